/* What is measured of every run, whatever its scene. Sums run in the order of the store, on one
 * thread, in double. */
#include "../../core/metric.h"

#include <stdlib.h>

#include "volume.h"

#define METRIC(name, unit, about) #name,
const char *const metric_names[NUM_METRICS] = {
#include "../metrics.def"
};
#undef METRIC
#define METRIC(name, unit, about) unit,
const char *const metric_units[NUM_METRICS] = {
#include "../metrics.def"
};
#undef METRIC
#define METRIC(name, unit, about) about,
const char *const metric_about[NUM_METRICS] = {
#include "../metrics.def"
};
#undef METRIC

/* --- energy and momenta --- */

static void centre_of_start(const struct snapshot *now, double centre[DIM])
{
  for (int d = 0; d < DIM; d++) {
    centre[d] = 0;
    for (int i = 0; i < now->num_start; i++) centre[d] += (double)now->x_start[i].c[d];
    if (now->num_start > 0) centre[d] /= now->num_start;
  }
}

static double length(const double *a, int n)
{
  double sum = 0;
  for (int d = 0; d < n; d++) sum += a[d] * a[d];
  return sqrt(sum);
}

/* x cross v; in 2-D its one component comes last, the others stay 0 */
static void add_cross(const double *x, vec v, double sum[3])
{
  sum[2] += x[0] * (double)v.c[1] - x[1] * (double)v.c[0];
  if (DIM == 2) return;
  const double z = x[DIM - 1], w = (double)v.c[DIM - 1];
  sum[0] += x[1] * w - z * (double)v.c[1];
  sum[1] += z * (double)v.c[0] - x[0] * w;
}

/* [kg] */
static double mass_of(const struct snapshot *now, int i)
{
  return now->light ? now->mass / (double)now->light[i] : now->mass;
}

static void measure_momenta(const struct snapshot *now, struct measures *out)
{
  double centre[DIM], linear[DIM] = {0}, angular[3] = {0};
  centre_of_start(now, centre);
  for (int i = 0; i < now->n; i++) {
    double x[DIM];
    const double m = mass_of(now, i);
    for (int d = 0; d < DIM; d++) {
      x[d] = m * ((double)now->x[i].c[d] - centre[d]);
      linear[d] += m * (double)now->v[i].c[d];
    }
    add_cross(x, now->v[i], angular);
  }
  MEASURE(out, linear_momentum, length(linear, DIM));
  MEASURE(out, angular_momentum, length(angular, 3));
}

/* NaN where the height is not one: gravity along a periodic axis. */
static double potential_energy(const struct snapshot *now)
{
  double energy = 0;
  for (int d = 0; d < DIM; d++) {
    const double g = (double)now->gravity.c[d];
    double moved = 0;
    if (g == 0) continue;
    if (now->period.c[d] > 0) return (double)NAN;
    for (int i = 0; i < now->n; i++) {
      const int label = now->id[i];
      if (label < now->num_start)
        moved += mass_of(now, i) * ((double)now->x[i].c[d] - (double)now->x_start[label].c[d]);
    }
    energy -= g * moved;
  }
  return energy;
}

static void measure_energy(const struct snapshot *now, struct measures *out)
{
  double v2 = 0;
  for (int i = 0; i < now->n; i++)
    for (int d = 0; d < DIM; d++)
      v2 += mass_of(now, i) * (double)now->v[i].c[d] * (double)now->v[i].c[d];
  const double kinetic = 0.5 * v2, potential = potential_energy(now);
  MEASURE(out, kinetic_energy, kinetic);
  MEASURE(out, potential_energy, potential);
  MEASURE(out, total_energy, kinetic + potential);
}

/* --- losses and volume --- */

static int is_inside(const struct snapshot *now, vec x)
{
  for (int d = 0; d < DIM; d++) {
    if (!isfinite(x.c[d])) return 0;
    if (now->period.c[d] > 0) continue;
    if (x.c[d] < now->low.c[d] || x.c[d] > now->high.c[d]) return 0;
  }
  return 1;
}

static void measure_volume(const struct snapshot *now, const struct metrics_start *start,
                           struct measures *out)
{
  const struct cloud cloud = {now->x, now->n, now->dx, now->low, now->high, now->period};
  int lost = now->num_start > now->n ? now->num_start - now->n : 0;
  for (int i = 0; i < now->n; i++) lost += !is_inside(now, now->x[i]);
  MEASURE(out, particles_lost, lost);
  MEASURE(out, volume_change, occupied_volume(&cloud) / start->volume - 1);
}

/* --- distribution and density --- */

struct distribution {
  const struct snapshot *now;
  const struct pairs *nb;
  double full;            /* sum of W over a full lattice [1/m^d] */
  double *sum_W;          /* by particle [n] */
  double *first, *second; /* the terms of gamma: [1], [1/m^2] */
  double *nearest;        /* distance of the nearest other fluid particle [m] */
};

static double full_lattice(const struct kernel *kernel, double dx)
{
  const int reach = (int)ceil((double)kernel->R / dx), across = 2 * reach + 1;
  const int sites = DIM == 2 ? across * across : across * across * across;
  double sum = 0;
  for (int k = 0; k < sites; k++) {
    double r2 = 0;
    for (int d = 0, rest = k; d < DIM; d++, rest /= across) {
      const double x = (rest % across - reach) * dx;
      r2 += x * x;
    }
    sum += (double)kernel_W(kernel, (real)sqrt(r2), DIM);
  }
  return sum;
}

/* x_i - x_j of the nearest image and its length [m] */
static double pair_distance(const struct pairs *nb, int i, int j, double x[DIM])
{
  double r2 = 0;
  for (int d = 0; d < DIM; d++) {
    const double period = (double)nb->period.c[d];
    x[d] = (double)nb->xi[i].c[d] - (double)nb->xj[j].c[d];
    if (nb->periodic && period > 0) x[d] -= period * rint(x[d] / period);
    r2 += x[d] * x[d];
  }
  return sqrt(r2);
}

/* sum_j W_ij over fluid and walls, and the nearest fluid particle. */
static void sum_kernel(struct distribution *s, int i)
{
  double sum = 0, nearest = HUGE_VAL, x[DIM];
  for (int k = s->nb->first[i]; k < s->nb->last[i]; k++) {
    const int j = s->nb->list[k];
    const double r = pair_distance(s->nb, i, j, x);
    sum += (double)kernel_W(&s->nb->kernel, (real)r, DIM);
    if (j != i && j < s->now->n && r < nearest) nearest = r;
  }
  s->sum_W[i] = sum;
  s->nearest[i] = nearest;
}

/* Eq. (20)   ((rho0 - rho_i)/rho0)^2  and  |sum_j V_j grad W_ij / sum_j V_j W_ij|^2,
 *            with V_j = m/rho_j = 1/sum_k W_jk */
static void sum_gamma(struct distribution *s, int i)
{
  double gradient[DIM] = {0}, weight = 0, x[DIM];
  for (int k = s->nb->first[i]; k < s->nb->last[i]; k++) {
    const int j = s->nb->list[k];
    const double r = pair_distance(s->nb, i, j, x);
    const double V = 1 / (j < s->now->n ? s->sum_W[j] : s->full);
    weight += V * (double)kernel_W(&s->nb->kernel, (real)r, DIM);
    if (r == 0) continue;
    const double slope = V * (double)kernel_dW(&s->nb->kernel, (real)r, DIM) / r;
    for (int d = 0; d < DIM; d++) gradient[d] += slope * x[d];
  }
  const double lack = 1 - s->sum_W[i] / s->full, tilt = length(gradient, DIM) / weight;
  s->first[i] = lack * lack;
  s->second[i] = tilt * tilt;
}

static void report_density(const struct distribution *s, struct measures *out)
{
  const int n = s->now->n;
  double sum = 0, most = -HUGE_VAL;
  for (int i = 0; i < n; i++) {
    const double excess = s->sum_W[i] / s->full - 1;
    sum += excess > 0 || isnan(excess) ? excess : 0;
    if (excess > most || isnan(excess)) most = excess;
  }
  MEASURE(out, density_error_mean, sum / n);
  MEASURE(out, density_error_max, most);
}

static void report_distribution(const struct distribution *s, const struct metrics_start *start,
                                struct measures *out)
{
  const struct snapshot *now = s->now;
  const double h = now->support / 2;
  double deep = 0, printed = 0;
  int num_deep = 0, clumped = 0;
  for (int i = 0; i < now->n; i++) {
    const int label = now->id[i];
    clumped += s->nearest[i] < 0.5 * now->dx;
    printed += s->first[i] + s->second[i];
    if (label >= start->n || start->layers[label] < METRICS_LAYERS) continue;
    deep += s->first[i] + h * h * s->second[i];
    num_deep++;
  }
  MEASURE(out, clumping_fraction, (double)clumped / now->n);
  MEASURE(out, gamma_printed, printed / now->n);
  if (num_deep > 0) MEASURE(out, gamma_mean, deep / num_deep);
}

static void measure_distribution(const struct snapshot *now, const struct metrics_start *start,
                                 struct measures *out)
{
  const struct pairs *nb = now->pairs ? now->pairs(now) : NULL;
  const size_t n = (size_t)now->n;
  double *memory = nb ? malloc(4 * n * sizeof *memory) : NULL;
  if (!memory) return;
  struct distribution s = {now,           nb,         full_lattice(&nb->kernel, now->dx),
                           memory,        memory + n, memory + 2 * n,
                           memory + 3 * n};
#pragma omp parallel for schedule(static) if (now->n > 512)
  for (int i = 0; i < now->n; i++) sum_kernel(&s, i);
#pragma omp parallel for schedule(static) if (now->n > 512)
  for (int i = 0; i < now->n; i++) sum_gamma(&s, i);
  report_density(&s, out);
  report_distribution(&s, start, out);
  free(memory);
}

void metrics_measure(const struct snapshot *now, struct measures *out)
{
  struct metrics_start own = {0, NULL, 0};
  for (int k = 0; k < NUM_METRICS; k++) out->value[k] = (double)NAN;
  if (now->n < 1) return;
  if (!now->start && metrics_start_make(now, &own) != OK) return;
  const struct metrics_start *start = now->start ? now->start : &own;
  measure_energy(now, out);
  measure_momenta(now, out);
  measure_volume(now, start, out);
  measure_distribution(now, start, out);
  metrics_start_free(&own);
}
