/* `list` and `show` of what the variants do not know: figures, variants, plans; and of everything.
 */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "front.h"
#include "process.h"
#include "recipe.h"
#include "variants.h"

/* Where the names go: a list for machines, or NULL for people. */
struct listing {
  json_t *array;
  const char *kind; /* in the list of everything, else NULL */
};

static void list_one(const struct listing *to, const char *name, const char *about)
{
  if (!to->array) {
    printf("%-22s %s\n", name, about);
    return;
  }
  json_t *row = json_pack("{s:s, s:s}", "name", name, "about", about);
  if (to->kind) json_object_set_new(row, "kind", json_string(to->kind));
  json_array_append_new(to->array, row);
}

static status list_figures(const struct listing *to)
{
  struct names names = recipe_names();
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    struct recipe *recipe;
    result = recipe_read(names.name[k], &recipe);
    if (result != OK) break;
    list_one(to, recipe->name, recipe->about);
    recipe_free(recipe);
  }
  names_free(&names);
  return result;
}

static status list_variants(const struct listing *to)
{
  for (int k = 0; k < NUM_VARIANTS; k++) {
    const struct variant v = variant_number(k);
    struct path unused;
    const int built = variant_executable(&v, &unused) == OK;
    const struct path name = variant_name(&v), means = variant_about(&v);
    const struct path about = path_of("%s%s", means.text, built ? "" : " (not built)");
    list_one(to, name.text, about.text);
    if (to->array)
      json_object_set_new(json_array_get(to->array, json_array_size(to->array) - 1), "built",
                          json_boolean(built));
  }
  return OK;
}

/* A plan is a YAML file; what it is about stands in its first line, as a comment. */
static status list_plans(const struct listing *to)
{
  const struct path data = data_folder(), folder = path_of("%s/benchmarks/plans", data.text);
  struct names names = folder_names(folder.text);
  for (int k = 0; k < names.n; k++) {
    const struct path path = path_of("%s/%s", folder.text, names.name[k]);
    char *end = strrchr(names.name[k], '.'), *text;
    size_t size;
    if (!end || strcmp(end, ".yaml") != 0 || file_read(path.text, &text, &size) != OK) continue;
    *end = '\0';
    text[strcspn(text, "\n")] = '\0';
    list_one(to, names.name[k], text + strspn(text, "# "));
    free(text);
  }
  names_free(&names);
  return OK;
}

/* One kind of names that a variant knows. */
static status list_from_variant(const struct listing *to, const char *kind)
{
  const struct variant usual = {"openmp", "f64", 2};
  struct variant any;
  struct path executable;
  TRY(variant_any(&usual, &any));
  TRY(variant_executable(&any, &executable));
  const char *const argv[] = {executable.text, "list", kind, "--json", NULL};
  char *text = process_output(argv);
  json_t *list = text ? json_loads(text, 0, NULL) : NULL, *row;
  size_t k;
  free(text);
  if (!list && getenv("SPHBENCH_PLUGIN"))
    return user_error("--plugin: '%s' cannot be loaded; 'sphbench list solvers --plugin ...' says "
                      "why",
                      getenv("SPHBENCH_PLUGIN"));
  if (!list) return status_set(ERR_IO, "'%s' cannot list its %s", executable.text, kind);
  json_array_foreach(list, k, row)
  {
    const char *name = json_string_value(json_object_get(row, "name"));
    const char *about = json_string_value(json_object_get(row, "about"));
    list_one(to, name ? name : "", about ? about : "");
  }
  json_decref(list);
  return OK;
}

static const char *const kinds[] = {"solvers", "scenes", "metrics", "figures", "variants", "plans"};
enum { NUM_KINDS = sizeof kinds / sizeof *kinds, NUM_VARIANTS_OWN = 3 };

static status list_kind(const struct listing *to, int kind)
{
  static status (*const own[])(const struct listing *) = {list_figures, list_variants, list_plans};
  return kind < NUM_VARIANTS_OWN ? list_from_variant(to, kinds[kind])
                                 : own[kind - NUM_VARIANTS_OWN](to);
}

static status list_all(struct listing *to)
{
  for (int k = 0; k < NUM_KINDS; k++) {
    to->kind = kinds[k];
    if (!to->array) printf("%s%s:\n", k ? "\n" : "", kinds[k]);
    TRY(list_kind(to, k));
  }
  return OK;
}

static status list_named(const struct listing *to, const char *name)
{
  for (int k = 0; k < NUM_KINDS; k++)
    if (strcmp(name, kinds[k]) == 0) return list_kind(to, k);
  return user_error("list: '%s' found, allowed is solvers, scenes, metrics, figures, variants or "
                    "plans",
                    name);
}

status verb_list(int argc, char **argv)
{
  const char *name = NULL, *unused = NULL;
  int num_names = 0, json = 0;
  const struct flag flags[] = {{"--json", NULL, &json},
                               {"--backend", &unused, NULL},
                               {"--dim", &unused, NULL},
                               {"--precision", &unused, NULL}};
  const struct arguments what = {"list", flags, 4, &name, 1, &num_names};
  struct variant v = {"openmp", "f64", 2};
  TRY(arguments_parse(&what, argc, argv));
  TRY(variant_choose(argc, argv, &v));
  struct listing to = {json ? json_array() : NULL, NULL};
  const status result = name ? list_named(&to, name) : list_all(&to);
  if (result == OK && to.array) {
    json_dumpf(to.array, stdout, JSON_INDENT(1));
    putchar('\n');
  }
  json_decref(to.array);
  return result;
}

/* --- show --- */

static json_t *recipe_json(const struct recipe *r)
{
  json_t *runs = json_array();
  for (unsigned k = 0; k < r->num_runs; k++) {
    const struct recipe_runs *one = &r->runs[k];
    json_t *solvers = json_array();
    for (unsigned s = 0; s < one->num_solvers; s++)
      json_array_append_new(solvers, json_string(one->solvers[s]));
    json_array_append_new(runs, json_pack("{s:s, s:o}", "scene", one->scene, "solvers", solvers));
  }
  return json_pack("{s:s, s:s, s:s, s:s, s:o}", "kind", "figure", "name", r->name, "about",
                   r->about, "statement", r->statement, "runs", runs);
}

static void print_recipe(const struct recipe *r)
{
  printf("%s: %s\n  %s\nruns:\n", r->name, r->about, r->statement);
  for (unsigned k = 0; k < r->num_runs; k++) {
    const struct recipe_runs *one = &r->runs[k];
    printf("  %s with", one->scene);
    for (unsigned s = 0; s < one->num_solvers; s++) printf(" %s", one->solvers[s]);
    if (!one->num_solvers) printf(" every solver");
    if (one->vary) printf(", for %u values of %s", one->vary->num_values, one->vary->name);
    printf("\n");
  }
}

/* The first argument behind the verb that is no flag. */
static const char *name_of(int argc, char **argv)
{
  for (int i = 2; i < argc; i++)
    if (argv[i][0] != '-') return argv[i];
  return NULL;
}

status show_figure(int argc, char **argv, int *mine)
{
  const char *name = name_of(argc, argv);
  struct names names = recipe_names();
  *mine = 0;
  for (int k = 0; name && k < names.n; k++) *mine |= strcmp(name, names.name[k]) == 0;
  names_free(&names);
  if (!*mine) return OK;
  struct recipe *recipe;
  TRY(recipe_read(name, &recipe));
  int json = 0;
  for (int i = 2; i < argc; i++) json |= strcmp(argv[i], "--json") == 0;
  if (json) {
    json_t *object = recipe_json(recipe);
    json_dumpf(object, stdout, JSON_INDENT(1));
    putchar('\n');
    json_decref(object);
  } else {
    print_recipe(recipe);
  }
  recipe_free(recipe);
  return OK;
}
