/* Divergence-free SPH.
 * J. Bender, D. Koschier, IEEE Trans. Vis. Comput. Graph. 23(3) (2017) 1193-1206,
 * doi:10.1109/TVCG.2016.2578335. Equation and algorithm numbers are that paper's; D_i below is
 * rho_i/alpha_i.
 *
 * Differences from the paper: see DIFFERENCES below.
 *
 * relaxation: a correction by the paper's kappa takes away theta times the error of a mode, theta
 * <= theta_max = 2.1 .. 7.5 on a lattice (sph/lattice.h; supports of 2 to 3 dx), about a fifth more
 * on a disordered one. Beyond 2/theta_max an iteration diverges, unless clamp = each, which never
 * takes an overshoot back: with the paper's factor of 1 that works at theta_max < 3 and makes fluid
 * expand beyond.
 *
 * divergence_solver: it keeps particles from approaching wherever they are, so that what a splash
 * has spread does not close up again: after 2 s of the spinner (benchmarks/helmholtz-spinner.yaml,
 * 1 ms) the fluid's volume has grown by 119 %, by 61 % without warm start, by 10 % without this
 * solver (IISPH: 9 %), and by 9 % with divergence_of = dense,
 * which lets particles approach up to rho_0. */
#include "../core/solver.h"
#include "../core/sph/lattice.h"
#include <stdio.h>

#define DIFFERENCES                                                                                \
  "relaxation: kappa of an iteration is multiplied by 1.4/theta_max (0.7/theta_max if clamp = "    \
  "free, where particles cluster), theta_max the largest eigenvalue of the unrelaxed iteration "   \
  "on a lattice; the paper's factor is 1\n"                                                        \
  "clamp: clamped keeps the sum of kappa over the iterations >= 0, so that an overshoot is taken " \
  "back; each keeps every iteration's kappa >= 0, as published programs do (they start from half " \
  "of the last kappa); free lets kappa < 0 hold density where it is below rho0, but never "        \
  "raise it, so that surfaces do not contract\n"                                                   \
  "stopping: before a correction, by what it would still change: the mean compression where "      \
  "nothing is clamped; at least 2 density and 1 divergence iterations as in the paper\n"           \
  "divergence_of: as in the paper every approach is taken away (all); dense spares that of "       \
  "particles below rho_0, which otherwise never close up again\n"                                  \
  "projection alone: the divergence tolerance is relative to the divergence at the start\n"        \
  "walls: particles of mass m with a velocity and without kappa\n"                                 \
  "isolated particles: D_i = rho_i/alpha_i is at least 1e-6 (rho0/R)^2\n"                          \
  "warm start: from the whole kappa/rho of the last step\n"                                        \
  "pressure: p_i = rho_i (kappa_i + kappa^v_i), whose impulse acted in this step; the paper "      \
  "shows none"

enum { CLAMPED, FREE, EACH };
enum { OFF, ON };
enum { EVERYWHERE, DENSE };
enum { LEAST_DENSITY = 2, LEAST_DIVERGENCE = 1 };

#define PARAMS(P)                                                                                  \
  P(tolerance, 1e-4, 0, 1, "1", "mean relative density error at which to stop")                    \
  P(divergence_tolerance, 1e-4, 0, 1, "1", "mean relative density change per step to stop at")     \
  P(max_iterations, 100, 1, 1e6, WHOLE, "largest number of iterations of either solver")           \
  P(fixed_iterations, 0, 0, 1e6, WHOLE, "number of iterations of each; 0: by tolerance")           \
  P(relaxation, 0, 0, 2, "1", "factor on kappa in an iteration; 0: 1.4/theta_max of the lattice")  \
  P(clamp, CLAMPED, 0, 2, "clamped|free|each", "sum of kappa >= 0, any, or each iteration's >= 0") \
  P(density_solver, ON, 0, 1, "off|on", "the constant-density solver")                             \
  P(divergence_solver, ON, 0, 1, "off|on", "the divergence solver")                                \
  P(divergence_of, EVERYWHERE, 0, 1, "all|dense",                                                  \
    "whose compression it takes away: any, or beyond rho_0")                                       \
  P(warm_density, 1, 0, 1, "1", "part of its last kappa that the density solver starts from")      \
  P(warm_divergence, 1, 0, 1, "1", "part of its last kappa that the divergence solver starts from")

#define FIELDS(F)                                                                          \
  F(real, excess, FLUID, KEPT, "1", "rho_i/rho_0 - 1")                                     \
  F(real, factor, FLUID, KEPT, "m^8/kg^2", "alpha_i/rho_i of Eq. (11)")                    \
  F(real, push, FLUID, KEPT, "m^5/(kg s^2)", "kappa_i/rho_i of the density solver")        \
  F(real, push_v, FLUID, KEPT, "m^5/(kg s^2)", "kappa^v_i/rho_i of the divergence solver") \
  F(real, change, ALL, STEP, "m^5/(kg s^2)", "change of either in this iteration, 0 on walls")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real theta; /* the relaxation in force */
} state;

/* kappa_i = kappa^v_i = 0 at the start; no change on walls, for good */
STAGE void forget(const state *s, int i) { s->push[i] = s->push_v[i] = 0; }
STAGE void forget_change(const state *s, int i) { s->change[i] = 0; }

/* rho_i = sum_j m_j W_ij
 * Eq. (11)   alpha_i = rho_i / D_i,   D_i = |sum_j m_j grad W_ij|^2 + sum_j |m_j grad W_ij|^2,
 *            the second sum not over walls, which do not give way; several fluids: see constraint.h
 */
STAGE void factor(const state *s, int i)
{
  const struct constraint c = constraint_at(&s->p, &s->nb, i);
  const real least = (real)1e-6 * sq(s->rho0 * s->nb.kernel.inv_R);
  s->p.rho[i] = c.rho;
  s->excess[i] = (c.rho - s->rho0) / s->rho0;
  s->factor[i] = 1 / larger(c.yield, least);
}

/* dt/rho_0 Drho_i/Dt,   Drho_i/Dt = sum_j m_j (v_i - v_j) . grad W_ij */
STAGE real compression(const state *s, int i)
{
  lanes rate = NO_LANES;
  for_neighbours (s, i, ij) rate += of(s->p.m, ij) * dot(diff(s->p.v, ij), gradW(&s->nb, ij));
  return s->dt / s->rho0 * sum(rate);
}

/* The change of kappa_i/rho_i, now `push`, that takes away the error in relative density: against
 * `high`, the excess over what is allowed, kappa >= 0 acts; against `low`, the shortfall (< 0), if
 * free, kappa <= 0. Returns the part of the error that the change takes away. */
STAGE real relax(const state *s, int i, real push, real high, real low)
{
  const real gain = s->theta * s->rho0 * s->factor[i] / sq(s->dt);
  real wanted = larger(push + gain * high, 0);
  if (s->clamp == (real)FREE) wanted += smaller(push + gain * low, 0);
  if (s->clamp == (real)EACH) wanted = push + larger(gain * high, 0);
  s->change[i] = wanted - push;
  return fabs(s->change[i]) / gain;
}

/* Alg. 3   rho*_i = rho_i + dt Drho_i/Dt,   kappa_i = (rho*_i - rho_0) alpha_i / dt^2 */
STAGE real predict_density(const state *s, int i)
{
  const real rate = compression(s, i);
  return relax(s, i, s->push[i], s->excess[i] + rate, larger(s->excess[i], 0) + rate);
}

/* Alg. 2   kappa^v_i = 1/dt Drho_i/Dt alpha_i;   dense: what lacks of rho_0 may close up */
STAGE real predict_divergence(const state *s, int i)
{
  const real rate = compression(s, i);
  const real open = s->divergence_of == (real)DENSE ? smaller(s->excess[i], 0) : 0;
  return relax(s, i, s->push_v[i], rate + open, rate);
}

/* Alg. 2 and 3   v_i = v_i - dt sum_j m_j (kappa_i/rho_i + kappa_j/rho_j) grad W_ij */
STAGE void repel(const state *s, int i)
{
  const real own = s->change[i];
  vecs a = NO_VECS;
  for_neighbours (s, i, ij)
    a = add(a, scale(of(s->p.m, ij) * (own + of(s->change, ij)), gradW(&s->nb, ij)));
  s->p.v[i] = madd(s->p.v[i], -s->dt * light(&s->p, i), sum(a));
}
/* kappa_i = sum of its changes, and what that does to v_i */
STAGE void correct_density(const state *s, int i)
{
  s->push[i] += s->change[i];
  repel(s, i);
}
/* kappa^v_i = sum of its changes, and what that does to v_i */
STAGE void correct_divergence(const state *s, int i)
{
  s->push_v[i] += s->change[i];
  repel(s, i);
}

/* kappa_i = 0, its first change = what the last step needed */
STAGE void begin_density(const state *s, int i)
{
  s->change[i] = s->warm_density * s->push[i];
  s->push[i] = 0;
}
/* kappa^v_i = 0, its first change = what the last step needed */
STAGE void begin_divergence(const state *s, int i)
{
  s->change[i] = s->warm_divergence * s->push_v[i];
  s->push_v[i] = 0;
}

/* p_i = rho_i (kappa_i + kappa^v_i) */
STAGE void pressure(const state *s, int i)
{
  s->p.p[i] = sq(s->rho0 * (1 + s->excess[i])) * (s->push[i] + s->push_v[i]);
}

/* Is the solver done after k corrections? Counts the solve if so; gives the run up if its error is
 * not a number. */
static status judge(struct run *run, const state *s, const char *what, int k, double error,
                    int least, double tolerance, int *done)
{
  const int fixed = (int)s->fixed_iterations, most = fixed > 0 ? fixed : (int)s->max_iterations;
  const int reached = fixed > 0 ? k == fixed : k >= least && error <= tolerance;
  if (!(error >= 0)) return run_diverged(run, "the error of the %s solver is not a number", what);
  *done = reached || k >= most;
  if (*done) run_iterations(run, what, k, error, reached);
  return OK;
}

/* Alg. 3 */
static status solve_density(struct run *run, state *s)
{
  sweep(begin_density, s);
  if (s->warm_density > 0) sweep(correct_density, s);
  for (int k = 0, done = 0;; k++) {
    double error;
    sum_over(predict_density, s, s->p.n, &error);
    TRY(judge(run, s, "density", k, error / s->p.n, LEAST_DENSITY, (double)s->tolerance, &done));
    if (done) return OK;
    sweep(correct_density, s);
  }
}

/* Alg. 2. The tolerance is a relative change of density per step, or a part of the first error. */
static status solve_divergence(struct run *run, state *s, int relative)
{
  double tolerance = (double)s->divergence_tolerance;
  sweep(begin_divergence, s);
  if (s->warm_divergence > 0) sweep(correct_divergence, s);
  for (int k = 0, done = 0;; k++) {
    double error;
    sum_over(predict_divergence, s, s->p.n, &error);
    error /= s->p.n;
    if (k == 0 && relative) tolerance *= error;
    TRY(judge(run, s, "divergence", k, error, LEAST_DIVERGENCE, tolerance, &done));
    if (done) return OK;
    sweep(correct_divergence, s);
  }
}

/* Alg. 1 */
static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_forces(run));
  if (s->density_solver == (real)ON) TRY(solve_density(run, s));
  TRY(run_move(run));
  TRY(run_neighbours(run));
  sweep(factor, s);
  if (s->divergence_solver == (real)ON) TRY(solve_divergence(run, s, 0));
  sweep(pressure, s);
  return OK;
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  const double safety = s->clamp == (real)FREE ? 0.7 : 1.4;
  s->theta = s->relaxation > 0 ? s->relaxation
                               : (real)(safety / lattice_stiffest(&s->nb.kernel, (double)s->dx));
  sweep(forget, s);
  sweep_over(forget_change, s, s->p.n_all);
  TRY(run_neighbours(run));
  sweep(factor, s);
  return OK;
}

/* Beyond 2/theta_max an iteration makes the stiffest mode worse. */
static void warn(const void *self, double speed, char *text, size_t size)
{
  const state *s = (const state *)self;
  const double most = 2 / lattice_stiffest(&s->nb.kernel, (double)s->dx);
  (void)speed;
  if (s->clamp != (real)EACH && (double)s->theta > most)
    snprintf(text, size, "relaxation %g is beyond %.3g = 2/theta_max, where iterations diverge",
             (double)s->theta, most);
}

/* New particles have neither alpha nor a list yet. */
static status changed(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  sweep(factor, s);
  return OK;
}

/* The divergence solver alone: with clamp = free the projection of v onto Drho_i/Dt = 0. */
static status project(struct run *run, void *self)
{
  state *s = (state *)self;
  sweep(factor, s);
  TRY(solve_divergence(run, s, 1));
  sweep(pressure, s);
  return OK;
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_dfsph = {
  .abi = SOLVER_ABI,
  .name = "dfsph",
  .about = "Divergence-free SPH: a divergence and a constant-density solver, warm started",
  .paper = "J. Bender, D. Koschier, Divergence-Free SPH for Incompressible and Viscous Fluids, "
           "IEEE Trans. Vis. Comput. Graph. 23(3) (2017) 1193-1206",
  .doi = "10.1109/TVCG.2016.2578335",
  .differences = DIFFERENCES,
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(p),
  .can = CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) |
         CAN(PERIODIC) | CAN(PROJECT) | CAN(MOMENTUM) | CAN(ISOTROPIC) | CAN(VISCOSITY) |
         CAN(TENSION) | CAN(FLUIDS) | CAN(MOVING_WALLS) | CAN(BODIES) | CAN(EMITTERS),
  .params = params,
  .num_params = COUNT(params),
  .fields = fields,
  .num_fields = COUNT(fields),
  .state_size = sizeof(state),
  .start = start,
  .step = step,
  .changed = changed,
  .project = project,
  .max_dt = NULL,
  .uses = NULL,
  .stop = NULL,
  .warn = warn,
};
