#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "yaml_source.h"

#include <cyaml/cyaml.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <yaml.h>

enum { MOST_BYTES = 1 << 20, MOST_LEVELS = 32, MOST_KEYS = 64, PATH_ROOM = 256 };

struct yaml_source {
  char *path;
  const cyaml_schema_value_t *schema;
  unsigned char *text;
  size_t length;
  yaml_document_t document;
  int has_document;
};

static status refuse_at(const struct yaml_source *f, yaml_mark_t mark, const char *format, ...)
  __attribute__((format(printf, 3, 4)));

static status refuse_at(const struct yaml_source *f, yaml_mark_t mark, const char *format, ...)
{
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return user_error("%s:%zu:%zu: %s", f->path, mark.line + 1, mark.column + 1, text);
}

/* --- the file's text --- */

static status read_text(struct yaml_source *f)
{
  struct stat about;
  if (stat(f->path, &about)) return user_error("%s: %s", f->path, strerror(errno));
  if (S_ISDIR(about.st_mode)) return user_error("%s is a directory, expected a YAML file", f->path);
  FILE *file = fopen(f->path, "rb");
  if (!file) return user_error("%s: %s", f->path, strerror(errno));
  f->text = malloc(MOST_BYTES + 1);
  if (f->text) f->length = fread(f->text, 1, MOST_BYTES + 1, file);
  const int failed = ferror(file), number = errno;
  fclose(file);
  if (!f->text) return status_set(ERR_MEMORY, "no memory to read %s", f->path);
  if (failed) return user_error("%s: %s", f->path, strerror(number));
  if (f->length > MOST_BYTES)
    return user_error("%s is longer than 1 MiB, too long for a file that people write", f->path);
  return OK;
}

/* --- first pass: is it one document of YAML, without aliases, of sane depth? --- */

static yaml_mark_t mark_of_offset(const struct yaml_source *f, size_t offset)
{
  yaml_mark_t mark = {offset, 0, 0};
  for (size_t k = 0; k < offset && k < f->length; k++) {
    mark.column = f->text[k] == '\n' ? 0 : mark.column + 1;
    mark.line += f->text[k] == '\n';
  }
  return mark;
}

static status syntax_error(const struct yaml_source *f, const yaml_parser_t *parser)
{
  const char *problem = parser->problem ? parser->problem : "unreadable";
  if (parser->error == YAML_MEMORY_ERROR)
    return status_set(ERR_MEMORY, "no memory to read %s", f->path);
  if (parser->error == YAML_READER_ERROR)
    return refuse_at(f, mark_of_offset(f, parser->problem_offset), "not YAML: %s", problem);
  return refuse_at(f, parser->problem_mark, "not YAML: %s", problem);
}

struct census {
  int documents, scalars, levels;
};

static status count_event(const struct yaml_source *f, const yaml_event_t *event, struct census *c)
{
  switch (event->type) {
  case YAML_ALIAS_EVENT:
    return refuse_at(f, event->start_mark, "alias '*%.40s' found, allowed is the value itself",
                     (const char *)event->data.alias.anchor);
  case YAML_DOCUMENT_START_EVENT:
    if (++c->documents > 1)
      return refuse_at(f, event->start_mark, "a second document begins, allowed is one");
    break;
  case YAML_SCALAR_EVENT: c->scalars++; break;
  case YAML_SEQUENCE_START_EVENT:
  case YAML_MAPPING_START_EVENT:
    if (++c->levels > MOST_LEVELS)
      return refuse_at(f, event->start_mark, "nested deeper than %d levels", MOST_LEVELS);
    break;
  case YAML_SEQUENCE_END_EVENT:
  case YAML_MAPPING_END_EVENT: c->levels--; break;
  default: break;
  }
  return OK;
}

static status check_syntax(const struct yaml_source *f)
{
  yaml_parser_t parser;
  struct census census = {0, 0, 0};
  status result = OK;
  int more = 1;
  if (!yaml_parser_initialize(&parser))
    return status_set(ERR_MEMORY, "no memory to read %s", f->path);
  yaml_parser_set_input_string(&parser, f->text, f->length);
  while (more && result == OK) {
    yaml_event_t event;
    if (!yaml_parser_parse(&parser, &event)) {
      result = syntax_error(f, &parser);
      break;
    }
    more = event.type != YAML_STREAM_END_EVENT;
    result = count_event(f, &event, &census);
    yaml_event_delete(&event);
  }
  yaml_parser_delete(&parser);
  if (result == OK && census.documents == 0) return user_error("%s is empty", f->path);
  return result;
}

static status load_document(struct yaml_source *f)
{
  yaml_parser_t parser;
  status result = OK;
  if (!yaml_parser_initialize(&parser))
    return status_set(ERR_MEMORY, "no memory to read %s", f->path);
  yaml_parser_set_input_string(&parser, f->text, f->length);
  if (yaml_parser_load(&parser, &f->document))
    f->has_document = 1;
  else
    result = syntax_error(f, &parser);
  yaml_parser_delete(&parser);
  return result;
}

/* --- second pass: is it what the schema says? --- */

/* A node with its schema and its way from the top ("fluid[1].box"). */
struct visit {
  struct yaml_source *f;
  yaml_node_t *node;
  const cyaml_schema_value_t *schema;
  char path[PATH_ROOM];
};

static yaml_node_t *node_of(struct yaml_source *f, int index)
{
  return yaml_document_get_node(&f->document, index);
}

static const char *kind_text(cyaml_type_e type)
{
  switch (type) {
  case CYAML_INT:
  case CYAML_UINT: return "a whole number";
  case CYAML_FLOAT: return "a number";
  case CYAML_BOOL: return "true or false";
  case CYAML_STRING:
  case CYAML_ENUM: return "text";
  case CYAML_MAPPING: return "a mapping (key: value)";
  default: return "a list ([.., ..])";
  }
}

/* What was found, as text that fits a sentence. */
static const char *found_text(const yaml_node_t *node, char buf[64])
{
  if (node->type == YAML_SEQUENCE_NODE) return "a list";
  if (node->type == YAML_MAPPING_NODE) return "a mapping";
  if (node->data.scalar.length == 0) return "nothing";
  const int length = node->data.scalar.length > 40 ? 40 : (int)node->data.scalar.length;
  snprintf(buf, 64, "'%.*s%s'", length, (const char *)node->data.scalar.value,
           length < (int)node->data.scalar.length ? ".." : "");
  for (char *c = buf; *c; c++)
    if ((unsigned char)*c < ' ') *c = '?';
  return buf;
}

static status wrong_kind(const struct visit *v)
{
  char found[64];
  return refuse_at(v->f, v->node->start_mark, "%s is %s, allowed is %s",
                   *v->path ? v->path : "the document", found_text(v->node, found),
                   kind_text(v->schema->type));
}

static int is_whole(const char *text)
{
  char *end;
  const char *digits = text + (*text == '-');
  errno = 0;
  const long long number = strtoll(text, &end, 10);
  if (end == text || *end || errno || (*digits == '0' && digits[1])) return 0;
  return *digits >= '0' && *digits <= '9' && number >= INT32_MIN && number <= INT32_MAX;
}

static int is_finite_number(const char *text)
{
  char *end;
  errno = 0;
  const double number = strtod(text, &end);
  return end != text && !*end && errno == 0 && isfinite(number);
}

/* One of the schema's words. */
static status check_word(const struct visit *v)
{
  const char *text = (const char *)v->node->data.scalar.value;
  char list[512] = "", found[64];
  for (uint32_t k = 0; k < v->schema->enumeration.count; k++) {
    const char *word = v->schema->enumeration.strings[k].str;
    const size_t used = strlen(list);
    if (!strcmp(word, text)) return OK;
    snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", word);
  }
  return refuse_at(v->f, v->node->start_mark, "%s is %s, allowed are %s", v->path,
                   found_text(v->node, found), list);
}

static status check_scalar(const struct visit *v)
{
  const char *text = (const char *)v->node->data.scalar.value;
  const size_t length = v->node->data.scalar.length;
  int right = strlen(text) == length;
  if (v->schema->type == CYAML_STRING && right) {
    if (length >= v->schema->string.min && length <= v->schema->string.max) return OK;
    return refuse_at(v->f, v->node->start_mark, "%s has %zu letters, allowed are %u to %u", v->path,
                     length, v->schema->string.min, v->schema->string.max);
  }
  if (v->schema->type == CYAML_ENUM && right) return check_word(v);
  switch (v->schema->type) {
  case CYAML_FLOAT: right = right && is_finite_number(text); break;
  case CYAML_INT:
  case CYAML_UINT:
    right = right && is_whole(text) && (v->schema->type == CYAML_INT || *text != '-');
    break;
  case CYAML_BOOL: right = right && (!strcmp(text, "true") || !strcmp(text, "false")); break;
  default: right = 0;
  }
  return right ? OK : wrong_kind(v);
}

static status check_node(const struct visit *v);

static status check_list(const struct visit *v)
{
  const yaml_node_item_t *items = v->node->data.sequence.items.start;
  const long n = (long)(v->node->data.sequence.items.top - items);
  const long low = (long)v->schema->sequence.min;
  const long high =
    v->schema->sequence.max == CYAML_UNLIMITED ? n + low : (long)v->schema->sequence.max;
  if (v->schema->type != CYAML_SEQUENCE && v->schema->type != CYAML_SEQUENCE_FIXED)
    return wrong_kind(v);
  if (n < low || n > high)
    return low == high
             ? refuse_at(v->f, v->node->start_mark, "%s has %ld entries, allowed are %ld", v->path,
                         n, low)
             : refuse_at(v->f, v->node->start_mark, "%s has %ld entries, allowed are %ld to %ld",
                         v->path, n, low, high);
  for (long k = 0; k < n; k++) {
    struct visit entry = {v->f, node_of(v->f, items[k]), v->schema->sequence.entry, ""};
    snprintf(entry.path, sizeof entry.path, "%.230s[%ld]", v->path, k + 1);
    TRY(check_node(&entry));
  }
  return OK;
}

static status unknown_key(const struct visit *v, const yaml_node_t *key)
{
  const char *names[MOST_KEYS];
  char list[512] = "", found[64];
  int n = 0;
  for (const cyaml_schema_field_t *s = v->schema->mapping.fields; s->key && n < MOST_KEYS; s++) {
    const size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", n ? ", " : "", s->key);
    names[n++] = s->key;
  }
  const char *near = nearest_name((const char *)key->data.scalar.value, names, n);
  return refuse_at(v->f, key->start_mark, "unknown key %s%s%s, allowed are %s%s%s%s",
                   found_text(key, found), *v->path ? " in " : "", v->path, list,
                   near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* The pair of this key before `end` (NULL: all); NULL if there is none. */
static yaml_node_pair_t *find_pair(struct yaml_source *f, yaml_node_t *mapping, const char *key,
                                   const yaml_node_pair_t *end)
{
  yaml_node_pair_t *pair = mapping->data.mapping.pairs.start;
  if (!end) end = mapping->data.mapping.pairs.top;
  for (; pair < end; pair++) {
    const yaml_node_t *node = node_of(f, pair->key);
    if (node->type == YAML_SCALAR_NODE && !strcmp((const char *)node->data.scalar.value, key))
      return pair;
  }
  return NULL;
}

static status check_pair(const struct visit *v, const yaml_node_pair_t *pair)
{
  const yaml_node_t *key = node_of(v->f, pair->key);
  const cyaml_schema_field_t *field = v->schema->mapping.fields;
  if (key->type != YAML_SCALAR_NODE)
    return refuse_at(v->f, key->start_mark, "a key%s%s is a list or mapping, allowed is text",
                     *v->path ? " in " : "", v->path);
  const char *name = (const char *)key->data.scalar.value;
  while (field->key && strcmp(field->key, name)) field++;
  if (!field->key || strlen(name) != key->data.scalar.length) return unknown_key(v, key);
  if (find_pair(v->f, v->node, name, pair))
    return refuse_at(v->f, key->start_mark, "key '%s' is given twice", name);
  struct visit value = {v->f, node_of(v->f, pair->value), &field->value, ""};
  snprintf(value.path, sizeof value.path, "%.200s%s%.50s", v->path, *v->path ? "." : "", name);
  return check_node(&value);
}

static status check_mapping(const struct visit *v)
{
  if (v->schema->type != CYAML_MAPPING) return wrong_kind(v);
  const yaml_node_pair_t *top = v->node->data.mapping.pairs.top;
  for (const yaml_node_pair_t *pair = v->node->data.mapping.pairs.start; pair < top; pair++)
    TRY(check_pair(v, pair));
  for (const cyaml_schema_field_t *s = v->schema->mapping.fields; s->key; s++)
    if (!(s->value.flags & CYAML_FLAG_OPTIONAL) && !find_pair(v->f, v->node, s->key, NULL))
      return refuse_at(v->f, v->node->start_mark, "%s has no key '%s'",
                       *v->path ? v->path : "the document", s->key);
  return OK;
}

static status check_node(const struct visit *v)
{
  switch (v->node->type) {
  case YAML_SCALAR_NODE: return check_scalar(v);
  case YAML_SEQUENCE_NODE: return check_list(v);
  default: return check_mapping(v);
  }
}

/* --- third pass: libcyaml fills the structures --- */

static void keep_message(cyaml_log_t level, void *context, const char *format, va_list arguments)
{
  char *message = context;
  if (level >= CYAML_LOG_ERROR && !*message) vsnprintf(message, 256, format, arguments);
  for (char *c = message; *c; c++)
    if (*c == '\n') *c = ' ';
}

static cyaml_config_t configuration(char *message)
{
  const cyaml_config_t config = {.log_fn = keep_message,
                                 .log_ctx = message,
                                 .mem_fn = cyaml_mem,
                                 .log_level = CYAML_LOG_ERROR,
                                 .flags = CYAML_CFG_NO_ALIAS};
  return config;
}

static status fill(const struct yaml_source *f, void **data)
{
  char message[256] = "";
  const cyaml_config_t config = configuration(message);
  const cyaml_err_t error = cyaml_load_data(f->text, f->length, &config, f->schema, data, NULL);
  if (error == CYAML_OK && *data) return OK;
  if (error == CYAML_ERR_OOM) return status_set(ERR_MEMORY, "no memory to read %s", f->path);
  return user_error("%s: %s (%s)", f->path, error ? cyaml_strerror(error) : "nothing in it",
                    *message ? message : "libcyaml");
}

status yaml_source_read(const char *path, const struct cyaml_schema_value *schema,
                        struct yaml_source **file, void **data)
{
  struct yaml_source *f = calloc(1, sizeof *f);
  *file = NULL;
  *data = NULL;
  if (f) f->path = strdup(path);
  if (!f || !f->path) {
    free(f);
    return status_set(ERR_MEMORY, "no memory to read %s", path);
  }
  f->schema = schema;
  status result = read_text(f);
  if (result == OK) result = check_syntax(f);
  if (result == OK) result = load_document(f);
  if (result == OK) {
    const struct visit top = {f, yaml_document_get_root_node(&f->document), schema, ""};
    result = top.node ? check_node(&top) : user_error("%s is empty", path);
  }
  if (result == OK) result = fill(f, data);
  if (result == OK)
    *file = f;
  else
    yaml_source_free(f, NULL);
  return result;
}

/* --- places --- */

/* One step of the way from `node` along `key`, which is moved on; NULL where it ends. */
static yaml_node_t *step_to(struct yaml_source *f, yaml_node_t *node, const char **key)
{
  char name[64];
  if (**key == '[' && node->type == YAML_SEQUENCE_NODE) {
    char *end;
    const long k = strtol(*key + 1, &end, 10);
    const yaml_node_item_t *items = node->data.sequence.items.start;
    if (k < 1 || k > node->data.sequence.items.top - items || *end != ']') return NULL;
    *key = end + 1;
    return node_of(f, items[k - 1]);
  }
  if (**key == '.') (*key)++;
  const size_t length = strcspn(*key, ".[");
  if (length == 0 || length >= sizeof name || node->type != YAML_MAPPING_NODE) return NULL;
  memcpy(name, *key, length);
  name[length] = 0;
  *key += length;
  const yaml_node_pair_t *pair = find_pair(f, node, name, NULL);
  return pair ? node_of(f, pair->value) : NULL;
}

static yaml_mark_t mark_of(const struct yaml_source *file, const char *key)
{
  struct yaml_source *f = (struct yaml_source *)file; /* libyaml knows no const */
  yaml_node_t *node = yaml_document_get_root_node(&f->document), *next;
  while (*key && (next = step_to(f, node, &key))) node = next;
  return node->start_mark;
}

char *yaml_source_place(const struct yaml_source *file, const char *key, char *buf, size_t size)
{
  const yaml_mark_t mark = mark_of(file, key);
  snprintf(buf, size, "%s:%zu:%zu", file->path, mark.line + 1, mark.column + 1);
  return buf;
}

status yaml_source_refuse(const struct yaml_source *file, const char *key, const char *format, ...)
{
  char text[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return refuse_at(file, mark_of(file, key), "%s", text);
}

void yaml_source_free(struct yaml_source *file, void *data)
{
  char message[256] = "";
  if (!file) return;
  const cyaml_config_t config = configuration(message);
  if (data) cyaml_free(&config, file->schema, data, 0);
  if (file->has_document) yaml_document_delete(&file->document);
  free(file->text);
  free(file->path);
  free(file);
}
