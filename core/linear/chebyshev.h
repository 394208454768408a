/* chebyshev.h - the Chebyshev semi-iterative method (Golub & Varga 1961, doi:10.1007/BF01386013;
 * for nonlinear iterations Wang 2015, doi:10.1145/2816795.2818063) on a fixed-point iteration
 * x <- g(x) of any field: the next value that the iteration proposes is replaced by a better one.
 */
#ifndef CHEBYSHEV_H
#define CHEBYSHEV_H
#include "../sph/sweep.h"

/* A field as a list of reals. */
struct chebyshev_field {
  int n;
  const real *x; /* x_k [n] */
  real *g;       /* in: g(x_k); out: x_{k+1} [n] */
  real *last;    /* work: x_{k-1} [n] */
};

struct chebyshev {
  struct chebyshev_field field;
  real rho;   /* spectral radius of the iteration, < 1 */
  real omega; /* omega_{k+1} */
  int k;      /* steps taken; 0 before the first */
};

/* omega_1 = 1,   omega_2 = 2 / (2 - rho^2),   omega_{k+1} = 4 / (4 - rho^2 omega_k) */
static inline void chebyshev_next(struct chebyshev *s)
{
  const real rho2 = sq(s->rho);
  s->omega = s->k == 0 ? 1 : s->k == 1 ? 2 / (2 - rho2) : 4 / (4 - rho2 * s->omega);
  s->k++;
}

/* x_{k+1} = omega_{k+1} (g_k - x_{k-1}) + x_{k-1};   x_1 = g_0 */
STAGE void chebyshev_blend(const struct chebyshev *s, int i)
{
  const struct chebyshev_field f = s->field;
  if (s->k > 1) f.g[i] = s->omega * (f.g[i] - f.last[i]) + f.last[i];
  f.last[i] = f.x[i];
}

/* After chebyshev_next, for every field that takes part. */
static inline void chebyshev_apply(struct chebyshev *s, struct chebyshev_field field)
{
  s->field = field;
  sweep_over(chebyshev_blend, s, field.n);
}
#endif
