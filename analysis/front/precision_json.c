/* Everything that was measured, and what follows from it, as JSON. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "json_out.h"
#include "precision.h"

const double precision_targets[NUM_TARGETS] = {0.1, 0.03, 0.01};
const double precision_density_targets[NUM_TARGETS] = {0.01, 0.001, 0.0001};

static json_t *text_or_null(const char *text) { return text ? json_string(text) : json_null(); }

/* --- points --- */

static int is_knob(const char *name)
{
  static const char *const names[] = {"spacing", "dt", "t_end", "fixed_iterations",
                                      "max_iterations"};
  const size_t length = strlen(name);
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    if (strcmp(name, names[k]) == 0) return 1;
  return (length > 8 && strcmp(name + length - 9, "tolerance") == 0) || !strncmp(name, "warm", 4);
}

static json_t *knobs_json(const struct point *point)
{
  json_t *parameters = json_object_get(point->facts, "parameters"), *value;
  json_t *object = json_object();
  const char *name;
  json_object_set_new(object, "spacing", json_out_number(point->knobs.spacing));
  if (point->knobs.dt > 0) json_object_set_new(object, "dt", json_out_number(point->knobs.dt));
  json_object_set_new(object, "tolerance_factor", json_out_number(point->knobs.factor));
  json_object_foreach(parameters, name, value)
  {
    if (is_knob(name)) json_object_set(object, name, value);
  }
  return object;
}

static void set_times(json_t *object, const struct precision *p, const struct point *point, int arm)
{
  struct interval time = point->time;
  if (arm > 0 && isfinite(time.median)) {
    double *copy = malloc(sizeof *copy * (size_t)p->repeat);
    if (copy) memcpy(copy, point->seconds[arm], sizeof *copy * (size_t)p->repeat);
    if (copy) time = interval_of_median(copy, (int)p->repeat);
    free(copy);
  }
  json_object_set_new(object, "time", json_out_number(time.median));
  json_object_set_new(object, "time_low", json_out_number(time.low));
  json_object_set_new(object, "time_high", json_out_number(time.high));
  json_object_set_new(object, "time_coverage", json_out_number(time.coverage));
  json_object_set_new(object, "repetitions", json_integer(point->taken[arm]));
  json_object_set_new(object, "setup", json_out_number(point->setup_median));
}

static json_t *point_json(const struct precision *p, const struct point *point, int arm)
{
  const struct candidate c = {point->knobs.method + arm * MOST_METHODS, 0, 0, 0, 0, 0};
  const struct path name = candidate_name(p, &c);
  json_t *object =
    json_pack("{s:s, s:o, s:o, s:s}", "solver", name.text, "parameters", knobs_json(point), "error",
              json_out_number(point->error), "error_kind", kind_words[point->kind]);
  set_times(object, p, point, arm);
  json_object_set_new(object, "pairs", json_out_number(point->visits));
  json_object_set_new(object, "density_error", json_out_number(point->density_error));
  json_object_set_new(object, "iterations",
                      json_out_number(fact_number(point->facts, "iterations.mean")));
  json_object_set_new(object, "residual",
                      json_out_number(fact_number(point->facts, "residual.last")));
  json_object_set_new(object, "particles", json_out_number(fact_number(point->facts, "particles")));
  json_object_set_new(object, "steps", json_out_number(fact_number(point->facts, "steps")));
  json_object_set_new(object, "valid", json_boolean(!point->reason));
  json_object_set_new(object, "reason", text_or_null(point->reason));
  json_object_set_new(object, "note", text_or_null(point->note));
  json_object_set_new(object, "run", json_string(p->queue.run[point->run].id));
  return object;
}

static json_t *points_json(const struct precision *p)
{
  json_t *array = json_array();
  for (int arm = 0; arm < (p->aa ? ARMS : 1); arm++)
    for (int k = 0; k < p->n; k++) json_array_append_new(array, point_json(p, &p->point[k], arm));
  return array;
}

static json_t *fronts_json(const struct precision *p, int by_pairs)
{
  json_t *object = json_object();
  for (int m = 0; m < p->study.num_methods; m++) {
    json_t *list = json_array();
    for (int k = 0; k < p->n; k++) {
      const struct point *point = &p->point[k];
      const int on = by_pairs ? point->on_pairs_front : point->on_front;
      if (point->knobs.method == m && on) json_array_append_new(list, json_integer(k));
    }
    if (json_array_size(list) > 0) json_object_set(object, p->study.method[m].name, list);
    json_decref(list);
  }
  return object;
}

/* --- tables --- */

struct path candidate_name(const struct precision *p, const struct candidate *c)
{
  const char *name = p->study.method[c->solver % MOST_METHODS].name;
  return path_of(c->solver < MOST_METHODS ? "%s" : "%s (again)", name);
}

double precision_finest(const struct precision *p)
{
  double finest = HUGE_VAL;
  for (int k = 0; k < p->n; k++) finest = fmin(finest, p->point[k].knobs.spacing);
  return finest;
}

int precision_candidates(const struct precision *p, double spacing, struct candidate *all)
{
  int n = 0;
  for (int k = 0; k < p->n; k++) {
    const struct point *point = &p->point[k];
    if (point->reason || !isfinite(point->time.median)) continue;
    if (spacing > 0 && point->knobs.spacing > 1.000001 * spacing) continue;
    const double error = spacing > 0 ? point->density_error : point->error;
    for (int arm = 0; arm < (p->aa ? ARMS : 1); arm++) {
      struct interval time = point->time;
      double copy[256];
      if (arm > 0) {
        memcpy(copy, point->seconds[arm], sizeof *copy * (size_t)p->repeat);
        time = interval_of_median(copy, (int)p->repeat);
      }
      all[n++] = (struct candidate){
        point->knobs.method + arm * MOST_METHODS, k, error, time.median, time.low, time.high};
    }
  }
  return n;
}

static json_t *ranking_json(const struct precision *p, const struct candidate *best, int n)
{
  json_t *array = json_array();
  for (int k = 0; k < n; k++) {
    const struct candidate *c = &best[k];
    const struct path name = candidate_name(p, c);
    const double slower = k > 0 ? slower_by(&best[0], c, p->floor) : 0;
    json_array_append_new(array,
                          json_pack("{s:s, s:i, s:f, s:f, s:f, s:f, s:o}", "solver", name.text,
                                    "point", c->point, "error", c->error, "time", c->time,
                                    "time_low", c->low, "time_high", c->high, "slower_by",
                                    slower > 0 ? json_real(slower) : json_null()));
  }
  return array;
}

/* One line per target: the cheapest solver, and the factor to the next. */
static json_t *table_json(const struct precision *p, double spacing, const double *targets)
{
  struct candidate *all = calloc((size_t)(ARMS * p->n) + 1, sizeof *all);
  struct candidate *best = calloc((size_t)(ARMS * p->n) + 1, sizeof *best);
  json_t *table = json_array();
  for (int t = 0; all && best && t < NUM_TARGETS; t++) {
    const int found = precision_candidates(p, spacing, all);
    const int n = rank_cheapest(all, found, targets[t], best);
    const struct path winner = n > 0 ? candidate_name(p, &best[0]) : path_of("%s", "");
    const double factor = n > 1 ? slower_by(&best[0], &best[1], p->floor) : 0;
    const struct path words = path_of("%.3g times", factor);
    json_array_append_new(
      table, json_pack("{s:f, s:o, s:o, s:s, s:o}", "target", targets[t], "cheapest",
                       n > 0 ? json_string(winner.text) : json_null(), "factor_to_next",
                       factor > 0 ? json_real(factor) : json_null(), "difference",
                       n == 0       ? "no solver gets there"
                       : n == 1     ? "no other gets there"
                       : factor > 0 ? words.text
                                    : "none",
                       "ranking", ranking_json(p, best, n)));
  }
  free(all);
  free(best);
  return table;
}

/* --- the rest --- */

static json_t *refused_json(const struct precision *p)
{
  json_t *array = json_array();
  for (int k = 0; k < p->study.num_methods; k++)
    if (p->study.method[k].refusal)
      json_array_append_new(array, json_pack("{s:s, s:s}", "solver", p->study.method[k].name,
                                             "reason", p->study.method[k].refusal));
  return array;
}

static json_t *warm_json(const struct precision *p)
{
  json_t *object = json_object();
  for (int k = 0; k < p->n; k++) {
    json_t *warm = json_object(), *value;
    const char *name;
    json_object_foreach(json_object_get(p->point[k].facts, "parameters"), name, value)
    {
      if (strncmp(name, "warm", 4) == 0) json_object_set(warm, name, value);
    }
    if (!json_object_get(object, point_solver(p, &p->point[k])) && p->point[k].facts)
      json_object_set(object, point_solver(p, &p->point[k]), warm);
    json_decref(warm);
  }
  return object;
}

static json_t *origin_json(const struct precision *p)
{
  static const char *const keys[] = {"commit", "dirty", "compiler", "flags", "cpu"};
  json_t *origin = json_object(), *provenance = NULL;
  char date[32];
  const time_t now = time(NULL);
  struct tm utc;
  for (int k = 0; k < p->n && !provenance; k++)
    provenance = json_object_get(p->point[k].facts, "provenance");
  for (size_t k = 0; provenance && k < sizeof keys / sizeof *keys; k++)
    json_object_set(origin, keys[k], json_object_get(provenance, keys[k]));
  strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  json_object_set_new(origin, "date", json_string(date));
  json_object_set_new(origin, "threads", json_integer(p->threads));
  json_object_set_new(origin, "load_before", json_real(p->load));
  json_object_set_new(origin, "others", json_out_number(p->others / p->wall));
  return origin;
}

static json_t *whole(const struct precision *p)
{
  const struct study *s = &p->study;
  json_t *object = json_pack("{s:s, s:b, s:b, s:{s:s, s:s, s:s}, s:o, s:o, s:{s:f, s:s}}", "scene",
                             s->ask.scene, "quick", s->ask.quick, "aa", p->aa, "error", "metric",
                             p->kind == KIND_TOTAL || p->kind == KIND_SPATIAL ? s->error
                             : s->is_projection ? "distance of velocities"
                                                : "distance of positions",
                             "kind", kind_words[p->kind], "meaning", kind_meanings[p->kind],
                             "points", points_json(p), "fronts", fronts_json(p, 0), "noise",
                             "floor", p->floor, "means", p->floor_means);
  if (p->kind == KIND_TOTAL || p->kind == KIND_SPATIAL)
    json_object_set_new(json_object_get(object, "error"), "about",
                        json_string(study_error_about(s)));
  json_object_set_new(object, "pairs_fronts", fronts_json(p, 1));
  json_object_set_new(object, "table", table_json(p, 0, precision_targets));
  json_object_set_new(object, "density_table",
                      json_pack("{s:f, s:o}", "spacing", precision_finest(p), "table",
                                table_json(p, precision_finest(p), precision_density_targets)));
  json_object_set(object, "fairness", p->fairness);
  json_object_set_new(object, "warm_start", warm_json(p));
  json_object_set_new(object, "refused", refused_json(p));
  json_object_set_new(object, "limit", json_real(p->queue.limit));
  json_object_set_new(object, "origin", origin_json(p));
  return object;
}

status precision_write(const struct precision *p, const char *also)
{
  const struct path path = path_of("%s/precision.json", p->folder.text);
  return json_out_finish(whole(p), path.text, also);
}
