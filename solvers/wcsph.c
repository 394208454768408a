/* Weakly compressible SPH: pressure by Tait's equation of state, explicit in time.
 * J. J. Monaghan, J. Comput. Phys. 110(2) (1994) 399-406, doi:10.1006/jcph.1994.1034
 * M. Becker, M. Teschner, Proc. Symp. Computer Animation (2007) 209-218,
 * doi:10.2312/SCA/SCA07/209-218.
 *
 * Differences from the papers: see DIFFERENCES below.
 *
 * Time step: symplectic Euler is stable while dt w < 2, w the frequency of the fastest sound wave:
 * on a lattice of rest density up to dt = 1.5 .. 2.8 h/c (h = R/2, supports of 2 to 3 dx). cfl =
 * 0.4 leaves room for what compression adds to c and disorder to w.
 *
 * Energy: with the summed density, walls without pressure and alpha = 0 the forces are the gradient
 * of sum_i m_i u(rho_i), du/drho = p/rho^2, whose drift is that of the time step. Mirrored
 * pressures push walls twice for what they add to rho_i: no energy has that gradient, and water at
 * rest in a tank heats up (default tank, 1 s: total energy about 1200 J with them, -1 J without,
 * whatever the substep). */
#include "../core/solver.h"
#include "../core/sph/lattice.h"
#include <stdio.h>
#include <string.h>

#define DIFFERENCES                                                                                \
  "density: summed, rho_i = sum_j m_j W_ij, or by the continuity equation, which Monaghan takes\n" \
  "clamp: p >= 0 where the density is summed, since it falls at every free surface, and p is "     \
  "free where it is carried by the continuity equation\n"                                          \
  "time: symplectic Euler in as many equal substeps of a step as the speed of sound asks\n"        \
  "speed of sound: 10 times the largest speed that the energy of the start allows, falling to "    \
  "the lowest particle; relative to the fluid's mean velocity; raised when particles come in\n"    \
  "pressure: reported as its mean over the substeps\n"                                             \
  "walls: particles of mass m, in the density, without pressure, or with their neighbour's; "      \
  "Monaghan repels by forces along the distance\n"                                                 \
  "artificial viscosity: between fluid particles only (walls are free slip)\n"                     \
  "XSPH: the scene's, which changes velocities; a substep has its part of the coefficient\n"       \
  "several fluids: of equal bulk modulus, so that the speed of sound is c sqrt(light_i)\n"         \
  "no surface tension"

enum { SUMMED, CONTINUITY };
enum { BY_DENSITY, CLAMPED, FREE };
enum { NONE, MIRRORED };

#define PARAMS(P)                                                                                \
  P(c, 0, 0, 1e6, "m/s", "speed of sound; 0: 10 times the largest speed that the energy allows") \
  P(gamma, 7, 1, 20, "1", "exponent of Tait's equation")                                         \
  P(density, SUMMED, 0, 1, "summed|continuity", "density as a sum, or by its rate of change")    \
  P(clamp, BY_DENSITY, 0, 2, "auto|clamped|free", "p >= 0, or any; auto: free by continuity")    \
  P(alpha, 0.01, 0, 10, "1", "Monaghan's artificial viscosity; 0: none")                         \
  P(wall_pressure, NONE, 0, 1, "none|mirrored", "pressure of a wall: none, or its neighbour's")  \
  P(max_substeps, 10000, 1, 1e9, "1", "substeps of a step beyond which the run is given up")     \
  P(cfl, 0.4, 1e-3, 2, "1", "largest substep over h/c, h = R/2")

#define FIELDS(F)                                                                          \
  F(real, excess, FLUID, KEPT, "1", "rho_i/rho_0 - 1, carried by the continuity equation") \
  F(real, mean, FLUID, KEPT, "Pa", "p_i, averaged over the substeps so far")               \
  F(vec, change, FLUID, STEP, "m/s", "change of velocity in this substep")                 \
  F(real, push, ALL, STEP, "m^5/(kg s^2)", "p_i/rho_i^2, 0 on walls")                      \
  F(real, dense, ALL, STEP, "kg/m^d", "rho_i as artificial viscosity reads it, 0 on walls")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real lightest, heaviest; /* largest of light_i and of 1/light_i */
  int chosen;              /* is c chosen by the energy? */
  vec drift;               /* mean velocity of the fluid at the start [m/s] */
  real deepest;            /* largest g.x of all particles at the start [m^2/s^2] */
  int axis;                /* of the mean being taken */
  real part;               /* of the step that a substep is */
} state;

/* --- the speed of sound */

/* 1 where the scene has one fluid */
STAGE real lightness(const state *s, int i) { return light(&s->p, i); }
STAGE real heaviness(const state *s, int i) { return 1 / light(&s->p, i); }
STAGE real velocity(const state *s, int i) { return s->p.v[i].c[s->axis]; }
STAGE real depth(const state *s, int i) { return inner(s->gravity, s->p.x[i]); }

/* u_i^2/light_i,   u_i^2 = |v_i - <v>|^2 + 2 g.(x_deepest - x_i): the largest speed that the energy
 * of particle i allows, and what pressure its fluid makes of that */
STAGE real energy(const state *s, int i)
{
  const vec v = sub(s->p.v[i], s->drift);
  return (inner(v, v) + 2 * (s->deepest - depth(s, i))) / light(&s->p, i);
}
/* |v_i - <v>|^2 of a wall, in the heaviest fluid */
STAGE real wall_energy(const state *s, int k)
{
  const vec v = sub(s->p.v[s->p.n + k], s->drift);
  return inner(v, v) * s->heaviest;
}

static void find_drift(state *s)
{
  s->drift = zero();
  for (s->axis = 0; s->axis < DIM; s->axis++) {
    double total;
    sum_over(velocity, s, s->p.n, &total);
    s->drift.c[s->axis] = (real)(total / (s->p.n > 0 ? s->p.n : 1));
  }
}

/* The speed that no particle will exceed, by its energy [m/s]: what it has, what gravity can give,
 * and what surface tension gives to the smallest drop, p = sigma/dx = rho0 v^2/2. */
static double fastest_speed(state *s)
{
  double most, of_walls = 0;
  find_drift(s);
  largest_over(depth, s, s->p.n_all, &most);
  s->deepest = (real)most;
  largest_over(energy, s, s->p.n, &most);
  if (s->p.n_all > s->p.n) largest_over(wall_energy, s, s->p.n_all - s->p.n, &of_walls);
  const double of_drops = 2 * (double)(s->sigma / (s->rho0 * s->dx));
  return sqrt(fmax(fmax(most, of_walls), 0) + of_drops);
}

/* The longest substep [s]: cfl h/(c (1 + 0.6 alpha)), Monaghan 1992, Annu. Rev. Astron. Astrophys.
 * 30, 543, of the fluid with the fastest sound. */
static double max_dt(const void *self)
{
  const state *s = (const state *)self;
  const double h = (double)s->nb.kernel.R / 2, c = (double)s->c * sqrt((double)s->lightest);
  return c > 0 ? (double)s->cfl * h / (c * (1 + 0.6 * (double)s->alpha)) : HUGE_VAL;
}

/* Symplectic Euler is stable while dt w < 2, of sound on a lattice of rest density
 *   w^2 = (c m/rho_0)^2 |sum_j sin(k.x_ij) grad W_ij|^2. */
static double stable_dt(const state *s)
{
  const struct kernel *kernel = &s->nb.kernel;
  const double dx = (double)s->dx, c = (double)s->c * sqrt((double)s->lightest);
  const double stiffest = lattice_stiffest(kernel, dx) * lattice_spread(kernel, dx);
  return 2 * (double)s->rho0 / (c * (double)s->mass * sqrt(stiffest));
}

/* Substeps that are too many or too long, and a fluid that its own speed compresses: density varies
 * by (speed/c)^2/2. */
static void warn(const void *self, double speed, char *text, size_t size)
{
  const state *s = (const state *)self;
  const double dt = (double)s->dt, c = (double)s->c, substeps = ceil(dt / max_dt(s));
  if (substeps > (double)s->max_substeps)
    snprintf(text, size, "a step needs %.3g acoustic substeps, more than max_substeps = %g",
             substeps, (double)s->max_substeps);
  else if (fmin(dt, max_dt(s)) > stable_dt(s))
    snprintf(text, size, "cfl %g makes substeps of %.3g s, sound on a lattice is stable up to %.3g",
             (double)s->cfl, max_dt(s), stable_dt(s));
  else if (c < 3 * speed)
    snprintf(text, size,
             "sound at c = %g m/s is not fast beside the fluid's %.3g m/s: its density "
             "will vary by some %.2g %%",
             c, speed, 50 * pow(speed / c, 2));
}

/* --- a substep */

/* Monaghan 1994   rho_i += dt sum_j m_j (v_i - v_j).grad W_ij, with the velocities of the move */
STAGE void carry_density(const state *s, int i)
{
  lanes rate = NO_LANES;
  for_neighbours (s, i, ij) rate += of(s->p.m, ij) * dot(diff(s->p.v, ij), gradW(&s->nb, ij));
  s->excess[i] += s->dt / s->rho0 * sum(rate);
}

/* Tait   p_i = B ((rho_i/rho_0)^gamma - 1),   B = rho_0 c^2/gamma, exact where rho_i ~ rho_0 */
STAGE real tait(const state *s, real excess)
{
  const real p = s->rho0 * sq(s->c) / s->gamma * expm1(s->gamma * log1p(excess));
  return s->clamp == (real)CLAMPED ? larger(p, 0) : p;
}
/* p_i = Tait(rho_i),   p_i/rho_i^2, and p_i's part of the mean */
STAGE void pressure(const state *s, int i)
{
  const int summed = s->density == (real)SUMMED;
  const real excess = summed ? (s->p.rho[i] - s->rho0) / s->rho0 : s->excess[i];
  const real rho = s->rho0 * (1 + excess);
  s->p.rho[i] = rho;
  s->p.p[i] = tait(s, excess);
  s->mean[i] += s->part * s->p.p[i];
  s->push[i] = s->p.p[i] / sq(rho);
  if (s->dense) s->dense[i] = rho;
}

/* p_j/rho_j^2; at walls 0, or p_i/rho_i^2 */
STAGE lanes push_of(const state *s, struct packet ij)
{
  const lanes push = of(s->push, ij);
  if (s->wall_pressure == (real)NONE || s->p.n_all == s->p.n) return push;
  return push + s->push[ij.i] * (1 - only_below(ij, s->p.n, 1 + NO_LANES));
}

/* Monaghan 1992   Pi_ij = -alpha c/rho_ij mu_ij,   rho_ij = (rho_i + rho_j)/2,
 *                 mu_ij = h v_ij.x_ij/(x_ij^2 + 0.01 h^2) where that is < 0, else 0
 * Of several fluids c/rho_ij = 2c/(rho_i sqrt(light_j) + rho_j sqrt(light_i)), the harmonic mean of
 * their impedances. */
STAGE lanes viscous(const state *s, struct packet ij)
{
  const real h = s->nb.kernel.R / 2, sqrt_light = sqrt(light(&s->p, ij.i));
  const lanes approach = at_most(dot(diff(s->p.v, ij), ij.x), 0);
  const lanes mu = h * approach / (ij.r * ij.r + (real)0.01 * sq(h));
  const lanes dense = s->dense[ij.i] * root(light_of(&s->p, ij)) + sqrt_light * of(s->dense, ij);
  return only_below(ij, s->p.n, -2 * s->alpha * s->c * mu / dense);
}

/* Monaghan 1994   dv_i = -dt light_i sum_j m_j (p_i/rho_i^2 + p_j/rho_j^2 + Pi_ij) grad W_ij */
STAGE void accelerate(const state *s, int i)
{
  const real own = s->push[i];
  vecs a = NO_VECS;
  for_neighbours (s, i, ij) {
    lanes push = own + push_of(s, ij);
    if (s->alpha > 0) push += viscous(s, ij);
    a = add(a, scale(of(s->p.m, ij) * push, gradW(&s->nb, ij)));
  }
  s->change[i] = times(-s->dt * light(&s->p, i), sum(a));
}
STAGE void kick(const state *s, int i) { s->p.v[i] = plus(s->p.v[i], s->change[i]); }

static status substep(struct run *run, state *s)
{
  TRY(run_move(run));
  TRY(run_neighbours(run));
  if (s->density == (real)CONTINUITY) sweep(carry_density, s);
  TRY(run_forces(run));
  if (s->density == (real)SUMMED) TRY(run_density(run));
  sweep(pressure, s);
  sweep(accelerate, s);
  sweep(kick, s);
  s->time += s->dt;
  return OK;
}

/* --- a step */

/* no substeps so far */
STAGE void no_mean(const state *s, int i) { s->mean[i] = 0; }
/* p_i = its mean over the substeps, whose impulse acted. Returns max(rho_i/rho_0 - 1, 0) */
STAGE real conclude(const state *s, int i)
{
  s->p.p[i] = s->mean[i];
  return larger(s->p.rho[i] / s->rho0 - 1, 0);
}

static status substeps(struct run *run, state *s, int n)
{
  const real dt = s->dt;
  status result = OK;
  s->part = 1 / (real)n;
  s->dt = dt * s->part;
  for (int k = 0; k < n && result == OK; k++) result = substep(run, s);
  s->dt = dt;
  return result;
}

static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  const double wanted = fmax(ceil((double)s->dt / max_dt(s)), 1);
  double error;
  if (!(wanted <= (double)s->max_substeps))
    return run_diverged(run, "a step of %g s needs %.3g acoustic substeps, more than max_substeps",
                        (double)s->dt, wanted);
  const int n = (int)wanted;
  sweep(no_mean, s);
  TRY(substeps(run, s, n));
  sum_over(conclude, s, s->p.n, &error);
  if (!(error >= 0)) return run_diverged(run, "the density is not a number");
  run_iterations(run, "substeps", n, s->p.n > 0 ? error / s->p.n : 0, 1);
  return OK;
}

/* rho_i = rho_0 */
STAGE void full(const state *s, int i) { s->excess[i] = 0; }
/* p = rho = 0 on walls, for good */
STAGE void no_push(const state *s, int i)
{
  s->push[i] = 0;
  if (s->dense) s->dense[i] = 0;
}

/* The speed of sound for the particles that are there now. */
static status changed(struct run *run, void *self)
{
  state *s = (state *)self;
  double lightest, heaviest;
  (void)run;
  if (s->p.n == 0) return OK;
  largest_over(lightness, s, s->p.n, &lightest);
  largest_over(heaviness, s, s->p.n, &heaviest);
  s->lightest = (real)lightest;
  s->heaviest = (real)heaviest;
  if (s->chosen) s->c = larger(s->c, (real)(10 * fastest_speed(s)));
  return OK;
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  s->lightest = s->heaviest = 1;
  s->chosen = !(s->c > 0);
  if (s->clamp == (real)BY_DENSITY) s->clamp = s->density == (real)SUMMED ? CLAMPED : FREE;
  sweep_over(no_push, s, s->p.n_all);
  if (s->excess) sweep(full, s);
  return changed(run, self);
}

static int uses(const void *self, const char *field)
{
  const state *s = (const state *)self;
  if (strcmp(field, "excess") == 0) return s->density == (real)CONTINUITY;
  if (strcmp(field, "dense") == 0) return s->alpha > 0;
  return 1;
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_wcsph = {
  .abi = SOLVER_ABI,
  .name = "wcsph",
  .about = "Weakly compressible SPH: Tait's equation of state, explicit in acoustic substeps",
  .paper = "J. J. Monaghan, Simulating Free Surface Flows with SPH, J. Comput. Phys. 110(2) (1994) "
           "399-406; M. Becker, M. Teschner, Weakly compressible SPH for free surface flows, "
           "ACM SIGGRAPH/Eurographics Symp. Computer Animation (2007) 209-218, "
           "doi:10.2312/SCA/SCA07/209-218",
  .doi = "10.1006/jcph.1994.1034",
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
  .changed = changed,
  .project = NULL,
  .max_dt = max_dt,
  .uses = uses,
  .stop = NULL,
  .warn = warn,
};
