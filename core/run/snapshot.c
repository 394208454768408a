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
  if (pairs_build(&cache->list, &cache->grid, &cache->fluid, 0, to, offset, n_wall > 0 ? 2 : 1) != OK)
    return NULL;
  cache->list.pairs.xi = cache->list.pairs.xj = now->x;
  cache->list.pairs.kernel = kernel_make(KERNEL_CUBIC, (real)now->support, DIM);
  cache->built = 1;
  return &cache->list.pairs;
}

/* A host copy of a field, NULL if the run has none; entries [begin, n) as they are in the store. */
static void *download(struct run *run, const char *name, int n)
{
  struct store_field *f = store_find(&run->store, name);
  if (!f) return NULL;
  void *copy = malloc(f->row.bytes * (size_t)(n + 1) + 64);
  if (copy) memory_to_host(copy, f->data, f->row.bytes * (size_t)n);
  return copy;
}

/* Put the first n entries in order; frees what was there. */
static void *reorder(void *from, const int *order, int n, int total, size_t bytes)
{
  if (!from) return NULL;
  char *to = malloc(bytes * (size_t)(total + 1) + 64);
  if (to) {
    permute(to, from, order, n, bytes);
    memcpy(to + bytes * (size_t)n, (char *)from + bytes * (size_t)n, bytes * (size_t)(total - n));
  }
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

status run_snapshot(struct run *run, struct snapshot *out)
{
  memset(out, 0, sizeof *out);
  fill_facts(run, out);
  const int n = out->n, all = out->n_all;
  struct cache *cache = calloc(1, sizeof *cache);
  int *order = malloc(sizeof(int) * (size_t)(all + 1));
  out->cache = cache;
  out->x = download(run, "x", all);
  out->v = download(run, "v", all);
  out->id = download(run, "id", n);
  out->p = download(run, "p", run->step > 0 ? n : 0);
  out->rho = download(run, "rho", run->step > 0 ? n : 0);
  status result = OK;
  if (!cache || !order || !out->x || !out->v || !out->id) result = status_set(ERR_MEMORY, "no memory for a snapshot");
  if (result == OK) result = fit_grid(out, &cache->grid);
  if (result == OK) {
    result = cell_sort(&cache->fluid, &cache->grid, out->x, n, order);
  }
  if (result == OK) {
    out->x = reorder((void *)out->x, order, n, all, sizeof(vec));
    out->v = reorder((void *)out->v, order, n, all, sizeof(vec));
    out->id = reorder((void *)out->id, order, n, n, sizeof(int));
    if (run->step > 0) {
      out->p = reorder((void *)out->p, order, n, n, sizeof(real));
      out->rho = reorder((void *)out->rho, order, n, n, sizeof(real));
    }
    result = sort_walls(out, cache, order);
  }
  free(order);
  if (run->step == 0) { /* nothing was computed yet */
    free((void *)out->p);
    free((void *)out->rho);
    out->p = out->rho = NULL;
  }
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
  free((void *)s->rho);
  memset(s, 0, sizeof *s);
}
