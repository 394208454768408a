/* neighbours.h - cell grid, spatial sort and pair lists between any two sets of particles, in open
 * and periodic domains.
 *
 * One grid serves all sets of a step. Cells have the side of the support radius, or a little more.
 * Particles beyond the grid's box belong to its border cells; on an axis that wraps (periodic, or
 * cut because the box would need too many cells) they are folded into it. Both are right for any
 * position, since neither moves two cells further apart, only slower. A set must be in the grid's
 * cell order (last axis fastest) before it is listed. */
#ifndef NEIGHBOURS_H
#define NEIGHBOURS_H
#include "../base/status.h"
#include "pairs.h"
#ifdef __cplusplus
extern "C" {
#endif

struct grid {
  vec low;      /* corner of the cell (0, .., 0) [m]; on a cut axis any place will do */
  vec inv_side; /* 1 / side of a cell per axis [1/m]; a period is a multiple of cells times side */
  int cells[DIM];
  int num_cells; /* product of cells */
  int wraps;     /* bit d: the last cell of axis d is followed by its first */
  vec period;    /* 0 where open */
  real support;  /* search radius R [m] */
};

/* The cell of x along axis d; 0 where x is not a number. In double, so that a float far from `low`
 * is not a cell off. */
STAGE int grid_cell(const struct grid *grid, vec x, int d)
{
  const double cells = grid->cells[d];
  const double q = ((double)x.c[d] - (double)grid->low.c[d]) * (double)grid->inv_side.c[d];
  if (q >= 0 && q < cells) return (int)q;
  if (!(grid->wraps >> d & 1)) return q > 0 ? grid->cells[d] - 1 : 0;
  const double k = floor(q);
  const double rest = fabs(k) < 0x1p40 ? k - cells * floor(k / cells) : fmod(k, cells); /* exact */
  const double folded = rest < 0 ? rest + cells : rest;
  return folded > 0 && folded < cells ? (int)folded : 0;
}

/* The cell of particle i at x, in cell order. Particles that are not finite have no neighbours and
 * are dealt out over all cells, so that many of them cost nothing. */
STAGE int grid_cell_of(const struct grid *grid, vec x, int i)
{
  int cell = 0, finite = 1;
  for (int d = 0; d < DIM; d++) {
    cell = cell * grid->cells[d] + grid_cell(grid, x, d);
    finite &= x.c[d] - x.c[d] == 0;
  }
  return finite ? cell : i % grid->num_cells;
}

/* Cells on one axis: one or two stretches, both ends included, in ascending order. */
struct stretches {
  int num, from[2], to[2];
};

/* The cells of axis d that are at most `reach` away from its cell c. */
STAGE struct stretches grid_near(const struct grid *grid, int d, int c, int reach)
{
  const int cells = grid->cells[d], a = c - reach, b = c + reach;
  const int below = a < 0, above = b >= cells, wraps = grid->wraps >> d & 1;
  struct stretches near;
  near.num = 1;
  near.from[0] = below ? 0 : a;
  near.to[0] = above ? cells - 1 : b;
  near.from[1] = near.to[1] = 0;
  if (!wraps || !(below || above)) return near;
  if (2 * reach + 1 >= cells) {
    near.from[0] = 0;
    near.to[0] = cells - 1;
    return near;
  }
  near.num = 2;
  near.from[0] = 0;
  near.to[0] = below ? b : b - cells;
  near.from[1] = below ? a + cells : a;
  near.to[1] = cells - 1;
  return near;
}

/* Is there a particle of the set with these cells (first: [num_cells + 1]) in the cells up to
 * `reach` away from that of x? */
STAGE int grid_occupied(const struct grid *grid, const int *first, vec x, int reach)
{
  struct stretches near[3] = {{1, {0, 0}, {0, 0}}};
  for (int d = 0; d < DIM; d++)
    near[3 - DIM + d] = grid_near(grid, d, grid_cell(grid, x, d), reach);
  for (int k = 0; k < near[0].num; k++)
    for (int a = near[0].from[k]; a <= near[0].to[k]; a++)
      for (int l = 0; l < near[1].num; l++)
        for (int b = near[1].from[l]; b <= near[1].to[l]; b++)
          for (int m = 0; m < near[2].num; m++) {
            const int row = (a * grid->cells[DIM - 2] + b) * grid->cells[DIM - 1];
            if (first[row + near[2].to[m] + 1] > first[row + near[2].from[m]]) return 1;
          }
  return 0;
}

/* Positions of n particles in cell order, with the first particle of each cell [num_cells + 1]. */
struct cell_set {
  const vec *x;
  int n;
  int *first;   /* owned; NULL before the first sort */
  int capacity; /* of first */
  int *work;    /* of the sort, reused */
  size_t work_capacity;
};

/* A pair list and the memory behind it; list.list, first, last belong to it. Zero-initialise before
 * first use. */
struct pair_list {
  struct pairs pairs;
  int *first, *last, *list;
  int row_capacity, slot_capacity;
  struct pair_scratch *scratch; /* of the search, reused */
};

/* A grid for particles in the box [low, high] (a finite bounding box of all sets). On a periodic
 * axis the box is [low, low + period). At most about 4 cells per particle of `n` + 4096: a box that
 * needs more (a few particles far away) is cut and wraps. Errors: ERR_USER where a period is
 * shorter than 2 support, since a particle would meet two images of another. */
status grid_fit(struct grid *grid, vec low, vec high, vec period, real support, int n);

/* Bounding box of finite positions; returns the number of particles that are not finite (their box
 * is ignored). */
int positions_bounds(const vec *x, int n, vec *low, vec *high);

/* order[k] = index of the particle that comes k-th in cell order (stable: equal cells keep their
 * order) [n]; sets set->first, set->n. x are the unsorted positions. Errors: ERR_MEMORY. */
status cell_sort(struct cell_set *set, const struct grid *grid, const vec *x, int n, int *order);

/* to[k] = from[order[k]], elements of `bytes` bytes; parallel. */
void permute(void *to, const void *from, const int *order, int n, size_t bytes);

/* List for each particle i of `from` every j of the `num_to` sets in `to` with |x_i - x_j| <
 * grid->support: rows [from->n], indices offset[s] + position in to[s]. A particle is its own
 * neighbour (r = 0). Row order: sets in turn, cells in ascending order, ascending index in a cell:
 * the same for any number of threads. Appends to rows from row_offset on (0 to start a new list),
 * so that several sets may have rows in one list. Fills list->pairs (first, last, list, rows,
 * slots, period, periodic); the caller sets xi, xj and kernel. Errors: ERR_MEMORY. */
status pairs_build(struct pair_list *list, const struct grid *grid, const struct cell_set *from,
                   int row_offset, const struct cell_set *to, const int *offset, int num_to);

/* Sort keys, drop repeated ones and the key ~0 (none); returns how many remain. Errors: -1 on no
 * memory. */
int keys_unique(unsigned long long *keys, int n);

void pair_list_free(struct pair_list *list);
void cell_set_free(struct cell_set *set);

/* The same operations where the particles live: these functions on the host, kernels in the CUDA
 * variants. Metrics use the host's on their snapshots in every variant. */
struct search {
  int (*positions_bounds)(const vec *x, int n, vec *low, vec *high);
  status (*cell_sort)(struct cell_set *set, const struct grid *grid, const vec *x, int n,
                      int *order);
  void (*permute)(void *to, const void *from, const int *order, int n, size_t bytes);
  status (*pairs_build)(struct pair_list *list, const struct grid *grid,
                        const struct cell_set *from, int row_offset, const struct cell_set *to,
                        const int *offset, int num_to);
  int (*keys_unique)(unsigned long long *keys, int n);
  void (*pair_list_free)(struct pair_list *list);
  void (*cell_set_free)(struct cell_set *set);
};
extern const struct search particle_search;

#ifdef __cplusplus
}
#endif
#endif
