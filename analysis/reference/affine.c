/* Affine motions of a free drop, x = F X, by CVODE's Adams method at two tolerances. */
#include "internal.h"
#include <string.h>

enum { LONGEST = 18 };
static const double LOOSE = 1e-13, TIGHT = 1e-15;

/* y' = rhs(y), n unknowns of magnitude 1, lengths first and then their rates, from `start`. */
struct motion {
  const double *start;
  int n, dim;
  double B;
  int (*rhs)(double t, const double *y, double *dy, void *motion);
  double *end;
};

static int arrive(int k, const double *y, void *motion)
{
  const struct motion *m = motion;
  (void)k;
  memcpy(m->end, y, m->n * sizeof *y);
  return REFERENCE_OK;
}

static enum reference_status integrate(struct motion m, double tolerance, double t, double *y)
{
  const struct ref_ode ode = {
    .name = "affine motion",
    .n = m.n,
    .relative = tolerance,
    .absolute = tolerance,
    .rate = m.rhs,
    .visit = arrive,
    .user = &m,
  };
  m.end = y;
  return ref_ode_integrate(&ode, m.start, (struct ref_times){&t, 1});
}

/* y from both runs' tighter one; *error is their largest difference over the lengths, relative to
 * the largest of these. */
static enum reference_status integrate_twice(const struct motion *m, double t, double *y,
                                             double *error)
{
  double loose[LONGEST], size = 0;
  enum reference_status status = integrate(*m, LOOSE, t, loose);
  if (!status) status = integrate(*m, TIGHT, t, y);
  if (status) return status;
  *error = 0;
  for (int i = 0; i < m->n / 2; i++) {
    size = fmax(size, fabs(y[i]));
    *error = fmax(*error, fabs(y[i] - loose[i]));
  }
  *error /= size;
  return status;
}

/* ---- axes along the coordinates: y = (a, adot) ---- */

static double axes_pressure(const struct motion *m, const double *y)
{
  double above = m->dim * sq(m->B), below = 0;
  for (int i = 0; i < m->dim; i++) {
    above += sq(y[m->dim + i] / y[i]);
    below += 2 / sq(y[i]);
  }
  return above / below;
}

static int axes_rhs(double t, const double *y, double *dy, void *user)
{
  (void)t;
  const struct motion *m = user;
  const double P = axes_pressure(m, y);
  for (int i = 0; i < m->dim; i++) {
    dy[i] = y[m->dim + i];
    dy[m->dim + i] = 2 * P / y[i] - sq(m->B) * y[i];
  }
  return 0;
}

/* ---- any affine motion: y = (F, F') row by row ---- */

/* Determinant of the d x d matrix m and its inverse. */
static double invert(int d, const double *m, double *inverse)
{
  if (d == 2) {
    const double det = m[0] * m[3] - m[1] * m[2];
    const double adjugate[4] = {m[3], -m[1], -m[2], m[0]};
    for (int i = 0; i < 4; i++) inverse[i] = adjugate[i] / det;
    return det;
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, e = (i + 2) % 3;
      inverse[3 * i + j] = m[3 * a + c] * m[3 * b + e] - m[3 * a + e] * m[3 * b + c];
    }
  const double det = m[0] * inverse[0] + m[1] * inverse[3] + m[2] * inverse[6];
  for (int i = 0; i < 9; i++) inverse[i] /= det;
  return det;
}

/* The velocity gradient F' F^-1: its trace and the trace of its square. */
struct traces {
  double one, squared;
};

static struct traces gradient_traces(int d, const double *rate, const double *inverse)
{
  double gradient[9] = {0};
  struct traces out = {0, 0};
  for (int i = 0; i < d; i++)
    for (int j = 0; j < d; j++)
      for (int k = 0; k < d; k++) gradient[d * i + j] += rate[d * i + k] * inverse[d * k + j];
  for (int i = 0; i < d; i++) {
    out.one += gradient[d * i + i];
    for (int j = 0; j < d; j++) out.squared += gradient[d * i + j] * gradient[d * j + i];
  }
  return out;
}

static double affine_pressure(const struct motion *m, const double *y, double *inverse)
{
  const int d = m->dim;
  invert(d, y, inverse);
  double below = 0;
  for (int i = 0; i < d * d; i++) below += 2 * sq(inverse[i]);
  return (gradient_traces(d, y + d * d, inverse).squared + d * sq(m->B)) / below;
}

static int affine_rhs(double t, const double *y, double *dy, void *user)
{
  (void)t;
  const struct motion *m = user;
  const int d = m->dim;
  double inverse[9];
  const double P = affine_pressure(m, y, inverse);
  for (int i = 0; i < d; i++)
    for (int j = 0; j < d; j++) {
      dy[d * i + j] = y[d * d + d * i + j];
      dy[d * d + d * i + j] = 2 * P * inverse[d * j + i] - sq(m->B) * y[d * i + j];
    }
  return 0;
}

/* ---- scaling: lengths by the largest, rates by the fastest, so that tolerances mean the same ----
 */

struct units {
  double length, rate;
};

static struct units units_of(const struct motion *m, const double *y)
{
  struct units u = {0, fabs(m->B)};
  for (int i = 0; i < m->n / 2; i++) u.length = fmax(u.length, fabs(y[i]));
  for (int i = m->n / 2; i < m->n; i++) u.rate = fmax(u.rate, fabs(y[i]) / u.length);
  if (u.rate == 0) u.rate = 1;
  return u;
}

static void rescale(const struct motion *m, struct units u, double *y)
{
  for (int i = 0; i < m->n; i++) y[i] *= i < m->n / 2 ? u.length : u.length * u.rate;
}

static double energy(const struct motion *m, const double *y)
{
  double sum = 0;
  for (int i = 0; i < m->n / 2; i++) sum += sq(y[i + m->n / 2]) + sq(m->B * y[i]);
  return sum;
}

static double axes_volume(const struct motion *m, const double *y)
{
  double product = 1;
  for (int i = 0; i < m->dim; i++) product *= y[i];
  return product;
}

static double affine_volume(const struct motion *m, const double *y)
{
  double inverse[9];
  return invert(m->dim, y, inverse);
}

/* Advances y by t; error and defect as in struct reference_axes. */
struct quality {
  double error, defect;
};

static enum reference_status advance(struct motion m, double t, double *y, struct quality *quality)
{
  const struct units u = units_of(&m, y);
  double (*volume)(const struct motion *, const double *) =
    m.rhs == axes_rhs ? axes_volume : affine_volume;
  double start[LONGEST];
  rescale(&m, (struct units){1 / u.length, 1 / u.rate}, y);
  memcpy(start, y, sizeof start);
  m.start = start;
  m.B /= u.rate;
  const enum reference_status status = integrate_twice(&m, t * u.rate, y, &quality->error);
  if (status) return status;
  const double energy0 = energy(&m, start);
  quality->defect = fabs(volume(&m, y) / volume(&m, start) - 1);
  if (energy0 > 0) quality->defect = fmax(quality->defect, fabs(energy(&m, y) / energy0 - 1));
  rescale(&m, u, y);
  return status;
}

enum reference_status reference_axes_flow(const struct reference_axes *start, double t,
                                          struct reference_axes *end)
{
  const int d = start->dim;
  struct motion m = {NULL, 2 * d, d, start->B, axes_rhs, NULL};
  struct quality quality;
  double y[LONGEST] = {0}, divergence = 0, fastest = 0;
  bool good = (d == 2 || d == 3) && isfinite(start->B) && isfinite(t);
  for (int i = 0; good && i < d; i++) {
    y[i] = start->a[i];
    y[d + i] = start->adot[i];
    divergence += y[d + i] / y[i];
    fastest = fmax(fastest, fabs(y[d + i] / y[i]));
    good = y[i] > 0 && isfinite(y[i]) && isfinite(y[d + i]);
  }
  if (!good || fabs(divergence) > 1e-12 * fastest)
    return ref_fail(REFERENCE_BAD_ARGUMENT, "axes flow: needs dim 2 or 3, finite numbers, a > 0 "
                                            "and sum adot/a = 0");
  const enum reference_status status = advance(m, t, y, &quality);
  if (status) return status;
  *end = *start;
  memcpy(end->a, y, d * sizeof *y);
  memcpy(end->adot, y + d, d * sizeof *y);
  end->pc_over_rho = axes_pressure(&m, y);
  end->error = quality.error;
  end->defect = quality.defect;
  return status;
}

enum reference_status reference_affine_flow(const struct reference_affine *start, double t,
                                            struct reference_affine *end)
{
  const int d = start->dim;
  struct motion m = {NULL, 2 * d * d, d, start->B, affine_rhs, NULL};
  struct quality quality;
  double y[LONGEST] = {0}, inverse[9], sum = 0;
  bool good = (d == 2 || d == 3) && isfinite(start->B) && isfinite(t);
  for (int k = 0; good && k < d * d; k++) {
    y[k] = start->F[k / d][k % d];
    y[d * d + k] = start->Fdot[k / d][k % d];
    sum += y[k] + y[d * d + k];
  }
  good = good && isfinite(sum) && invert(d, y, inverse) > 0;
  if (!good || fabs(gradient_traces(d, y + d * d, inverse).one) > 1e-12 * units_of(&m, y).rate)
    return ref_fail(REFERENCE_BAD_ARGUMENT, "affine flow: needs dim 2 or 3, finite numbers, "
                                            "det F > 0 and tr(F' F^-1) = 0");
  const enum reference_status status = advance(m, t, y, &quality);
  if (status) return status;
  *end = *start;
  for (int k = 0; k < d * d; k++) {
    end->F[k / d][k % d] = y[k];
    end->Fdot[k / d][k % d] = y[d * d + k];
  }
  end->pc_over_rho = affine_pressure(&m, y, inverse);
  end->error = quality.error;
  end->defect = quality.defect;
  return status;
}
