/* Data that a program of the figure's own computes from its runs: analysis/figures/NAME.c. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "figure.h"
#include "process.h"
#include "variants.h"

/* --- starting it --- */

/* Runs with facts as LABEL=FILE behind the words `argv` [n]; *num_runs counts them. */
static status add_runs(const struct figure *f, const struct queue *queue, char **argv, int n,
                       int *num_runs)
{
  char absolute[4096];
  for (int k = 0; k < f->n; k++) {
    const struct run *run = &queue->run[f->cases[k].run];
    const struct path file = run_file(queue->results, run->id, "json");
    const int has_facts = run->finished && run->outcome <= OUTCOME_DIVERGED;
    if (!has_facts || !realpath(file.text, absolute)) continue;
    if (!(argv[n + *num_runs] = text_make("%s=%s", f->cases[k].label, absolute)))
      return status_set(ERR_MEMORY, "out of memory");
    ++*num_runs;
  }
  return *num_runs || !f->n ? OK : user_error("%s: none of its runs has a result", f->recipe->name);
}

static status start(const struct figure *f, const struct path *executable, char **argv)
{
  const struct path log = path_of("%s/program.log", f->data.text);
  const struct process process = {.argv = (const char *const *)argv, .log = log.text};
  int code = 0;
  TRY(process_wait(&process, &code));
  if (code == 0) {
    unlink(log.text);
    return OK;
  }
  char *words = run_last_words(log.text);
  const status result = user_error("%s: '%s' ended with %d: %s", f->recipe->name, executable->text,
                                   code, words ? words : "without a word");
  free(words);
  return result;
}

static status run_program(const struct figure *f, const struct queue *queue)
{
  const struct recipe_extract *e = &f->recipe->extract;
  struct path executable;
  char data[4096], **argv;
  int n = 0, num_runs = 0;
  TRY(program_executable(e->program, &executable));
  if (!realpath(f->data.text, data)) return status_set(ERR_IO, "no folder '%s'", f->data.text);
  if (!(argv = calloc((size_t)f->n + e->num_arguments + 4, sizeof *argv)))
    return status_set(ERR_MEMORY, "out of memory");
  argv[n++] = strdup(executable.text);
  argv[n++] = strdup(data);
  for (unsigned k = 0; k < e->num_arguments; k++) argv[n++] = strdup(e->arguments[k]);
  argv[n++] = strdup("--");
  status result = add_runs(f, queue, argv, n, &num_runs);
  if (result == OK) result = start(f, &executable, argv);
  for (int k = 0; k < n + num_runs; k++) free(argv[k]);
  free(argv);
  return result;
}

/* --- what it wrote --- */

/* "# what" and "# columns: a | b" begin every data file. */
static status list_file(struct figure *f, const char *name)
{
  const struct path path = path_of("%s/%s", f->data.text, name);
  char *text;
  size_t size;
  TRY(file_read(path.text, &text, &size));
  char *rest = text, *about = strsep(&rest, "\n"), *columns = rest ? strsep(&rest, "\n") : NULL;
  const int good =
    about && strncmp(about, "# ", 2) == 0 && columns && strncmp(columns, "# columns: ", 11) == 0;
  if (good) {
    json_t *list = json_array();
    for (char *at = columns + 11, *next; at; at = next) {
      next = strstr(at, " | ");
      if (next) *next = '\0', next += 3;
      json_array_append_new(list, json_string(at));
    }
    json_array_append_new(
      f->files, json_pack("{s:s, s:s, s:o}", "file", name, "series", about + 2, "columns", list));
  }
  free(text);
  return good ? OK
              : user_error("%s: its first two lines are not '# what it is' and '# columns: a | b'",
                           path.text);
}

static status list_files(struct figure *f)
{
  struct names names = folder_names(f->data.text);
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    const char *end = strrchr(names.name[k], '.');
    if (end && strcmp(end, ".dat") == 0) result = list_file(f, names.name[k]);
  }
  names_free(&names);
  return result;
}

/* Numbers by name; null where one could not be found. */
static status read_values(struct figure *f)
{
  const struct path path = path_of("%s/values.json", f->data.text);
  const char *name;
  json_t *value;
  if (!path_is_file(path.text)) return OK;
  json_error_t error;
  f->values = json_load_file(path.text, 0, &error);
  if (!json_is_object(f->values))
    return user_error("%s:%d: %s", path.text, error.line, f->values ? "no object" : error.text);
  json_object_foreach(f->values, name, value)
  {
    if (!json_is_number(value) && !json_is_null(value))
      return user_error("%s: '%s' is no number", path.text, name);
  }
  return OK;
}

static void put_runs(const struct figure *f, const struct queue *queue, FILE *contents)
{
  int n = 0;
  put_lists(contents, f->n);
  for (int k = 0; k < f->n; k++) {
    const struct figure_case *one = &f->cases[k];
    const struct run *run = &queue->run[one->run];
    if (!run->finished || run->outcome > OUTCOME_DIVERGED) continue;
    const struct path name = data_name(one->label, "");
    put_curve(contents, ++n, name.text, one->label, one->colour);
  }
  fprintf(contents, "n = %d\n", n);
}

status extract_program(struct figure *f, const struct queue *queue, FILE *contents)
{
  const struct path values = path_of("%s/values.json", f->data.text);
  unlink(values.text);
  TRY(run_program(f, queue));
  TRY(list_files(f));
  put_runs(f, queue, contents);
  return read_values(f);
}
