/* drop.h - what scenes share whose exact motion is affine: drops that stay ellipsoids. */
#ifndef DROP_H
#define DROP_H
#include "../analysis/truth_drops.h"
#include "errors.h"

/* Of the samples so far. */
struct drop {
  struct squares centre;
  double time;   /* of the last sample [s] */
  double travel; /* largest sum of squared exact displacements so far [m^2] */
};

struct ellipsoid {
  double axis[DIM]; /* semi-axes [m] */
};

static inline int ellipsoid_holds(const void *self, vec x)
{
  const struct ellipsoid *e = (const struct ellipsoid *)self;
  double sum = 0;
  for (int d = 0; d < DIM; d++) sum += (double)x.c[d] * (double)x.c[d] / (e->axis[d] * e->axis[d]);
  return sum <= 1;
}

/* Fill an ellipsoid about the origin on the lattice whose cells meet there, displaced if the user
 * asked for it. */
static inline status drop_fill(struct scene *scene, const struct ellipsoid *e)
{
  const double dx = scene->common.spacing;
  vec corner = zero();
  for (int d = 0; d < DIM; d++) corner.c[d] = (real)(ceil(e->axis[d] / dx) * dx);
  TRY(scene_fill_where(scene, times(-1, corner), corner, ellipsoid_holds, e, zero()));
  scene_apply_jitter(scene);
  return OK;
}

/* v = rate x */
static inline void drop_set_velocities(struct scene *scene, const double rate[DIM][DIM])
{
  for (int i = 0; i < scene->n; i++)
    for (int d = 0; d < DIM; d++) {
      double v = 0;
      for (int e = 0; e < DIM; e++) v += rate[d][e] * component(scene->x, i, e);
      scene->v[i].c[d] = (real)v;
    }
}

static inline void affine_apply(const double m[3][3], const double x[DIM], double y[DIM])
{
  for (int d = 0; d < DIM; d++) {
    y[d] = 0;
    for (int e = 0; e < DIM; e++) y[d] += m[d][e] * x[e];
  }
}

struct affine_pressure {
  const struct truth_affine *motion;
  double rho0;
};
static inline double affine_pressure_at(const void *truth, const double *x)
{
  const struct affine_pressure *p = (const struct affine_pressure *)truth;
  double y[DIM], sum = p->motion->peak;
  affine_apply(p->motion->bowl, x, y);
  for (int d = 0; d < DIM; d++) sum -= x[d] * y[d];
  return p->rho0 * sum;
}
static inline void affine_velocity_at(const void *truth, const double *x, double *v)
{
  affine_apply(((const struct truth_affine *)truth)->rate, x, v);
}

/* Sums over the particles as they are, or over the same ones moved exactly. */
struct affine_sums {
  double moment[DIM][DIM], energy, spin;
};
static inline void affine_add(struct affine_sums *s, const double x[DIM], const double v[DIM],
                              double pull)
{
  for (int d = 0; d < DIM; d++) {
    for (int e = 0; e < DIM; e++) s->moment[d][e] += x[d] * x[e];
    s->energy += (v[d] * v[d] + pull * x[d] * x[d]) / 2;
  }
  s->spin += x[0] * v[1] - x[1] * v[0];
}

/* Roots of the second moments: about the principal axes in 2-D, along the coordinates in 3-D. */
static inline void principal_axes(const double m[DIM][DIM], double axis[DIM])
{
  const double mean = (m[0][0] + m[1][1]) / 2, half = (m[0][0] - m[1][1]) / 2;
  const double radius = sqrt(half * half + m[0][1] * m[0][1]);
  for (int d = 0; d < DIM; d++) axis[d] = sqrt(m[d][d]);
  if (DIM == 3) return;
  axis[0] = sqrt(mean + radius);
  axis[1] = sqrt(mean > radius ? mean - radius : 0);
}

static inline double axes_error(const struct affine_sums *found, const struct affine_sums *truth)
{
  struct squares s = {0, 0};
  double a[DIM], b[DIM];
  principal_axes(found->moment, a);
  principal_axes(truth->moment, b);
  for (int d = 0; d < DIM; d++) squares_add(&s, a[d], b[d], 1);
  return squares_ratio(&s);
}

/* The sums of both, and the squares of the displacements. */
static inline struct squares affine_compare(const struct snapshot *now,
                                            const struct truth_affine *motion, double pull,
                                            struct affine_sums *found, struct affine_sums *truth)
{
  struct squares moved = {0, 0};
  for (int i = 0; i < now->n; i++) {
    const int label = now->id[i];
    double from[DIM], x[DIM], v[DIM], y[DIM], w[DIM];
    for (int d = 0; d < DIM; d++) {
      from[d] = component(now->x_start, label, d);
      x[d] = component(now->x, i, d);
      v[d] = component(now->v, i, d);
    }
    affine_apply(motion->map, from, y);
    affine_apply(motion->rate, y, w);
    for (int d = 0; d < DIM; d++) squares_add(&moved, x[d] - from[d], y[d] - from[d], 1);
    affine_add(found, x, v, pull);
    affine_add(truth, y, w, pull);
  }
  return moved;
}

/* trajectory, velocity, axes, energy, pressure and centre pressure errors, and for a motion that
 * turns also that of the spin. */
static inline void drop_measure(struct drop *drop, const struct snapshot *now,
                                const struct truth_affine *motion, double pull,
                                struct measures *out)
{
  const struct affine_pressure pressure = {motion, now->rho0};
  const double interval = now->time - drop->time;
  struct affine_sums found = {.energy = 0}, truth = {.energy = 0};
  drop->time = now->time;
  if (now->step < 1 || isnan(motion->peak)) return;
  struct squares moved = affine_compare(now, motion, pull, &found, &truth);
  if (moved.truth > drop->travel) drop->travel = moved.truth;
  moved.truth = drop->travel;
  MEASURE(out, trajectory_error, squares_ratio(&moved));
  measure_velocity(now, affine_velocity_at, motion, out);
  MEASURE(out, axes_error, axes_error(&found, &truth));
  MEASURE(out, energy_error, fabs(found.energy / truth.energy - 1));
  if (motion->rate[0][1] != motion->rate[1][0])
    MEASURE(out, spin_error, fabs(found.spin / truth.spin - 1));
  if (!now->p) return;
  const struct centre c = centre_pressure(now, affine_pressure_at, &pressure);
  measure_pressure(now, affine_pressure_at, &pressure, 0, out);
  MEASURE(out, centre_pressure_error, squares_over_time(&drop->centre, c.found, c.truth, interval));
}

/* What drop_measure sets of a motion that does not turn, in word 0 or 1. */
#define DROP_METRICS(M, word)                                                  \
  M(word, trajectory_error) | VELOCITY_ERRORS(M, word) | M(word, axes_error) | \
    M(word, energy_error) | PRESSURE_ERRORS(M, word) | M(word, centre_pressure_error)
#endif
