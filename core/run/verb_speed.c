/* `sphbench speed`: microseconds per particle of the neighbour search, of a solver's iteration and
 * of its step, on a settled heap, beside what the machine can do at most. */
#include <jansson.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ceilings.h"
#include "driver.h"
#include "facts.h"
#include "speed_heap.h"

enum { DEFAULT_PARTICLES = 50000, FEW = 2, MANY = 12 };

struct speed_case {
  const char *solver;
  int particles, walls;
  double neighbours_mean, neighbours, iteration, step, bytes_per_particle; /* us per particle */
  double mean_iterations;
  double fraction; /* of the bandwidth ceiling that an iteration's compulsory traffic needs */
  struct equal_case equal;
  char reason[256]; /* why there is no time; "": there is one */
};

static double iterations_per_step(const struct run *run)
{
  long total = 0;
  for (int k = 0; k < run->num_iterations; k++) total += run->iterations[k].last;
  return (double)total;
}

static status time_solver(const struct solver *solver, int particles, double bandwidth,
                          struct speed_case *c)
{
  struct run *run = NULL;
  double few, many, search, unused, few_iterations;
  status result = heap_open(solver, particles, FEW, 0, &run);
  if (result == OK) result = heap_time(run, &few, &search);
  if (result == OK) {
    const double us = 1e6 / run->view->p.n;
    c->solver = solver->name;
    c->particles = run->view->p.n;
    c->walls = run->view->p.n_all - run->view->p.n;
    c->neighbours = us * search;
    c->step = us * few;
    c->bytes_per_particle = run_bytes_per_particle(run);
    double pairs = 0;
    struct snapshot now;
    if (run_snapshot(run, &now) == OK) {
      const struct pairs *list = now.pairs(&now);
      for (int i = 0; list && i < now.n; i++) pairs += list->last[i] - list->first[i] - 1;
      c->neighbours_mean = pairs / now.n;
      snapshot_free(&now);
    }
  }
  few_iterations = run ? iterations_per_step(run) : 0;
  run_free(run);
  run = NULL;
  if (result == OK) result = heap_open(solver, particles, MANY, 0, &run);
  if (result == OK) result = heap_time(run, &many, &unused);
  if (result == OK) {
    c->mean_iterations = few_iterations;
    const double more = iterations_per_step(run) - few_iterations;
    c->iteration = more > 0 ? 1e6 * (many - few) / more / c->particles : (double)NAN;
    /* at the least: the pair list once per sweep over pairs, two sweeps, and ten reals per particle
     */
    const double bytes = 2 * sizeof(int) * (c->neighbours_mean + 1) + 10 * sizeof(real);
    c->fraction = bandwidth > 0 ? bytes / bandwidth / (1e-6 * c->iteration) : (double)NAN;
  }
  run_free(run);
  return result == OK ? heap_at_equal_error(solver, particles, &c->equal) : result;
}

static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static status write_json(const char *path, const struct provenance *p, const struct ceilings *top,
                         const struct speed_case *c, int n)
{
  json_t *cases = json_array();
  for (int k = 0; k < n; k++) {
    json_t *row = json_pack("{s:s, s:s, s:i, s:i}", "case", "heap", "solver", c[k].solver,
                            "particles", c[k].particles, "walls", c[k].walls);
    json_object_set_new(row, "neighbours_mean", number(c[k].neighbours_mean));
    json_object_set_new(row, "neighbours_us_per_particle", number(c[k].neighbours));
    json_object_set_new(row, "iteration_us_per_particle", number(c[k].iteration));
    json_object_set_new(row, "step_us_per_particle", number(c[k].step));
    json_object_set_new(row, "step_iterations", number(c[k].mean_iterations));
    json_object_set_new(row, "bytes_per_particle", number(c[k].bytes_per_particle));
    json_object_set_new(row, "fraction_of_ceiling", number(c[k].fraction));
    json_object_set_new(row, "equal_step_us_per_particle", number(c[k].equal.step));
    json_object_set_new(row, "equal_density_error", number(c[k].equal.error));
    json_object_set_new(row, "equal_tolerance", number(c[k].equal.tolerance));
    json_object_set_new(row, "equal_iterations", number(c[k].equal.iterations));
    if (c[k].reason[0]) json_object_set_new(row, "reason", json_string(c[k].reason));
    json_array_append_new(cases, row);
  }
  json_t *all =
    json_pack("{s:{s:s, s:i, s:s, s:s, s:s, s:s}, s:{s:f, s:f}, s:o}", "machine", "cpu", p->cpu,
              "threads", p->threads, "variant", SPHBENCH_VARIANT, "compiler", p->compiler, "date",
              p->date, "commit", p->commit, "ceilings", "bandwidth_bytes_per_s", top->bandwidth,
              "peak_flops", top->flops, "cases", cases);
  const int failed = strcmp(path, "-") == 0 ? json_dumpf(all, stdout, JSON_INDENT(1))
                                            : json_dump_file(all, path, JSON_INDENT(1));
  json_decref(all);
  return failed ? status_set(ERR_IO, "cannot write '%s'", path) : OK;
}

/* Is the solver in the comma-separated list? NULL: all are. */
static int wanted(const char *list, const char *name)
{
  if (!list) return 1;
  const size_t length = strlen(name);
  for (const char *at = list; (at = strstr(at, name)); at += length)
    if ((at == list || at[-1] == ',') && (at[length] == '\0' || at[length] == ',')) return 1;
  return 0;
}

/* Every word of the list must be known before anything is timed. */
static status check_solvers(const char *list)
{
  while (list) {
    const struct solver *unused;
    char word[64];
    const size_t length = strcspn(list, ",");
    snprintf(word, sizeof word, "%.*s", (int)length, list);
    TRY(solver_require(word, &unused));
    list = list[length] ? list + length + 1 : NULL;
  }
  return OK;
}

static void print_heading(const struct provenance *p, const struct ceilings *top)
{
  printf("%s, %d thread(s), %s\nceilings: %.1f GB/s (triad), %.0f GFLOP/s (multiply-add)\n", p->cpu,
         p->threads, SPHBENCH_VARIANT, 1e-9 * top->bandwidth, 1e-9 * top->flops);
  printf(
    "heap, support %.1f dx; us per particle; a step has %d iterations of each solve where they "
    "can be fixed\n",
    SUPPORT, FEW);
  printf(
    "equal: the step where the mean compression stays below %.1f %%, the iterations it takes, and "
    "that compression\n",
    100 * EQUAL_ERROR);
  printf("%-12s %9s %6s %10s %10s %8s %6s %10s %8s %8s %6s %9s\n", "solver", "particles", "nbrs",
         "neighbours", "iteration", "step", "iters", "B/particle", "ceiling", "equal", "iters",
         "achieved");
}

static void print_case(const struct speed_case *c)
{
  printf("%-12s %9d %6.1f %10.3f %10.3f %8.3f %6.1f %10.1f %8.2f %8.3f %6.1f %9.2g\n", c->solver,
         c->particles, c->neighbours_mean, c->neighbours, c->iteration, c->step, c->mean_iterations,
         c->bytes_per_particle, c->fraction, c->equal.step, c->equal.iterations, c->equal.error);
  if (c->reason[0]) printf("  %s\n", c->reason);
  fflush(stdout);
}

status verb_speed(const struct options *o)
{
  long threads, particles;
  TRY(option_whole("--threads", o->threads, 1, 1024, 1, &threads));
  TRY(option_whole("--particles", o->particles, 100, 100000000, DEFAULT_PARTICLES, &particles));
  TRY(check_solvers(o->solvers));
  omp_set_num_threads((int)threads);
  struct provenance p;
  provenance_fill(&p, (int)threads, o->argc, (const char *const *)o->argv);
  const struct ceilings top = ceilings_measure();
  const int say = !o->quiet && !(o->json && strcmp(o->json, "-") == 0);
  if (say) print_heading(&p, &top);
  struct speed_case cases[64];
  int n = 0;
  for (int k = 0; k < solver_count() && n < 64; k++) {
    const struct solver *solver = solver_number(k);
    if (!wanted(o->solvers, solver->name)) continue;
    memset(&cases[n], 0, sizeof cases[n]);
    cases[n].solver = solver->name;
    cases[n].iteration = cases[n].fraction = cases[n].step = (double)NAN;
    cases[n].equal = (struct equal_case){(double)NAN, (double)NAN, (double)NAN, (double)NAN};
    const status result = time_solver(solver, (int)particles, top.bandwidth, &cases[n]);
    if (result == ERR_RUN) /* a result: shown as a gap */
      snprintf(cases[n].reason, sizeof cases[n].reason, "%s", status_sentence());
    else if (result != OK)
      return result;
    if (say) print_case(&cases[n]);
    n++;
  }
  return o->json ? write_json(o->json, &p, &top, cases, n) : OK;
}
