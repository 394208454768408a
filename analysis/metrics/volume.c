#include "volume.h"

#include <stdlib.h>

enum { MOST_NODES = 1 << 23 };

struct nodes {
  double low[DIM], step[DIM]; /* first node, distance of nodes [m] */
  long count[DIM], total;
  int wraps[DIM];
  double reach, pull; /* 1.5 dx and dx [m] */
  float *outer;       /* distance to the nearest particle, as far as it matters [m] */
  float *inner;       /* distance to the nearest point beyond `reach` of all particles [m] */
};

struct ball {
  double at[DIM], radius; /* m */
  double less;            /* that is taken off the distances to `at` [m] */
};
struct slab {
  long from, to; /* planes of nodes normal to the first axis: what one thread works on */
};

/* Where a ball meets the nodes of a slab: the first and one past the last, per axis; 0 if nowhere.
 */
static int nodes_near(const struct nodes *n, const struct ball *b, struct slab slab,
                      long first[DIM], long end[DIM])
{
  for (int d = 0; d < DIM; d++) {
    const double at = (b->at[d] - n->low[d]) / n->step[d], reach = b->radius / n->step[d];
    const long least = d == 0 ? slab.from : 0, most = d == 0 ? slab.to : n->count[d];
    first[d] = at - reach > (double)least ? (long)ceil(at - reach) : least;
    end[d] = at + reach < (double)most - 1 ? (long)floor(at + reach) + 1 : most;
    if (first[d] >= end[d]) return 0;
  }
  return 1;
}

/* row[m] = min(row[m], |x| - less) along a row of nodes that is sqrt(rest) away from the centre. */
static void lower_row(float *row, long nodes, double from, double step, const struct ball *b,
                      double rest)
{
  const double chord = b->radius * b->radius - rest;
  if (chord < 0) return;
  const double half = sqrt(chord), skip = (-half - from) / step, stop = (half - from) / step + 2;
  const long last = stop < (double)nodes ? (long)stop : nodes;
  const float x0 = (float)from, dx = (float)step, rest2 = (float)rest, less = (float)b->less;
  for (long m = skip > 0 ? (long)skip : 0; m < last; m++) {
    const float x = x0 + (float)m * dx, r = sqrtf(rest2 + x * x) - less;
    row[m] = r < row[m] ? r : row[m];
  }
}

/* field = min(field, distance from the ball's centre - less) in the ball, and on some nodes more.
 */
static void lower_ball(const struct nodes *n, float *field, const struct ball *b, struct slab slab)
{
  const int z = DIM - 1;
  long first[DIM], end[DIM], k[DIM];
  if (!nodes_near(n, b, slab, first, end)) return;
  for (int d = 0; d < DIM; d++) k[d] = first[d];
  const double from = n->low[z] + (double)first[z] * n->step[z] - b->at[z];
  for (int d = 0; d >= 0;) {
    double rest = 0;
    long node = 0;
    for (int e = 0; e < z; e++) {
      const double x = n->low[e] + (double)k[e] * n->step[e] - b->at[e];
      rest += x * x;
      node = (node + k[e]) * n->count[e + 1];
    }
    lower_row(field + node + first[z], end[z] - first[z], from, n->step[z], b, rest);
    for (d = DIM - 2; d >= 0 && ++k[d] >= end[d]; d--) k[d] = first[d];
  }
}

/* The same for the ball and its periodic images. */
static void lower_images(const struct nodes *n, float *field, const struct ball *ball,
                         struct slab slab)
{
  int images = 1;
  for (int d = 0; d < DIM; d++) images *= n->wraps[d] ? 3 : 1;
  for (int k = 0; k < images; k++) {
    struct ball image = *ball;
    for (int d = 0, rest = k; d < DIM; d++) {
      const double period = n->step[d] * (double)n->count[d];
      image.at[d] += n->wraps[d] ? (rest % 3 - 1) * period : 0;
      rest = n->wraps[d] ? rest / 3 : rest;
    }
    lower_ball(n, field, &image, slab);
  }
}

static int counts(const struct cloud *c, vec x)
{
  for (int d = 0; d < DIM; d++) {
    if (!isfinite(x.c[d])) return 0;
    if (!(c->period.c[d] > 0) && !(x.c[d] >= c->low.c[d] && x.c[d] <= c->high.c[d])) return 0;
  }
  return 1;
}

/* Nodes `step` apart over the bounding box of the cloud; 0 if nothing counts. */
static int nodes_fit(struct nodes *n, const struct cloud *c, double step)
{
  double low[DIM], high[DIM], total = 1;
  int some = 0;
  for (int i = 0; i < c->n; i++) {
    if (!counts(c, c->x[i])) continue;
    for (int d = 0; d < DIM; d++) {
      const double x = (double)c->x[i].c[d];
      low[d] = some && low[d] < x ? low[d] : x;
      high[d] = some && high[d] > x ? high[d] : x;
    }
    some = 1;
  }
  if (!some) return 0;
  n->reach = 1.5 * c->dx;
  n->pull = c->dx;
  for (int d = 0; d < DIM; d++) {
    const double period = (double)c->period.c[d], margin = n->reach + 3 * step;
    n->wraps[d] = period > 0;
    n->low[d] = n->wraps[d] ? (double)c->low.c[d] : low[d] - margin;
    const double cells =
      n->wraps[d] ? round(period / step) : ceil((high[d] - low[d] + 2 * margin) / step);
    const double whole = cells > 1 ? cells : 1;
    n->step[d] = n->wraps[d] ? period / whole : step;
    total *= whole;
    n->count[d] = whole < 1e9 ? (long)whole : 1000000000L;
  }
  n->total = total <= MOST_NODES ? (long)total : -1;
  return 1;
}

static void node_position(const struct nodes *n, long node, double at[DIM])
{
  for (int d = DIM - 1; d >= 0; d--) {
    at[d] = n->low[d] + (double)(node % n->count[d]) * n->step[d];
    node /= n->count[d];
  }
}

/* outer: the distance to the nearest particle, as far as reach + shell. */
static void find_outer(struct nodes *n, const struct cloud *c, double shell, struct slab slab)
{
  for (int i = 0; i < c->n; i++) {
    struct ball ball = {{0}, n->reach + shell, 0};
    if (!counts(c, c->x[i])) continue;
    for (int d = 0; d < DIM; d++) ball.at[d] = (double)c->x[i].c[d];
    lower_images(n, n->outer, &ball, slab);
  }
}

/* inner: the distance to the surface. The straight way from a point inside to a node `beyond`
 * outside crosses the surface at least `beyond` before its end, and for one node just there. */
static void find_inner(struct nodes *n, double shell, struct slab slab)
{
  for (long k = 0; k < n->total; k++) {
    const double beyond = (double)n->outer[k] - n->reach;
    struct ball ball = {{0}, n->pull + shell + beyond, beyond};
    if (beyond <= 0 || beyond > shell) continue;
    node_position(n, k, ball.at);
    lower_images(n, n->inner, &ball, slab);
  }
}

static double volume_on(struct nodes *n, const struct cloud *c)
{
  enum { SLABS = 16 };
  double widest = 0, cell = 1, volume = 0;
  for (int d = 0; d < DIM; d++) {
    widest = n->step[d] > widest ? n->step[d] : widest;
    cell *= n->step[d];
  }
  for (long k = 0; k < n->total; k++) n->outer[k] = n->inner[k] = (float)(10 * n->reach);
#pragma omp parallel for schedule(static) if (c->n > 512)
  for (int k = 0; k < SLABS; k++) {
    const struct slab slab = {n->count[0] * k / SLABS, n->count[0] * (k + 1) / SLABS};
    find_outer(n, c, 1.01 * widest, slab);
  }
#pragma omp parallel for schedule(static) if (c->n > 512)
  for (int k = 0; k < SLABS; k++) {
    const struct slab slab = {n->count[0] * k / SLABS, n->count[0] * (k + 1) / SLABS};
    find_inner(n, 1.01 * widest, slab);
  }
  for (long k = 0; k < n->total; k++) {
    if ((double)n->outer[k] > n->reach) continue;
    const double part = ((double)n->inner[k] - n->pull) / widest + 0.5;
    volume += cell * (part < 0 ? 0 : part > 1 ? 1 : part);
  }
  return volume;
}

double occupied_volume(const struct cloud *cloud)
{
  struct nodes nodes;
  double step = cloud->dx / (DIM == 2 ? 4 : 2), volume = (double)NAN;
  if (!nodes_fit(&nodes, cloud, step)) return 0;
  while (nodes.total < 0 && step < 0.99 * cloud->dx) {
    step = fmin(step * 1.25, cloud->dx);
    nodes_fit(&nodes, cloud, step);
  }
  if (nodes.total < 0) return volume;
  nodes.outer = malloc((size_t)nodes.total * sizeof *nodes.outer);
  nodes.inner = malloc((size_t)nodes.total * sizeof *nodes.inner);
  if (nodes.outer && nodes.inner) volume = volume_on(&nodes, cloud);
  free(nodes.outer);
  free(nodes.inner);
  return volume;
}
