/* result_read.h - reading a result file back, for analysis. A file that is foreign, cut off, being
 * written or left by a killed run is answered with ERR_IO and one sentence, and never takes more
 * memory than it can fill. (Where single bytes are damaged, HDF5 1.10 itself may fail: about 1 such
 * file in 500.) */
#ifndef RESULT_READ_H
#define RESULT_READ_H
#include <stddef.h>
#include "../base/status.h"
#ifdef __cplusplus
extern "C" {
#endif

struct result_read;

/* Numbers read: [rows][components], to be released by free(). */
struct result_numbers {
  long rows;
  int components;
  double *values;
};

/* Open a file that result_file_* wrote. ERR_IO: missing, a folder, no HDF5 file, cut off, being
 * written, not from here. */
status result_read_open(struct result_read **file, const char *path);
void result_read_close(struct result_read *file);

/* Number of frames (0: the run has none), and the time of frame k [s]. */
long result_read_frames(const struct result_read *file);
double result_read_time(const struct result_read *file, long k);

/* Quantity `name` ("position", "velocity", "id", ...) of frame k, sorted as it was written (by
 * label). An unknown name is answered with the names that there are. Positions have at least 2
 * components. */
status result_read_array(struct result_read *file, long k, const char *name,
                         struct result_numbers *numbers);

/* A dataset of numbers by its path: "metrics/gamma_mean", "metrics/steps/residual",
 * "walls/position". */
status result_read_series(struct result_read *file, const char *path,
                          struct result_numbers *numbers);

/* A single number: "metrics/final/gamma_mean", "run/parameters/dt", "run/steps". */
status result_read_number(struct result_read *file, const char *path, double *value);

/* A text, cut to `size`: an attribute of /run ("scene", "solver", "status"), or a dataset
 * ("run/parameters/kernel"). */
status result_read_text(struct result_read *file, const char *path, char *text, size_t size);

/* 1 if the file has a dataset or group of this path, else 0. */
int result_read_has(const struct result_read *file, const char *path);

/* The names in a group ("metrics", "particles/fluid"), sorted; calls use(name, self) for each. */
status result_read_names(struct result_read *file, const char *group,
                         void (*use)(const char *name, void *self), void *self);

#ifdef __cplusplus
}
#endif
#endif
