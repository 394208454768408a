#include "plan.h"

#include <cyaml/cyaml.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variants.h"

/* --- schema: a member of struct `type` under its own name --- */

#define TEXT(type, member)                                                                       \
  CYAML_FIELD_STRING_PTR(#member, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct type, member, \
                         1, CYAML_UNLIMITED)
#define NEEDED_TEXT(type, member) \
  CYAML_FIELD_STRING_PTR(#member, CYAML_FLAG_POINTER, struct type, member, 1, CYAML_UNLIMITED)
#define LIST(type, member, count, entry)                                                     \
  CYAML_FIELD_SEQUENCE_COUNT(#member, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct type, \
                             member, count, &(entry), 0, CYAML_UNLIMITED)

static const cyaml_schema_value_t text_value = {
  CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, CYAML_UNLIMITED)};

static const cyaml_schema_field_t axis_fields[] = {
  NEEDED_TEXT(plan_axis, name), LIST(plan_axis, values, num_values, text_value), CYAML_FIELD_END};
static const cyaml_schema_value_t axis_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct plan_axis, axis_fields)};

static const cyaml_schema_field_t runs_fields[] = {
  NEEDED_TEXT(plan_runs, scene),
  LIST(plan_runs, solvers, num_solvers, text_value),
  TEXT(plan_runs, dim),
  TEXT(plan_runs, precision),
  TEXT(plan_runs, backend),
  TEXT(plan_runs, dt),
  TEXT(plan_runs, t_end),
  TEXT(plan_runs, spacing),
  TEXT(plan_runs, frames),
  TEXT(plan_runs, seed),
  TEXT(plan_runs, threads),
  LIST(plan_runs, set, num_set, text_value),
  LIST(plan_runs, product, num_product, axis_value),
  CYAML_FIELD_END};
static const cyaml_schema_value_t runs_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct plan_runs, runs_fields)};

static const cyaml_schema_field_t plan_fields[] = {
  NEEDED_TEXT(plan, name), NEEDED_TEXT(plan, about), TEXT(plan, timed),
  LIST(plan, runs, num_runs, runs_value), CYAML_FIELD_END};
static const cyaml_schema_value_t plan_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct plan, plan_fields)};

enum { MOST_RUNS = 10000 }; /* of a plan: more is a slip, not a plan */

/* --- where they are --- */

struct names plan_names(void)
{
  const struct path data = data_folder(), all = path_of("%s/benchmarks/plans", data.text);
  struct names names = folder_names(all.text);
  int kept = 0;
  for (int k = 0; k < names.n; k++) {
    char *dot = strrchr(names.name[k], '.');
    if (dot && strcmp(dot, ".yaml") == 0) {
      *dot = '\0';
      names.name[kept++] = names.name[k];
    } else {
      free(names.name[k]);
    }
  }
  names.n = kept;
  return names;
}

static status unknown(const char *name)
{
  struct names names = plan_names();
  const char *near = nearest_name(name, (const char *const *)names.name, names.n);
  const status result =
    near ? user_error("there is no plan '%s'; the nearest known one is '%s'", name, near)
         : user_error("there is no plan '%s'; 'sphbench list plans' lists them", name);
  names_free(&names);
  return result;
}

/* --- what the schema cannot say --- */

static status check_runs(const struct plan *p, unsigned number)
{
  const struct plan_runs *runs = &p->runs[number - 1];
  const struct path at = path_of("runs[%u]", number);
  for (unsigned k = 0; k < runs->num_set; k++)
    if (!strchr(runs->set[k], '=')) {
      const struct path set = path_of("%s.set", at.text);
      return yaml_source_refuse(p->source, set.text, "'%s' found, KEY=VALUE expected",
                                runs->set[k]);
    }
  for (unsigned k = 0; k < runs->num_product; k++)
    if (runs->product[k].num_values == 0) {
      const struct path axis = path_of("%s.product[%u]", at.text, k + 1);
      return yaml_source_refuse(p->source, axis.text, "'%s' has no values", runs->product[k].name);
    }
  return OK;
}

status plan_read(const char *name, struct plan **plan)
{
  const struct path data = data_folder();
  const struct path path = strchr(name, '/') || path_is_file(name)
                             ? path_of("%s", name)
                             : path_of("%s/benchmarks/plans/%s.yaml", data.text, name);
  struct yaml_source *source;
  void *read;
  *plan = NULL;
  if (!path_is_file(path.text) && !strchr(name, '/')) return unknown(name);
  TRY(yaml_source_read(path.text, &plan_value, &source, &read));
  struct plan *p = read;
  p->source = source;
  status result = p->num_runs ? OK : yaml_source_refuse(source, "name", "the plan has no runs");
  for (unsigned k = 1; k <= p->num_runs && result == OK; k++) {
    result = check_runs(p, k);
    file_look_beside(&p->runs[k - 1].scene, path.text);
  }
  if (result == OK)
    *plan = p;
  else
    plan_free(p);
  return result;
}

void plan_free(struct plan *plan)
{
  if (plan) yaml_source_free(plan->source, plan);
}

/* --- the runs --- */

/* A varied parameter that has a flag of its own is given by it, others by --set. */
static const char **own_flag(struct run_request *r, const char *name)
{
  if (strcmp(name, "dim") == 0) return &r->dim;
  if (strcmp(name, "precision") == 0) return &r->precision;
  if (strcmp(name, "backend") == 0) return &r->backend;
  if (strcmp(name, "dt") == 0) return &r->dt;
  if (strcmp(name, "t_end") == 0) return &r->t_end;
  if (strcmp(name, "spacing") == 0) return &r->spacing;
  if (strcmp(name, "frames") == 0) return &r->frames;
  if (strcmp(name, "seed") == 0) return &r->seed;
  if (strcmp(name, "threads") == 0) return &r->threads;
  return NULL;
}

/* The `number`-th combination: the last axis varies fastest. Texts in `made` are to be freed. */
static status add_one(const struct plan_runs *runs, const char *solver, unsigned long number,
                      struct queue *queue)
{
  struct run_request r = {.scene = runs->scene,
                          .solver = solver,
                          .dim = runs->dim,
                          .precision = runs->precision,
                          .backend = runs->backend,
                          .dt = runs->dt,
                          .t_end = runs->t_end,
                          .spacing = runs->spacing,
                          .frames = runs->frames,
                          .seed = runs->seed,
                          .threads = runs->threads};
  char **set = calloc((size_t)runs->num_set + runs->num_product + 1, sizeof *set);
  status result = set ? OK : status_set(ERR_MEMORY, "out of memory");
  for (unsigned k = 0; set && k < runs->num_set; k++) set[r.num_sets++] = runs->set[k];
  for (unsigned k = runs->num_product; set && k-- > 0;) {
    const struct plan_axis *axis = &runs->product[k];
    const char *value = axis->values[number % axis->num_values];
    const char **flag = own_flag(&r, axis->name);
    number /= axis->num_values;
    if (flag)
      *flag = value;
    else if (!(set[r.num_sets++] = text_make("%s=%s", axis->name, value)))
      result = status_set(ERR_MEMORY, "out of memory");
  }
  r.set = set;
  int unused;
  if (result == OK) result = queue_add(queue, &r, &unused);
  for (int k = (int)runs->num_set; set && k < r.num_sets; k++) free(set[k]);
  free(set);
  return result;
}

static int is_known(const struct names *solvers, const char *name)
{
  for (int k = 0; k < solvers->n; k++)
    if (strcmp(solvers->name[k], name) == 0) return 1;
  return 0;
}

/* Of one solver. */
static status count_combinations(const struct plan *plan, unsigned number, double others,
                                 unsigned long *combinations)
{
  const struct plan_runs *runs = &plan->runs[number - 1];
  const struct path at = path_of("runs[%u].product", number);
  double count = 1;
  for (unsigned k = 0; k < runs->num_product; k++) count *= runs->product[k].num_values;
  *combinations = (unsigned long)fmin(count, MOST_RUNS);
  if (count + others <= MOST_RUNS) return OK;
  return yaml_source_refuse(plan->source, at.text,
                            "%g runs found, allowed are at most %d in a plan", count + others,
                            MOST_RUNS);
}

static status expand_runs(const struct plan *plan, unsigned number, const struct names *solvers,
                          struct queue *queue)
{
  const struct plan_runs *runs = &plan->runs[number - 1];
  const unsigned n = runs->num_solvers ? runs->num_solvers : (unsigned)solvers->n;
  char **names = runs->num_solvers ? runs->solvers : solvers->name;
  for (unsigned s = 0; s < n; s++) {
    unsigned long combinations;
    TRY(count_combinations(plan, number, queue->n, &combinations));
    if (!is_known(solvers, names[s])) {
      const struct path at = path_of("runs[%u].solvers", number);
      const char *near = nearest_name(names[s], (const char *const *)solvers->name, solvers->n);
      return yaml_source_refuse(plan->source, at.text, "'%s' is no solver%s%s%s", names[s],
                                near ? "; the nearest known one is '" : "", near ? near : "",
                                near ? "'" : "");
    }
    for (unsigned long c = 0; c < combinations; c++) TRY(add_one(runs, names[s], c, queue));
  }
  return OK;
}

status plan_expand(const struct plan *plan, const struct names *solvers, struct queue *queue)
{
  for (unsigned k = 1; k <= plan->num_runs; k++) TRY(expand_runs(plan, k, solvers, queue));
  return OK;
}
