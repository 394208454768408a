/* Replays inputs of a fuzzer: `fuzz-NAME FILE|FOLDER...`. A crash is the failure. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fuzz.h"

static void replay_file(const char *path)
{
  const struct fuzz_bytes all = fuzz_read(path);
  fprintf(stderr, "%s\n", path); /* the last one named is the one that crashes */
  /* of just this size, so that a checked build sees what reads beyond it */
  uint8_t *input = realloc(all.data, all.size + (all.size == 0));
  if (input) LLVMFuzzerTestOneInput(input, all.size);
  free(input);
}

static int by_name(const struct dirent *e) { return e->d_name[0] != '.'; }

/* The number of files that were replayed. */
static int replay(const char *path)
{
  struct dirent **entry;
  const int n = scandir(path, &entry, by_name, alphasort);
  if (n < 0) replay_file(path);
  for (int k = 0; k < n; k++) {
    char inside[4096];
    snprintf(inside, sizeof inside, "%s/%s", path, entry[k]->d_name);
    replay_file(inside);
    free(entry[k]);
  }
  if (n >= 0) free(entry);
  return n < 0 ? 1 : n;
}

int main(int argc, char **argv)
{
  int done = 0;
  if (!freopen("/dev/null", "w", stdout)) return 2;
  for (int k = 1; k < argc; k++) done += replay(argv[k]);
  fprintf(stderr, "%d inputs replayed\n", done);
  return done > 0 ? 0 : 2;
}
