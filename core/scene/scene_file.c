#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "scene_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene_file_inside.h"

enum { MOST_LAYERS = 100 };

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

static status check_shape(const struct scene_file *f, const char *list, unsigned k,
                          const struct file_shape *s)
{
  const int shapes = !!s->box + !!s->disc + !!s->ball + !!s->polygon + !!s->particle;
  char key[KEY_ROOM];
  key_of(key, list, k, "");
  if (shapes != 1)
    return yaml_source_refuse(
      f->yaml, key, "%s has %d shapes, allowed is one of box, disc, ball, polygon, particle", key,
      shapes);
  TRY(check_motion(f, key, s));
  if (s->particle) return check_vector(f, key, "particle", s->particle_count);
  key_of(key, list, k, s->box ? ".box" : s->disc ? ".disc" : s->ball ? ".ball" : ".polygon");
  if (s->disc && f->said->dim == 3)
    return yaml_source_refuse(f->yaml, key, "%s is given, allowed in 3-D is ball", key);
  if (s->ball && f->said->dim == 2)
    return yaml_source_refuse(f->yaml, key, "%s is given, allowed in 2-D is disc", key);
  if (s->box) return check_box(f, key, s->box);
  if (s->polygon) return check_polygon(f, key, s->polygon);
  return check_ball(f, key, s->disc ? s->disc : s->ball);
}

/* "a number of key, if given, is more than 0 (or not below it)" */
static status check_positive(const struct scene_file *f, const char *list, unsigned k,
                             const char *name, const double *number, int zero_too)
{
  char key[KEY_ROOM], rest[32];
  if (!number || *number > 0 || (zero_too && *number == 0)) return OK;
  snprintf(rest, sizeof rest, ".%s", name);
  key_of(key, list, k, rest);
  return yaml_source_refuse(f->yaml, key, "%s is %g, allowed is %s", key, *number,
                            zero_too ? "0 or more" : "more than 0");
}

static status check_moving(const struct scene_file *f, const char *list, unsigned k,
                           const struct file_motion *m)
{
  char key[KEY_ROOM];
  const unsigned spins = f->said->dim == 2 ? 1 : 3;
  if (!m) return OK;
  key_of(key, list, k, ".motion");
  if (m->velocity) TRY(check_vector(f, key, "velocity", m->velocity_count));
  if (m->centre) TRY(check_vector(f, key, "centre", m->centre_count));
  if (m->spin && m->spin_count != spins)
    return yaml_source_refuse(f->yaml, key, "%s.spin has %u entries, allowed are %u as dim is %d",
                              key, m->spin_count, spins, f->said->dim);
  return check_positive(f, list, k, "motion.period", m->period, 0);
}

static status check_wall(const struct scene_file *f, unsigned k)
{
  const struct file_wall_box *b = f->said->walls[k].box;
  const struct file_box box = {b->low, b->high, b->low_count, b->high_count};
  char key[KEY_ROOM];
  TRY(check_moving(f, "walls", k, f->said->walls[k].motion));
  key_of(key, "walls", k, ".box");
  TRY(check_box(f, key, &box));
  if (!b->layers || (*b->layers >= 1 && *b->layers <= MOST_LAYERS)) return OK;
  key_of(key, "walls", k, ".box.layers");
  return yaml_source_refuse(f->yaml, key, "%s is %d, allowed are 1 to %d", key, *b->layers,
                            MOST_LAYERS);
}

static status check_fluid(const struct scene_file *f, unsigned k)
{
  const struct file_shape *s = &f->said->fluid[k];
  TRY(check_shape(f, "fluid", k, s));
  TRY(check_positive(f, "fluid", k, "rho0", s->rho0, 0));
  return check_positive(f, "fluid", k, "viscosity", s->viscosity, 1);
}

static status check_body(const struct scene_file *f, unsigned k)
{
  const struct file_shape *s = &f->said->bodies[k];
  char key[KEY_ROOM];
  TRY(check_shape(f, "bodies", k, s));
  TRY(check_positive(f, "bodies", k, "density", s->density, 0));
  TRY(check_moving(f, "bodies", k, s->motion));
  if (!s->density || !s->motion || !s->motion->period) return OK;
  key_of(key, "bodies", k, ".motion.period");
  return yaml_source_refuse(f->yaml, key,
                            "%s is given, allowed only for a body without density, whose motion is "
                            "prescribed",
                            key);
}

static status check_emitter(const struct scene_file *f, unsigned k)
{
  const struct file_emitter *e = &f->said->emitters[k];
  char key[KEY_ROOM];
  key_of(key, "emitters", k, "");
  TRY(check_vector(f, key, "centre", e->centre_count));
  TRY(check_vector(f, key, "direction", e->direction_count));
  TRY(check_positive(f, "emitters", k, "width", &e->width, 0));
  TRY(check_positive(f, "emitters", k, "speed", &e->speed, 0));
  TRY(check_positive(f, "emitters", k, "begin", e->begin, 1));
  TRY(check_positive(f, "emitters", k, "rho0", e->rho0, 0));
  TRY(check_positive(f, "emitters", k, "viscosity", e->viscosity, 1));
  if (f->said->dim == 2 || !e->depth == (e->round && *e->round)) return OK;
  return yaml_source_refuse(f->yaml, key,
                            "%s is %s, allowed in 3-D is one of depth and round: true", key,
                            e->depth ? "round and has a depth" : "neither round nor has a depth");
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
  for (unsigned k = 0; k < s->fluid_count; k++) TRY(check_fluid(f, k));
  for (unsigned k = 0; k < s->walls_count; k++) TRY(check_wall(f, k));
  for (unsigned k = 0; k < s->bodies_count; k++) TRY(check_body(f, k));
  for (unsigned k = 0; k < s->emitters_count; k++) TRY(check_emitter(f, k));
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
