/* yaml_source.h - reading a YAML file by a libcyaml schema, with the place of everything in it, so
 * that each mistake of the user's becomes one sentence with file, line and column. */
#ifndef YAML_SOURCE_H
#define YAML_SOURCE_H
#include <stddef.h>

#include "status.h"
#ifdef __cplusplus
extern "C" {
#endif

struct cyaml_schema_value;
struct yaml_source; /* a document that was read, and where everything in it stands */

/* Read the one document in `path` into *data, as `schema` (a pointer to a mapping; of libcyaml's
 * kinds all but flags and bit fields) says. Refused, each with its place: a file that is missing,
 * empty, a directory, longer than 1 MiB or no YAML; a second document; aliases; more than 32
 * levels; an unknown, repeated or missing key; a value of the wrong kind; a number that is none, or
 * not finite; a list or text of the wrong length. Errors: ERR_USER, ERR_MEMORY; *file and *data are
 * then NULL. */
status yaml_source_read(const char *path, const struct cyaml_schema_value *schema,
                        struct yaml_source **file, void **data);

/* "path:line:column" of the value at `key`, as in "fluid[1].box.low" (lists count from 1), or of
 * the nearest thing around it that exists; returns buf. */
char *yaml_source_place(const struct yaml_source *file, const char *key, char *buf, size_t size);

/* The user's error at that place: "path:line:column: ..." */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
status
yaml_source_refuse(const struct yaml_source *file, const char *key, const char *format, ...);

/* Releases both; NULL is allowed. */
void yaml_source_free(struct yaml_source *file, void *data);

#ifdef __cplusplus
}
#endif
#endif
