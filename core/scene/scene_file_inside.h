/* scene_file_inside.h - a scene file between reading and building. */
#ifndef SCENE_FILE_INSIDE_H
#define SCENE_FILE_INSIDE_H
#include <math.h>
#include <stdio.h>

#include "../base/yaml_source.h"
#include "scene_schema.h"

struct scene_file {
  struct yaml_source *yaml;
  struct file_scene *said;
  char *name;
  struct scene_params values; /* of the params that the file gives */
  unsigned given;             /* bit k: row k of scene_param_rows */
};

enum { KEY_ROOM = 96 };

/* "fluid[3].box" and the like */
static inline void key_of(char key[KEY_ROOM], const char *list, unsigned k, const char *rest)
{
  snprintf(key, KEY_ROOM, "%s[%u]%s", list, k + 1, rest);
}

static inline double length_of(const double *a, unsigned n)
{
  double sum = 0;
  for (unsigned d = 0; d < n; d++) sum += a[d] * a[d];
  return sqrt(sum);
}
#endif
