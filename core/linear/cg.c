#include "cg.h"

STAGE real times_matrix(const struct cg *s, const real *p, int i)
{
  lanes off = NO_LANES;
  for_slots(&s->rows, i, ij) off += kept(s->coef, ij) * of(p, ij);
  return s->diag[i] * p[i] - sum(off);
}
/* r = b - A x,  d = r / diag */
STAGE void residual(const struct cg *s, int i)
{
  s->r[i] = s->b[i] - times_matrix(s, s->x, i);
  s->d[i] = s->r[i] / s->diag[i];
}
/* d_i = 0 for rows that stand alone, else 1; returns by how much its own diagonal holds a row */
STAGE real couple(const struct cg *s, int i)
{
  lanes off = NO_LANES;
  for_slots(&s->rows, i, ij) off += kept(s->coef, ij);
  const real coupled = sum(off);
  s->d[i] = coupled > 0;
  return coupled > 0 ? 1 - coupled / s->diag[i] : 0;
}
/* (diag_i - sum_j coef_ij)/diag_i over the coupled: 0 in every row where a constant costs nothing;
 * rows beside one that stands alone, as beside a surface, are held by it. */
STAGE real anchor(const struct cg *s, int i)
{
  lanes off = NO_LANES;
  for_slots(&s->rows, i, ij) off += kept(s->coef, ij) * of(s->d, ij);
  return s->d[i] > 0 ? fabs(1 - sum(off) / s->diag[i]) : 0;
}
STAGE real weight_of(const struct cg *s, int i) { return s->d[i] * s->weight[i]; }
STAGE real weighted_b(const struct cg *s, int i) { return s->d[i] * s->weight[i] * s->b[i]; }
STAGE void level_b(const struct cg *s, int i) { s->b[i] -= s->d[i] * s->mean; }

/* Without a free surface only differences of x count, and A x = b has a solution where b has no
 * mean: take it away. CG from an x without a mean finds the x that has none. */
static int floats(const struct cg *s)
{
  const double rounding = sizeof(real) == sizeof(float) ? 1e-5 : 1e-11;
  double most;
  largest_over(couple, s, s->n, &most);
  if (most > rounding) return 0; /* as at a free surface: the usual case, in one pass */
  largest_over(anchor, s, s->n, &most);
  return most <= rounding;
}
static void level(struct cg *s)
{
  double total, mean;
  sum_over(weight_of, s, s->n, &total);
  sum_over(weighted_b, s, s->n, &mean);
  s->mean = total > 0 ? (real)(mean / total) : 0;
  sweep_over(level_b, s, s->n);
}

STAGE void clear(const struct cg *s, int i) { s->x[i] = 0; }
STAGE real norm_b(const struct cg *s, int i) { return s->weight[i] * sq(s->b[i]); }
STAGE real norm_r(const struct cg *s, int i) { return s->weight[i] * sq(s->r[i]); }
STAGE real positive_r(const struct cg *s, int i) { return s->weight[i] * larger(s->r[i], 0); }
/* <r, z>,  z = r / diag */
STAGE real r_dot_z(const struct cg *s, int i) { return s->weight[i] * sq(s->r[i]) / s->diag[i]; }
/* q = A d;  <d, q> */
STAGE real apply(const struct cg *s, int i)
{
  s->q[i] = times_matrix(s, s->d, i);
  return s->weight[i] * s->d[i] * s->q[i];
}
/* x += step d,  r -= step q;  ||r||^2 */
STAGE real advance(const struct cg *s, int i)
{
  s->x[i] += s->step * s->d[i];
  s->r[i] -= s->step * s->q[i];
  return s->weight[i] * sq(s->r[i]);
}
/* d = z + beta d */
STAGE void turn(const struct cg *s, int i) { s->d[i] = s->r[i] / s->diag[i] + s->beta * s->d[i]; }

static int reached(const struct cg *s, double rr, double most, double excess)
{
  double left = 0;
  if (!(rr <= most)) return 0;
  if (isfinite(excess)) sum_over(positive_r, s, s->n, &left);
  return left <= excess;
}

struct cg_result cg_solve_to(struct cg *s, double tolerance, double excess, int max_iterations)
{
  struct cg_result result = {0, 1, 0};
  double bb, rr, rz, dq;
  if (floats(s)) level(s);
  sum_over(norm_b, s, s->n, &bb);
  if (bb == 0) {
    sweep_over(clear, s, s->n);
    return result;
  }
  sweep_over(residual, s, s->n);
  sum_over(norm_r, s, s->n, &rr);
  sum_over(r_dot_z, s, s->n, &rz);
  int done = 0;
  while (!done && result.iterations < max_iterations) {
    sum_over(apply, s, s->n, &dq);
    if (!(dq > 0)) break; /* the residual is zero, or the matrix is not positive definite */
    s->step = (real)(rz / dq);
    sum_over(advance, s, s->n, &rr);
    const double rz_before = rz;
    sum_over(r_dot_z, s, s->n, &rz);
    s->beta = (real)(rz / rz_before);
    sweep_over(turn, s, s->n);
    result.iterations++;
    done = reached(s, rr, tolerance * tolerance * bb, excess);
  }
  result.residual = sqrt(rr / bb);
  result.converged = done || reached(s, rr, tolerance * tolerance * bb, excess);
  return result;
}
