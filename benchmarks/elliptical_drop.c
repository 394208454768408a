/* Evolution of an elliptical drop: a disc or ball of fluid in pure strain stays an ellipse or
 * ellipsoid, without gravity.
 *
 * Monaghan 1994, J. Comput. Phys. 110, 399, sec. 4: radius 1 m, u = -100 x, v = 100 y, to 7.6 ms.
 * In 3-D either the same in the plane of the first and the last axis, or round: the first two axes
 * shrink at half the rate. All particles' paths are known: x = map(t) X. Kinetic energy is kept,
 * the pressure is positive. */
#include "drop.h"

enum { PLANE, ROUND };

#define PARAMS(P)                                                                    \
  P(radius, 1, 1e-6, 1e6, "m", "radius at the start")                                \
  P(strain, 100, -1e9, 1e9, "1/s", "rate at which the last axis grows at the start") \
  P(stretch, PLANE, 0, 1, "plane|round", "in 3-D: which axes shrink, the first or both")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct drop drop;
  struct truth_drop start;
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.025 : 0.1;
  common->dt = DIM == 2 ? 2e-5 : 4e-5;
  common->t_end = 7.6e-3;
  common->gravity = 0;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double R = (double)s->radius, rate = (double)s->strain;
  const int is_round = DIM == 3 && s->stretch == (real)ROUND;
  struct ellipsoid ball;
  double gradient[DIM][DIM] = {{0}};
  s->drop = (struct drop){{0, 0}, 0, 0};
  s->start = (struct truth_drop){DIM, R, {0, 0, 0}, 0};
  s->start.strain[0] = is_round ? -rate / 2 : -rate;
  s->start.strain[1] = is_round ? -rate / 2 : 0;
  s->start.strain[DIM - 1] = rate;
  for (int d = 0; d < DIM; d++) {
    ball.axis[d] = R;
    gradient[d][d] = s->start.strain[d];
  }
  TRY(drop_fill(scene, &ball));
  drop_set_velocities(scene, (const double(*)[DIM])gradient);
  /* the kinetic energy is kept, so that no axis grows faster than sqrt 2 times the start's rate */
  scene_domain_around(scene, R * (0.5 + 2 * fabs(rate) * scene->common.t_end));
  return OK;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  struct truth_affine motion;
  truth_drop_at(&s->start, now->time, &motion);
  drop_measure(&s->drop, now, &motion, 0, out);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_elliptical_drop = {
  .name = "elliptical-drop",
  .about = "a disc or ball of fluid in pure strain becomes an ellipse: all paths are known",
  .source = "Monaghan 1994, J. Comput. Phys. 110, 399, sec. 4; in 3-D by Dirichlet's ellipsoids",
  .asks = CAN(FREE_SURFACE),
  .dims = CAN(2D) | CAN(3D),
  .measures = MEASURES_OF(DROP_METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 0,
};
