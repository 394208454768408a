#include "study_file.h"

#include <cyaml/cyaml.h>
#include <string.h>

#include "../../core/base/yaml_source.h"
#include "variants.h"

#define NUMBERS(member)                                                                  \
  CYAML_FIELD_SEQUENCE_COUNT(#member, CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL,          \
                             struct study_sweep, member, num_##member, &number_value, 1, \
                             MOST_VALUES)

static const cyaml_schema_value_t number_value = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, double)};
static const cyaml_schema_value_t text_value = {
  CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, CYAML_UNLIMITED)};

static const cyaml_schema_field_t sweep_fields[] = {
  CYAML_FIELD_FLOAT("t_end", CYAML_FLAG_OPTIONAL, struct study_sweep, t_end), NUMBERS(spacing),
  NUMBERS(dt), NUMBERS(tolerance), CYAML_FIELD_END};

static const cyaml_schema_field_t file_fields[] = {
  CYAML_FIELD_STRING_PTR("scene", CYAML_FLAG_POINTER, struct study_file, scene, 1, CYAML_UNLIMITED),
  CYAML_FIELD_SEQUENCE_COUNT("set", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct study_file,
                             set, num_set, &text_value, 0, MOST_SETS),
  CYAML_FIELD_MAPPING("full", CYAML_FLAG_OPTIONAL, struct study_file, full, sweep_fields),
  CYAML_FIELD_MAPPING("quick", CYAML_FLAG_OPTIONAL, struct study_file, quick, sweep_fields),
  CYAML_FIELD_MAPPING("levels", CYAML_FLAG_OPTIONAL, struct study_file, levels, sweep_fields),
  CYAML_FIELD_FLOAT("jitter", CYAML_FLAG_OPTIONAL, struct study_file, jitter),
  CYAML_FIELD_END};
static const cyaml_schema_value_t file_value = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct study_file, file_fields)};

/* --- what any scene can do with --- */

static struct values scaled(double by, int n, const double *factors)
{
  struct values values = {.n = n};
  for (int k = 0; k < n; k++) values.value[k] = by * factors[k];
  return values;
}

static void fill_defaults(struct study *s)
{
  static const double sizes[] = {2, 1.4142135623730951, 1}, levels[] = {4, 2.83, 2, 1.41, 1};
  static const double steps[] = {2, 1, 0.5}, one[] = {1}, efforts[] = {100, 10, 1, 0.1};
  const int quick = s->ask.quick;
  struct sweep_plan *p = &s->plan;
  p->t_end = s->t_end;
  p->spacing = scaled(s->spacing, quick && !s->is_projection ? 2 : 3, sizes);
  p->dt = s->is_projection ? scaled(1, 1, one) : scaled(1, quick ? 2 : 3, steps);
  p->tolerance = scaled(1, quick && !s->is_projection ? 3 : 4, efforts);
  s->levels = scaled(s->spacing, quick ? 4 : 5, levels);
  s->jitter = 0.1;
}

/* --- what the file says instead --- */

static void take(struct values *to, const double *from, unsigned n)
{
  if (n == 0) return;
  to->n = (int)n;
  memcpy(to->value, from, n * sizeof *from);
}

static void take_sweep(struct sweep_plan *plan, const struct study_sweep *sweep)
{
  if (sweep->t_end > 0) plan->t_end = sweep->t_end;
  take(&plan->spacing, sweep->spacing, sweep->num_spacing);
  take(&plan->dt, sweep->dt, sweep->num_dt);
  take(&plan->tolerance, sweep->tolerance, sweep->num_tolerance);
}

static status check_positive(const struct study *s, const char *key, const struct study_sweep *w)
{
  const struct {
    const double *value;
    unsigned n;
  } lists[] = {{w->spacing, w->num_spacing}, {w->dt, w->num_dt}, {w->tolerance, w->num_tolerance}};
  for (int l = 0; l < 3; l++)
    for (unsigned k = 0; k < lists[l].n; k++)
      if (!(lists[l].value[k] > 0))
        return yaml_source_refuse(s->source, key, "%g found, allowed are numbers above 0",
                                  lists[l].value[k]);
  return OK;
}

static status check(const struct study *s)
{
  const struct study_file *f = s->file;
  if (strcmp(f->scene, s->ask.scene) != 0)
    return yaml_source_refuse(s->source, "scene", "'%s' found, expected '%s'", f->scene,
                              s->ask.scene);
  for (unsigned k = 0; k < f->num_set; k++)
    if (!strchr(f->set[k], '='))
      return yaml_source_refuse(s->source, "set", "'%s' found, KEY=VALUE expected", f->set[k]);
  TRY(check_positive(s, "full", &f->full));
  TRY(check_positive(s, "quick", &f->quick));
  return check_positive(s, "levels", &f->levels);
}

status study_file_read(struct study *s)
{
  const struct path data = data_folder();
  const struct path path = path_of("%s/benchmarks/precision/%s.yaml", data.text, s->ask.scene);
  void *content = NULL;
  fill_defaults(s);
  if (!path_is_file(path.text)) return OK;
  TRY(yaml_source_read(path.text, &file_value, &s->source, &content));
  s->file = content;
  TRY(check(s));
  take_sweep(&s->plan, &s->file->full);
  if (s->ask.quick) take_sweep(&s->plan, &s->file->quick);
  take(&s->levels, s->file->levels.spacing, s->file->levels.num_spacing);
  if (s->file->jitter > 0) s->jitter = s->file->jitter;
  return OK;
}
