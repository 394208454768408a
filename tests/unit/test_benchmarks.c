/* Built-in scenes: that they build, and that their errors are zero for the truth and known for a
 * known fault. */
#include "../../analysis/truth.h"
#include "stage.h"

#define BENCHMARK(name) &benchmark_##name,
static const struct benchmark *const all[] = {
#include "../../benchmarks/benchmarks.def"
};
#undef BENCHMARK

static int runs_here(const struct benchmark *b)
{
  return (b->dims & (DIM == 2 ? CAN(2D) : CAN(3D))) != 0;
}
static int no_truths(void) { return isnan(truth_patch_pressure(0, 0)); }

/* Only its own metrics are measured, and every one of them in the end. */
static void test_all_build_and_measure(void **state)
{
  (void)state;
  for (int k = 0; k < COUNT(all); k++) {
    const struct benchmark *b = all[k];
    assert_true(b->name && b->about && b->source && b->build && b->dims && b->params);
    assert_true(strlen(b->source) > 10);
    if (!runs_here(b)) continue;
    struct stage s = built(b);
    const struct measures out = measured(&s);
    for (int m = 0; m < NUM_METRICS; m++)
      if (!(b->measures[m / 32] & (1u << (m % 32)))) assert_true(isnan(out.value[m]));
    assert_true(s.scene.n <= 3 || (s.scene.n >= 200 && s.scene.n < 40000));
    if (b == &benchmark_dam_break && DIM == 2) assert_in_range(s.scene.n, 2000, 3000);
    end(&s);
  }
}

/* --- rotating-patch --- */

static void test_patch_start(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  struct stage s = built(&benchmark_rotating_patch);
  assert_int_equal(s.scene.n, 48 * 48);
  near_to(s.scene.common.xsph, 0.03, 0, 0);
  for (int i = 0; i < s.scene.n; i++) {
    near_to(s.scene.v[i].c[0], 2.0943951023931953 * (double)s.scene.x[i].c[1], 1e-15, 1e-7);
    near_to(s.scene.v[i].c[1], -2.0943951023931953 * (double)s.scene.x[i].c[0], 1e-15, 1e-7);
  }
  const double width = (double)(s.scene.high.c[0] - s.scene.low.c[0]);
  assert_true(width > 2 * 0.24 * 0.70711 * sqrt(1 + 4.19 * 4.19) && width < 3);
  end(&s);
  s = prepare(&benchmark_rotating_patch);
  set_param(&s, "spacing", 0.0075);
  set_param(&s, "support", 1.666667);
  build(&s);
  assert_int_equal(s.scene.n, 32 * 32);
  end(&s);
}

static void test_patch_truth_is_no_error(void **state)
{
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  struct stage s = built(&benchmark_rotating_patch);
  const double scale = 1000 * 2.0943951 * 2.0943951 * 0.24 * 0.24;
  s.now.time = 1e-3;
  for (int i = 0; i < s.now.n; i++)
    s.p[i] = (real)(scale * truth_patch_pressure((double)s.now.x[i].c[0] / 0.24,
                                                 (double)s.now.x[i].c[1] / 0.24));
  struct measures out = measured(&s);
  near_to(VALUE(out, centre_pressure_error), 0, 0.003, 0.003); /* the kernel's mean of a parabola */
  near_to(VALUE(out, mid_edge_error), 0, 0.002, 0.002);
  near_to(VALUE(out, tip_error), 0, 0.003, 0.003);
  /* a second sample, three times as long, 10 % off in pressure and with a hole in the middle */
  s.now.time = 4e-3;
  for (int i = 0; i < s.now.n; i++) s.p[i] *= (real)1.1;
  out = measured(&s);
  near_to(VALUE(out, centre_pressure_error), 0.1 * sqrt(0.75), 0.003, 0.003);
  for (int i = 0; i < s.now.n; i++)
    if ((double)inner(s.brute.x[i], s.brute.x[i]) < 0.03 * 0.03) s.brute.x[i].c[0] = 1;
  s.now.time = 8e-3;
  out = measured(&s);
  assert_true(VALUE(out, mid_edge_error) > 0.5 && VALUE(out, centre_pressure_error) > 0.6);
  assert_true(VALUE(out, tip_error) > 3);
  s.now.time = 3; /* beyond the truth: the error so far stays */
  const double before = VALUE(out, tip_error);
  near_to(VALUE(measured(&s), tip_error), before, 0, 0);
  end(&s);
}

/* Outlines of the computed evolution, filled with particles: what a perfect run would look like. */
static int read_outline(const char *name, double (*corner)[2], int most)
{
  char path[512], line[256];
  snprintf(path, sizeof path, "%s/analysis/reference/data/%s", SPHBENCH_SOURCE_DIR, name);
  FILE *file = fopen(path, "r");
  int n = 0;
  assert_non_null(file);
  while (n < most && fgets(line, sizeof line, file))
    if (sscanf(line, "%lf,%lf", &corner[n][0], &corner[n][1]) == 2) {
      corner[n][0] *= 0.24;
      corner[n][1] *= 0.24;
      n++;
    }
  fclose(file);
  return n;
}

static void test_patch_follows_the_outlines(void **state)
{
  static const char *const names[] = {
    "square_patch_outline_tw0p5.csv", "square_patch_outline_tw1p0.csv",
    "square_patch_outline_tw1p5.csv", "square_patch_outline_tw2p0.csv"};
  static double corner[1024][2];
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  for (int k = 0; k < COUNT(names); k++) {
    struct stage s = built(&benchmark_rotating_patch);
    struct scene filled = new_scene(0.0025);
    const int n = read_outline(names[k], corner, 1024);
    assert_true(n > 300);
    must(scene_fill_polygon(&filled, (const double(*)[2])corner, n, 0, 1, zero()));
    struct brute brute;
    struct snapshot now = snapshot_of(&filled, &brute), kept = s.now;
    s.now = now;
    s.now.p = NULL;
    s.now.time = 0.5 * (k + 1) / 2.0943951023931953 * (1 - 1e-6);
    const struct measures out = measured(&s);
    assert_true(isnan(VALUE(out, centre_pressure_error)));
    near_to(VALUE(out, mid_edge_error), 0, 0.01, 0.01);
    near_to(VALUE(out, tip_error), 0, 0.015, 0.015);
    brute_free(&brute);
    scene_free(&filled);
    s.now = kept;
    end(&s);
  }
}

/* --- first-step --- */

static void test_first_step(void **state)
{
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  struct stage s = prepare(&benchmark_first_step);
  const double omega = 2.0943951023931953, dt = 0.05, L = 0.24, a2 = 1 + omega * dt * omega * dt;
  set_param(&s, "dt", dt);
  build(&s);
  assert_true(s.b->projection);
  /* the velocity is the rigid rotation of the place that the particle came from */
  for (int i = 0; i < s.now.n; i++) {
    const vec from = madd(s.now.x[i], (real)-dt, s.now.v[i]);
    near_to(s.now.v[i].c[0], omega * (double)from.c[1], 1e-14, 1e-6);
    near_to(s.now.v[i].c[1], -omega * (double)from.c[0], 1e-14, 1e-6);
  }
  for (int i = 0; i < s.now.n; i++) {
    const double x = (double)s.now.x[i].c[0] / L, y = (double)s.now.x[i].c[1] / L;
    double g[2];
    truth_patch_gradient(x, y, g);
    s.p[i] = (real)(1000 * omega * omega * L * L * truth_patch_pressure(x, y) / a2);
    for (int d = 0; d < 2; d++) s.brute.v[i].c[d] -= (real)(dt * omega * omega * L * g[d] / a2);
  }
  struct measures out = measured(&s);
  near_to(VALUE(out, pressure_error), 0, 1e-12, 1e-6);
  near_to(VALUE(out, velocity_error), 0, 1e-12, 1e-5);
  for (int i = 0; i < s.now.n; i++) {
    s.p[i] *= (real)0.8;
    s.brute.v[i] = s.scene.v[i]; /* no change at all: an error of one */
  }
  out = measured(&s);
  near_to(VALUE(out, pressure_error), 0.2, 1e-12, 1e-6);
  near_to(VALUE(out, velocity_error), 1, 1e-12, 1e-6);
  end(&s);
}

/* The projected velocity has no divergence: by central differences of the exact fields. */
static void test_first_step_pressure_projects(void **state)
{
  const double omega = 1, dt = 0.1, a = omega * dt, h = 1e-4;
  (void)state;
  if (no_truths()) skip();
  for (double x = -0.4; x < 0.45; x += 0.2)
    for (double y = -0.4; y < 0.45; y += 0.2) {
      double east[2], west[2], north[2], south[2];
      truth_patch_gradient(x + h, y, east);
      truth_patch_gradient(x - h, y, west);
      truth_patch_gradient(x, y + h, north);
      truth_patch_gradient(x, y - h, south);
      const double laplacian = (east[0] - west[0] + north[1] - south[1]) / (2 * h);
      const double divergence = 2 * omega * a / (1 + a * a);
      assert_true(fabs(divergence - dt * laplacian / (1 + a * a)) < 1e-6);
    }
}

/* --- three-particle --- */

static void test_three_particles(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  struct stage s = built(&benchmark_three_particle);
  struct measures out = measured(&s);
  near_to(VALUE(out, gap_left), 0.006, 1e-15, 1e-9);
  near_to(VALUE(out, gap_right), 0.004, 1e-15, 1e-9);
  near_to(VALUE(out, gap_difference), -0.002, 1e-15, 1e-9);
  struct particles p = {.n = 3, .n_all = 3, .x = s.brute.x, .v = s.brute.v, .id = s.brute.id};
  for (int i = 0; i < 3; i++) { /* as sorted, and slowed down by tension */
    p.id[i] = 2 - i;
    p.v[i] = all_axes(0.01);
  }
  s.b->drive(&s.scene, s.self, p, 1);
  near_to(p.v[2].c[0], -0.05, 0, 1e-8);
  near_to(p.v[0].c[0], 0.05, 0, 1e-8);
  near_to(p.v[0].c[1], 0, 0, 0);
  near_to(p.v[1].c[0], 0.01, 1e-15, 1e-8);
  set_param(&s, "outer", 1); /* free */
  p.v[2] = zero();
  s.b->drive(&s.scene, s.self, p, 1);
  near_to(p.v[2].c[0], 0, 0, 0);
  end(&s);
}

/* --- dam-break --- */

static void test_column_pressure(void **state)
{
  (void)state;
  if (no_truths()) skip();
  struct stage s = built(&benchmark_dam_break);
  for (int i = 0; i < s.now.n; i++)
    s.p[i] = (real)(1000 * 9.81 * 0.7 *
                    truth_column_pressure(0.35, 0.7, (double)s.now.x[i].c[0],
                                          (double)s.now.x[i].c[DIM - 1]));
  near_to(VALUE(measured(&s), pressure_error), 0, 1e-7, 1e-5); /* g is a real */
  end(&s);
  s = built(&benchmark_dam_break); /* hydrostatic pressure is the well-known mistake */
  for (int i = 0; i < s.now.n; i++) s.p[i] = (real)(9810 * (0.7 - (double)s.now.x[i].c[DIM - 1]));
  const double wrong = VALUE(measured(&s), pressure_error);
  assert_true(wrong > 4 && wrong < 4.5);
  s.now.step = 100; /* later samples keep it */
  s.now.time = 0.1;
  near_to(VALUE(measured(&s), pressure_error), wrong, 0, 0);
  end(&s);
}

/* Put the front of the bottom rows at Z, at time T; returns the front's error so far. */
static double front_error_at(struct stage *s, double T, double Z)
{
  const double width = 0.35;
  int j = 0;
  for (int i = 0; i < s->now.n; i++)
    if ((double)s->now.x[i].c[DIM - 1] < 0.07)
      s->brute.x[i].c[0] = (real)(Z * width - s->now.dx * (0.5 + 0.001 * (j++ / 40)));
  s->now.p = NULL;
  s->now.time = T / sqrt(2 * 9.81 / width);
  s->now.step++;
  const struct measures out = measured(s);
  near_to(VALUE(out, front_position), Z, 1e-3, 1e-3);
  return VALUE(out, front_error);
}

/* Samples at the table's times, `off` times as far. */
static double error_of_front(double off)
{
  struct stage s = built(&benchmark_dam_break);
  const double *T, *Z;
  double error = (double)NAN;
  const int points = truth_front_points(&T, &Z);
  for (int k = 0; k < points; k++) {
    error = front_error_at(&s, T[k], off * Z[k]);
    assert_true(isnan(error) == (T[k] < 0.8));
  }
  end(&s);
  return error;
}

/* Samples at other times, of a front that moves evenly: linear in between is then exact. */
static void test_front_between_samples(void **state)
{
  struct stage s = built(&benchmark_dam_break);
  const double *T, *Z;
  double expected = 0, error = (double)NAN;
  int compared = 0;
  (void)state;
  for (double t = 0; t < 4; t += 0.7) error = front_error_at(&s, t, 1 + 0.8 * t);
  const int points = truth_front_points(&T, &Z);
  for (int k = 0; k < points; k++) {
    if (T[k] < 0.8 || T[k] > 3) continue;
    expected += fabs((1 + 0.8 * T[k]) / Z[k] - 1);
    compared++;
  }
  end(&s);
  if (points == 0) skip();
  near_to(error, expected / compared, 2e-3, 2e-3);
}

static void test_front(void **state)
{
  (void)state;
  if (no_truths()) skip();
  near_to(error_of_front(1), 0, 2e-3, 2e-3);
  near_to(error_of_front(1.05), 0.05, 2e-3, 2e-3);
  near_to(error_of_front(0.8), 0.2, 2e-3, 2e-3);
}

static void test_box_refuses(void **state)
{
  struct stage s = prepare(&benchmark_dam_break);
  (void)state;
  set_param(&s, "width", 2);
  refused(s.b->build(&s.scene, s.self), "its box");
  end(&s);
}

/* --- tank, free-fall, normal-impact --- */

static void test_tank(void **state)
{
  (void)state;
  struct stage s = built(&benchmark_tank);
  for (int i = 0; i < s.now.n; i++) {
    s.p[i] = (real)(9810 * (0.4 - (double)s.now.x[i].c[DIM - 1]));
    s.brute.v[i].c[0] = (real)(i % 2 ? 0.1 : -0.1);
  }
  const struct measures out = measured(&s);
  near_to(VALUE(out, pressure_error), 0, 1e-7, 1e-5);
  near_to(VALUE(out, residual_speed), 0.1 / sqrt(9.81 * 0.4), 1e-7, 1e-6);
  for (int i = 0; i < s.now.n; i++) s.p[i] *= (real)1.25;
  near_to(VALUE(measured(&s), pressure_error), 0.25, 1e-6, 1e-5);
  end(&s);
}

static void test_free_fall(void **state)
{
  (void)state;
  for (int lead = -1; lead <= 1; lead++) {
    struct stage s = prepare(&benchmark_free_fall);
    set_param(&s, "speed", 1.5);
    build(&s);
    const double t = 0.4, dt = 0.01;
    s.now.time = t;
    s.now.dt = dt;
    s.now.step = 40;
    for (int i = 0; i < s.now.n; i++) {
      s.brute.x[i].c[0] += (real)(1.5 * t);
      s.brute.x[i].c[DIM - 1] -= (real)(9.81 * t * (t + lead * dt) / 2);
      s.brute.v[i].c[DIM - 1] -= (real)(9.81 * t);
    }
    const struct measures out = measured(&s);
    const double fall = 9.81 * t * t / 2, moved = sqrt(fall * fall + 0.36);
    near_to(VALUE(out, trajectory_error), lead ? 0 : 9.81 * t * dt / 2 / moved, 1e-7, 1e-6);
    near_to(VALUE(out, velocity_error), 0, 1e-7, 1e-6);
    end(&s);
  }
}

static void test_normal_impact(void **state)
{
  (void)state;
  struct stage s = built(&benchmark_normal_impact);
  for (int i = 0; i < s.now.n; i++) s.brute.v[i].c[DIM - 1] *= (real)0.5;
  struct measures out = measured(&s);
  const double exact = DIM == 2 ? 0.5 : 1. / 3; /* half a cube: by symmetry */
  near_to(VALUE(out, energy_loss), 0.75, 1e-12, 1e-6);
  near_to(VALUE(out, orthogonality_defect), 0.5, 1e-12, 1e-6);
  if (!no_truths() || DIM == 3) near_to(VALUE(out, energy_loss_error), 0.75 - exact, 1e-6, 1e-6);
  for (int i = 0; i < s.now.n; i++) s.brute.v[i] = zero();
  out = measured(&s);
  near_to(VALUE(out, energy_loss), 1, 0, 0);
  near_to(VALUE(out, orthogonality_defect), 0, 0, 0);
  end(&s);
}

static void test_impact_in_space(void **state)
{
  (void)state;
  near_to(truth_impact_loss(1, 0.5, 1), 1. / 3, 1e-6, 1e-6);
  if (no_truths()) skip();
  near_to(truth_impact_loss(1, 0.5, 0), 0.5, 1e-15, 1e-15);
  /* a deep block is nearly plane; its two ends relieve about a third of a width's worth */
  near_to(truth_impact_loss(1, 0.5, 64), 0.5 * (1 - 0.341 / 64), 1e-4, 1e-4);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_all_build_and_measure),
    cmocka_unit_test(test_patch_start),
    cmocka_unit_test(test_patch_truth_is_no_error),
    cmocka_unit_test(test_patch_follows_the_outlines),
    cmocka_unit_test(test_first_step),
    cmocka_unit_test(test_first_step_pressure_projects),
    cmocka_unit_test(test_three_particles),
    cmocka_unit_test(test_column_pressure),
    cmocka_unit_test(test_front),
    cmocka_unit_test(test_front_between_samples),
    cmocka_unit_test(test_box_refuses),
    cmocka_unit_test(test_tank),
    cmocka_unit_test(test_free_fall),
    cmocka_unit_test(test_normal_impact),
    cmocka_unit_test(test_impact_in_space),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
