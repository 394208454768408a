#include "files.h"

#include <dirent.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct path path_of(const char *format, ...)
{
  struct path path;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(path.text, sizeof path.text, format, arguments);
  va_end(arguments);
  return path;
}

char *text_make(const char *format, ...)
{
  char *text;
  va_list arguments;
  va_start(arguments, format);
  if (vasprintf(&text, format, arguments) < 0) text = NULL;
  va_end(arguments);
  return text;
}

/* --- folders --- */

int path_is_file(const char *path)
{
  struct stat found;
  return stat(path, &found) == 0 && S_ISREG(found.st_mode);
}

int path_is_folder(const char *path)
{
  struct stat found;
  return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

status folder_make(const char *path)
{
  struct path part = path_of("%s", path);
  for (char *end = part.text + 1;; end++) {
    const char here = *end;
    if (here != '/' && here != '\0') continue;
    *end = '\0';
    if (mkdir(part.text, 0777) && errno != EEXIST)
      return status_set(ERR_IO, "cannot make the folder '%s': %s", part.text, strerror(errno));
    *end = here;
    if (!here) break;
  }
  if (path_is_folder(path)) return OK;
  return status_set(ERR_IO, "cannot make the folder '%s': a file of this name is there", path);
}

static int no_dots(const struct dirent *entry) { return entry->d_name[0] != '.'; }

struct names folder_names(const char *folder)
{
  struct dirent **entries;
  struct names names = {NULL, 0};
  const int n = scandir(folder, &entries, no_dots, alphasort);
  if (n < 0) return names;
  names.name = calloc((size_t)n + 1, sizeof *names.name);
  for (int k = 0; k < n; k++) {
    char *copy = names.name ? strdup(entries[k]->d_name) : NULL;
    if (copy) names.name[names.n++] = copy;
    free(entries[k]);
  }
  free(entries);
  return names;
}

void names_free(struct names *names)
{
  for (int k = 0; k < names->n; k++) free(names->name[k]);
  free(names->name);
  *names = (struct names){NULL, 0};
}

/* --- whole files --- */

static status cannot_read(const char *path, const char *why)
{
  return status_set(ERR_IO, "cannot read '%s': %s", path, why);
}

static status read_open(FILE *file, const char *path, char **text, size_t *size)
{
  size_t room = 1u << 16;
  *size = 0;
  *text = malloc(room + 1);
  while (*text) {
    *size += fread(*text + *size, 1, room - *size, file);
    (*text)[*size] = '\0';
    if (ferror(file)) {
      const int error = errno;
      free(*text);
      return cannot_read(path, strerror(error));
    }
    if (*size < room) return OK;
    room *= 2;
    char *more = realloc(*text, room + 1);
    if (!more) free(*text);
    *text = more;
  }
  return status_set(ERR_MEMORY, "out of memory for '%s'", path);
}

status file_read(const char *path, char **text, size_t *size)
{
  *text = NULL;
  if (path_is_folder(path)) return cannot_read(path, "it is a folder");
  FILE *file = fopen(path, "rb");
  if (!file) return cannot_read(path, strerror(errno));
  const status result = read_open(file, path, text, size);
  fclose(file);
  if (result != OK) *text = NULL;
  return result;
}

status file_begin(struct new_file *file, const char *path)
{
  file->stream = NULL;
  TRY(out_path_begin(&file->out, path, 1));
  file->stream = fopen(file->out.temp ? file->out.temp : path, "w");
  if (file->stream) return OK;
  const status failed = out_path_failed(&file->out, errno);
  out_path_discard(&file->out);
  return failed;
}

/* Do both files hold the same? */
static int same_content(const char *a, const char *b)
{
  unsigned long long hash_a = HASH_START, hash_b = HASH_START;
  struct stat about_a, about_b;
  return stat(a, &about_a) == 0 && stat(b, &about_b) == 0 && about_a.st_size == about_b.st_size &&
         hash_file(&hash_a, a) == OK && hash_file(&hash_b, b) == OK && hash_a == hash_b;
}

time_t folder_newest(const char *folder)
{
  struct names names = folder_names(folder);
  time_t newest = 0;
  for (int k = 0; k < names.n; k++) {
    struct stat about;
    const struct path path = path_of("%s/%s", folder, names.name[k]);
    if (stat(path.text, &about) == 0 && about.st_mtime > newest) newest = about.st_mtime;
  }
  names_free(&names);
  return newest;
}

status file_commit(struct new_file *file)
{
  errno = 0;
  int failed = ferror(file->stream) || fflush(file->stream);
  failed = fclose(file->stream) || failed;
  file->stream = NULL;
  status result = OK;
  if (failed)
    result = out_path_failed(&file->out, errno);
  else if (!file->out.temp || !same_content(file->out.name, file->out.temp))
    result = out_path_commit(&file->out);
  out_path_discard(&file->out);
  return result;
}

void file_discard(struct new_file *file)
{
  if (file->stream) fclose(file->stream);
  file->stream = NULL;
  out_path_discard(&file->out);
}

/* --- hashes --- */

unsigned long long hash_bytes(unsigned long long hash, const void *bytes, size_t size)
{
  for (const unsigned char *byte = bytes; size > 0; size--)
    hash = (hash ^ *byte++) * 1099511628211u;
  return hash;
}

status hash_file(unsigned long long *hash, const char *path)
{
  char *text;
  size_t size;
  TRY(file_read(path, &text, &size));
  *hash = hash_bytes(*hash, text, size);
  free(text);
  return OK;
}

void file_look_beside(char **scene, const char *from)
{
  const char *slash = strrchr(from, '/');
  if (!slash || **scene == '/' || !strchr(*scene, '.') || path_is_file(*scene)) return;
  const struct path near = path_of("%.*s/%s", (int)(slash - from), from, *scene);
  char *found = path_is_file(near.text) ? realpath(near.text, NULL) : NULL;
  if (!found) return; /* the run says what is wrong */
  free(*scene);
  *scene = found;
}
