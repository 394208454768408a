#include "../truth.h"

#include <math.h>
#include <stddef.h>

static const double pi = 3.14159265358979323846;

#ifdef SPHBENCH_HAVE_REFERENCE
#include "../reference/reference.h"

double truth_patch_pressure(double x, double y)
{
  const struct reference_vec at = {x, y};
  return reference_square_patch_pressure(at);
}

void truth_patch_gradient(double x, double y, double gradient[2])
{
  const struct reference_vec at = {x, y}, g = reference_square_patch_gradient(at);
  gradient[0] = g.x;
  gradient[1] = g.y;
}

double truth_patch_centre(double t_omega)
{
  return reference_square_patch_state(t_omega).p_centre.value;
}

double truth_patch_mid_edge(double t_omega)
{
  return reference_square_patch_state(t_omega).r_min.value;
}

double truth_column_pressure(double width, double height, double x, double y)
{
  const struct reference_column column = {width, height};
  const struct reference_vec at = {x, y};
  return reference_dambreak_pressure(column, at);
}

static double impact_loss_2d(double aspect) { return reference_impact_energy_loss(aspect); }

int truth_front_points(const double **T, const double **Z)
{
  const struct reference_series *front = reference_martin_moyce_front();
  *T = front->x;
  *Z = front->y;
  return front->count;
}

#else

double truth_patch_pressure(double x, double y) { return (void)x, (void)y, (double)NAN; }
void truth_patch_gradient(double x, double y, double gradient[2])
{
  (void)x, (void)y;
  gradient[0] = gradient[1] = (double)NAN;
}
double truth_patch_centre(double t_omega) { return (void)t_omega, (double)NAN; }
double truth_patch_mid_edge(double t_omega) { return (void)t_omega, (double)NAN; }
double truth_column_pressure(double width, double height, double x, double y)
{
  return (void)width, (void)height, (void)x, (void)y, (double)NAN;
}
static double impact_loss_2d(double aspect) { return (void)aspect, (double)NAN; }
int truth_front_points(const double **T, const double **Z)
{
  *T = *Z = NULL;
  return 0;
}
#endif

double truth_patch_tip(double t_omega)
{
  static const double ratio[] = {0.97764, 0.97016, 0.96736, 0.95633, 0.95997}, step = 0.5;
  const int last = (int)(sizeof ratio / sizeof *ratio) - 1;
  if (!(t_omega >= 0 && t_omega <= last * step)) return (double)NAN;
  int k = (int)(t_omega / step);
  if (k == last) k--;
  const double f = t_omega / step - k;
  return (ratio[k] + f * (ratio[k + 1] - ratio[k])) * sqrt(0.5 * (1 + t_omega * t_omega));
}

/* As in 2-D, with 1 = sum c_mn cos(m pi x/L) cos(n pi z/D) over odd m, n, |c_mn| = 16/(pi^2 m n),
 * on the contact |x| < L/2, |z| < D/2: the loss is sum c_mn^2/4 tanh(k H)/(k H), k = pi
 * sqrt((m/L)^2 + (n/D)^2). */
double truth_impact_loss(double width, double height, double depth)
{
  enum { TERMS = 801 }; /* the tail is below 1e-7 */
  if (!(depth > 0)) return impact_loss_2d(height / width);
  double loss = 0;
  for (int m = TERMS; m > 0; m -= 2)
    for (int n = TERMS; n > 0; n -= 2) {
      const double a = m / width, b = n / depth, kH = pi * sqrt(a * a + b * b) * height;
      const double c = 16 / (pi * pi * m * n);
      loss += c * c / 4 * tanh(kH) / kH;
    }
  return loss;
}
