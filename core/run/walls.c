/* What wall particles weigh and where their normals point, where the scene has not said. */
#include <stdlib.h>
#include <string.h>

#include "../base/memory.h"
#include "../sph/lattice.h"
#include "run.h"

/* The walls alone, on the host, in cell order. */
struct walls {
  int n, *order;
  vec *x;
  struct grid grid;
  struct cell_set cells;
  struct pair_list list;
};

static status walls_make(struct walls *w, const struct run *run)
{
  const struct scene *s = &run->scene;
  const int offset[1] = {0};
  vec low, high;
  w->n = s->n_wall;
  w->order = malloc(sizeof(int) * ((size_t)w->n + 1));
  w->x = calloc((size_t)w->n + 1, sizeof(vec));
  if (!w->order || !w->x) return status_set(ERR_MEMORY, "no memory for the walls");
  positions_bounds(s->wall_x, w->n, &low, &high);
  for (int d = 0; d < DIM; d++)
    if (s->period.c[d] > 0) {
      low.c[d] = s->low.c[d];
      high.c[d] = s->low.c[d] + s->period.c[d];
    }
  TRY(grid_fit(&w->grid, low, high, s->period, run->view->nb.kernel.R, w->n));
  TRY(cell_sort(&w->cells, &w->grid, s->wall_x, w->n, w->order));
  permute(w->x, s->wall_x, w->order, w->n, sizeof(vec));
  w->cells.x = w->x;
  TRY(pairs_build(&w->list, &w->grid, &w->cells, 0, &w->cells, offset, 1));
  w->list.pairs.xi = w->list.pairs.xj = w->x;
  w->list.pairs.kernel = run->view->nb.kernel;
  return OK;
}

static void walls_drop(struct walls *w)
{
  free(w->order);
  free(w->x);
  cell_set_free(&w->cells);
  pair_list_free(&w->list);
}

/* A factor gamma on the volumes of a single layer, as in the tutorial of Koschier, Bender,
 * Solenthaler & Teschner 2019: such that a lattice at dx from a flat wall has the density rho0.
 *   gamma = L_0 (L_1 + L_2 + ..) / (L_1 (L_0 + 2 L_1 + 2 L_2 + ..)),   L_k = sum of W over layer k
 */
static double share_of_layer(const struct kernel *kernel, double dx)
{
  const double own = lattice_layer(kernel, dx, 0), beside = lattice_layer(kernel, dx, 1);
  double beyond = 0;
  for (int k = 1; k * dx < (double)kernel->R; k++) beyond += lattice_layer(kernel, dx, k);
  return beside > 0 ? own * beyond / (beside * (own + 2 * beyond)) : 1;
}

/* Akinci et al. 2012, Eq. (4)   m_b = rho0 gamma V_b,   V_b = 1 / sum_k W_bk over the walls */
static real weight_of(const struct walls *w, double rho0, int b)
{
  lanes number = NO_LANES;
  for_pairs (&w->list.pairs, b, bk) number += W(&w->list.pairs, bk);
  return (real)rho0 / sum(number);
}

/* Away from the other walls: -sum_k grad W_bk, made of length 1; 0 where they surround b. */
static vec normal_of(const struct walls *w, int b)
{
  const struct kernel k = w->list.pairs.kernel;
  vecs gradient = NO_VECS;
  for_pairs (&w->list.pairs, b, bk) gradient = add(gradient, gradW(&w->list.pairs, bk));
  const vec n = sum(gradient);
  const real length = sqrt(inner(n, n)), surrounded = (real)1e-3 * kernel_W(&k, 0, DIM) / k.R;
  return length > surrounded ? times(-1 / length, n) : zero();
}

static int is_zero(vec a) { return !(inner(a, a) > 0); }

static status fill(const struct run *run, struct walls *w)
{
  const struct scene *s = &run->scene;
  const int n = s->n;
  real *mass = malloc(sizeof(real) * ((size_t)w->n + 1));
  if (!mass) return status_set(ERR_MEMORY, "no memory for the walls");
  const double gamma = share_of_layer(&run->view->nb.kernel, s->common.spacing);
  for (int b = 0; b < w->n; b++) {
    const int wall = w->order[b];
    mass[wall] = weight_of(w, gamma * s->common.rho0, b);
    if (is_zero(s->wall_n[wall])) s->wall_n[wall] = normal_of(w, b);
  }
  const struct particles p = run->view->p;
  if (s->common.walls == WALLS_AKINCI && p.m)
    memory_from_host(p.m + n, mass, sizeof(real) * (size_t)w->n);
  if (p.normal) memory_from_host(p.normal + n, s->wall_n, sizeof(vec) * (size_t)w->n);
  free(mass);
  return OK;
}

status walls_weigh(struct run *run)
{
  const struct scene *s = &run->scene;
  struct walls w;
  int unknown = 0;
  for (int b = 0; b < s->n_wall; b++) unknown += is_zero(s->wall_n[b]);
  if (s->n_wall == 0 || (s->common.walls == WALLS_LATTICE && !unknown)) return OK;
  memset(&w, 0, sizeof w);
  status result = walls_make(&w, run);
  if (result == OK) result = fill(run, &w);
  walls_drop(&w);
  return result;
}
