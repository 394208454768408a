/* Particle systems whose motion is known: the 1-D lattice and the bound pair. */
#include "internal.h"

void reference_cubic_spline_1d(double r, double h, double w[3])
{
  const double q = r / h, s = 2 - q, norm = 2 / (3 * h);
  w[0] = w[1] = w[2] = 0;
  if (q < 1) {
    w[0] = norm * (1 - 1.5 * q * q + 0.75 * q * q * q);
    w[1] = norm * (-3 * q + 2.25 * q * q) / h;
    w[2] = norm * (-3 + 4.5 * q) / sq(h);
  } else if (q < 2) {
    w[0] = norm * 0.25 * s * s * s;
    w[1] = norm * -0.75 * s * s / h;
    w[2] = norm * 1.5 * s / sq(h);
  }
}

static bool is_lattice(const struct reference_lattice *l)
{
  return l->dx > 0 && l->h > 0 && l->m > 0 && l->support > 0 && l->kernel;
}

double reference_lattice_density(const struct reference_lattice *l)
{
  if (!is_lattice(l)) return NAN;
  double w[3];
  l->kernel(0, l->h, w);
  double rho = l->m * w[0];
  for (int j = 1; j * l->dx < l->support; j++) {
    l->kernel(j * l->dx, l->h, w);
    rho += 2 * l->m * w[0];
  }
  return rho;
}

double reference_lattice_omega2(const struct reference_lattice *l, double k)
{
  if (!is_lattice(l)) return NAN;
  const double rho0 = reference_lattice_density(l);
  double slope = 0, curvature = 0; /* both neighbours at distance r count */
  for (int j = 1; j * l->dx < l->support; j++) {
    double w[3];
    const double r = j * l->dx;
    l->kernel(r, l->h, w);
    slope += 2 * l->m * w[1] * sin(k * r);
    curvature += 2 * w[2] * (1 - cos(k * r));
  }
  return ((l->c2 - 2 * l->p0 / rho0) * sq(slope) + 2 * l->m * l->p0 * curvature) / sq(rho0);
}

/* (W(r) - W(r0))/(r - r0) of the 3-D cubic spline (h = 1), without cancellation within a piece. */
static double spline_3d(double r)
{
  return (r < 1 ? 1 - 1.5 * r * r + 0.75 * r * r * r : 0.25 * pow(2 - r, 3)) / PI;
}

static double divided_difference(double r, double r0)
{
  if (r <= 1 && r0 <= 1) return (-1.5 * (r + r0) + 0.75 * (r * r + r * r0 + r0 * r0)) / PI;
  const double s = 2 - r, s0 = 2 - r0;
  if (r >= 1 && r0 >= 1) return -0.25 * (s * s + s * s0 + s0 * s0) / PI;
  return (spline_3d(r) - spline_3d(r0)) / (r - r0);
}

static double pair_density(double r) { return 1 / PI + spline_3d(r); }

/* u(r0 + offset) - u(r0) per unit offset, with u = log(rho/rho0) + rho0/rho - 1. */
static double energy_slope(double r0, double offset, double rho0)
{
  const double start = pair_density(r0), change = divided_difference(r0 + offset, r0);
  const double z = change * offset / start;
  const double logarithm = fabs(z) > 0 ? log1p(z) / z : 1;
  return change / start * (logarithm - rho0 / (start * (1 + z)));
}

/* r = middle - half cos(q) turns the two turning points into regular points of
 * t = int_0^q half sin q / sqrt(8 (u(r_start) - u(r))) dq. Each half is measured from its own end.
 */
static double orbit_slope(double q, void *params)
{
  const struct reference_orbit *o = params;
  const double half = (o->r_max - o->r_start) / 2;
  const bool first = q <= PI / 2;
  const double near = first ? sin(q / 2) : cos(q / 2), far = first ? cos(q / 2) : sin(q / 2);
  const double offset = (first ? 2 : -2) * half * near * near;
  const double slope = energy_slope(first ? o->r_start : o->r_max, offset, o->rho0);
  /* half sin q = 2 half near far, u(r_start) - u = -slope offset */
  return sqrt(half / 4) * far / sqrt((first ? -1 : 1) * slope);
}

static double orbit_angle(const struct reference_orbit *o, double r)
{
  return acos((o->r_start + o->r_max - 2 * r) / (o->r_max - o->r_start));
}

static double orbit_time(const struct reference_orbit *o, double q)
{
  const double knot = orbit_angle(o, 1);
  struct reference_orbit copy = *o;
  const gsl_function slope = {orbit_slope, &copy};
  const double cuts[] = {0, fmin(knot, PI / 2), fmax(knot, PI / 2), PI};
  double t = 0;
  for (int k = 0; k < 3 && cuts[k] < q; k++)
    t += ref_integrate(&slope, (struct ref_range){cuts[k], fmin(q, cuts[k + 1]), 0.25});
  return t;
}

struct reference_orbit reference_two_particle_orbit(double r_start)
{
  struct reference_orbit o = {r_start, NAN, pair_density(1), NAN};
  if (!(r_start > 0 && r_start < 1)) return o;
  /* u(r) - u(r_start) is negative just beyond r_start and rises from r = 1 on. */
  double low = 1, high = 2;
  if (!(energy_slope(r_start, high - r_start, o.rho0) > 0)) return o;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    *(energy_slope(r_start, middle - r_start, o.rho0) < 0 ? &low : &high) = middle;
  }
  o.r_max = low;
  o.period = 2 * orbit_time(&o, PI);
  return o;
}

struct reference_motion reference_two_particle_motion(const struct reference_orbit *o, double t)
{
  if (!(o->period > 0) || !isfinite(t)) return (struct reference_motion){NAN, NAN};
  const double phase = fabs(fmod(t, o->period));
  const bool back = phase > o->period / 2;
  const double target = back ? o->period - phase : phase;
  struct reference_orbit copy = *o;
  double q = 2 * PI * target / o->period, low = 0, high = PI;
  for (int k = 0; k < 60; k++) {
    const double late = orbit_time(o, q) - target;
    *(late < 0 ? &low : &high) = q;
    const double next = q - late / orbit_slope(q, &copy);
    const double step = (next > low && next < high ? next : (low + high) / 2) - q;
    q += step;
    if (fabs(step) <= 1e-15) break;
  }
  const double half = (o->r_max - o->r_start) / 2, sign = (back ? -1 : 1) * copysign(1, t);
  const double r = o->r_start + 2 * half * sq(sin(q / 2));
  const double speed = q > 0 ? half * sin(q) / orbit_slope(q, &copy) : 0;
  return (struct reference_motion){r, sign * speed};
}
