/* `sphbench sweep`: every run of a plan, once. */
#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "figure.h"
#include "front.h"
#include "plan.h"

struct request {
  const char *plan, *results, *jobs, *timeout, *memory;
  int fresh, dry_run, quiet;
};

static status parse(struct request *r, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--results", &r->results, NULL}, {"--jobs", &r->jobs, NULL},
    {"--timeout", &r->timeout, NULL}, {"--memory", &r->memory, NULL},
    {"--fresh", NULL, &r->fresh},     {"--dry-run", NULL, &r->dry_run},
    {"--quiet", NULL, &r->quiet},
  };
  int names = 0;
  const struct arguments what = {"sweep", flags, sizeof flags / sizeof *flags, &r->plan, 1, &names};
  *r = (struct request){.results = "results"};
  TRY(arguments_parse(&what, argc, argv));
  return names == 1 ? OK : user_error("sweep needs a plan; 'sphbench list plans' lists them");
}

static void show_plan(const struct queue *queue)
{
  double known = 0;
  int todo = 0, unknown = 0;
  for (int k = 0; k < queue->n; k++) {
    const struct run *run = &queue->run[k];
    const double seconds = queue_known_time(queue, run);
    printf("%s  %s with %s (%s)%s%s", run->id, run->argv[1], run->argv[3], run->name.text,
           *run->what ? " " : "", run->what);
    if (run->finished)
      printf(": %s already\n", outcome_words[run->outcome]);
    else if (seconds > 0)
      printf(": took %.1f s before\n", seconds);
    else
      printf("\n");
    todo += !run->finished;
    unknown += !run->finished && !(seconds > 0);
    known += run->finished ? 0 : seconds;
  }
  printf("%d runs, %d to do; %.0f s of computing for those known, %d were never run\n", queue->n,
         todo, known, unknown);
}

/* Counts of how the runs ended; ERR_RUN where one crashed, since that is a fault of the program. */
static status conclude(const struct queue *queue, int quiet)
{
  int count[NUM_OUTCOMES] = {0}, ended = 0;
  for (int k = 0; k < queue->n; k++)
    if (queue->run[k].finished) {
      count[queue->run[k].outcome]++;
      ended++;
    }
  if (!quiet) {
    printf("%d runs:", ended);
    for (int k = 0; k < NUM_OUTCOMES; k++)
      if (count[k]) printf(" %d %s", count[k], outcome_words[k]);
    printf("; %d done now\n", queue->done);
  }
  if (count[OUTCOME_UNABLE] == ended)
    return user_error("sweep: nothing was run: %s", ended ? queue->run[0].reason : "no run");
  if (count[OUTCOME_CRASHED])
    return status_set(ERR_RUN, "%d of %d runs crashed; the journal and the logs say how",
                      count[OUTCOME_CRASHED], ended);
  return OK;
}

static status take_limits(const struct request *r, struct queue *queue)
{
  long jobs = queue->jobs;
  TRY(argument_whole("--jobs", r->jobs, 1, 256, &jobs));
  TRY(argument_whole("--memory", r->memory, 16, 1L << 30, &queue->memory));
  queue->jobs = (int)jobs;
  queue->quiet = r->quiet;
  if (!r->timeout) return OK;
  char *end;
  queue->limit = strtod(r->timeout, &end);
  if (*end == '\0' && queue->limit > 0) return OK;
  return user_error("--timeout: '%s' found, allowed is a number of seconds above 0", r->timeout);
}

static status work(const struct request *r, const struct plan *plan, struct queue *queue)
{
  struct names solvers = {NULL, 0};
  status result = take_limits(r, queue);
  if (result == OK) result = solver_names(&solvers);
  if (result == OK) result = plan_expand(plan, &solvers, queue);
  names_free(&solvers);
  if (result != OK) return result;
  for (int k = 0; k < queue->n && r->fresh; k++) queue->run[k].finished = 0;
  if (r->dry_run) {
    show_plan(queue);
    return OK;
  }
  TRY(queue_work(queue));
  return conclude(queue, r->quiet);
}

status verb_sweep(int argc, char **argv)
{
  struct request r;
  struct queue queue;
  struct plan *plan;
  TRY(parse(&r, argc, argv));
  TRY(plan_read(r.plan, &plan));
  status result = queue_open(&queue, r.results);
  if (result == OK) {
    result = work(&r, plan, &queue);
    queue_close(&queue);
  }
  plan_free(plan);
  return result;
}
