/* cloud.h - for tests: comparing numbers, clouds of particles, and pair lists by brute force. */
#ifndef CLOUD_H
#define CLOUD_H
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../../core/metric.h"
#include "../../core/scene/scene.h"

#define IN_FLOAT (sizeof(real) == sizeof(float))

/* Within `tolerance` in double, or `coarse` in float; NaN never is. */
#define near_to(found, expected, tolerance, coarse) \
  check_near(#found, found, expected, IN_FLOAT ? (coarse) : (tolerance), __LINE__)
static inline void check_near(const char *what, double found, double expected, double tolerance,
                              int line)
{
  if (fabs(found - expected) <= tolerance) return;
  print_error("line %d: %s is %.17g, expected %.17g within %g\n", line, what, found, expected,
              tolerance);
  fail();
}

#define must(call) check_ok(call, __LINE__)
static inline void check_ok(status result, int line)
{
  if (result == OK) return;
  print_error("line %d: %s\n", line, status_sentence());
  fail();
}

/* The call fails by the user's mistake, with a sentence that holds these words. */
#define refused(call, words) check_refused(call, words, __LINE__)
static inline void check_refused(status result, const char *words, int line)
{
  if (result == ERR_USER && strstr(status_sentence(), words)) return;
  print_error("line %d: status %d, '%s' does not hold '%s'\n", line, (int)result, status_sentence(),
              words);
  fail();
}

static inline struct scene new_scene(double dx)
{
  struct scene scene;
  memset(&scene, 0, sizeof scene);
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&scene.common + scene_param_rows[k].offset) = scene_param_rows[k].initial;
  scene.common.spacing = dx;
  scene.seed = 1;
  return scene;
}

static inline vec all_axes(double x) { return scene_at(x, x, x); }

/* --- a snapshot of a scene at its start, with pair lists by brute force --- */

struct brute {
  struct pairs pairs;
  int *first, *last, *list;
  vec *x, *v;
  int *id;
};

static inline double image(double x, double period)
{
  return period > 0 ? x - period * round(x / period) : x;
}

static inline const struct pairs *brute_pairs(const struct snapshot *now)
{
  struct brute *b = (struct brute *)now->cache;
  int slots = 0;
  free(b->list);
  b->list = (int *)malloc(sizeof(int) * (size_t)(now->n + 1) * (size_t)(now->n_all + LANES));
  for (int i = 0; i < now->n; i++) {
    b->first[i] = slots;
    for (int j = 0; j < now->n_all; j++) {
      double r2 = 0;
      for (int d = 0; d < DIM; d++) {
        const double e = (double)(now->x[i].c[d] - now->x[j].c[d]);
        r2 += image(e, (double)now->period.c[d]) * image(e, (double)now->period.c[d]);
      }
      if (r2 < now->support * now->support) b->list[slots++] = j;
    }
    b->last[i] = slots;
    while (slots % LANES) b->list[slots++] = i;
  }
  b->pairs = (struct pairs){.first = b->first, .last = b->last, .list = b->list, .xi = now->x};
  b->pairs.xj = now->x;
  b->pairs.kernel = kernel_make(KERNEL_CUBIC, (real)now->support, DIM);
  b->pairs.period = now->period;
  for (int d = 0; d < DIM; d++) b->pairs.periodic |= now->period.c[d] > 0;
  b->pairs.rows = now->n;
  b->pairs.slots = slots;
  return &b->pairs;
}

/* m such that a full lattice has rho0 (cubic spline) */
static inline double full_mass(const struct scene_params *c)
{
  const double R = c->support * c->spacing;
  const struct kernel kernel = kernel_make(KERNEL_CUBIC, (real)R, DIM);
  const int reach = (int)ceil(c->support);
  double sum = 0;
  for (int i = -reach; i <= reach; i++)
    for (int j = -reach; j <= reach; j++)
      for (int k = DIM == 3 ? -reach : 0; k <= (DIM == 3 ? reach : 0); k++)
        sum += (double)kernel_W(&kernel, (real)(c->spacing * sqrt(i * i + j * j + k * k)), DIM);
  return c->rho0 / sum;
}

/* The snapshot's x, v and id may be changed; x_start and v_start are the scene's. */
static inline struct snapshot snapshot_of(const struct scene *s, struct brute *b)
{
  const size_t all = (size_t)(s->n + s->n_wall + 1);
  memset(b, 0, sizeof *b);
  b->x = (vec *)calloc(all, sizeof(vec));
  b->v = (vec *)calloc(all, sizeof(vec));
  b->id = (int *)calloc(all, sizeof(int));
  b->first = (int *)calloc(all, sizeof(int));
  b->last = (int *)calloc(all, sizeof(int));
  memcpy(b->x, s->x, sizeof(vec) * (size_t)s->n);
  memcpy(b->v, s->v, sizeof(vec) * (size_t)s->n);
  if (s->n_wall > 0) memcpy(b->x + s->n, s->wall_x, sizeof(vec) * (size_t)s->n_wall);
  for (int i = 0; i < s->n; i++) b->id[i] = i;
  struct snapshot now;
  memset(&now, 0, sizeof now);
  now.n = now.num_start = s->n;
  now.n_all = s->n + s->n_wall;
  now.x = b->x;
  now.v = b->v;
  now.id = b->id;
  now.dt = s->common.dt;
  now.rho0 = s->common.rho0;
  now.dx = s->common.spacing;
  now.mass = full_mass(&s->common);
  now.support = s->common.support * s->common.spacing;
  now.gravity = s->gravity;
  now.low = s->low;
  now.high = s->high;
  now.period = s->period;
  now.x_start = s->x;
  now.v_start = s->v;
  now.pairs = brute_pairs;
  now.cache = b;
  return now;
}

static inline void brute_free(struct brute *b)
{
  free(b->first);
  free(b->last);
  free(b->list);
  free(b->x);
  free(b->v);
  free(b->id);
}
#endif
