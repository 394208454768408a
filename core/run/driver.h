/* driver.h - one run from the command line: resolve, step, sample, write. */
#ifndef DRIVER_H
#define DRIVER_H
#include "../io/run_facts.h"
#include "options.h"
#include "run.h"

/* A scene and its resolved parameters: a built-in benchmark or a scene file. */
struct setting {
  const struct benchmark *benchmark; /* NULL: from a file */
  struct scene_file *file;
  void *self; /* of the benchmark: its parameters and working state */
  struct scene scene;
  unsigned asks;
};

/* The registries of this executable: what is built in. */
extern const struct solver *const solvers[];
extern const struct benchmark *const benchmarks[];
extern const int num_solvers, num_benchmarks;
/* All solvers, those of plug-ins too: behind the others, [solver_count]. */
int solver_count(void);
const struct solver *solver_number(int k);
/* One more, from that file. Errors: ERR_USER when there are too many. */
status solver_add(const struct solver *solver, const char *file);
const struct solver *solver_find(const char *name);
const struct benchmark *benchmark_find(const char *name);
/* The solver of that name. Errors: ERR_USER with the nearest known one; also for NULL. */
status solver_require(const char *name, const struct solver **solver);

/* Everything that was resolved from the options; released by plan_free. */
struct plan {
  const struct solver *solver;
  double *solver_values; /* [solver->num_params] */
  struct setting setting;
  struct fact *parameters; /* as reported [num_parameters] */
  int num_parameters;
  char (*words)[64]; /* behind the facts */
};

/* Resolve scene, solver and parameters, and fill the scene with particles. Errors: ERR_USER with
 * one sentence. A scene of the other dimension is not an error of the user's: *other_dim says which
 * one it wants (else 0). */
status plan_make(const struct options *o, struct plan *plan, int *other_dim);
/* Report the values that the solver has put in place of "auto" when it started. */
void plan_resolve(struct plan *plan, const struct run *run);
void plan_free(struct plan *plan);

/* Samples of metrics over a run, and what each step took. */
struct record {
  long rows, row_room, steps, step_room;
  double *sample[NUM_METRICS + 3]; /* time, metrics, iterations, residual [rows] */
  double *step[3];                 /* time, iterations, residual [steps] */
  long steps_counted, iterations_counted;
  struct measures last;
  struct metrics_start start;
  int has_start;
};
enum { SAMPLE_TIME = NUM_METRICS, SAMPLE_ITERATIONS, SAMPLE_RESIDUAL };
status record_sample(struct record *record, struct run *run, struct setting *setting,
                     struct snapshot *now);
status record_step(struct record *record, const struct run *run);
/* Room for so many samples and steps, which are to be filled in. Errors: ERR_MEMORY, ERR_USER. */
status record_make_room(struct record *record, long rows, long steps);
void record_free(struct record *record);

/* Replace this process by the executable of the other dimension with the same arguments; returns
 * only on failure. */
status switch_dimension(const struct options *o, int dim);

/* The verbs. Each returns a status; the sentence of an error is in status_sentence. */
status verb_run(const struct options *o);
status verb_list(const struct options *o);
status verb_show(const struct options *o);
status verb_speed(const struct options *o);

/* --explain: what the scene needed and what was left out. */
void explain(const struct run *run);
#endif
