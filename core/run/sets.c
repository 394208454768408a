/* Sorting and pair lists on a run's sets of particles. */
#include <math.h>
#include <string.h>

#include "../base/memory.h"
#include "run.h"

static status reserve_order(struct run *run, int n)
{
  if (n <= run->order_capacity) return OK;
  const int room = n + n / 4;
  memory_give(run->order, sizeof(int) * (size_t)run->order_capacity);
  run->order = memory_take(sizeof(int) * (size_t)room);
  run->order_capacity = run->order ? room : 0;
  return run->order ? OK : status_set(ERR_MEMORY, "no memory to sort %d particles", n);
}

/* The grid's corner and size are whole multiples of the support, so that it depends on where the
 * particles are, not on where they were: a restarted run sees the same cells. */
static void snap(vec *low, vec *high, real cell)
{
  for (int d = 0; d < DIM; d++) {
    low->c[d] = cell * floor(low->c[d] / cell);
    high->c[d] = cell * (floor(high->c[d] / cell) + 1);
  }
}

static status fit_grid(struct run *run, struct grid *grid)
{
  struct view *s = run->view;
  vec low, high;
  particle_search.positions_bounds(s->p.x, s->p.n, &low, &high);
  if (s->p.n_all > s->p.n)
    for (int d = 0; d < DIM; d++) {
      low.c[d] = smaller(low.c[d], run->wall_low.c[d]);
      high.c[d] = larger(high.c[d], run->wall_high.c[d]);
    }
  snap(&low, &high, s->nb.kernel.R);
  for (int d = 0; d < DIM; d++)
    if (run->scene.period.c[d] > 0) {
      low.c[d] = run->scene.low.c[d];
      high.c[d] = run->scene.low.c[d] + run->scene.period.c[d];
    }
  return grid_fit(grid, low, high, run->scene.period, s->nb.kernel.R, s->p.n_all);
}

static int same_grid(const struct grid *a, const struct grid *b)
{
  for (int d = 0; d < DIM; d++)
    if (a->low.c[d] != b->low.c[d] || a->cells[d] != b->cells[d] ||
        a->inv_side.c[d] != b->inv_side.c[d])
      return 0;
  return a->wraps == b->wraps;
}

/* Walls are sorted when the grid changes, not in every step. */
static status sort_walls(struct run *run)
{
  const int n = run->view->p.n, n_wall = run->view->p.n_all - n;
  TRY(reserve_order(run, n_wall));
  TRY(particle_search.cell_sort(&run->wall_cells, &run->view->grid, run->view->p.x + n, n_wall,
                                run->order));
  TRY(store_permute(&run->store, 1u << ALL | 1u << WALL, run->order, n, n_wall));
  return OK;
}

static status sort_fluid(struct run *run)
{
  const int n = run->view->p.n;
  TRY(reserve_order(run, n));
  TRY(
    particle_search.cell_sort(&run->fluid_cells, &run->view->grid, run->view->p.x, n, run->order));
  TRY(store_permute(&run->store, 1u << FLUID | 1u << ALL, run->order, 0, n));
  run->view->cells = run->fluid_cells.first;
  return OK;
}

/* The sets that a list may pair with, as the positions are now. */
static int gather(struct run *run, enum pair_set set, struct cell_set to[2], int offset[2],
                  const vec **x)
{
  struct view *s = run->view;
  run->fluid_cells.x = s->p.x;
  run->wall_cells.x = s->p.x + s->p.n;
  offset[0] = 0;
  offset[1] = s->p.n;
  *x = s->p.x;
  if (set == SET_VIRTUAL) {
    to[0] = run->virtual_cells;
    *x = run->virtual_cells.x;
    return 1;
  }
  to[0] = run->fluid_cells;
  to[1] = run->wall_cells;
  return set == SET_ALL && s->p.n_all > s->p.n ? 2 : 1;
}

static status build_list(struct run *run, struct pair_list *list, enum pair_set from_set,
                         enum pair_set to_set, struct pairs *out)
{
  struct cell_set from[2], to[2];
  int offset[2], unused[2];
  const vec *xi, *xj;
  const int num_from = gather(run, from_set, from, unused, &xi);
  const int num_to = gather(run, to_set, to, offset, &xj);
  const enum phase before = clock_enter(PHASE_NEIGHBOURS);
  status result = OK;
  for (int k = 0; k < num_from && result == OK; k++)
    result =
      particle_search.pairs_build(list, &run->view->grid, &from[k], unused[k], to, offset, num_to);
  clock_enter(before);
  list->pairs.kernel = run->view->nb.kernel;
  list->pairs.xi = xi;
  list->pairs.xj = xj;
  if (result == OK) result = visits_renew(run, list);
  *out = list->pairs;
  return result;
}

status run_remember_listed(struct run *run)
{
  const int all = run->view->p.n_all;
  if (all > run->listed_room) {
    memory_give(run->listed, sizeof(vec) * (size_t)run->listed_room);
    run->listed_room = all + all / 4;
    run->listed = (vec *)memory_take(sizeof(vec) * (size_t)run->listed_room);
    if (!run->listed) run->listed_room = 0;
  }
  if (!run->listed) return status_set(ERR_MEMORY, "no memory for %d positions", all);
  memory_copy(run->listed, run->view->p.x, sizeof(vec) * (size_t)all);
  return OK;
}

static status list_neighbours(struct run *run)
{
  struct view *s = run->view;
  struct grid grid;
  if (run->body)
    particle_search.positions_bounds(s->p.x + s->p.n, s->p.n_all - s->p.n, &run->wall_low,
                                     &run->wall_high);
  status result = fit_grid(run, &grid);
  const int grid_changed = !run->have_grid || !same_grid(&grid, &s->grid);
  s->grid = grid;
  run->have_grid = 1;
  run->has_wall_rows = 0;
  run->density_is_current = 0;
  if (result == OK && (grid_changed || run->body) && s->p.n_all > s->p.n) result = sort_walls(run);
  if (result == OK) result = sort_fluid(run);
  if (result == OK) result = build_list(run, &run->neighbours, SET_FLUID, SET_ALL, &s->nb);
  if (result == OK && run->keeps_listed) result = run_remember_listed(run);
  return result;
}

status run_neighbours(struct run *run)
{
  const enum phase before = clock_enter(PHASE_NEIGHBOURS);
  if (scene_asks(&run->scene) & CAN(PERIODIC))
    physics_wrap(run->view, run->scene.low, run->scene.period);
  const status result = list_neighbours(run);
  clock_enter(before);
  return result;
}

status run_list_again(struct run *run)
{
  run->have_grid = 0; /* the walls are sorted too, or their cells would be those of the start */
  return list_neighbours(run);
}

status run_wall_rows(struct run *run)
{
  if (run->has_wall_rows || run->view->p.n_all == run->view->p.n) return OK;
  run->has_wall_rows = 1;
  return build_list(run, &run->neighbours, SET_ALL, SET_ALL, &run->view->nb);
}

status run_virtual(struct run *run, int n)
{
  TRY(store_resize_virtual(&run->store, n));
  run->virtual_cells.n = n;
  return OK;
}

status run_sort_virtual(struct run *run)
{
  const int n = run->store.count[VIRTUAL];
  const enum phase before = clock_enter(PHASE_NEIGHBOURS);
  status result = reserve_order(run, n);
  if (result == OK)
    result = particle_search.cell_sort(&run->virtual_cells, &run->view->grid,
                                       store_find(&run->store, "X")->data, n, run->order);
  if (result == OK) result = store_permute(&run->store, 1u << VIRTUAL, run->order, 0, n);
  run->virtual_cells.x = store_find(&run->store, "X")->data;
  clock_enter(before);
  return result;
}

status run_pairs(struct run *run, int slot, enum pair_set from, enum pair_set to,
                 struct pairs *list)
{
  return build_list(run, &run->list[slot], from, to, list);
}

real *run_coefficients(struct run *run, int slot, int num_slots)
{
  const size_t wanted = sizeof(real) * (size_t)(num_slots + LANES);
  if (wanted > run->coefficients[slot].capacity) {
    memory_give(run->coefficients[slot].data, run->coefficients[slot].capacity);
    run->coefficients[slot].capacity = wanted + wanted / 8;
    run->coefficients[slot].data = memory_take(run->coefficients[slot].capacity);
    if (!run->coefficients[slot].data) run->coefficients[slot].capacity = 0;
  }
  return run->coefficients[slot].data;
}

unsigned long long *run_keys(struct run *run, int n)
{
  if (n > run->keys_capacity) {
    memory_give(run->keys, sizeof *run->keys * (size_t)run->keys_capacity);
    run->keys_capacity = n + n / 4;
    run->keys = memory_take(sizeof *run->keys * (size_t)run->keys_capacity);
    if (!run->keys) run->keys_capacity = 0;
  }
  return run->keys;
}

int run_unique_keys(struct run *run, unsigned long long *keys, int n)
{
  (void)run;
  const enum phase before = clock_enter(PHASE_NEIGHBOURS);
  const int left = particle_search.keys_unique(keys, n);
  clock_enter(before);
  return left;
}

status run_move(struct run *run)
{
  const enum phase before = clock_enter(PHASE_INTEGRATE);
  physics_move(run->view);
  bodies_move(run, (double)run->view->dt);
  clock_enter(before);
  return OK;
}

status run_density(struct run *run)
{
  if (!run->density_is_current) physics_density(run->view);
  run->density_is_current = 1;
  return OK;
}

/* (I - dt/rho mu lap) v = v* */
static status solve_viscosity(struct run *run, struct viscosity viscosity)
{
  const int most = 10000;
  real *coef = run_coefficients(run, MAX_PAIR_LISTS, run->view->nb.slots);
  if (!coef) return status_set(ERR_MEMORY, "no memory for the coefficients of viscosity");
  const struct cg_result result =
    viscosity_implicit(run->view, viscosity, coef, run->scene.common.viscosity_tolerance, most);
  if (!(result.residual >= 0)) return run_diverged(run, "the viscous solve is not a number");
  run_iterations(run, "viscosity", result.iterations, result.residual, result.converged);
  return OK;
}

static status apply_viscosity(struct run *run)
{
  const struct scene_params *c = &run->scene.common;
  const struct viscosity viscosity = {(real)c->viscosity, (int)c->viscosity_pairs,
                                      (int)c->wall_slip};
  if (c->viscosity_form == VISCOSITY_IMPLICIT) return solve_viscosity(run, viscosity);
  viscosity_explicit(run->view, viscosity);
  return OK;
}

static void apply_xsph(struct run *run)
{
  const struct scene_params *c = &run->scene.common;
  const double h = (double)run->view->nb.kernel.R / 2;
  const double part = (double)run->view->dt / (double)(real)run->dt; /* of a substep, else 1 */
  run->view->xsph = (real)(part * (c->xsph + c->xsph_rate * run->dt / h));
  physics_viscosity(run->view);
}

status run_viscosity(struct run *run)
{
  const unsigned asks = scene_asks(&run->scene) & (CAN(XSPH) | CAN(VISCOSITY) | CAN(TENSION));
  if (!asks) return OK;
  const enum phase before = clock_enter(PHASE_INTEGRATE);
  status result = run_density(run);
  if (asks & CAN(TENSION)) tension_apply(run->view, run->tension);
  if (asks & CAN(XSPH)) apply_xsph(run);
  if (result == OK && asks & CAN(VISCOSITY)) result = apply_viscosity(run);
  clock_enter(before);
  return result;
}

status run_gravity(struct run *run)
{
  const struct scene *scene = &run->scene;
  const enum phase before = clock_enter(PHASE_INTEGRATE);
  if (inner(scene->gravity, scene->gravity) > 0) physics_gravity(run->view);
  if (scene->pull != 0) physics_pull(run->view, scene->pull);
  clock_enter(before);
  return OK;
}

status run_forces(struct run *run)
{
  TRY(run_gravity(run));
  return run_viscosity(run);
}

double run_bytes_per_particle(const struct run *run)
{
  const int n = run->view->p.n > 0 ? run->view->p.n : 1;
  double bytes = (double)store_bytes(&run->store) + sizeof(int) * (double)run->order_capacity +
                 sizeof *run->keys * (double)run->keys_capacity;
  const struct pair_list *lists[MAX_PAIR_LISTS + 1] = {&run->neighbours};
  for (int k = 0; k < MAX_PAIR_LISTS; k++) {
    lists[k + 1] = &run->list[k];
    bytes += (double)run->coefficients[k].capacity;
  }
  bytes += (double)run->coefficients[MAX_PAIR_LISTS].capacity;
  for (int k = 0; k <= MAX_PAIR_LISTS; k++)
    bytes += sizeof(int) * (2.0 * lists[k]->row_capacity + lists[k]->slot_capacity);
  bytes += sizeof(int) * ((double)run->fluid_cells.capacity + run->wall_cells.capacity +
                          run->virtual_cells.capacity);
  return bytes / n;
}
