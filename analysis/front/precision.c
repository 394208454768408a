/* `sphbench precision`: error against run time. */
#include "precision.h"

#include <stdlib.h>
#include <string.h>

#include "../../core/base/clock.h"
#include "arguments.h"
#include "figure.h"
#include "front.h"

struct typed {
  struct study_request ask;
  const char *json, *jobs, *repeat, *threads, *timeout, *budget, *kind, *t_end, *unused;
  const char *spacings, *dts, *tolerances;
  int aa, fresh, quiet;
};

static status parse(struct typed *t, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--solvers", &t->ask.solvers, NULL}, {"--results", &t->ask.results, NULL},
    {"--dim", &t->ask.dim, NULL},         {"--precision", &t->ask.precision, NULL},
    {"--backend", &t->ask.backend, NULL}, {"--t-end", &t->t_end, NULL},
    {"--set", &t->unused, NULL},          {"--spacings", &t->spacings, NULL},
    {"--dt-factors", &t->dts, NULL},      {"--tolerance-factors", &t->tolerances, NULL},
    {"--kind", &t->kind, NULL},           {"--error", &t->ask.error, NULL},
    {"--repeat", &t->repeat, NULL},       {"--threads", &t->threads, NULL},
    {"--timeout", &t->timeout, NULL},     {"--budget", &t->budget, NULL},
    {"--jobs", &t->jobs, NULL},           {"--json", &t->json, NULL},
    {"--quick", NULL, &t->ask.quick},     {"--aa", NULL, &t->aa},
    {"--fresh", NULL, &t->fresh},         {"--quiet", NULL, &t->quiet},
  };
  const struct arguments what = {"precision",   flags, sizeof flags / sizeof *flags,
                                 &t->ask.scene, 1,     NULL};
  *t = (struct typed){.ask = {.verb = "precision", .results = "results"}};
  TRY(arguments_parse(&what, argc, argv));
  return arguments_sets(argc, argv, t->ask.set, MOST_SETS, &t->ask.num_sets);
}

static status choose_kind(const char *word, enum kind *kind)
{
  *kind = KIND_TOTAL;
  for (int k = 0; word && k < NUM_KINDS; k++)
    if (strcmp(word, kind_words[k]) == 0) {
      *kind = (enum kind)k;
      return OK;
    }
  return word ? user_error("--kind: '%s' found, allowed is total, spatial, temporal or algebraic",
                           word)
              : OK;
}

/* Numbers that need no scene to be checked. */
static status take_numbers(struct typed *t, struct precision *p, double *timeout, long *jobs)
{
  const double quick_budget = 780; /* s: with what is not counted, 15 min on two cores */
  p->repeat = t->ask.quick ? 6 : 10;
  p->threads = 1;
  p->budget = t->ask.quick ? quick_budget : 0;
  p->aa = t->aa;
  p->fresh = t->fresh;
  p->quiet = t->quiet;
  *timeout = 0;
  *jobs = processors();
  TRY(choose_kind(t->kind, &p->kind));
  TRY(argument_whole("--repeat", t->repeat, 5, 250, &p->repeat));
  TRY(argument_whole("--threads", t->threads, 1, 1024, &p->threads));
  TRY(argument_whole("--jobs", t->jobs, 1, 256, jobs));
  TRY(value_parse("--timeout", t->timeout, timeout));
  return value_parse("--budget", t->budget, &p->budget);
}

static status take_sweep(const struct typed *t, struct sweep_plan *plan)
{
  TRY(values_parse("--spacings", t->spacings, &plan->spacing));
  TRY(values_parse("--dt-factors", t->dts, &plan->dt));
  TRY(values_parse("--tolerance-factors", t->tolerances, &plan->tolerance));
  return value_parse("--t-end", t->t_end, &plan->t_end);
}

/* A limit for each untimed run, such that all of them fit into less than half the budget even if
 * every one reaches it. */
static double limit_of(const struct precision *p, double timeout)
{
  const double part = 0.45, shortest = 2, longest = 600;
  const struct sweep_plan *plan = &p->study.plan;
  const int runs = p->study.num_methods * plan->spacing.n * plan->dt.n * plan->tolerance.n;
  if (timeout > 0) return timeout;
  if (!(p->budget > 0)) return longest;
  return fmin(fmax(part * p->budget * p->queue.jobs / runs, shortest), longest);
}

/* --- what to say --- */

static void say_counts(const struct precision *p)
{
  int valid = 0, timed = 0;
  for (int k = 0; k < p->n; k++) {
    valid += !p->point[k].reason;
    timed += isfinite(p->point[k].time.median);
  }
  printf("%s, %s error: %d points, %d valid, %d timed; differences below %.3g times are noise "
         "(%s)\n",
         p->study.ask.scene, kind_words[p->kind], p->n, valid, timed, p->floor, p->floor_means);
  if (p->load > 0.5)
    printf("the machine was busy before (load %.2f): times are worth little\n", p->load);
  if (p->others > 0.5 * p->wall)
    printf("others kept %.2g cores busy meanwhile: times are worth little\n", p->others / p->wall);
  for (int k = 0; k < p->study.num_methods; k++)
    if (p->study.method[k].refusal) printf("  not run: %s\n", p->study.method[k].refusal);
}

/* The same words, whatever the numbers among them are. */
static int same_words(const char *a, const char *b)
{
  static const char numbers[] = "0123456789.+-";
  for (;; a++, b++) {
    a += strspn(a, numbers);
    b += strspn(b, numbers);
    if (*a != *b || !*a) return *a == *b;
  }
}

static int fails_alike(const struct point *a, const struct point *b)
{
  return a->knobs.method == b->knobs.method && a->reason && b->reason &&
         same_words(a->reason, b->reason);
}

/* A line for each solver and reason. */
static void say_failures(const struct precision *p)
{
  for (int k = 0; k < p->n; k++) {
    const struct point *point = &p->point[k];
    int before = 0, more = 0;
    for (int i = 0; i < p->n && point->reason; i++) {
      before += i < k && fails_alike(&p->point[i], point);
      more += i > k && fails_alike(&p->point[i], point);
    }
    if (!point->reason || before) continue;
    printf("  failed: %s (%s%s", point_solver(p, point), point_words(p, point).text,
           more ? "" : ")");
    if (more) printf(", and %d more)", more);
    printf(": %s\n", point->reason);
  }
}

static void say_line(const struct precision *p, const struct candidate *best, int n)
{
  for (int k = 0; k < n; k++) {
    const struct path name = candidate_name(p, &best[k]);
    const double slower = k ? slower_by(&best[0], &best[k], p->floor) : 0;
    if (k == 0)
      printf(" %s %.3g s [%.3g, %.3g] (%s)", name.text, best[k].time, best[k].low, best[k].high,
             point_words(p, &p->point[best[k].point]).text);
    else if (slower > 0)
      printf(", %s %.3gx", name.text, slower);
    else
      printf(", %s no slower", name.text);
  }
  printf(n ? "\n" : " no solver gets there\n");
}

static void say_table(const struct precision *p, double spacing, const double *targets)
{
  struct candidate *all = calloc((size_t)(ARMS * p->n) + 1, sizeof *all);
  struct candidate *best = calloc((size_t)(ARMS * p->n) + 1, sizeof *best);
  for (int t = 0; all && best && t < NUM_TARGETS; t++) {
    const int found = precision_candidates(p, spacing, all);
    printf(spacing > 0 ? "  density error <= %g %% (dx %.3g):" : "  error <= %g %%:",
           100 * targets[t], spacing);
    say_line(p, best, rank_cheapest(all, found, targets[t], best));
  }
  free(all);
  free(best);
}

static void say(const struct precision *p)
{
  if (p->quiet) return;
  say_counts(p);
  say_failures(p);
  say_table(p, 0, precision_targets);
  if (p->kind == KIND_TOTAL && !p->study.is_projection)
    say_table(p, precision_finest(p), precision_density_targets);
}

/* --- the whole --- */

static status work(struct precision *p, const struct typed *t, double timeout)
{
  TRY(take_sweep(t, &p->study.plan));
  p->folder = path_of("%s/precision/%s/%s", t->ask.results, t->ask.scene, kind_words[p->kind]);
  if (p->aa) p->folder = path_of("%s-aa", p->folder.text);
  TRY(folder_make(p->folder.text));
  p->queue.limit = limit_of(p, timeout);
  TRY(points_make(p));
  TRY(queue_work(&p->queue));
  TRY(points_read(p));
  TRY(points_compare(p));
  TRY(times_take(p));
  precision_fronts(p);
  if (!(t->json && strcmp(t->json, "-") == 0)) say(p);
  p->quiet |= t->json && strcmp(t->json, "-") == 0;
  TRY(precision_write(p, t->json));
  return precision_draw(p);
}

/* No valid point: nothing was learnt but why. */
static status judge(const struct precision *p)
{
  for (int k = 0; k < p->n; k++)
    if (!p->point[k].reason) return OK;
  return status_set(ERR_RUN, "precision: none of %d runs is valid, the first one %s", p->n,
                    p->point[0].reason);
}

status verb_precision(int argc, char **argv)
{
  static struct precision p; /* large, and there is one */
  struct typed t;
  double timeout;
  long jobs;
  p = (struct precision){.floor = 1, .begun = clock_now(), .queue = {.journal = {.file = -1}}};
  TRY(parse(&t, argc, argv));
  TRY(take_numbers(&t, &p, &timeout, &jobs));
  TRY(gnuplot_check());
  TRY(study_open(&p.study, &t.ask));
  status result = queue_open(&p.queue, t.ask.results);
  p.queue.jobs = (int)jobs;
  p.queue.quiet = t.quiet;
  if (result == OK) result = work(&p, &t, timeout);
  if (result == OK) result = judge(&p);
  points_free(&p);
  json_decref(p.fairness);
  study_close(&p.study);
  queue_close(&p.queue);
  return result;
}
