/* scene_schema.h - a scene file as libcyaml reads it. A vector is a list of as many numbers as the
 * scene has dimensions; what may be left out is a pointer. */
#ifndef SCENE_SCHEMA_H
#define SCENE_SCHEMA_H
#include <stdbool.h>

#include "scene.h"

struct file_box {
  double *low, *high;
  unsigned low_count, high_count;
};
struct file_ball {
  double *centre, radius;
  unsigned centre_count;
};
struct file_polygon {
  double (*corners)[2], *z; /* z: low and high, in 3-D */
  unsigned corners_count, z_count;
};
struct file_rotation {
  double *centre, omega; /* rad/s, anticlockwise in the plane of the first two axes */
  unsigned centre_count;
};
/* Of walls and bodies: prescribed, or at the start. spin: one number in 2-D, three in 3-D [rad/s]
 */
struct file_motion {
  double *velocity, *spin, *centre, *period;
  unsigned velocity_count, spin_count, centre_count;
};
struct file_shape { /* of fluid and of bodies */
  struct file_box *box;
  struct file_ball *disc, *ball;
  struct file_polygon *polygon;
  double *particle; /* the place of one */
  double *velocity;
  unsigned particle_count, velocity_count;
  struct file_rotation *rotation;
  double *rho0, *viscosity;   /* of a fluid of its own */
  double *density;            /* of a free body */
  struct file_motion *motion; /* of a body */
};
struct file_emitter {
  double *centre, *direction, width, *depth, speed, *begin, *end, *rho0, *viscosity;
  unsigned centre_count, direction_count;
  bool *round;
};
struct file_wall_box {
  double *low, *high;
  unsigned low_count, high_count;
  int *layers;
  bool *open_top;
};
struct file_wall {
  struct file_wall_box *box;
  struct file_motion *motion;
};
struct file_domain {
  double *low, *high, *period;
  unsigned low_count, high_count, period_count;
};
struct file_params { /* as text */
#define P(name, initial, low, high, unit, meaning) char *name;
  SCENE_PARAMS(P)
#undef P
};
struct file_scene {
  char *name, *about, *source;
  int dim;
  struct file_params *params;
  double *gravity;
  unsigned gravity_count;
  struct file_domain *domain;
  struct file_shape *fluid;
  unsigned fluid_count;
  struct file_wall *walls;
  unsigned walls_count;
  struct file_shape *bodies;
  unsigned bodies_count;
  struct file_emitter *emitters;
  unsigned emitters_count;
};

struct cyaml_schema_value;
extern const struct cyaml_schema_value *const scene_schema; /* of a struct file_scene */
#endif
