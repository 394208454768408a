#include "out_path.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static status refuse(const char *name, const char *why)
{
  return status_set(ERR_IO, "cannot write '%s': %s", name, why);
}

status out_path_failed(const struct out_path *out, int error)
{
  return refuse(out->name, error ? strerror(error) : "writing failed");
}

/* The sentence for a file that could not be opened: names the missing folder, if that is why. */
static status cannot_open(const char *name, int error)
{
  const char *slash = strrchr(name, '/');
  const int length = slash ? (int)(slash - name) : 0;
  if (error == ENOENT && length)
    return status_set(ERR_IO, "cannot write '%s': there is no folder '%.*s'", name, length, name);
  return refuse(name, strerror(error));
}

static status check_target(const char *name, int allow_stream, int *stream)
{
  struct stat found;
  *stream = 0;
  if (!*name) return user_error("the name of the file to write is empty");
  if (stat(name, &found)) {
    if (errno != ENOENT && errno != ENOTDIR) return cannot_open(name, errno);
    return name[strlen(name) - 1] == '/' ? refuse(name, "it names a folder") : OK;
  }
  if (S_ISDIR(found.st_mode)) return refuse(name, "it is a folder");
  *stream = !S_ISREG(found.st_mode);
  if (*stream && !allow_stream) return refuse(name, "it is not a regular file");
  if (access(name, W_OK)) return refuse(name, strerror(errno));
  return OK;
}

/* Create the temporary file, or take over one that a killed run left; never one that a live run is
 * writing. */
static status create_temp(const struct out_path *out)
{
  const int file = open(out->temp, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file < 0) return cannot_open(out->name, errno);
  const int busy = flock(file, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK;
  if (busy) {
    close(file);
    return refuse(out->name, "another run is writing it");
  }
  const int failed = ftruncate(file, 0);
  const int error = errno;
  close(file);
  if (!failed) return OK;
  unlink(out->temp);
  return out_path_failed(out, error);
}

status out_path_begin(struct out_path *out, const char *name, int allow_stream)
{
  int stream;
  *out = (struct out_path){0};
  TRY(check_target(name, allow_stream, &stream));
  out->name = strdup(name);
  if (!out->name) return status_set(ERR_MEMORY, "out of memory for the name of a file");
  if (stream) return OK;
  if (asprintf(&out->temp, "%s.tmp", name) < 0) out->temp = NULL;
  const status created = out->temp ? create_temp(out) : status_set(ERR_MEMORY, "out of memory");
  if (created == OK) return OK;
  free(out->temp); /* not ours to remove */
  out->temp = NULL;
  out_path_discard(out);
  return created;
}

status out_path_commit(struct out_path *out)
{
  status result = OK;
  if (out->temp && rename(out->temp, out->name)) result = out_path_failed(out, errno);
  if (result == OK) {
    free(out->temp);
    out->temp = NULL;
  }
  out_path_discard(out);
  return result;
}

void out_path_discard(struct out_path *out)
{
  if (out->temp) unlink(out->temp);
  free(out->temp);
  free(out->name);
  *out = (struct out_path){0};
}
