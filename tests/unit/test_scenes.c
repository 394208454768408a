/* Scenes of flows, waves, loads and projections: their starts are what they say, the truth has no
 * error and a planted fault the right one. */
#include "../../analysis/truth_flows.h"
#include "../../core/run/run.h"
#include "stage.h"

static const double pi = 3.14159265358979323846;

static int no_truths(void) { return isnan(truth_wave_frequency(1, 1, 1)); }

/* Set v and p by a flow of unit density that the test knows. */
static void set_flow(struct stage *s, struct truth_flow flow(double x, double y))
{
  for (int i = 0; i < s->now.n; i++) {
    const struct truth_flow f = flow((double)s->brute.x[i].c[0], (double)s->brute.x[i].c[1]);
    s->brute.v[i] = zero();
    s->brute.v[i].c[0] = (real)f.u;
    s->brute.v[i].c[1] = (real)f.v;
    s->p[i] = (real)(s->now.rho0 * f.p + 500); /* the level is free */
  }
}

static void grow_flow(struct stage *s, double speeds, double pressures)
{
  for (int i = 0; i < s->now.n; i++) {
    s->brute.v[i] = times((real)speeds, s->brute.v[i]);
    s->p[i] *= (real)pressures;
  }
}

/* --- taylor-green, gresho --- */

static const struct truth_vortices vortices = {1, 1.01, 0.01};
static struct truth_flow vortices_later(double x, double y)
{
  return truth_taylor_green(&vortices, x, y, 0.5);
}

static void test_taylor_green(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  struct stage s = prepare(&benchmark_taylor_green);
  set_param(&s, "reynolds", 101); /* the square is 1.01 m wide: nu = 0.01 */
  set_param(&s, "jitter", 0.1);
  set_param(&s, "side", 1);
  build(&s);
  near_to(s.scene.common.viscosity, 1000. / 101, 1e-12, 1e-12);
  near_to(s.scene.period.c[0], 1.01, 1e-15, 1e-6);
  assert_int_equal(s.scene.n, 2500);
  for (int i = 0; i < s.scene.n; i++) {
    const double x = 2 * pi * (double)s.scene.x[i].c[0] / 1.01;
    const double y = 2 * pi * (double)s.scene.x[i].c[1] / 1.01;
    near_to(s.scene.v[i].c[0], -cos(x) * sin(y), 1e-12, 1e-5);
    near_to(s.scene.v[i].c[1], sin(x) * cos(y), 1e-12, 1e-5);
  }
  end(&s);
  if (no_truths()) skip();
  s = prepare(&benchmark_taylor_green);
  set_param(&s, "viscosity", 10); /* the same fluid, told otherwise */
  build(&s);
  s.now.time = 0.5;
  set_flow(&s, vortices_later);
  struct measures out = measured(&s);
  near_to(VALUE(out, velocity_error), 0, 1e-12, 1e-5);
  near_to(VALUE(out, pressure_error), 0, 1e-11, 1e-4);
  near_to(VALUE(out, energy_error), 0, 1e-12, 1e-5);
  grow_flow(&s, 1.1, 1.3);
  out = measured(&s);
  near_to(VALUE(out, velocity_error), 0.1, 1e-12, 1e-5);
  near_to(VALUE(out, pressure_error), 0.3, 1e-11, 1e-4);
  near_to(VALUE(out, energy_error), 0.21, 1e-12, 1e-5);
  end(&s);
  s = prepare(&benchmark_taylor_green);
  set_param(&s, "viscosity", 10);
  set_param(&s, "reynolds", 10);
  refused(s.b->build(&s.scene, s.self), "one of them");
  end(&s);
}

static struct truth_flow vortex(double x, double y) { return truth_gresho(2, 0.3, x, y); }

static void test_gresho(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  for (int edge = 0; edge < 3; edge++) {
    struct stage s = prepare(&benchmark_gresho);
    set_param(&s, "edge", edge);
    set_param(&s, "peak_speed", 2);
    set_param(&s, "vortex_radius", 0.3);
    set_param(&s, "jitter", 0.1);
    set_param(&s, "slack", edge == 1 ? 0.02 : 0);
    build(&s);
    assert_int_equal(s.scene.n_wall > 0, edge == 2);
    near_to(s.scene.period.c[0], edge == 1 ? 1.02 : 0, 1e-15, 1e-6);
    if (!no_truths()) {
      struct measures out = measured(&s); /* the start itself: not one that the truth has set */
      near_to(VALUE(out, velocity_error), 0, 1e-12, 1e-5);
      near_to(VALUE(out, energy_error), 0, 1e-12, 1e-5);
      near_to(VALUE(out, spin_error), 0, 1e-12, 1e-5);
      set_flow(&s, vortex);
      out = measured(&s);
      near_to(VALUE(out, pressure_error), 0, 1e-11, 1e-4);
      grow_flow(&s, 0.9, 0.5);
      out = measured(&s);
      near_to(VALUE(out, velocity_error), 0.1, 1e-12, 1e-5);
      near_to(VALUE(out, pressure_error), 0.5, 1e-11, 1e-4);
      near_to(VALUE(out, energy_error), 0.19, 1e-12, 1e-5);
      near_to(VALUE(out, spin_error), 0.1, 1e-12, 1e-5);
    }
    end(&s);
  }
  struct stage s = prepare(&benchmark_gresho);
  set_param(&s, "vortex_radius", 0.6);
  refused(s.b->build(&s.scene, s.self), "half of the side");
  end(&s);
}

/* dp/dr = v^2/r of the truth, and the profile's numbers. */
static void test_gresho_truth(void **state)
{
  const double h = 1e-6;
  (void)state;
  if (no_truths()) skip();
  for (double r = 0.05; r < 0.9; r += 0.1) {
    const struct truth_flow f = truth_gresho(3, 0.8, 0.6 * r, 0.8 * r);
    const double speed = sqrt(f.u * f.u + f.v * f.v);
    const double slope =
      (truth_gresho(3, 0.8, r + h, 0).p - truth_gresho(3, 0.8, r - h, 0).p) / 2 / h;
    assert_true(fabs(slope - speed * speed / r) < 1e-6);
    assert_true(fabs(speed - (r < 0.4 ? 7.5 * r : r < 0.8 ? 6 - 7.5 * r : 0)) < 1e-12);
    assert_true(f.u <= 0 && f.v >= 0);
  }
}

/* --- waves --- */

/* A flat surface whose mode grows at a omega; no divergence; nothing goes through bed and walls. */
static void test_standing_wave(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  struct stage s = built(&benchmark_standing_wave);
  const double k = pi, a = 0.05, omega = sqrt(pi * tanh(pi)), dt = 1e-5;
  s.now.time = 0;
  s.now.step = 0;
  struct measures out = measured(&s);
  near_to(VALUE(out, mode_amplitude), 0, 1e-12, 1e-5);
  for (int i = 0; i < s.now.n; i++) {
    const double x = (double)s.scene.x[i].c[0], y = (double)s.scene.x[i].c[1];
    const double u = -a * k / omega * cosh(k * y) / cosh(k) * sin(k * x);
    const double v = a * k / omega * sinh(k * y) / cosh(k) * cos(k * x);
    near_to(s.scene.v[i].c[0], u, 1e-14, 1e-6);
    near_to(s.scene.v[i].c[1], v, 1e-14, 1e-6);
    s.brute.x[i] = madd(s.brute.x[i], (real)dt, s.brute.v[i]);
  }
  s.now.step = 1;
  s.now.time = dt;
  out = measured(&s);
  near_to(VALUE(out, mode_amplitude) / (a * omega * dt), 1, 2e-3, 0.5);
  if (!no_truths()) near_to(VALUE(out, mode_error), 0, 2e-3, 0.5);
  end(&s);
}

/* Water whose surface is raised by a cos(k x), by moving columns of particles apart. */
static void set_amplitude(struct stage *s, double a, double k, double depth)
{
  for (int i = 0; i < s->now.n; i++) {
    double x = (double)s->scene.x[i].c[0], X = x;
    for (int n = 0; n < 50; n++) X = x - a / (k * depth) * sin(k * X);
    s->brute.x[i] = s->scene.x[i];
    s->brute.x[i].c[0] = (real)X;
  }
}

static void test_waves_measure_their_mode(void **state)
{
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  struct stage s = prepare(&benchmark_standing_wave);
  set_param(&s, "viscosity", 4);
  build(&s);
  const double omega = 1.7691469796583, decay = 2 * 0.004 * pi * pi, period = 2 * pi / omega;
  for (int k = 0; k <= 400; k++) { /* exact but 2 % late and 10 % too high */
    s.now.time = 2 * period * k / 400;
    s.now.step = k;
    const double a = 0.05 * sin(omega * s.now.time / 1.02) * exp(-decay * s.now.time);
    set_amplitude(&s, 1.1 * a, pi, 1);
    const struct measures out = measured(&s);
    near_to(VALUE(out, mode_amplitude), 1.1 * a, 1e-4, 1e-4);
    if (k == 400) near_to(VALUE(out, period_error), 0.02, 2e-4, 1e-3);
    if (k == 400) assert_true(VALUE(out, mode_error) > 0.1 && VALUE(out, mode_error) < 0.2);
  }
  end(&s);
}

static void test_sloshing(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  for (int mode = 1; mode < 4; mode++) {
    struct stage s = prepare(&benchmark_sloshing);
    set_param(&s, "half_waves", mode);
    set_param(&s, "steepness", 0.02);
    build(&s);
    s.now.time = 0;
    s.now.step = 0;
    near_to(VALUE(measured(&s), mode_amplitude), 0.012, 3e-5, 3e-5);
    double highest = 0, lowest = 1; /* of the left half of the last half wave's top row */
    for (int i = 0; i < s.now.n; i++) {
      const double x = (double)s.scene.x[i].c[0], y = (double)s.scene.x[i].c[1];
      if (x < 0.025) highest = fmax(highest, y);
      if (fabs(x - s.scene.common.spacing / 2 - 1.725 / mode) < 0.03 && y > 0.55)
        lowest = fmin(lowest, y);
    }
    assert_true(highest > 0.5875 + 0.011 && highest < 0.5875 + 0.012);
    if (mode == 1) assert_true(lowest < 0.5875);
    if (!no_truths()) { /* a wave that stands still: at half a period off by two amplitudes */
      const double T = mode == 1 ? 1.667786050 : mode == 2 ? 1.066198161 : 0.860719829;
      for (int k = 0; k <= 1000; k++) {
        s.now.time = T / 4 * k / 1000;
        s.now.step = k;
        measured(&s);
      }
      const double rms = sqrt((1.5 - 4 / pi) / 0.5); /* of 1 - cos over cos, a quarter of it */
      near_to(VALUE(measured(&s), mode_error), rms, 0.02, 0.02);
    }
    end(&s);
  }
}

/* --- column --- */

/* By what the summed density of a lattice rises when it is pressed along one axis, over what its
 * number density rises: 1 but for the kernel's few neighbours. */
static double lattice_response(void)
{
  const struct kernel kernel = kernel_make(KERNEL_CUBIC, (real)2.5, DIM);
  const double pressed = 1e-2;
  double sum[2] = {0, 0};
  for (int k = 0; k < 2; k++)
    for (int a = -3; a <= 3; a++)
      for (int b = -3; b <= 3; b++)
        for (int c = DIM == 3 ? -3 : 0; c <= (DIM == 3 ? 3 : 0); c++) {
          const double y = k ? b * (1 - pressed) : b;
          sum[k] += (double)kernel_W(&kernel, (real)sqrt(a * a + y * y + c * c), DIM);
        }
  return (sum[1] / sum[0] - 1) / (1 / (1 - pressed) - 1);
}

/* Particles on the exact static solution. */
static void test_column(void **state)
{
  (void)state;
  for (int load = 0; load < 3; load++) {
    struct stage s = prepare(&benchmark_column);
    const double H = 0.4, weight = 1000 * 9.81 * H, K = weight / (load == 0 ? 0.02 : 0.06);
    set_param(&s, "modulus", load == 2 ? 0 : K);
    set_param(&s, "spacing", DIM == 2 ? 0.005 : 0.02);
    build(&s);
    const double e = weight / K, kappa = e / H; /* Y -> - log(1 - kappa Y/(1 + e))/kappa */
    double height = 0;
    for (int i = 0; i < s.now.n; i++) {
      real *y = &s.brute.x[i].c[DIM - 1];
      *y = (real)(-log(1 - kappa * (double)*y / (1 + e)) / kappa);
      height = fmax(height, (double)*y);
      s.brute.v[i].c[0] = (real)0.02;
    }
    assert_true(fabs(height - log(1 + e) / kappa) < s.now.dx);
    const struct measures out = measured(&s);
    near_to(VALUE(out, settlement), 1 - 2 * (e - log1p(e)) / (e * e), 2e-4, 2e-4);
    near_to(VALUE(out, bulk_modulus) / K, 1 / lattice_response(), 0.02, 0.02);
    if (load < 2) near_to(VALUE(out, settlement_error), 0, 2e-4, 2e-4);
    if (load == 2) near_to(VALUE(out, settlement_error), VALUE(out, settlement), 0, 0);
    near_to(VALUE(out, residual_speed), 0.02 / sqrt(9.81 * H), 1e-7, 1e-6);
    end(&s);
  }
}

static void test_column_is_loaded_slowly(void **state)
{
  (void)state;
  struct stage s = built(&benchmark_column);
  struct particles p = {.n = s.now.n, .n_all = s.now.n, .x = s.brute.x, .v = s.brute.v};
  for (int i = 0; i < p.n; i++) p.v[i] = scene_at(2, 0, 1);
  s.b->drive(&s.scene, s.self, p, 0.1); /* a third of the ramp */
  near_to(p.v[7].c[0], 2 * exp(-0.02), 1e-14, 1e-6);
  near_to(p.v[7].c[DIM - 1], (1 + 1e-3 * 9.81 * 2 / 3) * exp(-0.02), 1e-8, 1e-6);
  for (int i = 0; i < p.n; i++) p.v[i] = scene_at(2, 0, 1);
  s.b->drive(&s.scene, s.self, p, 0.31);
  near_to(p.v[7].c[DIM - 1], exp(-0.02), 1e-14, 1e-6);
  end(&s);
}

/* --- manufactured-projection --- */

static void test_manufactured_projection(void **state)
{
  (void)state;
  for (int kept = 0; kept < 2; kept++) {
    struct stage s = prepare(&benchmark_manufactured_projection);
    set_param(&s, "kept", kept);
    set_param(&s, "side", 1);
    set_param(&s, "dt", 0.01);
    set_param(&s, "jitter", 0.2);
    build(&s);
    assert_true(s.b->projection);
    struct measures out = measured(&s); /* nothing was done */
    near_to(VALUE(out, velocity_error), 1, 1e-12, 1e-6);
    for (int i = 0; i < s.now.n; i++) {
      double x[3] = {0}, q = 1 / pi;
      for (int d = 0; d < DIM; d++) x[d] = pi * (double)s.scene.x[i].c[d];
      for (int d = 0; d < DIM; d++) q *= cos(x[d]);
      s.p[i] = (real)(1000 * q / 0.01);
      s.brute.v[i] = zero();
      s.brute.v[i].c[0] = (real)(kept ? -cos(2 * x[0]) * sin(2 * x[1]) : 2 * x[1] / pi);
      s.brute.v[i].c[1] = (real)(kept ? sin(2 * x[0]) * cos(2 * x[1]) : -2 * x[0] / pi);
    }
    for (int i = 0; i < s.now.n; i++) /* the start had grad q beside it */
      for (int d = 0; d < DIM; d++) {
        double slope = -sin(pi * (double)s.scene.x[i].c[d]);
        for (int e = 0; e < DIM; e++)
          if (e != d) slope *= cos(pi * (double)s.scene.x[i].c[e]);
        near_to(s.scene.v[i].c[d] - s.brute.v[i].c[d], slope, 1e-12, 1e-5);
      }
    out = measured(&s);
    near_to(VALUE(out, velocity_error), 0, 1e-12, 1e-5);
    near_to(VALUE(out, pressure_error), 0, 1e-12, 1e-5);
    near_to(VALUE(out, orthogonality_defect), 0, 0.01, 0.01); /* the integral of v . grad q */
    for (int i = 0; i < s.now.n; i++) {
      s.brute.v[i] = zero(); /* all taken away: the kept part too */
      s.p[i] *= (real)0.7;
    }
    out = measured(&s);
    near_to(VALUE(out, pressure_error), 0.3, 1e-12, 1e-5);
    near_to(VALUE(out, orthogonality_defect), 0, 0, 0);
    assert_true(VALUE(out, velocity_error) > 0.5);
    end(&s);
  }
}

/* --- two-particle --- */

static void test_two_particles(void **state)
{
  (void)state;
  struct stage s = prepare(&benchmark_two_particle);
  set_param(&s, "drift", 0.3);
  build(&s);
  near_to(VALUE(measured(&s), pair_distance), 0.005, 1e-15, 1e-9);
  s.now.time = 0.1;
  for (int i = 0; i < 2; i++) { /* as flown, stored the other way round */
    s.brute.x[i] = madd(s.scene.x[1 - i], (real)0.1, s.scene.v[1 - i]);
    s.brute.v[i] = s.scene.v[1 - i];
    s.brute.id[i] = 1 - i;
  }
  struct measures out = measured(&s);
  near_to(VALUE(out, pair_distance), sqrt(0.01 * 0.01 + 0.005 * 0.005), 1e-15, 1e-8);
  near_to(VALUE(out, trajectory_error), 0, 1e-14, 1e-6);
  near_to(VALUE(out, spin_error), 0, 1e-13, 1e-5);
  for (int i = 0; i < 2; i++) /* held together: neither part nor pass */
    s.brute.x[i] = madd(s.scene.x[1 - i], (real)0.03, scene_at(1, 0, 0));
  const double lost = 4 * 0.0025 * 0.0025, flown = 2 * 0.03 * 0.03 + lost;
  near_to(VALUE(measured(&s), trajectory_error), sqrt(lost / flown), 1e-12, 1e-6);
  s.brute.v[0] = s.brute.v[1] = zero();
  near_to(VALUE(measured(&s), spin_error), 1, 1e-14, 1e-6);
  end(&s);
}

/* --- poiseuille, couette --- */

static void test_channels(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  const struct benchmark *const flows[] = {&benchmark_poiseuille, &benchmark_couette};
  for (int k = 0; k < 2; k++) {
    struct stage s = built(flows[k]);
    const double gap = 1e-3, length = (double)s.scene.period.c[0];
    assert_int_equal(s.scene.n, (int)round(length / 2.5e-5) * 40);
    near_to(s.scene.gravity.c[0], k == 0 ? 1e-4 : 0, 1e-19, 1e-11);
    for (int i = 0; i < s.scene.n_wall; i++) {
      const int upper = (double)s.scene.wall_x[i].c[1] > gap / 2;
      near_to(s.scene.wall_v[i].c[0], k == 1 && upper ? 1.25e-5 : 0, 1e-19, 1e-11);
      near_to(s.scene.wall_n[i].c[1], upper ? -1 : 1, 0, 0);
    }
    s.now.time = 0.1125;
    if (!no_truths()) {
      const double middle = k == 0 ? 8.249913844794e-6 : 3.628440987073e-6;
      const struct truth_channel c = {gap, 1e-6, k == 0 ? 1e-4 : 1.25e-5};
      double (*const truth)(const struct truth_channel *, double, double) =
        k == 0 ? truth_poiseuille : truth_couette;
      near_to(truth(&c, gap / 2, 0.1125) / middle, 1, 1e-11, 1e-11);
      near_to(VALUE(measured(&s), velocity_error), 1, 1e-12, 1e-6); /* still at rest */
      for (int i = 0; i < s.now.n; i++)
        s.brute.v[i].c[0] = (real)(1.1 * truth(&c, (double)s.brute.x[i].c[1], 0.1125));
      near_to(VALUE(measured(&s), velocity_error), 0.1, 1e-9, 1e-5);
    }
    end(&s);
  }
  struct stage s = prepare(&benchmark_couette);
  set_param(&s, "viscosity", 0);
  refused(s.b->build(&s.scene, s.self), "needs some");
  end(&s);
}

/* --- the central field --- */

/* A lone particle swings in it as symplectic Euler says, whichever of x and v moves first. */
static void swing(const struct solver *solver)
{
  struct scene scene = new_scene(0.01);
  struct run *run;
  scene.common.dt = 0.01;
  scene.pull = 4;
  scene.low = all_axes(-10);
  scene.high = all_axes(10);
  must(scene_add(&scene, scene_at(1, 0.5, 0.5), zero()));
  must(run_create(solver, NULL, &scene, 0, &run));
  double v_first = 1, move_first = 1, v = 0, w = 0;
  for (int k = 0; k < 40; k++) {
    must(run_step(run));
    v -= 0.01 * 4 * v_first;
    v_first += 0.01 * v;
    move_first += 0.01 * w;
    w -= 0.01 * 4 * move_first;
  }
  const double x = (double)run->view->p.x[0].c[0], tolerance = IN_FLOAT ? 1e-5 : 1e-13;
  if (fabs(x - v_first) > tolerance && fabs(x - move_first) > tolerance) {
    print_error("%s: x = %.17g\n", solver->name, x);
    fail();
  }
  assert_true(fabs(x - cos(0.8)) < 0.02);
  near_to(run->view->p.x[0].c[DIM - 1], x / 2, 1e-13, 1e-5);
  run_free(run);
}

static void test_every_solver_feels_the_pull(void **state)
{
#define SOLVER(name) &solver_##name,
  static const struct solver *const solvers[] = {
#include "../../solvers/solvers.def"
  };
#undef SOLVER
  (void)state;
  for (int k = 0; k < COUNT(solvers); k++)
    if (solvers[k]->can & CAN(GRAVITY)) swing(solvers[k]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_taylor_green),
    cmocka_unit_test(test_gresho),
    cmocka_unit_test(test_gresho_truth),
    cmocka_unit_test(test_standing_wave),
    cmocka_unit_test(test_waves_measure_their_mode),
    cmocka_unit_test(test_sloshing),
    cmocka_unit_test(test_column),
    cmocka_unit_test(test_column_is_loaded_slowly),
    cmocka_unit_test(test_manufactured_projection),
    cmocka_unit_test(test_two_particles),
    cmocka_unit_test(test_channels),
    cmocka_unit_test(test_every_solver_feels_the_pull),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
