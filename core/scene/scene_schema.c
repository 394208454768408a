#include "scene_schema.h"

#include <cyaml/cyaml.h>

enum { MOST_SHAPES = 10000, MOST_CORNERS = 100000, MOST_LETTERS = 2000 };
#define LEFT_OUT (CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL)

static const cyaml_schema_value_t number = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, double)};

/* a vector; two to three numbers, of which scene_file.c demands as many as dimensions */
#define VECTOR(key, flags, structure) \
  CYAML_FIELD_SEQUENCE(#key, flags, structure, key, &number, 2, 3)

static const cyaml_schema_field_t box_fields[] = {
  VECTOR(low, CYAML_FLAG_POINTER, struct file_box),
  VECTOR(high, CYAML_FLAG_POINTER, struct file_box),
  CYAML_FIELD_END,
};

static const cyaml_schema_field_t ball_fields[] = {
  VECTOR(centre, CYAML_FLAG_POINTER, struct file_ball),
  CYAML_FIELD_FLOAT("radius", CYAML_FLAG_DEFAULT, struct file_ball, radius),
  CYAML_FIELD_END,
};

static const cyaml_schema_value_t corner = {
  CYAML_VALUE_SEQUENCE_FIXED(CYAML_FLAG_DEFAULT, double, &number, 2),
};
static const cyaml_schema_field_t polygon_fields[] = {
  CYAML_FIELD_SEQUENCE("corners", CYAML_FLAG_POINTER, struct file_polygon, corners, &corner, 3,
                       MOST_CORNERS),
  CYAML_FIELD_SEQUENCE("z", LEFT_OUT, struct file_polygon, z, &number, 2, 2),
  CYAML_FIELD_END,
};

static const cyaml_schema_field_t rotation_fields[] = {
  VECTOR(centre, CYAML_FLAG_POINTER, struct file_rotation),
  CYAML_FIELD_FLOAT("omega", CYAML_FLAG_DEFAULT, struct file_rotation, omega),
  CYAML_FIELD_END,
};

static const cyaml_schema_field_t motion_fields[] = {
  VECTOR(velocity, LEFT_OUT, struct file_motion),
  CYAML_FIELD_SEQUENCE("spin", LEFT_OUT, struct file_motion, spin, &number, 1, 3),
  VECTOR(centre, LEFT_OUT, struct file_motion),
  CYAML_FIELD_FLOAT_PTR("period", LEFT_OUT, struct file_motion, period),
  CYAML_FIELD_END,
};

#define SHAPES                                                                                \
  CYAML_FIELD_MAPPING_PTR("box", LEFT_OUT, struct file_shape, box, box_fields),               \
    CYAML_FIELD_MAPPING_PTR("disc", LEFT_OUT, struct file_shape, disc, ball_fields),          \
    CYAML_FIELD_MAPPING_PTR("ball", LEFT_OUT, struct file_shape, ball, ball_fields),          \
    CYAML_FIELD_MAPPING_PTR("polygon", LEFT_OUT, struct file_shape, polygon, polygon_fields), \
    VECTOR(particle, LEFT_OUT, struct file_shape)

static const cyaml_schema_field_t fluid_fields[] = {
  SHAPES,
  VECTOR(velocity, LEFT_OUT, struct file_shape),
  CYAML_FIELD_MAPPING_PTR("rotation", LEFT_OUT, struct file_shape, rotation, rotation_fields),
  CYAML_FIELD_FLOAT_PTR("rho0", LEFT_OUT, struct file_shape, rho0),
  CYAML_FIELD_FLOAT_PTR("viscosity", LEFT_OUT, struct file_shape, viscosity),
  CYAML_FIELD_END,
};
static const cyaml_schema_value_t fluid = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_shape, fluid_fields),
};

static const cyaml_schema_field_t body_fields[] = {
  SHAPES,
  CYAML_FIELD_FLOAT_PTR("density", LEFT_OUT, struct file_shape, density),
  CYAML_FIELD_MAPPING_PTR("motion", LEFT_OUT, struct file_shape, motion, motion_fields),
  CYAML_FIELD_END,
};
static const cyaml_schema_value_t body = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_shape, body_fields),
};

static const cyaml_schema_field_t emitter_fields[] = {
  VECTOR(centre, CYAML_FLAG_POINTER, struct file_emitter),
  VECTOR(direction, CYAML_FLAG_POINTER, struct file_emitter),
  CYAML_FIELD_FLOAT("width", CYAML_FLAG_DEFAULT, struct file_emitter, width),
  CYAML_FIELD_FLOAT_PTR("depth", LEFT_OUT, struct file_emitter, depth),
  CYAML_FIELD_BOOL_PTR("round", LEFT_OUT, struct file_emitter, round),
  CYAML_FIELD_FLOAT("speed", CYAML_FLAG_DEFAULT, struct file_emitter, speed),
  CYAML_FIELD_FLOAT_PTR("begin", LEFT_OUT, struct file_emitter, begin),
  CYAML_FIELD_FLOAT_PTR("end", LEFT_OUT, struct file_emitter, end),
  CYAML_FIELD_FLOAT_PTR("rho0", LEFT_OUT, struct file_emitter, rho0),
  CYAML_FIELD_FLOAT_PTR("viscosity", LEFT_OUT, struct file_emitter, viscosity),
  CYAML_FIELD_END,
};
static const cyaml_schema_value_t emitter = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_emitter, emitter_fields),
};

static const cyaml_schema_field_t wall_box_fields[] = {
  VECTOR(low, CYAML_FLAG_POINTER, struct file_wall_box),
  VECTOR(high, CYAML_FLAG_POINTER, struct file_wall_box),
  CYAML_FIELD_INT_PTR("layers", LEFT_OUT, struct file_wall_box, layers),
  CYAML_FIELD_BOOL_PTR("open_top", LEFT_OUT, struct file_wall_box, open_top),
  CYAML_FIELD_END,
};
static const cyaml_schema_field_t wall_fields[] = {
  CYAML_FIELD_MAPPING_PTR("box", CYAML_FLAG_POINTER, struct file_wall, box, wall_box_fields),
  CYAML_FIELD_MAPPING_PTR("motion", LEFT_OUT, struct file_wall, motion, motion_fields),
  CYAML_FIELD_END,
};
static const cyaml_schema_value_t wall = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct file_wall, wall_fields),
};

static const cyaml_schema_field_t domain_fields[] = {
  VECTOR(low, CYAML_FLAG_POINTER, struct file_domain),
  VECTOR(high, CYAML_FLAG_POINTER, struct file_domain),
  VECTOR(period, LEFT_OUT, struct file_domain),
  CYAML_FIELD_END,
};

/* numbers and words alike: param_parse reads them */
#define P(name, initial, low, high, unit, meaning) \
  CYAML_FIELD_STRING_PTR(#name, LEFT_OUT, struct file_params, name, 1, 64),
static const cyaml_schema_field_t params_fields[] = {SCENE_PARAMS(P) CYAML_FIELD_END};
#undef P

static const cyaml_schema_field_t scene_fields[] = {
  CYAML_FIELD_STRING_PTR("name", LEFT_OUT, struct file_scene, name, 1, MOST_LETTERS),
  CYAML_FIELD_STRING_PTR("about", LEFT_OUT, struct file_scene, about, 1, MOST_LETTERS),
  CYAML_FIELD_STRING_PTR("source", LEFT_OUT, struct file_scene, source, 1, MOST_LETTERS),
  CYAML_FIELD_INT("dim", CYAML_FLAG_DEFAULT, struct file_scene, dim),
  CYAML_FIELD_MAPPING_PTR("params", LEFT_OUT, struct file_scene, params, params_fields),
  VECTOR(gravity, LEFT_OUT, struct file_scene),
  CYAML_FIELD_MAPPING_PTR("domain", LEFT_OUT, struct file_scene, domain, domain_fields),
  CYAML_FIELD_SEQUENCE("fluid", CYAML_FLAG_POINTER, struct file_scene, fluid, &fluid, 1,
                       MOST_SHAPES),
  CYAML_FIELD_SEQUENCE("walls", LEFT_OUT, struct file_scene, walls, &wall, 1, MOST_SHAPES),
  CYAML_FIELD_SEQUENCE("bodies", LEFT_OUT, struct file_scene, bodies, &body, 1, MOST_BODIES),
  CYAML_FIELD_SEQUENCE("emitters", LEFT_OUT, struct file_scene, emitters, &emitter, 1,
                       MOST_EMITTERS),
  CYAML_FIELD_END,
};
static const cyaml_schema_value_t schema = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct file_scene, scene_fields),
};
const struct cyaml_schema_value *const scene_schema = &schema;
