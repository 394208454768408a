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

/* Walks the nodes of the box around `at` in which a ball of radius `radius` lies; calls visit with
 * the distance. */
typedef void visitor(struct nodes *nodes, long node, double distance, double value);

static void visit_ball(struct nodes *n, const double at[DIM], double radius, double value,
                       visitor *visit)
{
  long first[DIM], last[DIM], k[DIM];
  for (int d = 0; d < DIM; d++) {
    first[d] = k[d] = (long)ceil((at[d] - radius - n->low[d]) / n->step[d]);
    last[d] = (long)floor((at[d] + radius - n->low[d]) / n->step[d]);
    if (last[d] < first[d]) return;
  }
  for (int d = 0; d >= 0;) {
    double r2 = 0;
    long node = 0;
    int exists = 1;
    for (int e = 0; e < DIM; e++) {
      const double x = n->low[e] + (double)k[e] * n->step[e] - at[e];
      long m = k[e];
      if (n->wraps[e]) m = (m % n->count[e] + n->count[e]) % n->count[e];
      exists &= m >= 0 && m < n->count[e];
      node = node * n->count[e] + m;
      r2 += x * x;
    }
    if (exists && r2 <= radius * radius) visit(n, node, sqrt(r2), value);
    for (d = DIM - 1; d >= 0 && ++k[d] > last[d]; d--) k[d] = first[d];
  }
}

static void near_particle(struct nodes *n, long node, double distance, double unused)
{
  (void)unused;
  if (distance < (double)n->outer[node]) n->outer[node] = (float)distance;
}

/* The straight way from a point inside to a node that lies `beyond` outside crosses the surface
 * that far before its end. */
static void near_outside(struct nodes *n, long node, double distance, double beyond)
{
  const double to_surface = distance - beyond;
  if (to_surface < (double)n->inner[node]) n->inner[node] = (float)to_surface;
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

static double volume_on(struct nodes *n, const struct cloud *c)
{
  double widest = 0, cell = 1, volume = 0;
  for (int d = 0; d < DIM; d++) {
    widest = n->step[d] > widest ? n->step[d] : widest;
    cell *= n->step[d];
  }
  const double shell = widest * sqrt((double)DIM), far = 10 * n->reach;
  for (long k = 0; k < n->total; k++) n->outer[k] = n->inner[k] = (float)far;
  for (int i = 0; i < c->n; i++) {
    double at[DIM];
    if (!counts(c, c->x[i])) continue;
    for (int d = 0; d < DIM; d++) at[d] = (double)c->x[i].c[d];
    visit_ball(n, at, n->reach + shell, 0, near_particle);
  }
  for (long k = 0; k < n->total; k++) {
    const double beyond = (double)n->outer[k] - n->reach;
    double at[DIM];
    if (beyond <= 0 || beyond > shell) continue;
    node_position(n, k, at);
    visit_ball(n, at, n->pull + widest + beyond, beyond, near_outside);
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
