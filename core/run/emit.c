/* Emitters: layers of new particles at an opening. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../base/memory.h"
#include "run.h"

/* Positions of one layer, on a lattice centred in the opening. */
struct layer {
  int n, room;
  vec *x;
};

/* Two directions across the opening, at right angles; in 2-D there is one. */
static void across(vec along, vec side[2])
{
  side[0] = side[1] = zero();
  if (DIM == 2) {
    side[0].c[0] = -along.c[1];
    side[0].c[1] = along.c[0];
    return;
  }
  int least = 0;
  for (int d = 1; d < DIM; d++)
    if (fabs(along.c[d]) < fabs(along.c[least])) least = d;
  side[0].c[least] = 1;
  side[0] = madd(side[0], -inner(side[0], along), along);
  side[0] = times(1 / sqrt(inner(side[0], side[0])), side[0]);
  for (int d = 0; d < DIM; d++) {
    const int a = (d + 1) % DIM, b = (d + 2) % DIM;
    side[1].c[d] = along.c[a] * side[0].c[b] - along.c[b] * side[0].c[a];
  }
}

static status layer_make(struct layer *layer, const struct scene_emitter *e, double dx, vec centre)
{
  vec side[2];
  across(e->direction, side);
  const double depth = DIM == 2 ? dx : e->round ? e->width : e->depth;
  const int na = (int)fmax(1, rint(e->width / dx)), nb = (int)fmax(1, rint(depth / dx));
  layer->x = malloc(sizeof(vec) * ((size_t)na * (size_t)nb + 1));
  layer->n = 0;
  if (!layer->x) return status_set(ERR_MEMORY, "no memory for %d new particles", na * nb);
  for (int a = 0; a < na; a++)
    for (int b = 0; b < nb; b++) {
      const double u = (a + 0.5 - 0.5 * na) * dx, v = (b + 0.5 - 0.5 * nb) * dx;
      if (DIM == 3 && e->round && u * u + v * v > 0.25 * e->width * e->width) continue;
      layer->x[layer->n++] = madd(madd(centre, (real)u, side[0]), (real)v, side[1]);
    }
  return OK;
}

/* One value, `times` times, into [at, at + n) of a field that may not exist. */
static void put(struct run *run, const char *name, int at, int n, const void *value)
{
  struct store_field *f = store_public(&run->store, name);
  for (int k = 0; f && k < n; k++)
    memory_from_host((char *)f->data + f->row.bytes * (size_t)(at + k), value, f->row.bytes);
}

static status add_layer(struct run *run, const struct scene_emitter *e, const struct layer *layer)
{
  struct view *s = run->view;
  const int n = s->p.n, k = layer->n;
  const double rho0 = run->scene.common.rho0;
  const struct scene_fluid *fluid = run->scene.num_fluids ? &run->scene.fluid[e->fluid] : NULL;
  const real light = (real)(fluid ? rho0 / fluid->rho0 : 1);
  const real mu = (real)(fluid ? fluid->viscosity : run->scene.common.viscosity);
  const vec velocity = times((real)e->speed, e->direction);
  if ((double)n + k > 1e9) return status_set(ERR_MEMORY, "more than 1e9 particles");
  TRY(store_insert_fluid(&run->store, k));
  s->p.n += k;
  s->p.n_all += k;
  memory_from_host(s->p.x + n, layer->x, sizeof(vec) * (size_t)k);
  put(run, "v", n, k, &velocity);
  put(run, "m", n, k, &s->mass);
  put(run, "light", n, k, &light);
  put(run, "mu", n, k, &mu);
  put(run, "fluid", n, k, &e->fluid);
  for (int j = 0; j < k; j++, run->num_labels++) put(run, "id", n + j, 1, &run->num_labels);
  return OK;
}

/* The layers of emitter `number` that are due by now, each as far from the opening as it has come
 * since. */
static status emit(struct run *run, int number, int *some)
{
  const struct scene_emitter *e = &run->scene.emitter[number];
  const double dx = run->scene.common.spacing, eps = 1e-9 * run->dt;
  for (;; run->layers[number]++) {
    const double due = e->begin + (double)run->layers[number] * dx / e->speed;
    if (due > run->time + eps || due > e->end + eps) return OK;
    struct layer layer;
    const double way = (run->time - due) * e->speed;
    status result = layer_make(&layer, e, dx, madd(e->centre, (real)way, e->direction));
    if (result == OK) result = add_layer(run, e, &layer);
    free(layer.x);
    if (result != OK) return result;
    *some = 1;
  }
}

status run_emit(struct run *run)
{
  int some = 0;
  for (int k = 0; k < run->scene.num_emitters; k++) TRY(emit(run, k, &some));
  if (!some) return OK;
  TRY(run_neighbours(run));
  return run->solver->changed ? run->solver->changed(run, run->state) : OK;
}
