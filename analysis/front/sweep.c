/* `sphbench sweep`: every run of a plan, once. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "emit.h"
#include "estimate.h"
#include "figure.h"
#include "front.h"
#include "manifest.h"
#include "plan.h"
#include "timed.h"

struct request {
  const char *plan, *results, *jobs, *timeout, *memory;
  const char *engine, *folder, *batch; /* --emit ENGINE FOLDER */
  const char *manifest, *task;
  const char *timed, *threads; /* repetitions of timed runs, and their threads */
  int fresh, dry_run, quiet;
};

/* --emit has two values, which are taken out of argv. */
static status take_emit(struct request *r, int *argc, char **argv)
{
  int kept = 2;
  for (int i = 2; i < *argc; i++) {
    if (strcmp(argv[i], "--emit") != 0) {
      argv[kept++] = argv[i];
      continue;
    }
    if (i + 2 >= *argc)
      return user_error("--emit needs two values: slurm or parallel, and a folder");
    r->engine = argv[++i];
    r->folder = argv[++i];
    TRY(emit_check(r->engine));
  }
  argv[ *argc = kept] = NULL;
  return OK;
}

static status parse(struct request *r, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--results", &r->results, NULL}, {"--jobs", &r->jobs, NULL},
    {"--timeout", &r->timeout, NULL}, {"--memory", &r->memory, NULL},
    {"--fresh", NULL, &r->fresh},     {"--dry-run", NULL, &r->dry_run},
    {"--quiet", NULL, &r->quiet},     {"--batch", &r->batch, NULL},
    {"--task", &r->task, NULL},       {"--manifest", &r->manifest, NULL},
    {"--timed", &r->timed, NULL},     {"--threads", &r->threads, NULL},
  };
  int names = 0;
  const struct arguments what = {"sweep", flags, sizeof flags / sizeof *flags, &r->plan, 1, &names};
  *r = (struct request){.results = NULL};
  TRY(take_emit(r, &argc, argv));
  TRY(arguments_parse(&what, argc, argv));
  const int settled = r->results || r->timeout || r->memory || r->fresh || r->dry_run ||
                      r->engine || r->timed || r->threads;
  if (!r->results) r->results = "results";
  if (!r->manifest != !r->task) return user_error("sweep: --manifest and --task go together");
  if (r->timed && r->engine)
    return user_error("sweep: --timed does not go with --emit: time where nothing else runs");
  if (r->batch && !r->engine) return user_error("sweep: --batch goes with --emit");
  if (r->manifest && names)
    return user_error("sweep: '%s' found, but a manifest takes the place of a plan", r->plan);
  if (r->manifest && settled)
    return user_error("sweep: with --manifest only --task, --jobs and --quiet are allowed; the "
                      "rest stands in the manifest");
  return names == 1 || r->manifest
           ? OK
           : user_error("sweep needs a plan; 'sphbench list plans' lists them");
}

static void show_run(const struct run *run, const struct estimate *e)
{
  printf("%s  %s with %s (%s)%s%s: ", run->id, run->argv[1], run->argv[3], run->name.text,
         *run->what ? " " : "", run->what);
  if (run->finished)
    printf("%s already\n", outcome_words[run->outcome]);
  else if (e->refusal)
    printf("%s\n", e->refusal);
  else
    printf("%s %.2g s, about %.3g MiB\n", e->measured ? "took" : "about", e->seconds, e->mebibytes);
}

static status show_plan(const struct queue *queue)
{
  struct estimate *all = calloc((size_t)queue->n + 1, sizeof *all);
  double seconds = 0, most = 0;
  int todo = 0;
  if (!all) return status_set(ERR_MEMORY, "out of memory");
  const status result = estimates_make(queue, all);
  for (int k = 0; k < queue->n && result == OK; k++) {
    show_run(&queue->run[k], &all[k]);
    todo += !queue->run[k].finished;
    seconds += all[k].seconds;
    most = fmax(most, all[k].mebibytes);
    free(all[k].refusal);
  }
  free(all);
  if (result == OK)
    printf("%d runs, %d to do: about %.2g s on one core, %.2g s on %d; at most about %.3g MiB at "
           "once\n",
           queue->n, todo, seconds, seconds / queue->jobs, queue->jobs, most * queue->jobs);
  return result;
}

/* Counts of how the runs ended; ERR_RUN where one crashed, since that is a fault of the program. A
 * whole plan of which nothing was run is a mistake, a task of it need not be. */
static status conclude(const struct queue *queue, int quiet, int whole)
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
  if (whole && count[OUTCOME_UNABLE] == ended)
    return user_error("sweep: nothing was run: %s", ended ? queue->run[0].reason : "no run");
  if (count[OUTCOME_CRASHED])
    return status_set(ERR_RUN, "%d of %d runs crashed; the journal and the logs say how",
                      count[OUTCOME_CRASHED], ended);
  if (count[OUTCOME_INTERRUPTED])
    return status_set(ERR_RUN, "%d of %d runs were stopped from outside; start the sweep again",
                      count[OUTCOME_INTERRUPTED], ended);
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

/* After the untimed runs, which fill all cores. */
static status take_times(const struct request *r, const struct plan *plan,
                         const struct queue *queue)
{
  struct timings_settings how = {.threads = 1, .fresh = r->fresh, .quiet = r->quiet};
  TRY(argument_whole("--timed", r->timed ? r->timed : plan->timed, 2, 1000, &how.repeat));
  TRY(argument_whole("--threads", r->threads, 1, MOST_CORES, &how.threads));
  return how.repeat ? timings_take(queue, &how) : OK;
}

static status emit(const struct request *r, struct queue *queue)
{
  struct emit what = {.engine = r->engine, .folder = r->folder, .plan = r->plan, .fresh = r->fresh};
  TRY(argument_whole("--batch", r->batch, 1, 1000000, &what.batch));
  TRY(argument_whole("--jobs", r->jobs, 1, 256, &what.jobs));
  return emit_write(&what, queue);
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
  if (r->dry_run) return show_plan(queue);
  if (r->engine) return emit(r, queue);
  TRY(queue_work(queue));
  TRY(take_times(r, plan, queue));
  return conclude(queue, r->quiet, 1);
}

/* One task of a manifest. Its engine gives it one processor, unless --jobs says more. */
static status work_task(const struct request *r)
{
  struct queue queue;
  json_t *manifest;
  long task = 0, jobs = 1;
  TRY(argument_whole("--task", r->task, 0, MOST_TASKS, &task));
  TRY(argument_whole("--jobs", r->jobs, 1, 256, &jobs));
  TRY(manifest_open(r->manifest, task, &queue, &manifest));
  queue.jobs = (int)jobs;
  queue.quiet = r->quiet;
  status result = queue_work(&queue);
  if (result == OK) result = conclude(&queue, r->quiet, 0);
  queue_close(&queue);
  json_decref(manifest);
  return result;
}

status verb_sweep(int argc, char **argv)
{
  struct request r;
  struct queue queue;
  struct plan *plan;
  TRY(parse(&r, argc, argv));
  if (r.manifest) return work_task(&r);
  TRY(plan_read(r.plan, &plan));
  status result = queue_open(&queue, r.results);
  if (result == OK) {
    result = work(&r, plan, &queue);
    queue_close(&queue);
  }
  plan_free(plan);
  return result;
}
