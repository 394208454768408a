/* neighbours.h - cell grid, spatial sort and pair lists between any two sets of particles, in open and periodic domains.
 *
 * One grid serves all sets of a step. Cells have the side of the support radius (or more); particles beyond the grid's box
 * belong to its border cells, which is right for any position (clamping never moves two cells further apart), only slower.
 * A set must be in the grid's cell order (last axis fastest) before it is listed. */
#ifndef NEIGHBOURS_H
#define NEIGHBOURS_H
#include "../base/status.h"
#include "pairs.h"
#ifdef __cplusplus
extern "C" {
#endif

struct grid {
  vec low;           /* corner of the cell (0, .., 0) [m] */
  vec inv_side;      /* 1 / side of a cell per axis [1/m]; a periodic axis holds a whole number of cells */
  int cells[DIM];
  int num_cells;     /* product of cells */
  vec period;        /* 0 where open */
  real support;      /* search radius R [m] */
};

/* Positions of n particles in cell order, with the first particle of each cell [num_cells + 1]. */
struct cell_set {
  const vec *x;
  int n;
  int *first;        /* owned; NULL before the first sort */
  int capacity;      /* of first */
};

/* A pair list and the memory behind it; list.list, first, last belong to it. Zero-initialise before first use. */
struct pair_list {
  struct pairs pairs;
  int *first, *last, *list;
  int row_capacity, slot_capacity;
};

/* A grid for particles in the box [low, high] (a finite bounding box of all sets). On a periodic axis the box is
 * [low, low + period). At most about 8 cells per particle of `n` + 4096: beyond it (a few particles far away) the box is cut. */
void grid_fit(struct grid *grid, vec low, vec high, vec period, real support, int n);

/* Bounding box of finite positions; returns the number of particles that are not finite (their box is ignored). */
int positions_bounds(const vec *x, int n, vec *low, vec *high);

/* order[k] = index of the particle that comes k-th in cell order (stable: equal cells keep their order) [n]; sets
 * set->first, set->n. x are the unsorted positions. Errors: ERR_MEMORY. */
status cell_sort(struct cell_set *set, const struct grid *grid, const vec *x, int n, int *order);

/* to[k] = from[order[k]], elements of `bytes` bytes; parallel. */
void permute(void *to, const void *from, const int *order, int n, size_t bytes);

/* List for each particle i of `from` every j of the `num_to` sets in `to` with |x_i - x_j| < grid->support: rows [from->n],
 * indices offset[s] + position in to[s]. A particle is its own neighbour (r = 0). Row order: sets in turn, cells in
 * ascending order, ascending index in a cell: the same for any number of threads. Appends to rows from row_offset on (0 to
 * start a new list), so that several sets may have rows in one list. Fills list->pairs (first, last, list, rows, slots,
 * period, periodic); the caller sets xi, xj and kernel. Errors: ERR_MEMORY. */
status pairs_build(struct pair_list *list, const struct grid *grid, const struct cell_set *from, int row_offset,
                   const struct cell_set *to, const int *offset, int num_to);

void pair_list_free(struct pair_list *list);
void cell_set_free(struct cell_set *set);

#ifdef __cplusplus
}
#endif
#endif
