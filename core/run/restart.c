#include "restart.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../base/memory.h"

static enum shelf_type real_type(void) { return sizeof(real) == 4 ? SHELF_FLOAT : SHELF_DOUBLE; }

static struct h5_label label(const char *name, const char *unit, const char *about)
{
  return (struct h5_label){name, unit, about};
}

static status no_memory(struct shelf *s, size_t bytes)
{
  if (s->failed == OK) s->failed = status_set(ERR_MEMORY, "no memory for %zu bytes", bytes);
  return s->failed;
}

/* One array that lies where the particles do; components 0: ints. */
struct block {
  void *data;
  long rows;
  int components;
};

static void walk_block(struct shelf *s, struct h5_label what, struct block b)
{
  const size_t each =
    b.components ? sizeof(real) * (size_t)b.components : sizeof(int); /* as in struct field */
  const size_t bytes = each * (size_t)b.rows;
  void *host = malloc(bytes + 1);
  if (!host) {
    no_memory(s, bytes);
    return;
  }
  if (s->saving) memory_to_host(host, b.data, bytes);
  shelf_array(s, what,
              (struct shelf_array){b.components ? real_type() : SHELF_INT, b.rows,
                                   b.components > 1 ? b.components : 0, host});
  if (!s->saving && s->failed == OK) memory_from_host(b.data, host, bytes);
  free(host);
}

/* What outlives a step: KEPT fields, and the public ones of the last step, which output shows. */
static void walk_fields(struct shelf *s, struct run *run)
{
  for (int k = 0; k < run->store.num_fields; k++) {
    const struct store_field *f = &run->store.field[k];
    char name[80];
    if (f->row.life != KEPT && !f->is_public) continue;
    snprintf(name, sizeof name, "fields/%s", f->row.name);
    walk_block(s, label(name, f->row.unit, f->row.meaning),
               (struct block){f->data, run->store.count[f->row.where], f->row.components});
  }
}

static void walk_params(struct shelf *s, struct run *run)
{
  const struct solver *solver = run->solver;
  for (int k = 0; k < solver->num_params; k++) {
    const struct param *p = &solver->params[k];
    char name[80];
    snprintf(name, sizeof name, "solver/%s", p->name);
    shelf_array(s, label(name, p->unit, p->meaning),
                (struct shelf_array){real_type(), 1, 0, (char *)run->state + p->offset});
  }
}

static void walk_iterations(struct shelf *s, struct run *run)
{
  long num = run->num_iterations, step_iterations = run->step_iterations;
  shelf_whole(s, label("num_iterations", "1", "kinds of iterative solves"), &num);
  shelf_whole(s, label("step_iterations", "1", "of the last step, all solves"), &step_iterations);
  shelf_number(s, label("step_residual", "1", "of the last step"), &run->step_residual);
  if (num < 0 || num > MAX_ITERATIONS) shelf_refuse(s, "it has %ld kinds of solves", num);
  for (int k = 0; k < num && s->failed == OK; k++) {
    struct iterations *it = &run->iterations[k];
    char name[40], *word = run->iteration_word[k];
    long whole[5] = {it->solves, it->total, it->capped, it->last, it->most};
    if (s->saving && it->what != word)
      snprintf(word, sizeof run->iteration_word[k], "%s", it->what);
    snprintf(name, sizeof name, "solve%d", k);
    shelf_text(s, label(name, "1", "name of the solve"), word, sizeof run->iteration_word[k]);
    snprintf(name, sizeof name, "solve%d_counts", k);
    shelf_array(s, label(name, "1", "solves, total, capped, last, most"),
                (struct shelf_array){SHELF_LONG, 5, 0, whole});
    snprintf(name, sizeof name, "solve%d_residual", k);
    shelf_number(s, label(name, "1", "of the last solve"), &it->residual);
    if (!s->saving) run->first_iterations += whole[1];
    *it = (struct iterations){word,          whole[0],      whole[1],    whole[2],
                              (int)whole[3], (int)whole[4], it->residual};
  }
  run->num_iterations = s->failed == OK ? (int)num : 0;
  run->step_iterations = (int)step_iterations;
}

static void walk_bodies(struct shelf *s, struct run *run)
{
  for (int k = 0; run->body && k < run->scene.num_bodies; k++) {
    struct body *b = &run->body[k];
    const struct {
      const char *name, *unit, *about;
      double *data;
      long rows;
    } part[] = {{"centre", "m", "centre of the body", b->centre, 3},
                {"velocity", "m/s", "velocity of its centre", b->velocity, 3},
                {"turn", "1", "its rotation, row by row", b->turn[0], 9},
                {"spin", "rad/s", "angular velocity", b->spin, 3},
                {"angular", "kg m^2/s", "angular momentum", b->angular, 3}};
    for (int p = 0; p < COUNT(part); p++) {
      char name[40];
      snprintf(name, sizeof name, "body%d_%s", k + 1, part[p].name);
      shelf_array(s, label(name, part[p].unit, part[p].about),
                  (struct shelf_array){SHELF_DOUBLE, part[p].rows, 0, part[p].data});
    }
  }
}

static void walk_clock(struct shelf *s, struct run *run)
{
  double visited = visits_total(run);
  long labels = run->num_labels;
  shelf_number(s, label("time", "s", "simulated time"), &run->time);
  shelf_number(s, label("dt", "s", "time step"), &run->dt);
  shelf_whole(s, label("step", "1", "number of steps so far"), &run->step);
  shelf_whole(s, label("labels", "1", "labels given so far"), &labels);
  shelf_array(s, label("layers", "1", "that each emitter has made"),
              (struct shelf_array){SHELF_LONG, MOST_EMITTERS, 0, run->layers});
  shelf_number(s, label("visited", "1", "neighbour pairs visited so far"), &visited);
  run->num_labels = (int)labels;
  if (!s->saving) visits_resume(run, visited);
  if (!s->saving) run->first_step = run->step;
}

/* A solver that has virtual particles keeps their positions under this name (solver.h); where they
 * are the particles themselves there are as many. */
static status check_virtual(struct shelf *s, struct run *run, long virtual, long particles)
{
  const struct store_field *f = store_find(&run->store, "X");
  const int has = f && f->row.where == VIRTUAL;
  const long rows = has && virtual > 0 ? shelf_rows(s, "fields/X") : virtual ? particles : 0;
  if (virtual == rows) return s->failed;
  return shelf_refuse(s, "it has %ld virtual particles and %ld positions of them", virtual, rows);
}

/* Particles per kind of field; a loading run takes in what emitters have made since the start. */
static status walk_counts(struct shelf *s, struct run *run)
{
  const long most = 1000000000;
  long n = run->view->p.n, walls = run->view->p.n_all - n, virtual = run->store.count[VIRTUAL];
  const long n_here = n, walls_here = walls;
  shelf_whole(s, label("particles", "1", "fluid particles"), &n);
  shelf_whole(s, label("walls", "1", "wall particles"), &walls);
  shelf_whole(s, label("virtual", "1", "virtual particles"), &virtual);
  if (s->failed != OK || s->saving) return s->failed;
  if (walls != walls_here || n < n_here || n > most)
    return shelf_refuse(s, "it has %ld fluid and %ld wall particles, the scene %ld and %ld", n,
                        walls, n_here, walls_here);
  if (shelf_rows(s, "fields/x") != n + walls)
    return shelf_refuse(s, "it has %ld positions of %ld particles", shelf_rows(s, "fields/x"),
                        n + walls);
  TRY(check_virtual(s, run, virtual, n + walls));
  s->failed = n > n_here ? store_insert_fluid(&run->store, (int)(n - n_here)) : OK;
  run->view->p.n = (int)n;
  run->view->p.n_all = (int)(n + walls);
  if (s->failed == OK) s->failed = run_virtual(run, (int)virtual);
  return s->failed;
}

/* The lists are those of where the particles were then, not of where they are now. */
static void walk_lists(struct shelf *s, struct run *run)
{
  long listed = run->have_grid, wall_rows = run->has_wall_rows, dense = run->density_is_current;
  shelf_whole(s, label("listed", "1", "were neighbours ever listed?"), &listed);
  shelf_whole(s, label("wall_rows", "1", "do walls have rows in the list?"), &wall_rows);
  shelf_whole(s, label("density", "1", "is the density that of the list?"), &dense);
  if (s->failed != OK || !listed) return;
  const struct block where = {s->saving ? run->listed : run->view->p.x, run->view->p.n_all, DIM};
  walk_block(s, label("listed_at", "m", "positions when neighbours were listed"), where);
  if (s->saving || s->failed != OK) return;
  s->failed = run_list_again(run);
  if (s->failed == OK && wall_rows) s->failed = run_wall_rows(run);
  if (s->failed == OK && run->solver->changed) s->failed = run->solver->changed(run, run->state);
  run->density_is_current = (int)dense;
}

/* --- what was loaded, before anything is computed from it --- */

/* A field of whole numbers below `most`, each of them once where it is a label. */
static status check_numbers(struct shelf *s, struct run *run, const char *name, int most, int once)
{
  const struct store_field *f = store_public(&run->store, name);
  const int n = f ? run->store.count[f->row.where] : 0;
  if (n == 0) return s->failed;
  int *number = malloc(sizeof(int) * (size_t)n);
  char *seen = calloc(1, (size_t)most + 1);
  if (!number || !seen) no_memory(s, sizeof(int) * (size_t)n);
  if (number) memory_to_host(number, f->data, sizeof(int) * (size_t)n);
  for (int i = 0; i < n && s->failed == OK; i++) {
    if (number[i] < 0 || number[i] >= most || (once && seen[number[i]]))
      shelf_refuse(s, "its fields/%s has %d, allowed are 0 to %d%s", name, number[i], most - 1,
                   once ? ", each of them once" : "");
    else
      seen[number[i]] = 1;
  }
  free(seen);
  free(number);
  return s->failed;
}

/* Which body a wall particle belongs to is a number among reals. */
static status check_bodies(struct shelf *s, struct run *run)
{
  const struct store_field *f = store_public(&run->store, "body");
  const int n = f ? run->store.count[f->row.where] : 0, bodies = run->scene.num_bodies;
  real *body = n > 0 ? malloc(sizeof(real) * (size_t)n) : NULL;
  if (n == 0) return s->failed;
  if (!body) return no_memory(s, sizeof(real) * (size_t)n);
  memory_to_host(body, f->data, sizeof(real) * (size_t)n);
  for (int i = run->view->p.n; i < n && s->failed == OK; i++)
    if (!(body[i] >= 0 && body[i] <= (real)bodies && body[i] == rint(body[i])))
      shelf_refuse(s, "its fields/body has %g, allowed are 0 to %d", (double)body[i], bodies);
  free(body);
  return s->failed;
}

static status check_clock(struct shelf *s, const struct run *run)
{
  if (!isfinite(run->time) || !isfinite(run->dt) || run->dt <= 0 || run->step < 0)
    return shelf_refuse(s, "it stands at t = %g s, step %ld of %g s", run->time, run->step,
                        run->dt);
  for (int k = 0; k < MOST_EMITTERS; k++)
    if (run->layers[k] < 0)
      return shelf_refuse(s, "emitter %d has made %ld layers", k + 1, run->layers[k]);
  return s->failed;
}

/* Also what a solver put in place of "auto" lies within the range of its parameter; one that has no
 * range is for the solver to report, not for a user to set. */
static status check_params(struct shelf *s, struct run *run)
{
  for (int k = 0; k < run->solver->num_params; k++) {
    const struct param *p = &run->solver->params[k];
    const double value = (double)*(const real *)((const char *)run->state + p->offset);
    const double least = fmin(p->low, p->initial), most = fmax(p->high, p->initial);
    const int reported = p->low == p->high;
    if (reported ? !(value >= 0) : !(value >= (double)(real)least && value <= (double)(real)most))
      return shelf_refuse(s, "its solver/%s is %g, allowed is %g to %g", p->name, value, least,
                          most);
  }
  return s->failed;
}

static status check_loaded(struct shelf *s, struct run *run)
{
  const int fluids = run->scene.num_fluids;
  if (s->failed != OK || s->saving) return s->failed;
  TRY(check_numbers(s, run, "id", run->view->p.n, 1));
  TRY(check_numbers(s, run, "fluid", fluids > 1 ? fluids : 1, 0));
  TRY(check_bodies(s, run));
  TRY(check_params(s, run));
  return s->failed;
}

status restart_prepare(struct run *run)
{
  run->keeps_listed = 1;
  return run->have_grid ? run_remember_listed(run) : OK;
}

status restart_walk(struct shelf *s, struct run *run)
{
  shelf_group(s, "fields");
  shelf_group(s, "solver");
  TRY(walk_counts(s, run));
  if (!s->saving) walk_fields(s, run); /* `changed` looks at them */
  if (!s->saving) walk_params(s, run);
  TRY(check_loaded(s, run));
  walk_lists(s, run);
  walk_fields(s, run);
  walk_params(s, run);
  walk_clock(s, run);
  if (!s->saving) TRY(check_clock(s, run));
  walk_iterations(s, run);
  walk_bodies(s, run);
  return s->failed;
}
