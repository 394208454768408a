/* From a scene file that was read and checked to a scene full of particles. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <string.h>

#include "scene_file.h"
#include "scene_file_inside.h"

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
  if (s->particle) return scene_add(scene, vector(s->particle), v);
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

static double or_default(const double *number, double otherwise)
{
  return number ? *number : otherwise;
}

/* What is not said of a motion is 0. */
static struct scene_body body_of(const struct file_motion *m, double density)
{
  struct scene_body body;
  memset(&body, 0, sizeof body);
  body.density = density;
  if (!m) return body;
  body.centre = vector(m->centre);
  body.velocity = vector(m->velocity);
  body.period = or_default(m->period, 0);
  for (unsigned d = 0; d < m->spin_count; d++) body.spin[3 - m->spin_count + d] = m->spin[d];
  return body;
}

static status build_wall(struct scene *scene, const struct file_wall *w)
{
  const struct file_wall_box *b = w->box;
  const int layers = b->layers ? *b->layers : scene_wall_layers(scene), first = scene->n_wall;
  TRY(scene_wall_box(scene, vector(b->low), vector(b->high), layers, b->open_top && *b->open_top));
  if (!w->motion) return OK;
  const struct scene_body motion = body_of(w->motion, 0);
  return scene_move_walls(scene, first, &motion);
}

static status find_fluid(struct scene *scene, const double *rho0, const double *viscosity,
                         int *number)
{
  *number = 0;
  if (!rho0 && !viscosity) return OK;
  return scene_find_fluid(scene, or_default(rho0, scene->common.rho0),
                          or_default(viscosity, scene->common.viscosity), number);
}

static status build_fluid(struct scene *scene, const struct file_shape *s)
{
  const int first = scene->n;
  int number;
  TRY(fill_shape(scene, s));
  rotate(scene, first, s->rotation);
  TRY(find_fluid(scene, s->rho0, s->viscosity, &number));
  return scene_set_fluid(scene, first, number);
}

static status build_body(struct scene *scene, const struct file_shape *s)
{
  const int first = scene->n;
  const struct scene_body body = body_of(s->motion, or_default(s->density, 0));
  TRY(fill_shape(scene, s));
  return scene_make_body(scene, first, &body);
}

static status build_emitter(struct scene *scene, const struct file_emitter *e)
{
  struct scene_emitter emitter;
  memset(&emitter, 0, sizeof emitter);
  emitter.centre = vector(e->centre);
  emitter.direction = vector(e->direction);
  emitter.width = e->width;
  emitter.depth = or_default(e->depth, 0);
  emitter.round = e->round && *e->round;
  emitter.speed = e->speed;
  emitter.begin = or_default(e->begin, 0);
  emitter.end = or_default(e->end, HUGE_VAL);
  TRY(find_fluid(scene, e->rho0, e->viscosity, &emitter.fluid));
  return scene_add_emitter(scene, &emitter);
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
  for (unsigned k = 0; k < s->fluid_count; k++)
    TRY(with_place(file, "fluid", k, build_fluid(scene, &s->fluid[k])));
  for (unsigned k = 0; k < s->walls_count; k++)
    TRY(with_place(file, "walls", k, build_wall(scene, &s->walls[k])));
  for (unsigned k = 0; k < s->bodies_count; k++)
    TRY(with_place(file, "bodies", k, build_body(scene, &s->bodies[k])));
  for (unsigned k = 0; k < s->emitters_count; k++)
    TRY(with_place(file, "emitters", k, build_emitter(scene, &s->emitters[k])));
  set_domain(file, scene);
  set_gravity(file, scene);
  return OK;
}
