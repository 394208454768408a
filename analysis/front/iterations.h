/* iterations.h - the parts of `sphbench convergence --over iterations`: how the error of one
 * step's solve falls with each solver's iterations. */
#ifndef ITERATIONS_H
#define ITERATIONS_H
#include "orders.h"
#include "study.h"

/* Errors that are asked when they are reached: 1e-1, 1e-2, 1e-3. */
enum { NUM_TARGETS = 3 };
extern const double iteration_targets[NUM_TARGETS];

/* One number of iterations of a solver. NaN: there is none. */
struct iterate {
  int run;                               /* in the queue */
  double residual;                       /* as the solver defines it */
  double velocity_error, pressure_error; /* relative L2 distances from the reference */
  char *reason;                          /* why there are none; NULL: there are */
};

/* A solver's errors over its iterations. */
struct iteration_curve {
  int method, reference; /* reference: in the queue; -1: none */
  struct iterate at[MOST_VALUES];
  double reference_iterations, reference_residual;
  struct order fit; /* of error = C exp(-order k); the rate is exp(-order) */
  char *unfit;      /* why there is no rate; NULL: there is one */
  char *reason;     /* why there is no curve; NULL: there is one */
};

struct iterations {
  struct study study;
  struct queue queue;
  int quiet;
  struct values count; /* numbers of iterations, rising */
  double spacing, dt;  /* [m], [s] */
  double jitter;       /* [dx] */
  long seed;
  struct path folder;
  struct iteration_curve *curve; /* [study.num_methods] */
};

/* The least of the counts from which on the velocity error stays at or below the target; 0: none.
 */
int iterations_to(const struct iterations *it, const struct iteration_curve *curve, double target);

/* `sphbench convergence SCENE --over iterations`; argv is the whole command line. ERR_USER,
 * ERR_RUN: no solver has a curve; ERR_IO, ERR_MEMORY. */
status verb_iterations(int argc, char **argv);

/* iterations_write.c: iterations.json and, unless NULL, `also`; CSV and pictures. ERR_IO, ERR_USER:
 * gnuplot fails. */
status iterations_write(const struct iterations *it, const char *also);
status iterations_draw(const struct iterations *it);

#endif
