/* One projection of the rotating square patch: the pressure of its first step, without time
 * integration.
 *
 * A rotation that is rigid in x is free of divergence, so a projection at the start does nothing;
 * what the first step projects is that velocity carried to x + dt v. The scene is built in that
 * state with the lattice kept: the velocity that a particle at x has brought from X, x = (I + dt
 * omega J) X, v = omega J X, is v = omega (J + a I) x / (1 + a^2), a = omega dt. Its divergence, 2
 * omega a / (1 + a^2), makes the exact pressure of the projection p0(x) / (1 + a^2) for any dt,
 * with p0 the series for the rotating square (Colagrossi 2005, PhD thesis; Le Touze et al. 2013,
 * Int. J. Numer. Meth. Fluids 73, 660). */
#include "../analysis/truth.h"
#include "patch.h"

#define PARAMS(P)                                                         \
  P(side, 0.24, 1e-6, 1e6, "m", "side of the square, to whole particles") \
  P(omega, 2.0943951023931953, 1e-6, 1e6, "rad/s", "angular velocity, 2 pi/3")

typedef struct {
  PARAMS(PARAM_MEMBER)
  double length, slowness; /* the side as filled [m]; 1 + (omega dt)^2 */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.005;
  common->gravity = 0;
  common->t_end = 0;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double omega = (double)s->omega, a = omega * scene->common.dt;
  s->length = patch_side((double)s->side, scene->common.spacing);
  s->slowness = 1 + a * a;
  TRY(patch_fill(scene, (double)s->side, omega / s->slowness, omega * a / s->slowness));
  scene_domain_around(scene, s->length);
  return OK;
}

static double pressure_error(const state *s, const struct snapshot *now)
{
  const double L = s->length, omega = (double)s->omega;
  const double scale = now->rho0 * omega * omega * L * L / s->slowness;
  double error = 0, truth = 0;
  for (int i = 0; i < now->n; i++) {
    const double p =
      scale * truth_patch_pressure((double)now->x[i].c[0] / L, (double)now->x[i].c[1] / L);
    const double e = (double)now->p[i] - p;
    error += e * e;
    truth += p * p;
  }
  return sqrt(error / truth);
}

/* Of the change of velocity, - dt grad p / rho0. */
static double velocity_error(const state *s, const struct snapshot *now)
{
  const double L = s->length, omega = (double)s->omega;
  const double scale = -now->dt * omega * omega * L / s->slowness;
  double error = 0, truth = 0;
  for (int i = 0; i < now->n; i++) {
    double g[2];
    truth_patch_gradient((double)now->x[i].c[0] / L, (double)now->x[i].c[1] / L, g);
    for (int d = 0; d < 2; d++) {
      const double change = (double)(now->v[i].c[d] - now->v_start[now->id[i]].c[d]);
      const double e = change - scale * g[d];
      error += e * e;
      truth += scale * g[d] * scale * g[d];
    }
  }
  return sqrt(error / truth);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  const state *s = (const state *)self;
  if (now->step < 1) return;
  if (now->p) MEASURE(out, pressure_error, pressure_error(s, now));
  MEASURE(out, velocity_error, velocity_error(s, now));
}

#define METRICS(M, word) M(word, pressure_error) | M(word, velocity_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_first_step = {
  .name = "first-step",
  .about = "projection of the rotating square's first step, against the exact pressure",
  .source =
    "Colagrossi 2005, PhD thesis; Le Touze et al. 2013, Int. J. Numer. Meth. Fluids 73, 660",
  .asks = CAN(FREE_SURFACE) | CAN(PROJECT),
  .dims = CAN(2D),
  .measures = MEASURES_OF(METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 1,
  .judged_by = METRIC_pressure_error,
};
