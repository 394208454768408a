/* stage.h - for tests of scenes: a built scene with a snapshot whose particles may be moved. */
#ifndef STAGE_H
#define STAGE_H
#include "../../core/benchmark.h"
#include "cloud.h"

#define VALUE(out, name) ((out).value[METRIC_##name])

struct stage {
  const struct benchmark *b;
  void *self;
  struct scene scene;
  struct brute brute;
  struct snapshot now;
  real *p;
};

static inline void set_param(struct stage *s, const char *name, double value)
{
  const struct param *p = param_find(s->b->params, s->b->num_params, name);
  if (p)
    *(real *)((char *)s->self + p->offset) = (real)value;
  else if ((p = param_find(scene_param_rows, num_scene_params, name)))
    *(double *)((char *)&s->scene.common + p->offset) = value;
  assert_non_null(p);
}

static inline struct stage prepare(const struct benchmark *b)
{
  struct stage s = {.b = b, .self = calloc(1, b->state_size), .scene = new_scene(0.01)};
  for (int k = 0; k < b->num_params; k++) set_param(&s, b->params[k].name, b->params[k].initial);
  if (b->defaults) b->defaults(&s.scene.common);
  return s;
}

static inline void build(struct stage *s)
{
  s->scene.gravity.c[DIM - 1] = (real)-s->scene.common.gravity;
  must(s->b->build(&s->scene, s->self));
  must(scene_check(&s->scene));
  s->now = snapshot_of(&s->scene, &s->brute);
  s->now.p = s->p = (real *)calloc((size_t)s->now.n + 1, sizeof(real));
  s->now.step = 1;
  s->now.time = s->now.dt;
}

static inline struct stage built(const struct benchmark *b)
{
  struct stage s = prepare(b);
  build(&s);
  return s;
}

static inline struct measures measured(struct stage *s)
{
  struct measures out;
  for (int k = 0; k < NUM_METRICS; k++) out.value[k] = (double)NAN;
  s->b->measure(s->self, &s->now, &out);
  return out;
}

static inline void end(struct stage *s)
{
  brute_free(&s->brute);
  scene_free(&s->scene);
  free(s->p);
  free(s->self);
}
#endif
