/* Three particles in a row that are pulled apart, the middle one off the centre.
 *
 * Liu, He, Guo, Chang & Wang 2024, ACM Trans. Graph. 43(3), 28, Figs. 3 and 4: dx 0.005 m, support
 * 0.0125 m; the outer particles leave at 0.05 m/s, the middle one starts 0.2 dx to the right. A
 * sound solver brings it back to the middle. outer=kept holds the outer velocities in every step;
 * outer=free only sets them at the start, and tension then stops the pull after about 25 ms. The
 * motion is along x, in two dimensions. */
#include "../core/benchmark.h"

#define PARAMS(P)                                                                              \
  P(outer, 0, 0, 1, "kept|free", "are the outer velocities held, or only given at the start?") \
  P(speed, 0.05, 0, 1e6, "m/s", "speed of the outer particles")                                \
  P(shift, 0.2, -1, 1, "dx", "displacement of the middle particle from the centre")

typedef struct {
  PARAMS(PARAM_MEMBER)
} state;

enum { LEFT, MIDDLE, RIGHT };

static void defaults(struct scene_params *common)
{
  common->spacing = 0.005;
  common->t_end = 0.1;
  common->gravity = 0;
}

static status build(struct scene *scene, void *self)
{
  const state *s = (const state *)self;
  const double dx = scene->common.spacing, speed = (double)s->speed;
  TRY(scene_add(scene, scene_at(-dx, 0, 0), scene_at(-speed, 0, 0)));
  TRY(scene_add(scene, scene_at((double)s->shift * dx, 0, 0), zero()));
  TRY(scene_add(scene, scene_at(dx, 0, 0), scene_at(speed, 0, 0)));
  scene_domain_around(scene, 10 * dx + 2 * speed * scene->common.t_end);
  return OK;
}

/* The outer particles' velocity, in every step. */
static void drive(struct scene *scene, const void *self, struct particles p, double time)
{
  const state *s = (const state *)self;
  (void)scene, (void)time;
  for (int i = 0; i < p.n && s->outer == 0; i++) {
    if (p.id[i] == MIDDLE) continue;
    p.v[i] = scene_at((double)(p.id[i] == LEFT ? -s->speed : s->speed), 0, 0);
  }
}

static double distance(vec a, vec b)
{
  const vec e = sub(a, b);
  return (double)sqrt(inner(e, e));
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  vec at[3] = {zero(), zero(), zero()};
  (void)self;
  for (int i = 0; i < now->n; i++) at[now->id[i]] = now->x[i];
  const double left = distance(at[MIDDLE], at[LEFT]), right = distance(at[RIGHT], at[MIDDLE]);
  MEASURE(out, gap_left, left);
  MEASURE(out, gap_right, right);
  MEASURE(out, gap_difference, right - left);
}

#define METRICS(M, word) M(word, gap_left) | M(word, gap_right) | M(word, gap_difference)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_three_particle = {
  .name = "three-particle",
  .about = "three particles pulled apart, the middle one off the centre: does tension centre it?",
  .source = "Liu, He, Guo, Chang & Wang 2024, ACM Trans. Graph. 43(3), 28, Figs. 3 and 4",
  .asks = CAN(FREE_SURFACE),
  .dims = CAN(2D),
  .measures = MEASURES_OF(METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = drive,
  .measure = measure,
  .projection = 0,
};
