/* From a recipe to the runs that it needs. */
#include <stdlib.h>
#include <string.h>

#include "figure.h"
#include "process.h"
#include "variants.h"

/* What the first variant says that can; a plug-in may be there for some only. */
static json_t *solver_list(struct path *executable)
{
  for (int k = -1; k < NUM_VARIANTS; k++) {
    const struct variant v = k < 0 ? (struct variant){"openmp", "f64", 2} : variant_number(k);
    const char *const argv[] = {executable->text, "list", "solvers", "--json", NULL};
    if (variant_executable(&v, executable) != OK) continue;
    char *text = process_output(argv);
    json_t *list = text ? json_loads(text, 0, NULL) : NULL;
    free(text);
    if (list) return list;
  }
  return NULL;
}

status solver_names(struct names *names)
{
  const struct variant wanted = {"openmp", "f64", 2};
  struct variant any;
  struct path executable;
  *names = (struct names){NULL, 0};
  TRY(variant_any(&wanted, &any));
  json_t *list = solver_list(&executable), *row;
  size_t k;
  if (!list && getenv("SPHBENCH_PLUGIN"))
    return user_error("--plugin: '%s' cannot be loaded; 'sphbench list solvers --plugin ...' says "
                      "why",
                      getenv("SPHBENCH_PLUGIN"));
  if (list) names->name = calloc(json_array_size(list) + 1, sizeof *names->name);
  json_array_foreach(list, k, row)
  {
    const char *name = json_string_value(json_object_get(row, "name"));
    if (names->name && name) names->name[names->n++] = strdup(name);
  }
  json_decref(list);
  return names->n ? OK : status_set(ERR_IO, "'%s' lists no solvers", executable.text);
}

/* Number of a solver, from 1; 0: unknown. */
static int number_of(const struct names *solvers, const char *name)
{
  for (int k = 0; k < solvers->n; k++)
    if (strcmp(solvers->name[k], name) == 0) return k + 1;
  return 0;
}

status solver_number(const struct names *all, const char *name, int *number)
{
  *number = number_of(all, name);
  if (*number) return OK;
  const char *near = nearest_name(name, (const char *const *)all->name, all->n);
  return near
           ? user_error("--solvers: unknown solver '%s'; the nearest known one is '%s'", name, near)
           : user_error("--solvers: unknown solver '%s'; 'sphbench list solvers' lists them", name);
}

static struct run_request request_of(const struct recipe_runs *runs)
{
  return (struct run_request){.scene = runs->scene,
                              .dim = runs->dim,
                              .precision = runs->precision,
                              .dt = runs->dt,
                              .t_end = runs->t_end,
                              .spacing = runs->spacing,
                              .frames = runs->frames,
                              .set = runs->set,
                              .num_sets = (int)runs->num_set,
                              .vary = runs->vary ? runs->vary->name : NULL};
}

/* Which form of its solver a label is, from 1; as many as there are line types of a colour. */
static int form_of(const struct figure *f, const char *solver, const char *label)
{
  enum { FORMS = 3 };
  int forms = 0;
  for (int k = 0; k < f->n; k++) {
    const struct figure_case *one = &f->cases[k];
    if (!one->name || strcmp(one->solver, solver) != 0) continue;
    if (strcmp(one->name, label) == 0) return one->colour / MOST_COLOURS;
    if (one->colour / MOST_COLOURS > forms) forms = one->colour / MOST_COLOURS;
  }
  return forms < FORMS ? forms + 1 : FORMS;
}

static status add_case(struct figure *f, const struct recipe_runs *runs, struct figure_case one,
                       struct queue *queue)
{
  struct run_request request = request_of(runs);
  request.solver = one.solver;
  request.value = one.value;
  if (runs->label) one.colour += MOST_COLOURS * form_of(f, one.solver, runs->label);
  struct figure_case *more = realloc(f->cases, (size_t)(f->n + 1) * sizeof *more);
  if (!more) return status_set(ERR_MEMORY, "out of memory");
  f->cases = more;
  one.curve = runs->label ? text_make("%s %s", one.solver, runs->label) : strdup(one.solver);
  one.label = one.value ? text_make("%s, %s %s", one.curve, runs->vary->name, one.value)
                        : text_make("%s", one.curve);
  f->cases[f->n++] = one;
  if (!one.curve || !one.label) return status_set(ERR_MEMORY, "out of memory");
  return queue_add(queue, &request, &f->cases[f->n - 1].run);
}

/* All values of the varied parameter, or the one run, with one solver. */
static status add_group(struct figure *f, const struct recipe_runs *runs, const char *solver,
                        const struct names *solvers, struct queue *queue)
{
  struct figure_case one = {.solver = solver,
                            .name = runs->label,
                            .colour = number_of(solvers, solver),
                            .group = f->num_groups++};
  if (!one.colour) {
    const char *near = nearest_name(solver, (const char *const *)solvers->name, solvers->n);
    return yaml_source_refuse(f->recipe->source, "runs", "'%s' is no solver; %s%s%s", solver,
                              near ? "the nearest known name is '" : "see 'sphbench list solvers",
                              near ? near : "", "'");
  }
  if (!runs->vary) return add_case(f, runs, one, queue);
  for (unsigned k = 0; k < runs->vary->num_values; k++) {
    one.value = runs->vary->values[k];
    TRY(add_case(f, runs, one, queue));
  }
  return OK;
}

static status expand(struct figure *f, const struct names *solvers, struct queue *queue)
{
  for (unsigned k = 0; k < f->recipe->num_runs; k++) {
    const struct recipe_runs *runs = &f->recipe->runs[k];
    const unsigned n = runs->num_solvers ? runs->num_solvers : (unsigned)solvers->n;
    char **names = runs->num_solvers ? runs->solvers : solvers->name;
    for (unsigned s = 0; s < n; s++) TRY(add_group(f, runs, names[s], solvers, queue));
  }
  return OK;
}

status figure_prepare(struct figure *figure, const struct figure_request *request,
                      struct queue *queue)
{
  *figure = (struct figure){.folder = recipe_folder(request->name),
                            .solvers = request->solvers,
                            .paper_size = request->paper_size};
  TRY(recipe_read(request->name, &figure->recipe));
  if (request->paper_size) TRY(recipe_at_paper_size(figure->recipe));
  return expand(figure, request->solvers, queue);
}

void figure_free(struct figure *figure)
{
  for (int k = 0; k < figure->n; k++) {
    free(figure->cases[k].curve);
    free(figure->cases[k].label);
  }
  free(figure->cases);
  recipe_free(figure->recipe);
  json_decref(figure->files);
  json_decref(figure->values);
  *figure = (struct figure){.n = 0};
}
