/* Position Based Fluids.
 * M. Macklin, M. Mueller, ACM Trans. Graph. 32(4) (2013) 104, doi:10.1145/2461912.2461984. Equation
 * and algorithm numbers are that paper's.
 *
 * Differences from the paper: see DIFFERENCES below.
 *
 * epsilon: the Jacobi iteration multiplies its stiffest mode by 1 - theta g/(g + epsilon), where
 * g = |grad C|^2 = 0.07 .. 0.5 /dx^2 and theta = 2.1 .. 7.5 on a lattice (sph/lattice.h; larger
 * supports have less g and more theta). 0.4/dx^2 makes that -0.45 at worst for supports of 2 to 3
 * dx; 0 makes it -1.1 .. -6.5. */
#include "../core/solver.h"
#include "../core/sph/lattice.h"
#include <stdio.h>

#define DIFFERENCES                                                                              \
  "masses: rho_i = sum_j m_j W_ij and m_j in every gradient; the paper sets m = 1\n"             \
  "epsilon: in units of 1/dx^2, with a default that keeps the iteration stable at any support\n" \
  "kernels: one kernel for W and grad W, the scene's; the paper takes poly6 and spiky\n"         \
  "clamp: lambda <= 0 by default; the paper lets surfaces attract and repels by s_corr\n"        \
  "s_corr: off by default; k in units of dx^2, dq in units of the support\n"                     \
  "velocity: v += dx/dt in every iteration, which is (x* - x)/dt without its cancellation\n"     \
  "walls: particles of mass m that do not move, lambda = 0; the paper detects collisions\n"      \
  "pressure: p_i = -rho0 sum lambda_i / dt^2 over the iterations, since then "                   \
  "dx_i = -dt^2 sum_j m_j (p_i + p_j)/rho0^2 grad W_ij; the paper has none\n"                    \
  "stopping: also by the mean compression; the residual is that after the last correction\n"     \
  "no vorticity confinement"

enum { CLAMPED, FREE };

#define PARAMS(P)                                                                          \
  P(tolerance, 1e-3, 0, 1, "1", "mean relative compression at which to stop")              \
  P(max_iterations, 100, 1, 1e6, WHOLE, "largest number of iterations")                    \
  P(fixed_iterations, 0, 0, 1e6, WHOLE,                                                    \
    "number of iterations, whatever the error; 0: by tolerance")                           \
  P(epsilon, 0.4, 0, 1e6, "1/dx^2", "relaxation epsilon of Eq. (11)")                      \
  P(clamp, CLAMPED, 0, 1, "clamped|free", "multipliers that only repel, or also attract")  \
  P(scorr_k, 0, 0, 10, "dx^2", "strength k of the artificial pressure, Eq. (13); 0: none") \
  P(scorr_n, 4, 1, 16, WHOLE, "its exponent n, an integer")                                \
  P(scorr_dq, 0.2, 0, 0.9, "R", "its reference distance dq")

#define FIELDS(F)                                                                                \
  F(real, lambda, ALL, STEP, "m^2", "multiplier lambda_i of the density constraint, 0 on walls") \
  F(vec, shift, FLUID, STEP, "m", "position change of this iteration")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real scorr_W; /* W(dq) [1/m^d] */
} state;

/* lambda_i = 0, for walls for good */
STAGE void no_multiplier(const state *s, int i) { s->lambda[i] = 0; }

/* p_i = 0 before the iterations */
STAGE void no_pressure(const state *s, int i) { s->p.p[i] = 0; }

/* Eq. (1), (2)   C_i = rho_i/rho_0 - 1,   rho_i = sum_j m_j W_ij
 * Eq. (7), (8)   grad_k C_i = 1/rho_0 { sum_j m_j grad W_ij for k = i;  -m_k grad W_ik for k != i,
 *                                      0 for walls }
 * Eq. (11)       lambda_i = -C_i / (sum_k |grad_k C_i|^2 + epsilon) */
STAGE real multiplier(const state *s, int i)
{
  const struct constraint c = constraint_at(&s->p, &s->nb, i);
  const real C = (c.rho - s->rho0) / s->rho0;
  const real lambda = -C / (c.yield / sq(s->rho0) + s->epsilon / sq(s->dx));
  s->p.rho[i] = c.rho;
  s->lambda[i] = s->clamp == (real)CLAMPED ? smaller(lambda, 0) : lambda;
  return larger(C, 0);
}

/* Eq. (13)   s_corr = -k (W_ij / W(dq))^n */
STAGE lanes artificial_pressure(const state *s, struct packet ij)
{
  const lanes ratio = W(&s->nb, ij) / s->scorr_W;
  lanes power = ratio;
  for (int k = 1; k < (int)s->scorr_n; k++) power = power * ratio;
  return -s->scorr_k * sq(s->dx) * power;
}

/* Eq. (12), (14)   dx_i = 1/rho_0 sum_j m_j (lambda_i + lambda_j + s_corr) grad W_ij */
STAGE void correct(const state *s, int i)
{
  const struct particles p = s->p;
  vecs shift = NO_VECS;
  for_neighbours (s, i, ij) {
    lanes strength = s->lambda[i] + of(s->lambda, ij);
    if (s->scorr_k > 0) strength += artificial_pressure(s, ij);
    shift = add(shift, scale(of(p.m, ij) * strength, gradW(&s->nb, ij)));
  }
  s->shift[i] = times(light(&p, i) / s->rho0, sum(shift));
}

/* Alg. 1, lines 17 and 21   x*_i = x*_i + dx_i,   v_i = (x*_i - x_i)/dt */
STAGE void displace(const state *s, int i)
{
  const struct particles p = s->p;
  p.x[i] = plus(p.x[i], s->shift[i]);
  p.v[i] = madd(p.v[i], 1 / s->dt, s->shift[i]);
  p.p[i] -= s->rho0 * s->lambda[i] / sq(s->dt);
}

/* Alg. 1, lines 8-19 */
static status keep_density(struct run *run, state *s)
{
  const int fixed = (int)s->fixed_iterations, most = fixed > 0 ? fixed : (int)s->max_iterations;
  const double tolerance = fixed > 0 ? -1 : (double)s->tolerance;
  sweep(no_pressure, s);
  for (int k = 0;; k++) {
    double error;
    sum_over(multiplier, s, s->p.n, &error);
    error /= s->p.n;
    if (!(error >= 0)) return run_diverged(run, "the density is not a number");
    if (k == most || error <= tolerance) {
      run_iterations(run, "density", k, error, fixed > 0 || error <= tolerance);
      return OK;
    }
    sweep(correct, s);
    sweep(displace, s);
  }
}

/* Alg. 1 */
static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_gravity(run)); /* line 2   v_i = v_i + dt f_ext */
  TRY(run_move(run));
  TRY(run_neighbours(run));
  TRY(keep_density(run, s));
  return run_viscosity(run); /* Eq. (17) */
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  s->scorr_W = kernel_W(&s->nb.kernel, s->scorr_dq * s->nb.kernel.R, DIM);
  sweep_over(no_multiplier, s, s->p.n_all);
  return OK;
}

/* An iteration multiplies the stiffest mode by 1 - theta_max g/(g + epsilon), g = |grad C|^2. */
static void warn(const void *self, double speed, char *text, size_t size)
{
  const state *s = (const state *)self;
  const double dx = (double)s->dx, m = (double)(s->mass / s->rho0), epsilon = (double)s->epsilon;
  const double g = m * m * dx * dx * lattice_spread(&s->nb.kernel, dx);
  const double least = g * (lattice_stiffest(&s->nb.kernel, dx) / 2 - 1);
  (void)speed;
  if (epsilon < least)
    snprintf(text, size,
             "epsilon %g is less than %.3g, with which iterations overshoot more than "
             "they correct",
             epsilon, least);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_pbf = {
  .abi = SOLVER_ABI,
  .name = "pbf",
  .about = "Position Based Fluids: Jacobi iterations on density constraints of the positions",
  .paper = "M. Macklin, M. Mueller, Position Based Fluids, ACM Trans. Graph. 32(4) (2013) 104",
  .doi = "10.1145/2461912.2461984",
  .differences = DIFFERENCES,
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(p),
  .can = CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) |
         CAN(PERIODIC) | CAN(MOMENTUM) | CAN(ISOTROPIC) | CAN(VISCOSITY) | CAN(TENSION) |
         CAN(FLUIDS) | CAN(MOVING_WALLS) | CAN(BODIES) | CAN(EMITTERS),
  .params = params,
  .num_params = COUNT(params),
  .fields = fields,
  .num_fields = COUNT(fields),
  .state_size = sizeof(state),
  .start = start,
  .step = step,
  .project = NULL,
  .max_dt = NULL,
  .uses = NULL,
  .stop = NULL,
  .warn = warn,
};
