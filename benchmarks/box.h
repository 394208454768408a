/* box.h - water in a box of wall particles, open at the top: what dam-break and tank share. */
#ifndef BOX_H
#define BOX_H
#include "../core/benchmark.h"

/* All in m, from the corner at the origin; depths are not used in 2-D. */
struct box {
  double length, depth, height;      /* inside the walls */
  double water_length, water_height; /* at x = 0, over the whole depth */
};

/* The nearest whole number of particles. */
static inline double box_whole(double side, double dx) { return round(side / dx) * dx; }

/* Sides are made whole. The domain ends 2 dx behind the walls and three heights above them, for
 * splashes. */
static inline status box_fill(struct scene *scene, struct box *box)
{
  const double dx = scene->common.spacing;
  box->length = box_whole(box->length, dx);
  box->depth = box_whole(box->depth, dx);
  box->height = box_whole(box->height, dx);
  box->water_length = box_whole(box->water_length, dx);
  box->water_height = box_whole(box->water_height, dx);
  if (box->water_length > box->length || box->water_height > box->height)
    return user_error(
      "the water is %g m long and %g m high, allowed is at most its box, %g by %g m",
      box->water_length, box->water_height, box->length, box->height);
  TRY(scene_fill_box(scene, zero(), scene_at(box->water_length, box->depth, box->water_height),
                     zero(), NULL));
  TRY(scene_wall_box(scene, zero(), scene_at(box->length, box->depth, box->height),
                     scene_wall_layers(scene), 1));
  scene_domain_around(scene, 2 * dx);
  scene->high.c[DIM - 1] += (real)(3 * box->height);
  return OK;
}
#endif
