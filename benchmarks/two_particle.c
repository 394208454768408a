/* Two particles alone, a spacing apart, pass each other: two droplets in free flight.
 *
 * Drops that do not touch have no pressure, so that each flies straight on (Newton's first law):
 * two particles have far less than the rest density, and a method that keeps rho <= rho0 must leave
 * them alone. What a method that keeps negative pressure does to them is its spurious cohesion. For
 * every method whose forces are central and mutual their centre moves evenly and their angular
 * momentum is kept. (The bound orbit of a pair is exact too, but only under an equation of state
 * whose rest density is that of the pair: analysis/reference/lattice.c.) */
#include "errors.h"

#define PARAMS(P)                                                                         \
  P(parting, 0.05, -1e6, 1e6, "m/s", "speed at which they part; < 0: at which they meet") \
  P(passing, 0.05, -1e6, 1e6, "m/s", "speed at which they pass, across their distance")   \
  P(drift, 0, -1e6, 1e6, "m/s", "speed of both, along their distance")

typedef struct {
  PARAMS(PARAM_MEMBER)
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.005;
  common->gravity = 0;
  common->t_end = 0.1;
}

static status build(struct scene *scene, void *self)
{
  const state *s = (const state *)self;
  const double half = scene->common.spacing / 2, drift = (double)s->drift;
  const double apart = (double)s->parting / 2, across = (double)s->passing / 2;
  TRY(scene_add(scene, scene_at(-half, 0, 0), scene_at(drift - apart, 0, -across)));
  TRY(scene_add(scene, scene_at(half, 0, 0), scene_at(drift + apart, 0, across)));
  const double fastest = 2 * (fabs(drift) + fabs(apart) + fabs(across));
  scene_domain_around(scene, 10 * half + fastest * scene->common.t_end);
  return OK;
}

/* Twice the angular momentum about the centre in the plane of the pair, per mass of a particle. */
static double pair_spin(const vec x[2], const vec v[2])
{
  const vec r = sub(x[1], x[0]), u = sub(v[1], v[0]);
  return (double)(r.c[0] * u.c[DIM - 1] - r.c[DIM - 1] * u.c[0]);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  struct squares moved = {0, 0};
  (void)self;
  if (now->n != 2) return;
  const vec r = sub(now->x[0], now->x[1]);
  MEASURE(out, pair_distance, (double)sqrt(inner(r, r)));
  if (now->step < 1) return;
  for (int i = 0; i < 2; i++)
    for (int d = 0; d < DIM; d++) {
      const double start = component(now->x_start, now->id[i], d);
      const double flown = component(now->v_start, now->id[i], d) * now->time;
      squares_add(&moved, component(now->x, i, d) - start, flown, 1);
    }
  MEASURE(out, trajectory_error, squares_ratio(&moved));
  const double spin_start = pair_spin(now->x_start, now->v_start);
  MEASURE(out, spin_error, fabs(pair_spin(now->x, now->v) / spin_start - 1));
}

#define METRICS(M, word) M(word, pair_distance) | M(word, trajectory_error) | M(word, spin_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_two_particle = {
  .name = "two-particle",
  .about = "two particles pass each other in free flight: nothing should act on them",
  .source = "Newton 1687, Principia, first law",
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
