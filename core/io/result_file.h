/* result_file.h - one run in one file.
 *
 *   /VTKHDF     VTKHDF 2.0 PolyData over time, a vertex per particle (VTK >= 9.3, ParaView >= 5.12)
 *   /particles  fluid/{position, velocity, ..., time, count, first}: the same data, other names
 *   /walls      {position, ...}, once
 *   /virtual    <frame>/{position, ...}: the second set of a method that has one
 *   /metrics    {time, <metric>...}: samples;  steps/{...}: every step;  final/<metric>
 *   /run        scene, solver, variant, status, reason; parameters, provenance, memory;
 *               volatile/: all that differs between two identical runs, and nothing else
 *
 * Every dataset has the attributes `unit` and `description`. Everything is written to NAME.tmp and
 * flushed frame by frame (a killed run leaves NAME.tmp, readable, status "running"); it gets its
 * name in result_file_finish. Errors: ERR_IO with one sentence (full disk, no folder, ...), after
 * which NAME.tmp is gone, NAME is untouched, and every further call returns the same error. */
#ifndef RESULT_FILE_H
#define RESULT_FILE_H
#include "../base/status.h"
#include "run_facts.h"
#ifdef __cplusplus
extern "C" {
#endif

struct result_file; /* holds HDF5 handles that its users need not know of */

/* One quantity of a set of particles, host memory. */
enum result_type { RESULT_FLOAT, RESULT_DOUBLE, RESULT_INT };
struct result_array {
  const char *name, *unit, *about;
  int components; /* 1; or 2, 3 for a vector, written with 3 (z = 0), as VTK wants it */
  enum result_type type;
  const void *data; /* [n][components] */
};

/* Particles of one kind. The first array is "position". */
struct result_set {
  long n;
  const int *order; /* [n]: row k of the file is data[order[k]]; NULL: as they stand */
  int num_arrays;
  const struct result_array *arrays;
};

/* Open `path` and write what is known before the first step (scene, solver, variant, parameters,
 * provenance). Also ERR_MEMORY. `path` must be a regular file or not exist; see out_path_begin. */
status result_file_open(struct result_file **file, const char *path, const struct run_facts *facts);

/* Append a frame. `numbers` are quantities of the whole frame ("step", "iterations",
 * "total_energy"). Names, units and types are those of the first frame in every frame; n may
 * change. (VTK >= 9.4 misreads a frame that follows an empty one; h5py and result_read do not.) */
status result_file_add_frame(struct result_file *file, double time, const struct result_set *fluid,
                             int num_numbers, const struct fact *numbers);

/* Wall particles, once, into /walls. */
status result_file_add_walls(struct result_file *file, const struct result_set *walls);

/* The second set of particles of a method that has one, for the last frame, into /virtual/<frame>.
 */
status result_file_add_virtual(struct result_file *file, const struct result_set *set);

/* Append the rows of facts->series and facts->per_step that are not in the file yet. Call it with a
 * frame so that a killed run leaves them too; result_file_finish calls it. */
status result_file_add_series(struct result_file *file, const struct run_facts *facts);

/* Write what is known at the end (status, reason, metrics, timing, memory), close, give the file
 * its name, release. */
status result_file_finish(struct result_file *file, const struct run_facts *facts);

/* Close and remove the unfinished file, release. NULL: nothing. */
void result_file_discard(struct result_file *file);

#ifdef __cplusplus
}
#endif
#endif
