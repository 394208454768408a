/* Errors and orders as JSON, as data for gnuplot and as pictures. */
#include <stdlib.h>
#include <string.h>

#include "convergence.h"
#include "figure.h"
#include "json_out.h"
#include "variants.h"

static json_t *text_or_null(const char *text) { return text ? json_string(text) : json_null(); }

/* Half the time step may change so much of an error that is called spatial. */
static const char *kind_of(const struct convergence *c, const struct curve *curve)
{
  const double most = 0.1;
  return curve->dt_influence > most ? "total" : c->kind;
}

static const struct curve *curve_of(const struct convergence *c, int method)
{
  for (int k = 0; k < c->num_curves; k++)
    if (c->curve[k].method == method) return &c->curve[k];
  return NULL;
}

static json_t *points_json(const struct convergence *c)
{
  json_t *array = json_array();
  for (int k = 0; k < c->n; k++) {
    const struct trial *t = &c->trial[k];
    json_t *row =
      json_pack("{s:s, s:o, s:o, s:i, s:o, s:s, s:b, s:o, s:s}", "solver",
                c->study.method[t->knobs.method].name, "spacing", json_out_number(t->knobs.spacing),
                "dt", t->knobs.dt > 0 ? json_out_number(t->knobs.dt) : json_null(), "level",
                t->level, "error", t->reason ? json_null() : json_out_number(t->error),
                "error_kind", kind_of(c, curve_of(c, t->knobs.method)), "valid", t->reason == NULL,
                "reason", text_or_null(t->reason), "run", c->queue.run[t->run].id);
    if (t->knobs.seed > 0) json_object_set_new(row, "seed", json_integer(t->knobs.seed));
    json_array_append_new(array, row);
  }
  return array;
}

static json_t *levels_json(const struct convergence *c, const struct curve *curve)
{
  json_t *array = json_array();
  for (int k = 0; k < c->h.n; k++)
    json_array_append_new(
      array, json_pack("{s:f, s:o, s:o, s:o, s:o}", c->over_dt ? "dt" : "spacing",
                       curve->level[k].h, "error", json_out_number(curve->level[k].error),
                       "relative_sd_of_mean", json_out_number(curve->level[k].sd), "local_order",
                       json_out_number(curve->local[k]), "reason", text_or_null(curve->reason[k])));
  return array;
}

static json_t *orders_json(const struct convergence *c)
{
  json_t *array = json_array();
  for (int k = 0; k < c->num_curves; k++) {
    const struct curve *curve = &c->curve[k];
    json_array_append_new(
      array,
      json_pack("{s:s, s:o, s:o, s:o, s:i, s:s, s:o, s:o, s:o}", "solver",
                c->study.method[curve->method].name, "order", json_out_number(curve->fit.order),
                "low", json_out_number(curve->fit.low), "high", json_out_number(curve->fit.high),
                "levels_used", curve->fit.n, "error_kind", kind_of(c, curve), "reason",
                text_or_null(curve->unfit), "dt_influence", json_out_number(curve->dt_influence),
                "levels", levels_json(c, curve)));
  }
  return array;
}

static json_t *refused_json(const struct convergence *c)
{
  json_t *array = json_array();
  for (int k = 0; k < c->study.num_methods; k++)
    if (c->study.method[k].refusal)
      json_array_append_new(array, json_pack("{s:s, s:s}", "solver", c->study.method[k].name,
                                             "reason", c->study.method[k].refusal));
  return array;
}

static json_t *whole(const struct convergence *c)
{
  return json_pack("{s:s, s:s, s:s, s:I, s:f, s:f, s:o, s:o, s:o, s:f}", "scene",
                   c->study.ask.scene, "over", c->over_dt ? "dt" : "spacing", "error",
                   c->over_dt ? "distance from the reference" : c->study.error, "starts",
                   (json_int_t)(c->seeds > 0 ? c->seeds : 1), "jitter", c->jitter, "reference_dt",
                   c->h_reference, "points", points_json(c), "orders", orders_json(c), "refused",
                   refused_json(c), "limit", c->queue.limit);
}

status convergence_write(const struct convergence *c, const char *also)
{
  const struct path path = path_of("%s/convergence.json", c->folder.text);
  return json_out_finish(whole(c), path.text, also);
}

/* --- pictures --- */

static status write_curve(const struct convergence *c, const struct curve *curve, const char *name)
{
  const struct path path = path_of("%s/%s", c->folder.text, name);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fprintf(file.stream, "# columns: %s | error | low | high | fitted\n",
          c->over_dt ? "dt [s]" : "spacing [m]");
  for (int k = 0; k < c->h.n; k++) {
    const struct level *l = &curve->level[k];
    const double r = c->h_reference, p = curve->fit.order;
    const double fitted = exp(curve->fit.level) * (pow(l->h, p) - (r > 0 ? pow(r, p) : 0));
    if (!(l->error > 0)) continue;
    fprintf(file.stream, "%.8g %.8g %.8g %.8g ", l->h, l->error, l->error / (1 + 2 * l->sd),
            l->error * (1 + 2 * l->sd));
    if (curve->unfit)
      fputs("nan\n", file.stream);
    else
      fprintf(file.stream, "%.8g\n", fitted);
  }
  return file_commit(&file);
}

static int has_error(const struct convergence *c, const struct curve *curve)
{
  for (int k = 0; k < c->h.n; k++)
    if (curve->level[k].error > 0) return 1;
  return 0;
}

static void put_ranges(const struct convergence *c, FILE *contents)
{
  double low = HUGE_VAL, high = 0;
  for (int k = 0; k < c->num_curves; k++)
    for (int l = 0; l < c->h.n; l++) {
      const struct level *level = &c->curve[k].level[l];
      if (!(level->error > 0)) continue;
      low = fmin(low, level->error / (1 + 2 * level->sd));
      high = fmax(high, level->error * (1 + 2 * level->sd));
    }
  fputs("set xtics (", contents);
  for (int k = 0; k < c->h.n; k++)
    fprintf(contents, "%s'%.3g' %.9g", k ? ", " : "", c->h.value[k], c->h.value[k]);
  fputs(")\n", contents);
  fprintf(contents, "error_low = %.8g\nerror_high = %.8g\nh_low = %.8g\nh_high = %.8g\n", low, high,
          c->h.value[c->h.n - 1], c->h.value[0]);
}

static status write_contents(const struct convergence *c, FILE *contents)
{
  int n = 0;
  fputs("# What there is to draw; written by sphbench convergence.\n", contents);
  fprintf(contents, "array file[%d]\narray title[%d]\narray colour[%d]\n", MOST_METHODS,
          MOST_METHODS, MOST_METHODS);
  for (int k = 0; k < c->num_curves; k++) {
    const struct curve *curve = &c->curve[k];
    const struct method *m = &c->study.method[curve->method];
    const struct path name = data_name(m->name, "");
    const struct path title = curve->unfit
                                ? path_of("%s (no order)", m->name)
                                : path_of("%s %.2f [%.2f, %.2f]", m->name, curve->fit.order,
                                          curve->fit.low, curve->fit.high);
    TRY(write_curve(c, curve, name.text));
    put_text(contents, "file", ++n, has_error(c, curve) ? name.text : "");
    put_text(contents, "title", n, title.text);
    fprintf(contents, "colour[%d] = %d\n", n, m->colour);
  }
  fprintf(contents, "n = %d\n", n);
  put_ranges(c, contents);
  const struct path label =
    c->over_dt ? path_of("temporal error") : path_of("%s (%s error)", c->study.error, c->kind);
  put_text(contents, "label_x", 0, c->over_dt ? "time step [s]" : "spacing [m]");
  put_text(contents, "label_error", 0, label.text);
  put_text(contents, "scene", 0, c->study.ask.scene);
  return OK;
}

/* What the report wants to know of the picture. */
static status write_facts(const struct convergence *c)
{
  enum { BEHIND_PRECISION = 1000 };
  const char *scene = c->study.ask.scene, *over = c->over_dt ? "dt" : "spacing";
  const struct path path = path_of("%s/convergence.figure.json", c->folder.text);
  const struct path name = path_of("%s-convergence-%s", scene, over);
  const struct path about = path_of("%s: observed order over %s", scene, over);
  const struct path command = path_of("convergence %s --over %s", scene, over);
  const struct path statement = path_of(
    "%s over %s, means of %ld starts disturbed by up to %g dx (bars: two standard deviations of "
    "the mean). The legend gives the order by weighted least squares with its interval of 95 %%.",
    c->over_dt ? "Distance from the reference" : c->study.error,
    c->over_dt ? "the time step" : "the spacing", c->seeds > 0 ? c->seeds : 1, c->jitter);
  struct new_file file;
  json_t *files = json_array();
  for (int k = 0; k < c->num_curves; k++) {
    const char *solver = c->study.method[c->curve[k].method].name;
    const struct path data = data_name(solver, "");
    json_array_append_new(files,
                          json_pack("{s:s, s:s, s:[s, s, s, s, s]}", "file", data.text, "series",
                                    solver, "columns", over, "error", "low", "high", "fitted"));
  }
  json_t *facts =
    json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:i, s:o}", "name", name.text, "picture",
              "convergence", "kind", "measured", "about", about.text, "statement", statement.text,
              "command", command.text, "order", BEHIND_PRECISION, "files", files);
  status result = facts ? file_begin(&file, path.text) : status_set(ERR_MEMORY, "out of memory");
  if (result == OK) {
    json_dumpf(facts, file.stream, JSON_INDENT(1));
    result = file_commit(&file);
  }
  json_decref(facts);
  return result;
}

status convergence_draw(const struct convergence *c)
{
  const struct path data = data_folder(), path = path_of("%s/contents.gp", c->folder.text);
  const struct drawing drawing = {"convergence", c->folder.text,
                                  path_of("%s/paper-figures/convergence.gp", data.text), c->folder};
  struct new_file file;
  int some = 0;
  for (int k = 0; k < c->num_curves; k++) some |= has_error(c, &c->curve[k]);
  if (!some) return OK; /* the verb says why */
  TRY(file_begin(&file, path.text));
  const status result = write_contents(c, file.stream);
  if (result != OK) file_discard(&file);
  if (result != OK) return result;
  TRY(file_commit(&file));
  TRY(write_facts(c));
  TRY(drawing_make(&drawing));
  if (!c->quiet) printf("%s/convergence.png\n%s/convergence.svg\n", c->folder.text, c->folder.text);
  return OK;
}
