#include "orders.h"

#include <math.h>
#ifdef SPHBENCH_HAVE_GSL
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#endif

enum { MOST_LEVELS = 64 };
#define LOWEST_ORDER 0.05
#define HIGHEST_ORDER 12.0

/* log (h^p - r^p) */
static double log_size(double h, double r, double p)
{
  return r > 0 ? log(pow(h, p) - pow(r, p)) : p * log(h);
}

/* The order between two levels: where log_size grows as the logarithm of the error does. It rises
 * with p, so halving finds it. */
double order_local(const struct level *coarse, const struct level *fine, double r)
{
  if (!(coarse->error > 0 && fine->error > 0 && coarse->h > fine->h && fine->h > r)) return NAN;
  const double wanted = log(coarse->error / fine->error);
  if (!(r > 0)) return wanted / log(coarse->h / fine->h);
  double low = LOWEST_ORDER, high = HIGHEST_ORDER;
  for (int k = 0; k < 100; k++) {
    const double p = (low + high) / 2;
    const double grown = log_size(coarse->h, r, p) - log_size(fine->h, r, p);
    if (grown < wanted)
      low = p;
    else
      high = p;
  }
  const double p = (low + high) / 2;
  return p > 1.01 * LOWEST_ORDER && p < 0.99 * HIGHEST_ORDER ? p : NAN;
}

#ifndef SPHBENCH_HAVE_GSL
status order_fit(const struct level *levels, int n, double h_reference, struct order *fit)
{
  (void)levels, (void)n, (void)h_reference, (void)fit;
  return user_error("this build has no GSL, which fits the orders; install libgsl-dev and build "
                    "again");
}
#else

struct line {
  double slope, slope_sd, level;
};

/* y = level + slope x; the scatter counts as at least what the weights say. */
static struct line fit_line(const double *x, const double *w, const double *y, int n, int known_sd)
{
  struct line line;
  double c00, c01, c11, chi2;
  gsl_fit_wlinear(x, 1, w, 1, y, 1, (size_t)n, &line.level, &line.slope, &c00, &c01, &c11, &chi2);
  const double scatter = chi2 / (n - 2);
  line.slope_sd = sqrt(c11 * (known_sd && scatter < 1 ? 1 : scatter));
  return line;
}

static int take(const struct level *levels, int n, double r, struct level *used)
{
  int taken = 0;
  for (int k = 0; k < n && taken < MOST_LEVELS; k++)
    if (levels[k].error > 0 && isfinite(levels[k].error) && levels[k].h > r)
      used[taken++] = levels[k];
  return taken;
}

status order_fit(const struct level *levels, int n, double r, struct order *fit)
{
  struct level used[MOST_LEVELS];
  double x[MOST_LEVELS], y[MOST_LEVELS], w[MOST_LEVELS], p = 1;
  struct line line = {1, 0, 0};
  *fit = (struct order){NAN, NAN, NAN, NAN, take(levels, n, r, used)};
  if (fit->n < 3)
    return user_error("an order needs at least 3 levels with an error, %d found", fit->n);
  int known_sd = 1;
  for (int k = 0; k < fit->n; k++) known_sd &= used[k].sd > 0;
  for (int round = 0; round < 100; round++) {
    for (int k = 0; k < fit->n; k++) {
      x[k] = log_size(used[k].h, r, p) / p;
      y[k] = log(used[k].error);
      w[k] = known_sd ? 1 / (used[k].sd * used[k].sd) : 1;
    }
    line = fit_line(x, w, y, fit->n, known_sd);
    const double next = fmin(fmax(line.slope, LOWEST_ORDER), HIGHEST_ORDER);
    if (!(r > 0) || fabs(next - p) < 1e-13) break;
    p = (p + next) / 2; /* the slope falls as p rises */
  }
  if (r > 0 && p < 1.01 * LOWEST_ORDER)
    return user_error("the error hardly falls with the step: the order is below %g", LOWEST_ORDER);
  const double half = gsl_cdf_tdist_Pinv(0.975, fit->n - 2) * line.slope_sd;
  fit->order = line.slope;
  fit->low = line.slope - half;
  fit->high = line.slope + half;
  fit->level = line.level;
  return OK;
}
#endif
