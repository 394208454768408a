/* Every run of the journal: what became of it and why. */
#include <stdlib.h>
#include <string.h>

#include "html.h"
#include "report.h"

/* What failed first. */
static int by_outcome(const void *a, const void *b)
{
  const struct journal_entry *x = *(const struct journal_entry *const *)a;
  const struct journal_entry *y = *(const struct journal_entry *const *)b;
  if (x->outcome != y->outcome) return x->outcome > y->outcome ? -1 : 1;
  const int scene = strcmp(x->scene, y->scene), solver = strcmp(x->solver, y->solver);
  return scene ? scene : solver ? solver : strcmp(x->what, y->what);
}

static int last_entries(const struct journal *journal, const struct journal_entry **list)
{
  int n = 0;
  for (int k = 0; k < journal->n; k++)
    if (report_is_last(journal, k)) list[n++] = &journal->entry[k];
  if (n > 0) qsort(list, (size_t)n, sizeof *list, by_outcome);
  return n;
}

static void put_summary(FILE *page, const struct journal_entry *const *list, int n)
{
  static const char *const meaning[] = {
#define O(name, word, meaning) meaning,
    OUTCOME_LIST(O)
#undef O
  };
  int count[NUM_OUTCOMES] = {0};
  for (int k = 0; k < n; k++) count[list[k]->outcome]++;
  fputs("<ul>\n", page);
  for (int o = 0; o < NUM_OUTCOMES; o++) {
    if (count[o] == 0) continue;
    html_put(page, o == OUTCOME_OK ? "<li><b class=good>%s</b>: " : "<li><b class=bad>%s</b>: ",
             outcome_words[o]);
    fprintf(page, "%d; ", count[o]);
    html_put(page, "%s</li>\n", meaning[o]);
  }
  fputs("</ul>\n", page);
}

static void put_run(FILE *page, const struct journal_entry *e)
{
  html_put(page, "<tr><td>%s</td><td>%s</td>", e->scene, e->solver);
  html_put(page, e->outcome == OUTCOME_OK ? "<td class=good>%s</td>" : "<td class=bad>%s</td>",
           outcome_words[e->outcome]);
  fprintf(page, "<td>%.3g</td>", e->seconds);
  html_put(page, "<td>%s</td><td>%s</td><td>%s</td>", e->variant, e->date, e->reason);
  html_put(page, "<td><code>sphbench run %s --solver %s %s</code></td></tr>\n", e->scene, e->solver,
           e->what);
}

void page_runs(FILE *page, const struct report *r)
{
  const struct journal_entry **list = calloc((size_t)r->journal.n + 1, sizeof *list);
  if (!list) return;
  const int n = last_entries(&r->journal, list);
  fputs("<h2 id=runs>Every run</h2>\n", page);
  put_summary(page, list, n);
  fputs(
    "<details open><summary>State, reason and command of each</summary>\n"
    "<div class=scroll><table class='sortable words runs'><thead><tr><th>scene</th><th>solver</th>"
    "<th>ended</th><th>time<small>s</small></th><th>variant</th><th>date</th><th>reason</th>"
    "<th>command</th></tr></thead><tbody>\n",
    page);
  for (int k = 0; k < n; k++) put_run(page, list[k]);
  fputs("</tbody></table></div>\n</details>\n", page);
  free(list);
}
