/* Affine motions of a drop that reduce to one quadrature.
 * The integrands are analytic; the panels are shorter than their distance from the real axis. */
#include "internal.h"

static double root_cosh(double s, void *unused)
{
  (void)unused;
  return sqrt(cosh(2 * s));
}

struct reference_ellipse reference_elliptical_drop(double A0, double t)
{
  const double tau = A0 * t;
  if (!isfinite(tau)) return (struct reference_ellipse){NAN, NAN, NAN, NAN, NAN};
  /* The integral exceeds both s and (e^s - 1)/sqrt2, so this start is beyond the root. */
  const double beyond = fmin(fabs(tau), log1p(SQRT2 * fabs(tau)));
  const struct ref_inverse inverse = {{root_cosh, NULL}, 0.4, copysign(beyond, tau)};
  const double s = tau == 0 ? 0 : ref_invert_integral(&inverse, tau);
  const double A = A0 / sqrt(cosh(2 * s));
  return (struct reference_ellipse){
    .a = exp(-s),
    .b = exp(s),
    .adot = -A * exp(-s),
    .bdot = A * exp(s),
    .pc_over_rho = sq(A) / (2 * cosh(2 * s)),
  };
}

/* Oscillating drop: *params is S^2 = A0^2/(2 B^2), the square of sinh of the largest strain. */
static double field_drop_slope(double q, void *params)
{
  const double S2 = *(const double *)params, x = S2 * sq(sin(q));
  return sqrt((1 + 2 * x) / (1 + x));
}

static bool is_field_drop(struct reference_field_drop d)
{
  return d.A0 >= 0 && isfinite(d.A0) && d.B > 0 && isfinite(d.B);
}

/* The nearest singularity is where S sin q = +-i/sqrt2. */
static double field_drop_panel(double S2) { return 0.6 * asinh(1 / sqrt(2 * S2 + 1)); }

double reference_oscillating_drop_period(struct reference_field_drop d)
{
  if (!is_field_drop(d)) return NAN;
  double S2 = sq(d.A0 / d.B) / 2;
  const gsl_function slope = {field_drop_slope, &S2};
  return 4 / (SQRT2 * d.B) *
         ref_integrate(&slope, (struct ref_range){0, PI / 2, field_drop_panel(S2)});
}

double reference_oscillating_drop_largest(struct reference_field_drop d)
{
  if (!is_field_drop(d)) return NAN;
  const double S2 = sq(d.A0 / d.B) / 2;
  return sqrt(S2) + sqrt(1 + S2);
}

struct reference_ellipse reference_oscillating_drop(struct reference_field_drop d, double t)
{
  if (!is_field_drop(d) || !isfinite(t)) return (struct reference_ellipse){NAN, NAN, NAN, NAN, NAN};
  double S2 = sq(d.A0 / d.B) / 2;
  const double period = reference_oscillating_drop_period(d), within = fmod(t, period);
  const struct ref_inverse inverse = {
    {field_drop_slope, &S2}, field_drop_panel(S2), 2 * PI * within / period};
  const double q = ref_invert_integral(&inverse, SQRT2 * d.B * within);
  const double s = asinh(sqrt(S2) * sin(q));
  const double A = d.A0 * cos(q) / sqrt(cosh(2 * s)); /* strain rate, s' */
  return (struct reference_ellipse){
    .a = exp(s),
    .b = exp(-s),
    .adot = A * exp(s),
    .bdot = -A * exp(-s),
    .pc_over_rho = (sq(A) + sq(d.B)) / (2 * cosh(2 * s)),
  };
}

/* Rotating ellipse. With a = r e^s, b = r e^-s, c = cosh 2s, c0 = c(0), r = sqrt(a0 b0):
 *   alpha' + beta' = Omega (c0 + 1)/(c + 1),  alpha' - beta' = Omega (c0 - 1)/(c - 1),
 *   c'^2 = 4 omega^2 (c0 c - 1)(c - c0)/c,    Omega = -omega,
 * and c = c0 + (c0 - 1/c0) sinh^2 f turns the last into
 *   omega t = int_0^f sqrt(1 + (1 - 1/c0^2) sinh^2 f) df. */
static double spin_slope(double f, void *params)
{
  const double c0 = *(const double *)params;
  return sqrt(1 + (1 - 1 / sq(c0)) * sq(sinh(f)));
}

/* d(alpha + beta)/df and d(alpha - beta)/df over Omega/omega; both 1 for a circle. */
static double spin_sum(double f, void *params)
{
  const double c0 = *(const double *)params, c = c0 + (c0 - 1 / c0) * sq(sinh(f));
  return (c0 + 1) / (c + 1) * spin_slope(f, params);
}

static double spin_difference(double f, void *params)
{
  const double c0 = *(const double *)params;
  return spin_slope(f, params) / (1 + (1 + 1 / c0) * sq(sinh(f)));
}

/* The angles and strain of the rotating ellipse and their rates. */
struct spin {
  double r, s, alpha, beta, sdot, alphadot, betadot;
};

static struct spin spin_at(const struct reference_spinning_ellipse *e, double t)
{
  const double excess = sq(e->a0 - e->b0) / (2 * e->a0 * e->b0); /* c0 - 1, without cancellation */
  double c0 = 1 + excess;
  const double tau = e->omega * t, kappa = sqrt(1 - 1 / sq(c0));
  const double beyond = fmin(fabs(tau), kappa > 0 ? acosh(1 + fabs(tau) / kappa) : INFINITY);
  const struct ref_inverse inverse = {{spin_slope, &c0}, 0.3, copysign(beyond, tau)};
  const double f = tau == 0 ? 0 : ref_invert_integral(&inverse, tau);
  const struct ref_range range = {0, f, 0.3};
  const double sum = -ref_integrate(&(gsl_function){spin_sum, &c0}, range);
  const double difference = -ref_integrate(&(gsl_function){spin_difference, &c0}, range);

  const double gain = 1 + (1 + 1 / c0) * sq(sinh(f)); /* (c - 1)/(c0 - 1) */
  const double c = 1 + excess * gain, side = e->a0 >= e->b0 ? 1 : -1;
  const double sum_dot = -e->omega * (c0 + 1) / (c + 1), difference_dot = -e->omega / gain;
  const double growth = (1 + 1 / c0) * sinh(f) * cosh(f) * sqrt(c0 * excess / (c * gain * (c + 1)));
  return (struct spin){
    .r = sqrt(e->a0 * e->b0),
    .s = side * asinh(sqrt(excess * gain / 2)),
    .alpha = (sum + difference) / 2,
    .beta = (sum - difference) / 2,
    .sdot = side * e->omega * growth,
    .alphadot = (sum_dot + difference_dot) / 2,
    .betadot = (sum_dot - difference_dot) / 2,
  };
}

/* m = R(alpha) n R(beta) */
static void between_rotations(const struct spin *p, const double n[2][2], double m[2][2])
{
  const double c = cos(p->alpha), s = sin(p->alpha), cb = cos(p->beta), sb = sin(p->beta);
  for (int j = 0; j < 2; j++) {
    const double n0 = n[0][0] * (j ? -sb : cb) + n[0][1] * (j ? cb : sb);
    const double n1 = n[1][0] * (j ? -sb : cb) + n[1][1] * (j ? cb : sb);
    m[0][j] = c * n0 - s * n1;
    m[1][j] = s * n0 + c * n1;
  }
}

struct reference_rotated_ellipse reference_rotating_ellipse(
  const struct reference_spinning_ellipse *e, double t)
{
  struct reference_rotated_ellipse out = {
    {{NAN, NAN}, {NAN, NAN}}, {{NAN, NAN}, {NAN, NAN}}, NAN, NAN, NAN, NAN};
  if (!(e->a0 > 0 && e->b0 > 0) || !isfinite(e->omega * t)) return out;
  const struct spin p = spin_at(e, t);
  const double a = p.r * exp(p.s), b = p.r * exp(-p.s);
  const double shape[2][2] = {{a, 0}, {0, b}};
  /* R(alpha)^T F' R(beta)^T = alpha' J D + D' + beta' D J, J a quarter turn, D = diag(a, b) */
  const double rate[2][2] = {{p.sdot * a, -p.alphadot * b - p.betadot * a},
                             {p.alphadot * a + p.betadot * b, -p.sdot * b}};
  between_rotations(&p, shape, out.F);
  between_rotations(&p, rate, out.Fdot);
  out.a = a;
  out.b = b;
  out.alpha = p.alpha;
  /* tr(M^2) = -2 det M for a trace-free M = F' F^-1; |F^-1|^2 = (a^2 + b^2)/(a b)^2 */
  const double det = rate[0][0] * rate[1][1] - rate[0][1] * rate[1][0];
  out.pc_over_rho = -det * a * b / (sq(a) + sq(b));
  return out;
}
