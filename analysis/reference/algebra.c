/* Linear systems by other people's programs: LAPACK's Cholesky factors and SUNDIALS' CG. */
#include "internal.h"
#include "sundials_versions.h"
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_pcg.h>

enum { MOST_UNKNOWNS = 5000 };

/* Fortran's; the last arguments are the lengths of the texts. */
void dpotrf_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t length);
void dpotrs_(const char *uplo, const int *n, const int *nrhs, const double *a, const int *lda,
             double *b, const int *ldb, int *info, size_t length);

/* Column k = A e_k; returns the largest |A_ij - A_ji| over the largest |A_ij|. */
static double write_out(const struct reference_system *s, double *matrix, double *unit)
{
  const size_t n = s->n;
  double most = 0, odd = 0;
  memset(unit, 0, n * sizeof *unit);
  for (size_t k = 0; k < n; k++) {
    unit[k] = 1;
    s->apply(unit, matrix + k * n, s->user);
    unit[k] = 0;
  }
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++) {
      most = fmax(most, fabs(matrix[i * n + k]));
      odd = fmax(odd, fabs(matrix[i * n + k] - matrix[k * n + i]));
    }
  return most > 0 ? odd / most : 0;
}

static double norm(const double *a, int n)
{
  double sum = 0;
  for (int i = 0; i < n; i++) sum += sq(a[i]);
  return sqrt(sum);
}

/* One step of refinement: x += A^-1 (b - A x) */
static enum reference_status factors(const struct reference_system *s, double *matrix, double *work,
                                     const double *b, double *x)
{
  const int one = 1;
  int info;
  dpotrf_("L", &s->n, matrix, &s->n, &info, 1);
  if (info)
    return ref_fail(REFERENCE_NOT_CONVERGED,
                    "dense solution: the matrix is not positive definite (dpotrf: %d)", info);
  memset(x, 0, s->n * sizeof *x);
  for (int pass = 0; pass < 2; pass++) {
    s->apply(x, work, s->user);
    for (int i = 0; i < s->n; i++) work[i] = b[i] - work[i];
    dpotrs_("L", &s->n, &one, matrix, &s->n, work, &s->n, &info, 1);
    for (int i = 0; i < s->n; i++) x[i] += work[i];
  }
  return REFERENCE_OK;
}

enum reference_status reference_dense_solve(const struct reference_system *s, const double *b,
                                            double *x, struct reference_dense *quality)
{
  const size_t n = s->n;
  if (s->n < 1 || s->n > MOST_UNKNOWNS)
    return ref_fail(REFERENCE_BAD_ARGUMENT, "dense solution: needs 1 to %d unknowns, not %d",
                    MOST_UNKNOWNS, s->n);
  double *matrix = malloc((n + 1) * n * sizeof *matrix), *work = matrix + n * n;
  if (!matrix) return ref_fail(REFERENCE_NO_MEMORY, "dense solution: no memory for the matrix");
  quality->asymmetry = write_out(s, matrix, work);
  enum reference_status status = REFERENCE_OK;
  if (!(quality->asymmetry < 1e-6))
    status = ref_fail(REFERENCE_BAD_ARGUMENT,
                      "dense solution: the matrix is not symmetric, by %.2g of its largest element",
                      quality->asymmetry);
  if (!status) status = factors(s, matrix, work, b, x);
  if (!status) {
    s->apply(x, work, s->user);
    for (int i = 0; i < s->n; i++) work[i] -= b[i];
    quality->residual = norm(work, s->n) / fmax(norm(b, s->n), 1e-300);
  }
  free(matrix);
  return status;
}

/* ---- SUNLinSol_PCG ---- */

struct conjugate {
  const struct reference_system *system;
  const double *diagonal;
  SUNContext context;
  N_Vector x, b;
  SUNLinearSolver solver;
};

static int times(void *conjugate, N_Vector x, N_Vector y)
{
  const struct reference_system *s = ((const struct conjugate *)conjugate)->system;
  s->apply(N_VGetArrayPointer(x), N_VGetArrayPointer(y), s->user);
  return 0;
}

static int precondition(void *conjugate, N_Vector r, N_Vector z, double tolerance, int side)
{
  const struct conjugate *c = conjugate;
  (void)tolerance, (void)side;
  for (int i = 0; i < c->system->n; i++)
    N_VGetArrayPointer(z)[i] = N_VGetArrayPointer(r)[i] / c->diagonal[i];
  return 0;
}

static bool open_conjugate(struct conjugate *c, int max_iterations)
{
  if (REF_CREATE_CONTEXT(&c->context)) return false;
  c->x = N_VNew_Serial(c->system->n, c->context);
  c->b = N_VNew_Serial(c->system->n, c->context);
  if (!c->x || !c->b) return false;
  c->solver = SUNLinSol_PCG(c->x, SUN_PREC_LEFT, max_iterations, c->context);
  return c->solver && !SUNLinSolSetATimes(c->solver, c, times) &&
         !SUNLinSolSetPreconditioner(c->solver, c, NULL, precondition) &&
         !SUNLinSolInitialize(c->solver) && !SUNLinSolSetup(c->solver, NULL);
}

enum reference_status reference_pcg_solve(const struct reference_system *s, const double *b,
                                          double *x, struct reference_pcg *how)
{
  struct conjugate c = {.system = s, .diagonal = how->diagonal};
  enum reference_status status = REFERENCE_NO_MEMORY;
  if (open_conjugate(&c, how->max_iterations)) {
    memcpy(N_VGetArrayPointer(c.x), x, s->n * sizeof *x);
    memcpy(N_VGetArrayPointer(c.b), b, s->n * sizeof *b);
    const int flag = SUNLinSolSolve(c.solver, NULL, c.x, c.b, how->tolerance * norm(b, s->n));
    memcpy(x, N_VGetArrayPointer(c.x), s->n * sizeof *x);
    how->iterations = SUNLinSolNumIters(c.solver);
    status = REFERENCE_OK;
    if (flag)
      status = ref_fail(REFERENCE_NOT_CONVERGED,
                        "SUNLinSol_PCG returned %d after %d iterations at "
                        "tolerance %g",
                        flag, how->iterations, how->tolerance);
  }
  if (c.solver) SUNLinSolFree(c.solver);
  if (c.b) N_VDestroy(c.b);
  if (c.x) N_VDestroy(c.x);
  if (c.context) SUNContext_Free(&c.context);
  return status == REFERENCE_NO_MEMORY ? ref_fail(status, "SUNLinSol_PCG: no memory") : status;
}
