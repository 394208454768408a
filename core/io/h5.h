/* h5.h - the few HDF5 calls that result files need. Failures stick: after the first one every call
 * does nothing useful, and `error` tells at the end what went wrong, so that callers need not look
 * at each result. */
#ifndef H5_H
#define H5_H
#include <hdf5.h>

struct h5 {
  hid_t file;
  int error; /* 0: all went well; the system's error number; H5_UNKNOWN where HDF5 gave none */
};
enum { H5_UNKNOWN = -1 };

/* What every dataset carries. `name` may be a path of existing groups. */
struct h5_label {
  const char *name, *unit, *about;
};

/* Before any other use of HDF5: no messages of its own on stderr, and no clean-up at exit (which
 * crashes in HDF5 1.10 after a full disk). */
void h5_start(void);

/* Keep the first error; returns `result` (an identifier, or negative). */
hid_t h5_check(struct h5 *h, hid_t result);

/* A new group, to be closed by H5Gclose. */
hid_t h5_group(struct h5 *h, hid_t parent, const char *name);

/* Attributes of a group or dataset; a text replaces one that is there. NULL text: nothing is
 * written. */
void h5_attribute_text(struct h5 *h, hid_t object, const char *name, const char *text);
/* An attribute [count] of 64-bit integers (count 0: a scalar), to be closed by H5Aclose. */
hid_t h5_attribute_integers(struct h5 *h, hid_t object, const char *name, int count,
                            const long long *values);

/* A dataset written once. dims [rank]; rank 0 is a scalar; `memory` is the type of `data` and
 * `type` that in the file. Compressed where it has rows enough. */
struct h5_array {
  hid_t type, memory;
  int rank;
  hsize_t dims[2];
  const void *data;
};
void h5_put(struct h5 *h, hid_t parent, struct h5_label label, struct h5_array array);
void h5_put_number(struct h5 *h, hid_t parent, struct h5_label label, double value);
void h5_put_integer(struct h5 *h, hid_t parent, struct h5_label label, long long value);
/* Texts [count]; count 0: a scalar. */
void h5_put_texts(struct h5 *h, hid_t parent, struct h5_label label, int count,
                  const char *const *texts);

/* A dataset [0][width] (width 0: [0]) that grows; `chunk` rows are stored together. To be closed by
 * H5Dclose. Chunks are compressed only where each append fills `whole` ones: a chunk written
 * again must keep its size, or a kill in between leaves it unreadable. */
hid_t h5_column(struct h5 *h, hid_t parent, struct h5_label label, hid_t type, int width,
                long chunk, int whole);
/* Write rows first .. first+rows-1 of a column, growing it to end there. */
void h5_append(struct h5 *h, hid_t column, long long first, long long rows, hid_t memory,
               const void *data);

/* Make `name` in `to` another name of the dataset `path` of the file. */
void h5_link(struct h5 *h, const char *path, hid_t to, const char *name);

#endif
