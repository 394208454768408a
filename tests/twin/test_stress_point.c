/* Stress points carried by their particles, against the projection by double loops (Liu et al.
 * 2024, Sec. 6.4), with the matrix written out. */
#include "twin_dual.h"

enum { PAIR, CORNER, EDGES, NUM_ARRANGEMENTS };

/* offsets of a particle's stress points [dx] */
static double offset(int arrangement, int k, int d)
{
  switch (arrangement) {
  case PAIR: return k ? -0.25 : 0.25;
  case CORNER: return 0.5;
  default: return k == d ? 0.5 : 0;
  }
}

static void generate(const struct cloud *c, const struct choices *o)
{
  s.n = 0;
  for (int i = 0; i < c->n_all; i++)
    for (int k = 0; k < o->each; k++, s.n++)
      for (int d = 0; d < DIM; d++) s.X[s.n][d] = c->x[i][d] + c->dx * offset(o->strategy, k, d);
}

/* Eq. (15), full lattice of particles with their stress points, seen from the first one */
static double alpha_zero(const struct cloud *c, const struct choices *o)
{
  double total = 0;
  for (int a = -4; a <= 4; a++)
    for (int b = -4; b <= 4; b++)
      for (int e = DIM == 3 ? -4 : 0; e <= (DIM == 3 ? 4 : 0); e++)
        for (int k = 0; k < o->each; k++) {
          const int cell[3] = {a, b, e};
          double r2 = 0;
          for (int d = 0; d < DIM; d++)
            r2 += pow(cell[d] + offset(o->strategy, k, d) - offset(o->strategy, 0, d), 2);
          const double r = c->dx * sqrt(r2);
          if (r > 0) total -= dW_at(c, r) / r;
        }
  return 2 / c->rho0 * c->mass / c->rho0 / o->each * total;
}

static void compare(const struct choices *o, int walls, unsigned long long seed)
{
  static struct cloud a, b;
  cloud_make(&a, DIM == 2 ? 11 : 6, walls, KERNEL_CUBIC, seed);
  a.xsph = (double)(real)0.05;
  b = a;
  const struct setting settings[] = {{"arrangement", o->strategy},
                                     {"volume", o->saturated},
                                     {"gradient", o->adjoint},
                                     {"kappa", o->kappa},
                                     {"density", o->density == DENSITY_REAL},
                                     {"tolerance", 1e-14},
                                     {"fixed_iterations", o->iterations},
                                     {NULL, 0}};
  cloud_run(&a, &solver_stress_point, settings, 1);
  twin_step(&b, o);
  assert_same_cloud(&a, &b, o->iterations ? 1 : 2);
}

static const int each[NUM_ARRANGEMENTS] = {2, 1, DIM};

/* Four iterations of CG, which rounding cannot hide: everything but the end of the solve. */
static void one_step(void **unused)
{
  (void)unused;
  for (int arrangement = PAIR; arrangement <= EDGES; arrangement++)
    for (int form = 0; form < 4; form++)
      for (int walls = 0; walls < 2; walls++) {
        const struct choices o = {arrangement,
                                  form & 1,
                                  form >> 1,
                                  form & 1 ? DENSITY_REAL : DENSITY_VIRTUAL,
                                  4,
                                  each[arrangement],
                                  (double)(real)0.1,
                                  0};
        print_message("arrangement %d, form %d, %s\n", arrangement, form, walls ? "walls" : "free");
        compare(&o, walls, 11 + (unsigned long long)form);
      }
}

#ifndef REAL_IS_FLOAT
/* Converged CG against elimination: the weighted inner product solves the printed, unsymmetric
 * system. */
static void converged_step(void **unused)
{
  (void)unused;
  for (int arrangement = PAIR; arrangement <= EDGES; arrangement++) {
    const struct choices o = {arrangement, 1, 0, DENSITY_REAL, 0, each[arrangement], 0.1, 0};
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
  const int failed =
    cmocka_run_group_tests_name("stress-point twin " SPHBENCH_VARIANT, tests, NULL, NULL);
  free(A);
  return failed;
}
