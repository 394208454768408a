/* Figures of the report, each with its caption, the command that makes it, and its data. */
#include <stdlib.h>
#include <string.h>

#include "html.h"
#include "report.h"
#include "runs.h"

enum { MOST_SVG = 700 * 1024 /* bytes: thousands of particles are lighter as PNG */ };

static const char *text_in(const json_t *object, const char *key)
{
  const char *text = json_string_value(json_object_get(object, key));
  return text ? text : "";
}

/* --- pictures --- */

/* The file's name may differ from the figure's, which is unique. */
static struct path picture_path(const struct report_figure *figure, const char *kind)
{
  const char *name = text_in(figure->facts, "name"), *file = text_in(figure->facts, "picture");
  return path_of("%s/%s.%s", figure->pictures.text, *file ? file : name, kind);
}

static void put_png(FILE *page, const struct report_figure *figure)
{
  const json_t *facts = figure->facts;
  const struct path path = picture_path(figure, "png");
  char *png;
  size_t size;
  if (file_read(path.text, &png, &size) != OK) {
    html_put(page, "<p class=gap>The picture %s is missing.</p>\n", path.text);
    return;
  }
  html_put(page, "<img alt=\"%s\" src=\"data:image/png;base64,", text_in(facts, "about"));
  html_base64(page, png, size);
  fputs("\">\n", page);
  free(png);
}

static void put_picture(FILE *page, const struct report_figure *figure)
{
  const struct path path = picture_path(figure, "svg");
  char *svg = NULL;
  size_t size = 0;
  fputs("<div class=paper>", page);
  if (file_read(path.text, &svg, &size) == OK && size <= MOST_SVG)
    html_svg(page, svg, text_in(figure->facts, "name"));
  else
    put_png(page, figure);
  fputs("</div>\n", page);
  free(svg);
}

/* --- data --- */

static void put_field(FILE *out, const char *text, size_t length)
{
  const int quote = memchr(text, ',', length) || memchr(text, '"', length);
  if (quote) fputc('"', out);
  for (size_t k = 0; k < length; k++) {
    if (text[k] == '"') fputc('"', out);
    fputc(text[k], out);
  }
  if (quote) fputc('"', out);
}

/* One line of a .dat file; fields are separated by tabs if there is one, else by blanks. */
static void put_row(FILE *out, const char *series, char *line)
{
  const char *between = strchr(line, '\t') ? "\t" : " ";
  put_field(out, series, strlen(series));
  for (char *field; (field = strsep(&line, between));) {
    fputc(',', out);
    put_field(out, field, strlen(field));
  }
  fputc('\n', out);
}

static void put_file(FILE *out, const struct report_figure *figure, const json_t *file)
{
  const struct path path = path_of("%s/%s", figure->folder.text, text_in(file, "file"));
  char *text;
  size_t size;
  if (file_read(path.text, &text, &size) != OK) return;
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));)
    if (*line && *line != '#') put_row(out, text_in(file, "series"), line);
  free(text);
}

static void put_head(FILE *out, const json_t *columns)
{
  size_t k;
  json_t *column;
  fputs("series", out);
  json_array_foreach(columns, k, column)
  {
    const char *name = json_string_value(column);
    fputc(',', out);
    if (name) put_field(out, name, strlen(name));
  }
  fputc('\n', out);
}

static void put_names(FILE *page, const json_t *columns)
{
  size_t k;
  json_t *column;
  json_array_foreach(columns, k, column)
  {
    html_put(page, k ? ", %s" : "%s", json_string_value(column));
  }
}

/* All files that have the columns of file `first`, as one CSV link. */
static void put_csv(FILE *page, const struct report_figure *figure, json_t *files, size_t first)
{
  json_t *columns = json_object_get(json_array_get(files, first), "columns");
  char *csv = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&csv, &size);
  if (!out) return;
  put_head(out, columns);
  for (size_t k = first; k < json_array_size(files); k++) {
    const json_t *file = json_array_get(files, k);
    if (json_equal(json_object_get(file, "columns"), columns)) put_file(out, figure, file);
  }
  fclose(out);
  html_put(page, " <a download=\"%s-%s.csv\" href=\"data:text/csv;base64,",
           text_in(figure->facts, "name"), text_in(json_array_get(files, first), "file"));
  html_base64(page, csv, size);
  fputs("\">", page);
  put_names(page, columns);
  fputs("</a>", page);
  free(csv);
}

static int seen_before(json_t *files, size_t k)
{
  json_t *columns = json_object_get(json_array_get(files, k), "columns");
  for (size_t i = 0; i < k; i++)
    if (json_equal(json_object_get(json_array_get(files, i), "columns"), columns)) return 1;
  return 0;
}

static void put_data(FILE *page, const struct report_figure *figure)
{
  json_t *files = json_object_get(figure->facts, "files");
  fputs("<span>Data as CSV:", page);
  for (size_t k = 0; k < json_array_size(files); k++)
    if (!seen_before(files, k)) {
      if (k > 0) fputs(";", page);
      put_csv(page, figure, files, k);
    }
  fputs("</span>", page);
}

/* A table as a table. */
static void put_table(FILE *page, const struct report_figure *figure)
{
  const json_t *file = json_array_get(json_object_get(figure->facts, "files"), 0);
  const struct path path = path_of("%s/%s", figure->folder.text, text_in(file, "file"));
  char *text;
  size_t size, k;
  json_t *column;
  if (file_read(path.text, &text, &size) != OK) return;
  fputs("<div class=scroll><table class=sortable><thead><tr>", page);
  json_array_foreach(json_object_get(file, "columns"), k, column)
    html_put(page, "<th>%s</th>", json_string_value(column));
  fputs("</tr></thead><tbody>\n", page);
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));) {
    if (!*line || *line == '#') continue;
    fputs("<tr>", page);
    for (char *field; (field = strsep(&line, "\t"));) html_put(page, "<td>%s</td>", field);
    fputs("</tr>\n", page);
  }
  fputs("</tbody></table></div>\n", page);
  free(text);
}

/* --- where it is from --- */

struct origin {
  char commit[16], first[16], last[16]; /* the first letters; dates without the time */
  int runs, dirty, commits;
};

static void note_origin(struct origin *o, const json_t *provenance)
{
  const char *date = text_in(provenance, "date");
  char commit[sizeof o->commit], day[sizeof o->first];
  snprintf(commit, sizeof commit, "%.10s", text_in(provenance, "commit"));
  snprintf(day, sizeof day, "%.10s", date);
  o->commits += o->runs == 0 || strcmp(o->commit, commit) != 0;
  memcpy(o->commit, commit, sizeof commit);
  if (o->runs == 0 || strcmp(day, o->first) < 0) memcpy(o->first, day, sizeof day);
  if (o->runs == 0 || strcmp(day, o->last) > 0) memcpy(o->last, day, sizeof day);
  o->dirty |= json_is_true(json_object_get(provenance, "dirty"));
  o->runs++;
}

/* Of the runs that it was drawn from; nothing where its facts do not name them. */
static void put_provenance(FILE *page, const char *results, const json_t *facts)
{
  struct origin o = {.runs = 0};
  size_t k;
  json_t *id;
  json_array_foreach(json_object_get(facts, "runs"), k, id)
  {
    const char *name = json_string_value(id);
    const struct path path = run_file(results, name ? name : "", "json");
    json_t *run = json_load_file(path.text, 0, NULL);
    if (run) note_origin(&o, json_object_get(run, "provenance"));
    json_decref(run);
  }
  if (o.runs == 0) return;
  fprintf(page, "<span>From %d runs", o.runs);
  html_put(page, o.commits == 1 ? ", commit %s" : ", several commits, the last %s", o.commit);
  if (o.dirty) fputs(" with changes", page);
  html_put(page, strcmp(o.first, o.last) ? ", %s to %s" : ", %s", o.first, o.last);
  fputs("</span>", page);
}

static void put_figure(FILE *page, const char *results, const struct report_figure *figure)
{
  const json_t *facts = figure->facts;
  const char *command = text_in(facts, "command");
  html_put(page, "<figure id=\"%s\">\n<h3>%s</h3>\n", text_in(facts, "name"),
           text_in(facts, "about"));
  if (strcmp(text_in(facts, "kind"), "table") == 0)
    put_table(page, figure);
  else
    put_picture(page, figure);
  html_put(page, "<figcaption>%s</figcaption>\n<p class=origin><code>sphbench %s%s</code> ",
           text_in(facts, "statement"), *command ? "" : "figure ",
           *command ? command : text_in(facts, "name"));
  put_data(page, figure);
  put_provenance(page, results, facts);
  fputs("</p>\n</figure>\n", page);
}

enum figure_sort figure_sort_of(const struct report_figure *figure)
{
  const char *kind = text_in(figure->facts, "kind");
  if (strcmp(kind, "measured") == 0) return SORT_MEASURED;
  return strcmp(kind, "frames") == 0 ? SORT_FRAMES : SORT_CURVES;
}

void page_figures(FILE *page, const struct report *r, enum figure_sort sort)
{
  static const char *const titles[] = {[SORT_MEASURED] =
                                         "<h2 id=precision>Error against cost, and orders</h2>\n",
                                       [SORT_FRAMES] = "<h2 id=gallery>Gallery</h2>\n",
                                       [SORT_CURVES] = "<h2 id=figures>Figures</h2>\n"};
  int n = 0;
  for (int k = 0; k < r->num_figures; k++) {
    if (figure_sort_of(&r->figure[k]) != sort) continue;
    if (n++ == 0) fputs(titles[sort], page);
    put_figure(page, r->results, &r->figure[k]);
  }
}
