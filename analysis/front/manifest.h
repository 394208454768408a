/* manifest.h - the runs of a plan that are still to be done, dealt out in tasks, as a file: another
 * engine (Slurm, GNU parallel) starts the tasks, at once and anywhere, and each does its runs by
 * `sphbench sweep --manifest FILE --task K`. The results and the journal are the sweep's own, so
 * that whoever ran them, a run is found by its id. */
#ifndef MANIFEST_H
#define MANIFEST_H
#include <jansson.h>
#include "runs.h"

/* Deal out the unfinished runs in order: `batch` to a task, or for batch = 0 as many as take a
 * minute together (by their known times), since to start a task costs most of a second. At most
 * MOST_TASKS, which Slurm takes by default. task [queue->n]: from 0, -1 for a finished run. Returns
 * the number of tasks. */
enum { MOST_TASKS = 1000 };
int manifest_deal(const struct queue *queue, long batch, int *task);

/* Write the manifest: runs by their arguments and ids, limits, folders, plug-in. With `fresh` what
 * was finished until now does not count. ERR_IO, ERR_MEMORY. */
struct manifest_settings {
  const char *path, *plan;
  const int *task; /* [queue->n] */
  int tasks, fresh;
};
status manifest_write(const struct manifest_settings *settings, const struct queue *queue);

/* Open a queue of the runs of task `number`, in the folder where the plan was read (which becomes
 * the current one). *manifest holds texts of the queue; to be released by json_decref after it.
 * ERR_USER: no such file or task, or the program is not the one that wrote it; ERR_IO,
 * ERR_MEMORY. */
status manifest_open(const char *path, long number, struct queue *queue, json_t **manifest);

#endif
