/* errors.h - norms of errors that scenes share. Sums are over the fluid, whose particles have equal
 * mass; fields are compared at the particles' computed places. */
#ifndef ERRORS_H
#define ERRORS_H
#include "../core/benchmark.h"

/* Sums of the squares of an error and of the truth that it is relative to. */
struct squares {
  double error, truth;
};

static inline void squares_add(struct squares *s, double found, double truth, double weight)
{
  s->error += weight * (found - truth) * (found - truth);
  s->truth += weight * truth * truth;
}

static inline double squares_ratio(const struct squares *s)
{
  return s->truth > 0 ? sqrt(s->error / s->truth) : (double)NAN;
}

/* Relative RMS error over time, each sample standing for the time since the one before; samples
 * without a truth are left out. */
static inline double squares_over_time(struct squares *s, double found, double truth,
                                       double interval)
{
  if (!isnan(truth) && interval > 0) squares_add(s, found, truth, interval);
  return squares_ratio(s);
}

static inline double component(const vec *x, int i, int d) { return (double)x[i].c[d]; }

/* Fields of a truth at a place x[DIM]: a scalar, or a vector into value[DIM]. */
typedef double scalar_field(const void *truth, const double *x);
typedef void vector_field(const void *truth, const double *x, double *value);

static inline void place(const struct snapshot *now, int i, double x[DIM])
{
  for (int d = 0; d < DIM; d++) x[d] = component(now->x, i, d);
}

/* Relative L2 error of the velocity. */
static inline double velocity_error(const struct snapshot *now, vector_field *field,
                                    const void *truth)
{
  struct squares s = {0, 0};
  for (int i = 0; i < now->n; i++) {
    double x[DIM], v[DIM] = {0};
    place(now, i, x);
    field(truth, x, v);
    for (int d = 0; d < DIM; d++) squares_add(&s, component(now->v, i, d), v[d], 1);
  }
  return squares_ratio(&s);
}

/* Relative L2 error of the pressure [Pa]; floating: of p - <p>, both means over the particles, for
 * fluid without a free surface. NaN without a pressure. */
static inline double pressure_error(const struct snapshot *now, scalar_field *field,
                                    const void *truth, int floating)
{
  struct squares s = {0, 0};
  double found = 0, expected = 0, x[DIM];
  if (!now->p) return (double)NAN;
  for (int i = 0; i < now->n && floating; i++) {
    place(now, i, x);
    found += (double)now->p[i] / now->n;
    expected += field(truth, x) / now->n;
  }
  for (int i = 0; i < now->n; i++) {
    place(now, i, x);
    squares_add(&s, (double)now->p[i] - found, field(truth, x) - expected, 1);
  }
  return squares_ratio(&s);
}

/* Means over the support around the origin, weighted by the cubic spline, of the pressure and of
 * its truth [Pa]; both 0, as outside the fluid, where nothing is. */
struct centre {
  double found, truth;
};
static inline struct centre centre_pressure(const struct snapshot *now, scalar_field *field,
                                            const void *truth)
{
  const struct kernel kernel = kernel_make(KERNEL_CUBIC, (real)now->support, DIM);
  struct centre c = {0, 0};
  double weight = 0, x[DIM];
  for (int i = 0; i < now->n; i++) {
    const double w = (double)kernel_W(&kernel, sqrt(inner(now->x[i], now->x[i])), DIM);
    if (!(w > 0)) continue;
    place(now, i, x);
    c.found += w * (double)now->p[i];
    c.truth += w * field(truth, x);
    weight += w;
  }
  if (weight > 0) c = (struct centre){c.found / weight, c.truth / weight};
  return c;
}

static inline double kinetic(const struct snapshot *now, const vec *v)
{
  double sum = 0;
  for (int i = 0; i < now->n; i++) sum += (double)inner(v[i], v[i]) / 2;
  return sum; /* per mass of a particle */
}

/* Error of the kinetic energy, relative to what it was at the start times `kept`. */
static inline double kinetic_error(const struct snapshot *now, double kept)
{
  return fabs(kinetic(now, now->v) / (kept * kinetic(now, now->v_start)) - 1);
}

/* Angular momentum about the origin in the plane of the first two axes, per mass of a particle. */
static inline double spin(const struct snapshot *now, const vec *x, const vec *v)
{
  double sum = 0;
  for (int i = 0; i < now->n; i++)
    sum += component(x, i, 0) * component(v, i, 1) - component(x, i, 1) * component(v, i, 0);
  return sum;
}

/* --- the period of a signal, from the times at which it passes 0 --- */

struct crossings {
  int count, samples;
  double first, last;  /* crossings [s] */
  double time, signal; /* of the sample before */
};

/* Returns the period so far [s], NaN before the second crossing. A signal of exactly 0 at its first
 * sample is a crossing. */
static inline double crossings_period(struct crossings *c, double time, double signal)
{
  const int starts_at_0 = c->samples == 0 && signal == 0;
  if (starts_at_0 || (c->samples > 0 && c->signal * signal <= 0 && c->signal != 0)) {
    const double part = starts_at_0 ? 1 : c->signal / (c->signal - signal);
    c->last = starts_at_0 ? time : c->time + part * (time - c->time);
    if (c->count++ == 0) c->first = c->last;
  }
  c->samples++;
  c->time = time;
  c->signal = signal;
  return c->count > 1 ? 2 * (c->last - c->first) / (c->count - 1) : (double)NAN;
}
#endif
