/* Variational staggered SPH: every pair of particles carries a velocity along the line that joins
 * them, and the projection acts on those.
 * X. He, H. Wang, G. Wang, H. Wang, E. Wu, A Variational Staggered Particle Framework for
 * Incompressible Free-Surface Flows, arXiv:2001.09421 (2020), doi:10.48550/arXiv.2001.09421.
 *
 * With e_ij = (x_i - x_j)/r and wbar = w/alpha a full neighbourhood has sum_j wbar e e^T = 1/d, so
 *   sum_j wbar (p_i - p_j)/r^2   = -lap p/(2d)
 *   sum_j wbar (v_i - v_j).e/r   = div v/d
 *   sum_j wbar (p_i - p_j) e/r   = grad p/d
 * The mean of 1/alpha_i and 1/alpha_j makes the matrix symmetric: with equal masses CG runs in the
 * plain inner product.
 *
 * Surface: a neighbourhood that is a hair thinner than a full lattice already has its A_ii lifted.
 * An expansion by 2e-6 takes 0.7 % off the pressure of the rotating square at 96 x 96 particles.
 *
 * Differences from the paper: see DIFFERENCES below. */
#include "../core/linear/cg.h"
#include "../core/solver.h"
#include <string.h>

#define DIFFERENCES                                                                                \
  "velocities change by d times the mean over pairs, consistent with the Laplacian (factor = 0); " \
  "factor = 1 takes the mean itself, the authors' programs 0.1 or 3.2 in 3-D\n"                    \
  "w_r = w/r and w_rr = w/r^2 with r at least 0.4 R, as in the authors' programs\n"                \
  "alpha_max and A_max are sums over a full lattice, not the largest of the first step\n"          \
  "Jacobi's preconditioner; a relative residual stops CG\n"                                        \
  "density term: kappa max(rho/rho0 - 1, 0) rho0/(d dt^2), kappa about 0.1 with gravity, 0 "       \
  "without; the authors' programs have numbers with units there\n"                                 \
  "gradient = symmetric is the adjoint of the source and keeps momentum; differences do not\n"     \
  "correction: the inverse of the moments of the pairs, for particles that surface_below leaves "  \
  "inside the fluid (by default only those with -sum_j A_ij >= A_max)\n"                           \
  "shifting: gradient steps of the energies inertia, bulk and surface in units of dx; off, and "   \
  "without surface energy, by default; velocities stay\n"                                          \
  "walls: particles that count with alpha_i; a pair with one has the wall's normal velocity, so "  \
  "that its part of the source counts twice and p_j = p_i; no friction; separation = 1 lets them " \
  "also pull, the authors' programs have 0.1; a single layer (Akinci et al.) acts as free surface"

enum { DIFFERENCE, SYMMETRIC };
enum { OFF, ON };
#define NEAR ((real)0.4) /* distance in R below which w_r and w_rr do not grow */

#define PARAMS(P)                                                                                 \
  P(gradient, DIFFERENCE, 0, 1, "difference|symmetric", "p_j - p_i of the paper, or p_i + p_j")   \
  P(factor, 0, 0, 10, "1", "on the mean pressure gradient of the pairs; 0: d")                    \
  P(correction, OFF, 0, 1, "off|on", "kernel correction of the differences inside the fluid")     \
  P(separation, 1, 0, 1, "1", "part of its velocity with which fluid clings to walls it leaves")  \
  P(surface_below, 1, 0, 1, "1", "part of A_max below which -sum_j A_ij means free surface")      \
  P(kappa, -1, -1, 100, "1", "density compensation; -1: 0.1 with gravity, 0 without")             \
  P(shifting, 0, 0, 100, WHOLE, "iterations of particle shifting after a step")                   \
  P(shift_inertia, 0.3, 0, 1, "1", "part of the way back to where shifting began")                \
  P(shift_bulk, 1, 0, 10, "dx", "shift by a neighbourhood compressed to 2 rho0, all on one side") \
  P(shift_surface, 0, 0, 10, "dx", "shift towards a neighbourhood that is all on one side")       \
  P(tolerance, 1e-4, 0, 1, "1", "relative residual at which CG stops")                            \
  P(max_iterations, 1000, 1, 1e6, WHOLE, "largest number of CG iterations")                       \
  P(fixed_iterations, 0, 0, 1e6, WHOLE, "exactly so many CG iterations; 0: by tolerance")

#define FIELDS(F)                                                                       \
  F(real, share, ALL, STEP, "1", "1/alpha_i, 0 on walls")                               \
  F(real, surface, FLUID, STEP, "1", "1 if A_ii was lifted to A_max, else 0")           \
  F(real, source, FLUID, STEP, "Pa/m^2", "right-hand side")                             \
  F(real, diag, FLUID, STEP, "1/m^2", "diagonal A_ii of the matrix")                    \
  F(real, pressure, ALL, STEP, "Pa", "unknown of CG, 0 on walls")                       \
  F(real, r, FLUID, STEP, "Pa/m^2", "residual of CG")                                   \
  F(real, d, ALL, STEP, "Pa", "direction of CG, 0 on walls")                            \
  F(real, q, FLUID, STEP, "Pa/m^2", "matrix times direction of CG")                     \
  F(vec, hold, WALL, STEP, "m/s", "change of velocity that holds a particle off walls") \
  F(vec, place, FLUID, STEP, "m", "position before shifting")                           \
  F(vec, shift, FLUID, STEP, "m", "displacement of one shifting iteration")             \
  F(real, squeeze, ALL, STEP, "m^(d+1)", "compression over the sum of slopes, 0 on walls")

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real *a;             /* -A_ij, one per slot of nb */
  real a_max, share_0; /* A_ii and 1/alpha of a full lattice */
} state;

/* --- weights of a pair; zero for i itself */

/* w = 1 - q^4,  q = r/R */
STAGE lanes weight(const state *s, struct packet ij)
{
  const lanes q = ij.r * s->nb.kernel.inv_R;
  return only(ij, positive(ij.r, at_least(1 - q * q * (q * q), 0)));
}
/* w_r = w/r and w_rr = w/r^2 follow from this r */
STAGE lanes apart(const struct pairs *nb, struct packet ij)
{
  return at_least(ij.r, NEAR * nb->kernel.R);
}
/* (1/alpha_i + 1/alpha_j)/2 w_ij, with alpha_i for walls */
STAGE lanes mean_weight(const state *s, struct packet ij)
{
  const real own = s->share[ij.i];
  return (real)0.5 * (own + or_else(of(s->share, ij), own)) * weight(s, ij);
}
/* e_ij = (x_i - x_j)/r */
STAGE vecs direction(const struct pairs *nb, struct packet ij)
{
  return scale(1 / at_least(ij.r, (real)1e-6 * nb->kernel.R), ij.x);
}

/* alpha_i = max(sum_j w_ij, alpha_max) */
STAGE void weigh(const state *s, int i)
{
  s->pressure[i] = s->d[i] = s->share[i] = 0;
  if (i >= s->p.n) return;
  lanes alpha = NO_LANES;
  for_neighbours (s, i, ij) alpha += weight(s, ij);
  s->share[i] = 1 / larger(sum(alpha), 1 / s->share_0);
}

/* --- the linear system */

/* (v_i - v_j).n_j n_j, separation times that if they part: what a wall takes away; 0 in fluid */
STAGE vecs into_wall(const state *s, struct packet ij)
{
  const vecs n = of(s->p.normal, ij);
  const lanes u = dot(diff(s->p.v, ij), n);
  return scale(at_most(u, 0) + s->separation * at_least(u, 0), n);
}

/* v_i - v_j; of walls twice the part above, as of a mirrored fluid */
STAGE vecs relative_velocity(const state *s, struct packet ij)
{
  const vecs u = diff(s->p.v, ij);
  if (!s->p.normal) return u;
  return add(scale(only_below(ij, s->p.n, 1 + NO_LANES), u), scale(2 + NO_LANES, into_wall(s, ij)));
}

/* A_ij = -(1/alpha_i + 1/alpha_j) w_rr,  A_ii = max(-sum_j A_ij, A_max) + sum_walls A_ij
 * b_i = -rho0/(2 dt) sum_j (1/alpha_i + 1/alpha_j) w_r (v_i - v_j).e_ij
 *       + kappa max(rho_i/rho0 - 1, 0) rho0/(d dt^2) */
STAGE void assemble(const state *s, int i)
{
  lanes full = NO_LANES, open = NO_LANES, div = NO_LANES;
  for_neighbours (s, i, ij) {
    const lanes w = mean_weight(s, ij), r = apart(&s->nb, ij), a = 2 * w / (r * r);
    const lanes to_fluid = only_below(ij, s->p.n, a);
    keep(s->a, ij, to_fluid);
    full += a;
    open += to_fluid;
    div += w / r * dot(relative_velocity(s, ij), direction(&s->nb, ij));
  }
  const real all = sum(full), to_walls = all - sum(open);
  const real dense = larger(s->p.rho[i] / s->rho0 - 1, 0);
  s->surface[i] = all < s->surface_below * s->a_max;
  s->diag[i] = larger(larger(all, s->a_max) - to_walls, (real)1e-6 * s->a_max);
  s->source[i] = s->rho0 / s->dt * (s->kappa * dense / (DIM * s->dt) - sum(div));
}

static status solve(struct run *run, state *s)
{
  struct cg cg;
  cg.n = s->p.n;
  cg.rows = s->nb;
  cg.coef = s->a;
  cg.diag = s->diag;
  cg.weight = s->p.m;
  cg.b = s->source;
  cg.x = s->pressure;
  cg.r = s->r;
  cg.d = s->d;
  cg.q = s->q;
  const int fixed = (int)s->fixed_iterations;
  const struct cg_result result =
    cg_solve(&cg, fixed ? 0 : (double)s->tolerance, fixed ? fixed : (int)s->max_iterations);
  if (!(result.residual >= 0)) return run_diverged(run, "the pressure is not a number");
  run_iterations(run, "pressure", result.iterations, result.residual, fixed || result.converged);
  return OK;
}

/* --- the velocities */

/* The moments of the pairs, M_i = 1/2 sum_j (1/alpha_i + 1/alpha_j) w_r r e e^T = 1/d if full;
 * returns M^-1 b */
STAGE vec corrected(const state *s, int i, vec b)
{
  real m[DIM][DIM];
  for (int k = 0; k < DIM; k++)
    for (int l = 0; l <= k; l++) {
      lanes moment = NO_LANES;
      for_neighbours (s, i, ij) {
        const vecs e = direction(&s->nb, ij);
        moment += mean_weight(s, ij) * ij.r / apart(&s->nb, ij) * e.c[k] * e.c[l];
      }
      m[k][l] = m[l][k] = sum(moment);
    }
  for (int k = 0; k < DIM; k++)
    for (int l = k + 1; l < DIM; l++) {
      const real f = m[l][k] / m[k][k];
      for (int d = k; d < DIM; d++) m[l][d] -= f * m[k][d];
      b.c[l] -= f * b.c[k];
    }
  for (int k = DIM - 1; k >= 0; k--) {
    for (int d = k + 1; d < DIM; d++) b.c[k] -= m[k][d] * b.c[d];
    b.c[k] /= m[k][k];
  }
  return b;
}

/* v_i += dt/rho0 d/2 sum_j (1/alpha_i + 1/alpha_j) w_r (p_j - p_i) e_ij
 * at the surface with p_j alone, since what is missing there has p = 0; on walls p_j = p_i
 * symmetric: with p_j + p_i everywhere */
STAGE void correct(const state *s, int i)
{
  const real p = s->pressure[i];
  const real own = s->gradient == (real)SYMMETRIC ? -p : s->surface[i] > 0 ? 0 : p;
  vecs push = NO_VECS;
  for_neighbours (s, i, ij) {
    const lanes w = mean_weight(s, ij) / apart(&s->nb, ij), fluid = only_below(ij, s->p.n, w);
    push =
      add(push, scale(fluid * (of(s->pressure, ij) - p) + w * (p - own), direction(&s->nb, ij)));
  }
  const vec mean = sum(push);
  const int inside = s->gradient == (real)DIFFERENCE && !(s->surface[i] > 0);
  const vec change =
    s->correction == (real)ON && inside ? corrected(s, i, mean) : times(s->factor, mean);
  s->p.v[i] = madd(s->p.v[i], s->dt / s->rho0, change);
  s->p.p[i] = p;
}

/* v_i -= d/alpha_i sum_walls w_ij ((v_i - v_j).n_j n_j).e_ij e_ij */
STAGE void yield_to_walls(const state *s, int i)
{
  vecs dv = NO_VECS;
  for_neighbours (s, i, ij) {
    const vecs e = direction(&s->nb, ij);
    dv = add(dv, scale(weight(s, ij) * dot(into_wall(s, ij), e), e));
  }
  s->hold[i] = times(-s->factor * s->share[i], sum(dv));
}
STAGE void add_hold(const state *s, int i) { s->p.v[i] = plus(s->p.v[i], s->hold[i]); }

static status project(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_density(run));
  s->a = run_coefficients(run, 0, s->nb.slots);
  if (!s->a) return status_set(ERR_MEMORY, "no memory for the matrix");
  sweep_over(weigh, s, s->p.n_all);
  sweep(assemble, s);
  TRY(solve(run, s));
  if (s->hold) sweep(yield_to_walls, s);
  sweep(correct, s);
  if (s->hold) sweep(add_hold, s);
  return OK;
}

/* --- Sec. 4.3: particle shifting */

STAGE void begin_shifting(const state *s, int i) { s->place[i] = s->p.x[i]; }

/* squeeze_i = max(rho_i/rho0 - 1, 0) / sum_j |W'_ij| */
STAGE void compress(const state *s, int i)
{
  s->squeeze[i] = 0;
  if (i >= s->p.n) return;
  lanes rho = NO_LANES, slopes = NO_LANES;
  for_neighbours (s, i, ij) {
    rho += of(s->p.m, ij) * W(&s->nb, ij);
    slopes += positive(ij.r, slope(&s->nb, ij));
  }
  const real total = sum(slopes), excess = sum(rho) / s->rho0 - 1;
  if (total > 0 && excess > 0) s->squeeze[i] = excess / total;
}

/* dx_i = inertia (x^0_i - x_i) + bulk sum_j (squeeze_i + squeeze_j) |W'_ij| e_ij - surface |g| g,
 * g = sum_j w_rr e_ij / sum_j w_rr */
STAGE void shifted(const state *s, int i)
{
  const real own = s->squeeze[i];
  vecs apart_from = NO_VECS, one_side = NO_VECS;
  lanes total = NO_LANES;
  for_neighbours (s, i, ij) {
    const vecs e = direction(&s->nb, ij);
    const lanes r = apart(&s->nb, ij), w = weight(s, ij) / (r * r);
    apart_from = add(apart_from, scale((own + of(s->squeeze, ij)) * slope(&s->nb, ij), e));
    one_side = add(one_side, scale(w, e));
    total += w;
  }
  const real all = sum(total);
  const vec g = times(all > 0 ? 1 / all : 0, sum(one_side));
  vec dx = times(s->shift_inertia, sub(s->place[i], s->p.x[i]));
  dx = madd(dx, s->shift_bulk * s->dx, sum(apart_from));
  s->shift[i] = madd(dx, -s->shift_surface * s->dx * sqrt(inner(g, g)), g);
}
STAGE void displace(const state *s, int i) { s->p.x[i] = plus(s->p.x[i], s->shift[i]); }

static void shift_particles(state *s)
{
  if (s->shifting <= 0) return;
  sweep(begin_shifting, s);
  for (int k = 0; k < (int)s->shifting; k++) {
    sweep_over(compress, s, s->p.n_all);
    sweep(shifted, s);
    sweep(displace, s);
  }
}

static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_move(run));
  TRY(run_neighbours(run));
  TRY(run_forces(run));
  TRY(project(run, s));
  shift_particles(s);
  return OK;
}

/* alpha_max = sum w and A_max = sum 2/alpha_max w_rr over a full lattice */
static void full_lattice(state *s)
{
  const double R = (double)s->nb.kernel.R, dx = (double)s->dx;
  const int reach = (int)(R / dx) + 1, deep = DIM == 3 ? reach : 0;
  double alpha = 0, second = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const double r = dx * sqrt((double)(a * a + b * b + c * c)), q = r / R;
        const double w = r > 0 && q < 1 ? 1 - q * q * (q * q) : 0;
        const double least = (double)NEAR * R, far = r > least ? r : least;
        alpha += w;
        second += w / (far * far);
      }
  s->share_0 = (real)(1 / alpha);
  s->a_max = (real)(2 * second / alpha);
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  full_lattice(s);
  if (s->factor <= 0) s->factor = DIM;
  if (s->kappa < 0) s->kappa = inner(s->gravity, s->gravity) > 0 ? (real)0.1 : 0;
  return OK;
}

static int uses(const void *self, const char *field)
{
  const state *s = (const state *)self;
  const int only_shifting =
    !strcmp(field, "place") || !strcmp(field, "shift") || !strcmp(field, "squeeze");
  return !only_shifting || s->shifting > 0;
}

static void warn(const void *self, double speed, char *text, size_t size)
{
  (void)speed;
  warn_of_kappa((double)((const state *)self)->kappa, text, size);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_vssph = {
  .abi = SOLVER_ABI,
  .name = "vssph",
  .about = "Variational staggered SPH: projects the velocities between pairs of particles",
  .paper = "He, Wang, Wang, Wang & Wu 2020, A Variational Staggered Particle Framework for "
           "Incompressible Free-Surface Flows, arXiv:2001.09421",
  .doi = "10.48550/arXiv.2001.09421",
  .differences = DIFFERENCES,
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(p) | HAS(normal),
  .can = CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) |
         CAN(PROJECT) | CAN(PERIODIC) | CAN(ISOTROPIC) | CAN(VISCOSITY) | CAN(TENSION),
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
  .uses = uses,
  .stop = NULL,
  .warn = warn,
};
