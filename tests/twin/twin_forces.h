/* twin_forces.h - a solver that does nothing but apply the runner's forces to particles at rest in
 * space, so that these can be compared with double loops, and two fluids on request. */
#ifndef TWIN_FORCES_H
#define TWIN_FORCES_H
#include "twin_solvers.h"

typedef struct {
  VIEW;
} still_state;

static status still_step(struct run *run, void *self)
{
  (void)self;
  TRY(run_neighbours(run));
  return run_forces(run);
}

/* The second fluid: particles with an odd label are three times as heavy and half as viscous. */
static inline double light_of_label(int label) { return label % 2 ? 1.0 / 3 : 1; }
static inline double mu_of_label(int label, double mu) { return label % 2 ? mu / 2 : mu; }
static double still_mu; /* of the first fluid [Pa s] */

static status two_fluids(struct run *run, void *self)
{
  still_state *s = (still_state *)self;
  (void)run;
  for (int i = 0; i < s->p.n_all; i++) {
    s->p.light[i] = i < s->p.n ? (real)light_of_label(s->p.id[i]) : 0;
    s->p.mu[i] = i < s->p.n ? (real)mu_of_label(s->p.id[i], still_mu) : (real)NAN;
  }
  return OK;
}

#define STILL_NEEDS (HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(V) | HAS(p))
#define STILL(label, the_needs, the_start)                                                     \
  {                                                                                            \
    .abi = SOLVER_ABI, .name = label, .about = "forces alone", .paper = "none", .doi = "none", \
    .differences = "", .needs = the_needs, .can = ~0u, .params = NULL, .num_params = 0,        \
    .fields = NULL, .num_fields = 0, .state_size = sizeof(still_state), .start = the_start,    \
    .step = still_step                                                                         \
  }
static const struct solver solver_still = STILL("still", STILL_NEEDS, NULL);
static const struct solver solver_still_two =
  STILL("still-two", STILL_NEEDS | HAS(light) | HAS(mu), two_fluids);

/* One step of the runner's forces on the cloud: its velocities after it. */
static inline void still_run(struct cloud *c, const struct solver *solver,
                             const struct scene_params *asked)
{
  struct scene scene = cloud_scene(c);
  struct run *run;
  struct snapshot now;
  scene.common.viscosity = asked->viscosity;
  scene.common.viscosity_form = asked->viscosity_form;
  scene.common.viscosity_tolerance = asked->viscosity_tolerance;
  scene.common.viscosity_pairs = asked->viscosity_pairs;
  scene.common.wall_slip = asked->wall_slip;
  scene.common.tension = asked->tension;
  scene.common.tension_form = asked->tension_form;
  scene.common.xsph_rate = asked->xsph_rate;
  still_mu = asked->viscosity;
  assert_int_equal(run_create(solver, NULL, &scene, 0, &run), OK);
  assert_int_equal(run_step(run), OK);
  if (run->diverged) fail_msg("%s", run->reason);
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int k = 0; k < now.n; k++)
    for (int d = 0; d < DIM; d++) c->v[now.id[k]][d] = (double)now.v[k].c[d];
  snapshot_free(&now);
  run_free(run);
}

/* How far apart their velocities are, relative to the largest change since `before`. */
static inline void assert_same_change(const struct cloud *a, const struct cloud *b,
                                      const struct cloud *before)
{
  double change = 0, wrong = 0;
  for (int i = 0; i < b->n; i++)
    for (int d = 0; d < DIM; d++) {
      change = fmax(change, fabs(b->v[i][d] - before->v[i][d]));
      wrong = isfinite(a->v[i][d]) ? fmax(wrong, fabs(a->v[i][d] - b->v[i][d])) : HUGE_VAL;
    }
  if (getenv("TWIN_SHOW")) print_message("apart: %.2g of %.3g m/s\n", wrong, change);
  assert_true(change > 1e-3);
  assert_true(wrong < TWIN_TOLERANCE * fmax(change, largest_of(b->v[0], b->n * DIM)));
}
#endif
