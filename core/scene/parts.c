/* What particles belong to: fluids, rigid bodies, emitters. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

/* Room for `n` numbers, those from *count on 0. */
static status extend(int **numbers, int *count, int n)
{
  int *more = realloc(*numbers, sizeof(int) * ((size_t)n + 1));
  if (!more) return status_set(ERR_MEMORY, "no memory for %d particles", n);
  for (int k = *count; k < n; k++) more[k] = 0;
  *numbers = more;
  *count = n;
  return OK;
}

/* --- fluids */

status scene_find_fluid(struct scene *scene, double rho0, double viscosity, int *number)
{
  if (scene->num_fluids == 0) {
    scene->fluid[0].rho0 = scene->common.rho0;
    scene->fluid[0].viscosity = scene->common.viscosity;
    scene->num_fluids = 1;
  }
  for (int k = 0; k < scene->num_fluids; k++)
    if (scene->fluid[k].rho0 == rho0 && scene->fluid[k].viscosity == viscosity) {
      *number = k;
      return OK;
    }
  if (scene->num_fluids == MOST_FLUIDS)
    return user_error("the scene has more than %d fluids, which is what is allowed", MOST_FLUIDS);
  *number = scene->num_fluids++;
  scene->fluid[*number].rho0 = rho0;
  scene->fluid[*number].viscosity = viscosity;
  return OK;
}

status scene_set_fluid(struct scene *scene, int first, int fluid)
{
  if (fluid == 0 && scene->num_fluid_of <= first) return OK;
  TRY(extend(&scene->fluid_of, &scene->num_fluid_of, scene->n));
  for (int k = first; k < scene->n; k++) scene->fluid_of[k] = fluid;
  return OK;
}

/* --- bodies */

static status add_body(struct scene *scene, int first, const struct scene_body *body)
{
  if (scene->num_bodies == MOST_BODIES)
    return user_error("the scene has more than %d bodies, which is what is allowed", MOST_BODIES);
  if (first == scene->n_wall) return user_error("a body has no particle");
  TRY(extend(&scene->body_of, &scene->num_body_of, scene->n_wall));
  scene->body[scene->num_bodies++] = *body;
  for (int k = first; k < scene->n_wall; k++) scene->body_of[k] = scene->num_bodies;
  return OK;
}

static vec mean_of(const vec *x, int n)
{
  vec centre;
  for (int d = 0; d < DIM; d++) {
    double sum = 0;
    for (int k = 0; k < n; k++) sum += (double)x[k].c[d];
    centre.c[d] = (real)(sum / n);
  }
  return centre;
}

status scene_make_body(struct scene *scene, int first, const struct scene_body *body)
{
  const int n = scene->n - first, first_wall = scene->n_wall;
  struct scene_body made = *body;
  if (n == 0) return user_error("a body has no particle");
  TRY(scene_reserve(scene, 0, n));
  if (made.density > 0) made.centre = mean_of(scene->x + first, n);
  for (int k = 0; k < n; k++) {
    const int wall = scene->n_wall++;
    scene->wall_x[wall] = scene->x[first + k];
    scene->wall_v[wall] = zero();
    scene->wall_n[wall] = zero();
  }
  scene->n = first;
  return add_body(scene, first_wall, &made);
}

status scene_move_walls(struct scene *scene, int first, const struct scene_body *motion)
{
  return add_body(scene, first, motion);
}

/* --- emitters */

status scene_add_emitter(struct scene *scene, const struct scene_emitter *emitter)
{
  const double half = scene->common.spacing / 2;
  const double length = sqrt((double)inner(emitter->direction, emitter->direction));
  if (scene->num_emitters == MOST_EMITTERS)
    return user_error("the scene has more than %d emitters, which is what is allowed",
                      MOST_EMITTERS);
  if (!(emitter->speed > 0))
    return user_error("an emitter has a speed of %g m/s, allowed is more than 0", emitter->speed);
  if (!(emitter->width >= half) || (DIM == 3 && !emitter->round && !(emitter->depth >= half)))
    return user_error("an emitter is %g m wide, allowed is half the spacing (%g m) or more",
                      emitter->width < half ? emitter->width : emitter->depth, half);
  if (!(length > 0)) return user_error("an emitter has no direction");
  struct scene_emitter *to = &scene->emitter[scene->num_emitters++];
  *to = *emitter;
  to->direction = times((real)(1 / length), emitter->direction);
  return OK;
}
