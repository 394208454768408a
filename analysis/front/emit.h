/* emit.h - `sweep PLAN --emit ENGINE DIR`: the runs for an engine that starts many jobs. */
#ifndef EMIT_H
#define EMIT_H
#include "runs.h"

struct emit {
  const char *engine; /* "slurm" or "parallel" */
  const char *folder, *plan;
  long batch; /* runs to a task; 0: as many as take a minute */
  long jobs;  /* tasks at once; 0: the engine's own choice */
  int fresh;
};

/* Is the engine known? ERR_USER. */
status emit_check(const char *engine);

/* Write FOLDER/manifest.json and the engine's script FOLDER/job.sh, and say how to start it.
 * ERR_USER: every run is finished; ERR_IO, ERR_MEMORY. */
status emit_write(const struct emit *emit, const struct queue *queue);

#endif
