/* Time steps that theory allows (docs/stability.md). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stability.h"

static void take(struct prediction *p, double dt, const char *by)
{
  if (isnan(dt) || dt >= p->least) return;
  p->least = dt;
  p->by = by;
}

/* h = R/2.   CFL: dt <= 0.4 h/v_max (Monaghan 1992).   Sound, where the pressure follows from it
 * explicitly: dt <= 0.4 h/(c + v_max).   Viscous forces of old velocities: dt <= 0.125 h^2/nu
 * (Morris, Fox, Zhu 1997). */
struct prediction predict(const struct candidate_solver *c, double spacing, double support,
                          double viscosity, double speed)
{
  const double courant = 0.4, fourier = 0.125, none = (double)NAN;
  const double h = support * spacing / 2, nu = viscosity / c->rho0;
  struct prediction p = {none, none, none, HUGE_VAL, NULL};
  if (speed > 0) p.cfl = courant * h / speed;
  if (c->sound > 0) p.sound = courant * h / (c->sound + fmax(speed, 0));
  if (nu > 0 && !c->implicit_viscosity) p.viscous = fourier * h * h / nu;
  take(&p, p.cfl, "cfl");
  take(&p, p.sound, "sound");
  take(&p, p.viscous, "viscous");
  if (!p.by) p.least = none;
  return p;
}

/* The largest speed of a row's largest stable step; 0: none is, and a failed run's speed is none.
 */
static double row_speed(const struct stability *s, int method, int row)
{
  const struct trial *best = NULL;
  for (int k = 0; k < s->n; k++) {
    const struct trial *t = &s->trial[k];
    const int stable = t->verdict == VERDICT_STABLE && t->speed_max > 0;
    if (t->method == method && t->row == row && stable && (!best || t->dt > best->dt)) best = t;
  }
  return best ? best->speed_max : 0;
}

struct prediction predict_row(const struct stability *s, int method, int row)
{
  struct candidate_solver c = s->solver[method];
  const double value = strtod(s->map.value[row], NULL);
  const struct {
    const char *key;
    double *place;
  } known[] = {{"spacing", &c.spacing},
               {"support", &c.support},
               {"viscosity", &c.viscosity},
               {"rho0", &c.rho0}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (strcmp(s->map.key, known[k].key) == 0) *known[k].place = value;
  if (strcmp(s->map.key, "c") == 0 && c.sound > 0) c.sound = value;
  return predict(&c, c.spacing, c.support, c.viscosity, row_speed(s, method, row));
}
