/* A block of fluid in free fall: p = 0 and every particle follows the same parabola (Galilei 1638).
 *
 * With a fixed step dt, symplectic Euler gives x - x0 = v0 t + g t (t + dt)/2 when it moves with
 * the new velocity and v0 t + g t (t - dt)/2 when it moves with the old one, both exactly. A method
 * may do either; the trajectory error is against the nearer of the two, relative to v0 t + g t^2/2,
 * so that it shows pressure where there is none and not the step. The velocity is v0 + g t for
 * both. */
#include "../core/benchmark.h"

#define PARAMS(P)                                            \
  P(side, 0.2, 1e-6, 1e6, "m", "side of the square or cube") \
  P(speed, 0, -1e6, 1e6, "m/s", "velocity at the start, horizontal")

typedef struct {
  PARAMS(PARAM_MEMBER)
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.01 : 0.02;
  common->t_end = 0.5;
}

static status build(struct scene *scene, void *self)
{
  const state *s = (const state *)self;
  const double side = (double)s->side, t = scene->common.t_end;
  TRY(scene_fill_box(scene, zero(), scene_at(side, side, side), scene_at((double)s->speed, 0, 0),
                     NULL));
  const double fall = 0.5 * sqrt((double)inner(scene->gravity, scene->gravity)) * t * t;
  scene_domain_around(scene, side + 1.5 * fall + 1.5 * fabs((double)s->speed) * t);
  return OK;
}

/* Relative L2 difference of the displacement from v0 t + g t (t + lead)/2. */
static double trajectory_error(const struct snapshot *now, double lead)
{
  const double t = now->time;
  double error = 0, all = 0;
  for (int i = 0; i < now->n; i++) {
    const int label = now->id[i];
    for (int d = 0; d < DIM; d++) {
      const double v0 = (double)now->v_start[label].c[d], g = (double)now->gravity.c[d];
      const double moved = (double)now->x[i].c[d] - (double)now->x_start[label].c[d];
      const double e = moved - (v0 * t + g * t * (t + lead) / 2), truth = v0 * t + g * t * t / 2;
      error += e * e;
      all += truth * truth;
    }
  }
  return sqrt(error / all);
}

static double velocity_error(const struct snapshot *now)
{
  double error = 0, all = 0;
  for (int i = 0; i < now->n; i++)
    for (int d = 0; d < DIM; d++) {
      const double start = (double)now->v_start[now->id[i]].c[d];
      const double truth = start + (double)now->gravity.c[d] * now->time;
      const double e = (double)now->v[i].c[d] - truth;
      error += e * e;
      all += truth * truth;
    }
  return sqrt(error / all);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  (void)self;
  if (now->step < 1) return;
  const double late = trajectory_error(now, -now->dt), early = trajectory_error(now, now->dt);
  MEASURE(out, trajectory_error, late < early ? late : early);
  MEASURE(out, velocity_error, velocity_error(now));
}

#define METRICS(M, word) M(word, trajectory_error) | M(word, velocity_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_free_fall = {
  .name = "free-fall",
  .about = "a block in free fall: no pressure, no relative motion",
  .source = "Galilei 1638, Discorsi, third day",
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
