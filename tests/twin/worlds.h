/* Sets of particles in a grid, for the tests of sorting and searching. */
#ifndef WORLDS_H
#define WORLDS_H
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <omp.h>

#include "../../core/neighbours/neighbours.h"

enum { MOST_SETS = 2 };

/* Sets of particles with their cells. */
struct world {
  int num_sets, n[MOST_SETS];
  vec *x[MOST_SETS], period;
  real support;
  struct grid grid;
  struct cell_set set[MOST_SETS];
};

static unsigned long long seed; /* of uniform; 1 at the begin of each test */
static inline real uniform(void)
{
  seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
  return (real)((double)(seed >> 40) / 16777216.0);
}

static inline int begin_test(void **unused)
{
  (void)unused;
  seed = 1;
  return 0;
}

static inline vec everywhere(real a)
{
  vec r;
  for (int d = 0; d < DIM; d++) r.c[d] = a;
  return r;
}

static inline vec somewhere(real side)
{
  vec r;
  for (int d = 0; d < DIM; d++) r.c[d] = side * uniform();
  return r;
}

static inline struct world world_make(int num_sets, int n, int n2, real support)
{
  struct world w;
  memset(&w, 0, sizeof w);
  w.num_sets = num_sets;
  w.n[0] = n;
  w.n[1] = n2;
  w.support = support;
  for (int s = 0; s < num_sets; s++) w.x[s] = (vec *)calloc((size_t)w.n[s] + 1, sizeof(vec));
  return w;
}

/* A cube of about n particles with spacing 1 around the origin, displaced by up to `jitter`. */
static inline int cube_side(int n) { return (int)(pow((double)n, 1.0 / DIM) + 0.5); }
static inline struct world world_cube(int n, real support, real jitter)
{
  const int side = cube_side(n);
  struct world w = world_make(1, DIM == 3 ? side * side * side : side * side, 0, support);
  for (int i = 0; i < w.n[0]; i++)
    for (int d = 0, k = i; d < DIM; d++, k /= side)
      w.x[0][i].c[d] = (real)(k % side - side / 2) + jitter * (2 * uniform() - 1);
  return w;
}

static inline void world_free(struct world *w)
{
  for (int s = 0; s < w->num_sets; s++) {
    free(w->x[s]);
    cell_set_free(&w->set[s]);
  }
}

/* Grid around the finite particles, each set in cell order. On periodic axes the box begins at
 * `origin`. */
static inline void world_sort(struct world *w, real origin)
{
  vec low = zero(), high = zero();
  int some = 0, total = 0;
  for (int s = 0; s < w->num_sets; s++) {
    vec a, b;
    total += w->n[s];
    if (positions_bounds(w->x[s], w->n[s], &a, &b) == w->n[s]) continue;
    for (int d = 0; d < DIM; d++) {
      low.c[d] = some ? smaller(low.c[d], a.c[d]) : a.c[d];
      high.c[d] = some ? larger(high.c[d], b.c[d]) : b.c[d];
    }
    some = 1;
  }
  for (int d = 0; d < DIM; d++)
    if (w->period.c[d] > 0) low.c[d] = origin;
  assert_int_equal(grid_fit(&w->grid, low, high, w->period, w->support, total), OK);
  assert_true(w->grid.num_cells <= 4 * total + 4096);
  for (int s = 0; s < w->num_sets; s++) {
    const int n = w->n[s];
    int *order = (int *)malloc(sizeof(int) * ((size_t)n + 1));
    vec *sorted = (vec *)malloc(sizeof(vec) * ((size_t)n + 1));
    assert_int_equal(cell_sort(&w->set[s], &w->grid, w->x[s], n, order), OK);
    permute(sorted, w->x[s], order, n, sizeof(vec));
    memcpy(w->x[s], sorted, sizeof(vec) * (size_t)n);
    w->set[s].x = w->x[s];
    free(order);
    free(sorted);
  }
}

static inline int most_in_a_cell(const struct world *w, int s)
{
  int most = 0;
  for (int c = 0; c < w->grid.num_cells; c++) {
    const int n = w->set[s].first[c + 1] - w->set[s].first[c];
    most = n > most ? n : most;
  }
  return most;
}

#endif
