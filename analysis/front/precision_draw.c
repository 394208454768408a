/* Data files for gnuplot, the pictures, and what belongs to them. */
#include <stdlib.h>
#include <string.h>

#include "figure.h"
#include "precision.h"
#include "variants.h"

/* --- fronts --- */

static void mark_front(struct precision *p, int method, int by_pairs)
{
  double *cost = calloc((size_t)p->n + 1, sizeof *cost);
  double *error = calloc((size_t)p->n + 1, sizeof *error);
  int *on = calloc((size_t)p->n + 1, sizeof *on);
  for (int k = 0; cost && error && on && k < p->n; k++) {
    const struct point *point = &p->point[k];
    const int mine = point->knobs.method == method && !point->reason;
    cost[k] = !mine ? (double)NAN : by_pairs ? point->visits : point->time.median;
    error[k] = point->error;
  }
  if (cost && error && on) {
    pareto_front(cost, error, p->n, on);
    for (int k = 0; k < p->n; k++) {
      int *mark = by_pairs ? &p->point[k].on_pairs_front : &p->point[k].on_front;
      *mark |= on[k];
    }
  }
  free(cost);
  free(error);
  free(on);
}

/* --- data --- */

static json_t *columns_json(const char *const *columns, int n)
{
  json_t *array = json_array();
  for (int k = 0; k < n; k++) json_array_append_new(array, json_string(columns[k]));
  return array;
}

static void put(FILE *out, double value)
{
  if (isfinite(value))
    fprintf(out, " %.8g", value);
  else
    fputs(" nan", out);
}

static void put_point(FILE *out, const struct point *point)
{
  const double numbers[] = {point->time.median,    point->time.low,      point->time.high,
                            point->error,          point->visits,        point->on_front,
                            point->on_pairs_front, point->density_error, point->knobs.spacing,
                            point->knobs.dt,       point->knobs.factor};
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) put(out, numbers[k]);
  fputc('\n', out);
}

static int by_error(const void *a, const void *b)
{
  const struct point *x = *(const struct point *const *)a, *y = *(const struct point *const *)b;
  return (x->error < y->error) - (x->error > y->error);
}

/* Which points a file holds. */
enum block { ALL_POINTS, TIME_FRONT, PAIRS_FRONT, NUM_BLOCKS };
static const char *const block_suffix[NUM_BLOCKS] = {"", "-front", "-pairs-front"};

static int belongs(const struct point *point, enum block block)
{
  return block == ALL_POINTS || (block == TIME_FRONT ? point->on_front : point->on_pairs_front);
}

/* The valid points of a solver, from the largest error to the smallest; *n of them. */
static status write_points(const struct precision *p, int method, enum block block, json_t *files,
                           int *n)
{
  static const char *const columns[] = {
    "time [s]",       "low [s]",       "high [s]",    "error",  "pairs visited",   "on front",
    "on pairs front", "density error", "spacing [m]", "dt [s]", "tolerance factor"};
  enum { NUM_COLUMNS = sizeof columns / sizeof *columns };
  const struct path name = data_name(p->study.method[method].name, block_suffix[block]);
  const struct path path = path_of("%s/%s", p->folder.text, name.text);
  const struct point **sorted = calloc((size_t)p->n + 1, sizeof *sorted);
  struct new_file file;
  *n = 0;
  if (!sorted) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < p->n; k++) {
    const struct point *point = &p->point[k];
    if (point->knobs.method == method && !point->reason && belongs(point, block))
      sorted[(*n)++] = point;
  }
  qsort(sorted, (size_t)*n, sizeof(const struct point *), by_error);
  const status begun = file_begin(&file, path.text);
  if (begun == OK) {
    fputs("# columns:", file.stream);
    for (int k = 0; k < NUM_COLUMNS; k++) fprintf(file.stream, "%s %s", k ? " |" : "", columns[k]);
    fputc('\n', file.stream);
    for (int k = 0; k < *n; k++) put_point(file.stream, sorted[k]);
  }
  free(sorted);
  if (begun != OK) return begun;
  if (block == ALL_POINTS)
    json_array_append_new(files, json_pack("{s:s, s:s, s:o}", "file", name.text, "series",
                                           p->study.method[method].name, "columns",
                                           columns_json(columns, NUM_COLUMNS)));
  return file_commit(&file);
}

static int count(const struct precision *p, int method, int valid)
{
  int n = 0;
  for (int k = 0; k < p->n; k++)
    n += p->point[k].knobs.method == method && (p->point[k].reason == NULL) == valid;
  return n;
}

static int count_exact(const struct precision *p, int method)
{
  int n = 0;
  for (int k = 0; k < p->n; k++)
    n += p->point[k].knobs.method == method && !p->point[k].reason && p->point[k].error == 0;
  return n;
}

/* Failed runs have neither time nor error: they are drawn in the margin, one mark each, solver
 * after solver. */
static status write_failed(const struct precision *p, int *total)
{
  const struct path path = path_of("%s/failed.dat", p->folder.text);
  struct new_file file;
  *total = 0;
  for (int k = 0; k < p->n; k++) *total += p->point[k].reason != NULL;
  TRY(file_begin(&file, path.text));
  fputs("# columns: place | colour | reason\n", file.stream);
  for (int k = 0, place = 0; k < p->n; k++)
    if (p->point[k].reason)
      fprintf(file.stream, "%d %d # %s, %s: %s\n", ++place,
              p->study.method[p->point[k].knobs.method].colour, point_solver(p, &p->point[k]),
              point_words(p, &p->point[k]).text, p->point[k].reason);
  return file_commit(&file);
}

/* The range of what is drawn, for the axes. */
struct range {
  double low, high;
};

static void widen(struct range *r, double value)
{
  if (!(value > 0) || !isfinite(value)) return;
  r->low = fmin(r->low, value);
  r->high = fmax(r->high, value);
}

static void put_range(FILE *contents, const char *name, struct range r)
{
  const int some = r.low <= r.high;
  fprintf(contents, "%s_low = %.8g; %s_high = %.8g\n", name, some ? r.low : 0.1, name,
          some ? r.high : 1.0);
}

static void put_ranges(const struct precision *p, FILE *contents)
{
  struct range error = {HUGE_VAL, 0}, time = error, pairs = error;
  for (int k = 0; k < p->n; k++) {
    const struct point *point = &p->point[k];
    if (point->reason) continue;
    widen(&error, point->error);
    widen(&time, point->time.low);
    widen(&time, point->time.high);
    widen(&pairs, point->visits);
  }
  put_range(contents, "error", error);
  put_range(contents, "time", time);
  put_range(contents, "pairs", pairs);
}

static status write_method(const struct precision *p, int m, int number, FILE *contents,
                           json_t *files)
{
  static const char *const arrays[NUM_BLOCKS] = {"file", "front", "pairs_front"};
  const int valid = count(p, m, 1), invalid = count(p, m, 0);
  const char *name = p->study.method[m].name;
  struct path title =
    invalid ? path_of("%s (%d of %d failed)", name, invalid, valid + invalid) : path_of("%s", name);
  const int exact = count_exact(p, m); /* has no place on a logarithmic axis */
  if (exact) title = path_of("%s (%d have no error)", title.text, exact);
  for (int block = 0; block < NUM_BLOCKS; block++) {
    const struct path file = data_name(name, block_suffix[block]);
    int n;
    TRY(write_points(p, m, (enum block)block, files, &n));
    put_text(contents, arrays[block], number, n ? file.text : "");
  }
  put_text(contents, "title", number, title.text);
  fprintf(contents, "colour[%d] = %d\n", number, p->study.method[m].colour);
  return OK;
}

static status write_contents(const struct precision *p, FILE *contents, json_t *files)
{
  static const char *const arrays[] = {"file", "front", "pairs_front", "title", "colour"};
  const struct study *s = &p->study;
  const int by_metric = p->kind == KIND_TOTAL || p->kind == KIND_SPATIAL;
  const struct path label = by_metric ? path_of("%s (%s error)", s->error, kind_words[p->kind])
                                      : path_of("%s error", kind_words[p->kind]);
  int n = 0, failed = 0;
  fputs("# What there is to draw; written by sphbench precision.\n", contents);
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    fprintf(contents, "array %s[%d]\n", arrays[k], MOST_METHODS);
  for (int m = 0; m < s->num_methods; m++)
    if (count(p, m, 1) + count(p, m, 0) > 0) TRY(write_method(p, m, ++n, contents, files));
  TRY(write_failed(p, &failed));
  fprintf(contents, "n = %d\nnum_failed = %d\nfloor = %.4g\n", n, failed, p->floor);
  put_ranges(p, contents);
  put_text(contents, "label_error", 0, label.text);
  put_text(contents, "scene", 0, s->ask.scene);
  return OK;
}

static status write_data(const struct precision *p, json_t *files)
{
  const struct path path = path_of("%s/contents.gp", p->folder.text);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  const status result = write_contents(p, file.stream, files);
  if (result == OK) return file_commit(&file);
  file_discard(&file);
  return result;
}

/* What the report wants to know of a picture. */
static status write_facts(const struct precision *p, const char *picture, const char *what,
                          json_t *files)
{
  enum { BY_KIND = 100, PAIRS_LATER = 50 };
  const char *scene = p->study.ask.scene, *kind = kind_words[p->kind];
  const int order = BY_KIND * p->kind + (strcmp(picture, "error-pairs") ? 0 : PAIRS_LATER);
  const struct path path = path_of("%s/%s.figure.json", p->folder.text, picture);
  const struct path name = path_of("%s-%s-%s%s", scene, kind, p->aa ? "aa-" : "", picture);
  const struct path about = path_of("%s: %s error against %s", scene, kind, what);
  const struct path command = path_of("precision %s --kind %s%s%s", scene, kind,
                                      p->study.ask.quick ? " --quick" : "", p->aa ? " --aa" : "");
  const struct path statement = path_of(
    "Error (%s) %s. Small marks: all points; lines: the Pareto front of each solver over spacing, "
    "time step and tolerance; bars: interval of the median of %ld repetitions. Failed runs stand "
    "in the margin. Differences below %.3g times are noise (%s).",
    study_error_about(&p->study), kind_meanings[p->kind], p->repeat, p->floor, p->floor_means);
  struct new_file file;
  json_t *facts =
    json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:i, s:O}", "name", name.text, "picture", picture,
              "kind", "measured", "about", about.text, "statement", statement.text, "command",
              command.text, "order", order, "files", files);
  status result = facts ? file_begin(&file, path.text) : status_set(ERR_MEMORY, "out of memory");
  if (result == OK) {
    json_dumpf(facts, file.stream, JSON_INDENT(1));
    result = file_commit(&file);
  }
  json_decref(facts);
  return result;
}

static status draw_one(const struct precision *p, const char *name, const char *what, json_t *files)
{
  const struct path data = data_folder();
  const struct drawing drawing = {name, p->folder.text,
                                  path_of("%s/paper-figures/%s.gp", data.text, name), p->folder};
  TRY(write_facts(p, name, what, files));
  TRY(drawing_make(&drawing));
  if (!p->quiet) printf("%s/%s.png\n%s/%s.svg\n", p->folder.text, name, p->folder.text, name);
  return OK;
}

status precision_draw(struct precision *p)
{
  json_t *files = json_array();
  status result = write_data(p, files);
  if (result == OK) result = draw_one(p, "error-time", "run time", files);
  if (result == OK) result = draw_one(p, "error-pairs", "neighbour pairs visited", files);
  json_decref(files);
  return result;
}

void precision_fronts(struct precision *p)
{
  for (int m = 0; m < p->study.num_methods; m++) {
    mark_front(p, m, 0);
    mark_front(p, m, 1);
  }
}
