/* Projection of the velocity by its Helmholtz decomposition.
 * "Helmholtz decomposition-based SPH", Virtual Reality & Intelligent Hardware 3(2) (2021) 118-128,
 * doi:10.1016/j.vrih.2021.01.003. Equation numbers are that paper's.
 *
 * Differences from the paper: see DIFFERENCES below.
 *
 * eta: the paper's 0.01 R^2 makes the Laplacian of a lattice 4 to 5 % too small (R = 2.5 dx), so
 * pressures do not converge to the exact ones. First step of the rotating square, errors of p at
 * dx .01, .005, .0025: .151, .064, .024, then .023; eta = 0: .180, .094, .048.
 *
 * surface: with lifted those errors are .239, .135, .086 (eta = 0: .195, .094, .046), and .78
 * (zero: .14) where particles are displaced by 0.1 dx, since there the lifted diagonal acts inside,
 * too. In 3-D tanks and dam breaks blow up with lifted, not with zero; a square patch in tension
 * blows up at 0.25 s with zero, with lifted it lives for 2 s.
 *
 * wall_velocity: with own the divergence sees half of the flow into a wall. Errors of a dam break's
 * pressure at t = 0, dx .02, .01, .005: .44, .46, .47; mirrored: .136, .087, .063 (both lifted;
 * with zero .053, .025, .027). mirrored is also the adjoint of p_b = p_i.
 *
 * It carries no bodies: the run pushes them by p_i alone, and fluid is pushed by p_b = p_i as well.
 *
 * kappa: a tank's density is off by 2.8 % after 1 s without it, by 0.03 % with. The equation of
 * state does not replace it (2.4 %): the projection takes away what it resolves of it. */
#include "../core/linear/cg.h"
#include "../core/solver.h"

#define DIFFERENCES                                                                                \
  "system: in the inner product weighted by V_i, where it is symmetric at any density, with "      \
  "Jacobi's preconditioner; the paper asks for uniform density\n"                                  \
  "surface: the paper says nothing and its sums put no condition there (printed: the system is "   \
  "singular); lifted lets the part that a full lattice's diagonal has in excess go to phi = 0 "    \
  "(Nair & Tomar 2014); zero puts phi = 0 where the density is nearer to that of the outermost "   \
  "layer of a half lattice than to rho_0, and lets diagonals fall short by no more than that\n"    \
  "walls: phi_b = phi_i in the Laplacian, p_b = p_i and rho_b = rho_0 in the gradient, and the "   \
  "velocity 2 v_b - v_i in div v* (wall_velocity = own: v_b)\n"                                    \
  "diagonal: at least that of the divergence of the gradient, as the two sums compose: a "         \
  "particle with nothing but walls about it would have none, and be thrown back too fast\n"        \
  "gradient: rho_0 in place of the factor rho_i of its gradient, so that momentum is kept\n"       \
  "kappa: a step also aims at taking that part of the excess density away; without gravity none\n" \
  "order: positions move first, with the projected velocity\n"                                     \
  "stopping: by the mean compression of a step that the residual means, as IISPH and DFSPH (the "  \
  "paper does not say how its bound is measured), and by a part of the first residual "            \
  "(tolerance = 1: by the former alone, as in the paper)\n"                                        \
  "eos: off by default; its pressure is cut off below rho_0, where it would contract surfaces\n"   \
  "viscosity: that of the scene, not Eq. (13)\n"                                                   \
  "several fluids: 1/rho_i as in Cummins & Rudman 1999; the paper has one"

enum { OFF, ON };
enum { PRINTED, LIFTED, ZERO };
enum { WALL_OWN, WALL_MIRRORED };
enum { LEAST_ITERATIONS = 2 };
#define TINY ((real)1e-12) /* of R^2: keeps r = 0 from 0/0 */

#define PARAMS(P)                                                                               \
  P(volume_error, 1e-4, 0, 1, "1", "mean compression of a step that CG may leave")              \
  P(tolerance, 1e-3, 0, 1, "1", "part of the divergence that CG may leave")                     \
  P(max_iterations, 1000, 1, 1e6, WHOLE, "largest number of CG iterations")                     \
  P(fixed_iterations, 0, 0, 1e6, WHOLE, "exactly so many CG iterations; 0: by tolerance")       \
  P(surface, ZERO, 0, 2, "printed|lifted|zero",                                                 \
    "at a free surface: nothing, the missing part of the Laplacian with phi = 0, or phi = 0")   \
  P(kappa, -1, -1, 100, "1", "density compensation; -1: 0.1 with gravity, 0 without")           \
  P(wall_velocity, WALL_MIRRORED, 0, 1, "own|mirrored", "walls in div v*: v_b, or 2 v_b - v_i") \
  P(eta, 0.01, 0, 1, "R^2", "what is added to |x_ij|^2 in the Laplacian")                       \
  P(eos, OFF, 0, 1, "off|on", "pressure by an equation of state in the prediction")             \
  P(stiffness, 0, 0, 1e12, "Pa", "its stiffness; 0: sound moves 0.1 dx in a step")              \
  P(gamma, 7, 1, 20, "1", "its exponent")

#define FIELDS(F)                                                                             \
  F(real, phi, ALL, STEP, "m^2/s", "potential of what the projection takes away, 0 on walls") \
  F(real, push, ALL, STEP, "m^5/(kg s^2)", "a pressure over rho_i^2, 0 on walls")             \
  F(real, source, FLUID, STEP, "1/s", "right-hand side, -div v*")                             \
  F(real, diag, FLUID, STEP, "1/m^2", "diagonal of the negative Laplacian")                   \
  F(real, r, FLUID, STEP, "1/s", "residual of CG")                                            \
  F(real, d, ALL, STEP, "m^2/s", "direction of CG, 0 on walls")                               \
  F(real, q, FLUID, STEP, "1/s", "matrix times direction of CG")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real *coef;     /* a_ij, one per slot of nb [1/m^2] */
  real full;      /* sum_j a_ij of a full lattice [1/m^2] */
  real thin;      /* rho/rho_0 below which surface = zero sees a surface [1] */
  real eos_scale; /* kappa of the equation of state [Pa] */
} state;

/* phi = 0, and nothing on walls, for good */
STAGE void forget(const state *s, int i) { s->phi[i] = s->push[i] = s->d[i] = 0; }

/* 1 in the lanes of walls */
STAGE lanes on_wall(const state *s, struct packet ij)
{
  return 1 - only_below(ij, s->p.n, 1 + NO_LANES);
}

/* p_i = 0 in the prediction */
STAGE void no_pressure(const state *s, int i) { s->p.p[i] = 0; }

/* Sec. 3.1  p_i = kappa ((rho_i/rho_0)^gamma - 1), here only where it repels */
STAGE void equation_of_state(const state *s, int i)
{
  const real p = s->eos_scale * (pow(s->p.rho[i] / s->rho0, s->gamma) - 1);
  s->p.p[i] = larger(p, 0);
  s->push[i] = s->p.p[i] / sq(s->p.rho[i]);
}

/* Eq. (12)  v_i -= dt sum_j m_j (p_i/rho_i^2 + p_j/rho_j^2) grad W_ij,
 *           with p_b = p_i, rho_b = rho_0 on walls; with p = rho_0 phi/dt that is Sec. 2.1.2 for
 *           v_i -= grad phi_i */
STAGE void repel(const state *s, int i)
{
  const real own = s->push[i], mirrored = own * sq(s->p.rho[i] / s->rho0);
  const int walls = s->p.n_all > s->p.n;
  vecs a = NO_VECS;
  for_neighbours (s, i, ij) {
    lanes both = own + of(s->push, ij);
    if (walls) both += mirrored * on_wall(s, ij);
    a = add(a, scale(of(s->p.m, ij) * both, gradW(&s->nb, ij)));
  }
  s->p.v[i] = madd(s->p.v[i], -s->dt * light(&s->p, i), sum(a));
}

/* zero: phi_i = 0 here */
STAGE int held(const state *s, int i)
{
  return s->surface == (real)ZERO && s->p.rho[i] < s->thin * s->rho0;
}

/* m_j; twice on walls whose velocity is mirrored, v_i - (2 v_b - v_i) = 2 (v_i - v_b) */
STAGE lanes mass_felt(const state *s, struct packet ij)
{
  const lanes m = of(s->p.m, ij);
  const int mirrored = s->p.n_all > s->p.n && s->wall_velocity == (real)WALL_MIRRORED;
  return mirrored ? m + m * on_wall(s, ij) : m;
}

/* Eq. (18)  -div v*_i = 1/rho_i sum_j m_j (v*_i - v*_j) . grad W_ij, over walls too,
 *           + kappa (rho_i/rho_0 - 1)/dt where rho_i > rho_0 */
STAGE void divergence(const state *s, int i)
{
  lanes rate = NO_LANES;
  for_neighbours (s, i, ij) rate += mass_felt(s, ij) * dot(diff(s->p.v, ij), gradW(&s->nb, ij));
  const real excess = larger(s->p.rho[i] / s->rho0 - 1, 0);
  const real b = sum(rate) / s->p.rho[i] + s->kappa * excess / s->dt;
  s->source[i] = held(s, i) ? 0 : b;
}

/* What Eq. (18) finds of the velocities that `repel` gives for phi_i = 1 alone:
 * rho_0/rho_i^3 (light_i sum_j m_j grad W_ij . sum_j m_j (1 + [wall] rho_i^2/rho_0^2) grad W_ij
 *                + sum_fluid light_j |m_j grad W_ij|^2) */
STAGE real composed(const state *s, int i)
{
  const real rho = s->p.rho[i], mirrored = sq(rho / s->rho0);
  const int walls = s->p.n_all > s->p.n;
  lanes others = NO_LANES;
  vecs felt = NO_VECS, given = NO_VECS;
  for_neighbours (s, i, ij) {
    const vecs g = gradW(&s->nb, ij), mg = scale(of(s->p.m, ij), g);
    felt = add(felt, scale(mass_felt(s, ij), g));
    given = add(given, mg);
    if (walls) given = add(given, scale(mirrored * on_wall(s, ij), mg));
    others += light_of(&s->p, ij) * dot(mg, mg);
  }
  return s->rho0 / (rho * rho * rho) *
         (light(&s->p, i) * inner(sum(felt), sum(given)) + sum(others));
}

/* Sec. 2.1.2  -lap phi_i = sum_j a_ij (phi_i - phi_j),   V_j = m_j/rho_j,
 *           a_ij = 2 V_j |W'_ij| |x_ij| / (|x_ij|^2 + 0.01 R^2);   phi_b = phi_i on walls
 * fluids    1/rho in the pressure's equation: a_ij 2 light_i light_j/(light_i + light_j)
 * lifted    what is missing of a full lattice's sum, walls included, goes to phi = 0
 * zero      where rho_i is thin, phi_i = 0: b_i = 0 keeps it so in CG, whatever other rows say;
 *           elsewhere what is missing of the part thin/rho_0 of the full sum goes to phi = 0
 * and the diagonal is at least what is composed */
STAGE void laplacian(const state *s, int i)
{
  const real R2 = sq(s->nb.kernel.R), own = light(&s->p, i);
  const int walls = s->p.n_all > s->p.n, alone = held(s, i);
  lanes fluid = NO_LANES, wall = NO_LANES;
  for_neighbours (s, i, ij) {
    const lanes V = of(s->p.V, ij), r2 = ij.r * ij.r;
    const lanes shape = 2 * slope_over_r(&s->nb, ij) * r2 / at_least(r2 + s->eta * R2, TINY * R2);
    lanes a = V * shape;
    if (walls) wall += on_wall(s, ij) * of(s->p.m, ij) / s->rho0 * shape;
    if (s->p.light) a = a * (2 * own * light_of(&s->p, ij) / (own + light_of(&s->p, ij)));
    fluid += a;
    keep(s->coef, ij, alone ? NO_LANES : a);
  }
  const real part = s->surface == (real)LIFTED ? 1 : s->surface == (real)ZERO ? s->thin : 0;
  const real lifted = larger(sum(fluid), own * (part * s->full - sum(wall)));
  const real least = alone ? s->full : larger(composed(s, i), (real)1e-6 * s->full);
  s->diag[i] = larger(lifted, least);
  s->phi[i] = 0;
}

/* p_i = rho_0 phi_i/dt, whose impulse takes grad phi away from v* */
STAGE void pressure(const state *s, int i)
{
  const real p = s->rho0 * s->phi[i] / s->dt;
  s->push[i] = p / sq(s->p.rho[i]);
  s->p.p[i] += p;
}

/* Sec. 3.3. The paper's bound of at least two iterations. */
static struct cg_result conjugate_gradients(state *s)
{
  struct cg cg;
  cg.n = s->p.n;
  cg.rows = s->nb;
  cg.coef = s->coef;
  cg.diag = s->diag;
  cg.weight = s->p.V;
  cg.b = s->source;
  cg.x = s->phi;
  cg.r = s->r;
  cg.d = s->d;
  cg.q = s->q;
  struct cg_result result;
  if (s->fixed_iterations > 0) {
    result = cg_solve(&cg, 0, (int)s->fixed_iterations);
    result.converged = 1;
    return result;
  }
  const double volume = s->p.n * (double)(s->mass / s->rho0);
  const double excess = (double)s->volume_error * volume / (double)s->dt;
  result = cg_solve_to(&cg, (double)s->tolerance, excess, (int)s->max_iterations);
  if (result.iterations == 1 && result.residual > 0) {
    sweep(forget, s);
    result = cg_solve(&cg, 0, LEAST_ITERATIONS);
    result.converged = 1;
  }
  return result;
}

/* Sec. 3.2   lap phi = div v*,   v = v* - grad phi */
static status solve(struct run *run, state *s)
{
  sweep(divergence, s);
  s->coef = run_coefficients(run, 0, s->nb.slots);
  if (!s->coef) return status_set(ERR_MEMORY, "no memory for the matrix");
  sweep(laplacian, s);
  const struct cg_result found = conjugate_gradients(s);
  if (!(found.residual >= 0)) return run_diverged(run, "the divergence is not a number");
  run_iterations(run, "pressure", found.iterations, found.residual, found.converged);
  sweep(pressure, s);
  sweep(repel, s);
  return OK;
}

static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_move(run)); /* x += dt v, with the projected v */
  TRY(run_neighbours(run));
  TRY(run_forces(run)); /* Eq. (14)  v* = v + dt a */
  TRY(run_density(run));
  if (s->eos == (real)ON) {
    sweep(equation_of_state, s);
    sweep(repel, s);
  } else
    sweep(no_pressure, s);
  return solve(run, s);
}

static status project(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_density(run));
  sweep(no_pressure, s);
  return solve(run, s);
}

/* full and thin, from a lattice */
static void measure_lattice(state *s)
{
  const struct kernel *k = &s->nb.kernel;
  const int reach = (int)(k->R / s->dx) + 1, deep = DIM == 3 ? reach : 0;
  double total = 0, whole = 0, half = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const real r = s->dx * sqrt((real)(a * a + b * b + c * c));
        const double W_r = (double)kernel_W(k, r, DIM);
        whole += W_r;
        if (a <= 0) half += W_r;
        if (r > 0) total -= (double)(kernel_dW(k, r, DIM) * r / (sq(r) + s->eta * sq(k->R)));
      }
  s->full = (real)(2 * (double)(s->mass / s->rho0) * total);
  s->thin = (real)((half + whole) / (2 * whole));
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  measure_lattice(s);
  if (s->kappa < 0) s->kappa = inner(s->gravity, s->gravity) > 0 ? (real)0.1 : 0;
  const real pressure_of_sound = s->rho0 * sq((real)0.1 * s->dx / s->dt) / s->gamma;
  s->eos_scale = s->stiffness > 0 ? s->stiffness : pressure_of_sound;
  sweep_over(forget, s, s->p.n_all);
  return OK;
}

static void warn(const void *self, double speed, char *text, size_t size)
{
  (void)speed;
  warn_of_kappa((double)((const state *)self)->kappa, text, size);
}

static int mirrors(const void *self)
{
  (void)self;
  return 1;
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_helmholtz = {
  .abi = SOLVER_ABI,
  .name = "helmholtz",
  .about = "Projection of the velocity: conjugate gradients on the SPH Laplacian of its potential",
  .paper = "Helmholtz decomposition-based SPH, Virtual Reality & Intelligent Hardware 3(2) (2021) "
           "118-128",
  .doi = "10.1016/j.vrih.2021.01.003",
  .differences = DIFFERENCES,
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(V) | HAS(p),
  .can = CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) |
         CAN(PERIODIC) | CAN(PROJECT) | CAN(MOMENTUM) | CAN(ISOTROPIC) | CAN(FLUIDS) |
         CAN(MOVING_WALLS) | CAN(BODIES) | CAN(EMITTERS) | CAN(VISCOSITY) | CAN(TENSION),
  .params = params,
  .num_params = COUNT(params),
  .fields = fields,
  .num_fields = COUNT(fields),
  .state_size = sizeof(state),
  .start = start,
  .step = step,
  .changed = NULL,
  .project = project,
  .max_dt = NULL,
  .uses = NULL,
  .stop = NULL,
  .warn = warn,
  .mirrors = mirrors,
};
