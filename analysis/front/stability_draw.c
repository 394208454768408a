/* Data files for gnuplot, and the pictures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "figure.h"
#include "stability.h"
#include "variants.h"

/* Colours of the verdicts: from dark red for what is worst to green. */
static const unsigned colours[NUM_VERDICTS] = {0x000000, 0x5a0a2a, 0x7b1230, 0x9e1b32, 0xc0392b,
                                               0xd95f30, 0xe98b3a, 0xf1b655, 0xf6e08a, 0x9fd0a5,
                                               0x3c9d5d, 0xbbbbbb, 0xeeeeee};

static void put(FILE *out, double value)
{
  if (isfinite(value))
    fprintf(out, " %.8g", value);
  else
    fputs(" nan", out);
}

/* --- limits --- */

static int able(const struct stability *s)
{
  int n = 0;
  for (int m = 0; m < s->num_solvers; m++) n += !s->solver[m].refusal;
  return n;
}

/* place | largest stable step [s] | smallest that failed [s] | theory [s] | colour | name | why */
static status write_limits(const struct stability *s)
{
  const struct path path = path_of("%s/limits.dat", s->folder.text);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fputs("# columns: place | dt max [s] | dt failed [s] | predicted [s] | line type | solver | "
        "why\n",
        file.stream);
  for (int m = 0, place = 0; m < s->num_solvers; m++) {
    const struct candidate_solver *c = &s->solver[m];
    if (c->refusal) continue;
    fprintf(file.stream, "%d", ++place);
    put(file.stream, c->stable > 0 ? c->stable : (double)NAN);
    put(file.stream, c->failed);
    put(file.stream, c->predicted.least);
    fprintf(file.stream, " %d \"%s\" \"%s\"\n", c->colour, c->name,
            c->failed < HUGE_VAL ? verdict_words[c->reason] : "");
  }
  return file_commit(&file);
}

/* The range of all that is drawn, for the axis; a scene's own step where there is nothing. */
static void put_limits_range(const struct stability *s, FILE *contents)
{
  double low = HUGE_VAL, high = 0, usual = 1e-3;
  for (int m = 0; m < s->num_solvers; m++) {
    const struct candidate_solver *c = &s->solver[m];
    const double drawn[] = {c->stable, c->predicted.least};
    if (c->refusal) continue;
    usual = c->dt;
    for (int k = 0; k < 2; k++)
      if (drawn[k] > 0 && c->stable > 0) {
        low = fmin(low, drawn[k]);
        high = fmax(high, drawn[k]);
      }
  }
  if (!(high > 0)) low = high = usual;
  fprintf(contents, "limits_low = %.8g; limits_high = %.8g\n", low / 1.5, high * 3);
}

/* --- the map --- */

/* The border between two neighbours of a list, and beyond its ends. */
static double border(const double *at, int n, int k, int is_log)
{
  if (n == 1) return is_log ? at[0] * (k ? sqrt(2) : sqrt(0.5)) : at[0] + (k ? 0.5 : -0.5);
  const int low = k == 0 ? 0 : k == n ? n - 2 : k - 1;
  const double a = at[low], b = at[low + 1];
  if (is_log) {
    const double middle = sqrt(a * b);
    return k == 0 ? a * a / middle : k == n ? b * b / middle : middle;
  }
  return k == 0 ? 1.5 * a - 0.5 * b : k == n ? 1.5 * b - 0.5 * a : 0.5 * (a + b);
}

static int by_value(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The second axis: numbers if all values are some, in order; else the places of the words. */
struct axis {
  double *at; /* by rank [n] */
  int n, is_log, is_words;
};

static double value_of(const struct stability *s, const struct axis *axis, int row)
{
  return axis->is_words ? row + 1 : strtod(s->map.value[row], NULL);
}

static int is_number(const char *text)
{
  char *end;
  strtod(text, &end);
  return end != text && *end == '\0';
}

static status make_axis(const struct stability *s, struct axis *axis)
{
  *axis = (struct axis){calloc((size_t)s->map.rows + 1, sizeof(double)), s->map.rows, 1, 0};
  if (!axis->at) return status_set(ERR_MEMORY, "out of memory");
  for (int r = 0; r < axis->n; r++) axis->is_words |= !is_number(s->map.value[r]);
  for (int r = 0; r < axis->n; r++) axis->at[r] = value_of(s, axis, r);
  qsort(axis->at, (size_t)axis->n, sizeof *axis->at, by_value);
  axis->is_log = !axis->is_words && axis->at[0] > 0 && axis->at[axis->n - 1] > 3 * axis->at[0];
  return OK;
}

static int rank_of(const double *at, int n, double value)
{
  int k = 0;
  while (k < n - 1 && at[k] < value) k++;
  return k;
}

static status write_cells(const struct stability *s, const struct axis *axis, int m)
{
  const struct path name = data_name(s->solver[m].name, "-map");
  const struct path path = path_of("%s/%s", s->folder.text, name.text);
  struct values dts = s->map.dts;
  struct new_file file;
  qsort(dts.value, (size_t)dts.n, sizeof *dts.value, by_value);
  TRY(file_begin(&file, path.text));
  fputs("# columns: dt [s] | value | from | to | from | to | colour | worst\n", file.stream);
  for (int k = 0; k < s->n; k++) {
    const struct trial *t = &s->trial[k];
    if (t->method != m || t->row < 0) continue;
    const double value = value_of(s, axis, t->row);
    const int x = rank_of(dts.value, dts.n, t->dt), y = rank_of(axis->at, axis->n, value);
    const double numbers[] = {t->dt,
                              value,
                              border(dts.value, dts.n, x, 1),
                              border(dts.value, dts.n, x + 1, 1),
                              border(axis->at, axis->n, y, axis->is_log),
                              border(axis->at, axis->n, y + 1, axis->is_log)};
    for (size_t c = 0; c < sizeof numbers / sizeof *numbers; c++) put(file.stream, numbers[c]);
    fprintf(file.stream, " %u \"%s\"\n", colours[t->verdict], verdict_words[t->verdict]);
  }
  return file_commit(&file);
}

/* The predicted limit as steps from row to row. */
static status write_line(const struct stability *s, const struct axis *axis, int m)
{
  const struct path name = data_name(s->solver[m].name, "-predicted");
  const struct path path = path_of("%s/%s", s->folder.text, name.text);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fputs("# columns: dt [s] | value\n", file.stream);
  for (int y = 0; y < axis->n; y++)
    for (int row = 0; row < s->map.rows; row++) {
      if (value_of(s, axis, row) != axis->at[y]) continue;
      const double dt = predict_row(s, m, row).least;
      for (int end = 0; end < 2; end++) {
        put(file.stream, dt);
        put(file.stream, border(axis->at, axis->n, y + end, axis->is_log));
        fputc('\n', file.stream);
      }
    }
  return file_commit(&file);
}

static void put_legend(const struct stability *s, FILE *contents)
{
  int there[NUM_VERDICTS] = {0}, n = 0;
  for (int k = 0; k < s->n; k++)
    if (s->trial[k].row >= 0) there[s->trial[k].verdict] = 1;
  fprintf(contents, "array verdict[%d]\narray verdict_colour[%d]\n", NUM_VERDICTS, NUM_VERDICTS);
  for (int k = NUM_VERDICTS - 1; k >= 0; k--)
    if (there[k]) {
      put_text(contents, "verdict", ++n, verdict_words[k]);
      fprintf(contents, "verdict_colour[%d] = %u\n", n, colours[k]);
    }
  fprintf(contents, "num_verdicts = %d\n", n);
}

/* "spacing [m]", with the unit that the first run with facts tells. */
static void put_label(const struct stability *s, FILE *contents)
{
  const char *unit = NULL;
  json_t *facts = NULL;
  for (int k = 0; k < s->n && !unit; k++) {
    json_decref(facts);
    facts = run_facts_json(&s->queue, s->trial[k].run);
    unit =
      json_string_value(json_object_get(json_object_get(facts, "parameter_units"), s->map.key));
  }
  const struct path label = path_of(unit ? "%s [%s]" : "%s", s->map.key, unit);
  put_text(contents, "label_value", 0, label.text);
  json_decref(facts);
}

static void put_axis(const struct stability *s, const struct axis *axis, FILE *contents)
{
  fprintf(contents, "is_log = %d\ndt_low = %.8g; dt_high = %.8g\nvalue_low = %.8g; value_high = ",
          axis->is_log, border(s->map.dts.value, s->map.dts.n, 0, 1),
          border(s->map.dts.value, s->map.dts.n, s->map.dts.n, 1),
          border(axis->at, axis->n, 0, axis->is_log));
  fprintf(contents, "%.8g\nnum_rows = %d\narray row_at[%d]\narray row_label[%d]\n",
          border(axis->at, axis->n, axis->n, axis->is_log), axis->n, axis->n, axis->n);
  for (int row = 0; row < axis->n; row++) {
    fprintf(contents, "row_at[%d] = %.8g\n", row + 1, value_of(s, axis, row));
    put_text(contents, "row_label", row + 1, s->map.value[row]);
  }
  put_label(s, contents);
}

static status write_map(const struct stability *s, FILE *contents)
{
  struct axis axis;
  int n = 0;
  TRY(make_axis(s, &axis));
  status result = OK;
  fprintf(contents, "array cells[%d]\narray line[%d]\narray name[%d]\n", able(s), able(s), able(s));
  for (int m = 0; m < s->num_solvers && result == OK; m++) {
    if (s->solver[m].refusal) continue;
    result = write_cells(s, &axis, m);
    if (result == OK) result = write_line(s, &axis, m);
    put_text(contents, "cells", ++n, data_name(s->solver[m].name, "-map").text);
    put_text(contents, "line", n, data_name(s->solver[m].name, "-predicted").text);
    put_text(contents, "name", n, s->solver[m].name);
  }
  put_axis(s, &axis, contents);
  put_legend(s, contents);
  free(axis.at);
  return result;
}

/* --- drawing --- */

static status write_contents(const struct stability *s, FILE *contents)
{
  fputs("# What there is to draw; written by sphbench stability.\n", contents);
  fprintf(contents, "n = %d\n", able(s));
  put_text(contents, "scene", 0, s->scene);
  fprintf(contents, "array solver[%d]\n", able(s));
  for (int m = 0, place = 0; m < s->num_solvers; m++)
    if (!s->solver[m].refusal) put_text(contents, "solver", ++place, s->solver[m].name);
  put_limits_range(s, contents);
  TRY(write_limits(s));
  return s->map.key ? write_map(s, contents) : OK;
}

static status draw_one(const struct stability *s, const char *name)
{
  const struct path data = data_folder();
  const struct drawing drawing = {name, s->folder.text,
                                  path_of("%s/paper-figures/%s.gp", data.text, name), s->folder};
  TRY(drawing_make(&drawing));
  if (!s->quiet) printf("%s/%s.png\n%s/%s.svg\n", s->folder.text, name, s->folder.text, name);
  return OK;
}

status stability_draw(const struct stability *s)
{
  const struct path path = path_of("%s/contents.gp", s->folder.text);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  const status result = write_contents(s, file.stream);
  if (result != OK) {
    file_discard(&file);
    return result;
  }
  TRY(file_commit(&file));
  TRY(draw_one(s, "stability-limits"));
  return s->map.key ? draw_one(s, "stability-map") : OK;
}
