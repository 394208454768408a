/* plan.h - a plan: benchmarks/plans/NAME.yaml, the runs of a sweep (docs/sweeps.md). */
#ifndef PLAN_H
#define PLAN_H
#include "../../core/base/yaml_source.h"
#include "runs.h"

/* Runs of one scene: every solver with every combination of the varied parameters. */
struct plan_runs {
  char *scene;
  char **solvers; /* none: all that there are */
  unsigned num_solvers;
  char *dim, *precision, *backend, *dt, *t_end, *spacing, *frames, *seed, *threads; /* or NULL */
  char **set;                                                                       /* KEY=VALUE */
  unsigned num_set;
  struct plan_axis {
    char *name, **values;
    unsigned num_values;
  } * product;
  unsigned num_product;
};

struct plan {
  struct yaml_source *source;
  char *name, *about;
  char *timed; /* how often each run is timed; NULL: it is not */
  struct plan_runs *runs;
  unsigned num_runs;
};

/* Read PATH, or benchmarks/plans/NAME.yaml. ERR_USER with file, line and column; an unknown name is
 * answered with the nearest. */
status plan_read(const char *name, struct plan **plan);
void plan_free(struct plan *plan);

/* Names of the plans in benchmarks/plans. */
struct names plan_names(void);

/* Add all runs to the queue. ERR_USER with the place of an unknown solver; ERR_MEMORY. */
status plan_expand(const struct plan *plan, const struct names *solvers, struct queue *queue);

#endif
