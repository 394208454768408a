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
  CYAML_FIELD_END};
static const cyaml_schema_value_t runs_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct recipe_runs, runs_fields)};

static const cyaml_strval_t kinds[] = {{"frames", EXTRACT_FRAMES},
                                       {"series", EXTRACT_SERIES},
                                       {"metric", EXTRACT_METRIC},
                                       {"table", EXTRACT_TABLE}};
static const cyaml_schema_field_t extract_fields[] = {
  CYAML_FIELD_ENUM("kind", CYAML_FLAG_STRICT, struct recipe_extract, kind, kinds, 4),
  LIST(recipe_extract, times, num_times, number_value),
  TEXT(recipe_extract, colour),
  LIST(recipe_extract, columns, num_columns, text_value),
  NUMBER(recipe_extract, scale_x),
  YES_OR_NO(recipe_extract, fit),
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

static status check_runs(const struct recipe *r, const struct recipe_runs *runs, unsigned number)
{
  const struct path at = path_of("runs[%u]", number), set = path_of("%s.set", at.text);
  if (runs->vary && !runs->vary->num_values)
    return yaml_source_refuse(r->source, at.text, "vary has no values");
  if (r->extract.kind == EXTRACT_METRIC && !runs->vary)
    return yaml_source_refuse(r->source, at.text, "kind metric needs a parameter to vary");
  for (unsigned i = 0; i < runs->num_set; i++)
    if (!strchr(runs->set[i], '='))
      return yaml_source_refuse(r->source, set.text, "'%s' found, KEY=VALUE expected",
                                runs->set[i]);
  return OK;
}

static status check(const struct recipe *r)
{
  for (unsigned k = 0; k < r->num_runs; k++) TRY(check_runs(r, &r->runs[k], k + 1));
  if (r->extract.kind == EXTRACT_FRAMES) return check_frames(r);
  return r->extract.num_columns
           ? OK
           : yaml_source_refuse(r->source, "extract", "columns is missing or empty");
}

/* The runs of the recipe that `runs_of` names become this one's own. */
static status adopt_runs(struct recipe *r)
{
  struct yaml_source *source;
  void *data;
  if (!r->runs_of == !r->num_runs)
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

void recipe_free(struct recipe *recipe)
{
  if (recipe) yaml_source_free(recipe->source, recipe);
}
