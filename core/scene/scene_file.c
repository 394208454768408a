#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "scene_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../base/yaml_source.h"
#include "scene_schema.h"

struct scene_file {
  struct yaml_source *yaml;
  struct file_scene *said;
  char *name;
  struct scene_params values; /* of the params that the file gives */
  unsigned given;             /* bit k: row k of scene_param_rows */
};

enum { KEY_ROOM = 96, MOST_LAYERS = 100 };

/* "fluid[3].box" and the like */
static void key_of(char key[KEY_ROOM], const char *list, unsigned k, const char *rest)
{
  snprintf(key, KEY_ROOM, "%s[%u]%s", list, k + 1, rest);
}

/* --- checks that the schema cannot make; each names its place --- */

static status check_vector(const struct scene_file *f, const char *key, const char *name,
                           unsigned count)
{
  char place[KEY_ROOM + 32];
  snprintf(place, sizeof place, "%s%s%s", key, *key ? "." : "", name);
  if ((int)count == f->said->dim) return OK;
  return yaml_source_refuse(f->yaml, place, "%s has %u entries, allowed are %d as dim is %d", place,
                            count, f->said->dim, f->said->dim);
}

static status check_box(const struct scene_file *f, const char *key, const struct file_box *b)
{
  TRY(check_vector(f, key, "low", b->low_count));
  TRY(check_vector(f, key, "high", b->high_count));
  for (int d = 0; d < f->said->dim; d++)
    if (!(b->high[d] > b->low[d]))
      return yaml_source_refuse(f->yaml, key,
                                "%s.high is %g on axis %d, allowed is more than low, %g", key,
                                b->high[d], d + 1, b->low[d]);
  return OK;
}

static status check_ball(const struct scene_file *f, const char *key, const struct file_ball *b)
{
  TRY(check_vector(f, key, "centre", b->centre_count));
  if (b->radius > 0) return OK;
  return yaml_source_refuse(f->yaml, key, "%s.radius is %g, allowed is more than 0", key,
                            b->radius);
}

static status check_polygon(const struct scene_file *f, const char *key,
                            const struct file_polygon *p)
{
  if (f->said->dim == 2)
    return p->z
             ? yaml_source_refuse(f->yaml, key, "%s.z is given, allowed only where dim is 3", key)
             : OK;
  if (!p->z) return yaml_source_refuse(f->yaml, key, "%s has no key 'z', the two ends in 3-D", key);
  if (p->z[1] > p->z[0]) return OK;
  return yaml_source_refuse(f->yaml, key, "%s.z ends at %g, allowed is more than its start, %g",
                            key, p->z[1], p->z[0]);
}

static status check_motion(const struct scene_file *f, const char *key, const struct file_shape *s)
{
  char inside[KEY_ROOM + 16];
  if (s->velocity) TRY(check_vector(f, key, "velocity", s->velocity_count));
  if (!s->rotation) return OK;
  snprintf(inside, sizeof inside, "%s.rotation", key);
  return check_vector(f, inside, "centre", s->rotation->centre_count);
}

static status check_shape(const struct scene_file *f, unsigned k)
{
  const struct file_shape *s = &f->said->fluid[k];
  const int shapes = !!s->box + !!s->disc + !!s->ball + !!s->polygon;
  char key[KEY_ROOM];
  key_of(key, "fluid", k, "");
  if (shapes != 1)
    return yaml_source_refuse(
      f->yaml, key, "%s has %d shapes, allowed is one of box, disc, ball, polygon", key, shapes);
  TRY(check_motion(f, key, s));
  key_of(key, "fluid", k, s->box ? ".box" : s->disc ? ".disc" : s->ball ? ".ball" : ".polygon");
  if (s->disc && f->said->dim == 3)
    return yaml_source_refuse(f->yaml, key, "%s is given, allowed in 3-D is ball", key);
  if (s->ball && f->said->dim == 2)
    return yaml_source_refuse(f->yaml, key, "%s is given, allowed in 2-D is disc", key);
  if (s->box) return check_box(f, key, s->box);
  if (s->polygon) return check_polygon(f, key, s->polygon);
  return check_ball(f, key, s->disc ? s->disc : s->ball);
}

static status check_wall(const struct scene_file *f, unsigned k)
{
  const struct file_wall_box *b = f->said->walls[k].box;
  const struct file_box box = {b->low, b->high, b->low_count, b->high_count};
  char key[KEY_ROOM];
  key_of(key, "walls", k, ".box");
  TRY(check_box(f, key, &box));
  if (!b->layers || (*b->layers >= 1 && *b->layers <= MOST_LAYERS)) return OK;
  key_of(key, "walls", k, ".box.layers");
  return yaml_source_refuse(f->yaml, key, "%s is %d, allowed are 1 to %d", key, *b->layers,
                            MOST_LAYERS);
}

static status check_domain(const struct scene_file *f)
{
  const struct file_domain *d = f->said->domain;
  if (!d) return OK;
  const struct file_box box = {d->low, d->high, d->low_count, d->high_count};
  TRY(check_box(f, "domain", &box));
  if (!d->period) return OK;
  TRY(check_vector(f, "domain", "period", d->period_count));
  for (int k = 0; k < f->said->dim; k++) {
    const double side = d->high[k] - d->low[k];
    if (d->period[k] != 0 && !(fabs(d->period[k] - side) <= 1e-9 * side))
      return yaml_source_refuse(
        f->yaml, "domain.period",
        "domain.period is %g on axis %d, allowed is 0 (open) or the side, %g", d->period[k], k + 1,
        side);
  }
  return OK;
}

/* --- parameters --- */

static double *value_of(struct scene_params *values, int k)
{
  return (double *)((char *)values + scene_param_rows[k].offset);
}

static double length_of(const double *a, unsigned n)
{
  double sum = 0;
  for (unsigned d = 0; d < n; d++) sum += a[d] * a[d];
  return sqrt(sum);
}

/* The file's gravity is a parameter too: its length, which a user may change. */
static status take_gravity(struct scene_file *f)
{
  const struct file_scene *s = f->said;
  const struct param *row = param_find(scene_param_rows, num_scene_params, "gravity");
  if (!s->gravity) return OK;
  TRY(check_vector(f, "", "gravity", s->gravity_count));
  if (s->params && s->params->gravity)
    return yaml_source_refuse(f->yaml, "gravity",
                              "gravity is given here and in params, allowed is one");
  f->values.gravity = length_of(s->gravity, s->gravity_count);
  f->given |= 1u << (row - scene_param_rows);
  if (f->values.gravity <= row->high) return OK;
  return yaml_source_refuse(f->yaml, "gravity", "gravity is %g m/s^2, allowed is at most %g",
                            f->values.gravity, row->high);
}

static status take_params(struct scene_file *f)
{
  const struct file_params *said = f->said->params;
  char place[512], key[KEY_ROOM];
  for (int k = 0; said && k < num_scene_params; k++) {
    const struct param *row = &scene_param_rows[k];
    const char *text = NULL;
#define P(param, initial, low, high, unit, meaning) \
  if (!strcmp(row->name, #param)) text = said->param;
    SCENE_PARAMS(P)
#undef P
    if (!text) continue;
    snprintf(key, sizeof key, "params.%s", row->name);
    TRY(param_parse(row, text, yaml_source_place(f->yaml, key, place, sizeof place),
                    value_of(&f->values, k)));
    f->given |= 1u << k;
  }
  return take_gravity(f);
}

static status take_name(struct scene_file *f, const char *path)
{
  const char *slash = strrchr(path, '/');
  f->name = strdup(f->said->name ? f->said->name : slash ? slash + 1 : path);
  if (!f->name) return status_set(ERR_MEMORY, "no memory to read %s", path);
  char *ending = f->said->name ? NULL : strrchr(f->name, '.');
  if (ending && ending > f->name) *ending = 0;
  return OK;
}

static status check_all(struct scene_file *f, const char *path)
{
  const struct file_scene *s = f->said;
  if (s->dim != 2 && s->dim != 3)
    return yaml_source_refuse(f->yaml, "dim", "dim is %d, allowed is 2 or 3", s->dim);
  TRY(take_name(f, path));
  TRY(take_params(f));
  TRY(check_domain(f));
  for (unsigned k = 0; k < s->fluid_count; k++) TRY(check_shape(f, k));
  for (unsigned k = 0; k < s->walls_count; k++) TRY(check_wall(f, k));
  return OK;
}

status scene_file_load(const char *path, struct scene_file **out)
{
  struct scene_file *f = calloc(1, sizeof *f);
  void *data = NULL;
  *out = NULL;
  if (!f) return status_set(ERR_MEMORY, "no memory to read %s", path);
  status result = yaml_source_read(path, scene_schema, &f->yaml, &data);
  f->said = data;
  if (result == OK) result = check_all(f, path);
  if (result == OK)
    *out = f;
  else
    scene_file_free(f);
  return result;
}

const char *scene_file_name(const struct scene_file *file) { return file->name; }
const char *scene_file_about(const struct scene_file *file)
{
  return file->said->about ? file->said->about : "";
}
const char *scene_file_source(const struct scene_file *file)
{
  return file->said->source ? file->said->source : "";
}
int scene_file_dim(const struct scene_file *file) { return file->said->dim; }

void scene_file_defaults(const struct scene_file *file, struct scene_params *common)
{
  struct scene_params values = file->values;
  for (int k = 0; k < num_scene_params; k++)
    if (file->given & (1u << k)) *value_of(common, k) = *value_of(&values, k);
}

void scene_file_free(struct scene_file *file)
{
  if (!file) return;
  yaml_source_free(file->yaml, file->said);
  free(file->name);
  free(file);
}

/* --- filling --- */

static vec vector(const double *a)
{
  vec v = zero();
  for (int d = 0; d < DIM && a; d++) v.c[d] = (real)a[d];
  return v;
}

static status fill_shape(struct scene *scene, const struct file_shape *s)
{
  const vec v = vector(s->velocity);
  const struct file_ball *ball = s->disc ? s->disc : s->ball;
  if (s->box) return scene_fill_box(scene, vector(s->box->low), vector(s->box->high), v, NULL);
  if (ball) return scene_fill_disc(scene, vector(ball->centre), ball->radius, v);
  const struct file_polygon *p = s->polygon;
  return scene_fill_polygon(scene, (const double(*)[2])p->corners, (int)p->corners_count,
                            p->z ? p->z[0] : 0, p->z ? p->z[1] : 0, v);
}

/* v += omega e_z x (x - centre), for the particles from `first` on */
static void rotate(struct scene *scene, int first, const struct file_rotation *r)
{
  for (int i = first; r && i < scene->n; i++) {
    const double x = (double)scene->x[i].c[0] - r->centre[0];
    const double y = (double)scene->x[i].c[1] - r->centre[1];
    scene->v[i].c[0] = (real)((double)scene->v[i].c[0] - r->omega * y);
    scene->v[i].c[1] = (real)((double)scene->v[i].c[1] + r->omega * x);
  }
}

static status build_wall(struct scene *scene, const struct file_wall_box *b)
{
  const int layers = b->layers ? *b->layers : scene_wall_layers(scene);
  return scene_wall_box(scene, vector(b->low), vector(b->high), layers,
                        b->open_top && *b->open_top);
}

/* An error of filling, with the place of its shape put in front. */
static status with_place(const struct scene_file *f, const char *list, unsigned k, status result)
{
  char key[KEY_ROOM], sentence[1024];
  if (result != ERR_USER) return result;
  key_of(key, list, k, "");
  snprintf(sentence, sizeof sentence, "%s", status_sentence());
  return yaml_source_refuse(f->yaml, key, "%s: %s", key, sentence);
}

/* Without a domain in the file: as much room on every side as the whole scene is wide. */
static void set_domain(const struct scene_file *f, struct scene *scene)
{
  const struct file_domain *d = f->said->domain;
  double widest = 10 * scene->common.spacing;
  if (d) {
    scene->low = vector(d->low);
    scene->high = vector(d->high);
    scene->period = vector(d->period);
    return;
  }
  scene_domain_around(scene, 0);
  for (int k = 0; k < DIM; k++) {
    const double side = (double)(scene->high.c[k] - scene->low.c[k]);
    if (side > widest) widest = side;
  }
  scene_domain_around(scene, widest);
}

static void set_gravity(const struct scene_file *f, struct scene *scene)
{
  const double length = f->said->gravity ? length_of(f->said->gravity, f->said->gravity_count) : 0;
  if (!f->said->gravity) return;
  scene->gravity = zero();
  if (length > 0)
    scene->gravity = times((real)(scene->common.gravity / length), vector(f->said->gravity));
}

status scene_file_build(struct scene_file *file, struct scene *scene)
{
  const struct file_scene *s = file->said;
  if (s->dim != DIM)
    return yaml_source_refuse(file->yaml, "dim", "dim is %d, asked is a run in %d-D", s->dim, DIM);
  for (unsigned k = 0; k < s->fluid_count; k++) {
    const int first = scene->n;
    TRY(with_place(file, "fluid", k, fill_shape(scene, &s->fluid[k])));
    rotate(scene, first, s->fluid[k].rotation);
  }
  for (unsigned k = 0; k < s->walls_count; k++)
    TRY(with_place(file, "walls", k, build_wall(scene, s->walls[k].box)));
  set_domain(file, scene);
  set_gravity(file, scene);
  return OK;
}
