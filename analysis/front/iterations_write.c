/* Errors over iterations as JSON, as CSV and as pictures. */
#include <stdlib.h>

#include "figure.h"
#include "iterations.h"
#include "json_out.h"
#include "variants.h"

static json_t *text_or_null(const char *text) { return text ? json_string(text) : json_null(); }

static json_t *targets_json(const struct iterations *it, const struct iteration_curve *curve)
{
  json_t *array = json_array();
  for (int k = 0; k < NUM_TARGETS; k++) {
    const int reached = iterations_to(it, curve, iteration_targets[k]);
    json_array_append_new(array,
                          json_pack("{s:f, s:o}", "error", iteration_targets[k], "iterations",
                                    reached ? json_integer(reached) : json_null()));
  }
  return array;
}

static void put_series(json_t *row, const struct iterations *it,
                       const struct iteration_curve *curve)
{
  json_t *counts = json_array(), *residuals = json_array(), *velocities = json_array();
  json_t *pressures = json_array(), *reasons = json_array();
  for (int k = 0; k < it->count.n && !curve->reason; k++) {
    const struct iterate *at = &curve->at[k];
    json_array_append_new(counts, json_integer((json_int_t)it->count.value[k]));
    json_array_append_new(residuals, json_out_number(at->residual));
    json_array_append_new(velocities, json_out_number(at->velocity_error));
    json_array_append_new(pressures, json_out_number(at->pressure_error));
    json_array_append_new(reasons, text_or_null(at->reason));
  }
  json_object_set_new(row, "iterations", counts);
  json_object_set_new(row, "residual", residuals);
  json_object_set_new(row, "velocity_error", velocities);
  json_object_set_new(row, "pressure_error", pressures);
  json_object_set_new(row, "failed", reasons);
}

static json_t *curve_json(const struct iterations *it, const struct iteration_curve *curve)
{
  json_t *row = json_pack("{s:s, s:o}", "solver", it->study.method[curve->method].name, "reason",
                          text_or_null(curve->reason));
  put_series(row, it, curve);
  if (curve->reason) return row;
  const int has_rate = !curve->unfit;
  const double rate = has_rate ? exp(-curve->fit.order) : (double)NAN;
  json_object_set_new(row, "rate", json_out_number(rate));
  json_object_set_new(row, "rate_low",
                      json_out_number(has_rate ? exp(-curve->fit.high) : (double)NAN));
  json_object_set_new(row, "rate_high",
                      json_out_number(has_rate ? exp(-curve->fit.low) : (double)NAN));
  json_object_set_new(row, "no_rate", text_or_null(curve->unfit));
  json_object_set_new(row, "reached", targets_json(it, curve));
  json_object_set_new(row, "reference",
                      json_pack("{s:o, s:o}", "iterations",
                                json_out_number(curve->reference_iterations), "residual",
                                json_out_number(curve->reference_residual)));
  return row;
}

status iterations_write(const struct iterations *it, const char *also)
{
  const struct path path = path_of("%s/iterations.json", it->folder.text);
  json_t *curves = json_array();
  for (int m = 0; m < it->study.num_methods; m++)
    json_array_append_new(curves, curve_json(it, &it->curve[m]));
  json_t *whole = json_pack(
    "{s:s, s:s, s:f, s:o, s:f, s:I, s:b, s:o}", "scene", it->study.ask.scene, "over", "iterations",
    "spacing", it->spacing, "dt", it->dt > 0 ? json_out_number(it->dt) : json_null(), "jitter",
    it->jitter, "seed", (json_int_t)it->seed, "warm_start", 0, "curves", curves);
  return json_out_finish(whole, path.text, also);
}

/* --- pictures --- */

static void put_number(FILE *out, double value)
{
  if (isfinite(value))
    fprintf(out, ",%.8g", value);
  else
    fputs(",nan", out);
}

static status write_data(const struct iterations *it)
{
  const struct path path = path_of("%s/iterations.csv", it->folder.text);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fputs("solver,iterations,residual,velocity_error,pressure_error\n", file.stream);
  for (int m = 0; m < it->study.num_methods; m++)
    for (int k = 0; k < it->count.n && !it->curve[m].reason; k++) {
      const struct iterate *at = &it->curve[m].at[k];
      fprintf(file.stream, "%s,%g", it->study.method[m].name, it->count.value[k]);
      put_number(file.stream, at->residual);
      put_number(file.stream, at->velocity_error);
      put_number(file.stream, at->pressure_error);
      fputc('\n', file.stream);
    }
  return file_commit(&file);
}

static void write_contents(const struct iterations *it, FILE *contents)
{
  int n = 0;
  fputs("# What there is to draw; written by sphbench convergence --over iterations.\n", contents);
  fprintf(contents, "array solver[%d]\narray title[%d]\narray colour[%d]\n", MOST_METHODS,
          MOST_METHODS, MOST_METHODS);
  for (int m = 0; m < it->study.num_methods; m++) {
    const struct iteration_curve *curve = &it->curve[m];
    const char *name = it->study.method[m].name;
    if (curve->reason) continue;
    const struct path title =
      curve->unfit ? path_of("%s", name) : path_of("%s %.2f", name, exp(-curve->fit.order));
    put_text(contents, "solver", ++n, name);
    put_text(contents, "title", n, title.text);
    fprintf(contents, "colour[%d] = %d\n", n, it->study.method[m].colour);
  }
  fprintf(contents, "n = %d\nmost = %g\n", n, it->count.value[it->count.n - 1]);
  put_text(contents, "scene", 0, it->study.ask.scene);
}

/* What the report wants to know of the picture. */
static json_t *facts_of(const struct iterations *it)
{
  enum { BEHIND_PRECISION = 1001 };
  const char *scene = it->study.ask.scene;
  const struct path name = path_of("%s-convergence-iterations", scene);
  const struct path about = path_of("%s: error over iterations", scene);
  const struct path command = path_of("convergence %s --over iterations", scene);
  const struct path statement = path_of(
    "Velocity after one step from a start disturbed by up to %g dx (dx %g m), without a warm "
    "start: relative distance from the same step solved to 1e-10. The legend gives the mean factor "
    "of an iteration.",
    it->jitter, it->spacing);
  return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:i, s:[{s:s, s:s, s:[s, s, s, s, s]}]}", "name",
                   name.text, "picture", "iterations", "kind", "measured", "about", about.text,
                   "statement", statement.text, "command", command.text, "order", BEHIND_PRECISION,
                   "files", "file", "iterations.csv", "series", "all solvers", "columns", "solver",
                   "iterations", "residual", "velocity_error", "pressure_error");
}

status iterations_draw(const struct iterations *it)
{
  const struct path data = data_folder(), path = path_of("%s/contents.gp", it->folder.text);
  const struct path facts = path_of("%s/iterations.figure.json", it->folder.text);
  const struct drawing drawing = {"iterations", it->folder.text,
                                  path_of("%s/paper-figures/iterations.gp", data.text), it->folder};
  struct new_file file;
  TRY(write_data(it));
  TRY(file_begin(&file, path.text));
  write_contents(it, file.stream);
  TRY(file_commit(&file));
  TRY(json_out_finish(facts_of(it), facts.text, NULL));
  TRY(drawing_make(&drawing));
  if (!it->quiet)
    printf("%s/iterations.png\n%s/iterations.svg\n%s/iterations.csv\n", it->folder.text,
           it->folder.text, it->folder.text);
  return OK;
}
