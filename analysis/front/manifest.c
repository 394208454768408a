#include "manifest.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "json_out.h"

static const char kind[] = "manifest of sphbench, 1";

/* --- dealing out --- */

int manifest_deal(const struct queue *queue, long batch, int *task)
{
  const double enough = 60; /* s in a task, against which its start is nothing */
  long todo = 0, held = 0;
  for (int k = 0; k < queue->n; k++) todo += !queue->run[k].finished;
  const long least = (todo + MOST_TASKS - 1) / MOST_TASKS;
  double seconds = 0;
  int tasks = 0;
  for (int k = 0; k < queue->n; k++) {
    task[k] = -1;
    if (queue->run[k].finished) continue;
    const int full = batch > 0 ? held >= batch : seconds >= enough;
    if (tasks == 0 || (full && held >= least)) {
      tasks++;
      held = 0;
      seconds = 0;
    }
    task[k] = tasks - 1;
    held++;
    seconds += queue_expected_time(queue, &queue->run[k]);
  }
  return tasks;
}

/* --- writing --- */

static char *absolute(const char *path)
{
  char *whole = realpath(path, NULL);
  return whole ? whole : strdup(path);
}

/* With --fresh, what the journal has of a run already is not to count. */
static json_t *row_of(const struct run *run, const struct queue *queue, int fresh)
{
  const int before = fresh ? journal_count(&queue->journal, run->id) : 0;
  json_t *row = json_pack("{s:s, s:i, s:[]}", "id", run->id, "before", before, "argv");
  for (int k = 0; k < run->argc; k++)
    json_array_append_new(json_object_get(row, "argv"), json_string(run->argv[k]));
  return row;
}

static json_t *tasks_of(const struct manifest_settings *s, const struct queue *queue)
{
  json_t *tasks = json_array();
  for (int k = 0; k < s->tasks; k++) json_array_append_new(tasks, json_array());
  for (int k = 0; k < queue->n; k++)
    if (s->task[k] >= 0)
      json_array_append_new(json_array_get(tasks, (size_t)s->task[k]),
                            row_of(&queue->run[k], queue, s->fresh));
  return tasks;
}

status manifest_write(const struct manifest_settings *s, const struct queue *queue)
{
  char *folder = absolute("."), *results = absolute(queue->results);
  const char *plugin = getenv("SPHBENCH_PLUGIN");
  json_t *object =
    json_pack("{s:s, s:s*, s:s*, s:s*, s:s, s:f, s:I, s:o}", "kind", kind, "plan", s->plan,
              "folder", folder, "results", results, "plugin", plugin ? plugin : "", "timeout",
              queue->limit, "memory", (json_int_t)queue->memory, "tasks", tasks_of(s, queue));
  free(folder);
  free(results);
  return json_out_finish(object, s->path, NULL);
}

/* --- one task --- */

static const char *text_in(const json_t *manifest, const char *key)
{
  const char *text = json_string_value(json_object_get(manifest, key));
  return text ? text : "";
}

static status read_it(const char *path, json_t **manifest)
{
  json_error_t where;
  *manifest = json_load_file(path, 0, &where);
  if (!*manifest) return user_error("%s:%d:%d: %s", path, where.line, where.column, where.text);
  return strcmp(text_in(*manifest, "kind"), kind) == 0
           ? OK
           : user_error("%s: \"kind\": '%s' found, allowed is '%s'; sweep PLAN --emit writes it",
                        path, text_in(*manifest, "kind"), kind);
}

static status add_row(struct queue *queue, const json_t *row, const char *path)
{
  enum { MOST = 512 };
  const char *argv[MOST];
  const json_t *words = json_object_get(row, "argv");
  const int argc = (int)json_array_size(words);
  int number;
  for (int i = 0; i < argc && i < MOST; i++) {
    argv[i] = json_string_value(json_array_get(words, (size_t)i));
    if (!argv[i])
      return user_error("%s: argument %d of run '%s' is no text", path, i + 1, text_in(row, "id"));
  }
  if (argc < 4 || argc > MOST)
    return user_error("%s: run '%s' has %d arguments, allowed is 4 to %d", path, text_in(row, "id"),
                      argc, MOST);
  TRY(queue_add_arguments(queue, argv, argc, &number));
  struct run *run = &queue->run[number];
  const int before = (int)json_integer_value(json_object_get(row, "before"));
  if (before > 0 && journal_count(&queue->journal, run->id) <= before) run->finished = 0;
  if (strcmp(run->id, text_in(row, "id")) == 0) return OK;
  return user_error("%s: run '%s' would be '%s' now: the program, its scene or its plug-in is not "
                    "the one of the manifest; emit it again",
                    path, text_in(row, "id"), run->id);
}

static status open_queue(const json_t *manifest, const char *path, long number, struct queue *queue)
{
  unsigned long long hash = HASH_START;
  const char *plugin = text_in(manifest, "plugin");
  const json_t *task = json_array_get(json_object_get(manifest, "tasks"), (size_t)number), *row;
  size_t k;
  TRY(hash_file(&hash, path));
  const struct path part = path_of("%08llx-%ld", hash & 0xffffffff, number);
  if (*plugin && setenv("SPHBENCH_PLUGIN", plugin, 1)) return status_set(ERR_MEMORY, "no memory");
  if (chdir(text_in(manifest, "folder")))
    return user_error("%s: the folder '%s' is not there", path, text_in(manifest, "folder"));
  TRY(queue_open_part(queue, text_in(manifest, "results"), part.text));
  queue->limit = json_number_value(json_object_get(manifest, "timeout"));
  queue->memory = (long)json_integer_value(json_object_get(manifest, "memory"));
  json_array_foreach(task, k, row) TRY(add_row(queue, row, path));
  return OK;
}

status manifest_open(const char *path, long number, struct queue *queue, json_t **manifest)
{
  *queue = (struct queue){.journal = {.file = -1}};
  status result = read_it(path, manifest);
  const long tasks = (long)json_array_size(json_object_get(*manifest, "tasks"));
  if (result == OK && (number < 0 || number >= tasks))
    result = user_error("--task: %ld found, allowed is 0 to %ld (%s)", number, tasks - 1, path);
  if (result == OK) result = open_queue(*manifest, path, number, queue);
  if (result == OK) return OK;
  queue_close(queue);
  json_decref(*manifest);
  *manifest = NULL;
  return result;
}
