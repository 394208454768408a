/* `sphbench convergence`: the order at which errors fall with the spacing, or the time step. */
#include "convergence.h"

#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "figure.h"
#include "front.h"
#include "iterations.h"
#include "study_file.h"

enum { LEAST_LEVELS = 4 };

struct typed {
  struct study_request ask;
  const char *json, *jobs, *timeout, *over, *t_end, *spacings, *dts, *seeds, *jitter, *unused;
  double limit;
  long num_jobs;
  int quiet;
};

static status parse(struct typed *t, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--solvers", &t->ask.solvers, NULL}, {"--results", &t->ask.results, NULL},
    {"--dim", &t->ask.dim, NULL},         {"--precision", &t->ask.precision, NULL},
    {"--backend", &t->ask.backend, NULL}, {"--t-end", &t->t_end, NULL},
    {"--set", &t->unused, NULL},          {"--over", &t->over, NULL},
    {"--spacings", &t->spacings, NULL},   {"--dt-factors", &t->dts, NULL},
    {"--seeds", &t->seeds, NULL},         {"--jitter", &t->jitter, NULL},
    {"--timeout", &t->timeout, NULL},     {"--jobs", &t->jobs, NULL},
    {"--json", &t->json, NULL},           {"--quick", NULL, &t->ask.quick},
    {"--error", &t->ask.error, NULL},     {"--quiet", NULL, &t->quiet},
  };
  const struct arguments what = {"convergence", flags, sizeof flags / sizeof *flags,
                                 &t->ask.scene, 1,     NULL};
  *t = (struct typed){.ask = {.verb = "convergence", .results = "results"}};
  TRY(arguments_parse(&what, argc, argv));
  return arguments_sets(argc, argv, t->ask.set, MOST_SETS, &t->ask.num_sets);
}

/* What needs no scene to be checked. */
static status take_numbers(struct typed *t, struct convergence *c)
{
  c->seeds = 5;
  c->quiet = t->quiet;
  c->jitter = -1;
  t->num_jobs = processors();
  c->over_dt = t->over && strcmp(t->over, "dt") == 0;
  if (t->over && !c->over_dt && strcmp(t->over, "spacing") != 0)
    return user_error("--over: '%s' found, allowed is spacing, dt or iterations", t->over);
  TRY(argument_whole("--seeds", t->seeds, 0, 1000, &c->seeds));
  TRY(argument_whole("--jobs", t->jobs, 1, 256, &t->num_jobs));
  TRY(value_parse("--jitter", t->jitter, &c->jitter));
  return value_parse("--timeout", t->timeout, &t->limit);
}

/* --- levels --- */

static int descending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x < y) - (x > y);
}

static double least(const struct values *values)
{
  double low = HUGE_VAL;
  for (int k = 0; k < values->n; k++) low = fmin(low, values->value[k]);
  return low;
}

/* Over the spacing: all levels with one time step, small enough for the finest. Over the time step:
 * one spacing, and a reference with a quarter of the smallest step. */
static status take_levels(const struct typed *t, struct convergence *c)
{
  struct study *s = &c->study;
  if (s->file && s->file->levels.t_end > 0) s->plan.t_end = s->file->levels.t_end;
  const struct values halves = {.value = {1, 0.5, 0.25, 0.125}, .n = 4};
  struct values spacings = c->over_dt ? s->plan.spacing : s->levels, steps = halves;
  TRY(values_parse("--spacings", t->spacings, &spacings));
  TRY(values_parse("--dt-factors", t->dts, &steps));
  TRY(value_parse("--t-end", t->t_end, &s->plan.t_end));
  if (c->jitter < 0) c->jitter = s->jitter;
  if (c->seeds == 0) c->jitter = 0;
  if (c->over_dt && s->is_projection)
    return user_error("--over dt: '%s' is one projection, which takes no steps", s->ask.scene);
  c->h = c->over_dt ? steps : spacings;
  if (c->h.n < LEAST_LEVELS)
    return user_error("%s: %d levels found, an order needs at least %d",
                      c->over_dt ? "--dt-factors" : "--spacings", c->h.n, LEAST_LEVELS);
  qsort(c->h.value, (size_t)c->h.n, sizeof *c->h.value, descending);
  s->plan.spacing = spacings; /* the coarsest is what solvers are asked whether they can run */
  if (!c->over_dt) return OK;
  const double spacing = least(&spacings), finest = least(&steps);
  for (int k = 0; k < c->h.n; k++) c->h.value[k] = study_dt(s, c->h.value[k], spacing);
  c->h_reference = study_dt(s, finest / 4, spacing);
  return OK;
}

static struct knobs knobs_at(const struct convergence *c, int method, int level, int start)
{
  const struct study *s = &c->study;
  const double tightest = fmin(least(&s->plan.tolerance), 1);
  struct knobs k = {.method = method,
                    .spacing = c->over_dt ? least(&s->plan.spacing) : c->h.value[level],
                    .factor = method_iterates(&s->method[method]) ? tightest : 1,
                    .jitter = c->jitter,
                    .seed = c->seeds > 0 ? start + 1 : 0};
  const double half = 0.5;
  k.dt = c->over_dt ? c->h.value[level]
                    : study_dt(s, fmin(least(&s->plan.dt), half), c->h.value[c->h.n - 1]);
  return k;
}

/* --- trials --- */

static status add_trial(struct convergence *c, int method, int level, int start)
{
  struct trial *t = &c->trial[c->n++];
  *t = (struct trial){.knobs = knobs_at(c, method, level, start),
                      .level = level,
                      .start = start,
                      .reference = -1,
                      .error = (double)NAN};
  struct knobs other = t->knobs;
  TRY(study_add(&c->study, &t->knobs, &c->queue, &t->run));
  /* does the time step matter? asked once, at the finest level, where it would most */
  const int asks = !c->study.is_projection && start == 0 && level == c->h.n - 1;
  if (!c->over_dt && !asks) return OK;
  other.dt = c->over_dt ? c->h_reference : t->knobs.dt / 2;
  return study_add(&c->study, &other, &c->queue, &t->reference);
}

static status add_trials(struct convergence *c)
{
  const struct study *s = &c->study;
  const int starts = c->seeds > 0 ? (int)c->seeds : 1;
  c->trial = calloc((size_t)(s->num_methods * c->h.n * starts) + 1, sizeof *c->trial);
  c->curve = calloc((size_t)s->num_methods + 1, sizeof *c->curve);
  if (!c->trial || !c->curve) return status_set(ERR_MEMORY, "out of memory");
  for (int m = 0; m < s->num_methods; m++) {
    if (s->method[m].refusal) continue;
    c->curve[c->num_curves++] = (struct curve){.method = m, .dt_influence = (double)NAN};
    for (int level = 0; level < c->h.n; level++)
      for (int start = 0; start < starts; start++) TRY(add_trial(c, m, level, start));
  }
  return OK;
}

static double metric_of(const struct convergence *c, const json_t *facts)
{
  const struct path keys = path_of("metrics.%s.value", c->study.error);
  return fact_number(facts, keys.text);
}

static status read_trial(struct convergence *c, struct trial *t)
{
  json_t *facts;
  status result = OK;
  t->reason = study_failure(&c->queue, t->run, &facts);
  if (!t->reason && c->over_dt) {
    json_t *unused;
    t->reason = study_failure(&c->queue, t->reference, &unused);
    json_decref(unused);
    if (!t->reason)
      result = study_distance(&c->queue, t->run, t->reference, study_array(&c->study), &t->error);
  } else if (!t->reason) {
    t->error = metric_of(c, facts);
  }
  json_decref(facts);
  const double rounding = 1e-11;
  if (result == OK && !t->reason && !(t->error > rounding))
    t->reason = text_make("its error is %.2g, hardly more than rounding", t->error);
  return result;
}

/* --- from trials to orders --- */

/* Mean and scatter over the starts of a level; one that failed spoils the mean. */
static void take_level(const struct convergence *c, struct curve *curve, int level)
{
  double sum = 0, squares = 0;
  int n = 0, failed = 0;
  const char *why = "";
  for (int k = 0; k < c->n; k++) {
    const struct trial *t = &c->trial[k];
    if (t->knobs.method != curve->method || t->level != level) continue;
    n++;
    if (t->reason) why = t->reason;
    failed += t->reason != NULL;
    sum += t->error;
    squares += t->error * t->error;
  }
  const double mean = sum / n, variance = n > 1 ? (squares - n * mean * mean) / (n - 1) : 0;
  curve->level[level] = (struct level){c->h.value[level], failed ? (double)NAN : mean,
                                       failed ? 0 : sqrt(fmax(variance, 0) / n) / mean};
  if (failed) curve->reason[level] = text_make("%d of %d starts failed: %s", failed, n, why);
}

/* How much half the time step changes the error. */
static void take_influence(const struct convergence *c, struct curve *curve)
{
  for (int k = 0; k < c->n && !c->over_dt; k++) {
    const struct trial *t = &c->trial[k];
    json_t *facts;
    if (t->knobs.method != curve->method || t->reference < 0 || t->reason) continue;
    char *failure = study_failure(&c->queue, t->reference, &facts);
    if (!failure) curve->dt_influence = fabs(metric_of(c, facts) - t->error) / t->error;
    free(failure);
    json_decref(facts);
  }
}

static void take_order(const struct convergence *c, struct curve *curve)
{
  for (int k = 0; k < c->h.n; k++) {
    take_level(c, curve, k);
    curve->local[k] =
      k ? order_local(&curve->level[k - 1], &curve->level[k], c->h_reference) : (double)NAN;
  }
  take_influence(c, curve);
  if (order_fit(curve->level, c->h.n, c->h_reference, &curve->fit) != OK)
    curve->unfit = strdup(status_sentence());
}

static status read_trials(struct convergence *c)
{
  for (int k = 0; k < c->n; k++) TRY(read_trial(c, &c->trial[k]));
  for (int k = 0; k < c->num_curves; k++) take_order(c, &c->curve[k]);
  return OK;
}

/* --- what to say --- */

static void say_curve(const struct convergence *c, const struct curve *curve)
{
  const char *name = c->study.method[curve->method].name;
  const double most = 0.1; /* part of the error that half the time step may change */
  if (curve->unfit) {
    printf("  %-12s %s\n", name, curve->unfit);
  } else {
    printf("  %-12s order %.2f [%.2f, %.2f] over %d levels; local", name, curve->fit.order,
           curve->fit.low, curve->fit.high, curve->fit.n);
    for (int k = 1; k < c->h.n; k++) printf(" %.2f", curve->local[k]);
    printf("; error %.3g to %.3g\n", curve->level[0].error, curve->level[c->h.n - 1].error);
  }
  if (curve->dt_influence > most)
    printf("  %-12s half the time step changes its error by %.2g of it: not spatial alone\n", "",
           curve->dt_influence);
  for (int k = 0; k < c->h.n; k++)
    if (curve->reason[k]) printf("  %-12s at %.4g: %s\n", "", c->h.value[k], curve->reason[k]);
}

static void say(const struct convergence *c)
{
  if (c->quiet) return;
  printf("%s: %s error over %s, ", c->study.ask.scene, c->kind, c->over_dt ? "dt" : "spacing");
  if (c->seeds > 0)
    printf("%ld starts disturbed by up to %g dx\n", c->seeds, c->jitter);
  else
    printf("from the lattice\n");
  for (int k = 0; k < c->num_curves; k++) say_curve(c, &c->curve[k]);
  for (int k = 0; k < c->study.num_methods; k++)
    if (c->study.method[k].refusal) printf("  not run: %s\n", c->study.method[k].refusal);
}

/* --- the whole --- */

/* In --quick, such that 12 minutes are enough even if every run reaches it. */
static double limit_of(const struct convergence *c, const struct typed *t)
{
  const double quick = 720, shortest = 2, longest = 600;
  const double references = c->over_dt ? 2 : 1; /* runs that belong to each trial */
  const double runs = references * c->study.num_methods * c->h.n * fmax(1, (double)c->seeds);
  if (t->limit > 0) return t->limit;
  return t->ask.quick ? fmin(fmax(quick * c->queue.jobs / runs, shortest), longest) : longest;
}

static status work(struct convergence *c, const struct typed *t)
{
  TRY(take_levels(t, c));
  c->kind = c->over_dt ? "temporal" : "spatial";
  c->folder =
    path_of("%s/convergence/%s/%s", t->ask.results, t->ask.scene, c->over_dt ? "dt" : "spacing");
  TRY(folder_make(c->folder.text));
  c->queue.limit = limit_of(c, t);
  TRY(add_trials(c));
  TRY(queue_work(&c->queue));
  TRY(read_trials(c));
  const int to_stdout = t->json && strcmp(t->json, "-") == 0;
  c->quiet |= to_stdout;
  say(c);
  TRY(convergence_write(c, t->json));
  return convergence_draw(c);
}

static status judge(const struct convergence *c)
{
  for (int k = 0; k < c->num_curves; k++)
    if (!c->curve[k].unfit) return OK;
  return status_set(ERR_RUN, "convergence: no solver has an order, the first since %s",
                    c->num_curves ? c->curve[0].unfit : "there is none");
}

static void release(struct convergence *c)
{
  for (int k = 0; k < c->n; k++) free(c->trial[k].reason);
  for (int k = 0; k < c->num_curves; k++) {
    free(c->curve[k].unfit);
    for (int l = 0; l < MOST_VALUES; l++) free(c->curve[k].reason[l]);
  }
  free(c->trial);
  free(c->curve);
  study_close(&c->study);
  queue_close(&c->queue);
}

/* Those curves have flags of their own (iterations.c). */
static int is_over_iterations(int argc, char **argv)
{
  for (int k = 2; k + 1 < argc; k++)
    if (strcmp(argv[k], "--over") == 0 && strcmp(argv[k + 1], "iterations") == 0) return 1;
  return 0;
}

status verb_convergence(int argc, char **argv)
{
  static struct convergence c; /* large, and there is one */
  struct typed t;
  if (is_over_iterations(argc, argv)) return verb_iterations(argc, argv);
  c = (struct convergence){.queue = {.journal = {.file = -1}}};
  TRY(parse(&t, argc, argv));
  TRY(take_numbers(&t, &c));
  TRY(gnuplot_check());
  TRY(study_open(&c.study, &t.ask));
  status result = queue_open(&c.queue, t.ask.results);
  c.queue.jobs = (int)t.num_jobs;
  c.queue.quiet = t.quiet;
  if (result == OK) result = work(&c, &t);
  if (result == OK) result = judge(&c);
  release(&c);
  return result;
}
