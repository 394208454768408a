#include <stdlib.h>

#include "../base/memory.h"
#include "run.h"

enum { NUM_LISTS = 1 + MAX_PAIR_LISTS };

struct pair_visits {
  struct {
    long *rows; /* where the particles live [capacity] */
    int capacity, used;
  } list[NUM_LISTS];
  double total; /* of lists that were built anew since */
};

int visits_wanted;

/* Sum of a list's rows; < 0: no memory. */
static double count(const struct pair_visits *v, int k)
{
  double sum = 0;
  if (v->list[k].used == 0) return 0;
  long *rows = malloc(sizeof(long) * (size_t)v->list[k].used);
  if (!rows) return -1;
  memory_to_host(rows, v->list[k].rows, sizeof(long) * (size_t)v->list[k].used);
  for (int i = 0; i < v->list[k].used; i++) sum += (double)rows[i];
  free(rows);
  return sum;
}

static status clear(struct pair_visits *v, int k, int rows)
{
  if (rows > v->list[k].capacity) {
    memory_give(v->list[k].rows, sizeof(long) * (size_t)v->list[k].capacity);
    v->list[k].capacity = rows + rows / 4;
    v->list[k].rows = memory_take(sizeof(long) * (size_t)v->list[k].capacity);
    if (!v->list[k].rows) v->list[k].capacity = 0;
  }
  v->list[k].used = 0;
  long *zero = calloc((size_t)rows + 1, sizeof(long));
  if (zero && v->list[k].rows) {
    memory_from_host(v->list[k].rows, zero, sizeof(long) * (size_t)rows);
    v->list[k].used = rows;
  }
  free(zero);
  return v->list[k].used == rows ? OK : status_set(ERR_MEMORY, "no memory to count pairs");
}

status visits_renew(struct run *run, struct pair_list *list)
{
  if (!visits_wanted) return OK;
  if (!run->visits) run->visits = calloc(1, sizeof *run->visits);
  if (!run->visits) return status_set(ERR_MEMORY, "no memory to count pairs");
  const int k = list == &run->neighbours ? 0 : 1 + (int)(list - run->list);
  const double so_far = count(run->visits, k);
  if (so_far < 0) return status_set(ERR_MEMORY, "no memory to count pairs");
  run->visits->total += so_far;
  TRY(clear(run->visits, k, list->pairs.rows));
  list->pairs.visits = run->visits->list[k].rows;
  return OK;
}

double visits_total(const struct run *run)
{
  if (!run->visits) return 0;
  double total = run->visits->total;
  for (int k = 0; k < NUM_LISTS; k++) {
    const double part = count(run->visits, k);
    if (part < 0) return 0;
    total += part;
  }
  return total;
}

void visits_resume(struct run *run, double total)
{
  if (run->visits) run->visits->total += total - visits_total(run);
}

void visits_free(struct run *run)
{
  for (int k = 0; run->visits && k < NUM_LISTS; k++)
    memory_give(run->visits->list[k].rows, sizeof(long) * (size_t)run->visits->list[k].capacity);
  free(run->visits);
  run->visits = NULL;
}
