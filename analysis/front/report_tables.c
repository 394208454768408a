/* Tables of the report: metrics of each scene, what was not run and why, and where it is from. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "html.h"
#include "report.h"

enum { MOST_COLUMNS = 64 };

static double number_in(const json_t *value)
{
  return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static double metric_of(const json_t *facts, const char *name)
{
  return number_in(
    json_object_get(json_object_get(json_object_get(facts, "metrics"), name), "value"));
}

/* Runs first .. last-1 are of one scene. */
struct part {
  const struct report *report;
  int first, last;
  const char *scene;
  const char *metric[MOST_COLUMNS], *unit[MOST_COLUMNS]; /* those that some run has a value of */
  int num_metrics, same_arguments;
};

static void collect_metrics(struct part *p)
{
  for (int k = p->first; k < p->last; k++) {
    json_t *metrics = json_object_get(p->report->run[k].facts, "metrics"), *metric;
    const char *name;
    json_object_foreach(metrics, name, metric)
    {
      int known =
        isnan(number_in(json_object_get(metric, "value"))) || p->num_metrics == MOST_COLUMNS;
      for (int c = 0; c < p->num_metrics; c++) known |= strcmp(name, p->metric[c]) == 0;
      if (known) continue;
      const char *unit = json_string_value(json_object_get(metric, "unit"));
      p->metric[p->num_metrics] = name;
      p->unit[p->num_metrics++] = unit ? unit : "";
    }
  }
}

static struct part part_at(const struct report *r, int first)
{
  struct part p = {.report = r,
                   .first = first,
                   .last = first,
                   .scene = r->run[first].entry->scene,
                   .same_arguments = 1};
  while (p.last < r->num_runs && strcmp(r->run[p.last].entry->scene, p.scene) == 0) {
    if (strcmp(r->run[p.last].entry->what, r->run[first].entry->what) != 0) p.same_arguments = 0;
    p.last++;
  }
  collect_metrics(&p);
  return p;
}

/* --- metrics --- */

static void put_number(FILE *page, double value)
{
  if (isnan(value))
    fputs("<td class=soft>\xE2\x80\x93</td>", page); /* en dash */
  else
    fprintf(page, "<td>%.4g</td>", value);
}

static void put_outcome(FILE *page, enum outcome outcome)
{
  html_put(page, outcome == OUTCOME_OK ? "<td class=good>%s</td>" : "<td class=bad>%s</td>",
           outcome_words[outcome]);
}

static void put_row(FILE *page, const struct part *p, const struct report_run *run)
{
  const json_t *timing = json_object_get(run->facts, "timing");
  const json_t *iterations = json_object_get(run->facts, "iterations");
  html_put(page, "<tr><td>%s</td>", run->entry->solver);
  if (!p->same_arguments) html_put(page, "<td><code>%s</code></td>", run->entry->what);
  put_outcome(page, run->entry->outcome);
  put_number(page, number_in(json_object_get(run->facts, "time_end")));
  put_number(page, number_in(json_object_get(run->facts, "particles")));
  put_number(page, number_in(json_object_get(iterations, "mean")));
  put_number(page, 1e3 * number_in(json_object_get(timing, "per_step")));
  for (int c = 0; c < p->num_metrics; c++) put_number(page, metric_of(run->facts, p->metric[c]));
  fputs("</tr>\n", page);
}

static void put_scene(FILE *page, const struct part *p)
{
  const struct report_run *first = &p->report->run[p->first];
  html_put(page, "<h3>%s</h3>\n", p->scene);
  if (p->same_arguments)
    html_put(page, "<p class=origin><code>sphbench run %s --solver NAME %s</code></p>\n", p->scene,
             first->entry->what);
  fputs("<div class=scroll><table class=sortable><thead><tr><th>solver</th>", page);
  if (!p->same_arguments) fputs("<th>arguments</th>", page);
  fputs("<th>ended</th><th>reached<small>s</small></th><th>particles</th>"
        "<th>iterations<small>per step</small></th><th>time<small>ms per step</small></th>",
        page);
  for (int c = 0; c < p->num_metrics; c++)
    html_put(page, "<th>%s<small>%s</small></th>", p->metric[c], p->unit[c]);
  fputs("</tr></thead><tbody>\n", page);
  for (int k = p->first; k < p->last; k++)
    if (p->report->run[k].facts) put_row(page, p, &p->report->run[k]);
  fputs("</tbody></table></div>\n", page);
}

void page_metrics(FILE *page, const struct report *r)
{
  fputs("<h2 id=metrics>Metrics at the end</h2>\n<p>Click a head to sort. <code>sphbench show "
        "METRIC</code> says what a metric is. Units in 2-D are per metre of depth. Times per step "
        "were taken on one core each while other runs went on beside.</p>\n",
        page);
  for (int k = 0; k < r->num_runs;) {
    const struct part p = part_at(r, k);
    int with_facts = 0;
    for (int i = p.first; i < p.last; i++) with_facts += r->run[i].facts != NULL;
    if (with_facts) put_scene(page, &p);
    k = p.last;
  }
}

/* --- compatibility --- */

struct axis {
  const char *name[256];
  int n;
};

static void add_name(struct axis *axis, const char *name)
{
  for (int k = 0; k < axis->n; k++)
    if (strcmp(axis->name[k], name) == 0) return;
  if (axis->n < 256) axis->name[axis->n++] = name;
}

/* The worst of what a solver's runs of a scene became. */
static void put_cell(FILE *page, const struct report *r, const char *solver, const char *scene)
{
  const struct journal_entry *worst = NULL;
  int ok = 0, n = 0;
  for (int k = 0; k < r->num_runs; k++) {
    const struct journal_entry *e = r->run[k].entry;
    if (strcmp(e->solver, solver) || strcmp(e->scene, scene)) continue;
    n++;
    ok += e->outcome == OUTCOME_OK;
    if (!worst || e->outcome > worst->outcome) worst = e;
  }
  if (!worst) {
    fputs("<td class=soft>not asked for</td>", page);
  } else if (ok == n) {
    fputs("<td class=good>ok</td>", page);
  } else {
    html_put(page, "<td><span class=bad>%s</span>: %s", outcome_words[worst->outcome],
             worst->reason);
    if (n > 1) fprintf(page, " (%d of %d runs ok)", ok, n);
    fputs("</td>", page);
  }
}

void page_compatibility(FILE *page, const struct report *r)
{
  struct axis solvers = {.n = 0}, scenes = {.n = 0};
  for (int k = 0; k < r->num_runs; k++) {
    add_name(&solvers, r->run[k].entry->solver);
    add_name(&scenes, r->run[k].entry->scene);
  }
  fputs("<h2 id=compatibility>What was not run or failed</h2>\n<p>A run that diverges is a result. "
        "A solver that was refused a scene lacks something that the scene asks for.</p>\n"
        "<div class=scroll><table class=words><thead><tr><th>solver</th>",
        page);
  for (int c = 0; c < scenes.n; c++) html_put(page, "<th>%s</th>", scenes.name[c]);
  fputs("</tr></thead><tbody>\n", page);
  for (int k = 0; k < solvers.n; k++) {
    html_put(page, "<tr><td>%s</td>", solvers.name[k]);
    for (int c = 0; c < scenes.n; c++) put_cell(page, r, solvers.name[k], scenes.name[c]);
    fputs("</tr>\n", page);
  }
  fputs("</tbody></table></div>\n", page);
}

/* --- origin --- */

static const char *text_in(const json_t *object, const char *key)
{
  const char *text = json_string_value(json_object_get(object, key));
  return text ? text : "";
}

/* All different values of one fact of origin, as a row. */
static void put_origin(FILE *page, const struct report *r, const char *title, const char *key)
{
  struct axis values = {.n = 0};
  for (int k = 0; k < r->num_runs; k++) {
    const char *text = text_in(json_object_get(r->run[k].facts, "provenance"), key);
    if (*text) add_name(&values, text);
  }
  if (!values.n) return;
  html_put(page, "<tr><td>%s</td><td>", title);
  for (int k = 0; k < values.n; k++) html_put(page, k ? "<br>%s" : "%s", values.name[k]);
  fputs("</td></tr>\n", page);
}

static void put_dates(FILE *page, const struct report *r)
{
  const char *first = NULL, *last = NULL;
  for (int k = 0; k < r->num_runs; k++) {
    const char *date = text_in(json_object_get(r->run[k].facts, "provenance"), "date");
    if (!*date) continue;
    if (!first || strcmp(date, first) < 0) first = date;
    if (!last || strcmp(date, last) > 0) last = date;
  }
  if (first) html_put(page, "<tr><td>Dates</td><td>%s to %s</td></tr>\n", first, last);
}

static void put_libraries(FILE *page, const struct report *r)
{
  for (int k = 0; k < r->num_runs; k++) {
    json_t *p = json_object_get(r->run[k].facts, "provenance"), *version;
    json_t *libraries = json_object_get(p, "libraries");
    const char *name, *between = "";
    if (!json_object_size(libraries)) continue;
    fputs("<tr><td>Libraries</td><td>", page);
    json_object_foreach(libraries, name, version)
    {
      html_put(page, "%s%s %s", between, name, json_string_value(version));
      between = ", ";
    }
    fputs("</td></tr>\n", page);
    return;
  }
}

static int any_dirty(const struct report *r)
{
  int dirty = 0;
  for (int k = 0; k < r->num_runs; k++) {
    const json_t *p = json_object_get(r->run[k].facts, "provenance");
    dirty |= json_is_true(json_object_get(p, "dirty"));
  }
  return dirty;
}

void page_origin(FILE *page, const struct report *r)
{
  struct axis variants = {.n = 0};
  for (int k = 0; k < r->num_runs; k++) add_name(&variants, r->run[k].entry->variant);
  fputs("<h2 id=origin>Origin</h2>\n<div class=scroll><table class=words><tbody>\n", page);
  put_origin(page, r, "Commit", "commit");
  if (any_dirty(r))
    fputs("<tr><td>Sources</td><td class=bad>differ from the commit</td></tr>\n", page);
  put_origin(page, r, "Compiler", "compiler");
  put_origin(page, r, "Flags", "flags");
  put_origin(page, r, "CPU", "cpu");
  put_origin(page, r, "GPU", "gpu");
  put_libraries(page, r);
  fputs("<tr><td>Variants</td><td>", page);
  for (int k = 0; k < variants.n; k++) html_put(page, k ? ", %s" : "%s", variants.name[k]);
  fputs("</td></tr>\n", page);
  put_dates(page, r);
  fputs("</tbody></table></div>\n", page);
}
