/* A standing wave, one wavelength in a tank, that starts from a flat surface with the velocity of
 * linear theory.
 *
 * As Antuono et al. 2011, Comput. Phys. Commun. 182, 866 and Colagrossi et al. 2013, Phys. Rev. E
 * 87, 023302: g = 1 m/s^2, depth H = 1 m, wavelength 2 m, amplitude eps H/2 with eps = 0.1; theirs
 * is periodic, where this has slip walls at the crests. Linear theory is short by about (k a)^2,
 * 2.5 % at this amplitude. */
#include "wave.h"

#define PARAMS(P)                                                       \
  P(wavelength, 2, 1e-6, 1e6, "m", "wavelength and length of the tank") \
  P(depth, 1, 1e-6, 1e6, "m", "depth H of the water")                   \
  P(steepness, 0.1, 1e-9, 0.5, "1", "eps: the surface rises by eps H/2")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct wave wave;
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.04;
  common->dt = 5e-3;
  common->t_end = 7.1; /* two periods */
  common->gravity = 1;
}

/* v = grad(a g/omega cosh(k y)/cosh(k H) cos(k x)) */
static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  struct wave *w = &s->wave;
  TRY(wave_fill(scene, w, (double)s->wavelength, (double)s->depth, 2));
  const double g = scene->common.gravity, k = w->k;
  w->amplitude = (double)s->steepness * w->depth / 2;
  if (!(g > 0)) return user_error("gravity: 0 found, a wave needs some");
  const double speed = w->amplitude * g * k / wave_start_frequency(w, g) / cosh(k * w->depth);
  for (int i = 0; i < scene->n; i++) {
    const double x = k * component(scene->x, i, 0), y = k * component(scene->x, i, DIM - 1);
    scene->v[i].c[0] = (real)(-speed * cosh(y) * sin(x));
    scene->v[i].c[DIM - 1] = (real)(speed * sinh(y) * cos(x));
  }
  return OK;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  struct wave *w = &((state *)self)->wave;
  wave_measure(w, now, w->amplitude * sin(w->omega * now->time), 0, out);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_standing_wave = {
  .name = "standing-wave",
  .about = "standing wave in a tank, from a flat surface: its height and period are known",
  .source =
    "Lamb 1932, Hydrodynamics, sec. 228; as Antuono et al. 2011, Comput. Phys. Commun. 182, "
    "866",
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
