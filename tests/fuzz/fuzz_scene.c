/* The reader of scene files, and the filling of what it reads. */
#include <float.h>
#include <string.h>

#include "../../core/scene/scene_file.h"
#include "../../core/scene/scene_file_inside.h"
#include "fuzz.h"

enum { MOST_CELLS = 40000, COARSE = 40 };

/* The extent of all that is filled [m]. */
struct extent {
  double low, high;
};

static void include(struct extent *e, const double *at, unsigned n, double margin)
{
  for (unsigned d = 0; d < n; d++) {
    e->low = fmin(e->low, at[d] - margin);
    e->high = fmax(e->high, at[d] + margin);
  }
}

static void include_shapes(struct extent *e, const struct file_shape *shape, unsigned n)
{
  for (unsigned k = 0; k < n; k++) {
    const struct file_shape *s = &shape[k];
    if (s->box) include(e, s->box->low, s->box->low_count, 0);
    if (s->box) include(e, s->box->high, s->box->high_count, 0);
    if (s->disc) include(e, s->disc->centre, s->disc->centre_count, s->disc->radius);
    for (unsigned c = 0; s->polygon && c < s->polygon->corners_count; c++)
      include(e, s->polygon->corners[c], 2, 0);
  }
}

/* A large scene is filled coarsely: what is looked for is no want of memory or time. */
static double spacing_for(const struct file_scene *s, double asked)
{
  struct extent e = {DBL_MAX, -DBL_MAX};
  include_shapes(&e, s->fluid, s->fluid_count);
  include_shapes(&e, s->bodies, s->bodies_count);
  for (unsigned k = 0; k < s->walls_count; k++) {
    include(&e, s->walls[k].box->low, s->walls[k].box->low_count, 0);
    include(&e, s->walls[k].box->high, s->walls[k].box->high_count, 0);
  }
  const double side = e.high - e.low, shapes = s->fluid_count + s->walls_count + s->bodies_count;
  return side * side * shapes <= MOST_CELLS * asked * asked ? asked : fmax(side / COARSE, asked);
}

static void build(struct scene_file *file)
{
  struct scene scene;
  memset(&scene, 0, sizeof scene);
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&scene.common + scene_param_rows[k].offset) = scene_param_rows[k].initial;
  scene_file_defaults(file, &scene.common);
  scene.common.spacing = spacing_for(file->said, scene.common.spacing);
  scene.seed = 1;
  if (scene_file_build(file, &scene) == OK) {
    scene_apply_jitter(&scene);
    (void)scene_check(&scene);
  }
  scene_free(&scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct scene_file *file;
  if (scene_file_load(fuzz_file("scene.yaml", data, size), &file) != OK) return 0;
  build(file);
  scene_file_free(file);
  return 0;
}
