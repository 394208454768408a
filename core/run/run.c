#include "run.h"

#include <Random123/philox.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../backend/backend.h"
#include "../base/memory.h"

unsigned scene_asks(const struct scene *scene)
{
  unsigned asks = DIM == 2 ? CAN(2D) : CAN(3D);
  if (scene->n_wall > 0) asks |= CAN(WALLS);
  if (scene->common.xsph > 0 || scene->common.xsph_rate > 0) asks |= CAN(XSPH);
  if (scene->common.viscosity > 0) asks |= CAN(VISCOSITY);
  if (scene->common.tension > 0) asks |= CAN(TENSION);
  if (scene->num_bodies > 0) asks |= CAN(MOVING_WALLS);
  for (int k = 0; k < scene->num_bodies; k++)
    if (scene->body[k].density > 0) asks |= CAN(BODIES);
  for (int k = 0; k < scene->num_fluids; k++) {
    if (scene->fluid[k].rho0 != scene->common.rho0) asks |= CAN(FLUIDS);
    if (scene->fluid[k].viscosity > 0) asks |= CAN(VISCOSITY);
  }
  if (scene->num_emitters > 0) asks |= CAN(EMITTERS);
  if (scene->pull != 0) asks |= CAN(GRAVITY);
  for (int d = 0; d < DIM; d++) {
    if (scene->gravity.c[d] != 0) asks |= CAN(GRAVITY);
    if (scene->period.c[d] > 0)
      asks |= CAN(PERIODIC);
    else
      asks |= CAN(FREE_SURFACE);
  }
  return asks;
}

const char *solver_lacks(const struct solver *solver, unsigned asks)
{
#define A(name, text) text,
  static const char *const texts[] = {ABILITY_LIST(A)};
#undef A
  for (int k = 0; k < NUM_ABILITIES; k++)
    if (asks & ~solver->can & (1u << k)) return texts[k];
  return NULL;
}

static unsigned fields_needed(const struct solver *solver, unsigned asks, const struct scene *scene)
{
  const struct scene_params *c = &scene->common;
  unsigned needs = solver->needs | HAS(x) | HAS(v) | HAS(id);
  if (asks & (CAN(XSPH) | CAN(VISCOSITY) | CAN(TENSION)))
    needs |= HAS(rho) | HAS(m) | HAS(V) | HAS(dv);
  if (asks & CAN(VISCOSITY) && c->viscosity_form == VISCOSITY_IMPLICIT)
    needs |= HAS(mu_dir) | HAS(mu_op) | HAS(mu_diag);
  if (asks & CAN(VISCOSITY) && scene->num_fluids > 0) needs |= HAS(mu);
  if (asks & CAN(TENSION)) needs |= HAS(slant) | (c->tension_form == TENSION_HE ? HAS(colour) : 0);
  if (asks & CAN(FLUIDS)) needs |= HAS(light) | HAS(fluid);
  if (asks & CAN(MOVING_WALLS)) needs |= HAS(body) | HAS(arm);
  if (asks & CAN(BODIES)) needs |= HAS(m) | HAS(p) | HAS(rho) | HAS(dv);
  return needs;
}

static void set_params(const struct solver *solver, const double *values, void *state)
{
  for (int k = 0; k < solver->num_params; k++) {
    const struct param *p = &solver->params[k];
    *(real *)((char *)state + p->offset) = (real)(values ? values[k] : p->initial);
  }
}

/* Copy one array of the scene into [begin, begin + n) of a field that may not exist. */
static void upload(struct store *store, const char *name, const void *from, int begin, int n)
{
  struct store_field *f = store_public(store, name);
  if (f && n > 0)
    memory_from_host((char *)f->data + f->row.bytes * (size_t)begin, from,
                     f->row.bytes * (size_t)n);
}

/* light_i = rho0/rho0_i and the number of its fluid, with `number` [all] and `label` [n] as room.
 */
static void upload_fluids(struct run *run, real *number, int *label)
{
  const struct scene *s = &run->scene;
  if (s->num_fluids == 0) return;
  for (int i = 0; i < s->n; i++) {
    label[i] = i < s->num_fluid_of ? s->fluid_of[i] : 0;
    number[i] = (real)(s->common.rho0 / s->fluid[label[i]].rho0);
  }
  upload(&run->store, "fluid", label, 0, s->n);
  for (int i = 0; i < s->n_wall; i++) number[s->n + i] = 0;
  upload(&run->store, "light", number, 0, s->n + s->n_wall);
  for (int i = 0; i < s->n; i++) number[i] = (real)s->fluid[label[i]].viscosity;
  upload(&run->store, "mu", number, 0, s->n);
}

static status upload_scene(struct run *run)
{
  const struct scene *s = &run->scene;
  const int all = s->n + s->n_wall;
  real *number = malloc(sizeof(vec) * (size_t)(all + 1));
  int *label = malloc(sizeof(int) * (size_t)(s->n + 1));
  if (!number || !label) {
    free(number);
    free(label);
    return status_set(ERR_MEMORY, "no memory for %d particles", all);
  }
  upload(&run->store, "x", s->x, 0, s->n);
  upload(&run->store, "v", s->v, 0, s->n);
  upload(&run->store, "x", s->wall_x, s->n, s->n_wall);
  upload(&run->store, "v", s->wall_v, s->n, s->n_wall);
  upload(&run->store, "normal", s->wall_n, s->n, s->n_wall);
  for (int i = 0; i < all; i++) number[i] = run->view->mass;
  upload(&run->store, "m", number, 0, all);
  memset(number, 0, sizeof(vec) * (size_t)(all + 1));
  upload(&run->store, "V", number, 0, all);
  upload(&run->store, "normal", number, 0, s->n);
  for (int i = 0; i < s->n; i++) label[i] = i;
  upload(&run->store, "id", label, 0, s->n);
  upload_fluids(run, number, label);
  free(number);
  free(label);
  return OK;
}

/* m such that a full lattice of spacing dx has density rho0 exactly: m sum_j W(x_j) = rho0. */
static double lattice_mass(double rho0, double dx, const struct kernel *kernel)
{
  const int reach = (int)ceil((double)kernel->R / dx);
  double total = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = DIM == 3 ? -reach : 0; c <= (DIM == 3 ? reach : 0); c++) {
        const double r = dx * sqrt((double)(a * a + b * b + c * c));
        total += (double)kernel_W(kernel, (real)r, DIM);
      }
  return rho0 / total;
}

static double reference_speed(const struct scene *s)
{
  double fastest = 0, fall = 0;
  for (int i = 0; i < s->n; i++) {
    const double v2 = (double)inner(s->v[i], s->v[i]);
    if (v2 > fastest) fastest = v2;
  }
  for (int i = 0; i < s->n_wall; i++) {
    const double v2 = (double)inner(s->wall_v[i], s->wall_v[i]);
    if (v2 > fastest) fastest = v2;
  }
  for (int d = 0; d < DIM; d++)
    fall += fabs((double)s->gravity.c[d]) * (double)(s->high.c[d] - s->low.c[d]);
  /* a disturbed start may also be set free at a tenth of a spacing per step */
  return sqrt(fastest) + sqrt(2 * fall) + 0.1 * s->common.spacing / s->common.dt;
}

static void fill_view(struct run *run)
{
  const struct scene_params *c = &run->scene.common;
  struct view *v = run->view;
  const struct kernel kernel = kernel_make((int)c->kernel, (real)(c->support * c->spacing), DIM);
  v->p.n = run->scene.n;
  v->p.n_all = run->scene.n + run->scene.n_wall;
  v->nb.kernel = kernel;
  v->dt = (real)c->dt;
  v->rho0 = (real)c->rho0;
  v->dx = (real)c->spacing;
  v->mass = (real)lattice_mass(c->rho0, c->spacing, &kernel);
  v->xsph = (real)c->xsph;
  v->sigma = (real)c->tension;
  v->gravity = run->scene.gravity;
}

static struct tension tension_of_scene(const struct run *run)
{
  const struct scene_params *c = &run->scene.common;
  return tension_make((int)c->tension_form, c->tension, &run->view->nb.kernel, c->spacing,
                      (double)run->view->mass);
}

/* Fields and the pair list of a full lattice: what any run needs. A system that promises more
 * memory than it has would end it later, without a sentence. */
static status check_memory(const struct run *run)
{
  const double n = run->view->p.n_all, s = run->scene.common.support;
  const double neighbours = DIM == 2 ? 3.14 * s * s : 4.19 * s * s * s;
  const double needed = n * (sizeof(int) * neighbours + 4 * sizeof(vec));
  const double there = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
  if (there <= 0 || needed < there) return OK;
  return user_error("%.0f particles with about %.0f neighbours each need %.3g GB, this machine has "
                    "%.3g GB",
                    n, neighbours, 1e-9 * needed, 1e-9 * there);
}

status run_create(const struct solver *solver, const double *solver_values, struct scene *scene,
                  unsigned asks, struct run **out)
{
  asks |= scene_asks(scene);
  const status ready = backend_check();
  if (ready != OK) {
    scene_free(scene);
    *out = NULL;
    return ready;
  }
  const char *lacks = solver_lacks(solver, asks);
  struct run *run = lacks ? NULL : calloc(1, sizeof *run);
  *out = run;
  if (!run) {
    scene_free(scene);
    if (lacks)
      return user_error("solver '%s' cannot %s, which the scene asks", solver->name, lacks);
    return status_set(ERR_MEMORY, "no memory for the run");
  }
  run->scene = *scene;
  memset(scene, 0, sizeof *scene);
  run->solver = solver;
  run->dim = DIM;
  run->state = calloc(1, solver->state_size);
  if (!run->state) return status_set(ERR_MEMORY, "no memory for the solver's state");
  run->view = (struct view *)run->state;
  run->dt = run->scene.common.dt;
  fill_view(run);
  set_params(solver, solver_values, run->state);
  run->needs = fields_needed(solver, asks, &run->scene);
  if (asks & CAN(TENSION)) run->tension = tension_of_scene(run);
  TRY(check_memory(run));
  run->speed_limit = SPEED_MARGIN * reference_speed(&run->scene);
  TRY(store_open(&run->store, solver, run->needs, run->scene.n, run->scene.n_wall, run->state));
  TRY(upload_scene(run));
  positions_bounds(run->scene.wall_x, run->scene.n_wall, &run->wall_low, &run->wall_high);
  run->num_labels = run->scene.n;
  TRY(walls_weigh(run));
  TRY(bodies_start(run));
  return solver->start ? solver->start(run, run->state) : OK;
}

static void begin_step(struct run *run)
{
  run->step_iterations = 0;
  run->step_residual = 0;
  run->view->time = (real)run->time;
  run->view->dt = (real)run->dt;
  if (memory_poisoned()) store_poison(&run->store);
}

static status finish_step(struct run *run, status result)
{
  TRY(backend_check());
  if (result == ERR_RUN && run->diverged) result = OK;
  run->step++;
  if (result == OK) judge_step(run);
  return result;
}

status run_step(struct run *run)
{
  begin_step(run);
  const enum phase before = clock_enter(PHASE_SOLVER);
  status result = run->scene.num_emitters ? run_emit(run) : OK;
  bodies_drive(run, run->time + run->dt / 2);
  if (result == OK) result = run->solver->step(run, run->state);
  if (result == OK) bodies_push(run, run->dt);
  run->time += run->dt;
  clock_enter(before);
  return finish_step(run, result);
}

status run_project(struct run *run)
{
  if (!run->solver->project)
    return user_error("solver '%s' cannot project velocities without moving the particles",
                      run->solver->name);
  begin_step(run);
  const enum phase before = clock_enter(PHASE_SOLVER);
  status result = run_neighbours(run);
  if (result == OK) result = run->solver->project(run, run->state);
  clock_enter(before);
  return finish_step(run, result);
}

void run_iterations(struct run *run, const char *what, int count, double residual, int converged)
{
  int k = 0;
  while (k < run->num_iterations && strcmp(run->iterations[k].what, what)) k++;
  if (k == MAX_ITERATIONS) return;
  struct iterations *it = &run->iterations[k];
  if (k == run->num_iterations) {
    run->num_iterations++;
    it->what = what;
  }
  it->solves++;
  it->total += count;
  it->capped += !converged;
  it->last = count;
  if (count > it->most) it->most = count;
  it->residual = residual;
  run->step_iterations += count;
  if (residual > run->step_residual || isnan(residual)) run->step_residual = residual;
}

status run_diverged(struct run *run, const char *format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(run->reason, sizeof run->reason, format, arguments);
  va_end(arguments);
  run->diverged = 1;
  return status_set(ERR_RUN, "%s", run->reason);
}

double run_random(const struct run *run, unsigned long long counter)
{
  const philox4x32_ctr_t count = {{(uint32_t)counter, (uint32_t)(counter >> 32), 0x52554eu, 0}};
  const philox4x32_key_t key = {{(uint32_t)run->scene.seed, (uint32_t)(run->scene.seed >> 32)}};
  return philox4x32(count, key).v[0] / 4294967296.0;
}

long run_step_number(const struct run *run) { return run->step; }

void run_free(struct run *run)
{
  if (!run) return;
  if (run->solver->stop && run->state) run->solver->stop(run, run->state);
  bodies_free(run);
  visits_free(run);
  particle_search.pair_list_free(&run->neighbours);
  for (int k = 0; k < MAX_PAIR_LISTS; k++) particle_search.pair_list_free(&run->list[k]);
  for (int k = 0; k <= MAX_PAIR_LISTS; k++)
    memory_give(run->coefficients[k].data, run->coefficients[k].capacity);
  particle_search.cell_set_free(&run->fluid_cells);
  particle_search.cell_set_free(&run->wall_cells);
  particle_search.cell_set_free(&run->virtual_cells);
  memory_give(run->listed, sizeof(vec) * (size_t)run->listed_room);
  memory_give(run->order, sizeof(int) * (size_t)run->order_capacity);
  memory_give(run->keys, sizeof *run->keys * (size_t)run->keys_capacity);
  store_close(&run->store);
  scene_free(&run->scene);
  free(run->state);
  free(run);
}
