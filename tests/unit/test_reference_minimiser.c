/* The minimiser of semi-implicit SPH by KINSOL: Eq. (14) as a fixed point with Anderson's
 * acceleration, and Newton-Krylov after 100 sweeps of it, against the minimisers that the fixtures
 * hold (Newton with Cholesky's factors in long double). tests/twin/test_known_sisph.c holds the
 * solver itself against the same fixtures. */
#include "sisph_objective.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multimin.h>

static const struct fixture {
  const char *name;
  int kind;
  double support, before, least;
} fixtures[] = {
  {"B0", SISPH_B0, 2, 0.067633566341092344, 0.000436267083155639008},
  {"B1", SISPH_B1, 2, 0.14113940480221992, 0.000438185593968404566},
  {"B2", SISPH_B2, 2, 0.221092130827422758, 0.000438829677397419892},
  {"H1p2_B0", SISPH_B0, 1.2, 0.0163330722781068655, 0.000633045379742224339},
};

static double largest(const double *a, const double *b, double scale)
{
  double most = 0;
  for (int k = 0; k < BLOCK_NUMBERS; k++) most = fmax(most, fabs(a[k] - (b ? b[k] : 0)) / scale);
  return most;
}

static void test_minimisers(void **state)
{
  (void)state;
  for (int f = 0; f < COUNT(fixtures); f++) {
    static struct block b;
    double x[2][BLOCK_NUMBERS], gradient[BLOCK_NUMBERS];
    block_read(&b, fixtures[f].name, fixtures[f].kind, fixtures[f].support);
    close_to("Psi(x*)", block_psi(&b, b.start), fixtures[f].before, 1e-15);
    close_to("Psi of the file's minimiser", block_psi(&b, b.least), fixtures[f].least, 2e-17);
    for (int newton = 0; newton < 2; newton++) {
      const int iterations = newton ? block_newton(&b, 100, x[1]) : block_fixed_point(&b, x[0]);
      const double off = largest(x[newton], b.least, b.dx);
      block_gradient(&b, x[newton], gradient, NULL);
      print_message("%-8s %-15s %3d iterations, off by %.1e dx, |grad| h^2/(m dx) %.1e\n",
                    fixtures[f].name, newton ? "Newton-Krylov" : "Anderson(5)", iterations, off,
                    largest(gradient, NULL, b.dx));
      close_to("Psi", block_psi(&b, x[newton]), fixtures[f].least, 2e-17);
      close_to("minimiser", off, 0, 1e-9);
    }
  }
}

/* The gradient by differences of Psi */
static void test_gradient(void **state)
{
  (void)state;
  static struct block b;
  double gradient[BLOCK_NUMBERS], x[BLOCK_NUMBERS];
  block_read(&b, "B2", SISPH_B2, 2);
  block_gradient(&b, b.start, gradient, NULL);
  memcpy(x, b.start, sizeof x);
  for (int k = 0; k < BLOCK_NUMBERS; k++) {
    const double step = 1e-5 * b.dx;
    x[k] = b.start[k] + step;
    const double more = block_psi(&b, x);
    x[k] = b.start[k] - step;
    const double less = block_psi(&b, x);
    x[k] = b.start[k];
    close_to("gradient", sq(b.h) / b.m * (more - less) / (2 * step), gradient[k],
             1e-8 * largest(gradient, NULL, 1));
  }
}

/* ---- GSL's minimiser of Psi itself, in units of dx; Psi is flat to rounding before x is found */

static double psi_of(const gsl_vector *x, void *block)
{
  const struct block *b = block;
  double at[BLOCK_NUMBERS];
  for (int k = 0; k < BLOCK_NUMBERS; k++) at[k] = gsl_vector_get(x, k) * b->dx;
  return block_psi(b, at);
}
static void gradient_of(const gsl_vector *x, void *block, gsl_vector *out)
{
  const struct block *b = block;
  double at[BLOCK_NUMBERS], gradient[BLOCK_NUMBERS];
  for (int k = 0; k < BLOCK_NUMBERS; k++) at[k] = gsl_vector_get(x, k) * b->dx;
  block_gradient(b, at, gradient, NULL);
  for (int k = 0; k < BLOCK_NUMBERS; k++)
    gsl_vector_set(out, k, gradient[k] * b->m / sq(b->h) * b->dx);
}
static void both_of(const gsl_vector *x, void *block, double *psi, gsl_vector *out)
{
  *psi = psi_of(x, block);
  gradient_of(x, block, out);
}

static void test_descent(void **state)
{
  (void)state;
  static struct block b;
  double at[BLOCK_NUMBERS];
  int steps = 0;
  block_read(&b, "B0", SISPH_B0, 2);
  gsl_multimin_function_fdf psi = {psi_of, gradient_of, both_of, BLOCK_NUMBERS, &b};
  gsl_multimin_fdfminimizer *search =
    gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, BLOCK_NUMBERS);
  gsl_vector *start = gsl_vector_alloc(BLOCK_NUMBERS);
  for (int k = 0; k < BLOCK_NUMBERS; k++) gsl_vector_set(start, k, b.start[k] / b.dx);
  gsl_multimin_fdfminimizer_set(search, &psi, start, 0.01, 0.1);
  while (steps < 5000 && gsl_multimin_fdfminimizer_iterate(search) == GSL_SUCCESS) steps++;
  for (int k = 0; k < BLOCK_NUMBERS; k++) at[k] = gsl_vector_get(search->x, k) * b.dx;
  const double least = block_psi(&b, b.least), above = block_psi(&b, at) / least - 1;
  print_message("GSL's bfgs2: %d steps, Psi above the least by %.1e of it, off by %.1e dx\n", steps,
                above, largest(at, b.least, b.dx));
  gsl_vector_free(start);
  gsl_multimin_fdfminimizer_free(search);
  close_to("Psi", above, 0, 1e-9);
  close_to("minimiser", largest(at, b.least, b.dx), 0, 1e-5);
}

/* A stiff one defeats the fixed point, which must say so, and not Newton's method. */
static void test_stiff(void **state)
{
  (void)state;
  static struct block b;
  double x[BLOCK_NUMBERS], gradient[BLOCK_NUMBERS];
  int iterations;
  block_read(&b, "B0", SISPH_B0, 2);
  b.mu = 100;
  struct reference_equations e = {BLOCK_NUMBERS, block_sweep, &b, 1e-13, 500, 5};
  for (int k = 0; k < BLOCK_NUMBERS; k++) x[k] = b.start[k] / b.dx;
  assert_int_equal(reference_fixed_point(&e, x, &iterations), REFERENCE_NOT_CONVERGED);
  assert_true(strlen(reference_error()) > 10);
  iterations = block_newton(&b, 100, x);
  block_gradient(&b, x, gradient, NULL);
  print_message("mu = 100: Newton-Krylov %d iterations, |grad| h^2/(m dx) %.1e\n", iterations,
                largest(gradient, NULL, b.dx));
  /* KINSOL sees it divided by 1 + S, which is 3000 */
  close_to("gradient", largest(gradient, NULL, b.dx), 0, 1e-10);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_minimisers),
    cmocka_unit_test(test_gradient),
    cmocka_unit_test(test_descent),
    cmocka_unit_test(test_stiff),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
