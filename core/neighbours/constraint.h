/* constraint.h - the density constraint C_i = rho_i/rho_0 - 1 of a particle and how it gives way:
 * the sums that PBF, PCISPH, IISPH and DFSPH share.
 *
 * Several fluids: every particle has the mass m that a particle of the reference fluid (rest
 * density rho_0) would have, so that rho_i = sum_j m_j W_ij is rho_0 in every fluid at rest and
 * steps of density at an interface are sharp (the number density of Solenthaler & Pajarola 2008,
 * doi:10.2312/SCA/SCA08/211-218). What differs is how lightly a particle moves: its true mass is
 * m_i/light_i with light_i = rho_0/rho_0i, 0 for walls. A force that gives a particle of the
 * reference fluid the acceleration a gives it light_i a. */
#ifndef CONSTRAINT_H
#define CONSTRAINT_H
#include "../particles/particles.h"
#include "pairs.h"

/* light_i; 1 where the scene has one fluid (p.light is NULL) */
STAGE real light(const struct particles *p, int i) { return p->light ? p->light[i] : 1; }
/* light_j: 0 in the lanes of walls, 1 for the others where the scene has one fluid */
STAGE lanes light_of(const struct particles *p, struct packet ij)
{
  return p->light ? of(p->light, ij) : only_below(ij, p->n, 1 + NO_LANES);
}

struct constraint {
  real rho;     /* sum_j m_j W_ij                                            [kg/m^d] */
  vec gradient; /* sum_j m_j grad W_ij                                       [kg/m^(d+1)] */
  real yield;   /* light_i |gradient|^2 + sum_j light_j |m_j grad W_ij|^2    [kg^2/m^(2d+2)] */
};

/* Of particle i against the list nb, fluid and walls. */
STAGE struct constraint constraint_at(const struct particles *p, const struct pairs *nb, int i)
{
  lanes rho = NO_LANES, others = NO_LANES;
  vecs own = NO_VECS;
  for_pairs (nb, i, ij) {
    const lanes m = of(p->m, ij);
    const vecs g = scale(m, gradW(nb, ij));
    rho += m * W(nb, ij);
    own = add(own, g);
    others += light_of(p, ij) * dot(g, g);
  }
  struct constraint c;
  c.rho = sum(rho);
  c.gradient = sum(own);
  c.yield = light(p, i) * inner(c.gradient, c.gradient) + sum(others);
  return c;
}
#endif
