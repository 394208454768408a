/* estimate.h - what a run is going to take, before it is run. */
#ifndef ESTIMATE_H
#define ESTIMATE_H
#include "runs.h"

struct estimate {
  double seconds, mebibytes; /* 0: finished, or refused */
  int measured;              /* 1: the time is that of the same run before */
  char *refusal;             /* why the program will not run it; NULL: it will. To be freed */
};

/* Of each run of the queue that is not finished, into all [queue->n]: particles and steps as the
 * program itself resolves them (`run --dry-run`), times the time per particle and step, and with
 * the memory per particle, of the largest finished run of the same solver in the journal (of those
 * that are large enough to tell), else of any solver, else 5 us and 1 kB. ERR_MEMORY. */
status estimates_make(const struct queue *queue, struct estimate *all);

#endif
