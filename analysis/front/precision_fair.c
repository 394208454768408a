/* Were all points run under the same conditions? Asked of what the runs themselves wrote. */
#include <stdlib.h>
#include <string.h>

#include "precision.h"

static const json_t *fact_at(const json_t *facts, const char *keys)
{
  char name[64];
  for (const char *key = keys; facts && *key;) {
    const size_t length = strcspn(key, ".");
    snprintf(name, sizeof name, "%.*s", (int)length, key);
    facts = json_object_get(facts, name);
    key += length + (key[length] == '.');
  }
  return facts;
}

static char *value_words(const json_t *value)
{
  char *text = value ? json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(9)) : NULL;
  return text ? text : strdup("missing");
}

/* Does the first valid point that `like` belongs to (all, or those of its spacing) agree? */
static const struct point *model_of(const struct precision *p, const struct point *like,
                                    int same_spacing)
{
  for (int k = 0; k < p->n; k++) {
    const struct point *other = &p->point[k];
    if (other->reason) continue;
    if (!same_spacing || other->knobs.spacing == like->knobs.spacing) return other;
  }
  return like;
}

static int times_agree(const json_t *a, const json_t *b)
{
  const double x = json_number_value(a), y = json_number_value(b);
  return fabs(x - y) <= 1e-9 * fabs(y);
}

/* One condition for all points; those that differ lose their validity. */
struct condition {
  const char *keys, *what;
  int same_spacing; /* only points of one spacing must agree */
};

static void compare(struct precision *p, const struct condition *c)
{
  char *first = NULL;
  int same = 1;
  for (int k = 0; k < p->n; k++) {
    struct point *point = &p->point[k];
    if (point->reason) continue;
    const struct point *model = model_of(p, point, c->same_spacing);
    const json_t *mine = fact_at(point->facts, c->keys), *its = fact_at(model->facts, c->keys);
    if (!first) first = value_words(its);
    if (json_equal((json_t *)mine, (json_t *)its) || (!mine && !its)) continue;
    if (json_is_real(mine) && json_is_real(its) && times_agree(mine, its)) continue;
    char *words = value_words(mine), *others = value_words(its);
    point->reason =
      text_make("cannot be compared: its %s is %s, of the others %s", c->what, words, others);
    free(words);
    free(others);
    same = 0;
  }
  json_array_append_new(p->fairness,
                        json_pack("{s:s, s:b, s:s}", "what", c->what, "same", same, "value",
                                  !first            ? "no valid point"
                                  : c->same_spacing ? "equal among points of one spacing"
                                                    : first));
  free(first);
}

/* Parameters of the scene, but for those that are swept. */
static void compare_scene(struct precision *p)
{
  static const char *const swept[] = {"spacing", "dt"};
  size_t k;
  json_t *row;
  json_array_foreach(json_object_get(p->study.scene, "parameters"), k, row)
  {
    const char *name = json_string_value(json_object_get(row, "name"));
    if (!name || !strcmp(name, swept[0]) || !strcmp(name, swept[1])) continue;
    const struct path keys = path_of("parameters.%s", name);
    const struct condition condition = {keys.text, name, 0};
    compare(p, &condition);
  }
}

status points_compare(struct precision *p)
{
  static const struct condition conditions[] = {
    {"variant", "executable (machine, dimension, precision)", 0},
    {"provenance.commit", "commit", 0},
    {"provenance.flags", "compiler's flags", 0},
    {"provenance.cpu", "processor", 0},
    {"parameters.seed", "seed", 0},
    {"time_end", "simulated time", 0},
    {"particles", "number of particles", 1},
    {"walls", "number of wall particles", 1},
  };
  p->fairness = json_array();
  if (!p->fairness) return status_set(ERR_MEMORY, "out of memory");
  for (size_t k = 0; k < sizeof conditions / sizeof *conditions; k++) compare(p, &conditions[k]);
  compare_scene(p);
  return OK;
}
