/* edits.h - a whole HDF5 file, changed through HDF5 itself: what comes out is sound to the library,
 * but need not hold what a reader expects. So what is found is ours and not the library's. */
#ifndef EDITS_H
#define EDITS_H
#include <stddef.h>
#include <stdint.h>

/* Change the file as `data` says, which may be any bytes: each edit is one byte for what is done,
 * one for the object that it is done to, and what else it needs. */
void edits_apply(const char *path, const uint8_t *data, size_t size);

#endif
