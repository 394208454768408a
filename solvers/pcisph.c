/* Predictive-corrective incompressible SPH.
 * B. Solenthaler, R. Pajarola, ACM Trans. Graph. 28(3) (2009) 40, doi:10.1145/1531326.1531346.
 * Algorithm numbers are that paper's.
 *
 * Differences from the paper: see DIFFERENCES below.
 *
 * relaxation: on a lattice an iteration with r times the paper's delta multiplies a mode of the
 * error by 1 - r theta/2, theta <= theta_max = 2.0 .. 7.5 (sph/lattice.h; supports of 2 to 3 dx).
 * The paper's r = 1 diverges where theta_max > 4: in 3-D beyond supports of 2.4 .. 2.9 dx.
 *
 * Gradients stay those of the start of the step: an iteration may stall where one step has to take
 * away more than some 10 % of compression.
 *
 * walls: a mirrored pressure pushes twice for what a wall adds to rho*, which is no gradient of the
 * density, and feeds energy (default tank, 1 s: total energy 8 J with it, -2 J without). */
#include "../core/solver.h"
#include "../core/sph/lattice.h"
#include <stdio.h>
#include <string.h>

#define DIFFERENCES                                                                                \
  "relaxation: the paper's delta is multiplied by 2.8/theta_max (1.4/theta_max if clamp = free), " \
  "theta_max the largest eigenvalue of the iteration on a lattice; the paper's factor is 1, "      \
  "which diverges where theta_max > 4\n"                                                           \
  "delta: of a particle in a full lattice of spacing dx\n"                                         \
  "clamp: clamped keeps the sum p >= 0, so that an overshoot is taken back; free lets p < 0 hold " \
  "density where it is below rho0, but never raise it, so that surfaces do not contract\n"         \
  "stopping: before a correction, by the mean (or largest) of max(rho*/rho0 - 1, 0), with "        \
  "clamp = free by what a correction would still change; the paper takes the largest and 1 %\n"    \
  "iterations change v* and x* by the change of p, which is the same but for rounding\n"           \
  "warm start: from a part of the last step's p; the paper's p starts from 0\n"                    \
  "walls: particles of mass m that keep their velocity, without pressure, or with their "          \
  "neighbour's; the paper corrects positions and velocities there\n"                               \
  "several fluids: delta is that of the prototype in the fluid of i, or that of i where its "      \
  "neighbours yield more; clamp = free fails where their densities differ 100-fold"

enum { CLAMPED, FREE };
enum { MEAN, LARGEST };
enum { NONE, MIRRORED };

#define PARAMS(P)                                                                               \
  P(tolerance, 1e-3, 0, 1, "1", "relative compression at which to stop")                        \
  P(measure, MEAN, 0, 1, "mean|largest", "of which the tolerance is meant")                     \
  P(min_iterations, 3, 0, 1e6, WHOLE, "least number of iterations")                             \
  P(max_iterations, 100, 1, 1e6, WHOLE, "largest number of iterations")                         \
  P(fixed_iterations, 0, 0, 1e6, WHOLE,                                                         \
    "number of iterations, whatever the error; 0: by tolerance")                                \
  P(relaxation, 0, 0, 4, "1", "factor on the paper's delta; 0: 2.8/theta_max of the lattice")   \
  P(clamp, CLAMPED, 0, 1, "clamped|free", "p >= 0, or also tension")                            \
  P(wall_pressure, NONE, 0, 1, "none|mirrored", "pressure of a wall: none, or its neighbour's") \
  P(warm_start, 0, 0, 1, "1", "part of its last p that a step starts from")

#define FIELDS(F)                                                                                  \
  F(vec, ahead, ALL, STEP, "m", "predicted position x*")                                           \
  F(real, change, ALL, STEP, "Pa", "change of p in this iteration, 0 on walls")                    \
  F(real, rest, FLUID, STEP, "1", "min(rho_i/rho_0 - 1, 0) at the start of the step")              \
  F(real, yield, FLUID, STEP, "kg^2/m^(2d+2)", "what replaces the prototype's, of several fluids") \
  F(real, last, FLUID, KEPT, "Pa", "p of the last step")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  struct pairs next; /* nb at the predicted positions */
  real spread;       /* sum_j |m grad W_ij|^2 of the full lattice [kg^2/m^(2d+2)] */
  real gain;         /* relaxation * delta * rho_0 in this step [Pa] */
} state;

/* no change of p on walls, for good */
STAGE void no_change(const state *s, int i) { s->change[i] = 0; }
STAGE void forget(const state *s, int i) { s->last[i] = 0; }
STAGE void remember(const state *s, int i) { s->last[i] = s->p.p[i]; }

/* Alg. 2   x*_i = x_i + dt v*_i */
STAGE void predict_position(const state *s, int i)
{
  s->ahead[i] = madd(s->p.x[i], s->dt, s->p.v[i]);
}

/* p_i = 0, its first change = a part of the last step's */
STAGE void begin(const state *s, int i)
{
  s->p.p[i] = 0;
  s->change[i] = s->last ? s->warm_start * s->last[i] : 0;
  if (s->rest) s->rest[i] = smaller(s->p.rho[i] / s->rho0 - 1, 0);
}

/* yield_i = light_i |sum_j m_j grad W_ij|^2 + sum_j light_j |m_j grad W_ij|^2 (constraint.h), or
 * the prototype's in the fluid of i, whichever is larger */
STAGE void find_yield(const state *s, int i)
{
  const struct constraint c = constraint_at(&s->p, &s->nb, i);
  s->yield[i] = larger(c.yield, s->p.light[i] * s->spread);
}

/* Alg. 2   rho*_i = sum_j m_j W(x*_i - x*_j),   rho*_err = rho*_i - rho_0,   p_i += delta rho*_err
 * of which the sum p_i is clamped. Returns the relative error that counts. */
STAGE real correct_pressure(const state *s, int i)
{
  lanes rho = NO_LANES;
  for_pairs (&s->next, i, ij) rho += of(s->p.m, ij) * W(&s->next, ij);
  s->p.rho[i] = sum(rho);
  const real gain = s->yield ? s->gain * s->spread / s->yield[i] : s->gain, p = s->p.p[i];
  const real high = (s->p.rho[i] - s->rho0) / s->rho0;
  real wanted = larger(p + gain * high, 0);
  if (s->rest) wanted += smaller(p + gain * (high - s->rest[i]), 0);
  s->change[i] = wanted - p;
  return s->rest ? fabs(s->change[i]) / gain : larger(high, 0);
}

/* change_j; at walls 0, or change_i */
STAGE lanes change_of(const state *s, struct packet ij)
{
  const lanes change = of(s->change, ij);
  if (s->wall_pressure == (real)NONE || s->p.n_all == s->p.n) return change;
  return change + s->change[ij.i] * (1 - only_below(ij, s->p.n, 1 + NO_LANES));
}

/* Alg. 2   a^p_i = -light_i sum_j m_j (p_i + p_j)/rho_0^2 grad W_ij at the positions of the start,
 *          v*_i = v*_i + dt a^p_i,   x*_i = x_i + dt v*_i */
STAGE void accelerate(const state *s, int i)
{
  const real own = s->change[i];
  vecs a = NO_VECS;
  for_neighbours (s, i, ij)
    a = add(a, scale(of(s->p.m, ij) * (own + change_of(s, ij)), gradW(&s->nb, ij)));
  const vec dv = times(-s->dt * light(&s->p, i) / sq(s->rho0), sum(a));
  s->p.p[i] += own;
  s->p.v[i] = plus(s->p.v[i], dv);
  s->ahead[i] = madd(s->ahead[i], s->dt, dv);
}

/* Error of the prediction for the next correction, and what that will be. */
static double correct_pressures(const state *s)
{
  double error;
  if (s->measure == (real)MEAN) {
    sum_over(correct_pressure, s, s->p.n, &error);
    return s->p.n > 0 ? error / s->p.n : 0;
  }
  largest_over(correct_pressure, s, s->p.n, &error);
  return s->p.n > 0 ? error : 0;
}

/* Alg. 2, the loop */
static status correct(struct run *run, state *s)
{
  const int fixed = (int)s->fixed_iterations, most = fixed > 0 ? fixed : (int)s->max_iterations;
  const int least = fixed > 0 ? fixed : (int)s->min_iterations;
  for (int k = 0;; k++) {
    const double error = correct_pressures(s);
    const int reached = k >= least && (fixed > 0 || error <= (double)s->tolerance);
    if (!(error >= 0)) return run_diverged(run, "the predicted density is not a number");
    if (reached || k >= most) {
      run_iterations(run, "density", k, error, reached);
      return OK;
    }
    sweep(accelerate, s);
  }
}

/* delta = rho_0^2/(2 dt^2 sum_j |m grad W_ij|^2), times rho_0 for a relative error */
static real gain(const state *s)
{
  return s->relaxation * s->rho0 * sq(s->rho0) / (2 * sq(s->dt) * s->spread);
}

/* Alg. 2 */
static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_neighbours(run));
  TRY(run_forces(run));
  if (s->rest) TRY(run_density(run));
  s->gain = gain(s);
  s->next = s->nb;
  s->next.xi = s->next.xj = s->ahead;
  sweep_over(predict_position, s, s->p.n_all);
  sweep(begin, s);
  if (s->yield) sweep(find_yield, s);
  if (s->warm_start > 0) sweep(accelerate, s);
  TRY(correct(run, s));
  if (s->last) sweep(remember, s);
  return run_move(run);
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  const double safety = s->clamp == (real)FREE ? 1.4 : 2.8;
  (void)run;
  const double m = (double)s->mass, dx = (double)s->dx;
  s->spread = (real)(m * m * lattice_spread(&s->nb.kernel, dx));
  if (!(s->relaxation > 0)) s->relaxation = (real)(safety / lattice_stiffest(&s->nb.kernel, dx));
  sweep_over(no_change, s, s->p.n_all);
  if (s->last) sweep(forget, s);
  return OK;
}

/* Beyond 4/theta_max an iteration makes the stiffest mode worse. */
static void warn(const void *self, double speed, char *text, size_t size)
{
  const state *s = (const state *)self;
  const double most = 4 / lattice_stiffest(&s->nb.kernel, (double)s->dx);
  (void)speed;
  if ((double)s->relaxation > most)
    snprintf(text, size, "relaxation %g is beyond %.3g = 4/theta_max, where iterations diverge",
             (double)s->relaxation, most);
}

static int uses(const void *self, const char *field)
{
  const state *s = (const state *)self;
  if (strcmp(field, "rest") == 0) return s->clamp == (real)FREE;
  if (strcmp(field, "yield") == 0) return s->p.light != NULL;
  if (strcmp(field, "last") == 0) return s->warm_start > 0;
  return 1;
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_pcisph = {
  .abi = SOLVER_ABI,
  .name = "pcisph",
  .about = "Predictive-corrective SPH: pressures from predicted densities, by one factor for all",
  .paper = "B. Solenthaler, R. Pajarola, Predictive-Corrective Incompressible SPH, "
           "ACM Trans. Graph. 28(3) (2009) 40",
  .doi = "10.1145/1531326.1531346",
  .differences = DIFFERENCES,
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(p),
  .can = CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) |
         CAN(PERIODIC) | CAN(MOMENTUM) | CAN(ISOTROPIC) | CAN(FLUIDS) | CAN(MOVING_WALLS) |
         CAN(BODIES) | CAN(EMITTERS) | CAN(VISCOSITY) | CAN(TENSION),
  .params = params,
  .num_params = COUNT(params),
  .fields = fields,
  .num_fields = COUNT(fields),
  .state_size = sizeof(state),
  .start = start,
  .step = step,
  .changed = NULL,
  .project = NULL,
  .max_dt = NULL,
  .uses = uses,
  .stop = NULL,
  .warn = warn,
};
