/* Position Based Fluids against its formulas by double loops (Macklin & Mueller 2013). */
#include "twin_solvers.h"

struct choices {
  int iterations, free_, scorr_n;
  double epsilon, scorr_k, scorr_dq;
};

/* Alg. 1, lines 5-7: who is near whom at the predicted positions; kept while they move */
static char near[TWIN_MOST][TWIN_MOST];
static void twin_neighbours(const struct cloud *c)
{
  for (int i = 0; i < c->n; i++)
    for (int j = 0; j < c->n_all; j++) near[i][j] = twin_distance(c, i, j) < (double)c->kernel.R;
}

/* Eq. (1), (2), (7), (8), (11) for one particle, with masses */
static double twin_lambda(struct cloud *c, const struct choices *o, int i)
{
  double rho = 0, gradients = 0, own[DIM] = {0};
  for (int j = 0; j < c->n_all; j++) {
    if (!near[i][j]) continue;
    double other = 0;
    rho += c->mass * twin_W(c, i, j);
    for (int d = 0; d < DIM; d++) {
      const double g = c->mass / c->rho0 * twin_grad(c, i, j, d);
      own[d] += g;
      other += g * g;
    }
    gradients += c->light[j] * other;
  }
  for (int d = 0; d < DIM; d++) gradients += c->light[i] * own[d] * own[d];
  c->rho[i] = rho;
  const double lambda = -(rho / c->rho0 - 1) / (gradients + o->epsilon / (c->dx * c->dx));
  return lambda > 0 && !o->free_ ? 0 : lambda;
}

/* Eq. (12) - (14) */
static void twin_shift(const struct cloud *c, const struct choices *o, const double *lambda, int i,
                       double *shift)
{
  const double W_dq = (double)kernel_W(&c->kernel, (real)(o->scorr_dq * (double)c->kernel.R), DIM);
  for (int d = 0; d < DIM; d++) shift[d] = 0;
  for (int j = 0; j < c->n_all; j++) {
    if (!near[i][j]) continue;
    const double scorr = -o->scorr_k * c->dx * c->dx * pow(twin_W(c, i, j) / W_dq, o->scorr_n);
    const double strength = lambda[i] + (j < c->n ? lambda[j] : 0) + scorr;
    for (int d = 0; d < DIM; d++)
      shift[d] += c->light[i] * c->mass / c->rho0 * strength * twin_grad(c, i, j, d);
  }
}

/* Algorithm 1, with v = (x* - x)/dt from the old positions */
static void twin_step(struct cloud *c, const struct choices *o)
{
  static double old[TWIN_MOST][DIM], shift[TWIN_MOST][DIM], lambda[TWIN_MOST];
  memcpy(old, c->x, sizeof old);
  memset(c->p, 0, sizeof c->p);
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) {
      c->v[i][d] += c->dt * c->gravity[d];
      c->x[i][d] += c->dt * c->v[i][d];
    }
  twin_neighbours(c);
  for (int k = 0; k < o->iterations; k++) {
    for (int i = 0; i < c->n; i++) lambda[i] = twin_lambda(c, o, i);
    for (int i = 0; i < c->n; i++) twin_shift(c, o, lambda, i, shift[i]);
    for (int i = 0; i < c->n; i++) {
      c->p[i] -= c->rho0 * lambda[i] / (c->dt * c->dt);
      for (int d = 0; d < DIM; d++) c->x[i][d] += shift[i][d];
    }
  }
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] = (c->x[i][d] - old[i][d]) / c->dt;
  for (int i = 0; i < c->n; i++) twin_lambda(c, o, i); /* for rho at the last positions */
  if (c->xsph > 0) twin_viscosity(c, near);
}

static int mixed; /* two fluids in the next comparison */

static void compare(int side, int walls, int kernel, double xsph, int steps, struct choices o)
{
  static struct cloud run, twin;
  const struct setting settings[] = {
    {"fixed_iterations", o.iterations},
    {"clamp", o.free_},
    {"epsilon", o.epsilon},
    {"scorr_k", o.scorr_k},
    {"scorr_n", o.scorr_n},
    {"scorr_dq", o.scorr_dq},
    {NULL, 0},
  };
  cloud_make(&run, side, walls, kernel, 7 + (unsigned long long)walls);
  run.xsph = (double)(real)xsph;
  if (mixed) cloud_mix(&run);
  twin = run;
  cloud_run(&run, &solver_pbf, settings, steps);
  for (int k = 0; k < steps; k++) twin_step(&twin, &o);
  assert_same_cloud(&run, &twin, steps);
}

enum { SIDE = DIM == 3 ? 6 : 13 };

static void test_free_fluid(void **unused)
{
  (void)unused;
  compare(SIDE, 0, KERNEL_CUBIC, 0, 1, (struct choices){3, 0, 4, 0.5, 0, 0.25});
}
static void test_walls(void **unused)
{
  (void)unused;
  compare(SIDE, 1, KERNEL_WENDLAND2, 0, 1, (struct choices){3, 0, 4, 0.5, 0, 0.25});
}
static void test_two_fluids(void **unused)
{
  (void)unused;
  mixed = 1;
  compare(SIDE, 1, KERNEL_CUBIC, 0, 1, (struct choices){3, 0, 4, 0.5, 0, 0.25});
  mixed = 0;
}
static void test_adsorption(void **unused)
{
  (void)unused;
  compare(SIDE, 1, KERNEL_CUBIC, 0, 1, (struct choices){4, 1, 4, 0.5, 0, 0.25});
}
static void test_artificial_pressure(void **unused)
{
  (void)unused;
  compare(SIDE, 1, KERNEL_SPIKY, 0, 1, (struct choices){2, 1, 3, 0.75, 0.0078125, 0.375});
}
static void test_two_steps_with_viscosity(void **unused)
{
  (void)unused;
  compare(SIDE, 0, KERNEL_WENDLAND4, 0.05, 2, (struct choices){2, 0, 4, 0.5, 0, 0.25});
}

/* By tolerance, the mean compression max(C, 0) is just below it, among the neighbours of the
 * predicted positions. (Newcomers, who are near only at the last ones, compress a little more.) */
static void test_tolerance(void **unused)
{
  (void)unused;
  static struct cloud c;
  const double tolerance = sizeof(real) == 4 ? 1e-4 : 1e-6;
  const struct setting settings[] = {{"tolerance", tolerance}, {"max_iterations", 1e5}, {NULL, 0}};
  cloud_make(&c, SIDE, 1, KERNEL_CUBIC, 13);
  cloud_run(&c, &solver_pbf, settings, 1);
  double mean = 0;
  for (int i = 0; i < c.n; i++) mean += fmax(c.rho[i] / c.rho0 - 1, 0) / c.n;
  if (getenv("TWIN_SHOW")) print_message("compression left: %.3g of %.3g\n", mean, tolerance);
  assert_true(mean < tolerance * (1 + 1e-3));
  assert_true(mean > 0.1 * tolerance);
}

/* A particle alone falls freely; nothing divides by its vanishing gradients. */
static void test_alone(void **unused)
{
  (void)unused;
  static struct cloud c;
  const struct setting settings[] = {{"clamp", 1}, {"epsilon", 0.5}, {NULL, 0}};
  cloud_make(&c, 2, 0, KERNEL_CUBIC, 3);
  c.n = c.n_all = 1;
  const double v = c.v[0][DIM - 1], x = c.x[0][DIM - 1];
  cloud_run(&c, &solver_pbf, settings, 3);
  assert_true(fabs(c.v[0][DIM - 1] - (v + 3 * c.dt * c.gravity[DIM - 1])) < TWIN_TOLERANCE);
  assert_true(fabs(c.x[0][DIM - 1] - (x + 3 * c.dt * v + 6 * c.dt * c.dt * c.gravity[DIM - 1])) <
              TWIN_TOLERANCE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_free_fluid),          cmocka_unit_test(test_walls),
    cmocka_unit_test(test_two_fluids),          cmocka_unit_test(test_adsorption),
    cmocka_unit_test(test_artificial_pressure), cmocka_unit_test(test_two_steps_with_viscosity),
    cmocka_unit_test(test_tolerance),           cmocka_unit_test(test_alone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
