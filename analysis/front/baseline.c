#include "baseline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the rules of a new baseline */

/* R(metric, abs, rel, why): short runs of one build on one kind of processor give the same bits;
 * another compiler or a GPU changes the order of sums, which these bounds let pass. */
#define RULES(R)                                                                              \
  R("default", 1e-12, 1e-6, "rounding of another compiler, grown over some tens of steps")    \
  R("linear_momentum", 1e-9, 1e-6, "zero but for rounding where a method keeps it")           \
  R("angular_momentum", 1e-9, 1e-6, "zero but for rounding in scenes at rest")                \
  R("density_error_mean", 1e-9, 1e-5, "a difference of nearly equal numbers")                 \
  R("density_error_max", 1e-8, 1e-4, "of one particle")                                       \
  R("volume_change", 1e-9, 1e-5, "a difference of nearly equal numbers")                      \
  R("gamma_mean", 1e-9, 1e-5, "a difference of nearly equal numbers")                         \
  R("particles_lost", 0, 0, "a count")                                                        \
  R("clumping_fraction", 1e-12, 1e-6, "a count")                                              \
  R("particles", 0, 0, "a count")                                                             \
  R("steps", 0, 0, "a count")                                                                 \
  R("iterations_mean", 0.011, 0, "one iteration more or less in a hundred steps is rounding") \
  R("iterations_max", 1, 0, "one iteration more or less in a single step is rounding")

json_t *baseline_default_rules(void)
{
  json_t *rules = json_object();
#define R(metric, absolute, relative, why)                                                \
  json_object_set_new(rules, metric,                                                      \
                      json_pack("{s:f, s:f, s:s, s:s}", "abs", (double)(absolute), "rel", \
                                (double)(relative), "side", "both", "why", why));
  RULES(R)
#undef R
  return rules;
}

json_t *baseline_default_curves(void)
{
  static const char *const names[] = {"kinetic_energy",     "total_energy", "gamma_mean",
                                      "density_error_mean", "iterations",   "residual"};
  json_t *curves = json_object();
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    const int counted = strcmp(names[k], "iterations") == 0;
    json_object_set_new(
      curves, names[k],
      json_pack("{s:f, s:f, s:s}", "abs", counted ? 1.0 : 1e-9, "rel", counted ? 0.0 : 1e-4, "why",
                counted ? "one iteration more or less in a single step is rounding"
                        : "rounding of another compiler, of the curve's largest value"));
  }
  return curves;
}

const json_t *baseline_rule(const json_t *rules, const char *metric)
{
  const json_t *rule = json_object_get(rules, metric);
  return rule ? rule : json_object_get(rules, "default");
}

/* --- what was measured */

/* Flags that change where a run writes or how fast it is, not what it computes. */
static int flag_to_skip(const char *word)
{
  static const char *const with_value[] = {"--solver",  "-o",       "--json",
                                           "--threads", "--frames", "--plugin"};
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
  take_number(values, "particles", json_object_get(facts, "particles"));
  take_number(values, "steps", json_object_get(facts, "steps"));
  return values;
}

static json_t *series_of(const json_t *facts, const json_t *curves)
{
  const json_t *all = json_object_get(facts, "series");
  json_t *series = json_object(), *unused;
  const char *name;
  json_object_set(series, "time", json_object_get(all, "time"));
  json_object_foreach((json_t *)curves, name, unused) if (json_object_get(all, name))
    json_object_set(series, name, json_object_get(all, name));
  return series;
}

static const char *date_of(const json_t *facts)
{
  const char *date =
    json_string_value(json_object_get(json_object_get(facts, "provenance"), "date"));
  return date ? date : "";
}

static status take_run(json_t *runs, const char *path, const json_t *curves)
{
  json_error_t error;
  json_t *facts = json_load_file(path, 0, &error);
  char *key = NULL;
  if (!facts || !json_string_value(json_object_get(facts, "solver"))) {
    json_decref(facts);
    return user_error("%s:%d: no result of a run: %s", path, facts ? 1 : error.line,
                      facts ? "there is no key 'solver'" : error.text);
  }
  key = key_of(facts);
  const char *date = date_of(facts),
             *known =
               json_string_value(json_object_get(json_object_get(runs, key ? key : ""), "date"));
  if (key && !(known && strcmp(known, date) > 0)) /* the latest of several builds */
    json_object_set_new(runs, key,
                        json_pack("{s:s, s:O, s:o, s:o}", "date", date, "status",
                                  json_object_get(facts, "status"), "values", values_of(facts),
                                  "series", series_of(facts, curves)));
  json_decref(facts);
  free(key);
  return key ? OK : status_set(ERR_MEMORY, "out of memory");
}

static int ends_with(const char *text, const char *end)
{
  const size_t n = strlen(text), m = strlen(end);
  return n >= m && strcmp(text + n - m, end) == 0;
}

status baseline_collect(const char *results, const json_t *curves, json_t **runs)
{
  status result = OK;
  *runs = json_object();
  if (path_is_file(results)) {
    result = take_run(*runs, results, curves);
  } else {
    const struct path folder = path_of("%s/runs", results);
    struct names names = folder_names(folder.text);
    for (int k = 0; k < names.n && result == OK; k++) {
      const struct path file = path_of("%s/%s", folder.text, names.name[k]);
      if (ends_with(names.name[k], ".json")) result = take_run(*runs, file.text, curves);
    }
    names_free(&names);
  }
  if (result == OK && json_object_size(*runs) == 0)
    result = user_error("'%s' holds no result of a run", results);
  if (result == OK) return OK;
  json_decref(*runs);
  *runs = NULL;
  return result;
}

/* --- reading */

static status check_rules(const char *path, const char *list, const json_t *rules)
{
  const char *name;
  json_t *rule;
  if (!json_is_object(rules)) return user_error("%s: key '%s' is no object", path, list);
  json_object_foreach((json_t *)rules, name, rule)
  {
    const double a = json_number_value(json_object_get(rule, "abs"));
    const double r = json_number_value(json_object_get(rule, "rel"));
    const char *side = json_string_value(json_object_get(rule, "side"));
    if (!json_is_number(json_object_get(rule, "abs")) || !(a >= 0) ||
        !json_is_number(json_object_get(rule, "rel")) || !(r >= 0))
      return user_error("%s: %s.%s: abs and rel are needed, numbers of at least 0", path, list,
                        name);
    if (side && strcmp(side, "both") && strcmp(side, "above") && strcmp(side, "below"))
      return user_error("%s: %s.%s.side is '%s', allowed is both, above or below", path, list, name,
                        side);
  }
  return OK;
}

static status check_runs(const char *path, const json_t *runs)
{
  const char *key, *name;
  json_t *run, *value;
  if (!json_is_object(runs) || json_object_size(runs) == 0)
    return user_error("%s: key 'runs' is no object with runs", path);
  json_object_foreach((json_t *)runs, key, run)
  {
    if (!json_string_value(json_object_get(run, "status")))
      return user_error("%s: runs.%s has no status", path, key);
    json_object_foreach(
      json_object_get(run, "values"), name,
      value) if (!json_is_number(value)) return user_error("%s: runs.%s.values.%s is no number",
                                                           path, key, name);
  }
  return OK;
}

status baseline_read(const char *path, json_t **baseline)
{
  json_error_t error;
  *baseline = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
  if (!*baseline) return user_error("%s:%d: %s", path, error.line, error.text);
  status result = check_rules(path, "rules", json_object_get(*baseline, "rules"));
  if (result == OK) result = check_rules(path, "curves", json_object_get(*baseline, "curves"));
  if (result == OK) result = check_runs(path, json_object_get(*baseline, "runs"));
  if (result == OK) return OK;
  json_decref(*baseline);
  *baseline = NULL;
  return result;
}
