/* Divergence-free SPH against its formulas by double loops (Bender & Koschier 2017), with kappa and
 * alpha as printed. */
#include "../../core/sph/lattice.h"
#include "twin_solvers.h"

enum { CLAMPED, FREE, EACH };
struct choices {
  int iterations, clamp;
  double warm, relaxation;
  int dense;
};

static double alpha[TWIN_MOST], kappa[TWIN_MOST],
  kappa_v[TWIN_MOST]; /* of Eq. (11), Alg. 3 and Alg. 2 */

/* Eq. (11) */
static void twin_factors(const struct cloud *c)
{
  for (int i = 0; i < c->n; i++) {
    double below = 0, own[DIM] = {0};
    for (int j = 0; j < c->n_all; j++)
      for (int d = 0; d < DIM; d++) {
        const double g = c->mass * twin_grad(c, i, j, d);
        own[d] += g;
        below += c->light[j] * g * g;
      }
    for (int d = 0; d < DIM; d++) below += c->light[i] * own[d] * own[d];
    alpha[i] = c->rho[i] / below;
  }
}

/* Eq. (12) */
static void twin_push(struct cloud *c, const double *k)
{
  static double change[TWIN_MOST][DIM];
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) {
      change[i][d] = 0;
      for (int j = 0; j < c->n_all; j++)
        change[i][d] -= c->light[i] * c->dt * c->mass *
                        (k[i] / c->rho[i] + (j < c->n ? k[j] / c->rho[j] : 0)) *
                        twin_grad(c, i, j, d);
    }
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += change[i][d];
}

/* Drho_i/Dt */
static double twin_rate(const struct cloud *c, int i)
{
  double rate = 0;
  for (int j = 0; j < c->n_all; j++)
    for (int d = 0; d < DIM; d++)
      rate += c->mass * (c->v[i][d] - c->v[j][d]) * twin_grad(c, i, j, d);
  return rate;
}

/* The total kappa_i that the error asks for: >= 0 against rho0; if free, <= 0 against falling below
 * min(rho_i, rho0). With `divergence` both errors are that of Drho/Dt alone. `each`: a total that
 * only grows. */
static double twin_total(const struct cloud *c, const struct choices *o, int i, double total,
                         int divergence)
{
  const double theta = o->relaxation, predicted = c->rho[i] + c->dt * twin_rate(c, i);
  const double kept = o->dense ? fmax(c->rho[i], c->rho0) : c->rho[i];
  const double ceiling = divergence ? kept : c->rho0;
  const double floor_ = divergence ? c->rho[i] : fmin(c->rho[i], c->rho0);
  const double up = total + theta * (predicted - ceiling) * alpha[i] / (c->dt * c->dt);
  const double down = total + theta * (predicted - floor_) * alpha[i] / (c->dt * c->dt);
  if (o->clamp == EACH) return fmax(up, total);
  if (up > 0) return up;
  return o->clamp == FREE && down < 0 ? down : 0;
}

static void twin_solve(struct cloud *c, const struct choices *o, double *total, int divergence)
{
  static double change[TWIN_MOST];
  for (int i = 0; i < c->n; i++) total[i] *= o->warm;
  twin_push(c, total);
  for (int k = 0; k < o->iterations; k++) {
    for (int i = 0; i < c->n; i++) change[i] = twin_total(c, o, i, total[i], divergence) - total[i];
    for (int i = 0; i < c->n; i++) total[i] += change[i];
    twin_push(c, change);
  }
}

/* Algorithm 1. The solver keeps totals as kappa/rho, so a warm start carries these over to the new
 * density. */
static void twin_step(struct cloud *c, const struct choices *o)
{
  static double before[TWIN_MOST];
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += c->dt * c->gravity[d];
  if (c->xsph > 0) twin_viscosity(c, NULL);
  twin_solve(c, o, kappa, 0);
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->x[i][d] += c->dt * c->v[i][d];
  memcpy(before, c->rho, sizeof before);
  twin_density(c);
  twin_factors(c);
  for (int i = 0; i < c->n; i++) {
    kappa[i] *= c->rho[i] / before[i];
    kappa_v[i] *= c->rho[i] / before[i];
  }
  twin_solve(c, o, kappa_v, 1);
  for (int i = 0; i < c->n; i++) c->p[i] = c->rho[i] * (kappa[i] + kappa_v[i]);
}

static void twin_start(struct cloud *c)
{
  memset(kappa, 0, sizeof kappa);
  memset(kappa_v, 0, sizeof kappa_v);
  twin_density(c);
  twin_factors(c);
}

enum { SIDE = DIM == 3 ? 6 : 13 };

static int mixed; /* two fluids in the next comparison */

static void compare(int walls, int kernel, double xsph, int steps, struct choices o)
{
  static struct cloud run, twin;
  const struct setting settings[] = {
    {"fixed_iterations", o.iterations},
    {"clamp", o.clamp},
    {"relaxation", o.relaxation},
    {"warm_density", o.warm},
    {"warm_divergence", o.warm},
    {"divergence_of", o.dense},
    {NULL, 0},
  };
  cloud_make(&run, SIDE, walls, kernel, 11 + (unsigned long long)walls);
  run.xsph = (double)(real)xsph;
  if (mixed) cloud_mix(&run);
  twin = run;
  cloud_run(&run, &solver_dfsph, settings, steps);
  twin_start(&twin);
  for (int k = 0; k < steps; k++) twin_step(&twin, &o);
  assert_same_cloud(&run, &twin, steps);
}

static void test_free_fluid(void **unused)
{
  (void)unused;
  compare(0, KERNEL_CUBIC, 0, 1, (struct choices){3, CLAMPED, 0, 0.375, 0});
}
static void test_walls(void **unused)
{
  (void)unused;
  compare(1, KERNEL_WENDLAND2, 0, 1, (struct choices){3, CLAMPED, 1, 0.375, 0});
}
static void test_unclamped(void **unused)
{
  (void)unused;
  compare(1, KERNEL_CUBIC, 0, 1, (struct choices){4, FREE, 1, 0.25, 0});
}
static void test_warm_start(void **unused)
{
  (void)unused;
  compare(1, KERNEL_SPIKY, 0, 3, (struct choices){2, CLAMPED, 1, 0.375, 0});
  compare(0, KERNEL_CUBIC, 0, 3, (struct choices){2, FREE, 1, 0.375, 0});
}
static void test_divergence_of_the_dense(void **unused)
{
  (void)unused;
  compare(1, KERNEL_CUBIC, 0, 2, (struct choices){3, CLAMPED, 1, 0.375, 1});
  compare(0, KERNEL_SPIKY, 0, 2, (struct choices){3, FREE, 1, 0.25, 1});
}
static void test_two_fluids(void **unused)
{
  (void)unused;
  mixed = 1;
  compare(0, KERNEL_CUBIC, 0, 1, (struct choices){3, CLAMPED, 1, 0.375, 0});
  compare(1, KERNEL_WENDLAND2, 0, 2, (struct choices){3, FREE, 1, 0.25, 0});
  mixed = 0;
}
static void test_clamp_of_each_iteration(void **unused)
{
  (void)unused;
  compare(1, KERNEL_CUBIC, 0, 2, (struct choices){3, EACH, 0.5, 1, 0});
}
static void test_viscosity(void **unused)
{
  (void)unused;
  compare(0, KERNEL_WENDLAND4, 0.05, 2, (struct choices){2, CLAMPED, 1, 0.5, 0});
}

/* The projection is Alg. 2 alone, and p = rho kappa^v. */
static void test_projection(void **unused)
{
  (void)unused;
  static struct cloud run, twin;
  const struct choices o = {5, FREE, 1, 0.375, 0};
  const struct setting settings[] = {
    {"fixed_iterations", 5}, {"clamp", FREE}, {"relaxation", 0.375}, {NULL, 0}};
  cloud_make(&run, SIDE, 0, KERNEL_CUBIC, 5);
  twin = run;
  cloud_run(&run, &solver_dfsph, settings, 0);
  twin_start(&twin);
  twin_solve(&twin, &o, kappa_v, 1);
  for (int i = 0; i < twin.n; i++) twin.p[i] = twin.rho[i] * kappa_v[i];
  assert_same_cloud(&run, &twin, 1);
}

/* The default relaxation. With only the 2 DIM nearest neighbours the stiffest mode is sin(k dx) = 1
 * on every axis, where |sum sin grad W|^2 / sum |grad W|^2 = DIM (2 W')^2 / (2 DIM W'^2) = 2. */
static void test_default_relaxation(void **unused)
{
  (void)unused;
  static struct cloud run, twin;
  const struct kernel near = kernel_make(KERNEL_CUBIC, (real)1.2, DIM);
  assert_true(fabs(lattice_stiffest(&near, 1) - 2) < 1e-6);
  const struct setting by_default[] = {{"fixed_iterations", 2}, {NULL, 0}};
  cloud_make(&run, SIDE, 0, KERNEL_CUBIC, 9);
  twin = run;
  const struct choices o = {2, CLAMPED, 1,
                            (double)(real)(1.4 / lattice_stiffest(&run.kernel, run.dx)), 0};
  cloud_run(&run, &solver_dfsph, by_default, 1);
  twin_start(&twin);
  twin_step(&twin, &o);
  assert_same_cloud(&run, &twin, 1);
}

/* By tolerance, the mean rate of compression that is left is below it: dt/rho0 <max(Drho/Dt, 0)> */
static void test_tolerance(void **unused)
{
  (void)unused;
  static struct cloud c;
  const double tolerance = sizeof(real) == 4 ? 1e-5 : 1e-8;
  const struct setting settings[] = {
    {"divergence_tolerance", tolerance}, {"max_iterations", 1e5}, {NULL, 0}};
  cloud_make(&c, SIDE, 1, KERNEL_CUBIC, 13);
  cloud_run(&c, &solver_dfsph, settings, 1);
  double mean = 0;
  for (int i = 0; i < c.n; i++) mean += c.dt / c.rho0 * fmax(twin_rate(&c, i), 0) / c.n;
  if (getenv("TWIN_SHOW")) print_message("compression left: %.3g of %.3g\n", mean, tolerance);
  assert_true(mean < tolerance * (1 + 1e-3));
  assert_true(mean > 0.1 * tolerance);
}

/* A particle alone falls freely: D_i = 0 is no division by zero. */
static void test_alone(void **unused)
{
  (void)unused;
  static struct cloud c;
  const struct setting settings[] = {{"clamp", FREE}, {NULL, 0}};
  cloud_make(&c, 2, 0, KERNEL_CUBIC, 3);
  c.n = c.n_all = 1;
  const double v = c.v[0][DIM - 1], x = c.x[0][DIM - 1];
  cloud_run(&c, &solver_dfsph, settings, 3);
  assert_true(fabs(c.v[0][DIM - 1] - (v + 3 * c.dt * c.gravity[DIM - 1])) < TWIN_TOLERANCE);
  assert_true(fabs(c.x[0][DIM - 1] - (x + 3 * c.dt * v + 6 * c.dt * c.dt * c.gravity[DIM - 1])) <
              TWIN_TOLERANCE);
}

/* Two particles that approach at a distance of 0.999 R: the floor of D_i leaves them nearly as fast
 * as they were, where alpha alone would stop them. */
static void test_barely_touching(void **unused)
{
  (void)unused;
  static struct cloud c;
  const struct setting settings[] = {{"fixed_iterations", 50}, {NULL, 0}};
  cloud_make(&c, 2, 0, KERNEL_CUBIC, 3);
  c.n = c.n_all = 2;
  memset(c.x, 0, sizeof c.x);
  memset(c.v, 0, sizeof c.v);
  memset(c.gravity, 0, sizeof c.gravity);
  c.x[1][0] = 0.999 * (double)c.kernel.R;
  c.v[0][0] = 1e-3, c.v[1][0] = -1e-3;
  cloud_run(&c, &solver_dfsph, settings, 1);
  assert_true(c.v[0][0] > 0.9e-3 && c.v[0][0] < 1.001e-3);
  assert_true(fabs(c.v[0][0] + c.v[1][0]) < TWIN_TOLERANCE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_free_fluid),
    cmocka_unit_test(test_walls),
    cmocka_unit_test(test_unclamped),
    cmocka_unit_test(test_warm_start),
    cmocka_unit_test(test_divergence_of_the_dense),
    cmocka_unit_test(test_two_fluids),
    cmocka_unit_test(test_clamp_of_each_iteration),
    cmocka_unit_test(test_viscosity),
    cmocka_unit_test(test_projection),
    cmocka_unit_test(test_default_relaxation),
    cmocka_unit_test(test_tolerance),
    cmocka_unit_test(test_alone),
    cmocka_unit_test(test_barely_touching),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
