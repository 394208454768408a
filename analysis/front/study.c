#include "study.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "figure.h"
#include "process.h"
#include "study_file.h"
#include "variants.h"

/* --- what the variant tells --- */

static status variant_of(const struct study_request *ask, struct path *executable)
{
  struct variant v = {"openmp", "f64", 2};
  char *words[] = {"sphbench",
                   "show",
                   ask->dim ? "--dim" : "",
                   (char *)(ask->dim ? ask->dim : ""),
                   ask->precision ? "--precision" : "",
                   (char *)(ask->precision ? ask->precision : ""),
                   ask->backend ? "--backend" : "",
                   (char *)(ask->backend ? ask->backend : "")};
  TRY(variant_choose(sizeof words / sizeof *words, words, &v));
  return variant_executable(&v, executable);
}

static json_t *told(const struct path *executable, const char *verb, const char *name)
{
  const char *const argv[] = {executable->text, verb, name, "--json", NULL};
  char *text = process_output(argv);
  json_t *object = text ? json_loads(text, 0, NULL) : NULL;
  free(text);
  return object;
}

static status unknown_scene(const struct study_request *ask, const json_t *list)
{
  const char *names[256];
  int n = 0;
  size_t k;
  json_t *row;
  json_array_foreach(list, k, row)
  {
    const char *name = json_string_value(json_object_get(row, "name"));
    if (name && n < 256) names[n++] = name;
  }
  const char *near = nearest_name(ask->scene, names, n);
  if (strchr(ask->scene, '/') || strstr(ask->scene, ".y"))
    return user_error("%s: '%s' is a scene file, which has no known truth; allowed is a scene of "
                      "'sphbench list scenes'",
                      ask->verb, ask->scene);
  return near ? user_error("unknown scene '%s'; the nearest known one is '%s'", ask->scene, near)
              : user_error("unknown scene '%s'; 'sphbench list scenes' lists them", ask->scene);
}

static int has_name(const json_t *list, const char *name)
{
  size_t k;
  json_t *row;
  json_array_foreach(list, k, row)
  {
    const char *word = json_string_value(row);
    if (!word) word = json_string_value(json_object_get(row, "name"));
    if (word && strcmp(word, name) == 0) return 1;
  }
  return 0;
}

static const json_t *parameter(const json_t *shown, const char *name)
{
  size_t k;
  json_t *row;
  json_array_foreach(json_object_get(shown, "parameters"), k, row)
  {
    const char *word = json_string_value(json_object_get(row, "name"));
    if (word && strcmp(word, name) == 0) return row;
  }
  return NULL;
}

static double parameter_default(const json_t *shown, const char *name)
{
  return json_number_value(json_object_get(parameter(shown, name), "default"));
}

static status check_error(const struct study *s)
{
  const json_t *metrics = json_object_get(s->scene, "metrics");
  const char *names[256];
  int n = 0;
  size_t k;
  json_t *row;
  if (has_name(metrics, s->error)) return OK;
  json_array_foreach((json_t *)metrics, k, row)
  {
    if (json_string_value(row) && n < 256) names[n++] = json_string_value(row);
  }
  const char *near = nearest_name(s->error, names, n);
  return near ? user_error("--error: the scene has no '%s'; the nearest metric is '%s'", s->error,
                           near)
              : user_error("--error: the scene has no '%s'; 'sphbench show %s' lists its metrics",
                           s->error, s->ask.scene);
}

static status learn_scene(struct study *s, const struct path *executable)
{
  json_t *list = told(executable, "list", "scenes");
  const status known = list && has_name(list, s->ask.scene) ? OK : unknown_scene(&s->ask, list);
  json_decref(list);
  TRY(known);
  s->scene = told(executable, "show", s->ask.scene);
  if (!s->scene) return status_set(ERR_IO, "'%s' cannot show its scenes", executable->text);
  s->error = s->ask.error ? s->ask.error : json_string_value(json_object_get(s->scene, "error"));
  s->metrics = told(executable, "list", "metrics");
  s->spacing = parameter_default(s->scene, "spacing");
  s->dt = parameter_default(s->scene, "dt");
  s->t_end = parameter_default(s->scene, "t_end");
  s->is_projection = has_name(json_object_get(s->scene, "asks"), "PROJECT");
  if (s->ask.needs_no_truth) return OK;
  if (s->error) return check_error(s);
  return user_error("%s: the scene '%s' has no known truth to measure an error against",
                    s->ask.verb, s->ask.scene);
}

static void learn_tolerance(struct method *m, const json_t *row, const char *name)
{
  static const char ending[] = "tolerance";
  const size_t length = strlen(name), end = sizeof ending - 1;
  const json_t *range = json_object_get(row, "range");
  if (length < end || strcmp(name + length - end, ending) != 0) return;
  if (m->num_tolerances == MOST_TOLERANCES) return;
  m->tolerance[m->num_tolerances++] = (struct tolerance){
    strdup(name), json_number_value(json_object_get(row, "default")),
    json_number_value(json_array_get(range, 0)), json_number_value(json_array_get(range, 1))};
}

static status learn_method(struct method *m, const struct path *executable)
{
  json_t *shown = told(executable, "show", m->name), *row;
  size_t k;
  if (!shown) return status_set(ERR_IO, "'%s' cannot show '%s'", executable->text, m->name);
  json_array_foreach(json_object_get(shown, "parameters"), k, row)
  {
    const char *name = json_string_value(json_object_get(row, "name"));
    if (name) learn_tolerance(m, row, name);
  }
  m->max_iterations = parameter_default(shown, "max_iterations");
  m->has_fixed = parameter(shown, "fixed_iterations") != NULL;
  json_decref(shown);
  return OK;
}

static status add_method(struct study *s, const struct names *all, const char *name)
{
  int number;
  TRY(solver_number(all, name, &number));
  for (int k = 0; k < s->num_methods; k++)
    if (strcmp(s->method[k].name, name) == 0)
      return user_error("--solvers: '%s' is named twice", name);
  if (s->num_methods == MOST_METHODS) return user_error("--solvers: more than %d", MOST_METHODS);
  s->method[s->num_methods++] = (struct method){.name = strdup(name), .colour = number};
  return OK;
}

static status choose_methods(struct study *s, const struct names *all)
{
  status result = OK;
  if (!s->ask.solvers) {
    for (int k = 0; k < all->n && result == OK; k++) result = add_method(s, all, all->name[k]);
    return result;
  }
  char *text = strdup(s->ask.solvers);
  for (char *rest = text, *name; result == OK && rest && (name = strsep(&rest, ","));)
    result = add_method(s, all, name);
  free(text);
  return result;
}

/* --- requests --- */

enum { MOST_WORDS = MOST_TOLERANCES + 8 };
struct words {
  char spacing[32], dt[32], t_end[32], seed[32], made[MOST_WORDS][96];
  char *set[MOST_WORDS + 2 * MOST_SETS];
  int num_made, num_sets;
};

static const char *put_number(char text[32], double value)
{
  snprintf(text, 32, "%.15g", value);
  return text;
}

static void put_set(struct words *w, const char *name, double value)
{
  if (w->num_made == MOST_WORDS) return;
  char *text = w->made[w->num_made++];
  snprintf(text, sizeof w->made[0], "%s=%.9g", name, value);
  w->set[w->num_sets++] = text;
}

int method_iterates(const struct method *m) { return m->num_tolerances > 0 || m->has_fixed; }

/* A solver without tolerances takes about as many more iterations as one of first order would for
 * the factor's third root. */
static double iterations_for(double factor)
{
  const double usual = 10, most = 10000;
  if (!(factor > 0)) return most;
  return fmax(1, round(usual / cbrt(factor)));
}

static void put_effort(struct words *w, const struct method *m, double factor)
{
  const double converged = 1e-10, most = 100000;
  for (int k = 0; k < m->num_tolerances; k++) {
    const struct tolerance *t = &m->tolerance[k];
    const double wanted = factor > 0 ? t->initial * factor : converged;
    put_set(w, t->name, fmin(fmax(wanted, t->low), t->high));
  }
  if (m->num_tolerances == 0 && m->has_fixed)
    put_set(w, "fixed_iterations", iterations_for(factor));
  if (m->num_tolerances > 0 && m->max_iterations > 0 && factor < 1) /* not to be stopped earlier */
    put_set(w, "max_iterations", factor > 0 ? 10 * m->max_iterations : most);
}

static void put_own_sets(const struct study *s, struct words *w)
{
  for (unsigned k = 0; s->file && k < s->file->num_set && k < MOST_SETS; k++)
    w->set[w->num_sets++] = s->file->set[k];
  for (int k = 0; k < s->ask.num_sets; k++) w->set[w->num_sets++] = s->ask.set[k];
}

static struct run_request request_of(const struct study *s, const struct knobs *k, struct words *w)
{
  const struct method *m = &s->method[k->method];
  *w = (struct words){.num_sets = 0};
  struct run_request r = {.scene = s->ask.scene,
                          .solver = m->name,
                          .dim = s->ask.dim,
                          .precision = s->ask.precision,
                          .backend = s->ask.backend,
                          .spacing = put_number(w->spacing, k->spacing)};
  if (k->dt > 0) r.dt = put_number(w->dt, k->dt);
  if (!s->is_projection) r.t_end = put_number(w->t_end, s->plan.t_end);
  if (k->seed > 0) r.seed = put_number(w->seed, (double)k->seed);
  put_own_sets(s, w);
  if (k->jitter > 0) put_set(w, "jitter", k->jitter);
  if (k->iterations > 0)
    put_set(w, "fixed_iterations", k->iterations);
  else if (k->factor != 1)
    put_effort(w, m, k->factor);
  r.set = w->set;
  return r;
}

status study_add(const struct study *s, const struct knobs *knobs, struct queue *queue, int *number)
{
  struct words words;
  struct run_request request = request_of(s, knobs, &words);
  request.num_sets = words.num_sets;
  request.frames = "1";
  request.count_pairs = 1;
  return queue_add(queue, &request, number);
}

status study_timed(const struct study *s, const struct knobs *knobs, struct run *run)
{
  struct words words;
  struct run_request request = request_of(s, knobs, &words);
  put_set(&words, "samples", 1);
  request.num_sets = words.num_sets;
  *run = (struct run){.argc = 0};
  const status result = run_make(&request, run);
  if (result != OK) run_release(run);
  return result;
}

double study_dt(const struct study *s, double factor, double spacing)
{
  if (s->is_projection) return 0;
  const double wanted = factor * s->dt * spacing / s->spacing;
  return s->plan.t_end / fmax(1, ceil(s->plan.t_end / wanted - 1e-9));
}

/* --- which solvers can --- */

/* Ask for the coarsest run without running it. */
static status check_method(struct study *s, int number, const char *log)
{
  struct run run;
  double coarsest = s->spacing;
  for (int k = 0; k < s->plan.spacing.n; k++) coarsest = fmax(coarsest, s->plan.spacing.value[k]);
  const struct knobs knobs = {
    .method = number, .spacing = coarsest, .dt = study_dt(s, 1, coarsest), .factor = 1};
  TRY(study_timed(s, &knobs, &run));
  const char **argv = calloc((size_t)run.argc + 3, sizeof *argv);
  status result = argv ? OK : status_set(ERR_MEMORY, "out of memory");
  if (argv) {
    argv[0] = run.executable.text;
    for (int k = 0; k < run.argc; k++) argv[1 + k] = run.argv[k];
    argv[1 + run.argc] = "--dry-run";
    const struct process process = {.argv = argv, .log = log, .one_thread = 1};
    int code = 0;
    result = process_wait(&process, &code);
    if (result == OK && code != 0) s->method[number].refusal = run_last_words(log);
  }
  free(argv);
  run_release(&run);
  return result;
}

static status check_methods(struct study *s)
{
  const struct path folder = path_of("%s/precision", s->ask.results);
  const struct path log = path_of("%s/check-%d.tmp", folder.text, (int)getpid());
  int able = 0;
  TRY(folder_make(folder.text));
  status result = OK;
  for (int k = 0; k < s->num_methods && result == OK; k++) {
    result = check_method(s, k, log.text);
    able += !s->method[k].refusal;
  }
  unlink(log.text);
  if (result != OK || able > 0) return result;
  return user_error("%s: no solver can run this: %s", s->ask.verb, s->method[0].refusal);
}

/* --- opening --- */

static status learn(struct study *s)
{
  struct path executable;
  struct names all;
  TRY(variant_of(&s->ask, &executable));
  TRY(learn_scene(s, &executable));
  TRY(study_file_read(s));
  TRY(solver_names(&all));
  status result = choose_methods(s, &all);
  names_free(&all);
  for (int k = 0; k < s->num_methods && result == OK; k++)
    result = learn_method(&s->method[k], &executable);
  return result == OK ? check_methods(s) : result;
}

status study_open(struct study *s, const struct study_request *ask)
{
  *s = (struct study){.ask = *ask};
  if (!ask->scene)
    return user_error("%s: SCENE is missing; 'sphbench list scenes' lists them", ask->verb);
  const status result = learn(s);
  if (result != OK) study_close(s);
  return result;
}

void study_close(struct study *s)
{
  for (int k = 0; k < s->num_methods; k++) {
    for (int t = 0; t < s->method[k].num_tolerances; t++) free(s->method[k].tolerance[t].name);
    free(s->method[k].name);
    free(s->method[k].refusal);
  }
  s->num_methods = 0;
  yaml_source_free(s->source, s->file);
  s->source = NULL;
  s->file = NULL;
  json_decref(s->scene);
  s->scene = NULL;
  json_decref(s->metrics);
  s->metrics = NULL;
}

const char *study_error_about(const struct study *s)
{
  size_t k;
  json_t *row;
  json_array_foreach(s->metrics, k, row)
  {
    const char *name = json_string_value(json_object_get(row, "name"));
    const char *about = json_string_value(json_object_get(row, "about"));
    if (name && about && strcmp(name, s->error) == 0) return about;
  }
  return s->error;
}

status values_parse(const char *flag, const char *text, struct values *values)
{
  if (!text) return OK;
  values->n = 0;
  for (const char *at = text;;) {
    char *end;
    const double value = strtod(at, &end);
    if (end == at || !(value > 0) || !isfinite(value) || (*end && *end != ','))
      return user_error("%s: '%s' found, allowed are numbers above 0 with commas between", flag,
                        text);
    if (values->n == MOST_VALUES)
      return user_error("%s: more than %d numbers found", flag, MOST_VALUES);
    values->value[values->n++] = value;
    if (!*end) return OK;
    at = end + 1;
  }
}

status value_parse(const char *flag, const char *text, double *value)
{
  struct values one;
  if (!text) return OK;
  TRY(values_parse(flag, text, &one));
  if (one.n != 1) return user_error("%s: '%s' found, one number expected", flag, text);
  *value = one.value[0];
  return OK;
}
