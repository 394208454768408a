/* Curves: metrics over time, or final metrics against a parameter. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "figure.h"

static double number_in(const json_t *value)
{
  return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

/* "first [unit]|name [unit]|..." of the figure's columns; to be released by free(). */
static char *column_names(const struct figure *f, const json_t *facts, const char *first)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  fputs(first, out);
  for (unsigned c = 0; c < f->recipe->extract.num_columns; c++) {
    const char *name = f->recipe->extract.columns[c];
    fprintf(out, "|%s [%s]", name, fact_unit(facts, name));
  }
  fclose(out);
  return text;
}

/* --- series --- */

static status check_column(const struct figure *f, json_t *series, const char *name)
{
  const char *names[256], *key;
  json_t *unused;
  int n = 0;
  if (json_object_get(series, name)) return OK;
  json_object_foreach(series, key, unused)
  {
    if (n < 256) names[n++] = key;
  }
  const char *near = nearest_name(name, names, n);
  return yaml_source_refuse(f->recipe->source, "extract.columns", "the runs have no '%s'%s%s%s",
                            name, near ? "; the nearest known name is '" : "", near ? near : "",
                            near ? "'" : "");
}

static status write_series(struct figure *f, const json_t *facts, const struct figure_case *one,
                           const char *name)
{
  const struct recipe_extract *e = &f->recipe->extract;
  json_t *series = json_object_get(facts, "series"), *time = json_object_get(series, "time");
  const double scale = e->scale_x != 0 ? e->scale_x : 1;
  struct new_file file;
  for (unsigned c = 0; c < e->num_columns; c++) TRY(check_column(f, series, e->columns[c]));
  char *columns = column_names(f, facts, e->scale_x != 0 ? "scaled time" : "time [s]");
  const status begun = columns ? data_begin(f, &file, name, one->label, columns)
                               : status_set(ERR_MEMORY, "out of memory");
  free(columns);
  if (begun != OK) return begun;
  for (size_t i = 0; i < json_array_size(time); i++) {
    fprintf(file.stream, "%.8g", scale * number_in(json_array_get(time, i)));
    for (unsigned c = 0; c < e->num_columns; c++)
      fprintf(file.stream, " %.8g",
              number_in(json_array_get(json_object_get(series, e->columns[c]), i)));
    fputc('\n', file.stream);
  }
  return file_commit(&file);
}

status extract_series(struct figure *f, const struct queue *queue, FILE *contents)
{
  int n = 0;
  put_lists(contents, f->n);
  for (int k = 0; k < f->n; k++) {
    const struct figure_case *one = &f->cases[k];
    json_t *facts = run_facts_json(queue, one->run);
    if (!facts) continue; /* the table of what was not run says why */
    const struct path name = data_name(one->label, "");
    const status written = write_series(f, facts, one, name.text);
    json_decref(facts);
    TRY(written);
    put_curve(contents, ++n, name.text, one->label, one->colour);
  }
  fprintf(contents, "n = %d\n", n);
  return n ? OK : user_error("%s: none of its runs has a result to draw", f->recipe->name);
}

/* --- final metrics against a parameter --- */

enum { MOST_POINTS = 256 };
struct points {
  int n;
  double x[MOST_POINTS], y[MOST_POINTS];
};

/* Least squares of log y = order log x + level. 0: not enough points. */
static int fit_order(const struct points *p, double *order, double *level)
{
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (int k = 0; k < p->n; k++) {
    if (!(p->x[k] > 0 && p->y[k] > 0)) continue;
    const double x = log(p->x[k]), y = log(p->y[k]);
    n += 1;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double spread = n * sxx - sx * sx;
  if (n < 2 || !(spread > 1e-12)) return 0;
  *order = (n * sxy - sx * sy) / spread;
  *level = (sy - *order * sx) / n;
  return 1;
}

/* The fitted line between its ends; *title gets the order. */
static status write_fit(struct figure *f, const struct points *p, const char *label,
                        struct path *title, struct path *name)
{
  double order, level, low = HUGE_VAL, high = -HUGE_VAL;
  struct new_file file;
  *name = (struct path){{0}};
  if (!f->recipe->extract.fit || !fit_order(p, &order, &level)) return OK;
  *title = path_of("%s (order %.2f)", label, order);
  *name = data_name(label, "-fit");
  for (int k = 0; k < p->n; k++) {
    low = fmin(low, p->x[k]);
    high = fmax(high, p->x[k]);
  }
  const struct path series = path_of("%s, fitted: order %.6g", label, order);
  TRY(data_begin(f, &file, name->text, series.text, "parameter|fit"));
  fprintf(file.stream, "%.8g %.8g\n%.8g %.8g\n", low, exp(level) * pow(low, order), high,
          exp(level) * pow(high, order));
  return file_commit(&file);
}

static status write_points(struct figure *f, const struct queue *queue, int first, int last,
                           const char *name, struct points *points)
{
  struct new_file file;
  const struct recipe_extract *e = &f->recipe->extract;
  const char *parameter = f->recipe->labels.x ? f->recipe->labels.x : "parameter";
  json_t *facts = NULL;
  for (int k = first; k < last && !facts; k++) facts = run_facts_json(queue, f->cases[k].run);
  points->n = 0;
  if (!facts) return OK;
  char *columns = column_names(f, facts, parameter);
  json_decref(facts);
  const status begun = columns ? data_begin(f, &file, name, f->cases[first].curve, columns)
                               : status_set(ERR_MEMORY, "out of memory");
  free(columns);
  if (begun != OK) return begun;
  for (int k = first; k < last && points->n < MOST_POINTS; k++) {
    if (!(facts = run_facts_json(queue, f->cases[k].run))) continue;
    const double x = strtod(f->cases[k].value, NULL), y = fact_value(facts, e->columns[0]);
    if (isfinite(y)) {
      points->x[points->n] = x;
      points->y[points->n++] = y;
    }
    fprintf(file.stream, "%.8g", x);
    for (unsigned c = 0; c < e->num_columns; c++)
      fprintf(file.stream, " %.8g", fact_value(facts, e->columns[c]));
    fputc('\n', file.stream);
    json_decref(facts);
  }
  return file_commit(&file);
}

status extract_metric(struct figure *f, const struct queue *queue, FILE *contents)
{
  int n = 0;
  struct points points;
  put_lists(contents, f->num_groups);
  for (int first = 0, last; first < f->n; first = last) {
    for (last = first; last < f->n && f->cases[last].group == f->cases[first].group;) last++;
    const struct figure_case *one = &f->cases[first];
    const struct path name = data_name(one->curve, "");
    struct path fit, title = path_of("%s", one->curve);
    TRY(write_points(f, queue, first, last, name.text, &points));
    if (points.n == 0) continue;
    TRY(write_fit(f, &points, one->curve, &title, &fit));
    put_curve(contents, ++n, name.text, title.text, one->colour);
    put_text(contents, "fit", n, fit.text);
  }
  fprintf(contents, "n = %d\n", n);
  return n ? OK : user_error("%s: none of its runs has a result to draw", f->recipe->name);
}
