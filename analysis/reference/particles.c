/* The ordinary differential equation of variational SPH with an equation of state, by CVODE. */
#include "internal.h"
#include <stdlib.h>
#include <string.h>

static const double LOOSE = 1e-12, TIGHT = 1e-14;

/* The unknowns are x[n][dim] and then v[n][dim]. */
struct system {
  const struct reference_particles *p;
  double *push;  /* p_i/rho_i^2 */
  double *slope; /* [n][n] W'/r, for j < i */
  double *end;
};

static double distance2(const struct reference_particles *p, const double *x, int i, int j)
{
  double r2 = 0;
  for (int d = 0; d < p->dim; d++) r2 += sq(x[i * p->dim + d] - x[j * p->dim + d]);
  return r2;
}

/* Fills push and slope. */
static void densities(const struct system *s, const double *x)
{
  const struct reference_particles *p = s->p;
  double w[2];
  p->kernel(0, w, p->user);
  for (int i = 0; i < p->n; i++) s->push[i] = p->m * w[0];
  for (int i = 0; i < p->n; i++)
    for (int j = 0; j < i; j++) {
      const double r2 = distance2(p, x, i, j);
      s->slope[i * p->n + j] = 0;
      if (r2 >= sq(p->support) || r2 == 0) continue;
      const double r = sqrt(r2);
      p->kernel(r, w, p->user);
      s->push[i] += p->m * w[0];
      s->push[j] += p->m * w[0];
      s->slope[i * p->n + j] = w[1] / r;
    }
  for (int i = 0; i < p->n; i++) {
    const double rho = s->push[i], full = p->rho0[i];
    s->push[i] = full * sq(p->c) / p->gamma * expm1(p->gamma * log(rho / full)) / sq(rho);
  }
}

static int rate(double t, const double *y, double *dy, void *system)
{
  const struct system *s = system;
  const struct reference_particles *p = s->p;
  const int numbers = p->n * p->dim;
  double *a = dy + numbers;
  (void)t;
  densities(s, y);
  memcpy(dy, y + numbers, numbers * sizeof *dy);
  memset(a, 0, numbers * sizeof *a);
  for (int i = 0; i < p->n; i++)
    for (int j = 0; j < i; j++) {
      const double pull = -p->m * (s->push[i] + s->push[j]) * s->slope[i * p->n + j];
      for (int d = 0; d < p->dim && pull != 0; d++) {
        const double force = pull * (y[i * p->dim + d] - y[j * p->dim + d]);
        a[i * p->dim + d] += force;
        a[j * p->dim + d] -= force;
      }
    }
  return isfinite(a[0]) ? 0 : 1;
}

static int arrive(int k, const double *y, void *system)
{
  const struct system *s = system;
  (void)k;
  memcpy(s->end, y, 2 * (size_t)s->p->n * s->p->dim * sizeof *y);
  return REFERENCE_OK;
}

static enum reference_status integrate(struct system s, const double *start, double tolerance,
                                       double t, double *end)
{
  const struct ref_ode ode = {
    .name = "particles",
    .n = 2 * s.p->n * s.p->dim,
    .relative = tolerance,
    .absolute = tolerance,
    .rate = rate,
    .visit = arrive,
    .user = &s,
  };
  s.end = end;
  return ref_ode_integrate(&ode, start, (struct ref_times){&t, 1});
}

enum reference_status reference_particle_flow(const struct reference_particles *p, double t,
                                              double *x, double *v, double *error)
{
  if (p->n < 1 || p->dim < 1 || p->dim > 3 || !(p->m > 0) || !(p->gamma > 0) || !isfinite(t))
    return ref_fail(REFERENCE_BAD_ARGUMENT, "particles: needs particles in 1 to 3 dimensions, m > "
                                            "0, gamma > 0 and a time");
  const size_t n = p->n, numbers = n * p->dim;
  double *memory = malloc((n + n * n + 6 * numbers) * sizeof *memory);
  if (!memory) return ref_fail(REFERENCE_NO_MEMORY, "particles: no memory");
  const struct system s = {.p = p, .push = memory, .slope = memory + n};
  double *start = s.slope + n * n, *loose = start + 2 * numbers, *tight = loose + 2 * numbers;
  memcpy(start, x, numbers * sizeof *x);
  memcpy(start + numbers, v, numbers * sizeof *v);
  enum reference_status status = integrate(s, start, LOOSE, t, loose);
  if (!status) status = integrate(s, start, TIGHT, t, tight);
  if (!status) {
    *error = 0;
    for (size_t k = 0; k < 2 * numbers; k++) *error = fmax(*error, fabs(tight[k] - loose[k]));
    memcpy(x, tight, numbers * sizeof *x);
    memcpy(v, tight + numbers, numbers * sizeof *v);
  }
  free(memory);
  return status;
}
