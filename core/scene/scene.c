#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "scene.h"

#include <Random123/philox.h>
#include <float.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "places.h"

#define ROW(name, initial, low, high, unit, meaning) \
  {#name, initial, low, high, unit, meaning, offsetof(struct scene_params, name)},
const struct param scene_param_rows[] = {SCENE_PARAMS(ROW)};
const int num_scene_params = COUNT(scene_param_rows);

/* --- memory --- */

static int memory_suffices(double bytes)
{
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  return pages <= 0 || page <= 0 || bytes < 0.8 * (double)pages * (double)page;
}

static status grow(vec **array, int capacity)
{
  vec *larger = realloc(*array, (size_t)capacity * sizeof **array);
  if (!larger) return status_set(ERR_MEMORY, "no memory for %d particles", capacity);
  *array = larger;
  return OK;
}

/* The capacity that holds n + more particles: at least half as much again as now. */
static status new_capacity(double wanted, int now, int *capacity)
{
  const double most = 1e9, eased = 1.5 * now + 64;
  if (!(wanted <= most))
    return user_error("the scene would have %.3g particles, allowed are at most %.0e", wanted,
                      most);
  *capacity = now;
  if (wanted <= now) return OK;
  *capacity = (int)(wanted > eased ? wanted : eased < most ? eased : most);
  if (!memory_suffices(*capacity * 4.0 * sizeof(vec)))
    return status_set(ERR_MEMORY, "no memory for %d particles", *capacity);
  return OK;
}

status scene_reserve(struct scene *scene, double fluid, double walls)
{
  int capacity;
  TRY(new_capacity(scene->n + fluid, scene->capacity, &capacity));
  if (capacity > scene->capacity) {
    TRY(grow(&scene->x, capacity));
    TRY(grow(&scene->v, capacity));
    scene->capacity = capacity;
  }
  TRY(new_capacity(scene->n_wall + walls, scene->wall_capacity, &capacity));
  if (capacity > scene->wall_capacity) {
    TRY(grow(&scene->wall_x, capacity));
    TRY(grow(&scene->wall_v, capacity));
    TRY(grow(&scene->wall_n, capacity));
    scene->wall_capacity = capacity;
  }
  return OK;
}

status scene_add(struct scene *scene, vec x, vec velocity)
{
  TRY(scene_reserve(scene, 1, 0));
  scene->x[scene->n] = x;
  scene->v[scene->n++] = velocity;
  return OK;
}

void scene_free(struct scene *scene)
{
  free(scene->x);
  free(scene->v);
  free(scene->wall_x);
  free(scene->wall_v);
  free(scene->wall_n);
  free(scene->fluid_of);
  free(scene->body_of);
  scene->fluid_of = scene->body_of = NULL;
  scene->num_fluid_of = scene->num_body_of = 0;
  scene->x = scene->v = scene->wall_x = scene->wall_v = scene->wall_n = NULL;
  scene->n = scene->n_wall = scene->capacity = scene->wall_capacity = 0;
}

/* --- after the shapes --- */

int scene_wall_layers(const struct scene *scene)
{
  if (scene->common.walls == WALLS_AKINCI) return 1;
  return (int)ceil(scene->common.support - 1e-9) + 1;
}

/* Philox 4x32 (Salmon et al. 2011): the counter is the particle's number, the key is the seed. */
void scene_apply_jitter(struct scene *scene)
{
  const double reach = scene->common.jitter * scene->common.spacing;
  if (!(reach > 0) || scene->jittered) return;
  scene->jittered = 1;
  const philox4x32_key_t key = {
    {(uint32_t)(scene->seed & 0xFFFFFFFFu), (uint32_t)(scene->seed >> 32)}};
  for (int i = 0; i < scene->n; i++) {
    const philox4x32_ctr_t counter = {{(uint32_t)i, 0, 0, 0}};
    const philox4x32_ctr_t bits = philox4x32(counter, key);
    for (int d = 0; d < DIM; d++) {
      const double uniform = (bits.v[d] + 0.5) / 4294967296.0;
      scene->x[i].c[d] = (real)((double)scene->x[i].c[d] + reach * (2 * uniform - 1));
    }
  }
}

static void bounds_include(const vec *x, int n, double low[DIM], double high[DIM])
{
  for (int i = 0; i < n; i++)
    for (int d = 0; d < DIM; d++) {
      const double at = (double)x[i].c[d];
      if (at < low[d]) low[d] = at;
      if (at > high[d]) high[d] = at;
    }
}

void scene_domain_around(struct scene *scene, double margin)
{
  double low[DIM], high[DIM];
  for (int d = 0; d < DIM; d++) {
    low[d] = DBL_MAX;
    high[d] = -DBL_MAX;
  }
  bounds_include(scene->x, scene->n, low, high);
  bounds_include(scene->wall_x, scene->n_wall, low, high);
  for (int d = 0; d < DIM; d++) {
    const int some = low[d] <= high[d];
    scene->low.c[d] = (real)(some ? low[d] - margin : -margin);
    scene->high.c[d] = (real)(some ? high[d] + margin : margin);
  }
}

/* --- the user's errors --- */

static char *point_text(vec x, char *buf, size_t size)
{
  size_t used = (size_t)snprintf(buf, size, "(");
  for (int d = 0; d < DIM && used < size; d++)
    used += (size_t)snprintf(buf + used, size - used, "%s%.6g", d ? ", " : "", (double)x.c[d]);
  if (used < size) snprintf(buf + used, size - used, ") m");
  return buf;
}

static status check_finite(const vec *x, int n, const char *kind)
{
  char at[96];
  for (int i = 0; i < n; i++)
    for (int d = 0; d < DIM; d++)
      if (!isfinite(x[i].c[d]))
        return user_error("%s particle %d is at %s, allowed are finite positions", kind, i,
                          point_text(x[i], at, sizeof at));
  return OK;
}

static status check_velocities(const struct scene *scene)
{
  for (int i = 0; i < scene->n; i++)
    for (int d = 0; d < DIM; d++)
      if (!isfinite(scene->v[i].c[d]))
        return user_error("fluid particle %d moves at %g m/s on axis %d, allowed are finite speeds",
                          i, (double)scene->v[i].c[d], d + 1);
  return OK;
}

static status check_inside(const struct scene *scene)
{
  char at[96], low[96], high[96];
  for (int i = 0; i < scene->n; i++)
    for (int d = 0; d < DIM; d++) {
      const real x = scene->x[i].c[d];
      if (scene->period.c[d] > 0 || (x >= scene->low.c[d] && x <= scene->high.c[d])) continue;
      return user_error("fluid particle %d at %s is outside the domain, which is %s to %s", i,
                        point_text(scene->x[i], at, sizeof at),
                        point_text(scene->low, low, sizeof low),
                        point_text(scene->high, high, sizeof high));
    }
  return OK;
}

/* Nearer than this are two particles that differ by rounding, at most dx: of its own coordinates,
 * so that one far away does not blur the others. */
static double blur(vec x, double dx)
{
  const double unit = sizeof(real) == sizeof(float) ? (double)FLT_EPSILON : DBL_EPSILON;
  double most = 0;
  for (int d = 0; d < DIM; d++) most = fmax(most, fabs((double)x.c[d]));
  return fmin(fmax(1e-6 * dx, 4 * unit * most), dx);
}

static status coincidence(const struct scene *scene, const vec *x, int i, int j)
{
  char at[96], one[48], other[48];
  const int n = scene->n;
  snprintf(one, sizeof one, "%s particle %d", i < n ? "fluid" : "wall", i < n ? i : i - n);
  snprintf(other, sizeof other, "%s particle %d", j < n ? "fluid" : "wall", j < n ? j : j - n);
  return user_error("%s and %s are both at %s: shapes overlap", one, other,
                    point_text(x[i], at, sizeof at));
}

static status check_apart(const struct scene *scene, vec *x)
{
  const int n = scene->n, all = n + scene->n_wall;
  if (n > 0) memcpy(x, scene->x, (size_t)n * sizeof *x);
  if (all > n) memcpy(x + n, scene->wall_x, (size_t)(all - n) * sizeof *x);
  const double dx = scene->common.spacing;
  struct places places;
  TRY(places_make(&places, x, all, dx, scene->period));
  int i = 0, other = -1;
  for (; i < all; i++)
    if ((other = places_nearest(&places, x[i], blur(x[i], dx), i, NULL)) >= 0) break;
  places_free(&places);
  return other < 0 ? OK : coincidence(scene, x, i, other);
}

status scene_check(const struct scene *scene)
{
  if (scene->n == 0) return user_error("the scene has no fluid particle");
  if ((double)scene->n + scene->n_wall > INT_MAX / 2)
    return user_error("the scene has %.3g particles, allowed are at most %d",
                      (double)scene->n + scene->n_wall, INT_MAX / 2);
  TRY(check_finite(scene->x, scene->n, "fluid"));
  TRY(check_finite(scene->wall_x, scene->n_wall, "wall"));
  TRY(check_velocities(scene));
  TRY(check_inside(scene));
  vec *x = malloc(((size_t)scene->n + (size_t)scene->n_wall) * sizeof *x);
  if (!x) return status_set(ERR_MEMORY, "no memory to check %d particles", scene->n);
  const status checked = check_apart(scene, x);
  free(x);
  return checked;
}
