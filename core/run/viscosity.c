/* Viscosity of Newtonian fluids.
 *   explicit   Monaghan, Rep. Prog. Phys. 68 (2005) 1703, with the Laplacian of the implicit form
 *   implicit   M. Weiler, D. Koschier, M. Brand, J. Bender, A Physically Consistent Implicit
 *              Viscosity Solver for SPH Fluids, Comput. Graph. Forum 37(2) (2018) 145,
 *              doi:10.1111/cgf.13349
 *   full       either with the Laplacian of J. P. Morris, P. J. Fox, Y. Zhu, J. Comput. Phys. 136
 *              (1997) 214, doi:10.1006/jcph.1997.5776, in place of pairs that pull along their line
 * Differences from the paper:
 *   0.01 h^2 is not added to |x_ij|^2: no term is singular without it (it takes 1 to 4 % away)
 *   mu_ij = 2 mu_i mu_j/(mu_i + mu_j) between fluids (Cleary & Monaghan 1999), mu_i at walls
 *   walls hold the fluid: their particles pull with their velocity and the volume m_j/rho_0;
 *     wall_slip = free leaves them out
 *   Jacobi's preconditioner with the mean of each block's diagonal, not the inverse block
 *   starts from v*, not from v* plus the last step's change
 * How much of mu a shear along an axis shows (cubic spline; decay of a wave in a box at rest, 2-D):
 *                                R = 2 dx   2.5 dx   3 dx   4 dx
 *   central, square lattice          0.66     0.83   0.94   0.97    (along a diagonal 1.36 .. 1.02)
 *   central, displaced by 0.25 dx    0.64     0.82   0.91   0.97
 *   full, square lattice             1.01     1.00   1.00   1.00
 *   full, displaced by 0.25 dx       0.86     0.94   0.97   0.98
 * central keeps angular momentum, and a rigid rotation is no friction, also at a free surface; full
 * does neither. Walls that hold the fluid do so in first order of dx. */
#include "forces.h"

#include <string.h>

#include "../linear/cg_vec.h"

struct viscous {
  VIEW;
  struct viscosity viscosity;
  int no_slip;
  real *coef; /* dt f_ij [kg/m^2] */
};

/* V_j, m_j/rho_0 on walls that hold the fluid */
STAGE lanes volume_of(const struct viscous *s, struct packet ij)
{
  lanes V = of(s->p.V, ij);
  if (s->no_slip) {
    const lanes V0 = of(s->p.m, ij) / s->rho0;
    V += V0 - only_below(ij, s->p.n, V0);
  }
  return V;
}

/* mu_ij = 2 mu_i mu_j / (mu_i + mu_j), mu_i at walls */
STAGE lanes viscosity_of(const struct viscous *s, int i, struct packet ij)
{
  if (!s->p.mu) return s->viscosity.mu + NO_LANES;
  const lanes mu = of(s->p.mu, ij), own = s->p.mu[i] + NO_LANES;
  const lanes both = 2 * own * mu / at_least(own + mu, (real)1e-30);
  return only_below(ij, s->p.n, both) + own - only_below(ij, s->p.n, own);
}

/* F_i = V_i mu lap v_i = -sum_j f_ij x_ij (x_ij . v_ij),  f_ij = 2 (d+2) mu_ij V_i V_j
 * |W'_ij|/r_ij^3 full: F_i = -sum_j f_ij v_ij,                           f_ij = 2 mu_ij V_i V_j
 * |W'_ij|/r_ij */
STAGE lanes friction(const struct viscous *s, int i, struct packet ij)
{
  const int central = s->viscosity.pairs == VISCOSITY_CENTRAL;
  const real own = 2 * (central ? DIM + 2 : 1) * s->p.V[i];
  const lanes r2 = central ? at_least(ij.r * ij.r, (real)1e-12 * sq(s->nb.kernel.R)) : 1 + NO_LANES;
  return positive(ij.r,
                  own * viscosity_of(s, i, ij) * volume_of(s, ij) * slope_over_r(&s->nb, ij) / r2);
}

/* dv_i = dt F_i light_i / m_i */
STAGE void drag(const struct viscous *s, int i)
{
  vecs F = NO_VECS;
  for_neighbours (s, i, ij) {
    const vecs v = diff(s->p.v, ij);
    const lanes f = friction(s, i, ij);
    F = add(F, s->viscosity.pairs == VISCOSITY_CENTRAL ? scale(-f * dot(ij.x, v), ij.x)
                                                       : scale(-f, v));
  }
  s->p.dv[i] = times(s->dt * light(&s->p, i) / s->p.m[i], sum(F));
}
STAGE void add_drag(const struct viscous *s, int i) { s->p.v[i] = plus(s->p.v[i], s->p.dv[i]); }

/* dt f_ij, kept for the iterations */
STAGE void couple(const struct viscous *s, int i)
{
  for_neighbours (s, i, ij) keep(s->coef, ij, s->dt * friction(s, i, ij));
}

static struct viscous viscous_of(const struct view *view, struct viscosity viscosity)
{
  struct viscous s;
  memset(&s, 0, sizeof s);
  memcpy(&s, view, sizeof *view); /* VIEW comes first */
  s.viscosity = viscosity;
  s.no_slip = s.p.n_all > s.p.n && viscosity.slip == WALL_SLIP_NONE;
  return s;
}

void viscosity_explicit(const struct view *view, struct viscosity viscosity)
{
  struct viscous s = viscous_of(view, viscosity);
  sweep(drag, &s);
  sweep(add_drag, &s);
}

/* (m_i/light_i) v_i + dt sum_j f_ij x_ij (x_ij . v_ij) = (m_i/light_i) v*_i */
struct cg_result viscosity_implicit(const struct view *view, struct viscosity viscosity, real *coef,
                                    double tolerance, int max_iterations)
{
  struct viscous s = viscous_of(view, viscosity);
  struct cg_vec cg;
  memset(&cg, 0, sizeof cg);
  s.coef = coef;
  sweep(couple, &s);
  cg.n = s.p.n;
  cg.n_all = s.p.n_all;
  cg.central = viscosity.pairs == VISCOSITY_CENTRAL;
  cg.rows = s.nb;
  cg.coef = coef;
  cg.mass = s.p.m;
  cg.light = s.p.light;
  cg.v = s.p.v;
  cg.r = s.p.dv;
  cg.d = s.p.mu_dir;
  cg.q = s.p.mu_op;
  cg.diag = s.p.mu_diag;
  return cg_vec_solve(&cg, tolerance, max_iterations);
}
