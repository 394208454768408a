/* Stress-point SPH: pressures live on stress points that every particle carries along.
 * C. Chalk, M. Pastor, J. Peakall, D. Borman, A. Sleight, W. Murphy, R. Fuentes, Comput. Methods
 * Appl. Mech. Eng. 366 (2020) 113034, doi:10.1016/j.cma.2020.113034, in the form that section 6.4
 * and Fig. 22 of the dual-particle paper compare with: its way to place stress points, with the
 * projection of that paper (dual.h; Liu et al. 2024, doi:10.1145/3649888). Equation numbers are
 * the latter's. Wherever particles are disordered, so are their stress points.
 *
 * Differences from the paper: see DIFFERENCES below. */
#include "dual.h"
#include <limits.h>

#define DIFFERENCES                                                                               \
  DUAL_DIFFERENCES                                                                                \
  "pressures by the projection of the dual-particle paper, as in its Fig. 22; Chalk et al. "      \
  "integrate the stress of an elastic-plastic soil\n"                                             \
  "a stress point keeps its place beside its particle: X_I = x_i + offset, so that it moves "     \
  "with the particle's velocity; the offset does not turn with the flow\n"                        \
  "section 6.4 does not say where stress points start: arrangement = pair has two per particle, " \
  "at (1/4, .., 1/4) dx on either side; corner one, at the centre of the cell behind it; edges "  \
  "d, half-way to the next particle along each axis\n"                                            \
  "wall particles carry stress points too\n"                                                      \
  "V_I is the volume of a particle divided among its stress points\n"                             \
  "density = real (default) takes Eq. (13) from the real particles nearby, as S.C does"

enum { PAIR, CORNER, EDGES };

#define PARAMS_STRESS(P)                                                                   \
  PARAMS(P)                                                                                \
  P(density, DENSITY_REAL, 0, 1, "virtual|real", "where the density of Eq. (13) is taken") \
  P(arrangement, PAIR, 0, 2, "pair|corner|edges", "stress points of a particle: 2, 1 or d")

STAGE int points_each(const state *s)
{
  return s->arrangement == (real)PAIR ? 2 : s->arrangement == (real)CORNER ? 1 : DIM;
}

/* Where the k-th stress point lies beside its particle, along axis d [dx] */
STAGE real offset_of(const state *s, int k, int d)
{
  if (s->arrangement == (real)PAIR) return k == 0 ? (real)0.25 : (real)-0.25;
  return s->arrangement == (real)CORNER || k == d ? (real)0.5 : 0;
}

/* Sec. 6.4   X_I = x_i + offset */
STAGE void carry(const state *s, int I)
{
  const int each = points_each(s), i = I / each;
  for (int d = 0; d < DIM; d++) s->X[I].c[d] = s->p.x[i].c[d] + s->dx * offset_of(s, I % each, d);
}

static status project(struct run *run, void *self)
{
  state *s = (state *)self;
  if (s->p.n_all > INT_MAX / points_each(s))
    return status_set(ERR_MEMORY, "more than %d particles are too many for stress points",
                      INT_MAX / points_each(s));
  s->num_virtual = points_each(s) * s->p.n_all;
  TRY(run_density(run));
  TRY(run_virtual(run, s->num_virtual));
  sweep_over(carry, s, s->num_virtual);
  TRY(pair_up(run, s));
  return project_on(run, s);
}

static status step(struct run *run, void *s) { return advance(run, (state *)s, project); }

/* A full lattice of stress points looks the same from each of them. */
static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  const int each = points_each(s);
  (void)run;
  s->solid_volume = s->mass / s->rho0;
  s->unit_volume = s->solid_volume / (real)each;
  s->alpha0 = 0;
  for (int k = 0; k < each; k++) {
    real shift[DIM];
    for (int d = 0; d < DIM; d++) shift[d] = offset_of(s, k, d) - offset_of(s, 0, d);
    s->alpha0 += full_lattice(s, s->dx, s->unit_volume, shift);
  }
  if (s->kappa < 0) s->kappa = inner(s->gravity, s->gravity) > 0 ? (real)0.1 : 0;
  return OK;
}

static void warn(const void *self, double speed, char *text, size_t size)
{
  (void)speed;
  warn_of_kappa((double)((const state *)self)->kappa, text, size);
}

static const struct param params[] = PARAM_TABLE(PARAMS_STRESS);
static const struct field fields[] = FIELD_TABLE(FIELDS_PLACED);

const struct solver solver_stress_point = {
  .abi = SOLVER_ABI,
  .name = "stress-point",
  .about = "pressures on stress points that the particles carry along",
  .paper = "Chalk, Pastor, Peakall, Borman, Sleight, Murphy & Fuentes 2020, Comput. Methods Appl. "
           "Mech. Eng. 366, 113034, as in Liu et al. 2024, ACM Trans. Graph. 43(3), 28, Sec. 6.4",
  .doi = "10.1016/j.cma.2020.113034",
  .differences = DIFFERENCES,
  .needs = NEEDS,
  .can = DOES,
  .params = params,
  .num_params = COUNT(params),
  .fields = fields,
  .num_fields = COUNT(fields),
  .state_size = sizeof(state),
  .start = start,
  .step = step,
  .changed = NULL,
  .project = project,
  .max_dt = NULL,
  .uses = uses,
  .stop = NULL,
  .warn = warn,
};
