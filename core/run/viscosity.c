/* Viscosity of Newtonian fluids.
 *   explicit   Monaghan, Rep. Prog. Phys. 68 (2005) 1703, Sec. 8.2, as the Laplacian of Weiler
 *   implicit   M. Weiler, D. Koschier, M. Brand, J. Bender, A Physically Consistent Implicit
 *              Viscosity Solver for SPH Fluids, Comput. Graph. Forum 37(2) (2018) 145,
 *              doi:10.1111/cgf.13349
 * Differences from the paper:
 *   0.01 h^2 is not added to |x_ij|^2: no term is singular without it (it takes 1 to 4 % away)
 *   mu_ij = 2 mu_i mu_j/(mu_i + mu_j) between fluids (Cleary & Monaghan 1999), mu_i at walls
 *   walls hold the fluid: their particles pull with their velocity and the volume m_j/rho_0;
 *     wall_slip = free leaves them out
 *   Jacobi's preconditioner with the mean of each block's diagonal, not the inverse block
 *   starts from v*, not from v* plus the last step's change
 * On a square or cubic lattice the pairs along the axes are too few: with the cubic spline and R =
 * 2.5 dx a shear along an axis has 0.83 of mu (2-D; 3-D: 0.87), one along a diagonal 1.17 (1.15);
 * R = 4 dx: 0.97 and 1.02. The mean over directions is 1.00, which disordered particles have. */
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

/* Eq. (6)   F_i = V_i mu lap v_i = -sum_j f_ij x_ij (x_ij . v_ij),
 *           f_ij = 2 (d + 2) mu_ij V_i V_j |W'_ij| / r_ij^3 */
STAGE lanes friction(const struct viscous *s, int i, struct packet ij)
{
  const real own = 2 * (DIM + 2) * s->p.V[i];
  const lanes r2 = at_least(ij.r * ij.r, (real)1e-12 * sq(s->nb.kernel.R));
  return positive(ij.r,
                  own * viscosity_of(s, i, ij) * volume_of(s, ij) * slope_over_r(&s->nb, ij) / r2);
}

/* dv_i = dt F_i light_i / m_i */
STAGE void drag(const struct viscous *s, int i)
{
  vecs F = NO_VECS;
  for_neighbours (s, i, ij)
    F = add(F, scale(-friction(s, i, ij) * dot(ij.x, diff(s->p.v, ij)), ij.x));
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

/* Eq. (8)   (m_i/light_i) v_i + dt sum_j f_ij x_ij (x_ij . v_ij) = (m_i/light_i) v*_i */
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
  cg.rows = s.nb;
  cg.coef = coef;
  cg.mass = s.p.m;
  cg.light = s.p.light;
  cg.v = s.p.v;
  cg.r = s.p.dv;
  cg.d = s.p.search;
  cg.q = s.p.pull;
  cg.diag = s.p.stiff;
  return cg_vec_solve(&cg, tolerance, max_iterations);
}
