/* A drop that oscillates in a central force field, f = -B^2 x, between two ellipses.
 *
 * Monaghan & Rafiee 2013, Int. J. Numer. Meth. Fluids 71, 537, App. A; Sun et al. 2017; De Courcy
 * et al. 2024: A0 = B gives a period of 4.8273/B. In 3-D the drop is stretched in the plane of the
 * first and the last axis at the start and all three axes oscillate. The field is given to the run
 * as the scene's pull, so that solvers apply it where they apply gravity: set through velocities
 * before a step it would move particles unprojected, and methods that move first would lose 2 B^2 t
 * dt of their volume. */
#include "drop.h"

#define PARAMS(P)                                                                      \
  P(radius, 1, 1e-6, 1e6, "m", "radius at the start")                                  \
  P(strain, 1, 1e-9, 1e9, "1/s", "rate A0 at which the first axis grows at the start") \
  P(field, 1, 1e-9, 1e9, "1/s", "B of the force field -B^2 x")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct drop drop;
  struct crossings swings;
  struct truth_drop start;
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.05 : 0.125;
  common->dt = DIM == 2 ? 4e-3 : 0.01;
  common->t_end = 4.8273430084023893; /* one period */
  common->gravity = 0;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double R = (double)s->radius, A = (double)s->strain, B = (double)s->field;
  struct ellipsoid ball;
  double gradient[DIM][DIM] = {{0}};
  s->drop = (struct drop){{0, 0}, 0, 0};
  s->swings = (struct crossings){0, 0, 0, 0, 0, 0};
  s->start = (struct truth_drop){DIM, R, {0, 0, 0}, B * B};
  s->start.strain[0] = gradient[0][0] = A;
  s->start.strain[DIM - 1] = gradient[DIM - 1][DIM - 1] = -A;
  for (int d = 0; d < DIM; d++) ball.axis[d] = R;
  scene->pull = (real)(B * B);
  TRY(drop_fill(scene, &ball));
  drop_set_velocities(scene, (const double(*)[DIM])gradient);
  /* energy: A^2 + 3/2 B^2 R^2 at most in one axis */
  scene_domain_around(scene, 2 * R * (1 + A / B));
  return OK;
}

/* log(a/b) of the first and the last axis, 0 where the drop is round. */
static double elongation(const struct snapshot *now)
{
  double first = 0, last = 0;
  for (int i = 0; i < now->n; i++) {
    first += component(now->x, i, 0) * component(now->x, i, 0);
    last += component(now->x, i, DIM - 1) * component(now->x, i, DIM - 1);
  }
  return now->step > 0 ? log(first / last) : 0;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  struct truth_affine motion;
  truth_drop_at(&s->start, now->time, &motion);
  drop_measure(&s->drop, now, &motion, s->start.pull, out);
  const double period = crossings_period(&s->swings, now->time, elongation(now));
  MEASURE(out, period_error, fabs(period / truth_drop_period(&s->start) - 1));
}

#define METRICS(M, word) DROP_METRICS(M, word) | M(word, period_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_oscillating_drop = {
  .name = "oscillating-drop",
  .about = "a drop oscillates in a central force field: all paths and the period are known",
  .source = "Monaghan & Rafiee 2013, Int. J. Numer. Meth. Fluids 71, 537, App. A",
  .asks = CAN(FREE_SURFACE) | CAN(GRAVITY),
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
