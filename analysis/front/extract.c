/* Data files of a figure: what its kinds have in common, and data from elsewhere drawn over it. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "figure.h"

/* --- for all kinds --- */

struct path data_name(const char *label, const char *suffix)
{
  struct path name = path_of("%s", label);
  char *to = name.text;
  for (const char *c = name.text; *c; c++) {
    const int plain = isalnum((unsigned char)*c) || strchr(".-+", *c);
    if (plain || (to > name.text && to[-1] != '-')) *to++ = plain ? *c : '-';
  }
  *to = '\0';
  struct path whole = path_of("%s%s.dat", name.text, suffix);
  if (*whole.text == '.') *whole.text = '-'; /* not hidden */
  return whole;
}

static json_t *split(const char *columns)
{
  json_t *list = json_array();
  for (const char *c = columns; *c;) {
    const size_t length = strcspn(c, "|");
    json_array_append_new(list, json_stringn(c, length));
    c += length + (c[length] == '|');
  }
  return list;
}

status data_begin(struct figure *figure, struct new_file *file, const char *name,
                  const char *series, const char *columns)
{
  const struct path path = path_of("%s/%s", figure->data.text, name);
  TRY(file_begin(file, path.text));
  fprintf(file->stream, "# %s\n# columns:", series);
  for (const char *c = columns; *c; c++) {
    if (c == columns || *c == '|') fputs(*c == '|' ? " | " : " ", file->stream);
    if (*c != '|') fputc(*c, file->stream);
  }
  fputc('\n', file->stream);
  json_array_append_new(figure->files, json_pack("{s:s, s:s, s:o}", "file", name, "series", series,
                                                 "columns", split(columns)));
  return OK;
}

void put_text(FILE *contents, const char *name, int number, const char *text)
{
  fputs(name, contents);
  if (number > 0) fprintf(contents, "[%d]", number);
  fputs(" = '", contents);
  for (const char *c = text ? text : ""; *c; c++) {
    if (*c == '\'') fputc('\'', contents); /* gnuplot's way to put a quote between quotes */
    if (*c != '\n') fputc(*c, contents);
  }
  fputs("'\n", contents);
}

json_t *run_facts_json(const struct queue *queue, int run)
{
  const struct run *r = &queue->run[run];
  if (!r->finished || (r->outcome != OUTCOME_OK && r->outcome != OUTCOME_DIVERGED)) return NULL;
  const struct path path = run_file(queue->results, r->id, "json");
  return json_load_file(path.text, 0, NULL);
}

void put_lists(FILE *contents, int n)
{
  const int room = n > 0 ? n : 1;
  fprintf(contents, "array file[%d]\narray title[%d]\narray colour[%d]\narray fit[%d]\n", room,
          room, room, room);
}

void put_curve(FILE *contents, int number, const char *file, const char *title, int colour)
{
  put_text(contents, "file", number, file);
  put_text(contents, "title", number, title);
  put_text(contents, "fit", number, "");
  fprintf(contents, "colour[%d] = %d\n", number, colour);
}

/* colour_dual_sc = 9: the line type of each solver. */
static void put_colours(const struct figure *f, FILE *contents)
{
  for (int k = 0; k < f->solvers->n; k++) {
    fputs("colour_", contents);
    for (const char *c = f->solvers->name[k]; *c; c++)
      fputc(isalnum((unsigned char)*c) ? *c : '_', contents);
    fprintf(contents, " = %d\n", k + 1);
  }
}

/* --- how large it is --- */

static struct path size_words(const struct figure *f, double low, double high)
{
  const char *word = !f->recipe->paper                                ? ""
                     : recipe_is_paper_size(f->recipe, f->paper_size) ? "paper size: "
                                                                      : "desk size: ";
  if (!(high > 0)) return path_of("%s", "");
  return low < high ? path_of("%s%.0f to %.0f particles", word, low, high)
                    : path_of("%s%.0f particles", word, high);
}

/* Every picture says it, in its corner. */
static void put_size(struct figure *f, const struct queue *queue, FILE *contents)
{
  double low = HUGE_VAL, high = 0, spacing = 0;
  for (int k = 0; k < f->n; k++) {
    json_t *facts = run_facts_json(queue, f->cases[k].run);
    if (!facts) continue;
    const double n = fact_value(facts, "particles");
    low = fmin(low, n);
    high = fmax(high, n);
    spacing = fmax(spacing, fact_value(facts, "parameters.spacing"));
    json_decref(facts);
  }
  f->size = size_words(f, low, high);
  put_text(contents, "size_note", 0, f->size.text);
  fputs("set label 99 size_note at screen 0.995, screen 0.02 right noenhanced font ',9' "
        "textcolor rgb '#666666'\n",
        contents);
  if (spacing > 0) fprintf(contents, "spacing = %.9g\n", spacing);
}

/* --- overlays --- */

static int copy_row(const struct recipe_overlay *o, const char *line, FILE *out)
{
  double x, y;
  if (sscanf(line, "%lf ,%lf", &x, &y) != 2) return 0; /* comment or head */
  fprintf(out, "%.8g %.8g\n", x * (o->scale_x != 0 ? o->scale_x : 1),
          y * (o->scale_y != 0 ? o->scale_y : 1));
  return 1;
}

static status write_overlay(struct figure *f, const struct recipe_overlay *o, const char *name)
{
  const struct path path = path_of("%s/%s", f->folder.text, o->file);
  struct new_file file;
  char *text;
  size_t size;
  int rows = 0;
  TRY(file_read(path.text, &text, &size));
  status result = data_begin(f, &file, name, o->about, "x|y");
  if (result == OK) {
    for (char *rest = text, *line; (line = strsep(&rest, "\n"));)
      rows += copy_row(o, line, file.stream);
    result = file_commit(&file);
  }
  free(text);
  if (result == OK && rows == 0)
    return user_error("%s: it has no rows 'x,y' of numbers", path.text);
  return result;
}

static status write_overlays(struct figure *f, FILE *contents)
{
  const unsigned n = f->recipe->num_overlays;
  fprintf(contents, "num_overlays = %u\n", n);
  fprintf(contents, "array overlay_file[%u]\narray overlay_title[%u]\narray overlay_time[%u]\n",
          n ? n : 1, n ? n : 1, n ? n : 1);
  for (unsigned k = 0; k < n; k++) {
    const struct recipe_overlay *o = &f->recipe->overlays[k];
    const struct path name = path_of("overlay-%u.dat", k + 1);
    TRY(write_overlay(f, o, name.text));
    put_text(contents, "overlay_file", (int)k + 1, name.text);
    put_text(contents, "overlay_title", (int)k + 1, o->title);
    fprintf(contents, "overlay_time[%u] = %.9g\n", k + 1, o->time);
  }
  return OK;
}

/* --- the whole --- */

/* What an older recipe wrote must not be taken for this one's. */
static void remove_old(const struct figure *f)
{
  struct names names = folder_names(f->data.text);
  for (int k = 0; k < names.n; k++) {
    const size_t length = strlen(names.name[k]);
    const struct path path = path_of("%s/%s", f->data.text, names.name[k]);
    if (length > 4 && strcmp(names.name[k] + length - 4, ".dat") == 0) unlink(path.text);
  }
  names_free(&names);
}

static status write_contents(struct figure *f, const struct queue *queue, FILE *contents)
{
  static status (*const extract[])(struct figure *, const struct queue *,
                                   FILE *) = {[EXTRACT_FRAMES] = extract_frames,
                                              [EXTRACT_SERIES] = extract_series,
                                              [EXTRACT_METRIC] = extract_metric,
                                              [EXTRACT_TABLE] = extract_table,
                                              [EXTRACT_PROGRAM] = extract_program};
  fprintf(contents, "# What there is to draw; written from recipe.yaml and the results.\n");
  put_text(contents, "label_x", 0, f->recipe->labels.x);
  put_text(contents, "label_y", 0, f->recipe->labels.y);
  put_text(contents, "label_colour", 0, f->recipe->labels.colour);
  put_colours(f, contents);
  put_size(f, queue, contents);
  TRY(extract[f->recipe->extract.kind](f, queue, contents));
  return write_overlays(f, contents);
}

status figure_extract(struct figure *f, const struct queue *queue)
{
  struct new_file file;
  TRY(folder_make(f->data.text));
  remove_old(f);
  json_decref(f->files);
  f->files = json_array();
  const struct path path = path_of("%s/contents.gp", f->data.text);
  TRY(file_begin(&file, path.text));
  const status result = write_contents(f, queue, file.stream);
  if (result == OK) return file_commit(&file);
  file_discard(&file);
  return result;
}
