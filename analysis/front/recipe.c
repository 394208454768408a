#include "recipe.h"

#include <cyaml/cyaml.h>
#include <stdlib.h>
#include <string.h>

#include "variants.h"

/* --- schema: a member of struct `type` under its own name --- */

#define TEXT(type, member)                                                                       \
  CYAML_FIELD_STRING_PTR(#member, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct type, member, \
                         1, CYAML_UNLIMITED)
#define NEEDED_TEXT(type, member) \
  CYAML_FIELD_STRING_PTR(#member, CYAML_FLAG_POINTER, struct type, member, 1, CYAML_UNLIMITED)
#define NUMBER(type, member) CYAML_FIELD_FLOAT(#member, CYAML_FLAG_OPTIONAL, struct type, member)
#define YES_OR_NO(type, member) CYAML_FIELD_BOOL(#member, CYAML_FLAG_OPTIONAL, struct type, member)
#define LIST(type, member, count, entry)                                                     \
  CYAML_FIELD_SEQUENCE_COUNT(#member, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct type, \
                             member, count, &(entry), 0, CYAML_UNLIMITED)

static const cyaml_schema_value_t text_value = {
  CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, CYAML_UNLIMITED)};
static const cyaml_schema_value_t number_value = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, double)};

static const cyaml_schema_field_t vary_fields[] = {
  NEEDED_TEXT(recipe_vary, name), LIST(recipe_vary, values, num_values, text_value),
  CYAML_FIELD_END};

static const cyaml_schema_field_t size_fields[] = {
  TEXT(recipe_size, dt),
  TEXT(recipe_size, t_end),
  TEXT(recipe_size, spacing),
  TEXT(recipe_size, frames),
  LIST(recipe_size, set, num_set, text_value),
  CYAML_FIELD_MAPPING_PTR("vary", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct recipe_size,
                          vary, vary_fields),
  CYAML_FIELD_END};

static const cyaml_schema_field_t runs_fields[] = {
  NEEDED_TEXT(recipe_runs, scene),
  TEXT(recipe_runs, label),
  LIST(recipe_runs, solvers, num_solvers, text_value),
  TEXT(recipe_runs, dim),
  TEXT(recipe_runs, precision),
  TEXT(recipe_runs, dt),
  TEXT(recipe_runs, t_end),
  TEXT(recipe_runs, spacing),
  TEXT(recipe_runs, frames),
  LIST(recipe_runs, set, num_set, text_value),
  CYAML_FIELD_MAPPING_PTR("vary", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct recipe_runs,
                          vary, vary_fields),
  CYAML_FIELD_MAPPING_PTR("at_paper_size", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL,
                          struct recipe_runs, at_paper_size, size_fields),
  CYAML_FIELD_END};
static const cyaml_schema_value_t runs_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct recipe_runs, runs_fields)};

static const cyaml_strval_t kinds[] = {{"frames", EXTRACT_FRAMES},
                                       {"series", EXTRACT_SERIES},
                                       {"metric", EXTRACT_METRIC},
                                       {"table", EXTRACT_TABLE},
                                       {"program", EXTRACT_PROGRAM}};
static const cyaml_schema_field_t beside_fields[] = {
  NEEDED_TEXT(recipe_beside, file), NEEDED_TEXT(recipe_beside, about), CYAML_FIELD_END};
static const cyaml_schema_field_t extract_fields[] = {
  CYAML_FIELD_ENUM("kind", CYAML_FLAG_STRICT, struct recipe_extract, kind, kinds, 5),
  LIST(recipe_extract, times, num_times, number_value),
  TEXT(recipe_extract, colour),
  LIST(recipe_extract, columns, num_columns, text_value),
  NUMBER(recipe_extract, scale_x),
  YES_OR_NO(recipe_extract, fit),
  CYAML_FIELD_MAPPING_PTR("beside", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct recipe_extract,
                          beside, beside_fields),
  TEXT(recipe_extract, program),
  LIST(recipe_extract, arguments, num_arguments, text_value),
  CYAML_FIELD_END};

static const cyaml_schema_field_t labels_fields[] = {TEXT(recipe_labels, x), TEXT(recipe_labels, y),
                                                     TEXT(recipe_labels, colour), CYAML_FIELD_END};

static const cyaml_schema_field_t overlay_fields[] = {NEEDED_TEXT(recipe_overlay, file),
                                                      TEXT(recipe_overlay, title),
                                                      NEEDED_TEXT(recipe_overlay, about),
                                                      NUMBER(recipe_overlay, scale_x),
                                                      NUMBER(recipe_overlay, scale_y),
                                                      NUMBER(recipe_overlay, time),
                                                      CYAML_FIELD_END};
static const cyaml_schema_value_t overlay_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct recipe_overlay, overlay_fields)};

static const cyaml_schema_field_t recipe_fields[] = {
  NEEDED_TEXT(recipe, name),
  NEEDED_TEXT(recipe, about),
  NEEDED_TEXT(recipe, statement),
  CYAML_FIELD_INT("order", CYAML_FLAG_OPTIONAL, struct recipe, order),
  YES_OR_NO(recipe, standard),
  TEXT(recipe, paper),
  TEXT(recipe, place),
  TEXT(recipe, departures),
  TEXT(recipe, runs_of),
  LIST(recipe, runs, num_runs, runs_value),
  CYAML_FIELD_MAPPING("extract", CYAML_FLAG_DEFAULT, struct recipe, extract, extract_fields),
  CYAML_FIELD_MAPPING("labels", CYAML_FLAG_OPTIONAL, struct recipe, labels, labels_fields),
  LIST(recipe, windows, num_windows, number_value),
  LIST(recipe, colours, num_colours, number_value),
  LIST(recipe, overlays, num_overlays, overlay_value),
  CYAML_FIELD_END};
static const cyaml_schema_value_t recipe_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct recipe, recipe_fields)};

/* --- where they are --- */

struct path recipe_folder(const char *name)
{
  if (strchr(name, '/')) return path_of("%s", name);
  const struct path data = data_folder();
  return path_of("%s/paper-figures/%s", data.text, name);
}

struct names recipe_names(void)
{
  const struct path data = data_folder(), all = path_of("%s/paper-figures", data.text);
  struct names names = folder_names(all.text);
  int kept = 0;
  for (int k = 0; k < names.n; k++) {
    const struct path recipe = path_of("%s/%s/recipe.yaml", all.text, names.name[k]);
    if (path_is_file(recipe.text))
      names.name[kept++] = names.name[k];
    else
      free(names.name[k]);
  }
  names.n = kept;
  return names;
}

static status unknown(const char *name)
{
  struct names names = recipe_names();
  const char *near = nearest_name(name, (const char *const *)names.name, names.n);
  const status result =
    near ? user_error("no figure is called '%s'; the nearest known name is '%s'", name, near)
         : user_error("no figure is called '%s'; 'sphbench list figures' lists them", name);
  names_free(&names);
  return result;
}

/* --- what the schema cannot say --- */

static status check_frames(const struct recipe *r)
{
  const struct recipe_extract *e = &r->extract;
  if (!e->num_times || !e->colour)
    return yaml_source_refuse(r->source, "extract", "kind frames needs times and colour");
  if (r->num_windows != 4 && r->num_windows != 4 * e->num_times)
    return yaml_source_refuse(r->source, "windows",
                              "%u numbers found, allowed is 4 (x0, x1, y0, y1), or 4 for each of "
                              "the %u times",
                              r->num_windows, e->num_times);
  if (r->num_colours != 2)
    return yaml_source_refuse(r->source, "colours", "%u numbers found, expected lowest and highest",
                              r->num_colours);
  return OK;
}

static status check_set(const struct recipe *r, const char *at, char *const *set, unsigned n)
{
  const struct path place = path_of("%s.set", at);
  for (unsigned k = 0; k < n; k++)
    if (!strchr(set[k], '='))
      return yaml_source_refuse(r->source, place.text, "'%s' found, KEY=VALUE expected", set[k]);
  return OK;
}

static status check_vary(const struct recipe *r, const char *at, const struct recipe_vary *vary)
{
  if (!vary || vary->num_values) return OK;
  return yaml_source_refuse(r->source, at, "vary has no values");
}

static status check_runs(const struct recipe *r, const struct recipe_runs *runs, unsigned number)
{
  const struct path at = path_of("runs[%u]", number), size = path_of("%s.at_paper_size", at.text);
  const struct recipe_size *paper = runs->at_paper_size;
  TRY(check_vary(r, at.text, runs->vary));
  if (r->extract.kind == EXTRACT_METRIC && !runs->vary)
    return yaml_source_refuse(r->source, at.text, "kind metric needs a parameter to vary");
  TRY(check_set(r, at.text, runs->set, runs->num_set));
  if (!paper) return OK;
  TRY(check_vary(r, size.text, paper->vary));
  return check_set(r, size.text, paper->set, paper->num_set);
}

static status check_paper(const struct recipe *r)
{
  return !r->paper == !r->place
           ? OK
           : yaml_source_refuse(r->source, "name", "paper and place belong together");
}

static status check(const struct recipe *r)
{
  const struct recipe_extract *e = &r->extract;
  TRY(check_paper(r));
  for (unsigned k = 0; k < r->num_runs; k++) TRY(check_runs(r, &r->runs[k], k + 1));
  if (e->kind == EXTRACT_FRAMES) return check_frames(r);
  if (!e->program == (e->kind == EXTRACT_PROGRAM))
    return yaml_source_refuse(r->source, "extract",
                              "kind program and the key program belong "
                              "together");
  if (e->beside && e->kind != EXTRACT_TABLE)
    return yaml_source_refuse(r->source, "extract.beside", "only kind table has it");
  if (e->kind == EXTRACT_PROGRAM) return OK;
  return e->num_columns ? OK
                        : yaml_source_refuse(r->source, "extract", "columns is missing or empty");
}

/* The runs of the recipe that `runs_of` names become this one's own. */
static status adopt_runs(struct recipe *r)
{
  struct yaml_source *source;
  void *data;
  const int may_have_none = r->extract.kind == EXTRACT_PROGRAM && !r->runs_of;
  if (!r->runs_of == !r->num_runs && !may_have_none)
    return yaml_source_refuse(r->source, "name", "either runs or runs_of is needed");
  if (!r->runs_of) return OK;
  const struct path folder = recipe_folder(r->runs_of);
  const struct path file = path_of("%s/recipe.yaml", folder.text);
  if (!path_is_file(file.text))
    return yaml_source_refuse(r->source, "runs_of", "no figure is called '%s'", r->runs_of);
  TRY(yaml_source_read(file.text, &recipe_value, &source, &data));
  struct recipe *other = data;
  const int chained = other->runs_of != NULL;
  if (!chained) {
    r->runs = other->runs;
    r->num_runs = other->num_runs;
    other->runs = NULL;
    other->num_runs = 0;
  }
  yaml_source_free(source, other);
  return chained
           ? yaml_source_refuse(r->source, "runs_of", "'%s' has no runs of its own", r->runs_of)
           : OK;
}

status recipe_read(const char *name, struct recipe **recipe)
{
  const struct path folder = recipe_folder(name), path = path_of("%s/recipe.yaml", folder.text);
  struct yaml_source *source;
  void *data;
  *recipe = NULL;
  if (!path_is_file(path.text) && !strchr(name, '/')) return unknown(name);
  TRY(yaml_source_read(path.text, &recipe_value, &source, &data));
  struct recipe *r = data;
  r->source = source;
  status result = adopt_runs(r);
  for (unsigned k = 0; k < r->num_runs; k++) file_look_beside(&r->runs[k].scene, path.text);
  if (result == OK) result = check(r);
  if (result == OK)
    *recipe = r;
  else
    recipe_free(r);
  return result;
}

/* --- the size --- */

static void exchange(char **a, char **b)
{
  char *const kept = *a;
  if (!*b) return;
  *a = *b;
  *b = kept;
}

/* KEY=VALUE takes the place of the entry with that key, or is added. */
static status exchange_set(struct recipe_runs *runs, char **entry)
{
  const size_t key = strcspn(*entry, "=") + 1;
  for (unsigned k = 0; k < runs->num_set; k++)
    if (strncmp(runs->set[k], *entry, key) == 0) {
      exchange(&runs->set[k], entry);
      return OK;
    }
  char **more = realloc(runs->set, (runs->num_set + 1) * sizeof *more);
  if (!more) return status_set(ERR_MEMORY, "out of memory");
  runs->set = more;
  runs->set[runs->num_set++] = *entry;
  *entry = NULL;
  return OK;
}

status recipe_at_paper_size(struct recipe *recipe)
{
  for (unsigned k = 0; k < recipe->num_runs; k++) {
    struct recipe_runs *runs = &recipe->runs[k];
    struct recipe_size *size = runs->at_paper_size;
    if (!size) continue;
    exchange(&runs->dt, &size->dt);
    exchange(&runs->t_end, &size->t_end);
    exchange(&runs->spacing, &size->spacing);
    exchange(&runs->frames, &size->frames);
    for (unsigned i = 0; i < size->num_set; i++) TRY(exchange_set(runs, &size->set[i]));
    if (size->vary) {
      struct recipe_vary *const kept = runs->vary;
      runs->vary = size->vary;
      size->vary = kept;
    }
  }
  return OK;
}

bool recipe_is_paper_size(const struct recipe *recipe, bool paper_size)
{
  for (unsigned k = 0; k < recipe->num_runs; k++)
    if (recipe->runs[k].at_paper_size) return paper_size;
  return true;
}

void recipe_free(struct recipe *recipe)
{
  if (recipe) yaml_source_free(recipe->source, recipe);
}
