/* files.h - paths, folders and whole files. Sentences of errors name the file. */
#ifndef FILES_H
#define FILES_H
#include <stddef.h>
#include <stdio.h>
#include <time.h>
#include "../../core/base/status.h"
#include "../../core/io/out_path.h"

/* A path; one that does not fit is cut, and then names no file. */
struct path {
  char text[4096];
};
__attribute__((format(printf, 1, 2))) struct path path_of(const char *format, ...);

int path_is_file(const char *path);
int path_is_folder(const char *path);

/* Make a folder and those above it. ERR_IO. */
status folder_make(const char *path);

/* Names in a folder, sorted, to be released by names_free; none where the folder cannot be read. */
struct names {
  char **name;
  int n;
};
struct names folder_names(const char *folder);
void names_free(struct names *names);

/* The whole file with a '\0' behind it, to be released by free(). ERR_IO, ERR_MEMORY. */
status file_read(const char *path, char **text, size_t *size);

/* When the last of a folder's files was changed; 0 where there is none. */
time_t folder_newest(const char *folder);

/* A file that appears under its name only when it is whole, and stays untouched where it holds the
 * same already. Writing errors stick to `stream`; file_commit tells of them. ERR_IO. */
struct new_file {
  struct out_path out;
  FILE *stream;
};
status file_begin(struct new_file *file, const char *path);
status file_commit(struct new_file *file);
void file_discard(struct new_file *file);

/* FNV-1a, 64 bits (Fowler, Noll, Vo; RFC 9923): continue `hash` over some bytes. */
enum { HASH_TEXT = 17 };
#define HASH_START 14695981039346656037u
unsigned long long hash_bytes(unsigned long long hash, const void *bytes, size_t size);
/* Over a file's content; ERR_IO. */
status hash_file(unsigned long long *hash, const char *path);

/* A copy of a text, or of a formatted one; NULL: no memory left. */
__attribute__((format(printf, 1, 2))) char *text_make(const char *format, ...);

/* A scene file that a plan or recipe names is looked for from here, then from the folder of `from`,
 * the file that names it: *scene, of malloc, becomes its whole path where it is found there. */
void file_look_beside(char **scene, const char *from);

#endif
