/* `sphbench convergence --over iterations`: the algebraic error of one step after a number of
 * iterations of each solver, and how fast it falls.
 *
 * The reference is the same step solved as far as it goes, so neither the truth of the scene nor
 * the size of the step is in these errors. It is the first step: there is nothing to start warm
 * from. */
#include "../../core/base/sorted.h"
#include "iterations.h"

#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "figure.h"
#include "front.h"

const double iteration_targets[NUM_TARGETS] = {1e-1, 1e-2, 1e-3};

struct typed {
  struct study_request ask;
  const char *json, *jobs, *timeout, *over, *spacing, *counts, *seed, *jitter, *unused;
  double limit;
  long num_jobs;
  int quiet;
};

static status parse(struct typed *t, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--solvers", &t->ask.solvers, NULL}, {"--results", &t->ask.results, NULL},
    {"--dim", &t->ask.dim, NULL},         {"--precision", &t->ask.precision, NULL},
    {"--backend", &t->ask.backend, NULL}, {"--set", &t->unused, NULL},
    {"--over", &t->over, NULL},           {"--spacing", &t->spacing, NULL},
    {"--iterations", &t->counts, NULL},   {"--seed", &t->seed, NULL},
    {"--jitter", &t->jitter, NULL},       {"--timeout", &t->timeout, NULL},
    {"--jobs", &t->jobs, NULL},           {"--json", &t->json, NULL},
    {"--quick", NULL, &t->ask.quick},     {"--quiet", NULL, &t->quiet},
  };
  const struct arguments what = {
    "convergence --over iterations", flags, sizeof flags / sizeof *flags, &t->ask.scene, 1, NULL};
  *t = (struct typed){.ask = {.verb = "convergence", .results = "results", .needs_no_truth = 1}};
  TRY(arguments_parse(&what, argc, argv));
  return arguments_sets(argc, argv, t->ask.set, MOST_SETS, &t->ask.num_sets);
}

static status take_counts(const char *text, struct values *count)
{
  const double most = 1000000; /* what solvers allow */
  *count = (struct values){.value = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48}, .n = 11};
  TRY(values_parse("--iterations", text, count));
  sort_numbers(count->value, count->n);
  for (int k = 0; k < count->n; k++)
    if (count->value[k] != floor(count->value[k]) || count->value[k] > most ||
        (k && count->value[k] == count->value[k - 1]))
      return user_error("--iterations: '%s' found, allowed are different whole numbers from 1 to "
                        "%g",
                        text, most);
  return OK;
}

/* What needs no scene to be checked. */
static status take_numbers(struct typed *t, struct iterations *it)
{
  it->quiet = t->quiet;
  it->seed = 1;
  it->jitter = 0.1;
  t->num_jobs = processors();
  t->limit = 600;
  TRY(take_counts(t->counts, &it->count));
  TRY(argument_whole("--seed", t->seed, 1, 1000000, &it->seed));
  TRY(argument_whole("--jobs", t->jobs, 1, 256, &t->num_jobs));
  TRY(value_parse("--jitter", t->jitter, &it->jitter));
  return value_parse("--timeout", t->timeout, &t->limit);
}

/* The finest spacing of the scene's sweep, with --quick its coarsest; one step long. */
static status take_size(const struct typed *t, struct iterations *it)
{
  struct study *s = &it->study;
  const struct values *sizes = &s->plan.spacing;
  it->spacing = sizes->value[0];
  for (int k = 1; k < sizes->n; k++)
    it->spacing = (t->ask.quick ? fmax : fmin)(it->spacing, sizes->value[k]);
  TRY(value_parse("--spacing", t->spacing, &it->spacing));
  it->dt = s->is_projection ? 0 : s->dt * it->spacing / s->spacing;
  s->plan.t_end = it->dt;
  return OK;
}

/* --- runs --- */

static status add_curve(struct iterations *it, int method)
{
  struct iteration_curve *curve = &it->curve[method];
  const struct method *m = &it->study.method[method];
  struct knobs knobs = {.method = method,
                        .spacing = it->spacing,
                        .dt = it->dt,
                        .factor = 0,
                        .jitter = it->jitter,
                        .seed = it->seed};
  *curve = (struct iteration_curve){.method = method, .reference = -1};
  if (m->refusal || !m->has_fixed) {
    curve->reason = strdup(m->refusal ? m->refusal : "not iterative: no fixed_iterations");
    return curve->reason ? OK : status_set(ERR_MEMORY, "out of memory");
  }
  TRY(study_add(&it->study, &knobs, &it->queue, &curve->reference));
  for (int k = 0; k < it->count.n; k++) {
    knobs.iterations = (int)it->count.value[k];
    TRY(study_add(&it->study, &knobs, &it->queue, &curve->at[k].run));
  }
  return OK;
}

static status add_curves(struct iterations *it)
{
  it->curve = calloc((size_t)it->study.num_methods + 1, sizeof *it->curve);
  if (!it->curve) return status_set(ERR_MEMORY, "out of memory");
  for (int m = 0; m < it->study.num_methods; m++) TRY(add_curve(it, m));
  return OK;
}

/* --- what came of them --- */

/* A reference that was stopped is none. */
static void read_reference(const struct iterations *it, struct iteration_curve *curve)
{
  json_t *facts;
  char *failure = study_failure(&it->queue, curve->reference, &facts);
  curve->reference_iterations = fact_number(facts, "iterations.max");
  curve->reference_residual = fact_number(facts, "residual.last");
  const double cap = fact_number(facts, "parameters.max_iterations");
  if (failure)
    curve->reason = text_make("the reference %s", failure);
  else if (curve->reference_iterations >= cap)
    curve->reason = text_make("the reference did not converge in %g iterations (%.2g left)", cap,
                              curve->reference_residual);
  free(failure);
  json_decref(facts);
}

static status read_iterate(const struct iterations *it, const struct iteration_curve *curve,
                           struct iterate *at)
{
  json_t *facts;
  const struct queue *queue = &it->queue;
  at->residual = at->velocity_error = at->pressure_error = (double)NAN;
  at->reason = study_failure(queue, at->run, &facts);
  if (!at->reason) at->residual = fact_number(facts, "residual.last");
  json_decref(facts);
  if (at->reason) return OK;
  TRY(study_distance(queue, at->run, curve->reference, "velocity", &at->velocity_error));
  return study_distance(queue, at->run, curve->reference, "pressure", &at->pressure_error);
}

/* order_fit takes error = C h^p: with h = exp(-k) that is C exp(-p k). What lies below the part of
 * the velocity that the reference itself is sure of is no error of the iteration. */
static void fit_rate(const struct iterations *it, struct iteration_curve *curve)
{
  const double sure = 1e-8; /* two digits above what a reference is solved to */
  struct level level[MOST_VALUES];
  int n = 0;
  for (int k = 0; k < it->count.n; k++)
    if (curve->at[k].velocity_error > sure)
      level[n++] = (struct level){exp(-it->count.value[k]), curve->at[k].velocity_error, 0};
  if (order_fit(level, n, 0, &curve->fit) != OK) curve->unfit = strdup(status_sentence());
}

static status read_curves(struct iterations *it)
{
  for (int m = 0; m < it->study.num_methods; m++) {
    struct iteration_curve *curve = &it->curve[m];
    if (curve->reason) continue;
    read_reference(it, curve);
    if (curve->reason) continue;
    for (int k = 0; k < it->count.n; k++) TRY(read_iterate(it, curve, &curve->at[k]));
    fit_rate(it, curve);
  }
  return OK;
}

int iterations_to(const struct iterations *it, const struct iteration_curve *curve, double target)
{
  int found = 0;
  for (int k = it->count.n - 1; k >= 0 && curve->at[k].velocity_error <= target; k--)
    found = (int)it->count.value[k];
  return found;
}

/* --- what to say --- */

static void say_curve(const struct iterations *it, const struct iteration_curve *curve)
{
  const char *name = it->study.method[curve->method].name;
  if (curve->reason) {
    printf("  %-12s %s\n", name, curve->reason);
    return;
  }
  if (curve->unfit)
    printf("  %-12s no rate: %s;", name, curve->unfit);
  else
    printf("  %-12s %.3f an iteration [%.3f, %.3f];", name, exp(-curve->fit.order),
           exp(-curve->fit.high), exp(-curve->fit.low));
  for (int k = 0; k < NUM_TARGETS; k++) {
    const int reached = iterations_to(it, curve, iteration_targets[k]);
    if (reached > 0)
      printf(" %g at %d;", iteration_targets[k], reached);
    else
      printf(" %g not reached;", iteration_targets[k]);
  }
  printf(" %.2g after %g\n", curve->at[it->count.n - 1].velocity_error,
         it->count.value[it->count.n - 1]);
}

static void say(const struct iterations *it)
{
  if (it->quiet) return;
  printf("%s: error of the velocity after one step over iterations, against the same step solved\n"
         "to 1e-10; dx %g m, disturbed by up to %g dx (seed %ld), no warm start\n",
         it->study.ask.scene, it->spacing, it->jitter, it->seed);
  for (int m = 0; m < it->study.num_methods; m++) say_curve(it, &it->curve[m]);
}

/* --- the whole --- */

static status work(struct iterations *it, const struct typed *t)
{
  TRY(take_size(t, it));
  it->folder = path_of("%s/convergence/%s/iterations", t->ask.results, t->ask.scene);
  TRY(folder_make(it->folder.text));
  it->queue.limit = t->limit;
  TRY(add_curves(it));
  TRY(queue_work(&it->queue));
  TRY(read_curves(it));
  it->quiet |= t->json && strcmp(t->json, "-") == 0;
  say(it);
  TRY(iterations_write(it, t->json));
  for (int m = 0; m < it->study.num_methods; m++)
    if (!it->curve[m].reason) return iterations_draw(it);
  return status_set(ERR_RUN,
                    "convergence: no solver has a curve over iterations, the first since "
                    "%s",
                    it->curve[0].reason);
}

static void release(struct iterations *it)
{
  for (int m = 0; it->curve && m < it->study.num_methods; m++) {
    free(it->curve[m].unfit);
    free(it->curve[m].reason);
    for (int k = 0; k < MOST_VALUES; k++) free(it->curve[m].at[k].reason);
  }
  free(it->curve);
  study_close(&it->study);
  queue_close(&it->queue);
}

status verb_iterations(int argc, char **argv)
{
  static struct iterations it; /* large, and there is one */
  struct typed t;
  it = (struct iterations){.queue = {.journal = {.file = -1}}};
  TRY(parse(&t, argc, argv));
  TRY(take_numbers(&t, &it));
  TRY(gnuplot_check());
  TRY(study_open(&it.study, &t.ask));
  status result = queue_open(&it.queue, t.ask.results);
  it.queue.jobs = (int)t.num_jobs;
  it.queue.quiet = t.quiet;
  if (result == OK) result = work(&it, &t);
  release(&it);
  return result;
}
