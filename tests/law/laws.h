/* laws.h - small runs on given particles, for tests over the registry of solvers. */
#ifndef LAWS_H
#define LAWS_H
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants the five above */
#include <cmocka.h>

#include "../../core/run/driver.h"

enum { SIDE = DIM == 2 ? 12 : 7 };
static const double DX = 0.01, DT = 1e-3;

/* Rounding that a few steps may leave, relative to the scale of what is compared. */
#ifdef REAL_IS_FLOAT
#define ROUNDING 2e-3
#else
#define ROUNDING 1e-9
#endif

/* A scene with defaults and nothing in it. */
static inline struct scene empty_scene(double gravity)
{
  struct scene s;
  memset(&s, 0, sizeof s);
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&s.common + scene_param_rows[k].offset) = scene_param_rows[k].initial;
  s.common.spacing = DX;
  s.common.dt = DT;
  s.common.support = 2.5;
  s.seed = 7;
  s.gravity = zero();
  s.gravity.c[DIM - 1] = (real)-gravity;
  for (int d = 0; d < DIM; d++) {
    s.low.c[d] = -10;
    s.high.c[d] = 10;
  }
  return s;
}

static inline real swirl_speed(vec x, int d)
{
  return d == 0 ? 2 * x.c[1] : d == 1 ? -2 * x.c[0] : 0;
}

/* A block of SIDE^DIM particles about the origin, turning at 2 rad/s, displaced by jitter (dx),
 * plus a velocity. */
static inline struct scene block(double gravity, double jitter, double spin, vec velocity)
{
  struct scene s = empty_scene(gravity);
  vec low, high;
  for (int d = 0; d < DIM; d++) {
    low.c[d] = (real)(-SIDE * DX / 2);
    high.c[d] = (real)(SIDE * DX / 2);
  }
  assert_int_equal(scene_fill_box(&s, low, high, velocity, NULL), OK);
  s.common.jitter = jitter;
  if (jitter > 0) scene_apply_jitter(&s);
  for (int i = 0; i < s.n; i++)
    for (int d = 0; d < DIM; d++) s.v[i].c[d] += (real)spin * swirl_speed(s.x[i], d);
  return s;
}

/* A copy of a scene's fluid, so that a test can change one and keep the other. */
static inline struct scene copy_of(const struct scene *from)
{
  struct scene s = *from;
  s.x = malloc(sizeof(vec) * (size_t)(from->n + 1));
  s.v = malloc(sizeof(vec) * (size_t)(from->n + 1));
  memcpy(s.x, from->x, sizeof(vec) * (size_t)from->n);
  memcpy(s.v, from->v, sizeof(vec) * (size_t)from->n);
  s.capacity = from->n;
  s.wall_x = s.wall_v = s.wall_n = NULL;
  s.n_wall = s.wall_capacity = 0;
  return s;
}

/* Positions and velocities by label after `steps` steps. */
struct outcome {
  int n;
  vec *x, *v;
};

static inline struct outcome outcome_of(const struct solver *solver, struct scene *scene, int steps)
{
  struct run *run;
  double values[64];
  for (int k = 0; k < solver->num_params; k++) {
    values[k] = solver->params[k].initial;
    /* a density term measured off the particles sees the ripple of the kernel sum: not part of
     * these laws */
    if (strcmp(solver->params[k].name, "kappa") == 0) values[k] = 0;
  }
  const status made = run_create(solver, values, scene, 0, &run);
  if (made != OK) fail_msg("%s: %s", solver->name, status_sentence());
  for (int k = 0; k < steps; k++) {
    assert_int_equal(run_step(run), OK);
    if (run->diverged) fail_msg("%s: %s", solver->name, run->reason);
  }
  struct snapshot now;
  assert_int_equal(run_snapshot(run, &now), OK);
  struct outcome out = {now.n, malloc(sizeof(vec) * (size_t)(now.n + 1)),
                        malloc(sizeof(vec) * (size_t)(now.n + 1))};
  for (int i = 0; i < now.n; i++) {
    out.x[now.id[i]] = now.x[i];
    out.v[now.id[i]] = now.v[i];
  }
  snapshot_free(&now);
  run_free(run);
  return out;
}

static inline void outcome_free(struct outcome *out)
{
  free(out->x);
  free(out->v);
}

static inline double norm_of(vec a)
{
  double s = 0;
  for (int d = 0; d < DIM; d++) s += (double)a.c[d] * (double)a.c[d];
  return sqrt(s);
}

/* The largest |a_i - b_i|. */
static inline double largest_difference(const vec *a, const vec *b, int n)
{
  double most = 0;
  for (int i = 0; i < n; i++) {
    const double r = norm_of(sub(a[i], b[i]));
    if (!(r <= most)) most = r;
  }
  return most;
}

/* Every solver that can do `asks`; the test states what it skips. */
#define FOR_SOLVERS(solver, asks)                                                     \
  for (int k_ = 0; k_ < num_solvers; k_++)                                            \
    for (const struct solver *solver = solvers[k_]; solver; solver = NULL)            \
      if (solver_lacks(solver, (asks) | (DIM == 2 ? CAN(2D) : CAN(3D))))              \
        print_message("%s is skipped: it cannot %s\n", solver->name,                  \
                      solver_lacks(solver, (asks) | (DIM == 2 ? CAN(2D) : CAN(3D)))); \
      else
#endif
