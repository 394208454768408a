/* The dual-particle strategies against their formulas by double loops (Liu et al. 2024), with the
 * matrix written out. */
#include "twin_dual.h"

enum { SA, SB, SC };

/* S.B: five PBF iterations on copies of the fluid */
static void even_out(const struct cloud *c)
{
  static double lambda[TWIN_MOST], shift[TWIN_MOST][DIM];
  memset(lambda, 0, sizeof lambda);
  static char close[TWIN_MOST][TWIN_MOST]; /* pairs as they were at the real particles */
  for (int i = 0; i < c->n_all; i++)
    for (int j = 0; j < c->n_all; j++) close[i][j] = twin_distance(c, i, j) < (double)c->kernel.R;
  for (int k = 0; k < 5; k++) {
    for (int i = 0; i < c->n; i++) {
      double rho = 0, squares = 0, own[DIM] = {0};
      for (int j = 0; j < c->n_all; j++) {
        const double r = between(s.X[i], s.X[j]);
        if (!close[i][j]) continue;
        rho += c->mass * W_at(c, r);
        for (int d = 0; d < DIM && r > 0; d++) {
          const double g = c->mass / c->rho0 * dW_at(c, r) * (s.X[i][d] - s.X[j][d]) / r;
          own[d] += g;
          squares += g * g;
        }
      }
      for (int d = 0; d < DIM; d++) squares += own[d] * own[d];
      lambda[i] = -fmax(rho / c->rho0 - 1, 0) / (squares + 1e-6 / (c->dx * c->dx));
    }
    memset(shift, 0, sizeof shift);
    for (int i = 0; i < c->n; i++)
      for (int j = 0; j < c->n_all; j++) {
        const double r = between(s.X[i], s.X[j]);
        for (int d = 0; d < DIM && r > 0 && close[i][j]; d++)
          shift[i][d] +=
            (lambda[i] + lambda[j]) * c->mass / c->rho0 * dW_at(c, r) * (s.X[i][d] - s.X[j][d]) / r;
      }
    for (int i = 0; i < c->n; i++)
      for (int d = 0; d < DIM; d++) s.X[i][d] += shift[i][d];
  }
}

/* S.C: is the node at `k` within the stencil of particle i's nearest node? */
static int in_stencil(const struct cloud *c, int i, const int *k)
{
  int others = 0, far = 0;
  for (int d = 0; d < DIM; d++) {
    const int off = abs(k[d] - (int)rint(c->x[i][d] / c->dx));
    others += off != 0;
    far = off > far ? off : far;
  }
  return far <= 1 || (far == 2 && others == 1);
}

static void nodes(const struct cloud *c)
{
  const int reach = 16;
  int k[3];
  s.n = 0;
  for (k[0] = -reach; k[0] <= reach; k[0]++)
    for (k[1] = -reach; k[1] <= reach; k[1]++)
      for (k[2] = DIM == 3 ? -reach : 0; k[2] <= (DIM == 3 ? reach : 0); k[2]++) {
        int found = 0;
        for (int i = 0; i < c->n_all && !found; i++) found = in_stencil(c, i, k);
        if (!found) continue;
        assert_true(s.n < MOST_VIRTUAL);
        for (int d = 0; d < DIM; d++) s.X[s.n][d] = c->dx * k[d];
        s.n++;
      }
}

static void generate(const struct cloud *c, const struct choices *o)
{
  if (o->strategy == SC) {
    nodes(c);
    return;
  }
  s.n = c->n_all;
  memcpy(s.X, c->x, sizeof(double) * DIM * (size_t)c->n_all);
  if (o->strategy == SB) even_out(c);
}

/* Eq. (15), full lattice */
static double alpha_zero(const struct cloud *c, const struct choices *o)
{
  (void)o;
  double total = 0;
  for (int a = -4; a <= 4; a++)
    for (int b = -4; b <= 4; b++)
      for (int e = DIM == 3 ? -4 : 0; e <= (DIM == 3 ? 4 : 0); e++) {
        const double r = c->dx * sqrt((double)(a * a + b * b + e * e));
        if (r > 0) total -= dW_at(c, r) / r;
      }
  return 2 / c->rho0 * c->mass / c->rho0 * total;
}

static const struct solver *const strategies[] = {&solver_dual_sa, &solver_dual_sb,
                                                  &solver_dual_sc};

static int density_of(int strategy, int at_real)
{
  return strategy == SB              ? DENSITY_COPIED
         : strategy == SC && at_real ? DENSITY_REAL
                                     : DENSITY_VIRTUAL;
}

static void compare(const struct choices *o, int walls, unsigned long long seed)
{
  static struct cloud a, b;
  cloud_make(&a, DIM == 2 ? 11 : 6, walls, KERNEL_CUBIC, seed);
  a.xsph = (double)(real)0.05;
  b = a;
  const struct setting settings[] = {
    {"volume", o->saturated},
    {"gradient", o->adjoint},
    {"kappa", o->kappa},
    {"tolerance", 1e-14},
    {"fixed_iterations", o->iterations},
    {o->strategy == SC ? "density" : NULL, o->density == DENSITY_REAL},
    {NULL, 0}};
  cloud_run(&a, strategies[o->strategy], settings, 1);
  twin_step(&b, o);
  assert_same_cloud(&a, &b, o->iterations ? 1 : 2);
}

/* Four iterations of CG, which rounding cannot hide: everything but the end of the solve. */
static void one_step(void **unused)
{
  (void)unused;
  for (int strategy = SA; strategy <= SC; strategy++)
    for (int form = 0; form < 4; form++)
      for (int walls = 0; walls < 2; walls++) {
        const struct choices o = {
          strategy, form & 1, form >> 1,         density_of(strategy, form & 1),
          4,        1,        (double)(real)0.1, strategy != SC};
        print_message("%s, form %d, %s\n", strategies[strategy]->name, form,
                      walls ? "walls" : "free");
        compare(&o, walls, 11 + (unsigned long long)form);
      }
}

#ifndef REAL_IS_FLOAT
/* Converged CG against elimination: the weighted inner product solves the printed, unsymmetric
 * system. */
static void converged_step(void **unused)
{
  (void)unused;
  for (int strategy = SA; strategy <= SC; strategy++) {
    const struct choices o = {strategy, 1, 0, density_of(strategy, 1), 0, 1, 0.1, strategy != SC};
    compare(&o, 1, 5);
  }
}
#endif

int main(void)
{
  A = malloc(sizeof(double) * MOST_VIRTUAL * (size_t)MOST_VIRTUAL);
  if (!A) return 77;
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(one_step),
#ifndef REAL_IS_FLOAT
    cmocka_unit_test(converged_step),
#endif
  };
  const int failed = cmocka_run_group_tests_name("dual twin " SPHBENCH_VARIANT, tests, NULL, NULL);
  free(A);
  return failed;
}
