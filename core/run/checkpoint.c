/* A run of the command line to a file and back: whose it is, the state, the samples so far. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "restart.h"

#define FORMAT "sphbench restart 1"
enum { WORD = 64 };

static struct h5_label label(const char *name, const char *unit, const char *about)
{
  return (struct h5_label){name, unit, about};
}

/* A text that must be the same in the file and in this run. */
static void walk_word(struct shelf *s, const char *name, const char *about, const char *here)
{
  char text[2 * WORD];
  snprintf(text, sizeof text, "%s", here);
  shelf_text(s, label(name, "1", about), text, sizeof text);
  if (s->failed == OK && !s->saving && strncmp(text, here, sizeof text - 1) != 0)
    shelf_refuse(s, "it was written with %s '%s', this run has '%s'", about, text, here);
}

static unsigned long long fingerprint(unsigned long long hash, const void *data, size_t bytes)
{
  for (size_t k = 0; k < bytes; k++)
    hash = (hash ^ ((const unsigned char *)data)[k]) * 0x100000001b3ULL; /* FNV-1a */
  return hash;
}

/* Where everything was at the start: two scene files of one name may differ. */
static unsigned long long start_of(const struct scene *s)
{
  unsigned long long hash = 0xcbf29ce484222325ULL;
  hash = fingerprint(hash, s->x, sizeof(vec) * (size_t)s->n);
  hash = fingerprint(hash, s->v, sizeof(vec) * (size_t)s->n);
  return fingerprint(hash, s->wall_x, sizeof(vec) * (size_t)s->n_wall);
}

/* All parameters but the end of the run, which may be put off. */
static void walk_parameters(struct shelf *s, const struct plan *plan)
{
  for (int k = 0; k < plan->num_parameters; k++) {
    const struct fact *f = &plan->parameters[k];
    char name[2 * WORD], value[WORD], about[WORD];
    if (strcmp(f->name, "t_end") == 0 || strcmp(f->name, "samples") == 0) continue;
    snprintf(name, sizeof name, "parameters/%s", f->name);
    snprintf(about, sizeof about, "%s =", f->name);
    snprintf(value, sizeof value, "%.17g", f->value);
    walk_word(s, name, about, f->word ? f->word : value);
  }
}

static void walk_identity(struct shelf *s, const struct checkpoint *c)
{
  char start[WORD];
  snprintf(start, sizeof start, "%016llx", start_of(&c->run->scene));
  shelf_group(s, "parameters");
  walk_word(s, "format", "format", FORMAT);
  walk_word(s, "scene", "scene", c->scene);
  walk_word(s, "method", "solver", c->run->solver->name);
  walk_word(s, "variant", "variant", SPHBENCH_VARIANT);
  walk_parameters(s, c->plan);
  walk_word(s, "start", "a start", start);
}

static void walk_columns(struct shelf *s, const char *name, double **columns, int n, long rows)
{
  for (int k = 0; k < n; k++) {
    char place[40];
    snprintf(place, sizeof place, "record/%s%d", name, k);
    shelf_array(s, label(place, "1", "a column of the series, in the order of the metrics"),
                (struct shelf_array){SHELF_DOUBLE, rows, 0, columns[k]});
  }
}

/* Has the file as many rows as it says? */
static void check_rows(struct shelf *s, const char *name, long rows)
{
  if (s->failed == OK && rows != 0 && shelf_rows(s, name) != rows)
    shelf_refuse(s, "its %s has %ld rows, it says %ld", name, shelf_rows(s, name), rows);
}

static void walk_record(struct shelf *s, const struct checkpoint *c)
{
  struct record *r = c->record;
  long rows = r->rows, steps = r->steps;
  shelf_group(s, "record");
  shelf_whole(s, label("record/samples", "1", "number of samples"), &rows);
  shelf_whole(s, label("record/steps", "1", "number of steps"), &steps);
  shelf_whole(s, label("record/steps_counted", "1", "at the last sample"), &r->steps_counted);
  shelf_whole(s, label("record/iterations_counted", "1", "at the last sample"),
              &r->iterations_counted);
  shelf_number(s, label("record/next_sample", "s", "when the next one is due"), c->next_sample);
  if (!s->saving) check_rows(s, "record/sample0", rows);
  if (!s->saving) check_rows(s, "record/step0", steps);
  if (s->failed == OK && !s->saving) s->failed = record_make_room(r, rows, steps);
  walk_columns(s, "sample", r->sample, NUM_METRICS + 3, rows);
  walk_columns(s, "step", r->step, 3, steps);
  shelf_array(s, label("record/last", "1", "the last sample's metrics"),
              (struct shelf_array){SHELF_DOUBLE, NUM_METRICS, 0, r->last.value});
}

/* What a scene has summed up for its errors. */
static void walk_scene(struct shelf *s, const struct checkpoint *c)
{
  const struct setting *set = &c->plan->setting;
  if (!set->benchmark) return;
  shelf_array(s, label("scene_state", "1", "the scene's own numbers, byte for byte"),
              (struct shelf_array){SHELF_INT, (long)(set->benchmark->state_size / sizeof(int)), 0,
                                   set->self});
}

static status walk(const char *path, int saving, const struct checkpoint *c)
{
  struct shelf shelf;
  TRY(shelf_open(&shelf, path, saving));
  walk_identity(&shelf, c);
  if (shelf.failed == OK) restart_walk(&shelf, c->run);
  walk_record(&shelf, c);
  walk_scene(&shelf, c);
  return shelf_close(&shelf);
}

status checkpoint_save(const char *path, const struct checkpoint *c)
{
  const enum phase before = clock_enter(PHASE_OUTPUT);
  const status result = walk(path, 1, c);
  clock_enter(before);
  return result;
}

status checkpoint_load(const char *path, const struct checkpoint *c) { return walk(path, 0, c); }

char *checkpoint_path(const struct options *o)
{
  char *path = NULL;
  const char *end = o->output ? strrchr(o->output, '.') : NULL;
  const int length = end && !strchr(end, '/') ? (int)(end - o->output) : -1;
  const char *slash = strrchr(o->name, '/'), *scene = slash ? slash + 1 : o->name;
  const int made = o->output ? asprintf(&path, "%.*s.restart", length, o->output)
                             : asprintf(&path, "%s-%s.restart", scene, o->solver);
  return made < 0 ? NULL : path;
}
