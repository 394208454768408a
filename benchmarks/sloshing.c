/* Free sloshing: water in a tank swings in one of its modes, from a raised surface at rest.
 *
 * Modes of a tank: Faltinsen 1978, J. Ship Res. 22, 193, whose tank this is: 1.73 m long, water
 * 0.6 m deep, period 1.6678 s. The particles start where the linear wave moves them, by a e^(i 0)
 * grad(cosh(k y) cos(k x))/(k sinh(k H)), which lifts the surface by a cos(k x) and changes no
 * density to first order. */
#include "wave.h"

#define PARAMS(P)                                                             \
  P(length, 1.73, 1e-6, 1e6, "m", "length of the tank, to whole particles")   \
  P(depth, 0.6, 1e-6, 1e6, "m", "depth H of the water")                       \
  P(half_waves, 1, 1, 8, WHOLE, "number of the mode: half waves in the tank") \
  P(steepness, 0.05, 1e-9, 0.5, "1", "height of the surface at the wall over H")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct wave wave;
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.025;
  common->dt = 2e-3;
  common->t_end = 3.4; /* two periods */
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  struct wave *w = &s->wave;
  if (s->half_waves != floor(s->half_waves))
    return user_error("half_waves: %g found, allowed are whole numbers", (double)s->half_waves);
  if (!(scene->common.gravity > 0)) return user_error("gravity: 0 found, a wave needs some");
  TRY(wave_fill(scene, w, (double)s->length, (double)s->depth, (int)s->half_waves));
  w->amplitude = (double)s->steepness * w->depth;
  const double scale = w->amplitude / sinh(w->k * w->depth);
  for (int i = 0; i < scene->n; i++) {
    const double x = w->k * component(scene->x, i, 0), y = w->k * component(scene->x, i, DIM - 1);
    scene->x[i].c[0] -= (real)(scale * cosh(y) * sin(x));
    scene->x[i].c[DIM - 1] += (real)(scale * sinh(y) * cos(x));
  }
  return OK;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  struct wave *w = &((state *)self)->wave;
  wave_measure(w, now, w->amplitude * cos(w->omega * now->time), 1, out);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_sloshing = {
  .name = "sloshing",
  .about = "water swings in a tank, in one of its modes: its height and period are known",
  .source = "Faltinsen 1978, J. Ship Res. 22, 193; Lamb 1932, Hydrodynamics, sec. 257",
  .asks = CAN(FREE_SURFACE),
  .dims = CAN(2D),
  .measures = MEASURES_OF(WAVE_METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 0,
};
