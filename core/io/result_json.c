#include "result_json.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "out_path.h"

static const char *const status_words[NUM_RUN_STATUS] = {
#define S(name, json, file) json,
  RUN_STATUS_LIST(S)
#undef S
};

/* JSON has no NaN and no infinity. */
static json_t *number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

/* Text of unknown encoding (an argument, say): what is not UTF-8 is shown with ? for every byte
 * past ASCII. */
static json_t *text(const char *bytes)
{
  if (!bytes) return json_null();
  json_t *value = json_string(bytes);
  if (value) return value;
  char *ascii = strdup(bytes);
  if (!ascii) return NULL;
  for (char *c = ascii; *c; c++)
    if ((unsigned char)*c > 127) *c = '?';
  value = json_string(ascii);
  free(ascii);
  return value;
}

static json_t *fact_value(const struct fact *fact)
{
  return fact->word ? text(fact->word) : number(fact->value);
}

static json_t *values_of(int n, const struct fact *facts)
{
  json_t *object = json_object();
  for (int i = 0; i < n; i++) json_object_set_new(object, facts[i].name, fact_value(&facts[i]));
  return object;
}

static json_t *units_of(int n, const struct fact *facts)
{
  json_t *object = json_object();
  for (int i = 0; i < n; i++) json_object_set_new(object, facts[i].name, text(facts[i].unit));
  return object;
}

static json_t *metrics(const struct run_facts *facts)
{
  json_t *object = json_object();
  for (int i = 0; i < facts->num_metrics; i++) {
    const struct fact *metric = &facts->metrics[i];
    json_object_set_new(
      object, metric->name,
      json_pack("{s:o, s:o}", "value", fact_value(metric), "unit", text(metric->unit)));
  }
  return object;
}

static json_t *warnings(const struct run_facts *facts)
{
  json_t *list = json_array();
  for (int i = 0; i < facts->num_warnings; i++)
    json_array_append_new(list, text(facts->warnings[i]));
  return list;
}

static json_t *judged(const struct run_facts *facts)
{
  json_t *list = json_array();
  for (int i = 0; i < facts->num_judged; i++) {
    const struct judged *j = &facts->judged[i];
    json_array_append_new(list, json_pack("{s:s, s:o, s:o, s:o, s:s}", "criterion", j->criterion,
                                          "time", number(j->time), "value", number(j->value),
                                          "limit", number(j->limit), "unit", j->unit));
  }
  return list;
}

static json_t *series(const struct fact_table *table)
{
  json_t *object = json_object();
  for (int c = 0; c < table->num_columns; c++) {
    json_t *values = json_array();
    for (long i = 0; i < table->rows; i++)
      json_array_append_new(values, number(table->columns[c].values[i]));
    json_object_set_new(object, table->columns[c].name, values);
  }
  return object;
}

static json_t *timing(const struct run_facts *facts)
{
  json_t *object = json_object();
  json_object_set_new(object, "total", number(facts->timing.total));
  for (int i = 0; i < facts->timing.num_phases; i++)
    json_object_set_new(object, facts->timing.phases[i].name,
                        number(facts->timing.phases[i].value));
  json_object_set_new(object, "per_step", number(facts->timing.per_step));
  json_object_set_new(object, "per_iteration", number(facts->timing.per_iteration));
  return object;
}

static json_t *memory(const struct run_facts *facts)
{
  json_t *fields = json_array();
  for (int i = 0; i < facts->memory.num_fields; i++)
    json_array_append_new(fields,
                          json_pack("{s:s, s:o}", "name", facts->memory.fields[i].name,
                                    "bytes_per_particle", number(facts->memory.fields[i].value)));
  return json_pack("{s:o, s:I, s:o}", "bytes_per_particle",
                   number(facts->memory.bytes_per_particle), "peak_rss_bytes",
                   (json_int_t)facts->memory.peak_rss_bytes, "fields", fields);
}

static json_t *provenance(const struct provenance *p)
{
  json_t *libraries = json_object(), *argv = json_array();
  for (int i = 0; i < p->num_libraries; i++)
    json_object_set_new(libraries, p->libraries[i][0], text(p->libraries[i][1]));
  for (int i = 0; i < p->argc; i++) json_array_append_new(argv, text(p->argv[i]));
  json_t *object =
    json_pack("{s:o, s:b, s:o, s:o, s:o, s:i, s:o, s:o, s:o}", "commit", text(p->commit), "dirty",
              p->dirty, "compiler", text(p->compiler), "flags", text(p->flags), "cpu", text(p->cpu),
              "threads", p->threads, "libraries", libraries, "date", text(p->date), "argv", argv);
  if (*p->gpu) json_object_set_new(object, "gpu", text(p->gpu));
  return object;
}

static json_t *solves(const struct run_facts *f)
{
  json_t *object = json_object();
  for (int k = 0; k < f->iterations.num_solves; k++) {
    const struct fact_solve *s = &f->iterations.solve[k];
    json_object_set_new(object, s->name,
                        json_pack("{s:o, s:I, s:I, s:I, s:I}", "mean", number(s->mean), "max",
                                  (json_int_t)s->max, "total", (json_int_t)s->total, "solves",
                                  (json_int_t)s->solves, "capped", (json_int_t)s->capped));
  }
  return object;
}

/* The keys in the order in which a person wants to read them. */
static json_t *whole(const struct run_facts *f)
{
  json_t *object =
    json_pack("{s:o, s:o, s:o, s:i, s:o, s:o, s:I, s:o, s:I, s:I}", "scene", text(f->scene),
              "solver", text(f->solver), "variant", text(f->variant), "dim", f->dim, "status",
              text(status_words[f->status]), "reason", text(f->reason), "steps",
              (json_int_t)f->steps, "time_end", number(f->time_end), "particles",
              (json_int_t)f->particles, "walls", (json_int_t)f->walls);
  json_object_set_new(object, "period",
                      json_pack("[f, f, f]", f->period[0], f->period[1], f->period[2]));
  json_object_set_new(object, "parameters", values_of(f->num_parameters, f->parameters));
  json_object_set_new(object, "parameter_units", units_of(f->num_parameters, f->parameters));
  json_object_set_new(object, "warnings", warnings(f));
  json_object_set_new(object, "judged", judged(f));
  json_object_set_new(object, "speed_max", number(f->speed_max));
  json_object_set_new(object, "energy_growth", number(f->energy_growth));
  json_object_set_new(object, "iterations",
                      json_pack("{s:o, s:I, s:I, s:o}", "mean", number(f->iterations.mean), "max",
                                (json_int_t)f->iterations.max, "total",
                                (json_int_t)f->iterations.total, "solves", solves(f)));
  json_object_set_new(object, "residual", json_pack("{s:o}", "last", number(f->residual_last)));
  json_object_set_new(object, "pairs",
                      json_pack("{s:o}", "visited",
                                f->pairs_visited > 0 ? json_real(f->pairs_visited) : json_null()));
  json_object_set_new(object, "metrics", metrics(f));
  json_object_set_new(object, "timing", timing(f));
  json_object_set_new(object, "memory", memory(f));
  json_object_set_new(object, "provenance",
                      f->provenance ? provenance(f->provenance) : json_null());
  json_object_set_new(object, "series", series(&f->series));
  return object;
}

/* One line per key: short enough to look at, and to compare by lines. Returns 0, or -1. */
static int print(FILE *file, json_t *object)
{
  const char *key, *before = "{";
  json_t *value;
  json_object_foreach(object, key, value)
  {
    fprintf(file, "%s\n\"%s\": ", before, key);
    if (json_dumpf(value, file, JSON_ENCODE_ANY)) return -1;
    before = ",";
  }
  return fputs("\n}\n", file) < 0 || fflush(file) || ferror(file) ? -1 : 0;
}

static status print_to(const char *path, struct out_path *out, json_t *object)
{
  FILE *file = fopen(out->temp ? out->temp : path, "w");
  if (!file) return out_path_failed(out, errno);
  errno = 0;
  int error = print(file, object) ? (errno ? errno : -1) : 0;
  if (fclose(file) && !error) error = errno;
  return error ? out_path_failed(out, error > 0 ? error : 0) : OK;
}

static status write_object(const char *path, json_t *object)
{
  struct out_path out;
  if (strcmp(path, "-") == 0)
    return print(stdout, object)
             ? status_set(ERR_IO, "cannot write to standard output: %s", strerror(errno))
             : OK;
  TRY(out_path_begin(&out, path, 1));
  status result = print_to(path, &out, object);
  if (result == OK) result = out_path_commit(&out);
  out_path_discard(&out);
  return result;
}

status result_json_write(const char *path, const struct run_facts *facts)
{
  json_t *object = whole(facts);
  if (!object) return status_set(ERR_MEMORY, "out of memory for '%s'", path);
  const status result = write_object(path, object);
  json_decref(object);
  return result;
}
