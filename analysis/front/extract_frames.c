/* Frames: positions and one quantity of the particles, at given times, one row per run. In 3-D they
 * are seen from the side: x and the height z. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../core/io/result_read.h"
#include "figure.h"

/* The frame at this time, -1: none. The last frame of a run that diverged is of the moment when it
 * did, and stands for no other. */
static long frame_at(const struct result_read *r, double time, int diverged)
{
  const long n = result_read_frames(r) - (diverged ? 1 : 0);
  const double interval = n > 1 ? result_read_time(r, 1) - result_read_time(r, 0) : 0;
  for (long k = 0; k < n; k++)
    if (fabs(result_read_time(r, k) - time) <= 0.1 * interval + 1e-12) return k;
  return -1;
}

static double magnitude(const struct result_numbers *v, long i)
{
  double sum = 0;
  for (int c = 0; c < v->components; c++) {
    const double value = v->values[i * v->components + c];
    sum += value * value;
  }
  return v->components == 1 ? v->values[i] : sqrt(sum);
}

/* Which component is the height? */
static int upward(struct result_read *r)
{
  double dim;
  return result_read_number(r, "run/dim", &dim) == OK && dim > 2 ? 2 : 1;
}

/* A scalar is taken as it is, a vector by its length. */
static status write_rows(FILE *out, struct result_read *r, long frame, const char *quantity)
{
  struct result_numbers x, q;
  const int up = upward(r);
  TRY(result_read_array(r, frame, "position", &x));
  const status result = result_read_array(r, frame, quantity, &q);
  for (long i = 0; result == OK && i < x.rows && i < q.rows; i++) {
    const double *at = x.values + i * x.components, value = magnitude(&q, i);
    if (isfinite(at[0]) && isfinite(at[up]) && isfinite(value))
      fprintf(out, "%.5g %.5g %.4g\n", at[0], at[up], value);
  }
  free(x.values);
  if (result == OK) free(q.values);
  return result;
}

static const char *array_of(const char *colour)
{
  return strcmp(colour, "speed") == 0 ? "velocity" : colour;
}

static status write_frame(struct figure *f, struct result_read *r, long frame,
                          const struct figure_case *one, const char *name)
{
  struct new_file file;
  const struct path series = path_of("%s, t = %.4g s", one->label, result_read_time(r, frame));
  const struct path columns =
    path_of("x [m]|%s [m]|%s", upward(r) == 2 ? "z" : "y",
            f->recipe->labels.colour ? f->recipe->labels.colour : f->recipe->extract.colour);
  TRY(data_begin(f, &file, name, series.text, columns.text));
  const status result = write_rows(file.stream, r, frame, array_of(f->recipe->extract.colour));
  if (result == OK) return file_commit(&file);
  file_discard(&file);
  return result;
}

/* In 3-D only walls half-way into the scene: those in front would hide it. */
static int wall_is_seen(const struct result_numbers *x, long i, double middle, double near)
{
  return fabs(x->values[i * x->components + 1] - middle) <= near;
}

static void write_wall_rows(FILE *out, const struct result_numbers *x, int up)
{
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (long i = 0; i < x->rows; i++) {
    low = fmin(low, x->values[i * x->components + 1]);
    high = fmax(high, x->values[i * x->components + 1]);
  }
  const double near = up == 2 ? 0.02 * (high - low) : HUGE_VAL;
  for (long i = 0; i < x->rows; i++)
    if (wall_is_seen(x, i, (low + high) / 2, near))
      fprintf(out, "%.5g %.5g\n", x->values[i * x->components], x->values[i * x->components + up]);
}

/* Walls do not move: one file for all rows of a figure. */
static status write_walls(struct figure *f, struct result_read *r, FILE *contents)
{
  struct result_numbers x;
  struct new_file file;
  if (!result_read_has(r, "walls/position")) return OK;
  TRY(result_read_series(r, "walls/position", &x));
  if (x.components < 2) x.rows = 0; /* no positions */
  const status begun = data_begin(f, &file, "walls.dat", "wall particles", "x [m]|y [m]");
  if (begun == OK) write_wall_rows(file.stream, &x, upward(r));
  free(x.values);
  put_text(contents, "walls", 0, "walls.dat");
  return begun == OK ? file_commit(&file) : begun;
}

/* Why there is no picture of a run at a time. */
static struct path gap(const struct run *run)
{
  if (!run->finished) return path_of("not run");
  if (run->outcome == OUTCOME_DIVERGED || run->outcome == OUTCOME_OK) {
    const char *at = run->reason ? strstr(run->reason, "t = ") : NULL;
    return at ? path_of("diverged at %s", at) : path_of("no frame");
  }
  return path_of("%s", outcome_words[run->outcome]);
}

struct row {
  struct figure *figure;
  const struct figure_case *one;
  const struct run *run;
  int number; /* from 1 */
  FILE *contents;
};

static status write_cell(const struct row *row, struct result_read *r, unsigned column, int *drawn)
{
  const double time = row->figure->recipe->extract.times[column];
  const int cell =
    (row->number - 1) * (int)row->figure->recipe->extract.num_times + (int)column + 1;
  const long frame = r ? frame_at(r, time, row->run->outcome == OUTCOME_DIVERGED) : -1;
  struct path name = {{0}}, note = {{0}};
  if (frame >= 0) {
    const struct path suffix = path_of("-%u", column + 1);
    name = data_name(row->one->label, suffix.text);
    TRY(write_frame(row->figure, r, frame, row->one, name.text));
    ++*drawn;
  } else {
    note = gap(row->run);
  }
  put_text(row->contents, "file", cell, name.text);
  put_text(row->contents, "note", cell, note.text);
  return OK;
}

static status write_cells(const struct row *row, const struct queue *queue, int *drawn)
{
  struct result_read *r = NULL;
  const struct path path = run_file(queue->results, row->run->id, "vtkhdf");
  const int has = row->run->finished && row->run->outcome <= OUTCOME_DIVERGED;
  put_text(row->contents, "row", row->number, row->one->label);
  if (has) TRY(result_read_open(&r, path.text));
  status result = r && row->number == 1 ? write_walls(row->figure, r, row->contents) : OK;
  for (unsigned c = 0; c < row->figure->recipe->extract.num_times && result == OK; c++)
    result = write_cell(row, r, c, drawn);
  result_read_close(r);
  return result;
}

static void write_layout(const struct figure *f, FILE *contents)
{
  const struct recipe *r = f->recipe;
  const unsigned columns = r->extract.num_times;
  fprintf(contents, "rows = %d\ncolumns = %u\n", f->n, columns);
  fprintf(contents, "array row[%d]\narray file[%u]\narray note[%u]\narray time[%u]\nwalls = ''\n",
          f->n, (unsigned)f->n * columns, (unsigned)f->n * columns, columns);
  for (unsigned c = 0; c < columns; c++)
    fprintf(contents, "time[%u] = %.9g\n", c + 1, r->extract.times[c]);
  fprintf(contents, "array window[%u]\n", 4 * columns);
  for (unsigned k = 0; k < 4 * columns; k++)
    fprintf(contents, "window[%u] = %.9g\n", k + 1, r->windows[k % r->num_windows]);
  fprintf(contents, "colour_low = %.9g\ncolour_high = %.9g\n", r->colours[0], r->colours[1]);
}

status extract_frames(struct figure *f, const struct queue *queue, FILE *contents)
{
  int drawn = 0;
  write_layout(f, contents);
  for (int k = 0; k < f->n; k++) {
    const struct row row = {f, &f->cases[k], &queue->run[f->cases[k].run], k + 1, contents};
    TRY(write_cells(&row, queue, &drawn));
  }
  return drawn ? OK : user_error("%s: none of its runs has a frame to draw", f->recipe->name);
}
