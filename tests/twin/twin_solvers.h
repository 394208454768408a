/* twin_solvers.h - a cloud of particles that a solver and its brute-force twin both advance, and
 * how far apart they end. The twins know no pair lists, no packets and no store: double loops over
 * all particles, in double, from the papers' formulas. */
#ifndef TWIN_SOLVERS_H
#define TWIN_SOLVERS_H
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../../core/run/run.h"

#ifdef REAL_IS_FLOAT
#define TWIN_TOLERANCE 1e-5
#else
#define TWIN_TOLERANCE 1e-12
#endif

enum { TWIN_MOST = 600 };

/* Fluid particles 0 .. n-1 by label, then walls .. n_all-1. */
struct cloud {
  int n, n_all;
  double x[TWIN_MOST][DIM], v[TWIN_MOST][DIM], normal[TWIN_MOST][DIM], rho[TWIN_MOST], p[TWIN_MOST];
  double light[TWIN_MOST]; /* rho0/rho0_i of the fluid, 0 for walls */
  int several;             /* fluids: those of even label are half as heavy */
  double dx, dt, rho0, mass, xsph, gravity[DIM];
  struct kernel kernel;
};

static inline double twin_random(unsigned long long *seed)
{
  *seed = *seed * 6364136223846793005ULL + 1442695040888963407ULL;
  return (double)(*seed >> 11) / 9007199254740992.0;
}

/* m sum_j W(x_j) = rho0 on the full lattice */
static inline double twin_mass(const struct cloud *c)
{
  double total = 0;
  const int reach = 4, deep = DIM == 3 ? reach : 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int e = -deep; e <= deep; e++)
        total +=
          (double)kernel_W(&c->kernel, (real)(c->dx * sqrt((double)(a * a + b * b + e * e))), DIM);
  return c->rho0 / total;
}

/* A jittered lattice, squeezed to 0.92, `side` particles per axis; with walls, its two lowest
 * layers are walls that move along x. All numbers are exact in `real`. */
static inline void cloud_make(struct cloud *c, int side, int walls, int kernel,
                              unsigned long long seed)
{
  memset(c, 0, sizeof *c);
  c->dx = (double)(real)0.1;
  c->dt = (double)(real)4e-3;
  c->rho0 = 1000;
  c->gravity[DIM - 1] = (double)(real)-9.81;
  c->kernel = kernel_make(kernel, (real)(2.5 * c->dx), DIM);
  c->mass = twin_mass(c);
  const int total = DIM == 3 ? side * side * side : side * side;
  const int per_layer = total / side, n_wall = walls ? 2 * per_layer : 0;
  assert_true(total <= TWIN_MOST);
  c->n_all = total;
  c->n = total - n_wall;
  for (int k = 0; k < total; k++) {
    const int i = k < n_wall ? c->n + k : k - n_wall;
    c->light[i] = i < c->n;
    for (int d = 0, rest = k; d < DIM; d++, rest /= side) {
      const double at = rest % side + 0.25 * (2 * twin_random(&seed) - 1);
      c->x[i][d] = (double)(real)(0.92 * c->dx * at);
      c->v[i][d] = (double)(real)(2 * twin_random(&seed) - 1);
    }
    if (k < n_wall)
      for (int d = 0; d < DIM; d++) c->v[i][d] = d == 0 ? 0.5 : 0, c->normal[i][d] = d == DIM - 1;
  }
}

/* Two fluids in a motley crowd: the one of even labels has half of the rest density. */
static inline void cloud_mix(struct cloud *c)
{
  c->several = 1;
  for (int i = 0; i < c->n; i += 2) c->light[i] = 2;
}

static inline double twin_distance(const struct cloud *c, int i, int j)
{
  double r2 = 0;
  for (int d = 0; d < DIM; d++) r2 += (c->x[i][d] - c->x[j][d]) * (c->x[i][d] - c->x[j][d]);
  return sqrt(r2);
}
static inline double twin_W(const struct cloud *c, int i, int j)
{
  return (double)kernel_W(&c->kernel, (real)twin_distance(c, i, j), DIM);
}
/* component d of grad_i W(x_i - x_j) */
static inline double twin_grad(const struct cloud *c, int i, int j, int d)
{
  const double r = twin_distance(c, i, j);
  return r > 0 ? (double)kernel_dW(&c->kernel, (real)r, DIM) * (c->x[i][d] - c->x[j][d]) / r : 0;
}
static inline void twin_density(struct cloud *c)
{
  for (int i = 0; i < c->n; i++) {
    c->rho[i] = 0;
    for (int j = 0; j < c->n_all; j++) c->rho[i] += c->mass * twin_W(c, i, j);
  }
}
/* XSPH with V_ij = 2 m/(rho_i + rho_j), walls left out; of the pairs in `near` only, unless NULL */
static inline void twin_viscosity(struct cloud *c, char (*near)[TWIN_MOST])
{
  static double dv[TWIN_MOST][DIM];
  memset(dv, 0, sizeof dv);
  for (int i = 0; i < c->n; i++)
    for (int j = 0; j < c->n; j++)
      for (int d = 0; d < DIM; d++)
        if (!near || near[i][j])
          dv[i][d] += c->xsph * 2 * c->mass / (c->rho[i] + c->rho[j]) * (c->v[j][d] - c->v[i][d]) *
                      twin_W(c, i, j);
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += dv[i][d];
}

/* --- the adaptor to the runner: the only part that knows it */

struct setting {
  const char *name;
  double value;
};

static inline void set_values(const struct solver *solver, const struct setting *settings,
                              double *values)
{
  for (int k = 0; k < solver->num_params; k++) values[k] = solver->params[k].initial;
  for (; settings->name; settings++) {
    const struct param *p = param_find(solver->params, solver->num_params, settings->name);
    assert_non_null(p);
    values[p - solver->params] = settings->value;
  }
}

static inline vec to_vec(const double *from)
{
  vec a;
  for (int d = 0; d < DIM; d++) a.c[d] = (real)from[d];
  return a;
}

static inline struct scene cloud_scene(const struct cloud *c)
{
  struct scene s;
  memset(&s, 0, sizeof s);
  const size_t most = sizeof(vec) * TWIN_MOST;
  s.n = s.capacity = c->n;
  s.n_wall = s.wall_capacity = c->n_all - c->n;
  s.x = calloc(1, most), s.v = calloc(1, most);
  s.wall_x = calloc(1, most), s.wall_v = calloc(1, most), s.wall_n = calloc(1, most);
  for (int i = 0; i < c->n_all; i++) {
    const int k = i < c->n ? i : i - c->n;
    (i < c->n ? s.x : s.wall_x)[k] = to_vec(c->x[i]);
    (i < c->n ? s.v : s.wall_v)[k] = to_vec(c->v[i]);
    if (i >= c->n) s.wall_n[k] = to_vec(c->normal[i]);
  }
  for (int d = 0; d < DIM; d++) s.low.c[d] = -10, s.high.c[d] = 10;
  s.gravity = to_vec(c->gravity);
  s.common.spacing = c->dx, s.common.dt = c->dt, s.common.t_end = 1;
  s.common.support = (double)c->kernel.R / c->dx, s.common.kernel = c->kernel.kind;
  s.common.rho0 = c->rho0, s.common.xsph = c->xsph, s.common.samples = 1;
  if (c->several) {
    int number;
    assert_int_equal(scene_find_fluid(&s, c->rho0 / 2, 0, &number), OK);
    assert_int_equal(scene_set_fluid(&s, 0, number), OK);
    for (int i = 1; i < c->n; i += 2) s.fluid_of[i] = 0;
  }
  return s;
}

/* Advance the cloud's fluid by `steps` steps of the solver, or by one projection with steps = 0. */
static inline void cloud_run(struct cloud *c, const struct solver *solver,
                             const struct setting *settings, int steps)
{
  struct scene scene = cloud_scene(c);
  struct run *run;
  struct snapshot now;
  double values[64];
  set_values(solver, settings, values);
  assert_int_equal(run_create(solver, values, &scene, 0, &run), OK);
  for (int k = 0; k < steps; k++) assert_int_equal(run_step(run), OK);
  if (steps == 0) assert_int_equal(run_project(run), OK);
  assert_false(run->diverged);
  assert_int_equal(run_snapshot(run, &now), OK);
  assert_int_equal(now.n, c->n);
  for (int k = 0; k < now.n; k++) {
    const int i = now.id[k];
    for (int d = 0; d < DIM; d++)
      c->x[i][d] = (double)now.x[k].c[d], c->v[i][d] = (double)now.v[k].c[d];
    c->rho[i] = (double)now.rho[k], c->p[i] = (double)now.p[k];
  }
  snapshot_free(&now);
  run_free(run);
}

/* --- comparison */

static inline double largest_of(const double *a, int n)
{
  double most = 0;
  for (int i = 0; i < n; i++) most = fmax(most, fabs(a[i]));
  return most;
}
/* max |a - b| / scale over n numbers; infinite where one is not a number */
static inline double apart(const double *a, const double *b, int n, double scale)
{
  double most = 0;
  for (int i = 0; i < n; i++) most = isfinite(a[i]) ? fmax(most, fabs(a[i] - b[i])) : HUGE_VAL;
  return most / scale;
}
/* Positions relative to dx, the rest to its largest value; p to at least what moves a particle by
 * 0.1 dx in a step. */
static inline void assert_same_cloud(const struct cloud *a, const struct cloud *b, int steps)
{
  const double most =
    (steps > 1 ? 10 : 1) * TWIN_TOLERANCE; /* a step amplifies what the last one rounded */
  const int n = a->n * DIM;
  const double x = apart(a->x[0], b->x[0], n, a->dx),
               v = apart(a->v[0], b->v[0], n, largest_of(b->v[0], n));
  const double rho = apart(a->rho, b->rho, a->n, largest_of(b->rho, a->n));
  const double impulse = 0.1 * b->rho0 * (b->dx / b->dt) * (b->dx / b->dt);
  const double p = apart(a->p, b->p, a->n, fmax(largest_of(b->p, a->n), impulse));
  const int same = x < most && v < most && rho < most && p < most;
  if (!same || getenv("TWIN_SHOW"))
    print_message("apart: x %.2g dx, v %.2g, rho %.2g, p %.2g\n", x, v, rho, p);
  assert_true(same);
}
#endif
