/* restart.h - the state of a run between two steps, to a file and back: what goes on from there is,
 * bit for bit, what the undisturbed run would have done. */
#ifndef RESTART_H
#define RESTART_H
#include "../io/shelf.h"
#include "driver.h"

/* From now on the run remembers where its particles were when they were listed; needed before the
 * first step of a run that is to be saved. Errors: ERR_MEMORY. */
status restart_prepare(struct run *run);

/* Save the run to the shelf, or load it into one that was just created from the same scene with
 * the same parameters. Fields are exact; what a solver keeps elsewhere it makes anew in `start` and
 * `changed` (solver.h). Errors: ERR_MEMORY, ERR_USER, ERR_IO; also left in shelf->failed. */
status restart_walk(struct shelf *shelf, struct run *run);

/* A run of the command line: the state, the plan that it belongs to and its record. */
struct checkpoint {
  const char *scene;
  const struct plan *plan;
  struct run *run;
  struct record *record;
  double *next_sample; /* [s] */
};
/* Errors: ERR_USER when the file is of another run; ERR_IO; ERR_MEMORY. */
status checkpoint_save(const char *path, const struct checkpoint *checkpoint);
status checkpoint_load(const char *path, const struct checkpoint *checkpoint);

/* The file that --checkpoint writes: that of -o (else SCENE-SOLVER) with the ending .restart. */
char *checkpoint_path(const struct options *o);
#endif
