/* errors.h - norms of errors that scenes share. Sums are over the fluid, whose particles have equal
 * mass; fields are compared at the particles' computed places. */
#ifndef ERRORS_H
#define ERRORS_H
#include <stdlib.h>
#include "../core/base/sorted.h"
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

/* Norms of an error over the particles, relative to the truth's: sum |e| / sum |f|, the root of
 * sum e^2 / sum f^2, the 99.9 percentile and the largest of |e| over the largest |f| (a single
 * stray particle decides the last). NaN where the truth is 0 everywhere. */
struct norms {
  double l1, l2, p999, most;
};

/* error [n], is sorted: lengths of the errors; truth [n]: of the truth. */
static inline struct norms norms_of(double *error, const double *truth, int n)
{
  double sum = 0, sum_truth = 0, largest = 0;
  struct squares s = {0, 0};
  for (int i = 0; i < n; i++) {
    sum += error[i];
    sum_truth += truth[i];
    s.error += error[i] * error[i];
    s.truth += truth[i] * truth[i];
    if (truth[i] > largest) largest = truth[i];
  }
  struct norms found = {(double)NAN, squares_ratio(&s), (double)NAN, (double)NAN};
  if (!(largest > 0)) return found;
  sort_numbers(error, n);
  found.l1 = sum / sum_truth;
  found.p999 = error[(int)(0.999 * (n - 1))] / largest;
  found.most = error[n - 1] / largest;
  return found;
}

/* Lengths of the errors of the velocity and of its truth [m/s]. */
static inline void velocity_lengths(const struct snapshot *now, vector_field *field,
                                    const void *truth, double *error, double *size)
{
  for (int i = 0; i < now->n; i++) {
    double x[DIM], v[DIM] = {0}, e2 = 0, v2 = 0;
    place(now, i, x);
    field(truth, x, v);
    for (int d = 0; d < DIM; d++) {
      const double e = component(now->v, i, d) - v[d];
      e2 += e * e;
      v2 += v[d] * v[d];
    }
    error[i] = sqrt(e2);
    size[i] = sqrt(v2);
  }
}

/* Of the pressure [Pa]; floating: of p - <p>, both means over the particles, for fluid without a
 * free surface. */
static inline void pressure_lengths(const struct snapshot *now, scalar_field *field,
                                    const void *truth, int floating, double *error, double *size)
{
  double found = 0, expected = 0, x[DIM];
  for (int i = 0; i < now->n && floating; i++) {
    place(now, i, x);
    found += (double)now->p[i] / now->n;
    expected += field(truth, x) / now->n;
  }
  for (int i = 0; i < now->n; i++) {
    place(now, i, x);
    const double f = field(truth, x) - expected;
    error[i] = fabs((double)now->p[i] - found - f);
    size[i] = fabs(f);
  }
}

/* The metrics of a field's error, as in MEASURES_OF and as numbers: relative L2, L1, 99.9
 * percentile, largest. */
#define FIELD_ERRORS(M, word, field)                                                  \
  (M(word, field##_error) | M(word, field##_error_l1) | M(word, field##_error_p999) | \
   M(word, field##_error_max))
#define VELOCITY_ERRORS(M, word) FIELD_ERRORS(M, word, velocity)
#define PRESSURE_ERRORS(M, word) FIELD_ERRORS(M, word, pressure)
#define MEASURE_NORMS(out, field, found)          \
  do {                                            \
    const struct norms norms = found; /* sorts */ \
    MEASURE(out, field##_error, norms.l2);        \
    MEASURE(out, field##_error_l1, norms.l1);     \
    MEASURE(out, field##_error_p999, norms.p999); \
    MEASURE(out, field##_error_max, norms.most);  \
  } while (0)

/* Room for the lengths of errors and of the truth, to be released by free(); NULL without memory.
 */
static inline double *lengths_make(int n)
{
  return (double *)malloc(2 * sizeof(double) * (size_t)n + 1);
}

/* All norms of the velocity's error; nothing without memory for them. */
static inline void measure_velocity(const struct snapshot *now, vector_field *field,
                                    const void *truth, struct measures *out)
{
  double *lengths = lengths_make(now->n);
  if (!lengths) return;
  velocity_lengths(now, field, truth, lengths, lengths + now->n);
  MEASURE_NORMS(out, velocity, norms_of(lengths, lengths + now->n, now->n));
  free(lengths);
}

/* The same of the pressure's, where the solver has one. */
static inline void measure_pressure(const struct snapshot *now, scalar_field *field,
                                    const void *truth, int floating, struct measures *out)
{
  double *lengths = now->p ? lengths_make(now->n) : NULL;
  if (!lengths) return;
  pressure_lengths(now, field, truth, floating, lengths, lengths + now->n);
  MEASURE_NORMS(out, pressure, norms_of(lengths, lengths + now->n, now->n));
  free(lengths);
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
