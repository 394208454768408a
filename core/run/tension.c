/* Surface tension from sums over pairs.
 *   akinci   N. Akinci, G. Akinci, M. Teschner, Versatile Surface Tension and Adhesion for SPH
 *            Fluids, ACM Trans. Graph. 32(6) (2013) 182, doi:10.1145/2508363.2508395
 *   he       X. He, H. Wang, F. Zhang, H. Wang, G. Wang, K. Zhou, Robust Simulation of Sparsely
 *            Sampled Thin Features in SPH-Based Free Surface Flows, ACM Trans. Graph. 34(1) (2014)
 *            7, doi:10.1145/2682630
 * Differences from the papers:
 *   strength: a tension [N/m], from which the coefficients follow (below); the papers' gamma and
 *     kappa mean another tension at every resolution. The constant of the cohesion spline, which is
 *     given for 3-D only, goes into the coefficient
 *   akinci: cohesion carries 2/3 of the tension and the normals 1/3, which is what the paper's one
 *     gamma gives for water at R = 2 dx (0.68 and 0.32); its two terms differ in unit by kg/m^3
 *   walls: no adhesion, so that they are not wetted
 *   several fluids: one tension of their common free surface, none between them
 *   he: without the air pressure
 *
 * The tension of a flat surface of pairwise forces is the excess of its normal over its tangential
 * pressure (Kirkwood & Buff 1949), sigma = 1/2 sum_ij (F_ij,z z_ij - F_ij,x x_ij) per area, summed
 * here over a half-space of the lattice. Measured with drops of 20 and 40 dx that swing in 2-D (R =
 * 2.5 to 4 dx, DFSPH, PBF, S.A): akinci shows 0.6 to 1.6 times the tension that was asked for; at R
 * = 2 dx the drop stiffens instead. he rounds corners off, but such a drop does not swing back, and
 * without viscosity it evaporates: V_i V_j (|grad c_i|^2 + |grad c_j|^2) grad W_ij is the force of
 * a pressure -kappa/4 |grad c|^2, most of which a pressure solver takes back. */
#include "forces.h"

#include <string.h>

struct tense {
  VIEW;
  struct tension tension;
};

/* Akinci Eq. (2) over 32/(pi R^3): s(q) = (1-q)^3 q^3,  for q <= 1/2: 2 (1-q)^3 q^3 - 1/64 */
STAGE lanes spline(lanes q)
{
  const lanes u = at_least(1 - q, 0), a = u * u * u * q * q * q;
  return a + positive((real)0.5 - q, a - (real)1 / 64);
}

/* He   c_i = sum_j V_j W_ij, over the fluid */
STAGE void colour(const struct tense *s, int i)
{
  lanes c = NO_LANES;
  s->p.colour[i] = 0;
  if (i >= s->p.n) return;
  for_neighbours (s, i, ij) c += of(s->p.V, ij) * W(&s->nb, ij);
  s->p.colour[i] = sum(c);
}

/* Akinci   n_i/R = sum_j V_j grad W_ij, over the fluid
 * He       grad c_i = 1/c_i sum_j V_j c_j grad W_ij */
STAGE void slant(const struct tense *s, int i)
{
  vecs n = NO_VECS;
  s->p.slant[i] = zero();
  if (i >= s->p.n) return;
  for_neighbours (s, i, ij) {
    lanes Vc = of(s->p.V, ij);
    if (s->p.colour) Vc = Vc * of(s->p.colour, ij);
    n = add(n, scale(Vc, gradW(&s->nb, ij)));
  }
  s->p.slant[i] = times(s->p.colour ? 1 / s->p.colour[i] : 1, sum(n));
}

/* Akinci   K_ij = 2 rho_0/(rho_i + rho_j),   rho = m/V; V = 0 leaves walls out
 *   dv_i = -dt light_i sum_j K_ij (cohesion m_j s(r_ij/R) x_ij/r_ij + normals (n_i - n_j)) */
STAGE void cohere(const struct tense *s, int i)
{
  const real R = s->nb.kernel.R, V = s->p.V[i], m = s->p.m[i];
  vecs a = NO_VECS;
  for_neighbours (s, i, ij) {
    const lanes q = ij.r * s->nb.kernel.inv_R, Vj = of(s->p.V, ij), mj = of(s->p.m, ij);
    const lanes K = only(ij, 2 * s->rho0 * V * positive(1 - q, Vj) / (m * Vj + mj * V));
    const lanes pull = s->tension.cohesion * mj * spline(q) / at_least(ij.r, (real)1e-6 * R);
    const vecs level = scale(s->tension.normals * R + NO_LANES, diff(s->p.slant, ij));
    a = add(a, scale(K, add(scale(pull, ij.x), level)));
  }
  s->p.dv[i] = times(-s->dt * light(&s->p, i), sum(a));
}

/* He   dv_i = dt light_i V_i/m_i sum_j V_j kappa/4 (|grad c_i|^2 + |grad c_j|^2) grad W_ij */
STAGE void contract(const struct tense *s, int i)
{
  const real own = inner(s->p.slant[i], s->p.slant[i]);
  vecs a = NO_VECS;
  for_neighbours (s, i, ij) {
    const vecs other = of(s->p.slant, ij);
    a = add(a, scale(of(s->p.V, ij) * (own + dot(other, other)), gradW(&s->nb, ij)));
  }
  const real lightness = light(&s->p, i) * s->p.V[i] / s->p.m[i];
  s->p.dv[i] = times(s->dt * lightness * s->tension.energy / 4, sum(a));
}
STAGE void add_tension(const struct tense *s, int i) { s->p.v[i] = plus(s->p.v[i], s->p.dv[i]); }

void tension_apply(const struct view *view, struct tension tension)
{
  struct tense s;
  memset(&s, 0, sizeof s);
  memcpy(&s, view, sizeof *view); /* VIEW comes first */
  s.tension = tension;
  if (tension.form == TENSION_HE) sweep_over(colour, &s, s.p.n_all);
  sweep_over(slant, &s, s.p.n_all);
  if (tension.form == TENSION_HE)
    sweep(contract, &s);
  else
    sweep(cohere, &s);
  sweep(add_tension, &s);
}

/* --- the tension of a flat surface */

/* Layers, in supports: forces reach 4 deep, gradients 3, colours 2, densities 1; each is filled as
 * deep as the next one looks. */
enum { DEEP = 4, MOST_REACH = 11, MOST_LAYERS = (DEEP + 3) * MOST_REACH + 1 };

/* A half-space of the lattice: layer k lies (k + 1/2) dx deep. */
struct half_space {
  struct kernel kernel;
  double dx, mass, rho0;
  int form, reach;
  double rho[MOST_LAYERS], V[MOST_LAYERS], colour[MOST_LAYERS], slant[MOST_LAYERS];
};

/* A particle of layer i and one of layer j: x_ij along the surface, z_ij out of it, r_ij */
struct bond {
  int i, j;
  double x, z, r;
};
typedef double bond_term(const struct half_space *h, const struct bond *b);

static double sum_bonds(const struct half_space *h, int layer, bond_term *term)
{
  const int n = h->reach, deep = DIM == 3 ? n : 0;
  double total = 0;
  for (int a = -n; a <= n; a++)
    for (int b = -deep; b <= deep; b++)
      for (int c = -n; c <= n && c <= layer; c++) {
        const double r = h->dx * sqrt((double)(a * a + b * b + c * c));
        const struct bond bond = {layer, layer - c, -a * h->dx, -c * h->dx, r};
        if (r < (double)h->kernel.R) total += term(h, &bond);
      }
  return total;
}

static double bond_W(const struct half_space *h, const struct bond *b)
{
  return (double)kernel_W(&h->kernel, (real)b->r, DIM);
}
/* grad W_ij = x_ij times this */
static double bond_slope(const struct half_space *h, const struct bond *b)
{
  return b->r > 0 ? (double)kernel_dW(&h->kernel, (real)b->r, DIM) / b->r : 0;
}
static double bond_colour(const struct half_space *h, const struct bond *b)
{
  return h->V[b->j] * bond_W(h, b);
}
static double bond_slant(const struct half_space *h, const struct bond *b)
{
  const double c = h->form == TENSION_HE ? h->colour[b->j] : 1;
  return h->V[b->j] * c * bond_slope(h, b) * b->z;
}
static double bond_K(const struct half_space *h, const struct bond *b)
{
  return 2 * h->rho0 / (h->rho[b->i] + h->rho[b->j]);
}

/* 1/2 (F_z z - F_x x) of a bond, by each force at strength 1 */
static double virial_cohesion(const struct half_space *h, const struct bond *b)
{
  const double q = b->r / (double)h->kernel.R, a = (1 - q) * (1 - q) * (1 - q) * q * q * q;
  const double s = q > 0.5 ? a : 2 * a - 1.0 / 64;
  if (b->r <= 0) return 0;
  return -0.5 * bond_K(h, b) * h->mass * h->mass * s / b->r * (b->z * b->z - b->x * b->x);
}
static double virial_normals(const struct half_space *h, const struct bond *b)
{
  const double n = (double)h->kernel.R * (h->slant[b->i] - h->slant[b->j]);
  return -0.5 * bond_K(h, b) * h->mass * n * b->z;
}
static double virial_energy(const struct half_space *h, const struct bond *b)
{
  const double g = h->slant[b->i] * h->slant[b->i] + h->slant[b->j] * h->slant[b->j];
  const double F = 0.25 * h->V[b->i] * h->V[b->j] * g * bond_slope(h, b);
  return 0.5 * F * (b->z * b->z - b->x * b->x);
}

static void fill_half_space(struct half_space *h)
{
  const int last = (DEEP + 3) * h->reach;
  for (int k = 0; k <= last; k++) {
    h->rho[k] = h->mass * sum_bonds(h, k, bond_W);
    h->V[k] = h->mass / h->rho[k];
  }
  h->rho0 = h->rho[last];
  for (int k = 0; k <= last - h->reach; k++) h->colour[k] = sum_bonds(h, k, bond_colour);
  for (int k = 0; k <= last - 2 * h->reach; k++)
    h->slant[k] = sum_bonds(h, k, bond_slant) / (h->form == TENSION_HE ? h->colour[k] : 1);
}

/* sum over the layers near the surface, per area */
static double tension_of(const struct half_space *h, bond_term *virial)
{
  double total = 0;
  for (int k = 0; k < DEEP * h->reach; k++) total += sum_bonds(h, k, virial);
  return total / (DIM == 3 ? h->dx * h->dx : h->dx);
}

struct tension tension_make(int form, double sigma, const struct kernel *kernel, double dx,
                            double mass)
{
  struct half_space h;
  struct tension t = {form, 0, 0, 0};
  memset(&h, 0, sizeof h);
  h.kernel = *kernel;
  h.dx = dx;
  h.mass = mass;
  h.form = form;
  h.reach = (int)ceil((double)kernel->R / dx - 1e-6);
  if (h.reach > MOST_REACH) h.reach = MOST_REACH; /* supports are at most 10 dx */
  fill_half_space(&h);
  if (form == TENSION_HE) {
    t.energy = (real)(sigma / tension_of(&h, virial_energy));
    return t;
  }
  t.cohesion = (real)(2 * sigma / 3 / tension_of(&h, virial_cohesion));
  t.normals = (real)(sigma / 3 / tension_of(&h, virial_normals));
  return t;
}
