#include "baseline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- the rules of a new baseline */

/* R(metric, abs, rel, why): runs of one build on one kind of processor give the same bits; another
 * compiler or a GPU changes the order of sums, which these bounds let pass. Measured on the quick
 * plan, gcc -O3 with fused multiply-adds against clang -O2 without: at most 1.5e-8 or 5e-9 of the
 * value in double, 1.4e-4 or 1.2e-4 of it in float. */
#define RULES(R)                                                                              \
  R("default", 1e-7, 1e-6, "rounding of another compiler, grown over some tens of steps")     \
  R("f32/default", 2e-5, 2e-4, "rounding of another compiler, in single precision")           \
  R("density_error_mean", 3e-8, 1e-5, "a difference of nearly equal numbers")                 \
  R("density_error_max", 5e-7, 1e-4, "of one particle")                                       \
  R("volume_change", 3e-7, 1e-5, "a difference of nearly equal numbers")                      \
  R("gamma_mean", 3e-8, 1e-5, "a difference of nearly equal numbers")                         \
  R("particles_lost", 0, 0, "a count")                                                        \
  R("clumping_fraction", 1e-12, 1e-6, "a count")                                              \
  R("particles", 0, 0, "a count")                                                             \
  R("steps", 0, 0, "a count")                                                                 \
  R("residual_last", 1e-6, 1e-4, "a hundredth of the solvers' usual tolerance")               \
  R("f32/residual_last", 1e-5, 1e-4, "a tenth of the solvers' usual tolerance")               \
  R("iterations_mean", 0.011, 0, "one iteration more or less in a hundred steps is rounding") \
  R("iterations_max", 1, 0, "one iteration more or less in a single step is rounding")

/* C(curve, abs, rel, why) */
#define CURVES(C)                                                                  \
  C("kinetic_energy", 1e-7, 1e-4, "rounding, of the curve's size")                 \
  C("total_energy", 1e-7, 1e-4, "rounding, of the curve's size")                   \
  C("f32/kinetic_energy", 3e-5, 1e-4, "rounding, in single precision")             \
  C("f32/total_energy", 3e-5, 1e-4, "rounding, in single precision")               \
  C("gamma_mean", 3e-8, 1e-4, "rounding, of the curve's size")                     \
  C("density_error_mean", 3e-8, 1e-4, "rounding, of the curve's size")             \
  C("iterations", 1, 0, "one iteration more or less in a single step is rounding") \
  C("residual", 1e-6, 1e-4, "a hundredth of the solvers' usual tolerance")         \
  C("f32/residual", 1e-5, 1e-4, "a tenth of the solvers' usual tolerance")

static json_t *rule_of(double absolute, double relative, const char *why)
{
  return json_pack("{s:f, s:f, s:s}", "abs", absolute, "rel", relative, "why", why);
}

json_t *baseline_default_rules(void)
{
  json_t *rules = json_object();
#define R(metric, absolute, relative, why) \
  json_object_set_new(rules, metric, rule_of(absolute, relative, why));
  RULES(R)
#undef R
  return rules;
}

json_t *baseline_default_curves(void)
{
  json_t *curves = json_object();
#define C(name, absolute, relative, why) \
  json_object_set_new(curves, name, rule_of(absolute, relative, why));
  CURVES(C)
#undef C
  return curves;
}

json_t *baseline_default_seeds(void)
{
  return json_pack("{s:f, s:s}", "sigmas", 4.0, "why",
                   "two medians of the same scatter are further apart once in 16000 times");
}

static const json_t *under(const json_t *rules, const char *where, int length, const char *metric)
{
  const struct path key = path_of("%.*s/%s", length, where, metric);
  return json_object_get(rules, key.text);
}

const json_t *baseline_rule(const json_t *rules, const char *run, const char *metric)
{
  const char *scene_end = strstr(run, " with ");
  const int is_float = strstr(run, "-f32)") != NULL;
  const json_t *rule = scene_end ? under(rules, run, (int)(scene_end - run), metric) : NULL;
  if (!rule && is_float) rule = under(rules, "f32", 3, metric);
  if (!rule) rule = json_object_get(rules, metric);
  if (!rule && is_float) rule = json_object_get(rules, "f32/default");
  return rule ? rule : json_object_get(rules, "default");
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

static status check_numbers(const char *path, const char *run, const char *list,
                            const json_t *numbers)
{
  const char *name;
  json_t *value;
  if (numbers && !json_is_object(numbers))
    return user_error("%s: runs.%s.%s is no object", path, run, list);
  json_object_foreach((json_t *)numbers, name, value) if (!json_is_number(value)) return user_error(
    "%s: runs.%s.%s.%s is no number", path, run, list, name);
  return OK;
}

/* Gates are made from these; one that is missing must not open a gate. */
static status check_runs(const char *path, const json_t *runs)
{
  const char *key, *name;
  json_t *run, *curve;
  if (!json_is_object(runs) || json_object_size(runs) == 0)
    return user_error("%s: key 'runs' is no object with runs", path);
  json_object_foreach((json_t *)runs, key, run)
  {
    const json_t *mad = json_object_get(run, "mad");
    if (!json_string_value(json_object_get(run, "status")))
      return user_error("%s: runs.%s has no status", path, key);
    TRY(check_numbers(path, key, "values", json_object_get(run, "values")));
    TRY(check_numbers(path, key, "mad", mad));
    if (mad && !(json_number_value(json_object_get(run, "seeds")) >= 1))
      return user_error("%s: runs.%s.seeds: a number of at least 1 is needed", path, key);
    json_object_foreach(
      json_object_get(run, "curves"), name,
      curve) if (json_array_size(curve) !=
                 CURVE_BINS) return user_error("%s: runs.%s.curves.%s has %zu numbers, not %d",
                                               path, key, name, json_array_size(curve), CURVE_BINS);
  }
  return OK;
}

/* What an older file lacks. */
static void fill_in(json_t *baseline)
{
  const json_t *sigmas = json_object_get(json_object_get(baseline, "seeds"), "sigmas");
  if (!json_is_number(sigmas) || !(json_number_value(sigmas) >= 0))
    json_object_set_new(baseline, "seeds", baseline_default_seeds());
  if (!json_is_object(json_object_get(baseline, "builds")))
    json_object_set_new(baseline, "builds", json_object());
}

status baseline_read(const char *path, json_t **baseline)
{
  json_error_t error;
  *baseline = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
  if (!*baseline) return user_error("%s:%d: %s", path, error.line, error.text);
  status result = check_rules(path, "rules", json_object_get(*baseline, "rules"));
  if (result == OK) result = check_rules(path, "curves", json_object_get(*baseline, "curves"));
  if (result == OK) result = check_runs(path, json_object_get(*baseline, "runs"));
  if (result == OK && !json_is_array(json_object_get(*baseline, "history")))
    result = user_error("%s: key 'history' is no list", path);
  if (result == OK) fill_in(*baseline);
  if (result == OK) return OK;
  json_decref(*baseline);
  *baseline = NULL;
  return result;
}

/* --- writing */

static void put(FILE *out, const json_t *value, size_t digits)
{
  char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(digits));
  fputs(text ? text : "null", out);
  free(text);
}

/* Curves to 5 digits, all else to 7: both well within the rules. */
static void put_run(FILE *out, const json_t *run)
{
  const char *key;
  json_t *part;
  int n = 0;
  fputc('{', out);
  json_object_foreach((json_t *)run, key, part)
  {
    fprintf(out, "%s\"%s\":", n++ ? "," : "", key);
    put(out, part, strcmp(key, "curves") == 0 ? 5 : 7);
  }
  fputc('}', out);
}

static int by_text(const void *a, const void *b)
{
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Sorted, so that a change shows as one. */
static status put_runs(FILE *out, const json_t *runs)
{
  const char **keys = calloc(json_object_size(runs) + 1, sizeof *keys), *key;
  json_t *run;
  size_t n = 0;
  if (!keys) return status_set(ERR_MEMORY, "out of memory");
  json_object_foreach((json_t *)runs, key, run) keys[n++] = key;
  qsort(keys, n, sizeof *keys, by_text);
  for (size_t k = 0; k < n; k++) {
    json_t *text = json_string(keys[k]);
    fputs(k ? ",\n " : "\n ", out);
    put(out, text, 0);
    fputs(": ", out);
    put_run(out, json_object_get(runs, keys[k]));
    json_decref(text);
  }
  free(keys);
  return OK;
}

/* A member of an object or of a list per line. */
static void put_lines(FILE *out, const json_t *part)
{
  const char *key;
  json_t *member;
  size_t k;
  int n = 0;
  json_object_foreach((json_t *)part, key, member)
  {
    fprintf(out, "%s\n \"%s\": ", n++ ? "," : "", key);
    put(out, member, 9);
  }
  json_array_foreach(part, k, member)
  {
    fputs(k ? ",\n " : "\n ", out);
    put(out, member, 9);
  }
}

status baseline_write(const char *path, const json_t *baseline)
{
  struct new_file file;
  const char *key;
  json_t *part;
  int n = 0;
  TRY(file_begin(&file, path));
  status result = OK;
  json_object_foreach((json_t *)baseline, key, part)
  {
    const int is_list = json_is_array(part), is_whole = !is_list && !json_is_object(part);
    fprintf(file.stream, "%s\"%s\": %s", n++ ? ",\n" : "{\n", key,
            is_whole  ? ""
            : is_list ? "["
                      : "{");
    if (is_whole)
      put(file.stream, part, 9);
    else if (strcmp(key, "runs") == 0)
      result = put_runs(file.stream, part);
    else
      put_lines(file.stream, part);
    if (!is_whole) fputs(is_list ? "\n]" : "\n}", file.stream);
  }
  fputs("\n}\n", file.stream);
  if (result == OK) return file_commit(&file);
  file_discard(&file);
  return result;
}
