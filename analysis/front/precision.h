/* precision.h - the parts of `sphbench precision`: error against run time of every solver that can
 * run a scene. Errors come from untimed runs, times from runs that do nothing else. */
#ifndef PRECISION_H
#define PRECISION_H
#include "statistics.h"
#include "study.h"
#include "timed.h"

/* The four kinds of error, which are never mixed. K(name, word, meaning) */
#define KIND_LIST(K)                                                                          \
  K(TOTAL, "total", "against the scene's truth")                                              \
  K(SPATIAL, "spatial",                                                                       \
    "against the scene's truth, with a time step and tolerances so small that half the step " \
    "changes it by less than a tenth")                                                        \
  K(TEMPORAL, "temporal",                                                                     \
    "against the same solver and particles with a quarter of the smallest "                   \
    "time step")                                                                              \
  K(ALGEBRAIC, "algebraic", "against the same solver, particles and time step, solved to 1e-10")
#define K(name, word, meaning) KIND_##name,
enum kind { KIND_LIST(K) NUM_KINDS };
#undef K
extern const char *const kind_words[NUM_KINDS], *const kind_meanings[NUM_KINDS];

enum { ARMS = 2 }; /* the same solver under two names */

/* A solver with certain knobs. */
struct point {
  struct knobs knobs;
  int run, reference; /* in the queue; reference -1: none is needed */
  enum kind kind;
  json_t *facts; /* of its untimed run, without the series; NULL: it has none */
  char *reason;  /* why it is not valid, and so has no time; NULL: it is */
  char *note;    /* of a valid point: why it was not timed, what else is to be known; or NULL */
  double error;
  double density_error; /* achieved: its mean over the run */
  double visits;        /* neighbour pairs that sums visited */
  double rough;         /* time of the untimed run [s] */

  struct run timed; /* how it is typed; argc 0: it is not timed */
  double *seconds[ARMS], *setup[ARMS];
  int taken[ARMS];
  struct interval time;
  double setup_median;
  int on_front, on_pairs_front;
};

struct precision {
  struct study study;
  struct queue queue;
  enum kind kind;
  int aa, fresh, quiet;
  long repeat, threads;
  double budget, begun; /* [s]; budget 0: none */
  struct path folder;   /* results/precision/SCENE/KIND */
  struct point *point;
  int n;
  double floor;            /* of the noise, a factor */
  const char *floor_means; /* how it was found */
  double load;             /* of the machine before the times were taken */
  double wall, others;     /* of all timed runs [s]; core seconds of other processes meanwhile */
  struct cores cores;      /* that timed runs stay on */
  json_t *fairness;        /* [{what, same, value}] */
};

/* precision_points.c: the points and their untimed runs, and what became of them. */
status points_make(struct precision *p);
status points_read(struct precision *p);
void points_free(struct precision *p);
/* What a point's error is made of, in words: "dt 0.001, tolerance 0.01". */
struct path point_words(const struct precision *p, const struct point *point);
const char *point_solver(const struct precision *p, const struct point *point);

/* precision_fair.c: points that were not run under the conditions of the others lose their
 * validity; p->fairness says what was compared. */
status points_compare(struct precision *p);

/* precision_times.c: choose what fits the budget, and time it in rounds, there and back. */
status times_take(struct precision *p);

/* precision_json.c: precision.json in p->folder and, unless NULL, `also`. */
status precision_write(const struct precision *p, const char *also);

/* precision_draw.c: which points are on their solver's front. */
void precision_fronts(struct precision *p);
/* Data files, pictures and the names of what was written. */
status precision_draw(struct precision *p);

/* The points that have a time, for the tables [ARMS * p->n]; returns their number. With `spacing` >
 * 0 only those of that spacing, their density errors in place of errors. */
int precision_candidates(const struct precision *p, double spacing, struct candidate *all);
double precision_finest(const struct precision *p);
/* A solver's name, or the second one that it was timed under. */
struct path candidate_name(const struct precision *p, const struct candidate *c);

#define NUM_TARGETS 3
extern const double precision_targets[NUM_TARGETS], precision_density_targets[NUM_TARGETS];

#endif
