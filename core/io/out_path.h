/* out_path.h - a file that appears under its name only when it is whole: written beside it, renamed
 * at the end. */
#ifndef OUT_PATH_H
#define OUT_PATH_H
#include "../base/status.h"

struct out_path {
  char *name; /* as the user gave it */
  char *temp; /* where to write: NAME.tmp; NULL: NAME is a device or pipe, write to it directly */
};

/* Check that `name` can be written and create its temporary sibling, empty. With allow_stream a
 * device or pipe (/dev/stdout) will do as well as a regular file. ERR_IO with a sentence: the
 * folder is missing or not writable, `name` is a folder or write-protected, another run is writing
 * it; ERR_MEMORY. Nothing is left behind on an error. */
status out_path_begin(struct out_path *out, const char *name, int allow_stream);

/* Give the finished file its name, replacing what was there, and release `out`. */
status out_path_commit(struct out_path *out);

/* Remove the temporary file and release `out`; after commit, or twice, it does nothing. */
void out_path_discard(struct out_path *out);

/* Record "cannot write 'NAME': <text of the system's error number>"; returns ERR_IO. 0: the cause
 * is unknown. */
status out_path_failed(const struct out_path *out, int error);

#endif
