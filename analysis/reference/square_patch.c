/* The rotating square patch and its circular relative. */
#include "internal.h"
#include <gsl/gsl_sf_zeta.h>

/* p = Y^2 - 1/4 + sum_{n odd} 8/(n pi)^3 (-1)^((n-1)/2) cosh(n pi X)/cosh(n pi/2) cos(n pi Y),
 * written with the distances d from the sides: cos(n pi Y) = +-sin(n pi d). */
static bool corner_strip(struct reference_vec x, struct ref_strip *strip)
{
  const double dx = 0.5 - fabs(x.x), dy = 0.5 - fabs(x.y);
  *strip = (struct ref_strip){PI * dx, PI * dy, PI / 2};
  return dx >= 0 && dy >= 0;
}

double reference_square_patch_pressure(struct reference_vec x)
{
  struct ref_strip strip;
  if (!corner_strip(x, &strip)) return NAN;
  const double d = 0.5 - fabs(x.y);
  return d * d - d + 8 / (PI * PI * PI) * cimag(ref_cosh_series(3, strip));
}

struct reference_vec reference_square_patch_gradient(struct reference_vec x)
{
  struct ref_strip strip;
  if (!corner_strip(x, &strip)) return (struct reference_vec){NAN, NAN};
  /* along the distances from the nearest sides, which fall as |x| and |y| rise */
  const double along_x = -8 / sq(PI) * cimag(ref_sinh_series(2, strip));
  const double along_y = 8 / sq(PI) * creal(ref_cosh_series(2, strip)) - 2 * fabs(x.y);
  return (struct reference_vec){x.x > 0 ? -along_x : along_x, x.y > 0 ? -along_y : along_y};
}

double reference_square_patch_mean_pressure(void)
{
  double sum = 0;
  for (int n = 15; n >= 1; n -= 2) sum += 64 / (pow(n * PI, 5) * (exp(n * PI) + 1));
  return -1.0 / 6 + 31 * gsl_sf_zeta_int(5) / pow(PI, 5) - sum;
}

double reference_square_patch_edge_slope(void)
{
  double sum = 0;
  for (int n = 25; n >= 1; n -= 2) sum += 8 / (sq(n * PI) * cosh(n * PI / 2));
  return 1 - sum;
}

struct reference_patch_invariants reference_square_patch_invariants(void)
{
  return (struct reference_patch_invariants){
    .kinetic_energy = 1.0 / 12, .angular_momentum = -1.0 / 6, .area = 1};
}

struct reference_patch_state reference_square_patch_state(double t_omega)
{
  return (struct reference_patch_state){
    .p_centre = reference_series_smooth(reference_square_patch_p_centre(), t_omega),
    .r_min = reference_series_smooth(reference_square_patch_r_min(), t_omega),
    .r_tip = sqrt((1 + sq(t_omega)) / 2),
    .theta_tip = -PI / 4 - atan(t_omega),
  };
}

double reference_disc_growth_rate(int m) { return m >= 1 ? sqrt(m - 1.0) : NAN; }
