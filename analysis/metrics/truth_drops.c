#include "../truth_drops.h"

#include <math.h>
#include <string.h>

static void fill(struct truth_affine *now, double value)
{
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) now->map[i][j] = now->rate[i][j] = now->bowl[i][j] = value;
  now->peak = value;
}

#ifdef SPHBENCH_HAVE_REFERENCE
#include "../reference/reference.h"

/* Along the axes: x = a X, a' = adot, p/rho = P (1 - sum (x/a)^2/R^2). */
struct axes {
  double a[3], adot[3], peak;
};

static void from_axes(const struct truth_drop *drop, const struct axes *axes,
                      struct truth_affine *now)
{
  const double R2 = drop->radius * drop->radius;
  fill(now, 0);
  for (int d = 0; d < drop->dim; d++) {
    now->map[d][d] = axes->a[d];
    now->rate[d][d] = axes->adot[d] / axes->a[d];
    now->bowl[d][d] = axes->peak / (axes->a[d] * axes->a[d]);
  }
  now->peak = axes->peak * R2;
}

/* The closed solutions contract along x (free) or stretch along it (in the field) at the start. */
static struct axes plane_drop(const struct truth_drop *drop, double t)
{
  const double s = drop->strain[0];
  if (drop->pull > 0) {
    const struct reference_field_drop field = {fabs(s), sqrt(drop->pull)};
    const struct reference_ellipse e = reference_oscillating_drop(field, t);
    return s >= 0 ? (struct axes){{e.a, e.b, 1}, {e.adot, e.bdot, 0}, e.pc_over_rho}
                  : (struct axes){{e.b, e.a, 1}, {e.bdot, e.adot, 0}, e.pc_over_rho};
  }
  const struct reference_ellipse e = reference_elliptical_drop(-s, t);
  return (struct axes){{e.a, e.b, 1}, {e.adot, e.bdot, 0}, e.pc_over_rho};
}

static struct axes space_drop(const struct truth_drop *drop, double t)
{
  struct reference_axes start = {.dim = 3, .B = sqrt(drop->pull), .a = {1, 1, 1}}, end;
  struct axes axes;
  for (int d = 0; d < 3; d++) start.adot[d] = drop->strain[d];
  if (reference_axes_flow(&start, t, &end) != REFERENCE_OK) end.pc_over_rho = (double)NAN;
  memcpy(axes.a, end.a, sizeof axes.a);
  memcpy(axes.adot, end.adot, sizeof axes.adot);
  axes.peak = end.pc_over_rho;
  return axes;
}

void truth_drop_at(const struct truth_drop *drop, double t, struct truth_affine *now)
{
  const struct axes axes = drop->dim == 2 ? plane_drop(drop, t) : space_drop(drop, t);
  if (isnan(axes.peak))
    fill(now, (double)NAN);
  else
    from_axes(drop, &axes, now);
}

double truth_drop_period(const struct truth_drop *drop)
{
  const struct reference_field_drop field = {fabs(drop->strain[0]), sqrt(drop->pull)};
  return drop->dim == 2 ? reference_oscillating_drop_period(field) : (double)NAN;
}

void truth_spinning_ellipse_at(double a, double b, double omega, double t, struct truth_affine *now)
{
  const struct reference_spinning_ellipse start = {a, b, omega};
  const struct reference_rotated_ellipse e = reference_rotating_ellipse(&start, t);
  const double det = e.F[0][0] * e.F[1][1] - e.F[0][1] * e.F[1][0];
  const double inverse[2][2] = {{e.F[1][1] / det, -e.F[0][1] / det},
                                {-e.F[1][0] / det, e.F[0][0] / det}};
  fill(now, 0);
  now->peak = e.pc_over_rho;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      now->map[i][j] = e.F[i][j] / (j == 0 ? a : b);
      for (int k = 0; k < 2; k++) {
        now->rate[i][j] += e.Fdot[i][k] * inverse[k][j];
        now->bowl[i][j] += e.pc_over_rho * inverse[k][i] * inverse[k][j];
      }
    }
}

#else

void truth_drop_at(const struct truth_drop *drop, double t, struct truth_affine *now)
{
  (void)drop, (void)t;
  fill(now, (double)NAN);
}
double truth_drop_period(const struct truth_drop *drop) { return (void)drop, (double)NAN; }
void truth_spinning_ellipse_at(double a, double b, double omega, double t, struct truth_affine *now)
{
  (void)a, (void)b, (void)omega, (void)t;
  fill(now, (double)NAN);
}
#endif

void truth_spinning_disc_at(double radius, double omega, double t, struct truth_affine *now)
{
  const double c = cos(omega * t), s = sin(omega * t), half = omega * omega / 2;
  fill(now, 0);
  now->map[0][0] = now->map[1][1] = c;
  now->map[0][1] = s;
  now->map[1][0] = -s;
  now->rate[0][1] = omega;
  now->rate[1][0] = -omega;
  now->peak = -half * radius * radius;
  now->bowl[0][0] = now->bowl[1][1] = -half;
}

double truth_spinning_disc_wave(int m, double omega, double t)
{
  if (m < 2) return (double)NAN;
  const double s = sqrt(m - 1.0) * fabs(omega * t);
  return sqrt(cosh(s) * cosh(s) + sinh(s) * sinh(s) / (m - 1.0));
}
