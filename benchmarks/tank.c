/* Water at rest in a tank: p = rho0 g (H - y), and nothing moves. A textbook case (Archimedes;
 * Batchelor 1967, sec. 1.4); as a test of particle methods e.g. Monaghan 1994, J. Comput. Phys.
 * 110, 399. */
#include "box.h"

#define PARAMS(P)                                                          \
  P(length, 0.4, 1e-6, 1e6, "m", "length of the tank, to whole particles") \
  P(height, 0.4, 1e-6, 1e6, "m", "height H of the water")                  \
  P(depth, 0.4, 1e-6, 1e6, "m", "depth of the tank, in 3-D")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct box box; /* as filled */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.01 : 0.02;
  common->t_end = 1;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double length = (double)s->length, height = (double)s->height;
  const struct box box = {length, (double)s->depth, height + 4 * scene->common.spacing, length,
                          height};
  s->box = box;
  return box_fill(scene, &s->box);
}

static double pressure_error(const struct snapshot *now, double g, double H)
{
  double error = 0, all = 0;
  for (int i = 0; i < now->n; i++) {
    const double below = H - (double)now->x[i].c[DIM - 1];
    const double p = below > 0 ? now->rho0 * g * below : 0;
    error += ((double)now->p[i] - p) * ((double)now->p[i] - p);
    all += p * p;
  }
  return sqrt(error / all);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  const state *s = (const state *)self;
  const double g = -(double)now->gravity.c[DIM - 1], H = s->box.water_height;
  double v2 = 0;
  if (!(g > 0)) return;
  for (int i = 0; i < now->n; i++) v2 += (double)inner(now->v[i], now->v[i]);
  MEASURE(out, residual_speed, sqrt(v2 / now->n / (g * H)));
  if (now->p && now->step >= 1) MEASURE(out, pressure_error, pressure_error(now, g, H));
}

#define METRICS(M, word) M(word, residual_speed) | M(word, pressure_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_tank = {
  .name = "tank",
  .about = "water at rest in a tank: hydrostatic pressure, and nothing may move",
  .source = "Batchelor 1967, An Introduction to Fluid Dynamics, sec. 1.4",
  .asks = CAN(FREE_SURFACE),
  .dims = CAN(2D) | CAN(3D),
  .measures = MEASURES_OF(METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 0,
};
