#include "cg_vec.h"

STAGE real weight(const struct cg_vec *s, int i)
{
  return s->light ? s->mass[i] / s->light[i] : s->mass[i];
}
/* 1/w_i sum_j c_ij (u_i - u_j),  or  1/w_i sum_j c_ij x_ij x_ij^T (u_i - u_j) */
STAGE vec pull(const struct cg_vec *s, const vec *u, int i)
{
  vecs total = NO_VECS;
  if (s->central)
    for_pairs (&s->rows, i, ij)
      total = add(total, scale(kept(s->coef, ij) * dot(ij.x, diff(u, ij)), ij.x));
  else
    for_slots(&s->rows, i, ij) total = add(total, scale(kept(s->coef, ij), diff(u, ij)));
  return times(1 / weight(s, i), sum(total));
}
/* diag = 1 + 1/w_i sum_j c_ij, or 1 + 1/w_i sum_j c_ij |x_ij|^2 / DIM;  r = b - A v for v = b;
 * d = r / diag, 0 where v is given */
STAGE void residual(const struct cg_vec *s, int i)
{
  s->d[i] = zero();
  if (i >= s->n) return;
  lanes stiff = NO_LANES;
  for_pairs (&s->rows, i, ij)
    stiff += kept(s->coef, ij) * (s->central ? ij.r * ij.r / DIM : 1 + NO_LANES);
  s->diag[i] = 1 + sum(stiff) / weight(s, i);
  s->r[i] = times(-1, pull(s, s->v, i));
  s->d[i] = times(1 / s->diag[i], s->r[i]);
}
STAGE real norm_r(const struct cg_vec *s, int i) { return weight(s, i) * inner(s->r[i], s->r[i]); }
STAGE real norm_v(const struct cg_vec *s, int i) { return weight(s, i) * inner(s->v[i], s->v[i]); }
/* <r, z>,  z = r / diag */
STAGE real r_dot_z(const struct cg_vec *s, int i)
{
  return weight(s, i) * inner(s->r[i], s->r[i]) / s->diag[i];
}
/* q = A d;  <d, q> */
STAGE real apply(const struct cg_vec *s, int i)
{
  s->q[i] = plus(s->d[i], pull(s, s->d, i));
  return weight(s, i) * inner(s->d[i], s->q[i]);
}
/* v += step d,  r -= step q;  |r|^2 */
STAGE real advance(const struct cg_vec *s, int i)
{
  s->v[i] = madd(s->v[i], s->step, s->d[i]);
  s->r[i] = madd(s->r[i], -s->step, s->q[i]);
  return norm_r(s, i);
}
/* d = z + beta d */
STAGE void turn(const struct cg_vec *s, int i)
{
  s->d[i] = madd(times(1 / s->diag[i], s->r[i]), s->beta, s->d[i]);
}

struct cg_result cg_vec_solve(struct cg_vec *s, double tolerance, int max_iterations)
{
  struct cg_result result = {0, 0, 0};
  double rr, vv, rz, dq;
  sweep_over(residual, s, s->n_all);
  sum_over(norm_r, s, s->n, &rr);
  sum_over(norm_v, s, s->n, &vv);
  sum_over(r_dot_z, s, s->n, &rz);
  while (result.iterations < max_iterations && rr > tolerance * tolerance * vv) {
    sum_over(apply, s, s->n, &dq);
    if (!(dq > 0)) break; /* no direction is left, or not a number */
    s->step = (real)(rz / dq);
    sum_over(advance, s, s->n, &rr);
    sum_over(norm_v, s, s->n, &vv);
    const double rz_before = rz;
    sum_over(r_dot_z, s, s->n, &rz);
    s->beta = (real)(rz / rz_before);
    sweep_over(turn, s, s->n);
    result.iterations++;
  }
  result.converged = rr <= tolerance * tolerance * vv;
  result.residual = rr > 0 || !(rr == rr) ? sqrt(rr / vv) : 0;
  return result;
}
