#include "estimate.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "process.h"

/* What finished runs cost. */
struct cost {
  double work;      /* particles * steps of the run that it is from; 0: of none */
  double rate;      /* [s] per particle and step */
  double base, per; /* memory [bytes]: of the program, and of a particle */
};
static const struct cost usual = {0, 5e-6, 16 << 20, 1000};

static double number_in(const json_t *object, const char *group, const char *key)
{
  return json_number_value(json_object_get(group ? json_object_get(object, group) : object, key));
}

static void take_facts(struct cost *cost, const json_t *facts)
{
  const double particles = number_in(facts, NULL, "particles") + number_in(facts, NULL, "walls");
  const double work = particles * number_in(facts, NULL, "steps");
  const double peak = number_in(facts, "memory", "peak_rss_bytes");
  const double too_small = 1e4; /* to tell of more than the start */
  if (!(work > cost->work) || work < too_small) return;
  cost->work = work;
  cost->rate = (number_in(facts, "timing", "total") - number_in(facts, "timing", "output")) / work;
  cost->per = number_in(facts, "memory", "bytes_per_particle");
  cost->base = peak > cost->per * particles ? peak - cost->per * particles : 0;
}

/* solver NULL: of any. */
static struct cost cost_of(const struct queue *queue, const char *solver)
{
  struct cost cost = usual;
  for (int k = 0; k < queue->journal.n; k++) {
    const struct journal_entry *entry = &queue->journal.entry[k];
    const struct path json = run_file(queue->results, entry->id, "json");
    if (entry->outcome != OUTCOME_OK || (solver && strcmp(entry->solver, solver) != 0)) continue;
    json_t *facts = json_load_file(json.text, 0, NULL);
    take_facts(&cost, facts);
    json_decref(facts);
  }
  return cost;
}

/* Costs of solvers are asked for again and again, and each reads the results. */
struct known {
  const char *solver;
  struct cost cost;
};

static struct cost find_cost(const struct queue *queue, const char *solver, struct known *known)
{
  int k = 0;
  while (known[k].solver && strcmp(known[k].solver, solver) != 0) k++;
  if (!known[k].solver) {
    known[k] = (struct known){solver, cost_of(queue, solver)};
    if (!(known[k].cost.work > 0)) known[k].cost = cost_of(queue, NULL);
  }
  return known[k].cost;
}

/* The first line of `run --dry-run`; NULL: refused. */
static char *ask(const struct run *run)
{
  const char **argv = calloc((size_t)run->argc + 3, sizeof *argv);
  if (!argv) return NULL;
  argv[0] = run->executable.text;
  for (int k = 0; k < run->argc; k++) argv[1 + k] = run->argv[k];
  argv[1 + run->argc] = "--dry-run";
  char *text = process_output(argv);
  free(argv);
  if (text) text[strcspn(text, "\n")] = '\0';
  return text;
}

static void estimate_one(const struct queue *queue, const struct run *run, struct known *known,
                         struct estimate *e)
{
  const struct cost cost = find_cost(queue, run->argv[3], known);
  const double before = queue_known_time(queue, run), start = 0.1; /* s */
  double fluid = 0, walls = 0, steps = 0;
  char *line = ask(run);
  const char *at = line ? strrchr(line, ':') : NULL;
  if (!at ||
      sscanf(at, ": %lf fluid and %lf wall particles, %lf steps", &fluid, &walls, &steps) != 3)
    e->refusal = strdup("refused: the program says why when it is run");
  free(line);
  if (e->refusal) return;
  e->measured = before > 0;
  e->seconds = before > 0 ? before : start + cost.rate * (fluid + walls) * steps;
  e->mebibytes = (cost.base + cost.per * (fluid + walls)) / (1 << 20);
}

status estimates_make(const struct queue *queue, struct estimate *all)
{
  struct known *known = calloc((size_t)queue->n + 1, sizeof *known);
  if (!known) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < queue->n; k++) {
    all[k] = (struct estimate){.seconds = 0};
    if (!queue->run[k].finished) estimate_one(queue, &queue->run[k], known, &all[k]);
  }
  free(known);
  return OK;
}
