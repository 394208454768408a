/* run.h - one run: a solver on a scene, stepped by the caller. */
#ifndef RUN_H
#define RUN_H
#include "../benchmark.h"
#include "../solver.h"
#include "bodies.h"
#include "forces.h"
#include "judge.h"
#include "store.h"
#include "visits.h"
#ifdef __cplusplus
extern "C" {
#endif

enum { SPEED_MARGIN = 10 }; /* a particle this many times faster than any energy allows: diverged */

/* One named iterative solve of a step ("pressure", "density", ...), summed over the run. */
struct iterations {
  const char *what;
  long solves, total, capped; /* capped: solves that hit their limit */
  int last, most;
  double residual; /* of the last solve */
};
enum { MAX_ITERATIONS = 4 };

struct run {
  const struct solver *solver;
  void *state;        /* of the solver, begins with VIEW */
  struct view *view;  /* = state */
  struct scene scene; /* as built; owned */
  struct store store;
  unsigned needs;
  double dt, time; /* [s] */
  long step;
  long first_step, first_iterations; /* what a restarted run found done */
  int dim;

  struct cell_set fluid_cells, wall_cells, virtual_cells;
  struct pair_list neighbours, list[MAX_PAIR_LISTS];
  struct {
    real *data;
    size_t capacity;
  } coefficients[MAX_PAIR_LISTS + 1]; /* the last is that of implicit viscosity */
  struct tension tension;
  struct pair_visits *visits; /* NULL: pairs are not counted */
  int *order;
  int order_capacity;
  unsigned long long *keys;
  int keys_capacity;
  vec wall_low, wall_high;
  struct body *body;          /* [scene.num_bodies], NULL without */
  long layers[MOST_EMITTERS]; /* that each emitter has made */
  int num_labels;             /* given so far */
  int have_grid, has_wall_rows, density_is_current;
  int keeps_listed; /* is `listed` kept up to date? (restart.h) */
  vec *listed;      /* positions when neighbours were listed [listed_room], NULL without */
  int listed_room;

  struct iterations iterations[MAX_ITERATIONS];
  char iteration_word[MAX_ITERATIONS][32]; /* their names, where they come from a file */
  int num_iterations;
  int step_iterations; /* of this step, all solves */
  double step_residual;

  int diverged;
  int not_finite; /* the last step left a position or velocity that is none */
  char reason[256];
  double speed_limit; /* [m/s]; 0: none */
  struct judge judge;
};

/* Start `solver` on `scene` (taken over, also on failure) with the solver's parameter values
 * [num_params] (NULL: its defaults); `asks` are abilities beyond what the scene itself shows.
 * Errors: ERR_USER when the solver cannot do the scene (sentence says what), ERR_MEMORY, what the
 * solver's start returns. */
status run_create(const struct solver *solver, const double *solver_values, struct scene *scene,
                  unsigned asks, struct run **out);

/* What the scene asks of a solver, from what it holds: walls, gravity, XSPH, period. */
unsigned scene_asks(const struct scene *scene);

/* The first ability that `solver` lacks, as text "cannot ..."; NULL if it can do all of `asks`. */
const char *solver_lacks(const struct solver *solver, unsigned asks);

/* One step of run->dt. A run that diverges returns OK with run->diverged and run->reason set. */
status run_step(struct run *run);

/* One projection of v at fixed x in place of a step. */
status run_project(struct run *run);

/* A host copy of the run's state, in cell order, for analysis. Valid until snapshot_free. Errors:
 * ERR_MEMORY. */
status run_snapshot(struct run *run, struct snapshot *out);
void snapshot_free(struct snapshot *snapshot);

/* walls.c: masses of wall particles after Akinci et al. 2012 where the scene asks for them, and
 * normals where it has none. Errors: ERR_MEMORY. */
status walls_weigh(struct run *run);

/* emit.c: particles that are due at the start of a step. Errors: ERR_MEMORY. */
status run_emit(struct run *run);

/* sets.c: the lists at the positions that p.x holds, which are those of the last sort: nothing is
 * moved into the period, and no particle changes its place. */
status run_list_again(struct run *run);
/* Keep the positions of the lists in run->listed. Errors: ERR_MEMORY. */
status run_remember_listed(struct run *run);

/* Bytes per fluid particle of everything that scales with them: fields, pair lists, coefficients,
 * cells. */
double run_bytes_per_particle(const struct run *run);

void run_free(struct run *run);

/* physics.c: the stages that every method shares; compiled for the variant's machine. */
void physics_move(struct view *view);
void physics_wrap(struct view *view, vec low, vec period);
void physics_gravity(struct view *view);
void physics_pull(struct view *view, real pull);
void physics_density(struct view *view);
void physics_viscosity(struct view *view);
/* Sum of |v| + |x| by components (not finite if any position or velocity is not) and the largest
 * speed [m/s].
 */
void physics_health(struct view *view, double *sum, double *fastest);

#ifdef __cplusplus
}
#endif
#endif
