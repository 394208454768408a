#include "result_facts.h"

#include <stdio.h>

enum { SERIES_CHUNK = 128 /* rows */ };

static const char *const status_words[NUM_RUN_STATUS] = {
#define S(name, json, file) file,
  RUN_STATUS_LIST(S)
#undef S
};

/* A group of the file, by its full path; made where it is missing. */
static hid_t group_at(struct h5 *h, const char *path)
{
  if (h->error) return -1;
  if (H5Lexists(h->file, path, H5P_DEFAULT) > 0)
    return h5_check(h, H5Gopen2(h->file, path, H5P_DEFAULT));
  return h5_group(h, h->file, path);
}

static void put_facts(struct h5 *h, const char *path, int n, const struct fact *facts)
{
  if (n == 0) return;
  const hid_t group = group_at(h, path);
  for (int i = 0; i < n; i++) {
    const struct h5_label label = {facts[i].name, facts[i].unit, facts[i].about};
    if (facts[i].word)
      h5_put_texts(h, group, label, 0, &facts[i].word);
    else
      h5_put_number(h, group, label, facts[i].value);
  }
  H5Gclose(group);
}

static void put_provenance(struct h5 *h, const struct provenance *p)
{
  const hid_t group = group_at(h, "/run/provenance");
  h5_attribute_text(h, group, "commit", p->commit);
  h5_attribute_text(h, group, "dirty", p->dirty ? "yes" : "no");
  h5_attribute_text(h, group, "compiler", p->compiler);
  h5_attribute_text(h, group, "flags", p->flags);
  for (int i = 0; i < p->num_libraries; i++) {
    char name[64];
    snprintf(name, sizeof name, "library_%s", p->libraries[i][0]);
    h5_attribute_text(h, group, name, p->libraries[i][1]);
  }
  H5Gclose(group);
}

/* All that may differ between two identical runs is in /run/volatile, so that the rest can be
 * compared bit for bit. */
static void put_circumstances(struct h5 *h, const struct provenance *p)
{
  const hid_t group = group_at(h, "/run/volatile");
  h5_attribute_text(h, group, "date", p->date);
  if (*p->cpu) h5_attribute_text(h, group, "cpu", p->cpu);
  if (*p->gpu) h5_attribute_text(h, group, "gpu", p->gpu);
  h5_put_integer(h, group, (struct h5_label){"threads", "1", "threads of the run"}, p->threads);
  if (p->argc > 0)
    h5_put_texts(h, group, (struct h5_label){"argv", "1", "the command"}, p->argc, p->argv);
  H5Gclose(group);
}

static void put_status(struct h5 *h, hid_t run, enum run_status status, const char *reason)
{
  h5_attribute_text(h, run, "status", status_words[status]);
  h5_attribute_text(h, run, "reason", reason);
}

void result_facts_start(struct h5 *h, const struct run_facts *facts)
{
  const hid_t run = group_at(h, "/run");
  h5_attribute_text(h, run, "scene", facts->scene);
  h5_attribute_text(h, run, "solver", facts->solver);
  h5_attribute_text(h, run, "variant", facts->variant);
  h5_put_integer(h, run, (struct h5_label){"dim", "1", "dimensions of space"}, facts->dim);
  put_status(h, run, RUN_RUNNING, NULL);
  put_facts(h, "/run/parameters", facts->num_parameters, facts->parameters);
  if (facts->num_warnings > 0)
    h5_put_texts(h, run, (struct h5_label){"warnings", "1", "what was told before the run"},
                 facts->num_warnings, facts->warnings);
  if (facts->provenance) {
    put_provenance(h, facts->provenance);
    put_circumstances(h, facts->provenance);
  }
  H5Gclose(run);
}

static void put_table(struct h5 *h, const char *path, const struct fact_table *table)
{
  if (table->num_columns == 0) return;
  const hid_t group = group_at(h, path);
  for (int c = 0; c < table->num_columns && !h->error; c++) {
    const struct fact_column *column = &table->columns[c];
    const struct h5_label label = {column->name, column->unit, column->about};
    const hid_t data = H5Lexists(group, column->name, H5P_DEFAULT) > 0
                         ? h5_check(h, H5Dopen2(group, column->name, H5P_DEFAULT))
                         : h5_column(h, group, label, H5T_IEEE_F64LE, 0, SERIES_CHUNK, 0);
    const hid_t space = H5Dget_space(data);
    const long long there = H5Sget_simple_extent_npoints(space);
    H5Sclose(space);
    if (table->rows > there)
      h5_append(h, data, there, table->rows - there, H5T_NATIVE_DOUBLE, column->values + there);
    H5Dclose(data);
  }
  H5Gclose(group);
}

void result_facts_series(struct h5 *h, const struct run_facts *facts)
{
  if (facts->series.num_columns + facts->per_step.num_columns == 0) return;
  H5Gclose(group_at(h, "/metrics"));
  put_table(h, "/metrics", &facts->series);
  put_table(h, "/metrics/steps", &facts->per_step);
}

static void put_totals(struct h5 *h, hid_t run, const struct run_facts *facts)
{
  const struct {
    const char *name, *about;
    long value;
  } counts[] = {{"steps", "time steps done", facts->steps},
                {"particles", "fluid particles at the end", facts->particles},
                {"walls", "wall particles", facts->walls},
                {"iterations_max", "most solver iterations in a step", facts->iterations.max},
                {"iterations_total", "solver iterations of all steps", facts->iterations.total}};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    h5_put_integer(h, run, (struct h5_label){counts[i].name, "1", counts[i].about},
                   counts[i].value);
  h5_put_number(h, run, (struct h5_label){"iterations_mean", "1", "solver iterations per step"},
                facts->iterations.mean);
  for (int k = 0; k < facts->iterations.num_solves; k++) {
    const struct fact_solve *solve = &facts->iterations.solve[k];
    char name[64];
    snprintf(name, sizeof name, "iterations_%s_mean", solve->name);
    h5_put_number(h, run, (struct h5_label){name, "1", "iterations of these solves per step"},
                  solve->mean);
  }
  h5_put_number(h, run,
                (struct h5_label){"residual_last", "1", "relative residual of the last solve"},
                facts->residual_last);
  if (facts->pairs_visited > 0)
    h5_put_number(h, run,
                  (struct h5_label){"pairs_visited", "1", "neighbour pairs, by all sums over them"},
                  facts->pairs_visited);
  h5_put_number(h, run, (struct h5_label){"time_end", "s", "simulated time reached"},
                facts->time_end);
}

static void put_costs(struct h5 *h, const struct run_facts *facts)
{
  const struct fact totals[] = {
    {.name = "total", .unit = "s", .about = "wall time of the run", .value = facts->timing.total},
    {.name = "per_step",
     .unit = "s",
     .about = "wall time per time step",
     .value = facts->timing.per_step},
    {.name = "per_iteration",
     .unit = "s",
     .about = "solver's wall time per iteration",
     .value = facts->timing.per_iteration}};
  const struct fact size = {.name = "bytes_per_particle",
                            .unit = "B",
                            .about = "particle memory, pair lists included, per particle",
                            .value = facts->memory.bytes_per_particle};
  const struct fact peak = {.name = "peak_rss",
                            .unit = "B",
                            .about = "most memory that the process held",
                            .value = (double)facts->memory.peak_rss_bytes};
  H5Gclose(group_at(h, "/run/volatile"));
  put_facts(h, "/run/volatile", 1, &peak);
  put_facts(h, "/run/volatile/timing", 3, totals);
  put_facts(h, "/run/volatile/timing", facts->timing.num_phases, facts->timing.phases);
  put_facts(h, "/run/memory", 1, &size);
  put_facts(h, "/run/memory/fields", facts->memory.num_fields, facts->memory.fields);
}

/* The criteria that the run came to break, one row each. */
static void put_judged(struct h5 *h, const struct run_facts *facts)
{
  enum { MOST = 16 };
  const char *words[MOST], *units[MOST];
  double time[MOST], value[MOST], limit[MOST];
  const int n = facts->num_judged < MOST ? facts->num_judged : MOST;
  if (n == 0) return;
  for (int i = 0; i < n; i++) {
    const struct judged *j = &facts->judged[i];
    words[i] = j->criterion;
    units[i] = j->unit;
    time[i] = j->time;
    value[i] = j->value;
    limit[i] = j->limit;
  }
  const struct {
    struct h5_label label;
    const double *data;
  } columns[] = {{{"time", "s", "when it first held"}, time},
                 {{"value", "see unit", "what was found then"}, value},
                 {{"limit", "see unit", "what is allowed"}, limit}};
  const hid_t group = group_at(h, "/run/judged");
  h5_put_texts(h, group, (struct h5_label){"criterion", "1", "that the run broke"}, n, words);
  h5_put_texts(h, group, (struct h5_label){"unit", "1", "of value and limit"}, n, units);
  for (size_t k = 0; k < sizeof columns / sizeof *columns; k++)
    h5_put(
      h, group, columns[k].label,
      (struct h5_array){H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, 1, {(hsize_t)n, 0}, columns[k].data});
  H5Gclose(group);
}

void result_facts_end(struct h5 *h, const struct run_facts *facts)
{
  const hid_t run = group_at(h, "/run");
  put_totals(h, run, facts);
  put_costs(h, facts);
  put_judged(h, facts);
  if (facts->num_metrics) {
    H5Gclose(group_at(h, "/metrics"));
    put_facts(h, "/metrics/final", facts->num_metrics, facts->metrics);
  }
  put_status(h, run, facts->status, facts->reason);
  H5Gclose(run);
}
