#include "places.h"

#include <stdlib.h>

static int is_finite(vec x)
{
  for (int d = 0; d < DIM; d++)
    if (!isfinite(x.c[d])) return 0;
  return 1;
}

static long long cell_of(double x, double side)
{
  const double k = floor(x / side), most = 4e18;
  return (long long)(k < -most ? -most : k > most ? most : k);
}

static unsigned long long hash_of(const long long cell[DIM])
{
  unsigned long long h = 0;
  for (int d = 0; d < DIM; d++) {
    h = (h ^ (unsigned long long)cell[d]) * 0x9E3779B97F4A7C15ull;
    h ^= h >> 29;
  }
  return h;
}

status places_make(struct places *places, const vec *x, int n, double side, vec period)
{
  unsigned long long heads = 64;
  while (heads < 2ull * (unsigned long long)n) heads *= 2;
  *places = (struct places){x, n, side, period, NULL, NULL, heads - 1};
  places->head = malloc(heads * sizeof *places->head);
  places->next = malloc(((size_t)n + 1) * sizeof *places->next);
  if (!places->head || !places->next) {
    places_free(places);
    return status_set(ERR_MEMORY, "no memory to index %d particles", n);
  }
  for (unsigned long long h = 0; h < heads; h++) places->head[h] = -1;
  for (int i = 0; i < n; i++) {
    if (!is_finite(x[i])) continue;
    long long cell[DIM];
    for (int d = 0; d < DIM; d++) cell[d] = cell_of((double)x[i].c[d], side);
    int *head = &places->head[hash_of(cell) & places->mask];
    places->next[i] = *head;
    *head = i;
  }
  return OK;
}

struct search {
  double at[DIM], nearest; /* m, m^2 */
  int except, found;
};

static void search_cell(const struct places *places, struct search *s, const long long cell[DIM])
{
  for (int j = places->head[hash_of(cell) & places->mask]; j >= 0; j = places->next[j]) {
    double r2 = 0;
    for (int d = 0; d < DIM; d++) {
      const double e = (double)places->x[j].c[d] - s->at[d];
      r2 += e * e;
    }
    const int tie = r2 == s->nearest && s->found >= 0 && j < s->found;
    if (j != s->except && (r2 < s->nearest || tie)) {
      s->nearest = r2;
      s->found = j;
    }
  }
}

/* All cells that the ball of radius `reach` around s->at can touch. */
static void search_around(const struct places *places, struct search *s, double reach)
{
  long long low[DIM], high[DIM], cell[DIM];
  for (int d = 0; d < DIM; d++) {
    low[d] = cell[d] = cell_of(s->at[d] - reach, places->side);
    high[d] = cell_of(s->at[d] + reach, places->side);
  }
  for (int d = 0; d < DIM;) {
    search_cell(places, s, cell);
    for (d = 0; d < DIM; d++) {
      if (++cell[d] <= high[d]) break;
      cell[d] = low[d];
    }
  }
}

int places_nearest(const struct places *places, vec at, double reach, int except, double *distance)
{
  struct search s = {{0}, reach * reach, except, -1};
  if (distance) *distance = reach;
  if (!is_finite(at)) return -1;
  int images = 1;
  for (int d = 0; d < DIM; d++) images *= places->period.c[d] > 0 ? 3 : 1;
  for (int k = 0; k < images; k++) {
    for (int d = 0, rest = k; d < DIM; d++) {
      const int open = !(places->period.c[d] > 0), shift = open ? 0 : rest % 3 - 1;
      s.at[d] = (double)at.c[d] + shift * (double)places->period.c[d];
      rest = open ? rest : rest / 3;
    }
    search_around(places, &s, reach);
  }
  if (distance && s.found >= 0) *distance = sqrt(s.nearest);
  return s.found;
}

void places_free(struct places *places)
{
  free(places->head);
  free(places->next);
  places->head = places->next = NULL;
}
