/* json_out.h - whole JSON objects as files, and numbers that may be none. */
#ifndef JSON_OUT_H
#define JSON_OUT_H
#include <jansson.h>
#include "../../core/base/status.h"

/* A number; null for one that is not finite. */
json_t *json_out_number(double value);

/* Write the object to the file, "-": to standard output; nothing where path is NULL. ERR_IO. */
status json_out_write(const char *path, const json_t *object);

/* Write the object to its own file and to `also`, and release it. NULL: ERR_MEMORY. */
status json_out_finish(json_t *object, const char *own, const char *also);

#endif
