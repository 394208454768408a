#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "fuzz.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_FILES = 8, ROOM = 128 };

static char folder[64];

static int remove_one(const char *path, const struct stat *about, int type, struct FTW *where)
{
  (void)about;
  (void)type;
  (void)where;
  return remove(path);
}

static void remove_folder(void) { nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS); }

static void give_up(const char *what)
{
  perror(what);
  _exit(1);
}

const char *fuzz_folder(void)
{
  if (*folder) return folder;
  const char *in = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
  snprintf(folder, sizeof folder, "%s/sphbench-fuzz-XXXXXX", in);
  if (!mkdtemp(folder)) give_up(folder);
  atexit(remove_folder);
  return folder;
}

/* The path of this name, the same text for the same name. */
static const char *path_of_name(const char *name)
{
  static char paths[MOST_FILES][ROOM];
  char path[ROOM];
  int k = 0;
  snprintf(path, sizeof path, "%s/%s", fuzz_folder(), name);
  while (k < MOST_FILES - 1 && *paths[k] && strcmp(paths[k], path) != 0) k++;
  if (!*paths[k] && strchr(name, '/')) {
    char *slash = strrchr(path, '/');
    *slash = 0;
    mkdir(path, 0700);
    *slash = '/';
  }
  memcpy(paths[k], path, sizeof path);
  return paths[k];
}

const char *fuzz_file(const char *name, const void *data, size_t size)
{
  const char *path = path_of_name(name);
  FILE *file = fopen(path, "wb");
  if (!file || fwrite(data, 1, size, file) != size || fclose(file)) give_up(path);
  return path;
}

struct fuzz_bytes fuzz_read(const char *path)
{
  struct fuzz_bytes bytes = {NULL, 0};
  struct stat about;
  FILE *file = fopen(path, "rb");
  if (!file || fstat(fileno(file), &about)) give_up(path);
  bytes.size = (size_t)about.st_size;
  bytes.data = malloc(bytes.size + 1);
  if (!bytes.data || fread(bytes.data, 1, bytes.size, file) != bytes.size) give_up(path);
  fclose(file);
  return bytes;
}
