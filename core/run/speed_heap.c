#include "speed_heap.h"

#include <math.h>
#include <string.h>

#include "driver.h"

enum { STEPS = 10, ROUNDS = 5 };

/* A heap: a block of fluid on the floor of a box, its lattice disturbed, as it lies after settling.
 */
static status heap(struct scene *scene, int particles)
{
  const int side = (int)lround(pow(particles, 1.0 / DIM));
  memset(scene, 0, sizeof *scene);
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&scene->common + scene_param_rows[k].offset) = scene_param_rows[k].initial;
  scene->common.spacing = 0.05;
  scene->common.support = SUPPORT;
  scene->common.dt = 1e-3;
  scene->common.jitter = 0.05;
  scene->common.kernel = KERNEL_CUBIC;
  scene->seed = 1;
  scene->gravity = zero();
  scene->gravity.c[DIM - 1] = (real)-scene->common.gravity;
  vec low = zero(), high = zero();
  for (int d = 0; d < DIM; d++) high.c[d] = (real)(scene->common.spacing * side);
  TRY(scene_fill_box(scene, low, high, zero(), NULL));
  scene_apply_jitter(scene);
  vec top = high;
  top.c[DIM - 1] = 2 * high.c[DIM - 1];
  TRY(scene_wall_box(scene, low, top, 2, 1));
  for (int d = 0; d < DIM; d++) {
    scene->low.c[d] = low.c[d] - 10 * (real)scene->common.spacing;
    scene->high.c[d] = top.c[d] + 10 * (real)scene->common.spacing;
  }
  return OK;
}

status heap_time(struct run *run, double *step, double *search)
{
  *step = *search = 1e300;
  for (int round = 0; round < ROUNDS; round++) {
    double before[NUM_PHASES], after[NUM_PHASES];
    clock_phases(before);
    const double begun = clock_now();
    for (int k = 0; k < STEPS; k++) TRY(run_step(run));
    const double each = (clock_now() - begun) / STEPS;
    clock_phases(after);
    const double nb = (after[PHASE_NEIGHBOURS] - before[PHASE_NEIGHBOURS]) / STEPS;
    if (each < *step) *step = each;
    if (nb < *search) *search = nb;
  }
  return run->diverged
           ? status_set(ERR_RUN, "the heap diverged with '%s': %s", run->solver->name, run->reason)
           : OK;
}

status heap_open(const struct solver *solver, int particles, int iterations, double tolerance,
                 struct run **run)
{
  struct scene scene;
  double values[64];
  TRY(heap(&scene, particles));
  for (int k = 0; k < solver->num_params && k < 64; k++) values[k] = solver->params[k].initial;
  const struct param *fixed = param_find(solver->params, solver->num_params, "fixed_iterations");
  const struct param *stop = param_find(solver->params, solver->num_params, "tolerance");
  if (fixed) values[fixed - solver->params] = iterations;
  if (stop && tolerance > 0) values[stop - solver->params] = tolerance;
  TRY(run_create(solver, values, &scene, 0, run));
  for (int k = 0; k < STEPS; k++) TRY(run_step(*run)); /* warm up and settle */
  return OK;
}

/* <max(rho_i/rho0 - 1, 0)> with rho_i = sum_j m_j W_ij at the positions as they are: not what the
 * solver thinks it has reached. */
static status compression(struct run *run, double *mean)
{
  struct snapshot now;
  double sum_ = 0;
  TRY(run_snapshot(run, &now));
  const struct pairs *list = now.pairs(&now);
  for (int i = 0; list && i < now.n; i++) {
    lanes W_sum = NO_LANES;
    for_pairs (list, i, ij) W_sum += W(list, ij);
    sum_ += fmax(now.mass * (double)sum(W_sum) / now.rho0 - 1, 0);
  }
  *mean = list ? sum_ / now.n : (double)NAN;
  snapshot_free(&now);
  return OK;
}

/* The worst compression of a few moments, and the iterations per step. */
static status judge(struct run *run, struct equal_case *equal)
{
  long before = 0, after = 0;
  for (int k = 0; k < run->num_iterations; k++) before += run->iterations[k].total;
  equal->error = 0;
  for (int k = 0; k < STEPS && !run->diverged; k++) {
    double now;
    TRY(run_step(run));
    TRY(compression(run, &now));
    equal->error = fmax(equal->error, now);
  }
  for (int k = 0; k < run->num_iterations; k++) after += run->iterations[k].total;
  equal->iterations = (double)(after - before) / STEPS;
  return OK;
}

status heap_at_equal_error(const struct solver *solver, int particles, struct equal_case *equal)
{
  static const double tolerances[] = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5};
  const int some = param_find(solver->params, solver->num_params, "tolerance") ? 6 : 1;
  const double none = (double)NAN;
  for (int k = 0; k < some; k++) {
    struct run *run = NULL;
    double step = none, unused;
    *equal = (struct equal_case){none, none, some > 1 ? tolerances[k] : none, none};
    status result = heap_open(solver, particles, 0, some > 1 ? tolerances[k] : 0, &run);
    if (result == OK) result = judge(run, equal);
    const int good = result == OK && !run->diverged && equal->error <= EQUAL_ERROR;
    if (good) result = heap_time(run, &step, &unused);
    if (good && result == OK) equal->step = 1e6 * step / run->view->p.n;
    run_free(run);
    if (result != OK || good) return result;
  }
  return OK;
}
