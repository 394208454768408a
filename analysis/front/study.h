/* study.h - a scene with a known truth, the solvers that can run it, and how a run of one of them
 * with certain knobs is typed: what `precision` and `convergence` have in common. */
#ifndef STUDY_H
#define STUDY_H
#include <jansson.h>
#include <math.h>
#include "runs.h"

enum { MOST_VALUES = 16, MOST_TOLERANCES = 4, MOST_METHODS = 64, MOST_SETS = 24 };

struct values {
  double value[MOST_VALUES];
  int n;
};

/* What is varied. spacing in m; dt as a factor on the scene's own time step, which goes with the
 * spacing; tolerance as a factor on each solver's own. */
struct sweep_plan {
  double t_end; /* [s]; 0: the scene's own */
  struct values spacing, dt, tolerance;
};

/* A solver. */
struct method {
  char *name;
  int colour; /* as in every figure */
  struct tolerance {
    char *name;
    double initial, low, high;
  } tolerance[MOST_TOLERANCES]; /* its parameters of that meaning */
  int num_tolerances;
  double max_iterations; /* its default; 0: it has none */
  int has_fixed;         /* has fixed_iterations */
  char *refusal;         /* why it cannot run the scene; NULL: it can */
};

/* The knobs of one run. */
struct knobs {
  int method;
  double spacing, dt; /* [m], [s]; dt 0: the scene's own */
  double factor;      /* on the tolerances; 0: solved as far as it goes (1e-10) */
  double jitter;      /* [dx]; 0: the scene's own */
  long seed;          /* 0: the scene's own */
  int iterations;     /* so many exactly; 0: as the tolerances say */
};

struct study_request {
  const char *verb, *scene, *results;
  const char *solvers; /* "A,B"; NULL: all */
  const char *error;   /* a metric in place of the scene's main one */
  const char *dim, *precision, *backend;
  int quick, needs_no_truth;
  char *set[MOST_SETS];
  int num_sets;
};

struct study {
  struct study_request ask;
  struct yaml_source *source; /* benchmarks/precision/SCENE.yaml */
  struct study_file *file;    /* its content; NULL: there is none */
  json_t *scene;              /* as `show` tells it */
  const char *error;          /* the metric that is the error against the truth */
  json_t *metrics;            /* as `list metrics` tells them */
  double spacing, dt, t_end;  /* the scene's own */
  int is_projection;          /* no time passes: dt and t_end do nothing */
  struct sweep_plan plan;     /* for precision */
  struct values levels;       /* spacings for convergence */
  double jitter;              /* of disturbed starts [dx] */
  struct method method[MOST_METHODS];
  int num_methods;
};

/* Learn about scene and solvers from the variant. ERR_USER: unknown names, a scene without a truth,
 * no solver that can run it; ERR_IO. */
status study_open(struct study *study, const struct study_request *ask);
void study_close(struct study *study);

/* What study->error is, in words; which truth it is against, too. */
const char *study_error_about(const struct study *study);

/* The time step of a factor at a spacing, so that t_end is a whole number of steps [s]; 0 for
 * projections. */
double study_dt(const struct study *study, double factor, double spacing);

/* Has the method a knob for how far it iterates? */
int method_iterates(const struct method *method);

/* Add an untimed run that is looked at: with pair counts and a frame of its end. */
status study_add(const struct study *study, const struct knobs *knobs, struct queue *queue,
                 int *number);
/* The same run as it is timed: without frames, samples and counts. To be released by run_release.
 */
status study_timed(const struct study *study, const struct knobs *knobs, struct run *run);

/* --- reading what came of a run --- */

/* A number of a run's facts, by keys with dots ("metrics.front_error.value"); NaN: none. */
double fact_number(const json_t *facts, const char *keys);

/* Why a run is no result (to be released by free()); NULL: it is one. *facts is to be released. */
char *study_failure(const struct queue *queue, int run, json_t **facts);

/* Relative distance of two runs of the same particles at their end, by label: |a - b| / |b - start|
 * over an array of the result file, "position" (the nearest images, where the domain is periodic),
 * "velocity" or "pressure". ERR_IO. */
status study_distance(const struct queue *queue, int run, int other, const char *array,
                      double *distance);

/* The array in which the scene moves something: of a projection the velocity. */
const char *study_array(const struct study *study);

/* "1,2,3" as numbers > 0; what was there is kept where text is NULL. ERR_USER with the flag. */
status values_parse(const char *flag, const char *text, struct values *values);
status value_parse(const char *flag, const char *text, double *value);

#endif
