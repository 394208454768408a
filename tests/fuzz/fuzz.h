/* fuzz.h - what the fuzzers share. Each defines fuzz_one; libFuzzer or replay.c calls it through
 * LLVMFuzzerTestOneInput with one input after the other. */
#ifndef FUZZ_H
#define FUZZ_H
#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A folder of this process, in memory where the system has /dev/shm; removed at its end. */
const char *fuzz_folder(void);

/* Write FOLDER/name; its path is valid until the next call with the same name (of 8 at most). The
 * name may hold a folder, which is made. Ends the process where it cannot be written. */
const char *fuzz_file(const char *name, const void *data, size_t size);

/* All of a file, to be kept or released by free(). Ends the process where it cannot be read. */
struct fuzz_bytes {
  uint8_t *data;
  size_t size;
};
struct fuzz_bytes fuzz_read(const char *path);

#endif
