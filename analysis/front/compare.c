/* `sphbench compare` and `sphbench bless`: results against a baseline, and a new baseline. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../../core/io/provenance.h"
#include "arguments.h"
#include "baseline.h"
#include "front.h"
#include "json_out.h"

enum { MOST_LINES = 20 }; /* of the table that people read */

struct request {
  const char *names[2]; /* results, baseline */
  int num_names;
  const char *junit, *json, *reason;
  int bitwise, all;
};

static status parse(struct request *r, const char *verb, int argc, char **argv)
{
  const struct flag flags[] = {{"--junit", &r->junit, NULL},
                               {"--json", &r->json, NULL},
                               {"--bitwise", NULL, &r->bitwise},
                               {"--all", NULL, &r->all},
                               {"--reason", &r->reason, NULL}};
  enum { NUM_OF_COMPARE = 4 };
  const int is_bless = strcmp(verb, "bless") == 0;
  const struct arguments what = {verb,
                                 is_bless ? flags + NUM_OF_COMPARE : flags,
                                 is_bless ? 1 : NUM_OF_COMPARE,
                                 r->names,
                                 2,
                                 &r->num_names};
  *r = (struct request){.num_names = 0};
  TRY(arguments_parse(&what, argc, argv));
  if (r->num_names == 2) return OK;
  return user_error("%s: RESULTS and BASELINE.json are needed, %d name%s found", verb, r->num_names,
                    r->num_names == 1 ? "" : "s");
}

/* --- what people read */

static void print_row(const struct comparison *row)
{
  printf("%-4s  %-24s %13.6g %13.6g %10.2g  %s%s%s\n", row->pass ? "ok" : "FAIL", row->name,
         row->value, row->baseline, row->tolerance, row->run, *row->note ? ": " : "", row->note);
}

/* Worst first; what passes is told only as far as there is room, if not all is asked for. */
static void print_table(const struct comparisons *all, int every)
{
  const int room = every ? all->n : MOST_LINES;
  printf("%-4s  %-24s %13s %13s %10s  %s\n", "", "metric", "value", "baseline", "gate", "run");
  for (int k = 0; k < all->n && (k < room || !all->row[k].pass); k++) print_row(&all->row[k]);
  if (all->n > room && all->row[room].pass)
    printf("... and %d more that pass (--all shows them)\n", all->n - room);
  printf("%d values and parts of curves of %d runs compared, %d failed; gate: the smallest change "
         "that would have been caught\n",
         all->n, all->runs, all->failed);
  printf("%d runs are the same in every bit, %d were made by the same compiler and flags\n",
         all->identical, all->same_build);
  if (all->extra)
    printf("warning: %d runs or metrics are not in the baseline (bless adds them)\n", all->extra);
}

/* --- what machines read */

static json_t *rows_json(const struct comparisons *all)
{
  json_t *rows = json_array();
  for (int k = 0; k < all->n; k++) {
    const struct comparison *row = &all->row[k];
    json_array_append_new(rows, json_pack("{s:s, s:s, s:o, s:o, s:o, s:b, s:s}", "run", row->run,
                                          "name", row->name, "value", json_out_number(row->value),
                                          "baseline", json_out_number(row->baseline), "tolerance",
                                          json_out_number(row->tolerance), "pass", row->pass,
                                          "note", row->note));
  }
  return rows;
}

static status write_text(const char *path, const char *text)
{
  struct new_file file;
  if (!text) return status_set(ERR_MEMORY, "out of memory");
  if (strcmp(path, "-") == 0) return fputs(text, stdout) < 0 ? ERR_IO : OK;
  TRY(file_begin(&file, path));
  fputs(text, file.stream);
  return file_commit(&file);
}

static void put_xml(FILE *out, const char *text)
{
  for (; *text; text++) switch (*text) {
    case '<': fputs("&lt;", out); break;
    case '>': fputs("&gt;", out); break;
    case '&': fputs("&amp;", out); break;
    case '"': fputs("&quot;", out); break;
    default: fputc((unsigned char)*text < 32 ? ' ' : *text, out);
    }
}

/* A metric is a test case of the class that is its run. */
static status write_junit(const char *path, const struct comparisons *all)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) return status_set(ERR_MEMORY, "out of memory");
  fprintf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
  fprintf(out, "<testsuite name=\"sphbench\" tests=\"%d\" failures=\"%d\">\n", all->n, all->failed);
  for (int k = 0; k < all->n; k++) {
    const struct comparison *row = &all->row[k];
    fprintf(out, " <testcase classname=\"");
    put_xml(out, row->run);
    fprintf(out, "\" name=\"");
    put_xml(out, row->name);
    if (row->pass) {
      fprintf(out, "\"/>\n");
      continue;
    }
    fprintf(out, "\"><failure message=\"%.9g, baseline %.9g, tolerance %.3g ", row->value,
            row->baseline, row->tolerance);
    put_xml(out, row->note);
    fprintf(out, "\"/></testcase>\n");
  }
  fprintf(out, "</testsuite>\n");
  fclose(out);
  const status result = write_text(path, text);
  free(text);
  return result;
}

/* --- compare */

static status report(const struct request *r, const struct comparisons *all)
{
  const int to_stdout = (r->json && !strcmp(r->json, "-")) || (r->junit && !strcmp(r->junit, "-"));
  if (!to_stdout) print_table(all, r->all);
  if (r->json)
    TRY(json_out_finish(json_pack("{s:i, s:i, s:i, s:i, s:i, s:o}", "compared", all->n, "failed",
                                  all->failed, "unknown", all->extra, "identical", all->identical,
                                  "same_build", all->same_build, "metrics", rows_json(all)),
                        r->json, NULL));
  if (r->junit) TRY(write_junit(r->junit, all));
  if (all->runs == 0)
    return user_error("nothing was compared: no run of '%s' is in '%s'", r->names[0], r->names[1]);
  if (all->failed == 0) return OK;
  return status_set(ERR_WORSE, "%d of %d values differ from the baseline, the worst is %s of %s",
                    all->failed, all->n, all->row[0].name, all->row[0].run);
}

status verb_compare(int argc, char **argv)
{
  struct request r;
  json_t *runs = NULL, *baseline = NULL;
  struct comparisons all = {.n = 0};
  TRY(parse(&r, "compare", argc, argv));
  all.bitwise = r.bitwise;
  status result = baseline_read(r.names[1], &baseline);
  if (result == OK)
    result = baseline_collect(r.names[0], json_object_get(baseline, "curves"), NULL, &runs);
  if (result == OK) result = baseline_compare(runs, baseline, &all);
  if (result == OK) result = report(&r, &all);
  free(all.row);
  json_decref(runs);
  json_decref(baseline);
  return result;
}

/* --- bless */

static json_t *empty_baseline(void)
{
  return json_pack("{s:s, s:o, s:o, s:o, s:{}, s:{}, s:[]}", "about", "Written by `sphbench bless`",
                   "rules", baseline_default_rules(), "curves", baseline_default_curves(), "seeds",
                   baseline_default_seeds(), "builds", "runs", "history");
}

static void add_history(json_t *baseline, const char *reason, int changes)
{
  char date[32];
  const time_t now = time(NULL);
  struct tm utc;
  struct provenance built;
  provenance_fill(&built, 1, 0, NULL);
  strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  json_array_append_new(json_object_get(baseline, "history"),
                        json_pack("{s:s, s:s, s:s, s:i}", "date", date, "commit", built.commit,
                                  "reason", reason, "changes", changes));
}

/* What changes, failed or not counted as new. Returns the number of changed values. */
static int show_changes(const struct comparisons *all, int *missing)
{
  int changed = 0;
  *missing = 0;
  for (int k = 0; k < all->n && !all->row[k].pass; k++) {
    const int is_missing = strcmp(all->row[k].name, "run") == 0;
    if (!is_missing) print_row(&all->row[k]);
    *missing += is_missing;
    changed += !is_missing;
  }
  return changed;
}

/* Runs that were not repeated stay as they are. */
static status bless(const struct request *r, json_t *baseline, const json_t *runs)
{
  struct comparisons all = {.n = 0};
  const char *key;
  json_t *run, *known = json_object_get(baseline, "runs");
  int fresh = 0, missing;
  TRY(baseline_compare(runs, baseline, &all));
  const int changed = show_changes(&all, &missing);
  free(all.row);
  json_object_foreach((json_t *)runs, key, run)
  {
    if (!json_object_get(known, key)) {
      printf("new   %s\n", key);
      fresh++;
    }
    json_object_set(known, key, run);
  }
  printf("%d values changed, %d runs are new, %d were not repeated and stay\n", changed, fresh,
         missing);
  add_history(baseline, r->reason, changed + fresh);
  return baseline_write(r->names[1], baseline);
}

status verb_bless(int argc, char **argv)
{
  struct request r;
  json_t *runs = NULL, *baseline = NULL;
  TRY(parse(&r, "bless", argc, argv));
  if (!r.reason || strspn(r.reason, " \t\r\n") == strlen(r.reason))
    return user_error("bless: --reason TEXT is needed: why may the results change?");
  status result = OK;
  if (path_is_file(r.names[1]))
    result = baseline_read(r.names[1], &baseline);
  else
    baseline = empty_baseline();
  if (result == OK)
    result = baseline_collect(r.names[0], json_object_get(baseline, "curves"),
                              json_object_get(baseline, "builds"), &runs);
  if (result == OK) result = bless(&r, baseline, runs);
  json_decref(runs);
  json_decref(baseline);
  return result;
}
