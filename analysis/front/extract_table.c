/* Tables: numbers of the runs, with those of a paper beside them; as data, CSV and Markdown. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "figure.h"

enum { MOST_TABLE_COLUMNS = 64 };

/* cell[0][...] are the heads; a row's first cell is the label of its run. */
struct table {
  char *(*cell)[MOST_TABLE_COLUMNS];
  int rows, columns;
};

static status table_begin(struct table *t, int rows)
{
  *t = (struct table){.cell = calloc((size_t)rows + 1, sizeof *t->cell), .rows = rows};
  return t->cell ? OK : status_set(ERR_MEMORY, "out of memory");
}

static void table_free(struct table *t)
{
  for (int r = 0; t->cell && r <= t->rows; r++)
    for (int c = 0; c < MOST_TABLE_COLUMNS; c++) free(t->cell[r][c]);
  free(t->cell);
}

/* --- ours --- */

static char *cell_of(const json_t *facts, const char *column)
{
  const json_t *fact = json_object_get(facts, column);
  if (json_is_string(fact)) return strdup(json_string_value(fact));
  const double value = fact_value(facts, column);
  return isfinite(value) ? text_make("%.5g", value) : strdup("-");
}

static void put_heads(struct table *t, const struct recipe_extract *e, const json_t *facts)
{
  t->cell[0][0] = strdup("run");
  t->columns = 1;
  for (unsigned c = 0; c < e->num_columns; c++) {
    const int is_word = json_is_string(json_object_get(facts, e->columns[c]));
    t->cell[0][t->columns++] =
      is_word ? strdup(e->columns[c])
              : text_make("%s [%s]", e->columns[c], fact_unit(facts, e->columns[c]));
  }
}

/* A run without facts has its outcome in place of its status. */
static void put_row(struct table *t, int row, const struct recipe_extract *e, const struct run *run,
                    json_t *facts)
{
  for (unsigned c = 0; c < e->num_columns; c++) {
    char **cell = &t->cell[row][1 + c];
    if (!facts && strcmp(e->columns[c], "status") == 0)
      *cell = strdup(run->finished ? outcome_words[run->outcome] : "not run");
    else
      *cell = cell_of(facts, e->columns[c]);
  }
}

static status put_ours(struct figure *f, const struct queue *queue, struct table *t)
{
  const struct recipe_extract *e = &f->recipe->extract;
  for (int k = 0; k < f->n; k++) {
    json_t *facts = run_facts_json(queue, f->cases[k].run);
    if (facts && !t->columns) put_heads(t, e, facts);
    t->cell[k + 1][0] = strdup(f->cases[k].label);
    put_row(t, k + 1, e, &queue->run[f->cases[k].run], facts);
    json_decref(facts);
  }
  return t->columns ? OK : user_error("%s: none of its runs has a result", f->recipe->name);
}

/* --- the paper's --- */

/* The next field of a line of CSV, without its quotes; *line goes on behind it, NULL at the end. */
static char *next_field(char **line)
{
  char *field = *line, *to = field, *from = field;
  int quoted = 0;
  for (; *from && (quoted || *from != ','); from++) {
    if (*from == '"' && quoted && from[1] == '"')
      *to++ = *from++;
    else if (*from == '"')
      quoted = !quoted;
    else
      *to++ = *from;
  }
  *line = *from ? from + 1 : NULL;
  *to = '\0';
  return field;
}

static int row_of(const struct table *t, const char *label)
{
  for (int r = 1; r <= t->rows; r++)
    if (strcmp(t->cell[r][0], label) == 0) return r;
  return 0;
}

/* Fields behind the first of a line, into the columns from `first` on. */
static int put_fields(struct table *t, int row, int first, char *line)
{
  int column = first;
  while (line && column < MOST_TABLE_COLUMNS) {
    free(t->cell[row][column]);
    t->cell[row][column++] = strdup(next_field(&line));
  }
  return column;
}

static status put_line(struct table *t, int first, char *line, const char *path)
{
  const char *label = next_field(&line);
  const int row = row_of(t, label);
  if (!row) return user_error("%s: no run of the figure is called '%s'", path, label);
  put_fields(t, row, first, line);
  return OK;
}

static status put_lines(struct table *t, char *text, const char *path)
{
  const int first = t->columns;
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));) {
    if (!*line || *line == '#') continue;
    if (t->columns > first) {
      TRY(put_line(t, first, line, path));
      continue;
    }
    next_field(&line);
    t->columns = put_fields(t, 0, first, line);
    for (int r = 1; r <= t->rows; r++)
      for (int c = first; c < t->columns; c++) t->cell[r][c] = strdup("-");
  }
  return t->columns > first ? OK : user_error("%s: it has no heads 'run,...'", path);
}

static status put_beside(const struct figure *f, struct table *t)
{
  if (!f->recipe->extract.beside) return OK;
  const struct path path = path_of("%s/%s", f->folder.text, f->recipe->extract.beside->file);
  char *text;
  size_t size;
  TRY(file_read(path.text, &text, &size));
  const status result = put_lines(t, text, path.text);
  free(text);
  return result;
}

/* --- writing --- */

static char *head_text(const struct table *t)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  for (int c = 0; c < t->columns; c++) fprintf(out, "%s%s", c ? "|" : "", t->cell[0][c]);
  fclose(out);
  return text;
}

/* Columns are separated by tabs, since labels have blanks. */
static status write_data(struct figure *f, const struct table *t)
{
  struct new_file file;
  char *heads = head_text(t);
  const status begun = heads ? data_begin(f, &file, "table.dat", f->recipe->about, heads)
                             : status_set(ERR_MEMORY, "out of memory");
  free(heads);
  if (begun != OK) return begun;
  for (int r = 1; r <= t->rows; r++)
    for (int c = 0; c < t->columns; c++)
      fprintf(file.stream, "%s%c", t->cell[r][c] ? t->cell[r][c] : "-",
              c + 1 < t->columns ? '\t' : '\n');
  return file_commit(&file);
}

static status write_csv(const struct figure *f, const struct table *t)
{
  const struct path path = path_of("%s/%s.csv", f->out.text, f->recipe->name);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  for (int r = 0; r <= t->rows; r++)
    for (int c = 0; c < t->columns; c++) {
      const char *quote = strchr(t->cell[r][c], ',') ? "\"" : "";
      fprintf(file.stream, "%s%s%s%c", quote, t->cell[r][c], quote,
              c + 1 < t->columns ? ',' : '\n');
    }
  return file_commit(&file);
}

static status write_markdown(const struct figure *f, const struct table *t)
{
  const struct path path = path_of("%s/%s.md", f->out.text, f->recipe->name);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fprintf(file.stream, "# %s\n\n%s\n\n", f->recipe->about, f->recipe->statement);
  if (*f->size.text) fprintf(file.stream, "%s\n\n", f->size.text);
  for (int r = 0; r <= t->rows; r++) {
    for (int c = 0; c < t->columns; c++) fprintf(file.stream, "| %s ", t->cell[r][c]);
    fputs("|\n", file.stream);
    for (int c = 0; c < t->columns && r == 0; c++) fputs(c ? "|--:" : "|:--", file.stream);
    if (r == 0) fputs("|\n", file.stream);
  }
  if (f->recipe->extract.beside)
    fprintf(file.stream, "\nBeside: %s.\n", f->recipe->extract.beside->about);
  return file_commit(&file);
}

status extract_table(struct figure *f, const struct queue *queue, FILE *contents)
{
  struct table table;
  TRY(table_begin(&table, f->n));
  status result = put_ours(f, queue, &table);
  if (result == OK) result = put_beside(f, &table);
  if (result == OK) result = write_data(f, &table);
  if (result == OK) result = write_csv(f, &table);
  if (result == OK) result = write_markdown(f, &table);
  table_free(&table);
  put_text(contents, "table", 0, "table.dat");
  return result;
}
