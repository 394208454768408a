/* program.h - what the programs of figures share: their command line, the runs' files, data files
 * and values.json (docs/figures.md).
 *
 *   NAME FOLDER [arguments] -- LABEL=RUN.json ... */
#ifndef FIGURE_PROGRAM_H
#define FIGURE_PROGRAM_H
#include <ctype.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../core/base/status.h"
#include "../../core/io/result_read.h"

struct figure_run {
  const char *label;        /* as in the recipe's runs, "dual-sc viscous, dt 0.001" */
  json_t *facts;            /* RUN.json */
  struct result_read *file; /* RUN.vtkhdf beside it */
};

struct program {
  const char *folder;    /* where the data go */
  const char **argument; /* [num_arguments] */
  int num_arguments, n;
  struct figure_run *run; /* [n] */
  json_t *values;
};

/* A number of a run's facts by its keys, "parameters.dt"; NaN where there is none. */
static inline double program_fact(const struct figure_run *run, const char *keys)
{
  const json_t *at = run->facts;
  char key[64];
  while (*keys) {
    const size_t length = strcspn(keys, ".");
    snprintf(key, sizeof key, "%.*s", (int)length, keys);
    at = json_object_get(at, key);
    keys += length + (keys[length] == '.');
  }
  return json_is_number(at) ? json_number_value(at) : (double)NAN;
}

/* ERR_IO: a file is missing or no result; ERR_USER: no '=' in the word. */
static inline status program_open_run(struct figure_run *run, char *word)
{
  char path[4096];
  char *equals = strchr(word, '='), *end = strrchr(word, '.');
  json_error_t error;
  if (!equals || !end) return user_error("'%s' found, LABEL=RUN.json expected", word);
  *equals = '\0';
  run->label = word;
  if (!(run->facts = json_load_file(equals + 1, 0, &error)))
    return status_set(ERR_IO, "%s:%d: %s", equals + 1, error.line, error.text);
  snprintf(path, sizeof path, "%.*s.vtkhdf", (int)(end - equals - 1), equals + 1);
  return result_read_open(&run->file, path);
}

/* Take the command line apart and open the runs; to be ended by program_end, whatever comes. */
static inline status program_begin(struct program *p, int argc, char **argv)
{
  int split = 2;
  *p = (struct program){.values = json_object()};
  while (split < argc && strcmp(argv[split], "--") != 0) split++;
  if (argc < 3 || split == argc)
    return user_error("usage: %s FOLDER [arguments] -- LABEL=RUN.json ...", argv[0]);
  p->folder = argv[1];
  p->argument = (const char **)argv + 2;
  p->num_arguments = split - 2;
  p->run = calloc((size_t)(argc - split), sizeof *p->run);
  if (!p->run) return status_set(ERR_MEMORY, "out of memory");
  for (int k = split + 1; k < argc; k++) TRY(program_open_run(&p->run[p->n++], argv[k]));
  return OK;
}

/* One of the numbers of values.json; null where it is not finite. */
static inline void program_value(struct program *p, const char *name, double value)
{
  json_object_set_new(p->values, name, isfinite(value) ? json_real(value) : json_null());
}
/* The same of a run: NAME_LABEL, with '_' for what is neither letter nor digit. */
static inline void program_run_value(struct program *p, const char *name, const char *label,
                                     double value)
{
  char whole[256];
  char *to = whole + snprintf(whole, sizeof whole / 2, "%s_", name);
  for (const char *c = label; *c && to < whole + sizeof whole - 1; c++) {
    const int plain = isalnum((unsigned char)*c);
    if (plain || to[-1] != '_') *to++ = plain ? *c : '_';
  }
  *to = '\0';
  program_value(p, whole, value);
}

/* The data file LABEL.dat, named as the front end names that of a run, with its two lines of head;
 * `columns` are separated by " | ". NULL: status_sentence() says why. */
static inline FILE *program_data(const struct program *p, const char *label, const char *suffix,
                                 const char *columns)
{
  char name[256], path[4096], *to = name;
  for (const char *c = label; *c && to < name + sizeof name - 1; c++) {
    const int plain = isalnum((unsigned char)*c) || strchr(".-+", *c);
    if (plain || (to > name && to[-1] != '-')) *to++ = plain ? *c : '-';
  }
  *to = '\0';
  snprintf(path, sizeof path, "%s/%s%s.dat", p->folder, name, suffix);
  FILE *out = fopen(path, "w");
  if (!out)
    status_set(ERR_IO, "'%s' cannot be written", path);
  else
    fprintf(out, "# %s\n# columns: %s\n", label, columns);
  return out;
}

/* Write values.json, close the runs, say what failed: the exit code of the program. */
static inline int program_end(struct program *p, status result)
{
  char path[4096];
  snprintf(path, sizeof path, "%s/values.json", p->folder ? p->folder : ".");
  if (result == OK && json_object_size(p->values) > 0 &&
      json_dump_file(p->values, path, JSON_INDENT(2) | JSON_SORT_KEYS) != 0)
    result = status_set(ERR_IO, "'%s' cannot be written", path);
  for (int k = 0; k < p->n; k++) {
    json_decref(p->run[k].facts);
    result_read_close(p->run[k].file);
  }
  free(p->run);
  json_decref(p->values);
  if (result != OK) fprintf(stderr, "%s\n", status_sentence());
  return status_exit_code(result);
}

/* A program that treats one run after the other. */
static inline int program_each(int argc, char **argv,
                               status (*treat)(struct program *p, const struct figure_run *run))
{
  struct program p;
  status result = program_begin(&p, argc, argv);
  for (int k = 0; result == OK && k < p.n; k++) result = treat(&p, &p.run[k]);
  return program_end(&p, result);
}
#endif
