/* Curves as a few means on a common axis of time, and what is compared of them. */
#include <math.h>

#include "baseline.h"
#include "json_out.h"

static double at(const json_t *array, size_t k)
{
  const json_t *number = json_array_get(array, k);
  return json_is_number(number) ? json_number_value(number) : NAN;
}

/* The integral of the straight lines between the points from `low` to `high`, which lie between the
 * first and the last; NaN: a point of them is no number. */
static double integral(const json_t *time, const json_t *curve, double low, double high)
{
  double sum = 0;
  for (size_t k = 1; k < json_array_size(time); k++) {
    const double t0 = at(time, k - 1), t1 = at(time, k), from = fmax(t0, low), to = fmin(t1, high);
    if (!(to > from)) continue;
    const double rise = (at(curve, k) - at(curve, k - 1)) / (t1 - t0);
    sum += (to - from) * (at(curve, k - 1) + rise * (0.5 * (from + to) - t0));
  }
  return sum;
}

json_t *curve_sample(const json_t *time, const json_t *curve, const double span[2])
{
  json_t *sampled = json_array();
  const double width = (span[1] - span[0]) / CURVE_BINS;
  for (int k = 0; k < CURVE_BINS; k++) {
    const double low = span[0] + k * width;
    json_array_append_new(sampled,
                          json_out_number(integral(time, curve, low, low + width) / width));
  }
  return sampled;
}

double slope_of(const double *x, const double *y, int n)
{
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (int k = 0; k < n; k++) {
    mean_x += x[k] / n;
    mean_y += y[k] / n;
  }
  for (int k = 0; k < n; k++) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
  }
  return xx > 0 ? xy / xx : NAN;
}

struct curve_parts curve_compare(const json_t *now, const json_t *before)
{
  double x[CURVE_BINS], y[2][CURVE_BINS], squares = 0, apart = 0;
  struct curve_parts parts = {.largest = 0};
  int n = 0;
  for (size_t k = 0; k < CURVE_BINS; k++) {
    const double old = at(before, k);
    if (isnan(old)) continue; /* was none then: nothing to keep to */
    x[n] = (k + 0.5) / CURVE_BINS;
    y[0][n] = at(now, k);
    y[1][n++] = old;
    apart += (at(now, k) - old) * (at(now, k) - old);
    squares += old * old;
    parts.largest = fmax(parts.largest, fabs(old));
  }
  parts.apart = n ? sqrt(apart / n) : 0;
  parts.size = n ? sqrt(squares / n) : 0;
  for (int k = 0; k < 2; k++) parts.rate[k] = slope_of(x, y[k], n);
  return parts;
}
