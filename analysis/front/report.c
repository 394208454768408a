/* `sphbench report DIR -o FILE.html`: one page that needs no other file. */
#include "report.h"

#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "front.h"
#include "runs.h"

static int same_run(const struct journal_entry *a, const struct journal_entry *b)
{
  return !strcmp(a->scene, b->scene) && !strcmp(a->solver, b->solver) && !strcmp(a->what, b->what);
}

int report_is_last(const struct journal *journal, int k)
{
  for (int later = k + 1; later < journal->n; later++)
    if (same_run(&journal->entry[k], &journal->entry[later])) return 0;
  return 1;
}

/* Runs of precision and convergence are many, and have figures and tables of their own. */
static int is_measurement(const struct journal_entry *entry)
{
  return strstr(entry->what, "--count-pairs") != NULL;
}

static int by_name(const void *a, const void *b)
{
  const struct journal_entry *x = ((const struct report_run *)a)->entry;
  const struct journal_entry *y = ((const struct report_run *)b)->entry;
  const int scene = strcmp(x->scene, y->scene), solver = strcmp(x->solver, y->solver);
  return scene ? scene : solver ? solver : strcmp(x->what, y->what);
}

/* Of runs that were done with several builds the last one counts. */
static status load_runs(struct report *r)
{
  TRY(journal_open(&r->journal, r->results, 0));
  r->run = calloc((size_t)r->journal.n + 1, sizeof *r->run);
  if (!r->run) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < r->journal.n; k++) {
    const struct journal_entry *entry = &r->journal.entry[k];
    if (!report_is_last(&r->journal, k) || is_measurement(entry)) continue;
    const struct path path = run_file(r->results, entry->id, "json");
    const int has_facts = entry->outcome == OUTCOME_OK || entry->outcome == OUTCOME_DIVERGED;
    json_t *facts = has_facts ? json_load_file(path.text, 0, NULL) : NULL;
    r->run[r->num_runs++] = (struct report_run){entry, facts};
  }
  qsort(r->run, (size_t)r->num_runs, sizeof *r->run, by_name);
  return OK;
}

static int by_order(const void *a, const void *b)
{
  const json_t *x = ((const struct report_figure *)a)->facts;
  const json_t *y = ((const struct report_figure *)b)->facts;
  const json_int_t i = json_integer_value(json_object_get(x, "order"));
  const json_int_t j = json_integer_value(json_object_get(y, "order"));
  return (i > j) - (i < j);
}

static status add_figure(struct report *r, struct path folder, struct path pictures, json_t *facts)
{
  if (!facts) return OK;
  struct report_figure *more = realloc(r->figure, (size_t)(r->num_figures + 1) * sizeof *r->figure);
  if (!more) {
    json_decref(facts);
    return status_set(ERR_MEMORY, "out of memory");
  }
  r->figure = more;
  r->figure[r->num_figures++] = (struct report_figure){folder, pictures, facts};
  return OK;
}

static status load_recipes(struct report *r)
{
  const struct path figures = path_of("%s/figures", r->results);
  struct names names = folder_names(figures.text);
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    const struct path folder = path_of("%s/%s", figures.text, names.name[k]);
    const struct path path = path_of("%s/figure.json", folder.text);
    result = add_figure(r, folder, figures, json_load_file(path.text, 0, NULL));
  }
  names_free(&names);
  return result;
}

/* What precision, convergence and profile have drawn lies beside its data, some folders down. */
static status load_measured(struct report *r, struct path folder, int depth)
{
  static const char ending[] = ".figure.json";
  struct names names = folder_names(folder.text);
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    const struct path path = path_of("%s/%s", folder.text, names.name[k]);
    const size_t length = strlen(names.name[k]), end = sizeof ending - 1;
    if (depth > 0 && path_is_folder(path.text))
      result = load_measured(r, path, depth - 1);
    else if (length > end && strcmp(names.name[k] + length - end, ending) == 0)
      result = add_figure(r, folder, folder, json_load_file(path.text, 0, NULL));
  }
  names_free(&names);
  return result;
}

static status load_figures(struct report *r)
{
  TRY(load_recipes(r));
  TRY(load_measured(r, path_of("%s/precision", r->results), 2));
  TRY(load_measured(r, path_of("%s/convergence", r->results), 2));
  if (r->num_figures > 0) qsort(r->figure, (size_t)r->num_figures, sizeof *r->figure, by_order);
  return OK;
}

static void report_free(struct report *r)
{
  for (int k = 0; k < r->num_runs; k++) json_decref(r->run[k].facts);
  for (int k = 0; k < r->num_figures; k++) json_decref(r->figure[k].facts);
  free(r->run);
  free(r->figure);
  journal_close(&r->journal);
}

static void write_page(FILE *page, const struct report *r)
{
  page_begin(page, r);
  page_figures(page, r, SORT_MEASURED);
  page_figures(page, r, SORT_FRAMES);
  page_metrics(page, r);
  page_figures(page, r, SORT_CURVES);
  page_compatibility(page, r);
  page_runs(page, r);
  page_origin(page, r);
  page_end(page);
}

static status write_report(struct report *r, const char *out)
{
  struct new_file file;
  TRY(load_runs(r));
  TRY(load_figures(r));
  if (r->num_runs == 0 && r->num_figures == 0)
    return user_error("report: '%s' holds no results (no run in journal.jsonl)", r->results);
  TRY(file_begin(&file, out));
  write_page(file.stream, r);
  return file_commit(&file);
}

status verb_report(int argc, char **argv)
{
  const char *results = NULL, *out = NULL;
  const struct flag flags[] = {{"-o", &out, NULL}};
  const struct arguments what = {"report", flags, 1, &results, 1, NULL};
  TRY(arguments_parse(&what, argc, argv));
  if (!results) return user_error("report: the folder of the results is missing");
  if (!out) return user_error("report: -o FILE.html is missing");
  if (!path_is_folder(results)) return user_error("report: there is no folder '%s'", results);
  struct report report = {.results = results, .journal = {.file = -1}};
  const status result = write_report(&report, out);
  report_free(&report);
  if (result == OK) printf("%s\n", out);
  return result;
}
