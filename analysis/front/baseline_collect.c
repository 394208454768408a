/* From the facts of runs to what a baseline holds of them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "baseline.h"

/* Flags that change where a run writes, how fast it is or on what machine (which the variant says),
 * not what it computes. */
static int flag_to_skip(const char *word)
{
  static const char *const with_value[] = {"--solver", "-o",       "--json",   "--threads",
                                           "--frames", "--plugin", "--backend"};
  for (size_t k = 0; k < sizeof with_value / sizeof *with_value; k++)
    if (strcmp(word, with_value[k]) == 0) return 2;
  return strcmp(word, "--quiet") == 0 || strcmp(word, "--explain") == 0;
}

/* "SCENE with SOLVER (VARIANT) ARGUMENTS" */
static char *key_of(const json_t *facts)
{
  const json_t *argv = json_object_get(json_object_get(facts, "provenance"), "argv");
  char *text = NULL;
  size_t size = 0, k;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  fprintf(out, "%s with %s (%s)", json_string_value(json_object_get(facts, "scene")),
          json_string_value(json_object_get(facts, "solver")),
          json_string_value(json_object_get(facts, "variant")));
  for (k = 3; k < json_array_size(argv); k++) {
    const char *word = json_string_value(json_array_get(argv, k));
    const int skip = word ? flag_to_skip(word) : 1;
    if (skip == 0) fprintf(out, " %s", word);
    if (skip == 2) k++;
  }
  fclose(out);
  return text;
}

static void take_number(json_t *values, const char *name, const json_t *number)
{
  if (json_is_number(number) && isfinite(json_number_value(number)))
    json_object_set_new(values, name, json_real(json_number_value(number)));
}

static json_t *values_of(const json_t *facts)
{
  json_t *values = json_object(), *entry;
  const json_t *iterations = json_object_get(facts, "iterations");
  const char *name;
  json_object_foreach(json_object_get(facts, "metrics"), name, entry)
    take_number(values, name, json_object_get(entry, "value"));
  take_number(values, "iterations_mean", json_object_get(iterations, "mean"));
  take_number(values, "iterations_max", json_object_get(iterations, "max"));
  take_number(values, "residual_last", json_object_get(json_object_get(facts, "residual"), "last"));
  take_number(values, "particles", json_object_get(facts, "particles"));
  take_number(values, "steps", json_object_get(facts, "steps"));
  return values;
}

static void take_curves(json_t *run, const json_t *facts, const json_t *wanted)
{
  const json_t *all = json_object_get(facts, "series"), *time = json_object_get(all, "time");
  const size_t n = json_array_size(time);
  const double span[] = {json_number_value(json_array_get(time, 0)),
                         json_number_value(json_array_get(time, n ? n - 1 : 0))};
  json_t *curves = json_object(), *unused;
  const char *name;
  json_object_set_new(run, "span", json_pack("[f, f]", span[0], span[1]));
  json_object_foreach((json_t *)wanted, name, unused)
  {
    const json_t *curve = json_object_get(all, name);
    if (curve && n > 1) json_object_set_new(curves, name, curve_sample(time, curve, span));
  }
  json_object_set_new(run, "curves", curves);
}

/* --- identity */

static json_t *hash_text(unsigned long long hash, int digits)
{
  return json_sprintf("%0*llx", digits, digits < 16 ? hash >> 32 : hash);
}

/* Over every number that the run gave, to the last bit. */
static json_t *bits_of(const json_t *facts)
{
  static const char *const parts[] = {"status", "steps", "iterations", "metrics", "series"};
  unsigned long long hash = HASH_START;
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
    const json_t *part = json_object_get(facts, parts[k]);
    char *text = part ? json_dumps(part, JSON_ENCODE_ANY | JSON_SORT_KEYS | JSON_COMPACT) : NULL;
    if (text) hash = hash_bytes(hash, text, strlen(text));
    free(text);
  }
  return hash_text(hash, 16);
}

/* Of the compiler and its flags; what it stands for is noted in `builds`. */
static json_t *build_of(const json_t *facts, json_t *builds)
{
  const json_t *from = json_object_get(facts, "provenance");
  const char *compiler = json_string_value(json_object_get(from, "compiler"));
  const char *flags = json_string_value(json_object_get(from, "flags"));
  char *text = text_make("%s %s", compiler ? compiler : "?", flags ? flags : "");
  json_t *hash = hash_text(text ? hash_bytes(HASH_START, text, strlen(text)) : 0, 8);
  if (builds && text) json_object_set_new(builds, json_string_value(hash), json_string(text));
  free(text);
  return hash;
}

/* --- runs */

static const char *date_of(const json_t *facts)
{
  const char *date =
    json_string_value(json_object_get(json_object_get(facts, "provenance"), "date"));
  return date ? date : "";
}

/* What a run's facts say, to be kept under `key`. */
static json_t *run_of(const json_t *facts, const json_t *curves, json_t *builds)
{
  json_t *run =
    json_pack("{s:o, s:O, s:o, s:o}", "build", build_of(facts, builds), "status",
              json_object_get(facts, "status"), "bits", bits_of(facts), "values", values_of(facts));
  if (run) take_curves(run, facts, curves);
  return run;
}

struct source {
  const json_t *curves;
  json_t *builds, *runs, *dates;
};

static status take_run(const struct source *to, const char *path)
{
  json_error_t error;
  json_t *facts = json_load_file(path, 0, &error);
  if (!facts || !json_string_value(json_object_get(facts, "solver")) ||
      !json_string_value(json_object_get(facts, "status"))) {
    json_decref(facts);
    return user_error("%s:%d: no result of a run: %s", path, facts ? 1 : error.line,
                      facts ? "there is no key 'solver' or 'status'" : error.text);
  }
  char *key = key_of(facts);
  const char *before = json_string_value(json_object_get(to->dates, key ? key : ""));
  if (key && !(before && strcmp(before, date_of(facts)) > 0)) { /* the latest of several builds */
    json_object_set_new(to->runs, key, run_of(facts, to->curves, to->builds));
    json_object_set_new(to->dates, key, json_string(date_of(facts)));
  }
  json_decref(facts);
  free(key);
  return key ? OK : status_set(ERR_MEMORY, "out of memory");
}

static int ends_with(const char *text, const char *end)
{
  const size_t n = strlen(text), m = strlen(end);
  return n >= m && strcmp(text + n - m, end) == 0;
}

static status take_folder(const struct source *to, const char *results)
{
  const struct path folder = path_of("%s/runs", results);
  struct names names = folder_names(folder.text);
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    const struct path file = path_of("%s/%s", folder.text, names.name[k]);
    if (ends_with(names.name[k], ".json")) result = take_run(to, file.text);
  }
  names_free(&names);
  return result;
}

status baseline_collect(const char *results, const json_t *curves, json_t *builds, json_t **runs)
{
  const struct source to = {curves, builds, *runs = json_object(), json_object()};
  status result = path_is_file(results) ? take_run(&to, results) : take_folder(&to, results);
  json_decref(to.dates);
  if (result == OK && json_object_size(*runs) == 0)
    result = user_error("'%s' holds no result of a run", results);
  if (result == OK) result = baseline_group(*runs);
  if (result == OK) return OK;
  json_decref(*runs);
  *runs = NULL;
  return result;
}
