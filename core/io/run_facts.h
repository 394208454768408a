/* run_facts.h - everything that is told about one run, once: the result file and --json write the
 * same facts. The runner fills it; nothing here is owned. A NULL text or an empty list is left out
 * of what is written. */
#ifndef RUN_FACTS_H
#define RUN_FACTS_H
#ifdef __cplusplus
extern "C" {
#endif

/* S(name, word in --json, word in the result file) */
#define RUN_STATUS_LIST(S)            \
  S(RUNNING, "running", "running")    \
  S(DONE, "ok", "complete")           \
  S(DIVERGED, "diverged", "diverged") \
  S(CRASHED, "crashed", "crashed")    \
  S(TIMEOUT, "timeout", "timeout")    \
  S(INTERRUPTED, "interrupted", "interrupted")
#define S(name, json, file) RUN_##name,
enum run_status { RUN_STATUS_LIST(S) NUM_RUN_STATUS };
#undef S

/* One number with its name; a word in place of the number where the value is a choice. */
struct fact {
  const char *name, *unit, *about;
  double value;
  const char *word; /* NULL: a number */
};

/* A criterion by which the run means nothing any more, and when it first held. */
struct judged {
  const char *criterion, *unit; /* unit: of value and limit */
  double time, value, limit;    /* [s] */
};

/* Columns of equal length; the first is the time [s] or, per step, whatever the runner puts first.
 */
struct fact_column {
  const char *name, *unit, *about;
  const double *values; /* [rows] */
};
struct fact_table {
  long rows;
  int num_columns;
  const struct fact_column *columns;
};

/* What was installed, built and typed (provenance.h fills it). Only cpu, gpu, threads, date and
 * argv differ between two runs of one build. */
struct provenance {
  const char *commit, *compiler, *flags;
  int dirty;                /* 1: the sources differed from the commit */
  char libraries[8][2][40]; /* name and version */
  int num_libraries;
  char cpu[128], gpu[128]; /* models; "" if unknown or none */
  char date[32];           /* ISO 8601, UTC, of the start */
  int threads;
  int argc;
  const char *const *argv; /* [argc] */
};

enum { MOST_SOLVES = 4 };

struct run_facts {
  const char *scene, *solver, *variant;
  int dim;
  const struct fact *parameters; /* resolved, of scene, solver and run */
  int num_parameters;
  enum run_status status;
  const char *reason;          /* one sentence, NULL when there is nothing to say */
  const char *const *warnings; /* clauses, told before the run started [num_warnings] */
  int num_warnings;
  const struct judged *judged; /* in the order of time */
  int num_judged;
  double energy_growth; /* largest, as it is judged [1]; NaN: not to be told */
  double speed_max;     /* of a particle, at the end of a step [m/s] */
  long steps, particles, walls;
  double period[3]; /* sides of a periodic domain [m], 0 where it is open */
  double time_end;  /* simulated time reached [s] */
  struct {
    double mean; /* per step */
    long max, total;
    struct fact_solve { /* the same of each kind of solve: "pressure", "viscosity", ... */
      const char *name;
      double mean;         /* per step */
      long max, total;     /* max: in a solve */
      long solves, capped; /* capped: they hit their limit */
    } solve[MOST_SOLVES];
    int num_solves;
  } iterations;
  double pairs_visited;       /* neighbour pairs, by all sums over them; 0: not counted */
  double residual_last;       /* relative; NaN where nothing was iterated */
  const struct fact *metrics; /* final values */
  int num_metrics;
  struct fact_table series;   /* samples: time, one column per metric, iterations */
  struct fact_table per_step; /* iterations, residual, ... of every step */
  struct {
    const struct fact *phases; /* [s] */
    int num_phases;
    double total, per_step, per_iteration; /* [s] */
  } timing;
  struct {
    double bytes_per_particle;
    long peak_rss_bytes;       /* of the process */
    const struct fact *fields; /* allocated fields, bytes per particle each */
    int num_fields;
  } memory;
  const struct provenance *provenance;
};

#ifdef __cplusplus
}
#endif
#endif
