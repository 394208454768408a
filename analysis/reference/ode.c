/* Ordinary differential equations by CVODE's Adams method. */
#include "internal.h"
#include "sundials_versions.h"
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

enum { MAX_STEPS = 2000000 };

/* CVODE's objects, so that one function frees whatever was made. */
struct integrator {
  SUNContext context;
  void *memory;
  N_Vector y;
  SUNNonlinearSolver iteration;
};

static int rate(double t, N_Vector y, N_Vector dy, void *user)
{
  const struct ref_ode *ode = user;
  return ode->rate(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy), ode->user);
}

static void close_integrator(struct integrator *s)
{
  if (s->memory) CVodeFree(&s->memory);
  if (s->iteration) SUNNonlinSolFree(s->iteration);
  if (s->y) N_VDestroy(s->y);
  if (s->context) SUNContext_Free(&s->context);
}

static bool open_integrator(struct integrator *s, const struct ref_ode *ode, const double *start)
{
  if (REF_CREATE_CONTEXT(&s->context)) return false;
  s->y = N_VNew_Serial(ode->n, s->context);
  s->memory = CVodeCreate(CV_ADAMS, s->context);
  if (!s->y || !s->memory || REF_SILENCE_CVODE(s->context, s->memory)) return false;
  s->iteration = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
  memcpy(N_VGetArrayPointer(s->y), start, ode->n * sizeof *start);
  return s->iteration && !CVodeInit(s->memory, rate, 0, s->y) &&
         !CVodeSStolerances(s->memory, ode->relative, ode->absolute) &&
         !CVodeSetNonlinearSolver(s->memory, s->iteration) &&
         !CVodeSetUserData(s->memory, (void *)ode) && !CVodeSetMaxNumSteps(s->memory, MAX_STEPS);
}

enum reference_status ref_ode_integrate(const struct ref_ode *ode, const double *start,
                                        struct ref_times times)
{
  struct integrator s = {0};
  int flag = CV_MEM_FAIL, k = 0;
  int status = REFERENCE_OK;
  if (open_integrator(&s, ode, start)) flag = CV_SUCCESS;
  for (; k < times.count && flag >= 0 && !status; k++) {
    double reached = 0;
    if (times.t[k] != 0) flag = CVode(s.memory, times.t[k], s.y, &reached, CV_NORMAL);
    if (flag >= 0) status = ode->visit(k, N_VGetArrayPointer(s.y), ode->user);
  }
  close_integrator(&s);
  if (flag >= 0) return (enum reference_status)status;
  return ref_fail(REFERENCE_NOT_CONVERGED, "%s: CVODE returned %d before t = %g at tolerance %g",
                  ode->name, flag, times.t[k > 0 ? k - 1 : 0], ode->relative);
}
