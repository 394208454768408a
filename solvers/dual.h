/* dual.h - the projection that the dual-particle strategies share: pressures live on virtual
 * particles, velocities on real ones. A strategy places the virtual particles and hands over the
 * pair lists; this file does the rest.
 * S. Liu, X. He, Y. Guo, Y. Chang, W. Wang, ACM Trans. Graph. 43(3), Article 28 (2024),
 * doi:10.1145/3649888. Lower case indices are real particles, upper case virtual ones. */
#ifndef DUAL_H
#define DUAL_H
#include "../core/linear/cg.h"
#include "../core/solver.h"
#include <string.h>

/* From the paper, whatever the strategy. */
#define DUAL_DIFFERENCES                                                                        \
  "Eqs. (9), (14), (15) use |W'|: as printed the Laplacian has the wrong sign\n"                \
  "Eq. (13) is divided once more by dt; kappa is a number of order 0.1 (0 without gravity)\n"   \
  "Eq. (8) printed, or saturated at the lattice's volume (default): the printed one lets the "  \
  "interior of a jittered lattice act as free surface\n"                                        \
  "V_I is scaled by (virtual spacing / dx)^d, or the pressure comes out multiplied by it\n"     \
  "CG runs in the V-weighted inner product, where the printed matrix is symmetric\n"            \
  "Eq. (16) printed, or the exact adjoint of Eq. (11) (gradient = adjoint)\n"                   \
  "Eq. (17) acts on the velocity, on approach only: as printed it adds m/s to Pa/m\n"           \
  "Algorithm 1 starts its last line from v*, not from v^n\n"                                    \
  "virtual particles without fluid near them (less than 0.1 % of their kernel sum) are solid: " \
  "removed, with a Neumann condition\n"

enum { VOLUME_PRINTED, VOLUME_SATURATED };
enum { GRADIENT_PRINTED, GRADIENT_ADJOINT };
enum { DENSITY_VIRTUAL, DENSITY_REAL };
enum { OFFSET_FIXED, OFFSET_RANDOM };
enum { SHIFTS = 5 };                                  /* PBF iterations of S.B */
enum { LIST_AT_VIRTUAL, LIST_VIRTUAL, LIST_AT_REAL }; /* the run's pair lists */
#define SATURATION ((real)0.85) /* kernel sum at which a virtual particle counts as full */
#define SOLID ((real)0.001)     /* fluid part of the kernel sum below which it is solid */

#define PARAMS(P)                                                                                 \
  P(volume, VOLUME_SATURATED, 0, 1, "printed|saturated", "volume of a virtual particle, Eq. (8)") \
  P(gradient, GRADIENT_PRINTED, 0, 1, "printed|adjoint",                                          \
    "pressure gradient: Eq. (16) or the adjoint of Eq. (11)")                                     \
  P(kappa, -1, -1, 100, "1", "density compensation, Eq. (13); -1: 0.1 with gravity, 0 without")   \
  P(tolerance, 1e-4, 0, 1, "1", "relative residual at which CG stops")                            \
  P(max_iterations, 1000, 1, 1e6, WHOLE, "largest number of CG iterations")                       \
  P(fixed_iterations, 0, 0, 1e6, WHOLE, "exactly so many CG iterations; 0: by tolerance")

#define PARAMS_SC(P)                                                                       \
  PARAMS(P)                                                                                \
  P(density, DENSITY_REAL, 0, 1, "virtual|real", "where the density of Eq. (13) is taken") \
  P(virtual_spacing, 1, 0.5, 4, "dx", "spacing of the virtual particles")                  \
  P(offset, OFFSET_FIXED, 0, 1, "fixed|random", "origin of the grid: fixed, or anew in every step")

#define FIELDS(F)                                                                    \
  F(real, VI, VIRTUAL, STEP, "m^d", "volume of a virtual particle, Eq. (8)")         \
  F(real, wet, VIRTUAL, STEP, "1", "1, or 0 for a solid virtual particle")           \
  F(real, source, VIRTUAL, STEP, "1/s^2", "right-hand side D_I, Eqs. (11) and (13)") \
  F(real, diag, VIRTUAL, STEP, "m^3/kg/m^2",                                         \
    "diagonal of the matrix, Eq. (15), clamped to alpha_0")                          \
  F(real, pI, VIRTUAL, STEP, "Pa", "pressure of a virtual particle")                 \
  F(real, r, VIRTUAL, STEP, "1/s^2", "residual of CG")                               \
  F(real, d, VIRTUAL, STEP, "Pa", "direction of CG")                                 \
  F(real, q, VIRTUAL, STEP, "1/s^2", "matrix times direction of CG")                 \
  F(vec, lift, VIRTUAL, STEP, "1/m",                                                 \
    "sum_k V_k grad_J W_Jk / sum_k V_k W_Jk of the adjoint gradient")                \
  F(vec, hold, WALL, STEP, "m/s",                                                    \
    "change of velocity that holds a particle off the walls, Eq. (17)")

#define FIELDS_SB(F)                                                                          \
  FIELDS(F)                                                                                   \
  F(vec, X, VIRTUAL, KEPT, "m", "position of a virtual particle")                             \
  F(real, excess, VIRTUAL, KEPT, "1",                                                         \
    "max(rho - rho0, 0) / rho0 at the real particle; -1 on a wall")                           \
  F(real, lambda, ALL, STEP, "m^2", "multiplier of the shifting, Macklin & Mueller Eq. (11)") \
  F(vec, shift, ALL, STEP, "m", "displacement of a virtual particle in one shifting iteration")

#define FIELDS_PLACED(F) \
  FIELDS(F)              \
  F(vec, X, VIRTUAL, KEPT, "m", "position of a virtual particle")

/* One state for all strategies; a strategy's tables name the members that it uses. */
typedef struct {
  VIEW;
  PARAMS_SC(PARAM_MEMBER)
  real arrangement; /* stress points: number of one of their arrangements */
  FIELDS_SB(FIELD_MEMBER)
  struct pairs at_virtual, among_virtual, at_real; /* I -> j, I -> J, i -> J */
  int num_virtual, num_same; /* S.A: as many are the real particles themselves */
  real *alpha;               /* alpha_IJ, one per slot of among_virtual */
  real alpha0, unit_volume,
    solid_volume;           /* Eq. (15) of a full lattice; V_I and V_s of a full lattice */
  vec origin;               /* S.C: position of the node (0, .., 0) [m] */
  unsigned long long *keys; /* S.C: nodes as keys */
  int num_keys;
} state;

/* --- Sec. 3.3: volumes and the source term on virtual particles */

/* Eq. (7)   V_j = m / rho_j on the fluid; on the walls the volume of a full lattice */
STAGE lanes volume_j(const state *s, struct packet Ij)
{
  return or_else(of(s->p.V, Ij), s->solid_volume);
}

/* Eq. (8)   V_I = sum_j V_j^2 W_Ij, or saturated V_I = V_0 min(1, c_I/0.85), c_I = sum_j V_j W_Ij;
 *           V_0 on a wall's particle that feels no fluid: behind the last layer is more wall, and
 *           a volume that fades out there would open the wall's inner layers as a free surface
 * Eq. (12)  vbar_I = sum_fluid V_j v_j W_Ij / sum_fluid V_j W_Ij
 * Eq. (11)  D_I = -1/dt sum_j V_j (v_j - vbar_I) . grad_I W_Ij
 * Eq. (13)  D_I += kappa max(rho_I - rho0, 0) / (rho0 dt^2),
 *           or with the mean over fluid in place of rho_I,
 *           sum_fluid V_j (rho_j/rho0 - 1) W_Ij = sum_fluid (V_0 - V_j) W_Ij */
STAGE void source(const state *s, int I)
{
  lanes c = NO_LANES, c_fluid = NO_LANES, V2 = NO_LANES, number = NO_LANES, div = NO_LANES;
  lanes crowd = NO_LANES;
  vecs momentum = NO_VECS, gradient = NO_VECS;
  for_pairs (&s->at_virtual, I, Ij) {
    const lanes w = W(&s->at_virtual, Ij), V = volume_j(s, Ij), fluid_w = of(s->p.V, Ij) * w;
    c += V * w;
    V2 += V * V * w;
    number += w;
    crowd += positive(of(s->p.V, Ij), s->solid_volume - of(s->p.V, Ij)) * w;
    c_fluid += fluid_w;
    momentum = add(momentum, scale(fluid_w, of(s->p.v, Ij)));
  }
  const real cI = sum(c), cf = sum(c_fluid);
  const int is_fluid = cf > SOLID * cI;
  const vec vbar = is_fluid ? times(1 / cf, sum(momentum)) : zero();
  for_pairs (&s->at_virtual, I, Ij) {
    const vecs Vg = scale(volume_j(s, Ij), gradW(&s->at_virtual, Ij));
    div += dot(difference(vbar, of(s->p.v, Ij)), Vg);
    gradient = add(gradient, Vg);
  }
  const real at_nodes = larger(s->mass * sum(number) / s->rho0 - 1, 0);
  const real nearby = is_fluid ? larger(sum(crowd) / cf, 0) : 0;
  const real dense = s->excess                          ? larger(s->excess[I], 0)
                     : s->density == (real)DENSITY_REAL ? nearby
                                                        : at_nodes;
  const real scaled = s->unit_volume / s->solid_volume;
  const int is_wall = s->excess ? s->excess[I] < 0 : I >= s->p.n && I < s->num_same;
  s->VI[I] = is_wall && !is_fluid                ? s->unit_volume
             : s->volume == (real)VOLUME_PRINTED ? scaled * sum(V2)
                                                 : s->unit_volume * smaller(1, cI / SATURATION);
  s->wet[I] = is_fluid;
  s->source[I] = is_fluid ? sum(div) / s->dt + s->kappa * dense / sq(s->dt) : 0;
  if (s->lift) s->lift[I] = is_fluid ? times(1 / cf, sum(gradient)) : zero();
}

/* --- Sec. 4: the pressure Poisson equation */

/* Eq. (15)  alpha_IJ = 2/rho0 V_J |W'_IJ| / (r_IJ + eta),
 *           alpha_I = max(sum_J alpha_IJ, alpha_0) - sum_solid alpha_IJ */
STAGE void matrix(const state *s, int I)
{
  lanes full = NO_LANES, open = NO_LANES;
  const real mine = s->wet[I];
  for_pairs (&s->among_virtual, I, IJ) {
    const lanes a =
      positive(IJ.r, 2 / s->rho0 * of(s->VI, IJ) * slope_over_r(&s->among_virtual, IJ));
    const lanes to_fluid = mine * of(s->wet, IJ) * a;
    keep(s->alpha, IJ, to_fluid);
    full += a;
    open += to_fluid;
  }
  const real sum_full = sum(full), to_solid = sum_full - sum(open);
  s->diag[I] =
    mine > 0 ? larger(larger(sum_full, s->alpha0) - to_solid, (real)1e-6 * s->alpha0) : 1;
  s->pI[I] = 0;
}

/* Eq. (16)  G_i = sum_J V_J p_J grad_i W_iJ;   Eq. (18)  v_i = v*_i - dt/rho0 G_i
 * adjoint   v_i = v*_i - dt/rho_i sum_J V_J p_J [grad_i W_iJ + W_iJ lift_J]
 * and the pressure at the real particle, for the record: p_i = sum_J V_J p_J W_iJ / sum_J V_J W_iJ
 */
STAGE void correct(const state *s, int i)
{
  vecs G = NO_VECS;
  lanes pressure = NO_LANES, weight = NO_LANES;
  for_pairs (&s->at_real, i, iJ) {
    const lanes V = of(s->VI, iJ) * of(s->wet, iJ), Vp = V * of(s->pI, iJ), w = W(&s->at_real, iJ);
    G = add(G, scale(Vp, gradW(&s->at_real, iJ)));
    if (s->lift) G = add(G, scale(Vp * w, of(s->lift, iJ)));
    pressure += Vp * w;
    weight += V * w;
  }
  const real total = sum(weight), rho = s->lift ? s->p.rho[i] : s->rho0;
  s->p.v[i] = madd(s->p.v[i], -s->dt / rho, sum(G));
  s->p.p[i] = total > 0 ? sum(pressure) / total : 0;
}

/* Eq. (17)  v_i -= sum_s V_s W_is [(v_i - v_s) . n_s]^- n_s */
STAGE void hold_off_walls(const state *s, int i)
{
  vecs dv = NO_VECS;
  for_neighbours (s, i, ij) {
    const vecs n = of(s->p.normal, ij);
    const lanes approach = at_most(dot(diff(s->p.v, ij), n), 0);
    dv = add(dv, scale(-s->solid_volume * W(&s->nb, ij) * approach, n));
  }
  s->hold[i] = sum(dv);
}
STAGE void add_hold(const state *s, int i) { s->p.v[i] = plus(s->p.v[i], s->hold[i]); }

static status solve(struct run *run, state *s)
{
  sweep_over(source, s, s->num_virtual);
  s->alpha = run_coefficients(run, LIST_VIRTUAL, s->among_virtual.slots);
  if (!s->alpha) return status_set(ERR_MEMORY, "no memory for the matrix");
  sweep_over(matrix, s, s->num_virtual);
  struct cg cg;
  cg.n = s->num_virtual;
  cg.rows = s->among_virtual;
  cg.coef = s->alpha;
  cg.diag = s->diag;
  cg.weight = s->VI;
  cg.b = s->source;
  cg.x = s->pI;
  cg.r = s->r;
  cg.d = s->d;
  cg.q = s->q;
  const int fixed = (int)s->fixed_iterations;
  const struct cg_result result =
    cg_solve(&cg, fixed ? 0 : (double)s->tolerance, fixed ? fixed : (int)s->max_iterations);
  run_iterations(run, "pressure", result.iterations, result.residual, fixed || result.converged);
  return OK;
}

/* Sec. 3.4, steps (2) to (6) but for the move; virtual particles and lists are in the state. */
static status project_on(struct run *run, state *s)
{
  TRY(solve(run, s));
  sweep(correct, s);
  if (s->p.n_all > s->p.n) {
    sweep(hold_off_walls, s);
    sweep(add_hold, s);
  }
  return OK;
}

/* --- pair lists of virtual particles that are not the real ones */

static status pair_up(struct run *run, state *s)
{
  TRY(run_sort_virtual(run));
  TRY(run_pairs(run, LIST_AT_VIRTUAL, SET_VIRTUAL, SET_ALL, &s->at_virtual));
  TRY(run_pairs(run, LIST_VIRTUAL, SET_VIRTUAL, SET_VIRTUAL, &s->among_virtual));
  return run_pairs(run, LIST_AT_REAL, SET_FLUID, SET_VIRTUAL, &s->at_real);
}

/* --- Algorithm 1 */

/* alpha_0 of Eq. (15): 2/rho0 V_0 sum |W'|/r over a full lattice of virtual particles, seen from
 * `shift` spacings off one of them. */
STAGE real full_lattice(const state *s, real spacing, real volume, const real shift[DIM])
{
  const struct kernel *k = &s->nb.kernel;
  const int reach = (int)(k->R / spacing) + 1;
  double total = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = DIM == 3 ? -reach : 0; c <= (DIM == 3 ? reach : 0); c++) {
        const int node[3] = {a, b, c};
        real r2 = 0;
        for (int d = 0; d < DIM; d++) r2 += sq((real)node[d] + shift[d]);
        const real r = spacing * sqrt(r2);
        if (r > 0) total -= (double)(kernel_dW(k, r, DIM) / r);
      }
  return 2 / s->rho0 * volume * (real)total;
}

static status advance(struct run *run, state *s, status (*project)(struct run *, void *))
{
  TRY(run_move(run)); /* x += dt v, with the projected v */
  TRY(run_neighbours(run));
  TRY(run_forces(run));   /* v* = v + dt g, then viscosity */
  return project(run, s); /* v = v* - dt/rho0 grad p */
}

static int uses(const void *self, const char *field)
{
  const state *s = (const state *)self;
  return strcmp(field, "lift") != 0 || s->gradient == (real)GRADIENT_ADJOINT;
}

#define NEEDS (HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(V) | HAS(p) | HAS(normal))
#define DOES                                                                                      \
  (CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) | CAN(PROJECT) | \
   CAN(VISCOSITY) | CAN(TENSION) | CAN(MOVING_WALLS) | CAN(EMITTERS))
#endif
