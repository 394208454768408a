/* Nonlinear systems by SUNDIALS' KINSOL. */
#include "internal.h"
#include "sundials_versions.h"
#include <kinsol/kinsol.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunlinsol/sunlinsol_spgmr.h>

struct kinsol {
  const struct reference_equations *equations;
  SUNContext context;
  void *memory;
  N_Vector x, ones;
  SUNLinearSolver gmres;
};

static int function(N_Vector x, N_Vector f, void *kinsol)
{
  const struct reference_equations *e = ((const struct kinsol *)kinsol)->equations;
  e->function(N_VGetArrayPointer(x), N_VGetArrayPointer(f), e->user);
  return 0;
}

static void close_kinsol(struct kinsol *k)
{
  if (k->memory) KINFree(&k->memory);
  if (k->gmres) SUNLinSolFree(k->gmres);
  if (k->ones) N_VDestroy(k->ones);
  if (k->x) N_VDestroy(k->x);
  if (k->context) SUNContext_Free(&k->context);
}

/* Before SUNDIALS 7.5 the history must be set before KINInit. */
static bool open_kinsol(struct kinsol *k, bool fixed_point)
{
  const struct reference_equations *e = k->equations;
  if (REF_CREATE_CONTEXT(&k->context)) return false;
  k->x = N_VNew_Serial(e->n, k->context);
  k->ones = N_VNew_Serial(e->n, k->context);
  k->memory = KINCreate(k->context);
  if (!k->x || !k->ones || !k->memory || REF_SILENCE_KINSOL(k->context, k->memory)) return false;
  N_VConst(1, k->ones);
  const long history = e->history < e->max_iterations ? e->history : e->max_iterations - 1;
  if (KINSetUserData(k->memory, k) || KINSetNumMaxIters(k->memory, e->max_iterations) ||
      (fixed_point && KINSetMAA(k->memory, history)) || KINInit(k->memory, function, k->x) ||
      KINSetFuncNormTol(k->memory, e->tolerance))
    return false;
  if (fixed_point) return true;
  k->gmres = SUNLinSol_SPGMR(k->x, SUN_PREC_NONE, e->history, k->context);
  return k->gmres && !KINSetLinearSolver(k->memory, k->gmres, NULL) &&
         !KINSetScaledStepTol(k->memory, 1e-30) && !KINSetEtaForm(k->memory, KIN_ETACONSTANT) &&
         !KINSetEtaConstValue(k->memory, 1e-4) && !KINSetNoResMon(k->memory, 1);
}

static enum reference_status solve(const struct reference_equations *e, double *x, const char *name,
                                   int strategy, int *iterations)
{
  struct kinsol k = {.equations = e};
  int flag = KIN_MEM_FAIL;
  long steps = 0;
  if (open_kinsol(&k, strategy == KIN_FP)) {
    memcpy(N_VGetArrayPointer(k.x), x, e->n * sizeof *x);
    flag = KINSol(k.memory, k.x, strategy, k.ones, k.ones);
    KINGetNumNonlinSolvIters(k.memory, &steps);
    memcpy(x, N_VGetArrayPointer(k.x), e->n * sizeof *x);
  }
  close_kinsol(&k);
  *iterations = (int)steps;
  if (flag == KIN_SUCCESS || flag == KIN_INITIAL_GUESS_OK) return REFERENCE_OK;
  return ref_fail(REFERENCE_NOT_CONVERGED, "KINSOL (%s) returned %d after %ld iterations", name,
                  flag, steps);
}

enum reference_status reference_fixed_point(const struct reference_equations *e, double *x,
                                            int *iterations)
{
  return solve(e, x, "fixed point", KIN_FP, iterations);
}

enum reference_status reference_newton_krylov(const struct reference_equations *e, double *x,
                                              int *iterations)
{
  return solve(e, x, "Newton-Krylov", KIN_LINESEARCH, iterations);
}
