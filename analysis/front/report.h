/* report.h - the parts of the page that `sphbench report` writes. */
#ifndef REPORT_H
#define REPORT_H
#include <jansson.h>
#include "journal.h"

/* A run as the journal has it last, with its facts. */
struct report_run {
  const struct journal_entry *entry;
  json_t *facts; /* NULL: it has none */
};

/* Is this the last time that the journal has run this scene, solver and arguments? */
int report_is_last(const struct journal *journal, int k);

struct report {
  const char *results;
  struct journal journal;
  struct report_run *run;
  int num_runs;
  struct report_figure {
    struct path folder, pictures; /* of its data; of its .svg and .png */
    json_t *facts;                /* figure.json */
  } * figure;
  int num_figures;
};

/* report_page.c: head with style and script; end. */
void page_begin(FILE *page, const struct report *report);
void page_end(FILE *page);

/* report_figures.c: figures of one sort. Pictures or data that are missing are said to be. */
enum figure_sort { SORT_MEASURED, SORT_FRAMES, SORT_CURVES }; /* errors against costs and orders */
enum figure_sort figure_sort_of(const struct report_figure *figure);
void page_figures(FILE *page, const struct report *report, enum figure_sort sort);

/* report_tables.c */
void page_metrics(FILE *page, const struct report *report);
void page_compatibility(FILE *page, const struct report *report);
void page_origin(FILE *page, const struct report *report);

/* report_runs.c: the state of every run that the journal knows, also of those that are only part of
 * a measurement, with its reason and its command. */
void page_runs(FILE *page, const struct report *report);

#endif
