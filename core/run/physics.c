/* The stages that every method shares. */
#include "run.h"

struct wrapping {
  VIEW;
  vec low, period;
};

STAGE void move(const struct view *s, int i) { s->p.x[i] = madd(s->p.x[i], s->dt, s->p.v[i]); }

STAGE void wrap(const struct wrapping *s, int i)
{
  for (int d = 0; d < DIM; d++)
    if (s->period.c[d] > 0)
      s->p.x[i].c[d] -= s->period.c[d] * floor((s->p.x[i].c[d] - s->low.c[d]) / s->period.c[d]);
}

STAGE void fall(const struct view *s, int i) { s->p.v[i] = madd(s->p.v[i], s->dt, s->gravity); }

/* rho_i = sum_j m_j W_ij */
STAGE void density(const struct view *s, int i)
{
  lanes rho = NO_LANES;
  for_neighbours (s, i, ij) rho += of(s->p.m, ij) * W(&s->nb, ij);
  s->p.rho[i] = sum(rho);
}

STAGE void volume(const struct view *s, int i) { s->p.V[i] = s->p.m[i] / s->p.rho[i]; }

/* XSPH, Monaghan 1989, J. Comput. Phys. 82, Eq. (2.6), as a coefficient per step (Schechter &
 * Bridson 2012): dv_i = c sum_j V_ij (v_j - v_i) W_ij,   V_ij = 2 V_i V_j / (V_i + V_j) = 2 m /
 * (rho_i + rho_j): symmetric, so momentum is kept; 0 on walls, so that they are free slip. Between
 * fluids times 2 light_i/(light_i + light_j), for the same reason. */
STAGE void xsph(const struct view *s, int i)
{
  vecs dv = NO_VECS;
  const real Vi = s->p.V[i];
  for_neighbours (s, i, ij) {
    const lanes Vj = of(s->p.V, ij);
    lanes share = 2 * Vi * Vj / (Vi + Vj) * W(&s->nb, ij);
    if (s->p.light) share = share * 2 * light(&s->p, i) / (light(&s->p, i) + light_of(&s->p, ij));
    dv = add(dv, scale(-share, diff(s->p.v, ij)));
  }
  s->p.dv[i] = times(s->xsph, sum(dv));
}
STAGE void add_change(const struct view *s, int i) { s->p.v[i] = plus(s->p.v[i], s->p.dv[i]); }

STAGE real speed2(const struct view *s, int i) { return inner(s->p.v[i], s->p.v[i]); }
STAGE real position_and_velocity(const struct view *s, int i)
{
  return inner(s->p.v[i], s->p.v[i]) + inner(s->p.x[i], s->p.x[i]);
}

void physics_move(struct view *s) { sweep(move, s); }

void physics_wrap(struct view *view, vec low, vec period)
{
  struct wrapping s;
  s.p = view->p;
  s.low = low;
  s.period = period;
  sweep(wrap, &s);
}

void physics_gravity(struct view *s) { sweep(fall, s); }

void physics_density(struct view *s)
{
  sweep(density, s);
  if (s->p.V) sweep(volume, s);
}

void physics_viscosity(struct view *s)
{
  sweep(xsph, s);
  sweep(add_change, s);
}

void physics_health(struct view *s, double *total, double *fastest)
{
  sum_over(position_and_velocity, s, s->p.n, total);
  largest_over(speed2, s, s->p.n, fastest);
  *fastest = sqrt(*fastest);
}
