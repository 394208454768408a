/* `sphbench stability --extreme`: every run of the plan of extreme cases, and what became of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "figure.h"
#include "json_out.h"
#include "plan.h"
#include "stability.h"

/* What the table says of a run; NaN where it says nothing. */
struct row {
  const struct run *run;
  struct trial judged;
  int has_facts;
  double momentum;   /* largest change over what the fluid has at most; where nothing pulls */
  double energy;     /* the largest, over what there was */
  double density;    /* largest in the run [rho0] */
  double iterations; /* mean per step */
  double most;       /* in a step */
  double leaks;      /* particles outside the domain at the end */
};

/* --- numbers from series --- */

static const json_t *column(const json_t *facts, const char *name)
{
  return json_object_get(json_object_get(facts, "series"), name);
}

static double at(const json_t *column, size_t k)
{
  const json_t *value = json_array_get(column, k);
  return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static double largest(const json_t *column)
{
  double most = -HUGE_VAL;
  for (size_t k = 0; k < json_array_size(column); k++) most = fmax(most, at(column, k));
  return most > -HUGE_VAL ? most : (double)NAN;
}

/* Momentum that came from nowhere, over the most that the fluid had in its parts. */
static double momentum_defect(const json_t *facts)
{
  const json_t *p = column(facts, "linear_momentum");
  const double gravity = fact_number(facts, "parameters.gravity");
  const double dx = fact_number(facts, "parameters.spacing"), n = fact_number(facts, "particles");
  const double rho0 = fact_number(facts, "parameters.rho0"), dim = fact_number(facts, "dim");
  const double mass = n * rho0 * pow(dx, dim);
  const double scale = sqrt(2 * mass * largest(column(facts, "kinetic_energy")));
  double most = 0;
  if (gravity != 0 || fact_number(facts, "walls") > 0) return (double)NAN;
  for (size_t k = 1; k < json_array_size(p); k++) most = fmax(most, fabs(at(p, k) - at(p, 0)));
  return scale > 0 ? most / scale : 0;
}

static void read_facts(struct row *r, const json_t *facts)
{
  r->has_facts = 1;
  r->momentum = momentum_defect(facts);
  r->energy = 1 + fact_number(facts, "energy_growth");
  r->density = 1 + largest(column(facts, "density_error_max"));
  r->iterations = fact_number(facts, "iterations.mean");
  r->most = fact_number(facts, "iterations.max");
  r->leaks = fact_number(facts, "metrics.particles_lost.value");
  facts_judge(facts, 0, &r->judged);
}

static struct row read_row(const struct queue *queue, int number)
{
  const double none = (double)NAN;
  const struct run *run = &queue->run[number];
  struct row r = {run, {.time = none}, 0, none, none, none, none, none, none};
  static const enum verdict ends[NUM_OUTCOMES] = {VERDICT_STABLE, VERDICT_GAVE_UP, VERDICT_UNABLE,
                                                  VERDICT_CRASHED, VERDICT_TIMEOUT};
  r.judged.verdict = r.judged.first = VERDICT_STABLE;
  json_t *facts = run->outcome == OUTCOME_OK || run->outcome == OUTCOME_DIVERGED
                    ? run_facts_json(queue, number)
                    : NULL;
  if (facts)
    read_facts(&r, facts);
  else
    r.judged.verdict = r.judged.first = ends[run->outcome];
  json_decref(facts);
  return r;
}

/* --- the table --- */

static json_t *number_json(double value)
{
  return isfinite(value) ? json_real(value) : json_null();
}

static json_t *row_json(const struct row *r)
{
  const int finished = r->run->outcome == OUTCOME_OK;
  const int finite = r->has_facts && r->judged.verdict != VERDICT_NOT_FINITE;
  json_t *row = json_pack("{s:s, s:s, s:s, s:s, s:s, s:b, s:o}", "scene", r->run->argv[1], "solver",
                          r->run->argv[3], "variant", r->run->name.text, "what", r->run->what,
                          "status", outcome_words[r->run->outcome], "finished", finished, "finite",
                          r->has_facts ? json_boolean(finite) : json_null());
  const struct {
    const char *name;
    double value;
  } numbers[] = {{"momentum_defect", r->momentum}, {"energy_ratio", r->energy},
                 {"density_max", r->density},      {"iterations_mean", r->iterations},
                 {"iterations_max", r->most},      {"leaks", r->leaks},
                 {"failed_at", r->judged.time}};
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
    json_object_set_new(row, numbers[k].name, number_json(numbers[k].value));
  json_object_set_new(
    row, "failed",
    r->judged.first == VERDICT_STABLE ? json_null() : json_string(verdict_words[r->judged.first]));
  json_object_set_new(row, "reason", json_string(r->run->reason ? r->run->reason : ""));
  return row;
}

static void print_number(double value)
{
  if (isfinite(value))
    printf(" %9.3g", value);
  else
    printf(" %9s", "-");
}

static void print_row(const struct row *r, const struct run *before)
{
  const char *slash = strrchr(r->run->argv[1], '/');
  if (!before || strcmp(before->argv[1], r->run->argv[1]) || strcmp(before->what, r->run->what))
    printf("%s %s (%s)\n", slash ? slash + 1 : r->run->argv[1], r->run->what, r->run->name.text);
  printf("  %-14s %-9s %-10s", r->run->argv[3], outcome_words[r->run->outcome],
         r->judged.first == VERDICT_STABLE ? "-" : verdict_words[r->judged.first]);
  if (r->has_facts) {
    const double numbers[] = {r->momentum, r->energy, r->density, r->iterations, r->most, r->leaks};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) print_number(numbers[k]);
  } else {
    printf(" %s", r->run->reason ? r->run->reason : "");
  }
  printf("\n");
}

static void print_table(const struct row *rows, int n)
{
  printf("%-16s %-9s %-10s %9s %9s %9s %9s %9s %9s\n", "", "state", "broke", "momentum", "energy",
         "density", "iter", "iter max", "lost");
  for (int k = 0; k < n; k++) print_row(&rows[k], k ? rows[k - 1].run : NULL);
}

static status write_table(const struct row *rows, int n, const char *results, const char *also)
{
  const struct path own = path_of("%s/stability/extreme.json", results);
  json_t *object = json_pack("{s:o}", "rows", json_array());
  if (!object) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < n; k++)
    json_array_append_new(json_object_get(object, "rows"), row_json(&rows[k]));
  return json_out_finish(object, own.text, also);
}

/* --- the whole --- */

/* Only the runs of the solvers that were asked for. */
static void keep_solvers(struct queue *queue, const char *wanted)
{
  int kept = 0;
  const struct path list = path_of(",%s,", wanted ? wanted : "");
  for (int k = 0; k < queue->n; k++) {
    const struct path name = path_of(",%s,", queue->run[k].argv[3]);
    if (!wanted || strstr(list.text, name.text))
      queue->run[kept++] = queue->run[k];
    else
      run_release(&queue->run[k]);
  }
  queue->n = kept;
}

static int by_case(const void *a, const void *b)
{
  const struct row *x = a, *y = b;
  int order = strcmp(x->run->argv[1], y->run->argv[1]);
  if (!order) order = strcmp(x->run->what, y->run->what);
  return order ? order : strcmp(x->run->argv[3], y->run->argv[3]);
}

static status conclude(const struct extreme_request *r, const struct queue *queue)
{
  struct row *rows = calloc((size_t)queue->n + 1, sizeof *rows);
  int crashed = 0;
  if (!rows) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < queue->n; k++) {
    rows[k] = read_row(queue, k);
    crashed += queue->run[k].outcome == OUTCOME_CRASHED;
  }
  qsort(rows, (size_t)queue->n, sizeof *rows, by_case);
  if (!r->quiet && !(r->json && strcmp(r->json, "-") == 0)) print_table(rows, queue->n);
  const status result = write_table(rows, queue->n, r->results, r->json);
  free(rows);
  if (result != OK) return result;
  return crashed ? status_set(ERR_RUN, "%d of %d runs crashed", crashed, queue->n) : OK;
}

status extreme_run(const struct extreme_request *r)
{
  struct queue queue = {.journal = {.file = -1}};
  struct names solvers = {NULL, 0};
  struct plan *plan;
  const struct path folder = path_of("%s/stability", r->results);
  TRY(plan_read(r->plan, &plan));
  status result = folder_make(folder.text);
  if (result == OK) result = queue_open(&queue, r->results);
  if (result == OK) result = solver_names(&solvers);
  if (result == OK) result = plan_expand(plan, &solvers, &queue);
  if (result == OK) {
    keep_solvers(&queue, r->solvers);
    queue.jobs = r->jobs;
    queue.limit = r->limit;
    queue.quiet = r->quiet;
    for (int k = 0; k < queue.n && r->fresh; k++) queue.run[k].finished = 0;
    result = queue.n ? queue_work(&queue)
                     : user_error("--solvers: no run of the plan is with '%s'", r->solvers);
  }
  if (result == OK) result = conclude(r, &queue);
  names_free(&solvers);
  plan_free(plan);
  queue_close(&queue);
  return result;
}
