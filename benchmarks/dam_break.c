/* Collapse of a column of water in a box.
 *
 * Martin & Moyce 1952, Phil. Trans. R. Soc. Lond. A 244, 312-324: a column a wide and 2a high, here
 * with a = 0.35 m, in a box 4.6 a long; results are compared in Z = z/a against T = t sqrt(2 g/a).
 * Inviscid, so the scale is free. The front is the 99.9 % quantile of x over the fluid below a
 * tenth of the column's height, plus dx/2 to the surface of its particles. It is compared where the
 * table has a point in 0.8 <= T <= 3 that lies in the box, and only for a column twice as high as
 * wide. Pressure: at the first sample after a step, against the exact pressure at t = 0+ (truth.h),
 * if t < 0.05 sqrt(a/g). */
#include <stdlib.h>

#include "../analysis/truth.h"
#include "box.h"

#define PARAMS(P)                                                             \
  P(width, 0.35, 1e-6, 1e6, "m", "width a of the column, to whole particles") \
  P(height, 0.7, 1e-6, 1e6, "m", "height of the column")                      \
  P(box_length, 1.6, 1e-6, 1e6, "m", "length of the box, inside")             \
  P(box_height, 1.6, 1e-6, 1e6, "m", "height of the box's walls, inside")     \
  P(depth, 0.35, 1e-6, 1e6, "m", "depth of box and column, in 3-D")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct box box;        /* as filled */
  double pressure_error; /* at t = 0+; NaN before */
  double T, Z;           /* of the last sample */
  double deviation;      /* sum of |Z / Z_measured - 1| */
  int next, compared;    /* point of the table */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.01 : 0.025;
  common->t_end = 1;
  common->xsph = 0.02;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const struct box box = {(double)s->box_length, (double)s->depth, (double)s->box_height,
                          (double)s->width, (double)s->height};
  s->box = box;
  s->pressure_error = s->Z = (double)NAN;
  s->T = s->deviation = 0;
  s->next = s->compared = 0;
  return box_fill(scene, &s->box);
}

static int descending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x < y) - (x > y);
}

/* Front over the width, NaN where no fluid is left at the bottom. */
static double front(const state *s, const struct snapshot *now)
{
  const double bottom = 0.1 * s->box.water_height;
  double *x = (double *)malloc((size_t)now->n * sizeof *x), z = (double)NAN;
  int low = 0;
  for (int i = 0; x && i < now->n; i++)
    if ((double)now->x[i].c[DIM - 1] < bottom) x[low++] = (double)now->x[i].c[0];
  if (low > 0) {
    qsort(x, (size_t)low, sizeof *x, descending);
    z = x[low / 1000] + now->dx / 2;
  }
  free(x);
  return z / s->box.water_length;
}

/* Take the points of the table between the last sample and this one, linearly in between. */
static double front_error(state *s, double T, double Z)
{
  const double *table_T, *table_Z, wall = s->box.length / s->box.water_length;
  const int points = truth_front_points(&table_T, &table_Z);
  const int proportions = fabs(s->box.water_height / s->box.water_length - 2) < 0.05;
  for (; proportions && s->next < points && table_T[s->next] <= T * (1 + 1e-6); s->next++) {
    const double at = table_T[s->next], truth = table_Z[s->next];
    const double z = s->Z + (Z - s->Z) * (at - s->T) / (T - s->T);
    if (at < 0.8 || at > 3 || truth >= wall || isnan(z)) continue;
    s->deviation += fabs(z / truth - 1);
    s->compared++;
  }
  s->T = T;
  s->Z = Z;
  return s->compared > 0 ? s->deviation / s->compared : (double)NAN;
}

static double clamped(real x, double high) { return fmin(fmax((double)x, 0), high); }

static double pressure_error(const state *s, const struct snapshot *now, double g)
{
  const double a = s->box.water_length, H = s->box.water_height;
  double error = 0, all = 0;
  for (int i = 0; i < now->n; i++) {
    const double x = clamped(now->x[i].c[0], a), y = clamped(now->x[i].c[DIM - 1], H);
    const double p = now->rho0 * g * H * truth_column_pressure(a, H, x, y);
    error += ((double)now->p[i] - p) * ((double)now->p[i] - p);
    all += p * p;
  }
  return sqrt(error / all);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  const double g = -(double)now->gravity.c[DIM - 1], a = s->box.water_length;
  const double Z = front(s, now), T = now->time * sqrt(2 * g / a);
  MEASURE(out, front_position, Z);
  if (!(g > 0)) return;
  MEASURE(out, front_error, front_error(s, T, Z));
  if (now->p && isnan(s->pressure_error) && now->step >= 1 && now->time < 0.05 * sqrt(a / g))
    s->pressure_error = pressure_error(s, now, g);
  MEASURE(out, pressure_error, s->pressure_error);
}

#define METRICS(M, word) M(word, front_position) | M(word, front_error) | M(word, pressure_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_dam_break = {
  .name = "dam-break",
  .about = "collapse of a column of water in a box, against the measured front",
  .source = "Martin & Moyce 1952, Phil. Trans. R. Soc. Lond. A 244, 312-324",
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
  .judged_by = METRIC_front_error,
};
