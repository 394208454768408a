/* Implicit incompressible SPH.
 * M. Ihmsen, J. Cornelis, B. Solenthaler, C. Horvath, M. Teschner, IEEE Trans. Vis. Comput. Graph.
 * 20(3) (2014) 426-435, doi:10.1109/TVCG.2013.105. Equation and algorithm numbers are that paper's.
 *
 * Differences from the paper: see DIFFERENCES below.
 *
 * Two passes over the pairs per iteration: a^p_i from p, then (A p)_i from a^p. The paper's own two
 * passes, sum_j d_ij p_j and Eq. (13), add up the same numbers in another order, but read more of
 * them per pair. Here (A p)_i - (rho_0 - rho_adv_i) is also the error to stop by, and the a^p that
 * it was found from is the one that acts: no pass is left over after the last iteration.
 *
 * wall_pressure: own makes pressure forces the adjoint of Eq. (4), so that A is symmetric and a
 * resting tank loses energy; pressures at walls come out too large (hydrostatic error 1.6 in the
 * first steps). mirrored has better pressures (0.2 to 0.4), but is no adjoint: the same tank's
 * motion grows, at any tolerance and dt (0.4 sqrt(g H) after 1 s against 0.04; free diverges). */
#include "../core/solver.h"
#include "../core/sph/lattice.h"
#include <stdio.h>
#include <string.h>

#define DIFFERENCES                                                                                \
  "iteration: in the form p += omega/a_ii (rho_0 - rho_adv - A p) with A p from accelerations "    \
  "(Koschier et al. 2019, Eurographics tutorial on SPH), which is Eq. (13)\n"                      \
  "stopping: before an update, by the mean compression that is left with the pressures that act; " \
  "the paper looks at those before the last update\n"                                              \
  "relaxation: omega is by default 0.5 as in the paper, but at most 1.4/theta_max (0.7/theta_max " \
  "if clamp = free), theta_max the largest eigenvalue of A over its diagonal on a lattice; "       \
  "beyond 2/theta_max the iteration diverges\n"                                                    \
  "clamp: free lets p < 0 hold density where it is below rho_0, but never raise it, so that "      \
  "surfaces do not contract\n"                                                                     \
  "walls: own is the paper's, p_i/rho_i^2 alone; mirrored adds p_i/rho_0^2 for the wall\n"         \
  "warm start: from a part of the last p/rho^2, the paper's from a part of p\n"                    \
  "isolated particles: p = 0 where -a_ii rho_i^2/dt^2 < 1e-6 (rho_0/R)^2"

enum { CLAMPED, FREE };
enum { OWN, MIRRORED };
enum { LEAST_ITERATIONS = 2 };

#define PARAMS(P)                                                                                \
  P(tolerance, 1e-3, 0, 1, "1", "mean relative compression at which to stop")                    \
  P(max_iterations, 100, 1, 1e6, WHOLE, "largest number of iterations")                          \
  P(fixed_iterations, 0, 0, 1e6, WHOLE,                                                          \
    "number of iterations, whatever the error; 0: by tolerance")                                 \
  P(relaxation, 0, 0, 2, "1", "omega of the Jacobi iteration; 0: 0.5 or what the lattice bears") \
  P(clamp, CLAMPED, 0, 1, "clamped|free", "pressures that only repel, or also attract")          \
  P(warm, 0.5, 0, 1, "1", "part of the last pressure to start from")                             \
  P(wall_pressure, OWN, 0, 1, "own|mirrored",                                                    \
    "walls push with p_i alone, or with p_b = p_i as well")

#define FIELDS(F)                                                                                  \
  F(real, push, ALL, KEPT, "m^5/(kg s^2)", "p_i/rho_i^2, 0 on walls")                              \
  F(real, advected, FLUID, STEP, "1", "rho^adv_i/rho_0 - 1")                                       \
  F(real, error, FLUID, STEP, "1", "density predicted with the pressures of now, over rho_0, - 1") \
  F(real, gain, FLUID, STEP, "m^5/(kg s^2)", "change of push that takes away an error of 1")       \
  F(vec, accel, ALL, STEP, "m/s^2", "acceleration a^p_i by pressure, 0 on walls")                  \
  F(vec, wall, FLUID, STEP, "kg/m^(d+1)", "sum of m_b grad W_ib over walls")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real omega; /* relaxation in force */
} state;

/* p_i = 0 at the start; neither pressure nor acceleration of walls, for good */
STAGE void forget(const state *s, int i)
{
  s->push[i] = 0;
  s->accel[i] = zero();
}

/* rho_i = sum_j m_j W_ij
 * Eq. (4)   rho^adv_i = rho_i + dt sum_j m_j (v*_i - v*_j) . grad W_ij
 * Eq. (9)   d_ii = -dt^2 sum_j m_j/rho_i^2 grad W_ij,   d_ji = dt^2 m_i/rho_i^2 grad W_ij
 * Eq. (12)  a_ii = sum_j m_j (d_ii - d_ji) . grad W_ij; d_ii over walls too, with
 *           m_b (1/rho_i^2 + 1/rho_0^2) grad W_ib if mirrored, and Eq. (16) d_bi = 0
 * With light_i of constraint.h, -a_ii rho_i^2/dt^2 = light_i G . (G + (rho_i/rho_0)^2 G_walls)
 *           + sum_fluid light_j |m_j grad W_ij|^2,   G = sum_j m_j grad W_ij. */
STAGE void predict(const state *s, int i)
{
  const struct particles p = s->p;
  lanes rho = NO_LANES, rate = NO_LANES, others = NO_LANES;
  vecs all = NO_VECS, walls = NO_VECS;
  for_neighbours (s, i, ij) {
    const lanes m = of(p.m, ij);
    const vecs g = scale(m, gradW(&s->nb, ij));
    rho += m * W(&s->nb, ij);
    rate += dot(diff(p.v, ij), g);
    all = add(all, g);
    others += light_of(&p, ij) * dot(g, g);
    if (s->wall) walls = add(walls, scale(1 - only_below(ij, p.n, 1 + NO_LANES), g));
  }
  const real density = sum(rho), ratio2 = sq(density / s->rho0);
  const vec G = sum(all), G_walls = sum(walls);
  const real yield = light(&p, i) * inner(G, madd(G, ratio2, G_walls)) + sum(others);
  const real least = (real)1e-6 * sq(s->rho0 * s->nb.kernel.inv_R);
  p.rho[i] = density;
  s->advected[i] = (density - s->rho0 + s->dt * sum(rate)) / s->rho0;
  s->gain[i] = yield > least ? s->omega * s->rho0 / (sq(s->dt) * yield) : 0;
  if (s->wall) s->wall[i] = times(ratio2, G_walls);
}

/* Alg. 1   p^0_i = 0.5 p_i(t - dt) */
STAGE void begin(const state *s, int i) { s->push[i] *= s->warm; }

/* Eq. (9)   a^p_i = (d_ii p_i + sum_j d_ij p_j)/dt^2
 *                 = -sum_j m_j (p_i/rho_i^2 + p_j/rho_j^2) grad W_ij,   walls: see predict */
STAGE void accelerate(const state *s, int i)
{
  const real own = s->push[i];
  vecs a = NO_VECS;
  for_neighbours (s, i, ij)
    a = add(a, scale(of(s->p.m, ij) * (own + of(s->push, ij)), gradW(&s->nb, ij)));
  vec force = sum(a);
  if (s->wall) force = madd(force, own, s->wall[i]);
  s->accel[i] = times(-light(&s->p, i), force);
}

/* Eq. (5)   (A p)_i = dt^2 sum_j m_j (a^p_i - a^p_j) . grad W_ij,
 *           error = (rho^adv_i + (A p)_i)/rho_0 - 1; returns what counts of it. */
STAGE real compression(const state *s, int i)
{
  lanes rate = NO_LANES;
  for_neighbours (s, i, ij) rate += of(s->p.m, ij) * dot(diff(s->accel, ij), gradW(&s->nb, ij));
  const real error = s->advected[i] + sq(s->dt) / s->rho0 * sum(rate);
  s->error[i] = error;
  return larger(error, 0);
}

/* Eq. (13)  p_i = max(0, p_i + omega (rho_0 - rho^adv_i - (A p)_i) / a_ii)
 *           free: and, where that is 0, min(0, the same against min(rho_0, rho_i) for rho_0) */
STAGE void update(const state *s, int i)
{
  const real before = s->push[i], gain = s->gain[i];
  const real lacked = larger(1 - s->p.rho[i] / s->rho0, 0);
  real push = larger(before + gain * s->error[i], 0);
  if (s->clamp == (real)FREE) push += smaller(before + gain * (s->error[i] + lacked), 0);
  s->push[i] = gain > 0 ? push : 0;
}

/* Alg. 1   v_i = v*_i + dt a^p_i;   and p_i for the record */
STAGE void finish(const state *s, int i)
{
  s->p.v[i] = madd(s->p.v[i], s->dt, s->accel[i]);
  s->p.p[i] = s->push[i] * sq(s->p.rho[i]);
}

/* Alg. 1, PRESSURE SOLVE */
static status solve(struct run *run, state *s)
{
  const int fixed = (int)s->fixed_iterations, most = fixed > 0 ? fixed : (int)s->max_iterations;
  sweep(begin, s);
  for (int k = 0;; k++) {
    double error;
    sweep(accelerate, s);
    sum_over(compression, s, s->p.n, &error);
    error /= s->p.n;
    if (!(error >= 0)) return run_diverged(run, "the predicted density is not a number");
    const int enough = k >= LEAST_ITERATIONS && error <= (double)s->tolerance;
    const int reached = fixed > 0 ? k == fixed : enough;
    if (reached || k >= most) {
      run_iterations(run, "density", k, error, reached);
      return OK;
    }
    sweep(update, s);
  }
}

/* Alg. 1; the positions move last, so the densities are those where the pairs were found */
static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_neighbours(run));
  TRY(run_forces(run));
  sweep(predict, s);
  TRY(solve(run, s));
  sweep(finish, s);
  return run_move(run);
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  const double safety = s->clamp == (real)FREE ? 0.7 : 1.4;
  const double bearable = safety / lattice_stiffest(&s->nb.kernel, (double)s->dx);
  (void)run;
  s->omega = s->relaxation > 0 ? s->relaxation : (real)(bearable < 0.5 ? bearable : 0.5);
  sweep_over(forget, s, s->p.n_all);
  return OK;
}

/* Beyond 2/theta_max an iteration makes the stiffest mode worse. */
static void warn(const void *self, double speed, char *text, size_t size)
{
  const state *s = (const state *)self;
  const double most = 2 / lattice_stiffest(&s->nb.kernel, (double)s->dx);
  (void)speed;
  if ((double)s->omega > most)
    snprintf(text, size, "relaxation %g is beyond %.3g = 2/theta_max, where iterations diverge",
             (double)s->omega, most);
}

static int mirrors(const void *self)
{
  return ((const state *)self)->wall_pressure == (real)MIRRORED;
}

static int uses(const void *self, const char *field)
{
  const state *s = (const state *)self;
  return strcmp(field, "wall") != 0 || (s->p.n_all > s->p.n && mirrors(s));
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_iisph = {
  .abi = SOLVER_ABI,
  .name = "iisph",
  .about = "Implicit incompressible SPH: relaxed Jacobi iterations on the pressure equation",
  .paper = "M. Ihmsen, J. Cornelis, B. Solenthaler, C. Horvath, M. Teschner, Implicit "
           "Incompressible SPH, IEEE Trans. Vis. Comput. Graph. 20(3) (2014) 426-435",
  .doi = "10.1109/TVCG.2013.105",
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
  .mirrors = mirrors,
};
