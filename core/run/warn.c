#include "warn.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "../sph/lattice.h"

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
warn(struct warnings *w, const char *format, ...)
{
  va_list arguments;
  if (w->n == MOST_WARNINGS) return;
  va_start(arguments, format);
  vsnprintf(w->text[w->n], WARNING_TEXT, format, arguments);
  va_end(arguments);
  w->list[w->n] = w->text[w->n];
  w->n++;
}

void warn_of_kappa(double kappa, char *text, size_t size)
{
  if (kappa > 2)
    snprintf(text, size,
             "kappa %g takes compression away %g times over in every step, more than 2 "
             "overshoots further each time",
             kappa, kappa);
}

/* --- the scale of speed */

static double largest_square(const vec *v, int n, double most)
{
  for (int i = 0; i < n; i++) most = fmax(most, (double)inner(v[i], v[i]));
  return most;
}

/* g.x: how deep a place lies [m^2/s^2] */
static double deepest(const struct scene *s, const vec *x, int n, double most)
{
  for (int i = 0; i < n; i++) most = fmax(most, (double)inner(s->gravity, x[i]));
  return most;
}

static double highest(const struct scene *s)
{
  double least = HUGE_VAL;
  for (int i = 0; i < s->n; i++) least = fmin(least, (double)inner(s->gravity, s->x[i]));
  return least;
}

double run_energy_speed(const struct run *run)
{
  const struct scene *s = &run->scene;
  double square = largest_square(s->wall_v, s->n_wall, largest_square(s->v, s->n, 0));
  const double bottom = deepest(s, s->wall_x, s->n_wall, deepest(s, s->x, s->n, -HUGE_VAL));
  for (int k = 0; k < s->num_emitters; k++) square = fmax(square, pow(s->emitter[k].speed, 2));
  if (s->n > 0) square += 2 * fmax(bottom - highest(s), 0);
  if (s->pull > 0) square += (double)s->pull * largest_square(s->x, s->n, 0);
  return sqrt(square);
}

/* --- limits */

/* The longest part of a step that the solver takes at once [s]. */
static double longest_step(const struct run *run)
{
  const double dt = run->dt;
  return run->solver->max_dt ? fmin(dt, run->solver->max_dt(run->state)) : dt;
}

static void check_courant(const struct run *run, double dt, double speed, struct warnings *w)
{
  const struct scene *s = &run->scene;
  const double g = sqrt((double)inner(s->gravity, s->gravity));
  const double R = s->common.support * s->common.spacing;
  const double fastest = fmax(speed, g * dt), way = fastest * dt;
  if (way > R)
    warn(w,
         "dt = %g s is far too long: at %.3g m/s, which the energy allows, a particle crosses %.3g "
         "spacings in a step, more than a support, and %.2g s are usual",
         run->dt, fastest, way / s->common.spacing, 0.2 * R / fmax(speed, sqrt(0.2 * R * g)));
}

static double most_viscous(const struct scene *s)
{
  double nu = s->common.viscosity / s->common.rho0;
  for (int k = 0; k < s->num_fluids; k++) nu = fmax(nu, s->fluid[k].viscosity / s->fluid[k].rho0);
  return nu;
}

static void check_viscosity(const struct run *run, double dt, struct warnings *w)
{
  const struct scene *s = &run->scene;
  const struct view *v = run->view;
  const double nu = most_viscous(s), V = (double)(v->mass / v->rho0);
  if (!(nu > 0) || s->common.viscosity_form == VISCOSITY_IMPLICIT) return;
  const int full = s->common.viscosity_pairs > 0;
  const double most = 2 / (nu * V * lattice_most_friction(&v->nb.kernel, (double)v->dx, full));
  if (dt > most)
    warn(w,
         "dt = %g s is far too long for explicit viscosity, which is stable up to %.2g s "
         "(viscosity_form=implicit has no such limit)",
         dt, most);
}

static void check_tension(const struct run *run, double dt, struct warnings *w)
{
  const struct scene_params *c = &run->scene.common;
  const double most = sqrt(c->rho0 * pow(c->spacing, 3) / (2 * (double)PI * c->tension));
  if (c->tension > 0 && dt > most)
    warn(w, "dt = %g s is far too long for surface tension, whose waves are resolved up to %.2g s",
         dt, most);
}

static void check_xsph(const struct run *run, double dt, struct warnings *w)
{
  const struct scene_params *c = &run->scene.common;
  const double total = c->xsph + c->xsph_rate * dt / (c->support * c->spacing / 2);
  if (total > 1)
    warn(w,
         "XSPH takes %.3g times the difference to the neighbours' velocity in a step, allowed is "
         "at most 1",
         total);
}

void run_warnings(const struct run *run, struct warnings *w)
{
  const double dt = longest_step(run), speed = run_energy_speed(run);
  char own[WARNING_TEXT] = "";
  w->n = 0;
  check_courant(run, dt, speed, w);
  check_viscosity(run, dt, w);
  check_tension(run, dt, w);
  check_xsph(run, dt, w);
  if (run->solver->warn) run->solver->warn(run->state, speed, own, sizeof own);
  if (*own) warn(w, "%s", own);
}

void warnings_say(const struct warnings *w)
{
  for (int k = 0; k < w->n; k++)
    fprintf(stderr, "%s%s%s", k ? "; " : "sphbench: warning: ", w->text[k],
            k == w->n - 1 ? "\n" : "");
}
