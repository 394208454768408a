#include "statistics.h"
#include "../../core/base/sorted.h"

#include <math.h>
#include <stdlib.h>

/* P(B <= k) of B ~ binomial(n, 1/2) */
static double binomial_half(int k, int n)
{
  double term = pow(0.5, n), sum = 0;
  for (int i = 0; i <= k; i++) {
    sum += term;
    term *= (double)(n - i) / (i + 1);
  }
  return sum;
}

/* P(x_(k) <= median <= x_(n+1-k)) = 1 - 2 P(B <= k - 1) */
struct interval interval_of_median(double *values, int n)
{
  int k = 1;
  sort_numbers(values, n);
  while (2 * (k + 1) <= n && 1 - 2 * binomial_half(k, n) >= 0.95) k++;
  const double coverage = 1 - 2 * binomial_half(k - 1, n);
  return (struct interval){.median = (values[(n - 1) / 2] + values[n / 2]) / 2,
                           .low = values[k - 1],
                           .high = values[n - k],
                           .coverage = coverage > 0 ? coverage : 0};
}

void pareto_front(const double *cost, const double *error, int n, int *on)
{
  for (int k = 0; k < n; k++) {
    on[k] = isfinite(cost[k]) && isfinite(error[k]);
    for (int i = 0; i < n && on[k]; i++) {
      if (i == k || !isfinite(cost[i]) || !isfinite(error[i])) continue;
      const int no_worse = cost[i] <= cost[k] && error[i] <= error[k];
      const int better = cost[i] < cost[k] || error[i] < error[k];
      if (no_worse && (better || i < k)) on[k] = 0;
    }
  }
}

/* --- the cheapest --- */

static int is_measured(const struct candidate *c)
{
  return isfinite(c->error) && isfinite(c->time);
}

static int by_time(const void *a, const void *b)
{
  const struct candidate *x = a, *y = b;
  if (x->time != y->time) return x->time > y->time ? 1 : -1;
  return (x->solver > y->solver) - (x->solver < y->solver);
}

int rank_cheapest(const struct candidate *all, int n, double target, struct candidate *best)
{
  int found = 0;
  for (int k = 0; k < n; k++) {
    if (!is_measured(&all[k]) || all[k].error > target) continue;
    int b = 0;
    while (b < found && best[b].solver != all[k].solver) b++;
    if (b == found || all[k].time < best[b].time) best[b] = all[k];
    found += b == found;
  }
  qsort(best, (size_t)found, sizeof *best, by_time);
  return found;
}

double slower_by(const struct candidate *a, const struct candidate *b, double floor)
{
  const double factor = b->time / a->time;
  return factor > floor && b->low > a->high ? factor : 0;
}

double noise_floor(const double *a, const double *b, int n)
{
  double *factor = malloc(sizeof *factor * (size_t)(n + 1));
  int found = 0;
  for (int k = 0; factor && k < n; k++)
    if (a[k] > 0 && b[k] > 0) factor[found++] = fmax(a[k] / b[k], b[k] / a[k]);
  if (found > 0) sort_numbers(factor, found);
  const double floor = found > 0 ? factor[(int)ceil(0.95 * found) - 1] : 1;
  free(factor);
  return floor;
}

/* --- what to measure --- */

/* How many times longer than the fastest kept candidate of the same solver that is no less exact.
 */
static double wasted(const struct candidate *all, int n, const int *keep, int k)
{
  double most = 1;
  for (int i = 0; i < n; i++)
    if (i != k && keep[i] && all[i].solver == all[k].solver && all[i].error <= all[k].error)
      most = fmax(most, all[k].time / all[i].time);
  return most;
}

static int is_last_of_solver(const struct candidate *all, int n, const int *keep, int k)
{
  for (int i = 0; i < n; i++)
    if (i != k && keep[i] && all[i].solver == all[k].solver) return 0;
  return 1;
}

/* The next to go; -1: none may. */
static int next_to_drop(const struct candidate *all, int n, const int *keep)
{
  const double enough = 2;
  int worst = -1, slowest = -1;
  double most = enough;
  for (int k = 0; k < n; k++) {
    if (!keep[k] || is_last_of_solver(all, n, keep, k)) continue;
    const double waste = wasted(all, n, keep, k);
    if (waste > most) {
      most = waste;
      worst = k;
    }
    if (slowest < 0 || all[k].time > all[slowest].time) slowest = k;
  }
  return worst >= 0 ? worst : slowest;
}

int drop_slow(const struct candidate *all, int n, double budget, int *keep)
{
  double sum = 0;
  int dropped = 0;
  for (int k = 0; k < n; k++) {
    keep[k] = is_measured(&all[k]);
    if (keep[k]) sum += all[k].time;
  }
  while (sum > budget) {
    const int k = next_to_drop(all, n, keep);
    if (k < 0) break;
    keep[k] = 0;
    sum -= all[k].time;
    dropped++;
  }
  return dropped;
}

/* --- profiles --- */

static double cost_of(const struct profile *p, int problem, int s)
{
  const double cost = p->cost[problem * p->solvers + s];
  return isfinite(cost) && cost > 0 ? cost : HUGE_VAL;
}

double performance_profile(const struct profile *p, int s, double tau)
{
  int within = 0;
  for (int k = 0; k < p->problems; k++) {
    double least = HUGE_VAL;
    for (int i = 0; i < p->solvers; i++) least = fmin(least, cost_of(p, k, i));
    const double cost = cost_of(p, k, s);
    within += isfinite(cost) && cost <= tau * least;
  }
  return p->problems ? (double)within / p->problems : 0;
}

double data_profile(const struct profile *p, int s, double kappa)
{
  int within = 0;
  for (int k = 0; k < p->problems; k++) {
    const double cost = cost_of(p, k, s);
    within += isfinite(cost) && cost <= kappa;
  }
  return p->problems ? (double)within / p->problems : 0;
}

double pairwise_wins(const struct profile *p, int a, int b)
{
  int wins = 0;
  for (int k = 0; k < p->problems; k++) wins += cost_of(p, k, a) < cost_of(p, k, b);
  return p->problems ? (double)wins / p->problems : 0;
}
