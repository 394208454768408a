/* solver.h - the contract of a pressure solver: one const table per method, and what the runner
 * offers to it. */
#ifndef SOLVER_H
#define SOLVER_H
#include "base/param.h"
#include "base/status.h"
#include "neighbours/constraint.h"
#include "neighbours/neighbours.h"
#include "particles/particles.h"
#include "sph/sweep.h"
#ifdef __cplusplus
extern "C" {
#endif

#define SOLVER_ABI 2

/* What a scene may ask and a solver can do. The text completes "the solver cannot ..." in the
 * compatibility table. */
#define ABILITY_LIST(A)                                         \
  A(2D, "run in two dimensions")                                \
  A(3D, "run in three dimensions")                              \
  A(WALLS, "handle wall particles")                             \
  A(FREE_SURFACE, "handle a free surface")                      \
  A(GRAVITY, "apply a body force")                              \
  A(XSPH, "apply XSPH viscosity")                               \
  A(PERIODIC, "run in a periodic domain")                       \
  A(PROJECT, "project velocities without moving the particles") \
  A(MOMENTUM, "keep linear momentum to rounding")               \
  A(ISOTROPIC, "treat all directions in space alike")           \
  A(VISCOSITY, "apply viscosity")                               \
  A(TENSION, "apply surface tension")                           \
  A(FLUIDS, "handle fluids of different rest density")          \
  A(MOVING_WALLS, "handle walls that move")                     \
  A(BODIES, "carry rigid bodies")                               \
  A(EMITTERS, "take in new particles during a run")
#define A(name, text) ABILITY_##name,
enum ability { ABILITY_LIST(A) NUM_ABILITIES };
#undef A
#define CAN(name) (1u << ABILITY_##name)

struct run; /* owns particles, pair lists, clocks, results; opaque to solvers */

/* What the runner keeps up to date at the head of every solver's state. */
#define VIEW                                                                              \
  struct particles p;                                                                     \
  struct pairs nb;  /* fluid -> fluid and wall, at the positions of the last sort */      \
  struct grid grid; /* of the last sort */                                                \
  const int *cells; /* first fluid particle of each cell of the grid [num_cells + 1] */   \
  real dt;          /* time step [s] */                                                   \
  real time;        /* time at the start of the step [s] */                               \
  real rho0;        /* rest density [kg/m^3] */                                           \
  real dx;          /* particle spacing [m] */                                            \
  real mass;        /* of a particle in a full lattice of density rho0 [kg, 2-D: kg/m] */ \
  real xsph;        /* XSPH coefficient per step [1] */                                   \
  real sigma;       /* surface tension [N/m] */                                           \
  vec gravity       /* body force [m/s^2] */
struct view {
  VIEW;
};

#define FIELD_MEMBER(type, name, where, life, unit, meaning) type *name;
#define FIELD_ROW(type, name, where, life, unit, meaning) \
  {#name, unit, meaning, where, life, FIELD_COMPONENTS(type), sizeof(type), offsetof(state, name)},
#define FIELD_COMPONENTS(type) (FIELD_IS_##type ? (int)(sizeof(type) / sizeof(real)) : 0)
#define FIELD_IS_real 1
#define FIELD_IS_vec 1
#define FIELD_IS_int 0
#define FIELD_TABLE(LIST) \
  {                       \
    LIST(FIELD_ROW)       \
  }

/* The slots are in this order in every table (C++20 wants designated initialisers so). */
struct solver {
  int abi;                 /* REQUIRED: SOLVER_ABI */
  const char *name;        /* REQUIRED: as users type it, lower case with hyphens */
  const char *about;       /* REQUIRED: one line */
  const char *paper;       /* REQUIRED: citation */
  const char *doi;         /* REQUIRED */
  const char *differences; /* REQUIRED: from the paper, one per line; "" if none */
  unsigned needs;          /* REQUIRED: HAS(..) of the public fields it reads or writes */
  unsigned can;            /* REQUIRED: CAN(..) */
  const struct param *params;
  int num_params;
  const struct field *fields; /* private fields */
  int num_fields;
  size_t state_size; /* REQUIRED: sizeof(state); a state begins with VIEW */
  /* After the particles were placed and before the first step. Optional. */
  status (*start)(struct run *run, void *state);
  /* Advance x and v from `time` to time + dt. REQUIRED. */
  status (*step)(struct run *run, void *state);
  /* Particles were added between two steps (their private fields are 0) and the lists are new, or
   * the run was loaded from a file: bring up to date what step expects from the last one and does
   * not find in KEPT fields or parameters. Optional. */
  status (*changed)(struct run *run, void *state);
  /* Replace v by its projection at fixed x, and set p. REQUIRED with CAN(PROJECT). */
  status (*project)(struct run *run, void *state);
  /* The largest time step that the method allows now [s]. Optional. */
  double (*max_dt)(const void *state);
  /* Is this private field needed with the parameters in state? Optional: all are. */
  int (*uses)(const void *state, const char *field);
  /* Release what start took beyond fields and pair lists. Optional. */
  void (*stop)(struct run *run, void *state);
  /* After start: what of these parameters the method cannot do at this dt, as a clause without a
   * full stop in text [size], which is empty before. `speed`: the largest that the energy of the
   * start allows [m/s]. Optional. */
  void (*warn)(const void *state, double speed, char *text, size_t size);
  /* With these parameters, do walls push with p_b = p_i, rho_b = rho_0 besides p_i/rho_i^2? Then
   * rigid bodies take both. Optional: with the latter alone. */
  int (*mirrors)(const void *state);
};

/* --- what the runner does for a solver; each keeps the state's VIEW and private field pointers
 * valid --- */

/* x += dt v for the fluid particles; bodies move on too. */
status run_move(struct run *run);

/* Sort the fluid by cell and list its neighbours into state->nb. */
status run_neighbours(struct run *run);

/* rho_i = sum_j m_j W_ij over fluid and walls (state->p.rho), and the fluid's volumes m/rho where
 * they are needed (p.V); once per step and sort. */
status run_density(struct run *run);

/* v += dt (gravity - pull x), then what the scene asks of surface tension, XSPH (v_i += xsph sum_j
 * V_ij (v_j - v_i) W_ij over the fluid) and viscosity, in this order. */
status run_forces(struct run *run);
/* The first part alone (for methods that apply the others after the correction). */
status run_gravity(struct run *run);
/* All but that part (likewise). Nothing where the scene asks for none. */
status run_viscosity(struct run *run);

/* Record that an iterative solve named `what` ("pressure", "divergence") took `count` iterations
 * and left the relative residual; `converged` 0 if it hit its cap. */
void run_iterations(struct run *run, const char *what, int count, double residual, int converged);

/* Stop the run as a result: it diverged, for this reason. Returns ERR_RUN for the solver to pass
 * on. */
status run_diverged(struct run *run, const char *format, ...);

/* --- a second set of particles, for solvers that declare VIRTUAL fields; one of them, a KEPT vec
 * named X, is its position */

/* Give the virtual set n particles: its fields hold n; KEPT ones keep their first min(n, old n)
 * entries. */
status run_virtual(struct run *run, int n);

/* Sort the virtual set by the cells of the last run_neighbours: permutes its KEPT fields. */
status run_sort_virtual(struct run *run);

/* A pair list of the solver's own, valid until the same slot is built again. SET_ALL is fluid and
 * walls. The virtual set must be sorted. `slot` is 0 .. MAX_PAIR_LISTS-1. */
enum pair_set { SET_FLUID, SET_ALL, SET_VIRTUAL };
enum { MAX_PAIR_LISTS = 4 };
status run_pairs(struct run *run, int slot, enum pair_set from, enum pair_set to,
                 struct pairs *list);

/* Rows of the walls for state->nb, which run_neighbours leaves without: [n, n_all). */
status run_wall_rows(struct run *run);

/* n keys to be filled by a stage; then sorted with repetitions dropped: the number left, < 0 on no
 * memory. */
unsigned long long *run_keys(struct run *run, int n);
int run_unique_keys(struct run *run, unsigned long long *keys, int n);

/* Room for one real per slot of that pair list (coefficients), reused from step to step; NULL on no
 * memory. */
real *run_coefficients(struct run *run, int slot, int num_slots);

/* Random bits for this step: a counter-based stream of the run's seed; the same on CPU and GPU. in
 * [0, 1) */
double run_random(const struct run *run, unsigned long long counter);

long run_step_number(const struct run *run);

/* A solver's warning where its density compensation takes the part kappa of the compression away in
 * each step: beyond 2 an overshoot is larger than what it takes away. */
void warn_of_kappa(double kappa, char *text, size_t size);

#define SOLVER(name) extern const struct solver solver_##name;
#include "../solvers/solvers.def"
#undef SOLVER

#ifdef __cplusplus
}
#endif
#endif
