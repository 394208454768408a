/* cg_vec.h - conjugate gradients with Jacobi's preconditioner for velocities that pull at each
 * other, in all components or along the lines between particles:
 *   (A v)_i = v_i + 1/w_i sum_j c_ij (v_i - v_j),               c_ij = c_ji >= 0,
 *   (A v)_i = v_i + 1/w_i sum_j c_ij x_ij x_ij^T (v_i - v_j)    if central,
 * symmetric and positive definite in <a, b> = sum_i w_i a_i . b_i. Its smallest eigenvalue is 1, so
 * that a residual bounds the error: |v - A^-1 b| <= |b - A v|. */
#ifndef CG_VEC_H
#define CG_VEC_H
#include "../neighbours/pairs.h"
#include "../sph/sweep.h"
#include "cg.h"
#ifdef __cplusplus
extern "C" {
#endif

struct cg_vec {
  int n, n_all;      /* unknown are v_0 .. v_n-1; v_n .. v_n_all-1 are given */
  int central;       /* see above */
  struct pairs rows; /* the list that coef belongs to, with its positions */
  const real *coef;  /* c_ij [slots] */
  const real *mass;  /* w_i = mass_i / light_i [n] */
  const real *light; /* > 0 [n]; NULL: 1 */
  vec *v;            /* b, then the solution [n_all] */
  vec *r, *d, *q;    /* work: residual [n], direction [n_all], A d [n] */
  real *diag;        /* work: mean of the diagonal of A's block [n] */
  real step, beta;   /* of the current iteration */
};

/* Solve A v = b from v = b until |b - A v| <= tolerance |v|, or max_iterations; the result's
 * residual is that ratio. No iteration where v = b is the solution. */
struct cg_result cg_vec_solve(struct cg_vec *s, double tolerance, int max_iterations);

#ifdef __cplusplus
}
#endif
#endif
