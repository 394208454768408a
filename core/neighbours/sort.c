/* Sorting particles by cell: a stable counting sort. */
#include "neighbours.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define GRAIN 8192 /* particles per thread, below which it costs more than it saves */

/* The particles are counted and dealt out in `parts` stretches at a time, each with its own
 * counters; the order that results does not depend on their number. */
struct sort {
  int n, num_cells, parts;
  int *key;   /* cell of each particle [n] */
  int *count; /* per part and cell: particles, then the place of the next one [parts][num_cells] */
};

static int parts_for(int n, int num_cells)
{
  int parts = n / GRAIN;
  if (parts > omp_get_max_threads()) parts = omp_get_max_threads();
  while (parts > 1 && (long long)parts * num_cells > n)
    parts--; /* counters are walked by one thread */
  return parts > 1 ? parts : 1;
}

static status reserve(struct cell_set *set, const struct sort *s)
{
  const size_t work = (size_t)s->n + (size_t)s->parts * (size_t)s->num_cells;
  if (s->num_cells + 1 > set->capacity) {
    free(set->first);
    set->capacity = s->num_cells + s->num_cells / 4 + 1;
    set->first = (int *)malloc(sizeof(int) * (size_t)set->capacity);
    if (!set->first) set->capacity = 0;
  }
  if (work > set->work_capacity) {
    free(set->work);
    set->work_capacity = work + work / 4;
    set->work = (int *)malloc(sizeof(int) * set->work_capacity);
    if (!set->work) set->work_capacity = 0;
  }
  if (!set->first || !set->work)
    return status_set(ERR_MEMORY, "no memory to sort %d particles into %d cells", s->n,
                      s->num_cells);
  return OK;
}

static void part_range(const struct sort *s, int part, int *begin, int *end)
{
  *begin = (int)((long long)s->n * part / s->parts);
  *end = (int)((long long)s->n * (part + 1) / s->parts);
}

static void count_part(const struct sort *s, int part, const struct grid *grid, const vec *x)
{
  int begin, end, *count = s->count + (size_t)part * (size_t)s->num_cells;
  part_range(s, part, &begin, &end);
  memset(count, 0, sizeof(int) * (size_t)s->num_cells);
  for (int i = begin; i < end; i++) {
    const int cell = grid_cell_of(grid, x[i], i);
    s->key[i] = cell;
    count[cell]++;
  }
}

static void places(const struct sort *s, int *first)
{
  int place = 0;
  for (int cell = 0; cell < s->num_cells; cell++) {
    first[cell] = place;
    for (int part = 0; part < s->parts; part++) {
      int *count = s->count + (size_t)part * (size_t)s->num_cells + cell;
      const int number = *count;
      *count = place;
      place += number;
    }
  }
  first[s->num_cells] = place;
}

static void deal_part(const struct sort *s, int part, int *order)
{
  int begin, end, *place = s->count + (size_t)part * (size_t)s->num_cells;
  part_range(s, part, &begin, &end);
  for (int i = begin; i < end; i++) order[place[s->key[i]]++] = i;
}

status cell_sort(struct cell_set *set, const struct grid *grid, const vec *x, int n, int *order)
{
  struct sort s = {n, grid->num_cells, parts_for(n, grid->num_cells), NULL, NULL};
  TRY(reserve(set, &s));
  s.key = set->work;
  s.count = set->work + n;
#pragma omp parallel for schedule(static) num_threads(s.parts)
  for (int part = 0; part < s.parts; part++) count_part(&s, part, grid, x);
  places(&s, set->first);
#pragma omp parallel for schedule(static) num_threads(s.parts)
  for (int part = 0; part < s.parts; part++) deal_part(&s, part, order);
  set->n = n;
  return OK;
}

/* Inlined for each known size: a few moves in place of a call. */
STAGE void permute_sized(char *to, const char *from, const int *order, int n, size_t size)
{
#pragma omp parallel for schedule(static) if (n > GRAIN)
  for (int k = 0; k < n; k++) memcpy(to + (size_t)k * size, from + (size_t)order[k] * size, size);
}

void permute(void *to, const void *from, const int *order, int n, size_t bytes)
{
  char *a = (char *)to;
  const char *b = (const char *)from;
  switch (bytes) {
  case 4: permute_sized(a, b, order, n, 4); break;
  case 8: permute_sized(a, b, order, n, 8); break;
  case 12: permute_sized(a, b, order, n, 12); break;
  case 16: permute_sized(a, b, order, n, 16); break;
  case 24: permute_sized(a, b, order, n, 24); break;
  default: permute_sized(a, b, order, n, bytes);
  }
}

void cell_set_free(struct cell_set *set)
{
  free(set->first);
  free(set->work);
  *set = (struct cell_set){0};
}
