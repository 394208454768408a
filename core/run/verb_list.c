/* `sphbench list` and `sphbench show`: what is in the registries. */
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "driver.h"
#include "plugins.h"

static int print_json(json_t *what)
{
  const int failed = json_dumpf(what, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
  printf("\n");
  json_decref(what);
  return failed;
}

static void list_one(json_t *array, const char *name, const char *about)
{
  if (array)
    json_array_append_new(array, json_pack("{s:s, s:s}", "name", name, "about", about));
  else
    printf("%-22s %s\n", name, about);
}

static void list_solvers(json_t *array)
{
  for (int k = 0; k < solver_count(); k++) {
    const struct solver *s = solver_number(k);
    list_one(array, s->name, s->about);
    if (array && plugin_file(s))
      json_object_set_new(json_array_get(array, json_array_size(array) - 1), "plugin",
                          json_string(plugin_file(s)));
  }
}

static void list_kind(json_t *array, const char *kind)
{
  if (strcmp(kind, "solvers") == 0)
    list_solvers(array);
  else if (strcmp(kind, "scenes") == 0)
    for (int k = 0; k < num_benchmarks; k++)
      list_one(array, benchmarks[k]->name, benchmarks[k]->about);
  else
    for (int k = 0; k < NUM_METRICS; k++) list_one(array, metric_names[k], metric_about[k]);
}

status verb_list(const struct options *o)
{
  static const char *const kinds[] = {"solvers", "scenes", "metrics"};
  json_t *array = o->json_output ? json_array() : NULL;
  int known = o->name == NULL;
  for (int k = 0; k < COUNT(kinds); k++) {
    if (o->name && strcmp(o->name, kinds[k])) continue;
    known = 1;
    if (!o->name && !array) printf("%s%s:\n", k ? "\n" : "", kinds[k]);
    list_kind(array, kinds[k]);
  }
  if (array) print_json(array);
  return known
           ? OK
           : user_error(
               "list: '%s' found, allowed is solvers, scenes, metrics, figures, variants or plans",
               o->name);
}

static json_t *params_json(const struct param *p, int n, int is_double, const void *defaults)
{
  json_t *array = json_array();
  for (int k = 0; k < n; k++) {
    char word[64];
    double value = p[k].initial;
    if (defaults && is_double) value = *(const double *)((const char *)defaults + p[k].offset);
    json_t *row =
      json_pack("{s:s, s:s, s:s}", "name", p[k].name, "unit", p[k].unit, "meaning", p[k].meaning);
    const int is_choice = strchr(p[k].unit, '|') != NULL;
    json_object_set_new(row, "default",
                        is_choice ? json_string(param_text(&p[k], value, word)) : json_real(value));
    if (!is_choice) json_object_set_new(row, "range", json_pack("[f, f]", p[k].low, p[k].high));
    json_array_append_new(array, row);
  }
  return array;
}

static void print_params(const char *title, const struct param *p, int n, const void *defaults)
{
  if (n > 0) printf("%s (name, default, range, unit, meaning):\n", title);
  for (int k = 0; k < n; k++) {
    char word[64], range[64] = "";
    const double value =
      defaults ? *(const double *)((const char *)defaults + p[k].offset) : p[k].initial;
    if (!strchr(p[k].unit, '|')) snprintf(range, sizeof range, "%g .. %g", p[k].low, p[k].high);
    printf("  %-18s %-12s %-16s [%s] %s\n", p[k].name, param_text(&p[k], value, word), range,
           p[k].unit, p[k].meaning);
  }
}

static json_t *abilities_json(unsigned can)
{
#define A(name, text) #name,
  static const char *const names[] = {ABILITY_LIST(A)};
#undef A
  json_t *array = json_array();
  for (int k = 0; k < NUM_ABILITIES; k++)
    if (can & (1u << k)) json_array_append_new(array, json_string(names[k]));
  return array;
}

static void show_solver_text(const struct solver *s)
{
  printf("%s: %s\n  %s, doi:%s\n", s->name, s->about, s->paper, s->doi);
  print_params("parameters", s->params, s->num_params, NULL);
  printf("fields of its own (name, unit, meaning):\n");
  for (int k = 0; k < s->num_fields; k++)
    printf("  %-12s [%s] %s\n", s->fields[k].name, s->fields[k].unit, s->fields[k].meaning);
  printf("differences from the paper:\n");
  for (const char *line = s->differences; *line;) {
    const size_t length = strcspn(line, "\n");
    printf("  - %.*s\n", (int)length, line);
    line += length + (line[length] != '\0');
  }
}

static json_t *fields_json(const struct field *fields, int n)
{
  static const char *const where[NUM_WHERE] = {"fluid", "fluid and walls", "walls", "virtual"};
  json_t *array = json_array();
  for (int k = 0; k < n; k++)
    json_array_append_new(array, json_pack("{s:s, s:s, s:s, s:s}", "name", fields[k].name, "unit",
                                           fields[k].unit, "meaning", fields[k].meaning, "where",
                                           where[fields[k].where]));
  return array;
}

static void show_solver(const struct solver *s, int json)
{
  if (!json) {
    show_solver_text(s);
    return;
  }
  print_json(json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o}", "kind", "solver", "name",
                       s->name, "about", s->about, "paper", s->paper, "doi", s->doi, "differences",
                       s->differences, "parameters", params_json(s->params, s->num_params, 0, NULL),
                       "fields", fields_json(s->fields, s->num_fields), "can",
                       abilities_json(s->can)));
}

static json_t *dims_json(unsigned dims)
{
  json_t *array = json_array();
  if (dims & CAN(2D)) json_array_append_new(array, json_integer(2));
  if (dims & CAN(3D)) json_array_append_new(array, json_integer(3));
  return array;
}

static json_t *measures_json(const unsigned *measures)
{
  json_t *array = json_array();
  for (int k = NUM_GENERAL_METRICS; k < NUM_METRICS; k++)
    if (measures[k / 32] >> (k % 32) & 1u)
      json_array_append_new(array, json_string(metric_names[k]));
  return array;
}

/* The metric that is the error of a run against the scene's truth; NULL: it has none. */
static const char *main_error(const struct benchmark *b)
{
  static const int first[] = {METRIC_trajectory_error, METRIC_velocity_error};
  if (b->judged_by) return metric_names[b->judged_by];
  for (int k = 0; k < COUNT(first); k++)
    if (b->measures[first[k] / 32] >> (first[k] % 32) & 1u) return metric_names[first[k]];
  for (int k = NUM_GENERAL_METRICS; k < NUM_METRICS; k++) {
    const size_t length = strlen(metric_names[k]);
    const int is_error = length > 6 && strcmp(metric_names[k] + length - 6, "_error") == 0;
    if (is_error && b->measures[k / 32] >> (k % 32) & 1u) return metric_names[k];
  }
  return NULL;
}

static void show_scene(const struct benchmark *b, int json)
{
  struct scene_params common;
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&common + scene_param_rows[k].offset) = scene_param_rows[k].initial;
  if (b->defaults) b->defaults(&common);
  if (json) {
    json_t *parameters = params_json(scene_param_rows, num_scene_params, 1, &common);
    json_t *own = params_json(b->params, b->num_params, 0, NULL);
    json_array_extend(parameters, own);
    json_decref(own);
    print_json(json_pack("{s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:s?}", "kind", "scene", "name",
                         b->name, "about", b->about, "source", b->source, "parameters", parameters,
                         "asks", abilities_json(b->asks), "dims", dims_json(b->dims), "metrics",
                         measures_json(b->measures), "error", main_error(b)));
    return;
  }
  printf("%s: %s\n  %s\n", b->name, b->about, b->source);
  print_params("parameters of every scene, with this scene's defaults", scene_param_rows,
               num_scene_params, &common);
  print_params("its own parameters", b->params, b->num_params, NULL);
  printf("judged by: %s\n", main_error(b) ? main_error(b) : "nothing, it has no truth");
}

static void show_metric(int k, int json)
{
  if (json)
    print_json(json_pack("{s:s, s:s, s:s, s:s}", "kind", "metric", "name", metric_names[k], "unit",
                         metric_units[k], "about", metric_about[k]));
  else
    printf("%s [%s]: %s\n", metric_names[k], metric_units[k], metric_about[k]);
}

status verb_show(const struct options *o)
{
  if (!o->name) return user_error("show needs the name of a solver, scene or metric");
  const int json = o->json_output;
  if (solver_find(o->name)) {
    show_solver(solver_find(o->name), json);
    return OK;
  }
  if (benchmark_find(o->name)) {
    show_scene(benchmark_find(o->name), json);
    return OK;
  }
  const char *names[256];
  int n = 0;
  for (int k = 0; k < NUM_METRICS; k++) {
    if (strcmp(metric_names[k], o->name) == 0) {
      show_metric(k, json);
      return OK;
    }
    names[n++] = metric_names[k];
  }
  for (int k = 0; k < solver_count(); k++) names[n++] = solver_number(k)->name;
  for (int k = 0; k < num_benchmarks; k++) names[n++] = benchmarks[k]->name;
  const char *near = nearest_name(o->name, names, n);
  return near ? user_error("show: nothing is called '%s'; the nearest name is '%s'", o->name, near)
              : user_error("show: nothing is called '%s'; 'sphbench list' lists what there is",
                           o->name);
}
