#include "json_out.h"

#include <math.h>
#include <string.h>

#include "files.h"

json_t *json_out_number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

status json_out_write(const char *path, const json_t *object)
{
  struct new_file file;
  if (!path) return OK;
  if (strcmp(path, "-") == 0) {
    json_dumpf(object, stdout, JSON_INDENT(1));
    return puts("") < 0 ? status_set(ERR_IO, "cannot write to standard output") : OK;
  }
  TRY(file_begin(&file, path));
  json_dumpf(object, file.stream, JSON_INDENT(1));
  fputc('\n', file.stream);
  return file_commit(&file);
}

status json_out_finish(json_t *object, const char *own, const char *also)
{
  if (!object) return status_set(ERR_MEMORY, "out of memory for '%s'", own);
  status result = json_out_write(own, object);
  if (result == OK) result = json_out_write(also, object);
  json_decref(object);
  return result;
}
