/* index.html beside the figures: picture, the paper's statement, ours, verdict, settings. */
#include "index.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "figure.h"
#include "html.h"

struct index {
  const char *results, *folder;
  json_t *claims; /* as `claims` wrote them last; NULL: never */
  json_t **figure;
  int n;
};

static const char style[] =
  ":root{color-scheme:light dark;--line:#8886;--soft:#777}\n"
  "body{margin:0 auto;max-width:70rem;padding:1rem 1.25rem 4rem;"
  "font:16px/1.5 system-ui,'DejaVu Sans',sans-serif}\n"
  "h2{margin-top:3rem;border-bottom:1px solid var(--line)}article{margin:2rem 0 3rem}\n"
  "img{max-width:100%;max-height:44rem;background:#fff;border:1px solid var(--line);"
  "border-radius:6px}\n"
  "p,li{max-width:52rem}.soft,code{color:var(--soft);font-size:.875rem}\n"
  ".scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.8125rem;margin:.5rem 0}\n"
  "th,td{padding:.3rem .6rem;border-bottom:1px solid var(--line);text-align:left;"
  "vertical-align:top}\n"
  ".holds{color:#1f7a3d}.not{color:#b8321a;font-weight:600}nav a{margin-right:.75rem}\n";

static const char *text_in(const json_t *object, const char *key)
{
  const char *text = json_string_value(json_object_get(object, key));
  return text ? text : "";
}

/* --- what the claims say --- */

static void put_verdict(FILE *page, const json_t *claim)
{
  const char *verdict = text_in(claim, "verdict");
  const json_t *value = json_object_get(claim, "value");
  const char *kind = strcmp(verdict, "holds") == 0           ? "holds"
                     : strcmp(verdict, "does not hold") == 0 ? "not"
                                                             : "soft";
  html_put(page, "<tr><td>%s</td><td>%s</td><td>", text_in(claim, "place"),
           text_in(claim, "statement"));
  if (json_is_number(value)) fprintf(page, "%.4g ", json_number_value(value));
  html_put(page, "<br><span class=soft>%s</span></td><td class=%s>%s</td><td>%s</td></tr>\n",
           text_in(claim, "rule"), kind, verdict, text_in(claim, "cause"));
}

static void put_claims(FILE *page, const struct index *x, const char *figure, const char *paper)
{
  int n = 0;
  size_t k;
  json_t *claim;
  json_array_foreach(x->claims, k, claim)
  {
    if (strcmp(text_in(claim, "figure"), figure) != 0) continue;
    if (!*figure && strcmp(text_in(claim, "paper"), paper) != 0) continue;
    if (n++ == 0)
      fputs("<div class=scroll><table><tr><th>place<th>the paper states<th>ours, rule<th>verdict"
            "<th>why</tr>\n",
            page);
    put_verdict(page, claim);
  }
  if (n) fputs("</table></div>\n", page);
}

/* --- what was run --- */

/* The numbers that runs share, or their range. */
static void put_range(FILE *page, json_t *const *facts, int n, const char *name, const char *word)
{
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int k = 0; k < n; k++) {
    const double value = fact_value(facts[k], name);
    low = fmin(low, value);
    high = fmax(high, value);
  }
  if (!isfinite(low)) return;
  fprintf(page, low < high ? "; %s %.6g to %.6g" : "; %s %.6g", word, low, high);
}

static void put_settings(FILE *page, const struct index *x, const json_t *figure)
{
  const json_t *runs = json_object_get(figure, "runs");
  json_t **facts = calloc(json_array_size(runs) + 1, sizeof *facts), *run;
  size_t k;
  int n = 0;
  json_array_foreach(runs, k, run)
  {
    const struct path path = run_file(x->results, text_in(run, "id"), "json");
    if (facts && (facts[n] = json_load_file(path.text, 0, NULL))) n++;
  }
  if (n) {
    fprintf(page, "<p class=soft>%d of %zu runs have a result; scene ", n, json_array_size(runs));
    html_put(page, "%s", text_in(facts[0], "scene"));
    put_range(page, facts, n, "particles", "particles");
    put_range(page, facts, n, "parameters.spacing", "spacing [m]");
    put_range(page, facts, n, "parameters.dt", "dt [s]");
    put_range(page, facts, n, "parameters.t_end", "t_end [s]");
    put_range(page, facts, n, "parameters.support", "R/dx");
    put_range(page, facts, n, "parameters.xsph", "XSPH");
    fputs("</p>\n", page);
  }
  for (int j = 0; j < n; j++) json_decref(facts[j]);
  free(facts);
}

/* Runs that did not come to their end, and why. */
static void put_failures(FILE *page, const json_t *figure)
{
  size_t k;
  json_t *run;
  int n = 0;
  json_array_foreach(json_object_get(figure, "runs"), k, run)
  {
    if (strcmp(text_in(run, "outcome"), "ok") == 0) continue;
    if (n++ == 0) fputs("<details><summary class=soft>Not run or failed</summary><ul>\n", page);
    html_put(page, "<li>%s: %s. %s</li>\n", text_in(run, "name"), text_in(run, "outcome"),
             text_in(run, "reason"));
  }
  if (n) fputs("</ul></details>\n", page);
}

static void put_values(FILE *page, const json_t *figure)
{
  json_t *values = json_object_get(figure, "values"), *value;
  const char *name;
  if (json_object_size(values) == 0) return;
  fputs("<details><summary class=soft>Numbers</summary><ul>\n", page);
  json_object_foreach(values, name, value)
  {
    html_put(page, "<li>%s: ", name);
    if (json_is_number(value)) fprintf(page, "%.6g", json_number_value(value));
    fputs("</li>\n", page);
  }
  fputs("</ul></details>\n", page);
}

/* --- a figure --- */

static void put_table(FILE *page, const struct index *x, const json_t *figure)
{
  const json_t *file = json_array_get(json_object_get(figure, "files"), 0);
  const struct path path =
    path_of("%s/%s/%s", x->folder, text_in(figure, "name"), text_in(file, "file"));
  char *text;
  size_t size, k;
  json_t *column;
  if (!path_is_file(path.text) || file_read(path.text, &text, &size) != OK) return;
  fputs("<div class=scroll><table><tr>", page);
  json_array_foreach(json_object_get(file, "columns"), k, column)
    html_put(page, "<th>%s</th>", json_string_value(column));
  fputs("</tr>\n", page);
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));) {
    if (!*line || *line == '#') continue;
    fputs("<tr>", page);
    for (char *field; (field = strsep(&line, "\t"));) html_put(page, "<td>%s</td>", field);
    fputs("</tr>\n", page);
  }
  fputs("</table></div>\n", page);
  free(text);
}

static void put_figure(FILE *page, const struct index *x, const json_t *f)
{
  const char *name = text_in(f, "name"), *place = text_in(f, "place");
  html_put(page, "<article id=\"%s\">\n<h3>%s%s%s</h3>\n", name, place, *place ? ": " : "",
           text_in(f, "about"));
  if (strcmp(text_in(f, "kind"), "table") == 0)
    put_table(page, x, f);
  else
    html_put(page, "<a href=\"%s.svg\"><img loading=lazy alt=\"%s\" src=\"%s.png\"></a>\n", name,
             text_in(f, "about"), name);
  html_put(page, "<p>%s</p>\n", text_in(f, "statement"));
  put_claims(page, x, name, "");
  if (*text_in(f, "departures"))
    html_put(page, "<p><b>Other than in the paper:</b> %s</p>\n", text_in(f, "departures"));
  if (*text_in(f, "size")) html_put(page, "<p class=soft>%s</p>\n", text_in(f, "size"));
  put_settings(page, x, f);
  put_values(page, f);
  put_failures(page, f);
  html_put(page, "<p><code>sphbench figure %s</code> <a class=soft href=\"%s/\">data</a></p>\n",
           name, name);
  fputs("</article>\n", page);
}

/* Figures of a paper ("": our own), and the claims that no figure decides. */
static void put_paper(FILE *page, const struct index *x, const char *paper)
{
  int n = 0;
  for (int k = 0; k < x->n; k++) {
    if (strcmp(text_in(x->figure[k], "paper"), paper) != 0) continue;
    if (n++ == 0)
      html_put(page, "<h2 id=\"paper-%s\">%s</h2>\n", paper, *paper ? paper : "Our own figures");
    put_figure(page, x, x->figure[k]);
  }
  if (n && *paper) put_claims(page, x, "", paper);
}

static int is_first_of_paper(const struct index *x, int k)
{
  for (int j = 0; j < k; j++)
    if (strcmp(text_in(x->figure[j], "paper"), text_in(x->figure[k], "paper")) == 0) return 0;
  return 1;
}

static void put_page(FILE *page, const struct index *x)
{
  fputs("<!doctype html>\n<html lang=en><head><meta charset=utf-8>\n"
        "<meta name=viewport content=\"width=device-width,initial-scale=1\">\n"
        "<title>The papers, figure by figure</title><style>\n",
        page);
  fputs(style, page);
  fputs("</style></head><body>\n<h1>The papers, figure by figure</h1>\n"
        "<p>Every number comes from runs of this program; verdicts are decided by rule. Runs that "
        "failed are gaps in the pictures, and named below them.</p>\n<nav>",
        page);
  for (int k = 0; k < x->n; k++)
    html_put(page, "<a href=\"#%s\">%s</a>\n", text_in(x->figure[k], "name"),
             text_in(x->figure[k], "name"));
  fputs("</nav>\n", page);
  for (int k = 0; k < x->n; k++)
    if (is_first_of_paper(x, k)) put_paper(page, x, text_in(x->figure[k], "paper"));
  fputs("</body></html>\n", page);
}

/* --- reading --- */

/* Papers' figures first, ours last; as a recipe orders them, else by name. */
static int by_place(const void *a, const void *b)
{
  const json_t *x = *(json_t *const *)a, *y = *(json_t *const *)b;
  const char *p = text_in(x, "paper"), *q = text_in(y, "paper");
  const json_int_t i = json_integer_value(json_object_get(x, "order"));
  const json_int_t j = json_integer_value(json_object_get(y, "order"));
  if (!*p != !*q) return *p ? -1 : 1;
  if (strcmp(p, q) != 0) return strcmp(p, q);
  return i != j ? (i > j) - (i < j) : strcmp(text_in(x, "name"), text_in(y, "name"));
}

static status read_figures(struct index *x)
{
  struct names names = folder_names(x->folder);
  x->figure = calloc((size_t)names.n + 1, sizeof *x->figure);
  for (int k = 0; x->figure && k < names.n; k++) {
    const struct path path = path_of("%s/%s/figure.json", x->folder, names.name[k]);
    json_t *figure = json_load_file(path.text, 0, NULL);
    if (figure) x->figure[x->n++] = figure;
  }
  names_free(&names);
  if (!x->figure) return status_set(ERR_MEMORY, "out of memory");
  qsort(x->figure, (size_t)x->n, sizeof *x->figure, by_place);
  return OK;
}

status index_write(const char *results, const char *folder)
{
  const struct path claims = path_of("%s/claims.json", results);
  const struct path out = path_of("%s/index.html", folder);
  struct index x = {
    .results = results, .folder = folder, .claims = json_load_file(claims.text, 0, NULL)};
  struct new_file file;
  status result = read_figures(&x);
  if (result == OK && x.n > 0) {
    result = file_begin(&file, out.text);
    if (result == OK) {
      put_page(file.stream, &x);
      result = file_commit(&file);
    }
  }
  for (int k = 0; k < x.n; k++) json_decref(x.figure[k]);
  free(x.figure);
  json_decref(x.claims);
  return result;
}
