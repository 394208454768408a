/* Interpolation in series and tables, the CSV reader, outlines. */
#include "internal.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Largest i with x(i) <= at, so that at lies in [x(i), x(i+1)]; -1 outside. */
struct column {
  const double *first;
  int count, stride;
};

static double entry(struct column c, int i) { return c.first[(ptrdiff_t)i * c.stride]; }

static int interval(struct column c, double at)
{
  if (c.count < 1 || !(at >= entry(c, 0) && at <= entry(c, c.count - 1))) return -1;
  int low = 0, high = c.count - 1;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    *(entry(c, middle) <= at ? &low : &high) = middle;
  }
  return low;
}

static double linear(struct column x, struct column y, double at)
{
  const int i = interval(x, at);
  if (i < 0) return NAN;
  if (x.count == 1) return entry(y, 0);
  const double s = (at - entry(x, i)) / (entry(x, i + 1) - entry(x, i));
  return s == 1 ? entry(y, i + 1) : entry(y, i) + s * (entry(y, i + 1) - entry(y, i));
}

double reference_series_linear(const struct reference_series *s, double x)
{
  return linear((struct column){s->x, s->count, 1}, (struct column){s->y, s->count, 1}, x);
}

/* Lagrange's polynomial at x through `points` points from index `first`; a negative index is the
 * mirror image. The error of the points is added up with the weights' magnitudes. */
struct stencil {
  int first, points;
};

static double mirrored(const struct reference_series *s, int i)
{
  return i < 0 ? -s->x[-i] : s->x[i];
}

static struct reference_value lagrange(const struct reference_series *s, struct stencil stencil,
                                       double x)
{
  struct reference_value out = {0, 0};
  for (int i = stencil.first; i < stencil.first + stencil.points; i++) {
    double weight = 1;
    for (int k = stencil.first; k < stencil.first + stencil.points; k++)
      if (k != i) weight *= (x - mirrored(s, k)) / (mirrored(s, i) - mirrored(s, k));
    out.value += weight * s->y[abs(i)];
    if (s->error) out.error += fabs(weight) * s->error[abs(i)];
  }
  return out;
}

static struct stencil around(const struct reference_series *s, int i, int points)
{
  const int lowest = s->even ? 1 - s->count : 0, available = s->count - lowest;
  struct stencil out = {i + 1 - points / 2, points < available ? points : available};
  if (out.first + out.points > s->count) out.first = s->count - out.points;
  if (out.first < lowest) out.first = lowest;
  return out;
}

struct reference_value reference_series_smooth(const struct reference_series *s, double x)
{
  const int i = interval((struct column){s->x, s->count, 1}, x);
  if (i < 0) return (struct reference_value){NAN, NAN};
  struct reference_value fine = lagrange(s, around(s, i, 6), x);
  fine.error += fabs(fine.value - lagrange(s, around(s, i, 4), x).value);
  return fine;
}

/* ---- CSV ---- */

static enum reference_status read_text(const char *path, char **text)
{
  FILE *file = fopen(path, "rb");
  if (!file) return ref_fail(REFERENCE_NO_FILE, "%s: cannot open: %s", path, strerror(errno));
  size_t length = 0, space = 0, got = 0;
  char *buffer = NULL;
  bool memory = true;
  do {
    if (space - length < 4097) {
      space = 2 * space + 8192;
      char *larger = realloc(buffer, space);
      memory = larger != NULL;
      if (!memory) break;
      buffer = larger;
    }
    got = fread(buffer + length, 1, 4096, file);
    length += got;
  } while (got > 0);
  const bool failed = ferror(file);
  fclose(file);
  if (memory && !failed) {
    buffer[length] = 0;
    *text = buffer;
    return REFERENCE_OK;
  }
  free(buffer);
  if (failed) return ref_fail(REFERENCE_NO_FILE, "%s: cannot read", path);
  return ref_fail(REFERENCE_NO_MEMORY, "%s: no memory for the table", path);
}

/* Cuts the next line off *rest; NULL at the end. */
static char *next_line(char **rest)
{
  char *line = *rest;
  if (!*line) return NULL;
  char *end = line + strcspn(line, "\r\n");
  if (*end == '\r') *end++ = 0;
  if (*end == '\n') *end++ = 0;
  *rest = end;
  return line;
}

static bool is_data(const char *line) { return *line && *line != '#'; }

static int count_char(const char *text, char c)
{
  int n = 0;
  for (; *text; text++) n += *text == c;
  return n;
}

static bool split_names(char *line, struct reference_table *table)
{
  table->columns = 1 + count_char(line, ',');
  table->names = malloc(table->columns * sizeof *table->names);
  if (!table->names) return false;
  for (int k = 0; k < table->columns; k++) {
    table->names[k] = line;
    line += strcspn(line, ",");
    if (*line) *line++ = 0;
  }
  return true;
}

/* Number of values read; anything but `columns` is a fault of the line. */
static int split_numbers(const char *line, int columns, double *values)
{
  for (int k = 0; k < columns; k++) {
    char *end;
    values[k] = strtod(line, &end);
    if (end == line || !isfinite(values[k])) return k;
    line = end + strspn(end, " \t");
    if (*line != (k + 1 < columns ? ',' : 0)) return k;
    if (*line) line++;
  }
  return columns;
}

static enum reference_status parse(const char *path, struct reference_table *table)
{
  char *rest = table->text, *line;
  const int lines = 1 + count_char(table->text, '\n') + count_char(table->text, '\r');
  for (int number = 1; (line = next_line(&rest)) != NULL; number++) {
    if (!is_data(line)) continue;
    if (!table->names) {
      if (!split_names(line, table)) break;
      table->values = malloc((size_t)lines * table->columns * sizeof *table->values);
      if (!table->values) break;
      continue;
    }
    double *row = table->values + (ptrdiff_t)table->rows * table->columns;
    const int good = split_numbers(line, table->columns, row);
    if (good != table->columns)
      return ref_fail(REFERENCE_BAD_FILE, "%s:%d: needs %d finite numbers, number %d is wrong",
                      path, number, table->columns, good + 1);
    table->rows++;
  }
  if (line) return ref_fail(REFERENCE_NO_MEMORY, "%s: no memory for the table", path);
  if (!table->rows) return ref_fail(REFERENCE_BAD_FILE, "%s: has no row of numbers", path);
  return REFERENCE_OK;
}

enum reference_status reference_table_read(const char *path, struct reference_table *table)
{
  memset(table, 0, sizeof *table);
  enum reference_status status = read_text(path, &table->text);
  if (!status) status = parse(path, table);
  if (status) reference_table_free(table);
  return status;
}

void reference_table_free(struct reference_table *table)
{
  free(table->names);
  free(table->values);
  free(table->text);
  memset(table, 0, sizeof *table);
}

int reference_table_column(const struct reference_table *table, const char *name)
{
  for (int k = 0; k < table->columns; k++)
    if (!strcmp(table->names[k], name)) return k;
  return -1;
}

double reference_table_at(const struct reference_table *table, struct reference_columns c, double x)
{
  if (c.x < 0 || c.y < 0 || c.x >= table->columns || c.y >= table->columns) return NAN;
  return linear((struct column){table->values + c.x, table->rows, table->columns},
                (struct column){table->values + c.y, table->rows, table->columns}, x);
}

/* ---- outlines ---- */

enum reference_status reference_outline_read(const char *path, struct reference_outline *outline)
{
  struct reference_table table;
  *outline = (struct reference_outline){0, NULL};
  enum reference_status status = reference_table_read(path, &table);
  if (status) return status;
  const int x = reference_table_column(&table, "x"), y = reference_table_column(&table, "y");
  if (x < 0 || y < 0 || table.rows < 3) {
    status = ref_fail(REFERENCE_BAD_FILE, "%s: an outline needs columns x, y and 3 rows", path);
  } else if (!(outline->points = malloc(table.rows * sizeof *outline->points))) {
    status = ref_fail(REFERENCE_NO_MEMORY, "%s: no memory for the outline", path);
  } else {
    outline->count = table.rows;
    for (int i = 0; i < table.rows; i++) {
      const double *row = table.values + (ptrdiff_t)i * table.columns;
      outline->points[i] = (struct reference_vec){row[x], row[y]};
    }
  }
  reference_table_free(&table);
  return status;
}

void reference_outline_free(struct reference_outline *outline)
{
  free(outline->points);
  *outline = (struct reference_outline){0, NULL};
}

bool reference_outline_contains(const struct reference_outline *outline, struct reference_vec p)
{
  bool odd = false;
  for (int i = 0; i < outline->count; i++) {
    const struct reference_vec a = outline->points[i];
    const struct reference_vec b = outline->points[(i + 1) % outline->count];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x))
      odd = !odd;
  }
  return odd;
}

double reference_outline_area(const struct reference_outline *outline)
{
  double twice = 0;
  for (int i = 0; i < outline->count; i++) {
    const struct reference_vec a = outline->points[i];
    const struct reference_vec b = outline->points[(i + 1) % outline->count];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

double reference_outline_distance(const struct reference_outline *outline, struct reference_vec p)
{
  double nearest = INFINITY;
  for (int i = 0; i < outline->count; i++) {
    const struct reference_vec a = outline->points[i];
    const struct reference_vec b = outline->points[(i + 1) % outline->count];
    const double ux = b.x - a.x, uy = b.y - a.y, length2 = sq(ux) + sq(uy);
    double s = length2 > 0 ? ((p.x - a.x) * ux + (p.y - a.y) * uy) / length2 : 0;
    s = fmin(1, fmax(0, s));
    nearest = fmin(nearest, hypot(a.x + s * ux - p.x, a.y + s * uy - p.y));
  }
  return nearest;
}
