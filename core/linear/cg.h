/* cg.h - conjugate gradients with Jacobi's preconditioner in a weighted inner product, for
 * operators (A p)_i = diag_i p_i - sum_j coef_ij p_j that are symmetric and positive definite in
 * <a, b> = sum_i w_i a_i b_i  (w_i coef_ij = w_j coef_ji). Hestenes & Stiefel 1952; Barrett et al.,
 * Templates (1994), Fig. 2.5. Where every row of A adds up to 0 (no free surface, no wall of given
 * pressure) constants cost nothing: b loses its weighted mean, and the x with none is found. */
#ifndef CG_H
#define CG_H
#include <math.h>

#include "../neighbours/pairs.h"
#include "../sph/sweep.h"
#ifdef __cplusplus
extern "C" {
#endif

struct cg {
  int n;
  struct pairs rows;  /* the list that coef belongs to; its positions are not read */
  const real *coef;   /* off-diagonal coefficients [slots] */
  const real *diag;   /* > 0 [n] */
  const real *weight; /* of the inner product, > 0 [n] */
  real *b;         /* right-hand side [n]; loses its mean where A has constants for a null space */
  real *x;         /* start and solution [n] */
  real *r, *d, *q; /* work [n]: residual, direction, A d; d is 0 for what rows list beyond n */
  real step, beta; /* of the current iteration */
  real mean;       /* taken from b or x */
};

struct cg_result {
  int iterations, converged;
  double residual; /* ||b - A x|| / ||b|| in the weighted norm, by the recurrence */
};

/* Iterate from x until residual <= tolerance and sum_i w_i max(r_i, 0) <= excess, or max_iterations
 * (at least one iteration unless b = 0; exactly max_iterations where tolerance = 0). b = 0 gives
 * x = 0. */
struct cg_result cg_solve_to(struct cg *s, double tolerance, double excess, int max_iterations);

/* The same by the residual alone. */
static inline struct cg_result cg_solve(struct cg *s, double tolerance, int max_iterations)
{
  return cg_solve_to(s, tolerance, HUGE_VAL, max_iterations);
}

#ifdef __cplusplus
}
#endif
#endif
