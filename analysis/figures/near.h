/* near.h - the neighbours of points within a distance, by cells of that side: for programs of
 * figures, which look once at a frame. */
#ifndef FIGURE_NEAR_H
#define FIGURE_NEAR_H
#include <math.h>
#include <stdlib.h>

#include "../../core/base/status.h"

struct near {
  const double *x; /* [n][3] */
  int n;
  double reach;     /* [m] */
  int *head, *next; /* of a cell's list in the table; of a point */
  int table;        /* a power of 2 */
};

static inline int near_slot(const struct near *near, long a, long b, long c)
{
  const unsigned long mixed =
    (unsigned long)a * 73856093UL ^ (unsigned long)b * 19349663UL ^ (unsigned long)c * 83492791UL;
  return (int)(mixed & (unsigned long)(near->table - 1));
}
static inline long near_cell(const struct near *near, double x)
{
  return (long)floor(x / near->reach);
}

static inline void near_end(struct near *near)
{
  free(near->head);
  free(near->next);
}

/* ERR_MEMORY. To be released by near_end, whatever comes. */
static inline status near_begin(struct near *near, const double *x, int n, double reach)
{
  *near = (struct near){.x = x, .n = n, .reach = reach, .table = 1024};
  while (near->table < n) near->table *= 2;
  near->head = malloc((size_t)near->table * sizeof *near->head);
  near->next = malloc((size_t)(n > 0 ? n : 1) * sizeof *near->next);
  if (!near->head || !near->next) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < near->table; k++) near->head[k] = -1;
  for (int i = 0; i < n; i++) {
    const double *at = x + 3 * i;
    int *head = &near->head[near_slot(near, near_cell(near, at[0]), near_cell(near, at[1]),
                                      near_cell(near, at[2]))];
    near->next[i] = *head;
    *head = i;
  }
  return OK;
}

/* Call use(j, distance, self) for all points within reach of `at`, itself included. */
static inline void near_each(const struct near *near, const double at[3],
                             void (*use)(int j, double r, void *self), void *self)
{
  const long c[3] = {near_cell(near, at[0]), near_cell(near, at[1]), near_cell(near, at[2])};
  for (int k = 0; k < 27; k++) {
    const long a = c[0] + k % 3 - 1, b = c[1] + k / 3 % 3 - 1, e = c[2] + k / 9 - 1;
    for (int j = near->head[near_slot(near, a, b, e)]; j >= 0; j = near->next[j]) {
      const double *x = near->x + 3 * j;
      /* other cells may share the slot */
      if (near_cell(near, x[0]) != a || near_cell(near, x[1]) != b || near_cell(near, x[2]) != e)
        continue;
      const double r = sqrt((x[0] - at[0]) * (x[0] - at[0]) + (x[1] - at[1]) * (x[1] - at[1]) +
                            (x[2] - at[2]) * (x[2] - at[2]));
      if (r <= near->reach) use(j, r, self);
    }
  }
}
#endif
