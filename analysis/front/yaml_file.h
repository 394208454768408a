/* yaml_file.h - reading a YAML file into a structure by a libcyaml schema, with the user's mistakes
 * told as "FILE:LINE:COLUMN: what". */
#ifndef YAML_FILE_H
#define YAML_FILE_H
#include <cyaml/cyaml.h>
#include "../../core/base/status.h"

/* *data is to be released by yaml_file_free. ERR_IO: the file is missing or a folder; ERR_USER: it
 * is empty, not YAML, or not as the schema wants it. */
status yaml_file_read(const char *path, const cyaml_schema_value_t *schema, void **data);
void yaml_file_free(const cyaml_schema_value_t *schema, void *data);

#endif
