/* `sphbench figure`: runs what is missing, writes the data, draws, and prints the files. */
#include "figure.h"

#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "figure_plan.h"
#include "front.h"
#include "index.h"

enum { MOST_FIGURES = 256 };

struct request {
  const char *results, *out, *jobs, *size;
  int all, standard, quiet, dry_run;
  bool paper_size;
  const char *names[MOST_FIGURES];
  int num_names;
};

static int by_order(const void *a, const void *b)
{
  const struct recipe *x = ((const struct figure *)a)->recipe;
  const struct recipe *y = ((const struct figure *)b)->recipe;
  return x->order != y->order ? (x->order > y->order) - (x->order < y->order)
                              : strcmp(x->name, y->name);
}

static status parse(struct request *r, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--results", &r->results, NULL},   {"-o", &r->out, NULL},
    {"--jobs", &r->jobs, NULL},         {"--all", NULL, &r->all},
    {"--standard", NULL, &r->standard}, {"--quiet", NULL, &r->quiet},
    {"--size", &r->size, NULL},         {"--dry-run", NULL, &r->dry_run},
  };
  const struct arguments what = {"figure", flags,        sizeof flags / sizeof *flags,
                                 r->names, MOST_FIGURES, &r->num_names};
  *r = (struct request){.results = "results", .size = "desk"};
  TRY(arguments_parse(&what, argc, argv));
  r->paper_size = strcmp(r->size, "paper") == 0;
  if (!r->paper_size && strcmp(r->size, "desk") != 0)
    return user_error("--size: '%s' found, allowed is desk or paper", r->size);
  if ((r->num_names > 0) + r->all + r->standard == 1) return OK;
  return user_error("figure: either NAMEs, --standard or --all is needed; 'sphbench list figures' "
                    "lists them");
}

/* Read the recipes that are asked for; figures [num_names], of which *n are used. */
static status prepare(const struct request *r, const char *const *names, int num_names,
                      const struct names *solvers, struct queue *queue, struct figure *figures,
                      int *n)
{
  for (int k = 0; k < num_names; k++) {
    if (r->standard) {
      struct recipe *recipe;
      TRY(recipe_read(names[k], &recipe));
      const int wanted = recipe->standard;
      recipe_free(recipe);
      if (!wanted) continue;
    }
    const struct figure_request request = {names[k], r->paper_size, solvers};
    TRY(figure_prepare(&figures[(*n)++], &request, queue));
  }
  return *n ? OK : user_error("figure: there is nothing to draw");
}

/* Which runs it shows, and what its recipe calls them: the claims look for them by that. */
static json_t *runs_json(const struct figure *f, const struct queue *queue)
{
  json_t *runs = json_array();
  for (int k = 0; k < f->n; k++) {
    const struct figure_case *one = &f->cases[k];
    const struct run *run = &queue->run[one->run];
    json_array_append_new(runs, json_pack("{s:s, s:s, s:s, s:s, s:s?, s:s}", "id", run->id, "name",
                                          one->label, "solver", one->solver, "outcome",
                                          run->finished ? outcome_words[run->outcome] : "not run",
                                          "reason", run->finished ? run->reason : NULL, "label",
                                          one->name ? one->name : ""));
  }
  return runs;
}

/* What the report, the index and the claims want to know of a figure. */
static status write_facts(const struct figure *f, const struct queue *queue)
{
  static const char *const kinds[] = {"frames", "series", "metric", "table", "program"};
  const struct recipe *r = f->recipe;
  const struct path path = path_of("%s/figure.json", f->data.text);
  struct new_file file;
  json_t *object = json_pack("{s:s, s:s, s:s, s:i, s:s, s:s?, s:s?, s:s?, s:s, s:O, s:O?, s:o}",
                             "name", r->name, "about", r->about, "statement", r->statement, "order",
                             r->order, "kind", kinds[r->extract.kind], "paper", r->paper, "place",
                             r->place, "departures", r->departures, "size", f->size.text, "files",
                             f->files, "values", f->values, "runs", runs_json(f, queue));
  status result = object ? file_begin(&file, path.text)
                         : user_error("%s/recipe.yaml: a text is not UTF-8", f->folder.text);
  if (result == OK) {
    json_dumpf(object, file.stream, JSON_INDENT(1));
    result = file_commit(&file);
  }
  json_decref(object);
  return result;
}

static status finish(struct figure *f, const struct queue *queue, const char *out)
{
  f->out = path_of("%s", out);
  f->data = path_of("%s/%s", out, f->recipe->name);
  TRY(figure_extract(f, queue));
  const int is_table = f->recipe->extract.kind == EXTRACT_TABLE;
  if (!is_table) TRY(figure_draw(f, out));
  TRY(write_facts(f, queue));
  if (is_table)
    printf("%s/%s.csv\n%s/%s.md\n", out, f->recipe->name, out, f->recipe->name);
  else
    printf("%s/%s.png\n%s/%s.svg\n", out, f->recipe->name, out, f->recipe->name);
  fflush(stdout);
  return OK;
}

/* One figure without data must not keep the others from being drawn: its sentence is told and the
 * last such status returned. */
static status finish_all(struct figure *figures, int n, const struct queue *queue, const char *out)
{
  status last = OK;
  for (int k = 0; k < n; k++) {
    const status result = finish(&figures[k], queue, out);
    if (result == OK) continue;
    last = result;
    if (k < n - 1) fprintf(stderr, "sphbench: %s\n", status_sentence());
  }
  return last;
}

/* A crash is a fault of the program, other than a run that diverges. */
static status tell_crashes(const struct queue *queue)
{
  int crashed = 0, k_last = 0;
  for (int k = 0; k < queue->n; k++)
    if (queue->run[k].finished && queue->run[k].outcome == OUTCOME_CRASHED) {
      crashed++;
      k_last = k;
    }
  if (!crashed) return OK;
  const struct run *run = &queue->run[k_last];
  const struct path log = run_file(queue->results, run->id, "log");
  return status_set(ERR_RUN, "%d of %d runs crashed, the last of them %s with %s: %s (log: %s)",
                    crashed, queue->n, run->argv[1], run->argv[3], run->reason, log.text);
}

static status draw(const struct request *r, struct queue *queue, struct figure *figures, int n,
                   const char *out)
{
  qsort(figures, (size_t)n, sizeof *figures, by_order);
  TRY(queue_work(queue));
  if (!r->quiet)
    fprintf(stderr, "%d runs done, %d were there already\n", queue->done, queue->n - queue->done);
  TRY(folder_make(out));
  const status drawn = finish_all(figures, n, queue, out);
  TRY(index_write(r->results, out));
  TRY(drawn);
  return tell_crashes(queue);
}

static status work(const struct request *r, struct queue *queue, struct figure *figures, int *n)
{
  struct names all = {NULL, 0}, solvers = {NULL, 0};
  const struct path out = r->out
                            ? path_of("%s", r->out)
                            : path_of("%s/figures%s", r->results, r->paper_size ? "/paper" : "");
  const int every = r->all || r->standard;
  if (every) all = recipe_names();
  status result = solver_names(&solvers);
  if (result == OK)
    result = prepare(r, every ? (const char *const *)all.name : r->names,
                     every ? all.n : r->num_names, &solvers, queue, figures, n);
  if (result == OK && r->dry_run) result = figure_plan_show(queue);
  if (result == OK && !r->dry_run) result = draw(r, queue, figures, *n, out.text);
  for (int k = 0; k < *n; k++) figure_free(&figures[k]);
  names_free(&all);
  names_free(&solvers);
  return result;
}

status verb_figure(int argc, char **argv)
{
  static struct figure figures[MOST_FIGURES];
  struct request r;
  struct queue queue;
  int n = 0;
  TRY(parse(&r, argc, argv));
  TRY(gnuplot_check());
  TRY(queue_open(&queue, r.results));
  long jobs = queue.jobs;
  status result = argument_whole("--jobs", r.jobs, 1, 256, &jobs);
  queue.jobs = (int)jobs;
  queue.quiet = r.quiet;
  if (result == OK) result = work(&r, &queue, figures, &n);
  queue_close(&queue);
  return result;
}
