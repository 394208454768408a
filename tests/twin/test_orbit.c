/* Two particles bound by an equation of state: m = h = c = 1, cubic spline in 3-D, p = rho - rho0
 * with rho0 the density at r = 1, released at rest at r = 0.8. r(2) and r'(2) by quadrature, 1e-14
 * (analysis/reference, test_reference_motions.c). */
#include "../../core/base/memory.h"
#include "twin_solvers.h"

#define R_2 1.1749320787768974
#define RDOT_2 0.17422373827215577
#define RHO_0 0.397887357729738339

/* r and r' at t = 2 with steps of dt */
static void orbit(double dt, double *r, double *rdot)
{
  static struct cloud c;
  struct run *run;
  struct snapshot now;
  double values[64];
  const struct setting settings[] = {{"c", 1},     {"gamma", 1}, {"clamp", 2},
                                     {"alpha", 0}, {"cfl", 0.5}, {NULL, 0}};
  memset(&c, 0, sizeof c);
  c.n = c.n_all = 2;
  c.dx = 0.8; /* of the cloud's support R = 2.5 dx = 2 */
  c.dt = dt;
  c.rho0 = RHO_0;
  c.kernel = kernel_make(KERNEL_CUBIC, 2, DIM);
  c.x[1][0] = 0.8;
  struct scene scene = cloud_scene(&c);
  set_values(&solver_wcsph, settings, values);
  assert_int_equal(run_create(&solver_wcsph, values, &scene, 0, &run), OK);
  const real one[2] = {1, 1};
  memory_from_host(run->view->p.m, one, sizeof one);
  run->view->mass = 1;
  for (long k = 0; k < lround(2 / dt); k++) assert_int_equal(run_step(run), OK);
  assert_false(run->diverged);
  assert_int_equal(run_snapshot(run, &now), OK);
  *r = fabs((double)now.x[0].c[0] - (double)now.x[1].c[0]);
  *rdot = fabs((double)now.v[0].c[0] - (double)now.v[1].c[0]);
  snapshot_free(&now);
  run_free(run);
}

static void the_pair_follows_its_orbit(void **unused)
{
  (void)unused;
  double r, rdot, fine, rdot_fine;
  if (DIM == 2 || sizeof(real) == 4) skip();
  orbit(2e-3, &r, &rdot);
  orbit(1e-3, &fine, &rdot_fine);
  print_message("r(2) is wrong by %.2g and %.2g, r' by %.2g and %.2g\n", r - R_2, fine - R_2,
                rdot - RDOT_2, rdot_fine - RDOT_2);
  assert_true(fabs(fine - R_2) < 1e-3 && fabs(rdot_fine - RDOT_2) < 1e-6);
  /* the step is a leapfrog whose positions are those of half a step before */
  assert_true(fabs((r - R_2) / (fine - R_2) - 2) < 0.05);
  assert_true(fabs((rdot - RDOT_2) / (rdot_fine - RDOT_2) - 4) < 0.5);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_pair_follows_its_orbit)};
  return cmocka_run_group_tests_name("orbit " SPHBENCH_VARIANT, tests, NULL, NULL);
}
