/* Pressures of flows that start with a jump: sudden release, normal impact. */
#include "internal.h"
#include <gsl/gsl_sf_zeta.h>

static bool inside(struct reference_column c, struct reference_vec x)
{
  return c.width > 0 && c.height > 0 && x.y >= 0 && x.y <= c.height && x.x <= c.width;
}

/* p/(rho g H) = 1 - y/H - sum_{n odd} 8/(n pi)^2 cos(n pi y/2H) cosh(n pi x/2H)/cosh(n pi B/2H) */
static struct ref_strip column_strip(struct reference_column c, struct reference_vec x)
{
  const double k = PI / (2 * c.height);
  return (struct ref_strip){k * (c.width - x.x), k * x.y, k * c.width};
}

double reference_dambreak_pressure(struct reference_column c, struct reference_vec x)
{
  if (!inside(c, x) || !(x.x >= 0)) return NAN;
  return 1 - x.y / c.height - 8 / sq(PI) * creal(ref_cosh_series(2, column_strip(c, x)));
}

struct reference_vec reference_dambreak_gradient(struct reference_column c, struct reference_vec x)
{
  if (!inside(c, x) || !(x.x >= 0)) return (struct reference_vec){NAN, NAN};
  const struct ref_strip strip = column_strip(c, x);
  return (struct reference_vec){-4 / PI * creal(ref_sinh_series(1, strip)),
                                -1 + 4 / PI * cimag(ref_cosh_series(1, strip))};
}

/* Pi/(rho U L) = sum_{n odd} 4/(n pi)^2 (-1)^((n-1)/2) cos(n pi x/L)
 *                            sinh(n pi (H - y)/L)/cosh(n pi H/L), L the width */
static struct ref_strip block_strip(struct reference_column c, struct reference_vec x)
{
  const double k = PI / c.width;
  return (struct ref_strip){k * x.y, k * (c.width / 2 - fabs(x.x)), k * c.height};
}

static bool inside_block(struct reference_column c, struct reference_vec x)
{
  return inside(c, x) && fabs(x.x) <= c.width / 2;
}

double reference_impact_impulse(struct reference_column c, struct reference_vec x)
{
  if (!inside_block(c, x)) return NAN;
  return 4 / sq(PI) * cimag(ref_sinh_series(2, block_strip(c, x)));
}

struct reference_vec reference_impact_gradient(struct reference_column c, struct reference_vec x)
{
  if (!inside_block(c, x)) return (struct reference_vec){NAN, NAN};
  const struct ref_strip strip = block_strip(c, x);
  const double inwards = 4 / PI * creal(ref_sinh_series(1, strip));
  return (struct reference_vec){x.x > 0 ? -inwards : inwards,
                                -4 / PI * cimag(ref_cosh_series(1, strip))};
}

double reference_impact_energy_loss(double aspect)
{
  if (!(aspect > 0)) return NAN;
  if (aspect < 0.5) return 1 - reference_impact_energy_loss(1 / (4 * aspect));
  double sum = 0;
  for (int n = 1; n * aspect < 8; n += 2)
    sum += 16 / (pow(n * PI, 3) * (exp(2 * n * PI * aspect) + 1));
  return (7 * gsl_sf_zeta_int(3) / (PI * PI * PI) - sum) / aspect;
}
