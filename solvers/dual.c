/* The dual-particle approach: pressures live on virtual particles, velocities on real ones.
 * S. Liu, X. He, Y. Guo, Y. Chang, W. Wang, ACM Trans. Graph. 43(3), Article 28 (2024),
 * doi:10.1145/3649888. S.A  virtual particles are the real ones: ISPH of Cummins & Rudman 1999, J.
 * Comput. Phys. 152, 584-607, with the semi-analytical free surface of Nair & Tomar 2014, Comput.
 * Fluids 102, 304-314 S.B  they are copies, evened out by a few PBF iterations (Macklin & Mueller
 * 2013) S.C  they are nodes of a regular grid near the real ones Equation numbers are the first
 * paper's. Lower case indices are real particles, upper case virtual ones.
 *
 * Differences from the paper: see DIFFERENCES below. */
#include "../core/neighbours/node_keys.h"
#include "dual.h"
#include <limits.h>

#define DIFFERENCES                                                                              \
  DUAL_DIFFERENCES                                                                               \
  "S.A, S.B: V_I is full inside walls: one that fades out behind a wall's last layer makes the " \
  "wall a weak free surface\n"                                                                   \
  "S.B: Eq. (13) takes the density of the real particle that was copied: at shifted ones "       \
  "compression hides\n"                                                                          \
  "S.C: density = real (default) takes Eq. (13) from the real particles nearby: at nodes the "   \
  "kernel sum of a perfect lattice ripples about rho0, which alone raises a spurious pressure\n" \
  "S.C: nearest node and a stencil of 13 (2-D) or 33 (3-D) nodes; keys of 64 bits"

/* --- Sec. 5, S.A: the real particles themselves */

static status project_sa(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_density(run));
  TRY(run_wall_rows(run));
  TRY(run_virtual(run, s->p.n_all));
  s->num_virtual = s->num_same = s->p.n_all;
  s->at_virtual = s->among_virtual = s->at_real = s->nb;
  return project_on(run, s);
}

/* --- S.B: copies, evened out */

STAGE void copy(const state *s, int I)
{
  s->X[I] = s->p.x[I];
  s->excess[I] = I < s->p.n ? larger(s->p.rho[I] / s->rho0 - 1, 0) : -1;
  s->lambda[I] = 0;
}
/* Macklin & Mueller Eq. (11)  lambda_I = -C_I / (sum_k |grad_k C_I|^2 + eps),  C_I = max(rho_I /
 * rho0 - 1, 0) */
STAGE void multiplier(const state *s, int I)
{
  lanes number = NO_LANES, g2 = NO_LANES;
  vecs g = NO_VECS;
  for_pairs (&s->at_real, I, IJ) {
    const vecs dC = scale(s->solid_volume + NO_LANES, gradW(&s->at_real, IJ));
    number += W(&s->at_real, IJ);
    g = add(g, dC);
    g2 += dot(dC, dC);
  }
  const real C = larger(s->solid_volume * sum(number) - 1, 0);
  const vec own = sum(g);
  s->lambda[I] = -C / (inner(own, own) + sum(g2) + (real)1e-6 / sq(s->dx));
}
/* Macklin & Mueller Eq. (12)  dX_I = sum_J (lambda_I + lambda_J) m/rho0 grad_I W_IJ */
STAGE void displacement(const state *s, int I)
{
  vecs dX = NO_VECS;
  for_pairs (&s->at_real, I, IJ) {
    const lanes both = s->lambda[I] + of(s->lambda, IJ);
    dX = add(dX, scale(both * s->solid_volume, gradW(&s->at_real, IJ)));
  }
  s->shift[I] = sum(dX);
}
STAGE void displace(const state *s, int I) { s->X[I] = plus(s->X[I], s->shift[I]); }

static status project_sb(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_density(run));
  TRY(run_virtual(run, s->p.n_all));
  s->num_virtual = s->p.n_all;
  sweep_over(copy, s, s->num_virtual);
  s->at_real = s->nb; /* copies of walls stay, those of the fluid move among them */
  s->at_real.xi = s->at_real.xj = s->X;
  for (int k = 0; k < SHIFTS; k++) {
    sweep(multiplier, s);
    sweep(displacement, s);
    sweep(displace, s);
  }
  TRY(pair_up(run, s));
  return project_on(run, s);
}

/* --- S.C: nodes of a grid */

enum { STENCIL = DIM == 2 ? 13 : 33 };

/* Sec. 5.1 (2)  k = round((x_i - x_0) / d_v), the node nearest to a real particle;
 * none for walls that the fluid cannot feel. */
STAGE void nearest(const state *s, int i)
{
  long long k[DIM];
  const real inverse = 1 / (s->virtual_spacing * s->dx);
  for (int d = 0; d < DIM; d++)
    k[d] = node_whole(rint((s->p.x[i].c[d] - s->origin.c[d]) * inverse));
  const int felt = i < s->p.n || grid_occupied(&s->grid, s->cells, s->p.x[i], 2);
  s->keys[i] = felt ? key_of(k) : NO_KEY;
}

/* Sec. 5.1 (2)  candidates k + s: the node and its neighbours, s in {-1, 0, 1}^d,
 * and two steps along each axis. */
STAGE void stencil(const state *s, int i)
{
  long long k[DIM], step[DIM];
  unsigned long long *out = s->keys + s->num_keys + (long long)STENCIL * i;
  node_of(s->keys[i], k);
  for (int n = 0; n < STENCIL; n++) {
    const int axis = n - (STENCIL - 2 * DIM), cube = n;
    for (int d = 0, rest = cube; d < DIM; d++, rest /= 3)
      step[d] = k[d] + (axis < 0 ? rest % 3 - 1 : 0);
    if (axis >= 0) step[axis / 2] += axis % 2 ? 2 : -2;
    out[n] = key_of(step);
  }
}
STAGE void place(const state *s, int I)
{
  long long k[DIM];
  node_of(s->keys[s->num_keys + I], k);
  for (int d = 0; d < DIM; d++)
    s->X[I].c[d] = s->origin.c[d] + s->virtual_spacing * s->dx * (real)k[d];
}

/* Sec. 5.1, steps (2) to (6) */
static status generate_nodes(struct run *run, state *s)
{
  for (int d = 0; d < DIM; d++) {
    const unsigned long long draw = (unsigned long long)(run_step_number(run) * DIM + d);
    const real part = s->offset == (real)OFFSET_RANDOM ? (real)run_random(run, draw) : 0;
    s->origin.c[d] = part * s->virtual_spacing * s->dx;
  }
  if (s->p.n_all > INT_MAX / (STENCIL + 1))
    return status_set(ERR_MEMORY, "more than %d particles are too many for S.C",
                      INT_MAX / (STENCIL + 1));
  s->keys = run_keys(run, s->p.n_all * (STENCIL + 1));
  if (!s->keys) return status_set(ERR_MEMORY, "no memory for the virtual particles");
  sweep_over(nearest, s, s->p.n_all);
  s->num_keys = run_unique_keys(run, s->keys, s->p.n_all);
  sweep_over(stencil, s, s->num_keys);
  s->num_virtual = run_unique_keys(run, s->keys + s->num_keys, s->num_keys * STENCIL);
  if (s->num_virtual < 0) return status_set(ERR_MEMORY, "no memory for the virtual particles");
  TRY(run_virtual(run, s->num_virtual));
  sweep_over(place, s, s->num_virtual);
  return OK;
}

static status project_sc(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_density(run));
  TRY(generate_nodes(run, s));
  TRY(pair_up(run, s));
  return project_on(run, s);
}

/* --- Algorithm 1 */

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  if (s->virtual_spacing <= 0) s->virtual_spacing = 1; /* S.A and S.B have no such parameter */
  s->solid_volume = s->unit_volume = s->mass / s->rho0;
  for (int d = 0; d < DIM; d++) s->unit_volume *= s->virtual_spacing;
  const real at_node[3] = {0, 0, 0};
  s->alpha0 = full_lattice(s, s->virtual_spacing * s->dx, s->unit_volume, at_node);
  if (s->kappa < 0) s->kappa = inner(s->gravity, s->gravity) > 0 ? (real)0.1 : 0;
  return OK;
}

static void warn(const void *self, double speed, char *text, size_t size)
{
  (void)speed;
  warn_of_kappa((double)((const state *)self)->kappa, text, size);
}

static status step_sa(struct run *run, void *s) { return advance(run, (state *)s, project_sa); }
static status step_sb(struct run *run, void *s) { return advance(run, (state *)s, project_sb); }
static status step_sc(struct run *run, void *s) { return advance(run, (state *)s, project_sc); }

static const struct param params[] = PARAM_TABLE(PARAMS), params_sc[] = PARAM_TABLE(PARAMS_SC);
static const struct field fields_sa[] = FIELD_TABLE(FIELDS), fields_sb[] = FIELD_TABLE(FIELDS_SB),
                          fields_sc[] = FIELD_TABLE(FIELDS_PLACED);

#define STRATEGY(label, text, also_can, the_params, the_fields, the_step, the_project)      \
  {                                                                                         \
    .abi = SOLVER_ABI, .name = label, .about = text,                                        \
    .paper = "Liu, He, Guo, Chang & Wang 2024, ACM Trans. Graph. 43(3), 28",                \
    .doi = "10.1145/3649888", .differences = DIFFERENCES, .needs = NEEDS,                   \
    .can = DOES | (also_can), .params = the_params, .num_params = COUNT(the_params),        \
    .fields = the_fields, .num_fields = COUNT(the_fields), .state_size = sizeof(state),     \
    .start = start, .step = the_step, .project = the_project, .max_dt = NULL, .uses = uses, \
    .stop = NULL, .warn = warn                                                              \
  }

const struct solver solver_dual_sa =
  STRATEGY("dual-sa", "ISPH: pressures on the particles themselves (dual-particle strategy S.A)",
           CAN(PERIODIC) | CAN(ISOTROPIC), params, fields_sa, step_sa, project_sa);
const struct solver solver_dual_sb =
  STRATEGY("dual-sb", "pressures on copies evened out by PBF shifting (dual-particle strategy S.B)",
           CAN(ISOTROPIC), params, fields_sb, step_sb, project_sb);
const struct solver solver_dual_sc = STRATEGY(
  "dual-sc", "pressures on the nodes of a grid near the particles (dual-particle strategy S.C)", 0u,
  params_sc, fields_sc, step_sc, project_sc);
