/* Reference motions against the equations that they solve: residuals by finite differences,
 * invariants, and other ways to the same number. */
#include "reference_checks.h"

/* ---- drops ---- */

static double drop_b(double t) { return reference_elliptical_drop(3, t).b; }
static double drop_bdot(double t) { return reference_elliptical_drop(3, t).bdot; }
static const struct reference_field_drop field_drop = {0.7, 1.3};
static double field_a(double t) { return reference_oscillating_drop(field_drop, t).a; }
static double field_adot(double t) { return reference_oscillating_drop(field_drop, t).adot; }

static void test_drops_solve_their_equations(void **state)
{
  (void)state;
  for (double t = -0.5; t < 3; t += 0.21) {
    const struct reference_ellipse e = reference_elliptical_drop(3, t);
    close_to("b'", derivative(drop_b, t, 1e-3), e.bdot, 1e-9);
    close_to("b''", derivative(drop_bdot, t, 1e-3), 2 * e.pc_over_rho / e.b, 1e-8);
    close_to("volume", e.a * e.b, 1, 1e-15);
    close_to("energy", sq(e.adot) + sq(e.bdot), 18, 2e-14);
    close_to("pressure", e.pc_over_rho, 18 / sq(sq(e.a) + sq(e.b)), 1e-14);

    const struct reference_ellipse f = reference_oscillating_drop(field_drop, t);
    const double B2 = sq(field_drop.B);
    close_to("a'", derivative(field_a, t, 1e-3), f.adot, 1e-10);
    close_to("a''", derivative(field_adot, t, 1e-3), 2 * f.pc_over_rho / f.a - B2 * f.a, 1e-10);
    close_to("energy", sq(f.adot) + sq(f.bdot) + B2 * (sq(f.a) + sq(f.b)),
             2 * sq(field_drop.A0) + 2 * B2, 1e-14);
    const double later = t + 7 * reference_oscillating_drop_period(field_drop);
    close_to("period", reference_oscillating_drop(field_drop, later).a, f.a, 1e-13);
  }
  close_to("huge time", reference_elliptical_drop(1, 1e8).b, 1.41421356237309515e8, 2);
  close_to("small drop", reference_oscillating_drop_period((struct reference_field_drop){0, 1}),
           PI * sqrt(2), 1e-15);
  assert_true(isnan(reference_oscillating_drop_period((struct reference_field_drop){1, 0})));
}

static double largest_difference(double a[2][2], double b[3][3])
{
  double most = 0;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) most = fmax(most, fabs(a[i][j] - b[i][j]));
  return most;
}

static void test_rotating_ellipse(void **state)
{
  (void)state;
  const struct reference_spinning_ellipse e = {0.6, 1.1, -1.7};
  struct reference_affine end,
    start = {.dim = 2, .F = {{0.6, 0}, {0, 1.1}}, .Fdot = {{0, -1.7 * 1.1}, {1.7 * 0.6, 0}}};
  const double energy0 = sq(1.7) * (sq(0.6) + sq(1.1));
  for (double t = -2; t < 3; t += 0.37) {
    struct reference_rotated_ellipse r = reference_rotating_ellipse(&e, t);
    double energy = 0, spin = 0;
    for (int j = 0; j < 2; j++) {
      energy += sq(r.Fdot[0][j]) + sq(r.Fdot[1][j]);
      spin += r.F[0][j] * r.Fdot[1][j] - r.F[1][j] * r.Fdot[0][j];
    }
    close_to("volume", r.F[0][0] * r.F[1][1] - r.F[0][1] * r.F[1][0], 0.66, 1e-14);
    close_to("energy", energy, energy0, 3e-14);
    close_to("angular momentum", spin, 1.7 * (sq(0.6) + sq(1.1)), 3e-14);
    close_to("axes", r.a * r.b, 0.66, 1e-15);
    assert_true(r.pc_over_rho < 0);
    if (reference_affine_flow(&start, t, &end)) fail_msg("%s", reference_error());
    const double bound = end.error * fmax(r.a, r.b) + 1e-14;
    close_to("F", largest_difference(r.F, end.F), 0, fmin(bound, 2e-12));
    close_to("F'", largest_difference(r.Fdot, end.Fdot), 0, 5e-12);
    close_to("pc", end.pc_over_rho, r.pc_over_rho, 5e-12);
  }
  const struct reference_spinning_ellipse disc = {2, 2, 3};
  const struct reference_rotated_ellipse r = reference_rotating_ellipse(&disc, 0.4);
  close_to("disc", r.F[0][1], 2 * sin(1.2), 1e-14);
  close_to("disc", r.pc_over_rho, -18, 1e-13);
}

/* The axisymmetric drop also obeys c'^2 (1 + 1/(2 c^3)) = 3/2 A^2, A t = int sqrt(...) dc. */
static double stretch_time(double c) { return sqrt((1 + 1 / (2 * c * c * c)) / 1.5); }

static void test_affine_flows(void **state)
{
  (void)state;
  struct reference_axes end, start = {.dim = 3, .a = {1, 1, 1}, .adot = {-50, -50, 100}};
  assert_int_equal(reference_axes_flow(&start, 0.01, &end), REFERENCE_OK);
  close_to("quadrature", midpoint(stretch_time, 1, end.a[2], 200000), 1, 1e-10);
  close_to("error", end.error, 0, 1e-11);

  /* the same through the general form, turned: F = Q D Q^T with a rotation Q about y */
  const double c = cos(0.7), s = sin(0.7), Q[3][3] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
  struct reference_affine turned = {.dim = 3, .F = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, out;
  double want[3][3] = {{0}};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++) {
        turned.Fdot[i][j] += Q[i][k] * start.adot[k] * Q[j][k];
        want[i][j] += Q[i][k] * end.a[k] * Q[j][k];
      }
  if (reference_affine_flow(&turned, 0.01, &out)) fail_msg("%s", reference_error());
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) close_to("turned", out.F[i][j], want[i][j], 1e-11);
  close_to("turned pressure", out.pc_over_rho, end.pc_over_rho, 1e-8);

  struct reference_axes drop = {.dim = 2, .B = 1.3, .a = {1, 1}, .adot = {0.7, -0.7}};
  assert_int_equal(reference_axes_flow(&drop, 9, &end), REFERENCE_OK);
  close_to("field drop", end.a[0], field_a(9), fmin(end.error * 2, 1e-11));
  assert_int_equal(reference_axes_flow(&drop, 0, &end), REFERENCE_OK);
  assert_true(end.a[0] == 1 && end.error == 0);

  struct reference_affine general = {
    .dim = 2, .B = 1.3, .F = {{1, 0}, {0, 1}}, .Fdot = {{0.7, 0}, {0, -0.7}}};
  if (reference_affine_flow(&general, 9, &out)) fail_msg("%s", reference_error());
  close_to("field drop, general form", out.F[0][0], field_a(9), fmin(out.error * 2, 1e-11));

  /* a field much weaker than the strain: long thin ellipses */
  const struct reference_field_drop strong = {24, 1};
  struct reference_axes thin = {.dim = 2, .B = 1, .a = {1, 1}, .adot = {24, -24}};
  const double T = reference_oscillating_drop_period(strong);
  if (reference_axes_flow(&thin, 1.3 * T, &end)) fail_msg("%s", reference_error());
  const struct reference_ellipse exact = reference_oscillating_drop(strong, 1.3 * T);
  close_to("thin", end.a[0], exact.a, fmin(end.error, 1e-10) * exact.a);
  close_to("closing", reference_oscillating_drop(strong, T).a, 1, 1e-12);

  drop.adot[1] = 0.7;
  assert_int_equal(reference_axes_flow(&drop, 1, &end), REFERENCE_BAD_ARGUMENT);
  assert_true(strlen(reference_error()) > 10);
  turned.dim = 4;
  assert_int_equal(reference_affine_flow(&turned, 1, &out), REFERENCE_BAD_ARGUMENT);
}

/* ---- shallow water ---- */

static void test_shallow_water(void **state)
{
  (void)state;
  const struct reference_dry_bed dry = {1, 9.81};
  const double c0 = sqrt(9.81);
  const struct reference_shallow dam = reference_ritter(dry, 0, 2);
  close_to("dam depth", dam.h, 4.0 / 9, 1e-15);
  close_to("dam discharge", dam.h * dam.u, 8.0 / 27 * c0, 1e-15);
  close_to("front", reference_ritter(dry, 2 * c0 * 0.999999, 1).h, 0, 1e-12);
  assert_true(reference_ritter(dry, -c0 * 1.01, 1).h == 1);
  assert_true(reference_ritter(dry, 2.01 * c0, 1).h == 0);

  const struct reference_wet_bed wet = {2, 0.3, 9.81};
  const struct reference_stoker_states s = reference_stoker_states(&wet);
  /* jumps of mass and momentum across the bore */
  close_to("mass", s.bore * (s.hm - wet.hr), s.hm * s.um, 1e-13);
  close_to("momentum", s.bore * s.hm * s.um, s.hm * sq(s.um) + 9.81 / 2 * (sq(s.hm) - sq(wet.hr)),
           1e-12);
  double volume = 0;
  const int n = 100000;
  for (int i = 0; i < n; i++)
    volume += reference_stoker(&wet, -10 + 20 * (i + 0.5) / n, 1.3).h * 20 / n;
  close_to("volume", volume, 10 * 2.3, 2e-4);
  /* u + 2 c is constant through the rarefaction */
  for (double x = s.head * 1.1; x < s.bore * 0.99; x += 0.1) {
    const struct reference_shallow at = reference_stoker(&wet, x, 1);
    close_to("invariant", at.u + 2 * sqrt(9.81 * at.h), 2 * sqrt(9.81 * 2), 1e-13);
  }
  const struct reference_wet_bed even = {1, 1, 9.81};
  assert_true(isnan(reference_stoker_states(&even).hm));
}

/* ---- particle systems ---- */

/* Acceleration of particle i of a ring of n (m = dx = 1), x_i = i + eps cos(k i), p = p0 + c2 drho.
 */
struct ring {
  int n;
  double eps, k;
};

static double ring_at(struct ring r, int i) { return i + r.eps * cos(r.k * i); }

static double ring_density(struct ring r, int i)
{
  double rho = 0, w[3];
  for (int j = i - 5; j <= i + 5; j++) {
    reference_cubic_spline_1d(fabs(ring_at(r, i) - ring_at(r, j)), 1.3, w);
    rho += w[0];
  }
  return rho;
}

static double ring_acceleration(struct ring r, int i, const struct reference_lattice *l)
{
  const double rho0 = reference_lattice_density(l);
  double sum = 0, w[3];
  for (int j = i - 5; j <= i + 5; j++) {
    const double d = ring_at(r, i) - ring_at(r, j), a = ring_density(r, i), b = ring_density(r, j);
    reference_cubic_spline_1d(fabs(d), 1.3, w);
    const double Pa = (l->p0 + l->c2 * (a - rho0)) / sq(a),
                 Pb = (l->p0 + l->c2 * (b - rho0)) / sq(b);
    sum -= (Pa + Pb) * w[1] * (d > 0) - (Pa + Pb) * w[1] * (d < 0);
  }
  return sum;
}

static void test_lattice(void **state)
{
  (void)state;
  for (int p0 = -1; p0 <= 1; p0++)
    for (int mode = 1; mode <= 8; mode++) {
      const struct reference_lattice l = {1, 1, 1.3, 2.6, 10, p0, reference_cubic_spline_1d};
      const double k = PI * mode / 8, eps = 1e-6;
      const struct ring plus = {16, eps, k}, minus = {16, -eps, k};
      const double a = ring_acceleration(plus, 0, &l) - ring_acceleration(minus, 0, &l);
      close_to("omega^2", reference_lattice_omega2(&l, k), -a / (2 * eps), 1e-8);
    }
  struct reference_lattice l = {1, 1, 1.3, 2.6, 10, -1, reference_cubic_spline_1d};
  close_to("rho0", reference_lattice_density(&l), 1.0034662652, 1e-10);
  close_to("growth", sqrt(-reference_lattice_omega2(&l, PI)), 1.05483737, 1e-8);
  l.p0 = 0;
  close_to("zero-energy mode", reference_lattice_omega2(&l, PI), 0, 1e-15);
  close_to("half", reference_lattice_omega2(&l, PI / 2), 5.8924104293, 1e-10);
}

static struct reference_orbit orbit;
static double orbit_r(double t) { return reference_two_particle_motion(&orbit, t).r; }
static double orbit_rdot(double t) { return reference_two_particle_motion(&orbit, t).rdot; }

/* r'' = -2 dP/dr with u(rho)' = (rho - rho0)/rho^2: twice the acceleration of one particle */
static double pair_force(double r)
{
  const double s = 2 - r, slope_w = (r < 1 ? -3 * r + 2.25 * r * r : -0.75 * s * s) / PI;
  const double w = (r < 1 ? 1 - 1.5 * r * r + 0.75 * r * r * r : 0.25 * s * s * s) / PI;
  const double rho = 1 / PI + w;
  return -4 * (rho - orbit.rho0) / sq(rho) * slope_w;
}

static void test_two_particle_orbit(void **state)
{
  (void)state;
  orbit = reference_two_particle_orbit(0.8);
  close_to("rho0", orbit.rho0, 0.397887357729738339, 1e-16);
  close_to("r_max", orbit.r_max, 1.25534331150255369, 5e-15);
  close_to("period", orbit.period, 5.80599657796282539, 2e-14);
  close_to("r(2)", orbit_r(2), 1.1749320787768974, 2e-15);
  close_to("r'(2)", orbit_rdot(2), 0.17422373827215577, 2e-15);
  for (double t = -3.3; t < 9; t += 0.27) {
    close_to("r'", derivative(orbit_r, t, 1e-3), orbit_rdot(t), 1e-9);
    close_to("r''", derivative(orbit_rdot, t, 1e-3), pair_force(orbit_r(t)), 1e-5);
    close_to("again", orbit_r(t + 3 * orbit.period), orbit_r(t), 1e-13);
  }
  close_to("start", orbit_r(0), 0.8, 0);
  close_to("turn", orbit_r(orbit.period / 2), orbit.r_max, 1e-15);
  assert_true(isnan(reference_two_particle_orbit(0.05).period));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_drops_solve_their_equations),
    cmocka_unit_test(test_rotating_ellipse),
    cmocka_unit_test(test_affine_flows),
    cmocka_unit_test(test_shallow_water),
    cmocka_unit_test(test_lattice),
    cmocka_unit_test(test_two_particle_orbit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
