/* A host copy of a run's state in cell order, with pair lists on demand, for metrics and output. */
#include <stdlib.h>
#include <string.h>

#include "../base/memory.h"
#include "run.h"

struct cache {
  struct grid grid;
  struct cell_set fluid, walls;
  struct pair_list list;
  int built;
};

static const struct pairs *build_pairs(const struct snapshot *now)
{
  struct cache *cache = now->cache;
  if (cache->built) return &cache->list.pairs;
  const int n_wall = now->n_all - now->n, offset[2] = {0, now->n};
  cache->fluid.x = now->x;
  cache->walls.x = now->x + now->n;
  const struct cell_set to[2] = {cache->fluid, cache->walls};
  if (pairs_build(&cache->list, &cache->grid, &cache->fluid, 0, to, offset, n_wall > 0 ? 2 : 1) !=
      OK)
    return NULL;
  cache->list.pairs.xi = cache->list.pairs.xj = now->x;
  cache->list.pairs.kernel = kernel_make(KERNEL_CUBIC, (real)now->support, DIM);
  cache->built = 1;
  return &cache->list.pairs;
}

/* The first n entries of a field on the host, as they are in the store; NULL if the run has no such
 * field, or n is 0; *lost is set if there is no memory. */
static void *download(struct run *run, const char *name, int n, int *lost)
{
  struct store_field *f = store_public(&run->store, name);
  if (!f || n == 0) return NULL;
  void *copy = malloc(f->row.bytes * (size_t)(n + 1) + 64);
  if (copy) memory_to_host(copy, f->data, f->row.bytes * (size_t)n);
  *lost |= !copy;
  return copy;
}

/* Put the first n entries in order; frees what was there. */
static void *reorder(void *from, const int *order, int n, int total, size_t bytes, int *lost)
{
  if (!from) return NULL;
  char *to = malloc(bytes * (size_t)(total + 1) + 64);
  if (to) {
    permute(to, from, order, n, bytes);
    memcpy(to + bytes * (size_t)n, (char *)from + bytes * (size_t)n, bytes * (size_t)(total - n));
  }
  *lost |= !to;
  free(from);
  return to;
}

static status sort_walls(struct snapshot *out, struct cache *cache, int *order)
{
  const int n_wall = out->n_all - out->n;
  if (n_wall == 0) return OK;
  TRY(cell_sort(&cache->walls, &cache->grid, out->x + out->n, n_wall, order));
  vec *sorted = malloc(sizeof(vec) * (size_t)n_wall);
  if (!sorted) return status_set(ERR_MEMORY, "no memory for a snapshot");
  permute(sorted, out->x + out->n, order, n_wall, sizeof(vec));
  memcpy((vec *)out->x + out->n, sorted, sizeof(vec) * (size_t)n_wall);
  permute(sorted, out->v + out->n, order, n_wall, sizeof(vec));
  memcpy((vec *)out->v + out->n, sorted, sizeof(vec) * (size_t)n_wall);
  free(sorted);
  return OK;
}

static void fill_facts(struct run *run, struct snapshot *out)
{
  const struct scene *s = &run->scene;
  out->n = run->view->p.n;
  out->n_all = run->view->p.n_all;
  out->time = run->time;
  out->dt = run->dt;
  out->step = run->step;
  out->rho0 = s->common.rho0;
  out->dx = s->common.spacing;
  out->mass = (double)run->view->mass;
  out->support = s->common.support * s->common.spacing;
  out->gravity = s->gravity;
  out->low = s->low;
  out->high = s->high;
  out->period = s->period;
  out->num_start = s->n;
  out->x_start = s->x;
  out->v_start = s->v;
  out->pairs = build_pairs;
}

static status fit_grid(const struct snapshot *s, struct grid *grid)
{
  vec low, high;
  positions_bounds(s->x, s->n_all, &low, &high);
  for (int d = 0; d < DIM; d++)
    if (s->period.c[d] > 0) {
      low.c[d] = s->low.c[d];
      high.c[d] = s->low.c[d] + s->period.c[d];
    }
  return grid_fit(grid, low, high, s->period, (real)s->support, s->n_all);
}

static status sort_all(struct snapshot *out, struct cache *cache, int *order)
{
  const int n = out->n;
  int lost = 0;
  TRY(fit_grid(out, &cache->grid));
  TRY(cell_sort(&cache->fluid, &cache->grid, out->x, n, order));
  out->x = reorder((void *)out->x, order, n, out->n_all, sizeof(vec), &lost);
  out->v = reorder((void *)out->v, order, n, out->n_all, sizeof(vec), &lost);
  out->id = reorder((void *)out->id, order, n, n, sizeof(int), &lost);
  out->light = reorder((void *)out->light, order, n, n, sizeof(real), &lost);
  out->p = reorder((void *)out->p, order, n, n, sizeof(real), &lost);
  out->rho = reorder((void *)out->rho, order, n, n, sizeof(real), &lost);
  if (lost) return status_set(ERR_MEMORY, "no memory for a snapshot");
  return sort_walls(out, cache, order);
}

status run_snapshot(struct run *run, struct snapshot *out)
{
  memset(out, 0, sizeof *out);
  fill_facts(run, out);
  const int all = out->n_all, computed = run->step > 0 ? out->n : 0; /* nothing is at the start */
  struct cache *cache = calloc(1, sizeof *cache);
  int *order = malloc(sizeof(int) * (size_t)(all + 1));
  int lost = !cache || !order;
  out->cache = cache;
  out->x = download(run, "x", all, &lost);
  out->v = download(run, "v", all, &lost);
  out->id = download(run, "id", out->n, &lost);
  out->light = download(run, "light", out->n, &lost);
  out->p = download(run, "p", computed, &lost);
  out->rho = download(run, "rho", computed, &lost);
  const status result =
    lost ? status_set(ERR_MEMORY, "no memory for a snapshot") : sort_all(out, cache, order);
  free(order);
  if (result != OK) snapshot_free(out);
  return result;
}

void snapshot_free(struct snapshot *s)
{
  struct cache *cache = s->cache;
  if (cache) {
    pair_list_free(&cache->list);
    cell_set_free(&cache->fluid);
    cell_set_free(&cache->walls);
  }
  free(cache);
  free((void *)s->x);
  free((void *)s->v);
  free((void *)s->id);
  free((void *)s->p);
  free((void *)s->light);
  free((void *)s->rho);
  memset(s, 0, sizeof *s);
}
