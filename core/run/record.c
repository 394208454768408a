/* Samples of metrics over a run. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "driver.h"

static status grow(double **columns, int n, long rows, long *room)
{
  if (rows < *room) return OK;
  const long wanted = *room ? 2 * *room : 256;
  for (int k = 0; k < n; k++) {
    double *grown = realloc(columns[k], sizeof(double) * (size_t)wanted);
    if (!grown) return status_set(ERR_MEMORY, "no memory for the series");
    columns[k] = grown;
  }
  *room = wanted;
  return OK;
}

status record_sample(struct record *r, struct run *run, struct setting *set, struct snapshot *now)
{
  const enum phase before = clock_enter(PHASE_METRICS);
  status result = grow(r->sample, NUM_METRICS + 3, r->rows, &r->row_room);
  if (result == OK && !r->has_start) {
    result = metrics_start_make(now, &r->start);
    r->has_start = result == OK;
  }
  if (result == OK) {
    now->start = &r->start;
    for (int k = 0; k < NUM_METRICS; k++) r->last.value[k] = NAN;
    metrics_measure(now, &r->last);
    if (set->benchmark && set->benchmark->measure)
      set->benchmark->measure(set->self, now, &r->last);
    judge_sample(run, now, &r->last);
    long total = 0;
    for (int k = 0; k < run->num_iterations; k++) total += run->iterations[k].total;
    const long steps = run->step - r->steps_counted;
    for (int k = 0; k < NUM_METRICS; k++) r->sample[k][r->rows] = r->last.value[k];
    r->sample[SAMPLE_TIME][r->rows] = now->time;
    r->sample[SAMPLE_ITERATIONS][r->rows] =
      steps > 0 ? (double)(total - r->iterations_counted) / (double)steps : 0;
    r->sample[SAMPLE_RESIDUAL][r->rows] = run->step_residual;
    r->steps_counted = run->step;
    r->iterations_counted = total;
    r->rows++;
  }
  clock_enter(before);
  return result;
}

status record_step(struct record *r, const struct run *run)
{
  TRY(grow(r->step, 3, r->steps, &r->step_room));
  r->step[0][r->steps] = run->time;
  r->step[1][r->steps] = run->step_iterations;
  r->step[2][r->steps] = run->step_residual;
  r->steps++;
  return OK;
}

status record_make_room(struct record *r, long rows, long steps)
{
  const long most = 1L << 40;
  if (rows < 0 || steps < 0 || rows > most || steps > most)
    return user_error("a series of %ld samples and %ld steps cannot be", rows, steps);
  for (; r->rows < rows; r->rows = r->row_room < rows ? r->row_room : rows)
    TRY(grow(r->sample, NUM_METRICS + 3, r->rows, &r->row_room));
  for (; r->steps < steps; r->steps = r->step_room < steps ? r->step_room : steps)
    TRY(grow(r->step, 3, r->steps, &r->step_room));
  r->rows = rows;
  r->steps = steps;
  return OK;
}

void record_free(struct record *r)
{
  for (int k = 0; k < NUM_METRICS + 3; k++) free(r->sample[k]);
  for (int k = 0; k < 3; k++) free(r->step[k]);
  if (r->has_start) metrics_start_free(&r->start);
  memset(r, 0, sizeof *r);
}
