/* The pressure systems of the solvers that use conjugate gradients, as they stand in a step of
 * theirs, solved by others: LAPACK's Cholesky factors of the matrix written out and SUNDIALS' CG.
 * The linker lets __wrap_cg_solve_to see every call of cg_solve_to. */
#include "../../analysis/reference/reference.h"
#include "../../core/linear/cg.h"
#include "twin_solvers.h"

struct cg_result __real_cg_solve_to(struct cg *s, double tolerance, double excess,
                                    int max_iterations);
struct cg_result __wrap_cg_solve_to(struct cg *s, double tolerance, double excess,
                                    int max_iterations);

/* Row i is coupled to none: with b_i = 0 CG keeps x_i = 0 there, whatever other rows say */
static int alone(const struct cg *s, int i)
{
  for (int slot = s->rows.first[i]; slot < s->rows.last[i]; slot++)
    if (s->coef[slot] != 0) return 0;
  assert_true(s->b[i] == 0 && s->x[i] == 0);
  return 1;
}

/* sqrt(w_i) A_ij/sqrt(w_j), symmetric where A is in the inner product of weights w; rows in CSR */
static struct caught {
  int n, entries, *first, *column;
  double *coef, *diag, *root, *b, *x, *by_cg;
  double tolerance;
  int iterations;
} caught;

static void times_matrix(const double *x, double *y, void *unused)
{
  (void)unused;
  const struct caught *c = &caught;
  for (int i = 0; i < c->n; i++) {
    double sum = c->diag[i] * x[i];
    for (int k = c->first[i]; k < c->first[i + 1]; k++)
      sum -= c->root[i] * c->coef[k] / c->root[c->column[k]] * x[c->column[k]];
    y[i] = sum;
  }
}
static const struct reference_system symmetric = {0, times_matrix, NULL};

static void *numbers(int n) { return calloc((size_t)n + 1, sizeof(double)); }

static void take_matrix(const struct cg *s)
{
  struct caught *c = &caught;
  c->n = s->n;
  c->entries = 0;
  for (int i = 0; i < s->n; i++) c->entries += s->rows.last[i] - s->rows.first[i];
  c->first = numbers(c->n), c->column = numbers(c->entries), c->coef = numbers(c->entries);
  c->diag = numbers(c->n), c->root = numbers(c->n), c->b = numbers(c->n), c->x = numbers(c->n);
  c->by_cg = numbers(c->n);
  int k = 0;
  for (int i = 0; i < s->n; i++) {
    c->diag[i] = (double)s->diag[i];
    c->root[i] = sqrt((double)s->weight[i]);
    c->b[i] = c->root[i] * (double)s->b[i];
    c->x[i] = c->root[i] * (double)s->x[i];
    for (int slot = s->rows.first[i]; slot < s->rows.last[i]; slot++)
      if (s->rows.list[slot] < s->n && !alone(s, s->rows.list[slot])) {
        c->column[k] = s->rows.list[slot];
        c->coef[k++] = (double)s->coef[slot];
      }
    c->first[i + 1] = k;
  }
}
static void let_go(void)
{
  free(caught.first), free(caught.column), free(caught.coef), free(caught.diag);
  free(caught.root), free(caught.b), free(caught.x), free(caught.by_cg);
  memset(&caught, 0, sizeof caught);
}

/* The first system only */
struct cg_result __wrap_cg_solve_to(struct cg *s, double tolerance, double excess,
                                    int max_iterations)
{
  const int first = caught.n == 0;
  if (first) take_matrix(s);
  const struct cg_result result = __real_cg_solve_to(s, tolerance, excess, max_iterations);
  if (first) {
    caught.iterations = result.iterations;
    caught.tolerance = tolerance;
    for (int i = 0; i < s->n; i++) caught.by_cg[i] = caught.root[i] * (double)s->x[i];
  }
  return result;
}

/* sqrt(e.A e / x.A x), e = y - x */
static double algebraic_error(const double *x, const double *y)
{
  const int n = caught.n;
  double *e = numbers(n), *Ae = numbers(n), *Ax = numbers(n), above = 0, below = 0;
  for (int i = 0; i < n; i++) e[i] = y[i] - x[i];
  times_matrix(e, Ae, NULL);
  times_matrix(x, Ax, NULL);
  for (int i = 0; i < n; i++) above += e[i] * Ae[i], below += x[i] * Ax[i];
  free(e), free(Ae), free(Ax);
  return sqrt(above / below);
}

/* One projection of a jittered block with a free surface all round */
static void catch_system(const struct solver *solver, double tolerance)
{
  static struct cloud c;
  const struct setting tight[] = {{"tolerance", tolerance}, {"kappa", 0.1}, {NULL, 0}};
  const struct setting as_it_is[] = {{"kappa", 0.1}, {NULL, 0}};
  cloud_make(&c, DIM == 3 ? 8 : 24, 0, KERNEL_CUBIC, 7);
  let_go();
  cloud_run(&c, solver, tolerance > 0 ? tight : as_it_is, 1);
  assert_true(caught.n > 300);
}

static const struct solver *const solvers[] = {&solver_vssph, &solver_helmholtz, &solver_dual_sa,
                                               &solver_dual_sb, &solver_dual_sc};

static void test_cholesky(void **unused)
{
  (void)unused;
  for (int k = 0; k < COUNT(solvers); k++) {
    struct reference_dense quality;
    double errors[2];
    int n = 0, iterations[2];
    for (int loose = 0; loose < 2; loose++) {
      catch_system(solvers[k], loose ? 0 : 1e-13);
      struct reference_system s = symmetric;
      s.n = n = caught.n;
      double *x = numbers(s.n);
      if (reference_dense_solve(&s, caught.b, x, &quality)) fail_msg("%s", reference_error());
      errors[loose] = algebraic_error(x, caught.by_cg);
      iterations[loose] = caught.iterations;
      free(x);
      assert_true(quality.residual < 1e-13 && quality.asymmetry < 1e-13);
    }
    print_message("%-10s %4d unknowns, asymmetry %.0e: algebraic error %.1e at tolerance 1e-13 (%d "
                  "iterations), %.1e at the default %.0e (%d)\n",
                  solvers[k]->name, n, quality.asymmetry, errors[0], iterations[0], errors[1],
                  caught.tolerance, iterations[1]);
    assert_true(errors[0] < 1e-12);
    assert_true(errors[1] < 10 * caught.tolerance && errors[1] > 1e-8);
  }
}

static void test_pcg(void **unused)
{
  (void)unused;
  for (int k = 0; k < COUNT(solvers); k++)
    for (double tolerance = 1e-2; tolerance > 1e-11; tolerance /= 1000) {
      catch_system(solvers[k], tolerance);
      struct reference_system s = symmetric;
      struct reference_pcg how = {caught.diag, caught.tolerance, 1000, 0};
      s.n = caught.n;
      if (reference_pcg_solve(&s, caught.b, caught.x, &how)) fail_msg("%s", reference_error());
      const double apart_by = algebraic_error(caught.x, caught.by_cg);
      print_message("%-10s tolerance %.0e: %d iterations, SUNLinSol_PCG %d, apart %.1e\n",
                    solvers[k]->name, caught.tolerance, caught.iterations, how.iterations,
                    apart_by);
      assert_true(abs(how.iterations - caught.iterations) <= 1);
      assert_true(apart_by < (how.iterations == caught.iterations ? 1e-13 : 3 * tolerance));
    }
}

static void test_refusals(void **unused)
{
  (void)unused;
  struct reference_system none = {0, times_matrix, NULL};
  struct reference_dense quality;
  double x[1], b[1] = {1};
  assert_int_equal(reference_dense_solve(&none, b, x, &quality), REFERENCE_BAD_ARGUMENT);
  catch_system(&solver_vssph, 1e-3);
  struct reference_system s = symmetric;
  double *y = numbers(caught.n);
  s.n = caught.n;
  for (int k = caught.first[7]; k < caught.first[8]; k++) caught.coef[k] *= 1 + 1e-4;
  assert_int_equal(reference_dense_solve(&s, caught.b, y, &quality), REFERENCE_BAD_ARGUMENT);
  catch_system(&solver_vssph, 1e-3);
  caught.diag[7] = -1;
  assert_int_equal(reference_dense_solve(&s, caught.b, y, &quality), REFERENCE_NOT_CONVERGED);
  free(y);
  let_go();
}

int main(void)
{
  if (sizeof(real) == sizeof(float)) return 77; /* a system in f32 has another solution */
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_cholesky),
    cmocka_unit_test(test_pcg),
    cmocka_unit_test(test_refusals),
  };
  return cmocka_run_group_tests_name("algebra " SPHBENCH_VARIANT, tests, NULL, NULL);
}
