/* convergence.h - the parts of `sphbench convergence`: observed orders over spacing or time step.
 */
#ifndef CONVERGENCE_H
#define CONVERGENCE_H
#include "orders.h"
#include "study.h"

/* One run. */
struct trial {
  struct knobs knobs;
  int level, start;   /* numbers; start 0: the first seed, or the lattice */
  int run, reference; /* in the queue; -1: none */
  char *reason;       /* why it is not valid; NULL: it is */
  double error;
};

/* A solver's errors and order. */
struct curve {
  int method;
  struct level level[MOST_VALUES];
  char *reason[MOST_VALUES]; /* why a level has no error; NULL: it has one */
  double local[MOST_VALUES]; /* order between level k - 1 and k; NaN for k = 0 */
  struct order fit;
  char *unfit;         /* why there is no order; NULL: there is one */
  double dt_influence; /* part of the error that half the time step changes, NaN: not asked */
};

struct convergence {
  struct study study;
  struct queue queue;
  int over_dt, quiet;
  long seeds;         /* starts of each level */
  double jitter;      /* [dx]; 0: the lattice alone */
  struct values h;    /* spacings [m], or time steps [s], from the largest */
  double h_reference; /* time step of the reference [s]; 0: the truth */
  const char *kind;   /* "temporal", "spatial", "total" */
  struct path folder;
  struct trial *trial;
  int n;
  struct curve *curve;
  int num_curves;
};

/* convergence_write.c: convergence.json and, unless NULL, `also`; data and pictures. */
status convergence_write(const struct convergence *c, const char *also);
status convergence_draw(const struct convergence *c);

#endif
