#include "figure_plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "figure.h"
#include "process.h"

struct size {
  double particles, walls, steps; /* 0: the run is refused */
};

struct rate {
  double seconds, bytes; /* per particle and step; per particle; 0: unknown */
};

/* "...: N fluid and M wall particles, S steps of ..." */
static struct size size_told(const char *text)
{
  struct size size = {0, 0, 0};
  const char *at = text ? strstr(text, "): ") : NULL;
  if (!at) return size;
  size.particles = strtod(at + 3, NULL);
  const char *walls = strstr(at, " and "), *steps = strstr(at, "particles, ");
  if (walls && steps && walls < steps) size.walls = strtod(walls + 5, NULL);
  if (steps) size.steps = strtod(steps + 11, NULL);
  return size;
}

static status ask(const struct run *run, struct size *size)
{
  const char **argv = calloc((size_t)run->argc + 3, sizeof *argv);
  if (!argv) return status_set(ERR_MEMORY, "out of memory");
  argv[0] = run->executable.text;
  for (int k = 0; k < run->argc; k++) argv[1 + k] = run->argv[k];
  argv[1 + run->argc] = "--dry-run";
  char *text = process_output(argv);
  *size = size_told(text);
  free(text);
  free(argv);
  return OK;
}

static struct rate rate_of(const struct queue *queue, const struct journal_entry *entry)
{
  const struct path path = run_file(queue->results, entry->id, "json");
  json_t *facts = json_load_file(path.text, 0, NULL);
  const double n = fact_value(facts, "particles"), step = fact_value(facts, "per_step");
  const double bytes = fact_value(facts, "memory.bytes_per_particle");
  json_decref(facts);
  const int good = n > 0 && step > 0 && bytes > 0;
  return good ? (struct rate){step / n, bytes} : (struct rate){0, 0};
}

static struct rate rate_known(const struct queue *queue, const struct run *run)
{
  struct rate any = {0, 0};
  for (int k = queue->journal.n - 1; k >= 0; k--) {
    const struct journal_entry *e = &queue->journal.entry[k];
    const int same_scene = strcmp(e->scene, run->argv[1]) == 0;
    if (strcmp(e->solver, run->argv[3]) != 0 || strcmp(e->variant, run->name.text) != 0) continue;
    if (e->outcome != OUTCOME_OK || (any.bytes > 0 && !same_scene)) continue;
    const struct rate rate = rate_of(queue, e);
    if (rate.bytes > 0 && same_scene) return rate;
    if (rate.bytes > 0) any = rate;
  }
  return any;
}

static status show_run(const struct queue *queue, const struct run *run, double *seconds)
{
  struct size size = {0, 0, 0};
  const struct rate rate = rate_known(queue, run);
  TRY(ask(run, &size));
  printf("%s with %s (%s) %s\n    ", run->argv[1], run->argv[3], run->name.text, run->what);
  if (!(size.particles > 0)) {
    puts("is refused");
    return OK;
  }
  const double known = queue_known_time(queue, run);
  *seconds = run->finished ? 0 : known > 0 ? known : rate.seconds * size.particles * size.steps;
  printf("%.0f particles, %.0f of walls, %.0f steps", size.particles, size.walls, size.steps);
  if (rate.bytes > 0) printf(", %.0f MiB", rate.bytes * size.particles / 1048576);
  if (run->finished)
    printf(", %s already", outcome_words[run->outcome]);
  else if (*seconds > 0)
    printf(", about %.0f s", *seconds);
  else
    printf(", time unknown");
  puts("");
  return OK;
}

status figure_plan_show(const struct queue *queue)
{
  double total = 0;
  int todo = 0, unknown = 0;
  for (int k = 0; k < queue->n; k++) {
    double seconds = 0;
    const struct run *run = &queue->run[k];
    TRY(show_run(queue, run, &seconds));
    todo += !run->finished;
    unknown += !run->finished && !(seconds > 0);
    total += seconds;
  }
  printf("%d runs, %d to do: about %.0f s on one core each; %d of unknown time\n", queue->n, todo,
         total, unknown);
  return OK;
}
