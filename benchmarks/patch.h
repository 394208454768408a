/* patch.h - the square of fluid that rotating-patch and first-step share: filled symmetrically
 * about the origin. */
#ifndef PATCH_H
#define PATCH_H
#include "../core/benchmark.h"

/* The side that whole particles fill [m]: the truths are for this square. */
static inline double patch_side(double side, double dx) { return round(side / dx) * dx; }

/* v = omega (y, -x) + growth (x, y). */
static inline status patch_fill(struct scene *scene, double side, double omega, double growth)
{
  const double half = patch_side(side, scene->common.spacing) / 2;
  TRY(
    scene_fill_box(scene, scene_at(-half, -half, -half), scene_at(half, half, half), zero(), NULL));
  for (int i = 0; i < scene->n; i++) {
    const double x = (double)scene->x[i].c[0], y = (double)scene->x[i].c[1];
    scene->v[i].c[0] = (real)(omega * y + growth * x);
    scene->v[i].c[1] = (real)(growth * y - omega * x);
  }
  return OK;
}
#endif
