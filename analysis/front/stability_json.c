/* What was found, for machines and for people. */
#include <math.h>
#include <string.h>

#include "json_out.h"
#include "stability.h"

static json_t *word_of(enum verdict v)
{
  return v == VERDICT_STABLE ? json_null() : json_string(verdict_words[v]);
}

static json_t *prediction_json(const struct prediction *p)
{
  return json_pack("{s:o, s:o, s:o}", "cfl", json_out_number(p->cfl), "sound",
                   json_out_number(p->sound), "viscous", json_out_number(p->viscous));
}

static json_t *trial_json(const struct stability *s, const struct trial *t)
{
  const struct run *run = &s->queue.run[t->run];
  return json_pack(
    "{s:f, s:I, s:o, s:o, s:i, s:o, s:s, s:s}", "dt", t->dt, "seed", (json_int_t)t->seed, "failed",
    word_of(t->first), "time", json_out_number(t->time), "leaks", t->leaks, "speed_max",
    json_out_number(t->speed_max), "run", run->id, "said", run->reason ? run->reason : "");
}

static json_t *trials_json(const struct stability *s, int method, int row)
{
  json_t *list = json_array();
  for (int k = 0; k < s->n; k++)
    if (s->trial[k].method == method && s->trial[k].row == row)
      json_array_append_new(list, trial_json(s, &s->trial[k]));
  return list;
}

static double stable_dt(const struct candidate_solver *c)
{
  return c->stable > 0 ? c->stable : (double)NAN;
}

/* reason: why a step that is 5 % longer fails; null where none that was tried does. */
static json_t *limit_json(const struct stability *s, int m)
{
  const struct candidate_solver *c = &s->solver[m];
  const struct prediction *p = &c->predicted;
  json_t *limit =
    json_pack("{s:s, s:o, s:o, s:o}", "solver", c->name, "dt_max", json_out_number(stable_dt(c)),
              "reason", word_of(c->failed < HUGE_VAL ? c->reason : VERDICT_STABLE), "predicted",
              json_out_number(p->least));
  json_object_set_new(limit, "predicted_by", p->by ? json_string(p->by) : json_null());
  json_object_set_new(limit, "ratio", json_out_number(stable_dt(c) / p->least));
  json_object_set_new(limit, "dt_failed", json_out_number(c->failed));
  json_object_set_new(limit, "leaks", json_integer(c->leaks));
  json_object_set_new(limit, "speed_max",
                      json_out_number(c->stable > 0 ? c->speed_max : (double)NAN));
  json_object_set_new(limit, "predictions", prediction_json(p));
  json_object_set_new(limit, "trials", trials_json(s, m, -1));
  return limit;
}

static json_t *limits_json(const struct stability *s)
{
  json_t *list = json_array();
  for (int m = 0; m < s->num_solvers; m++)
    if (!s->solver[m].refusal) json_array_append_new(list, limit_json(s, m));
  return list;
}

static json_t *refused_json(const struct stability *s)
{
  json_t *list = json_array();
  for (int m = 0; m < s->num_solvers; m++)
    if (s->solver[m].refusal)
      json_array_append_new(
        list, json_pack("{s:s, s:s}", "solver", s->solver[m].name, "reason", s->solver[m].refusal));
  return list;
}

static json_t *cell_json(const struct stability *s, const struct trial *t)
{
  return json_pack("{s:s, s:s, s:f, s:s, s:o, s:o, s:i}", "solver", s->solver[t->method].name,
                   "value", s->map.value[t->row], "dt", t->dt, "worst", verdict_words[t->verdict],
                   "first", word_of(t->first), "time", json_out_number(t->time), "leaks", t->leaks);
}

static json_t *map_json(const struct stability *s)
{
  json_t *cells = json_array(), *lines = json_array(), *dts = json_array(), *values = json_array();
  if (!s->map.key) {
    json_decref(cells);
    json_decref(lines);
    json_decref(dts);
    json_decref(values);
    return json_null();
  }
  for (int k = 0; k < s->map.dts.n; k++) json_array_append_new(dts, json_real(s->map.dts.value[k]));
  for (int row = 0; row < s->map.rows; row++)
    json_array_append_new(values, json_string(s->map.value[row]));
  for (int k = 0; k < s->n; k++)
    if (s->trial[k].row >= 0) json_array_append_new(cells, cell_json(s, &s->trial[k]));
  for (int m = 0; m < s->num_solvers; m++)
    for (int row = 0; row < s->map.rows && !s->solver[m].refusal; row++) {
      const struct prediction p = predict_row(s, m, row);
      json_array_append_new(lines,
                            json_pack("{s:s, s:s, s:o, s:o}", "solver", s->solver[m].name, "value",
                                      s->map.value[row], "dt", json_out_number(p.least), "by",
                                      p.by ? json_string(p.by) : json_null()));
    }
  return json_pack("{s:s, s:o, s:o, s:o, s:o}", "key", s->map.key, "values", values, "dts", dts,
                   "cells", cells, "predicted", lines);
}

static json_t *ignored_json(const struct stability *s)
{
  json_t *list = json_array();
  for (int k = 0; k < NUM_VERDICTS; k++)
    if (s->ignored >> k & 1u) json_array_append_new(list, json_string(verdict_words[k]));
  return list;
}

status stability_write(const struct stability *s, const char *also)
{
  const struct path own = path_of("%s/stability.json", s->folder.text);
  json_t *object =
    json_pack("{s:s, s:o, s:o, s:o, s:f, s:I, s:o}", "scene", s->scene, "limits", limits_json(s),
              "map", map_json(s), "not_run", refused_json(s), "jitter", s->jitter, "seeds",
              (json_int_t)s->num_seeds, "ignored", ignored_json(s));
  return json_out_finish(object, own.text, also);
}

/* --- for people --- */

static void say_limit(const struct candidate_solver *c)
{
  printf("  %-14s ", c->name);
  if (c->stable > 0)
    printf("%10.4g s", c->stable);
  else
    printf("%12s", "none");
  printf("  %-12s", c->failed < HUGE_VAL ? verdict_words[c->reason] : "(not found)");
  if (c->predicted.by && c->stable > 0)
    printf("  %10.4g s by %-8s %8.3g", c->predicted.least, c->predicted.by,
           c->stable / c->predicted.least);
  else
    printf("  %12s", "-");
  if (c->leaks > 0) printf("  %d leaked", c->leaks);
  printf("\n");
}

void stability_say(const struct stability *s)
{
  if (s->quiet) return;
  printf(
    "%s, %ld seeds, jitter %g dx: the largest stable time step, what fails 5 %% beyond, theory, "
    "their ratio\n",
    s->scene, s->num_seeds, s->jitter);
  for (int m = 0; m < s->num_solvers; m++)
    if (s->solver[m].refusal)
      printf("  %-14s not run: %s\n", s->solver[m].name, s->solver[m].refusal);
    else
      say_limit(&s->solver[m]);
}
