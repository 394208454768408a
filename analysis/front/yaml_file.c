#include "yaml_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files.h"

/* libcyaml tells what is wrong as log lines: the fault first, then a backtrace from the inside out
 * with the place of each. */
struct complaint {
  char text[512];
  long line, column; /* 0: not told yet */
};

__attribute__((format(printf, 3, 0))) static void listen(cyaml_log_t level, void *context,
                                                         const char *format, va_list arguments)
{
  struct complaint *c = context;
  char said[512];
  (void)level;
  vsnprintf(said, sizeof said, format, arguments);
  said[strcspn(said, "\n")] = '\0';
  const char *place = strstr(said, "(line: ");
  if (place && c->line == 0) {
    if (sscanf(place, "(line: %ld, column: %ld)", &c->line, &c->column) != 2) c->line = 0;
  } else if (!place && !*c->text) {
    const int skip = strncmp(said, "Load: ", 6) == 0 ? 6 : 0;
    snprintf(c->text, sizeof c->text, "%s", said + skip);
  }
}

/* Is this the key `key` of a mapping, perhaps the first one of a sequence's entry? */
static int is_key(const char *line, const char *key, long *column)
{
  const size_t indent = strspn(line, " -"), length = strlen(key);
  if (strncmp(line + indent, key, length) != 0) return 0;
  *column = (long)indent + 1;
  return line[indent + length + strspn(line + indent + length, " ")] == ':';
}

/* For an unknown key libcyaml gives the place of what stood before it: look on from there. */
static void find_key(const char *text, struct complaint *c)
{
  static const char intro[] = "Unexpected key: ";
  long number = 1, column;
  if (strncmp(c->text, intro, sizeof intro - 1) != 0) return;
  for (const char *line = text; *line; number++) {
    if (number >= c->line && is_key(line, c->text + sizeof intro - 1, &column)) {
      c->line = number;
      c->column = column;
      return;
    }
    line += strcspn(line, "\n");
    line += *line == '\n';
  }
}

/* libyaml's own faults (a bracket that is not closed) come without a place. */
static status tell(const char *path, const char *text, struct complaint *c, cyaml_err_t error)
{
  if (!*c->text) snprintf(c->text, sizeof c->text, "%s", cyaml_strerror(error));
  find_key(text, c);
  if (c->line == 0) return user_error("%s: %s", path, c->text);
  return user_error("%s:%ld:%ld: %s", path, c->line, c->column, c->text);
}

static cyaml_config_t configuration(struct complaint *c)
{
  return (cyaml_config_t){
    .log_fn = listen, .log_ctx = c, .log_level = CYAML_LOG_WARNING, .mem_fn = cyaml_mem};
}

status yaml_file_read(const char *path, const cyaml_schema_value_t *schema, void **data)
{
  struct complaint c = {.line = 0};
  const cyaml_config_t config = configuration(&c);
  char *text;
  size_t size;
  *data = NULL;
  TRY(file_read(path, &text, &size));
  const cyaml_err_t error =
    cyaml_load_data((const uint8_t *)text, size, &config, schema, data, NULL);
  status result = OK;
  if (error != CYAML_OK)
    result = tell(path, text, &c, error);
  else if (!*data)
    result = user_error("%s: the file is empty", path);
  free(text);
  return result;
}

void yaml_file_free(const cyaml_schema_value_t *schema, void *data)
{
  struct complaint unused = {.line = 0};
  const cyaml_config_t config = configuration(&unused);
  cyaml_free(&config, schema, data, 0);
}
