/* Semi-implicit SPH under gravity in a tank: what walls must do, and a soft fluid beside a stiff
 * one. */
#include "twin_solvers.h"

enum { ORDINARY, STILL, MIRRORED };
enum { OWN, COMMON };
enum { HIGH = DIM == 3 ? 8 : 16, WIDE = DIM == 3 ? 4 : 12, STEPS = DIM == 3 ? 250 : 500 };
static const double dx = 0.01, gravity = 9.81;

static struct scene tank(void)
{
  struct scene s;
  vec low = zero(), high, top;
  memset(&s, 0, sizeof s);
  s.common.spacing = dx, s.common.dt = 1e-3, s.common.t_end = 1, s.common.samples = 1;
  s.common.support = DIM == 3 ? 2 : 2.5, s.common.kernel = KERNEL_CUBIC, s.common.rho0 = 1000;
  for (int d = 0; d < DIM; d++) high.c[d] = (real)(dx * (d == DIM - 1 ? HIGH : WIDE));
  top = high;
  top.c[DIM - 1] += (real)(4 * dx);
  assert_int_equal(scene_fill_box(&s, low, high, zero(), NULL), OK);
  assert_int_equal(scene_wall_box(&s, low, top, scene_wall_layers(&s), 1), OK);
  scene_domain_around(&s, 1);
  s.gravity.c[DIM - 1] = (real)-gravity;
  return s;
}

struct rest {
  double pressure_error, speed;  /* relative to rho0 g depth (r.m.s.) and to sqrt(g H) */
  double lambda[2], pressure[2]; /* means over the lower half of the water, left and right */
};

static struct rest settle(const struct setting *settings)
{
  struct scene scene = tank();
  struct run *run;
  struct snapshot now;
  double values[64], wrong = 0, all = 0, v2 = 0, count[2] = {0, 0};
  struct rest rest = {0, 0, {0, 0}, {0, 0}};
  set_values(&solver_sisph, settings, values);
  assert_int_equal(run_create(&solver_sisph, values, &scene, 0, &run), OK);
  for (int k = 0; k < STEPS && !run->diverged; k++) assert_int_equal(run_step(run), OK);
  assert_false(run->diverged);
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int i = 0; i < now.n; i++) {
    const double y = (double)now.x[i].c[DIM - 1], p = (double)now.p[i];
    const double known = 1000 * gravity * fmax(HIGH * dx - y, 0);
    const int right = (double)now.x[i].c[0] > WIDE * dx / 2;
    wrong += (p - known) * (p - known), all += known * known;
    v2 += (double)inner(now.v[i], now.v[i]) / now.n;
    if (y > HIGH * dx / 2) continue;
    count[right]++;
    rest.lambda[right] += (double)now.rho[i] / 1000;
    rest.pressure[right] += p;
  }
  for (int k = 0; k < 2; k++) rest.lambda[k] /= count[k], rest.pressure[k] /= count[k];
  rest.pressure_error = sqrt(wrong / all);
  rest.speed = sqrt(v2 / (gravity * HIGH * dx));
  snapshot_free(&now);
  run_free(run);
  return rest;
}

/* Wall particles that press by their own compression hold the water at rest under its hydrostatic
 * pressure. Mirrored pressures are no gradient of an energy and keep it moving; with none at all
 * walls push back with half of it. */
static void test_walls(void **unused)
{
  (void)unused;
  static const char *const names[] = {"ordinary", "still", "mirrored"};
  struct rest rest[3];
  for (int walls = ORDINARY; walls <= MIRRORED; walls++) {
    const struct setting settings[] = {{"wall_pressure", walls}, {NULL, 0}};
    rest[walls] = settle(settings);
    print_message("%-9s pressure off by %.3f, speed %.4f\n", names[walls],
                  rest[walls].pressure_error, rest[walls].speed);
  }
  assert_true(rest[ORDINARY].pressure_error < (DIM == 2 ? 0.1 : 0.2));
  assert_true(rest[ORDINARY].speed < 0.03);
  for (int walls = STILL; walls <= MIRRORED; walls++) {
    assert_true(rest[walls].pressure_error > 3 * rest[ORDINARY].pressure_error);
    assert_true(rest[walls].speed > 3 * rest[ORDINARY].speed);
  }
}

static struct rest halves(int diagonal, int iterations)
{
  const struct setting settings[] = {
    {"split", WIDE * dx / 2},         {"K", 1e6}, {"stiff_ratio", 0.1}, {"diagonal", diagonal},
    {"fixed_iterations", iterations}, {NULL, 0}};
  const struct rest rest = settle(settings);
  print_message("diagonal %d, N %2d: lambda %.4f %.4f, p %.0f %.0f Pa, speed %.4f\n", diagonal,
                iterations, rest.lambda[0], rest.lambda[1], rest.pressure[0], rest.pressure[1],
                rest.speed);
  return rest;
}

/* The right half is ten times softer: it bears the same pressure p and is compressed by p/K of its
 * own. With few iterations each particle's own diagonal breaks the balance where K jumps, and the
 * water does not come to rest. */
static void test_soft_beside_stiff(void **unused)
{
  (void)unused;
  const struct rest good = halves(COMMON, 80), agitated = halves(OWN, 5);
  assert_true(fabs(good.pressure[1] / good.pressure[0] - 1) < 0.1);
  assert_true(fabs((good.lambda[1] - 1) / (good.pressure[1] / 1e5) - 1) < 0.25);
  assert_true(good.lambda[0] - 1 < 0.2 * (good.lambda[1] - 1));
  assert_true(good.speed < 0.03);
  assert_true(agitated.speed > 5 * good.speed);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_walls),
    cmocka_unit_test(test_soft_beside_stiff),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
