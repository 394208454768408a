/* What the metrics keep of the start: how deep each particle lay in the fluid, and the volume of
 * the fluid. */
#include <stdlib.h>

#include "../../core/metric.h"
#include "../../core/scene/places.h"
#include "volume.h"

enum { SITES = DIM == 2 ? 8 : 26 }; /* lattice sites around one */

/* Number k of the sites -1 .. 1 around x, the middle left out. */
static vec site(vec x, int k, double dx)
{
  const int middle = SITES / 2;
  int rest = k < middle ? k : k + 1;
  for (int d = 0; d < DIM; d++, rest /= 3) x.c[d] += (real)((rest % 3 - 1) * dx);
  return x;
}

/* The particle on each site around each particle, -1 where there is none within 0.75 dx. */
static void find_sites(const struct places *places, double dx, int (*around)[SITES])
{
#pragma omp parallel for schedule(static) if (places->n > 512)
  for (int i = 0; i < places->n; i++)
    for (int k = 0; k < SITES; k++)
      around[i][k] = places_nearest(places, site(places->x[i], k, dx), 0.75 * dx, i, NULL);
}

/* Particles that lie in `depth` layers and whose neighbours all do lie in depth + 1. */
static void deepen(int (*around)[SITES], int n, int depth, int *layers, int *deeper)
{
  for (int i = 0; i < n; i++) {
    deeper[i] = layers[i];
    if (layers[i] < depth) continue;
    int all = 1;
    for (int k = 0; k < SITES && all; k++) all = around[i][k] >= 0 && layers[around[i][k]] >= depth;
    if (all) deeper[i] = depth + 1;
  }
  for (int i = 0; i < n; i++) layers[i] = deeper[i];
}

static status find_layers(const struct snapshot *now, int *layers)
{
  const int n = now->num_start;
  int(*around)[SITES] = malloc(((size_t)n + 1) * sizeof *around);
  int *deeper = malloc(((size_t)n + 1) * sizeof *deeper);
  struct places places;
  status result = status_set(ERR_MEMORY, "no memory for the layers of %d particles", n);
  if (around && deeper) result = places_make(&places, now->x_start, n, now->dx, now->period);
  if (result == OK) {
    find_sites(&places, now->dx, around);
    for (int i = 0; i < n; i++) layers[i] = 0;
    for (int depth = 0; depth < METRICS_LAYERS; depth++) deepen(around, n, depth, layers, deeper);
    places_free(&places);
  }
  free(around);
  free(deeper);
  return result;
}

status metrics_start_make(const struct snapshot *now, struct metrics_start *start)
{
  const struct cloud cloud = {now->x_start, now->num_start, now->dx,
                              now->low,     now->high,      now->period};
  *start = (struct metrics_start){now->num_start, NULL, 0};
  start->layers = malloc(((size_t)now->num_start + 1) * sizeof *start->layers);
  if (!start->layers) return status_set(ERR_MEMORY, "no memory for %d particles", now->num_start);
  const status result = find_layers(now, start->layers);
  if (result != OK) metrics_start_free(start);
  start->volume = occupied_volume(&cloud);
  return result;
}

void metrics_start_free(struct metrics_start *start)
{
  free(start->layers);
  start->layers = NULL;
}
