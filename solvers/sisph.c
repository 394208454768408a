/* Semi-implicit SPH.
 * X. He, S. Liu, Y. Guo, J. Shi, Y. Qiao, A Semi-Implicit SPH Method for Compressible and
 * Incompressible Flows with Improved Convergence, Comput. Graph. Forum (2025),
 * doi:10.1111/cgf.70043. Equation and algorithm numbers are that paper's; its h is dt here.
 *
 * Differences from the paper: see DIFFERENCES below.
 *
 * Stiffness: mu is an energy per particle [J], so that the bulk modulus is K = mu/V0, V0 = dx^d,
 * and a mu that is kept means K ~ dx^-d. A fluid's elastic modulus to a long wave is
 *   K_eff = K B''(1) G^2,   G^2 = .48/.60 (2-D/3-D) at R = 2 dx, .0186/.0183 at R = 1.2 dx (spiky),
 * and N plain iterations of diagonal D = 1 + S/beta make of it K_eff (1 - (1 - 1/D)^N): what the
 * fluid is like does not depend on N and dt where S <~ N beta/3 and is as soft as N allows beyond.
 *
 * Pressure: an iterate feels P_i = K_i B'(lambda_i), of which the step to it took the share 1/D_i.
 * p_i follows the same averages (also those of the accelerations), so that
 *   dv_i = -dt sum_j m_j (p_i + p_j)/rho_0^2 grad W_ij:
 * exact with one common diagonal but for the motion of grad W in the step; with each particle's own
 * good where S varies little (20 % off in a block of 6^3, which is nearly all surface); P_i itself
 * when converged. */
#include "../core/linear/anderson.h"
#include "../core/linear/chebyshev.h"
#include "../core/solver.h"
#include "../core/sph/lattice.h"
#include <stdio.h>
#include <string.h>

#define DIFFERENCES                                                                                \
  "Alg. 1: k++ stands in the inner loop and the test reads 'k < N or eps < eta'; here k < N and "  \
  "eps > eta once per sweep, eps = |h^2/m grad Psi|/dx (r.m.s.), which bounds the distance to a "  \
  "minimum of a convex Psi\n"                                                                      \
  "Eq. (12), (14) as increments dx_i, with x - x* accumulated beside x and v += (x - x*)/dt: the " \
  "same numbers without their cancellation\n"                                                      \
  "Eq. (9): the scene's kernel, by default not the spiky one, scaled by the particles' mass so "   \
  "that the full lattice has rho_0; all neighbours within the support, not 30 to 40\n"             \
  "stiffness: K [Pa] or mu [J] (mu = K dx^d); by default K = 1e6 Pa, which is the paper's mu = 1 " \
  "J at dx = 0.01 m in 3-D\n"                                                                      \
  "support: the scene's; the paper's 1.2 dx keeps its volume badly\n"                              \
  "Eq. (14) conserves momentum only when converged; diagonal = common does always, and keeps "     \
  "soft fluid beside stiff calm, which own diagonals agitate until they converge\n"                \
  "diagonal: 1 + S/beta, beta = 1 in the paper\n"                                                  \
  "Eq. (20) as printed cannot move a particle that only its neighbours press (psi_i = 0); "        \
  "repaired: alpha_i = 1 where rho_i <= rho_0\n"                                                   \
  "Eq. (23): rho = S/(1 + S) of the step's largest S, at most .995, unless given; the paper's is " \
  ".9\n"                                                                                           \
  "Eq. (21): with a safeguard on the residual or on Psi (Peng et al. 2018), or none\n"             \
  "clamp: free lets lambda < 1 attract\n"                                                          \
  "walls: particles of mass m that do not move and have a P_j and K_j like any other, which "      \
  "belong to Psi; with P_j = P_i instead (mirrored) Psi is no objective any more and water in a "  \
  "tank gains energy, with P_j = 0 (still) it sinks towards the walls; the paper clips against "   \
  "triangles\n"                                                                                    \
  "several fluids: m_i = rho_0i dx^d in Psi, and a stiffness of their own"

enum { B0, B1, B2 };
enum { EQ_12, EQ_14 };
enum { STEP_NONE, STEP_PRINTED, STEP_REPAIRED };
enum { PLAIN, CHEBYSHEV, ANDERSON };
enum { GUARD_NONE, GUARD_PSI, GUARD_RESIDUAL };
enum { OWN, COMMON };
enum { CLAMPED, FREE };
enum { WALLS_ORDINARY, WALLS_STILL, WALLS_MIRRORED };
#define DEFAULT_K ((real)1e6)
#define DEFAULT_N 10
#define MOST_RHO ((real)0.995)

#define PARAMS(P)                                                                                \
  P(energy, B0, 0, 2, "B0|B1|B2", "bulk energy B(lambda), Eqs. (15), (16), (17)")                \
  P(form, EQ_14, 0, 1, "eq12|eq14", "non-conservative or conservative substitution")             \
  P(fixed_iterations, 0, 0, 1e6, WHOLE,                                                          \
    "number of iterations N; 0: by tolerance, or 10 without one")                                \
  P(tolerance, 0, 0, 1, "dx", "eta: r.m.s. of h^2/m grad Psi at which to stop; 0: none")         \
  P(max_iterations, 1000, 1, 1e6, WHOLE, "largest number of iterations with a tolerance")        \
  P(K, 0, 0, 1e15, "Pa", "bulk modulus; 0: from mu, or 1e6 Pa if that is 0, too")                \
  P(mu, 0, 0, 1e15, "J", "energy per particle K dx^d (2-D: J/m); 0: from K")                     \
  P(S, 0, 0, 0, "1", "reported: sum of A+ in Eq. (14) on a full lattice; follows from K")        \
  P(stiff_ratio, 1, 0, 1e6, "1", "modulus of fluids after the first and beyond split, over K")   \
  P(split, 1e30, -1e30, 1e30, "m", "fluid that starts at larger x has K stiff_ratio")            \
  P(clamp, CLAMPED, 0, 1, "clamped|free", "lambda >= 1, or also attraction")                     \
  P(wall_pressure, WALLS_ORDINARY, 0, 2, "ordinary|still|mirrored",                              \
    "P_j of a wall particle: K B'(lambda_j), 0, or P_i")                                         \
  P(step_length, STEP_NONE, 0, 2, "none|printed|repaired", "Eq. (20); B0 needs none")            \
  P(diagonal, OWN, 0, 1, "own|common", "1 + S_i/beta, or 1 + max S/beta: conserves momentum")    \
  P(beta, 1, 0.1, 10, "1", "what S is divided by in the diagonal; 3 converges 2.8 times faster") \
  P(acceleration, PLAIN, 0, 2, "plain|chebyshev|anderson", "Eqs. (14), (22), (21)")              \
  P(spectral_radius, 0, 0, 0.9999, "1",                                                          \
    "spectral radius rho of Eq. (23); 0: that of a lattice, S/(1 + S)")                          \
  P(history, 1, 1, 5, WHOLE, "n of Eq. (21), an integer")                                        \
  P(safeguard, GUARD_RESIDUAL, 0, 2, "none|psi|residual", "what an accelerated step may not raise")

#define HISTORY(F, k)                                                          \
  F(vec, df##k, FLUID, STEP, "m", "Anderson: a difference of residuals")       \
  F(vec, dg##k, FLUID, STEP, "m", "Anderson: a difference of proposed shifts") \
  F(real, dp##k, FLUID, STEP, "Pa", "Anderson: a difference of proposed pressures")

#define FIELDS(F)                                                                           \
  F(real, bulk, ALL, KEPT, "Pa", "bulk modulus K_i of the particle")                        \
  F(real, press, ALL, STEP, "Pa", "P_i = K_i B'(lambda_i) of this iterate")                 \
  F(real, diag, FLUID, STEP, "1", "S_i, the sum of A+ in Eq. (14)")                         \
  F(vec, pull, FLUID, STEP, "m", "sum of A (x_j - x_i) in Eq. (14)")                        \
  F(vec, shift, FLUID, STEP, "m", "x_i - x*_i of this iterate")                             \
  F(vec, next, FLUID, STEP, "m", "x_i - x*_i of the next iterate")                          \
  F(real, next_p, FLUID, STEP, "Pa", "pressure that acted by the next iterate")             \
  F(vec, last, FLUID, STEP, "m", "Chebyshev: x_i - x*_i of the iterate before")             \
  F(real, last_p, FLUID, STEP, "Pa", "Chebyshev: pressure of the iterate before")           \
  F(real, wet, WALL, STEP, "1/m^d", "sum of W over the fluid that a wall particle touches") \
  HISTORY(F, 1) HISTORY(F, 2) HISTORY(F, 3) HISTORY(F, 4) HISTORY(F, 5)

typedef struct {
  VIEW;
  PARAMS(PARAM_MEMBER)
  FIELDS(FIELD_MEMBER)
  real common; /* the largest S_i of this iterate */
  int given;   /* was a stiffness asked for? */
} state;

/* --- Sec. 4: the bulk energy and its forces */

/* Eq. (15) - (17)   B'(lambda) = lambda^n - 1,   n = 1, 2, 3, in e = lambda - 1 */
STAGE real slope_of_energy(const state *s, real e)
{
  if (s->energy == (real)B0) return e;
  if (s->energy == (real)B1) return e * (2 + e);
  return e * (3 + e * (3 + e));
}
/* B0 = (lambda - 1)^2 / 2,   B1 = (lambda^3 - 1)/3 - lambda + 1,
 * B2 = (lambda^4 - 1)/4 - lambda + 1 */
STAGE real energy_of(const state *s, real e)
{
  if (s->energy == (real)B0) return e * e / 2;
  if (s->energy == (real)B1) return e * e * (1 + e / 3);
  return e * e * ((real)1.5 + e * (1 + e / 4));
}

/* K_i = mu_i / V0 */
STAGE real modulus(const state *s, int i) { return s->bulk ? s->bulk[i] : s->K; }

/* lambda_i - 1, clamped as Alg. 1 does */
STAGE real compression(const state *s, int i)
{
  const real e = (s->p.rho[i] - s->rho0) / s->rho0;
  return s->clamp == (real)CLAMPED ? larger(e, 0) : e;
}

/* psi_i / (m_i/dt^2) of Eq. (7):   |x_i - x*_i|^2 / 2 + dt^2/rho_0i K_i B(lambda_i) */
STAGE real own_energy(const state *s, int i)
{
  const real scale = light(&s->p, i) * sq(s->dt) / s->rho0;
  const real bulk = scale * modulus(s, i) * energy_of(s, compression(s, i));
  return inner(s->shift[i], s->shift[i]) / 2 + bulk;
}

/* Eq. (5), (6)   rho_i = sum_j m_j W_ij */
STAGE real density(const state *s, int i)
{
  lanes rho = NO_LANES;
  for_neighbours (s, i, ij) rho += of(s->p.m, ij) * W(&s->nb, ij);
  return sum(rho);
}

/* Eq. (13)   P_i = K_i B'(lambda_i): what A+_ij + A-_ij of particle i have in common
 * Eq. (7)    returns psi_i / (rho_0 V0/dt^2) */
STAGE real compress(const state *s, int i)
{
  s->p.rho[i] = density(s, i);
  s->press[i] = modulus(s, i) * slope_of_energy(s, compression(s, i));
  return own_energy(s, i) / light(&s->p, i);
}
/* wet_k = sum_j W_kj over the fluid: does it reach the k-th wall particle?   P_k = 0 where not */
STAGE void reach(const state *s, int k)
{
  const int i = s->p.n + k;
  lanes fluid = NO_LANES;
  for_neighbours (s, i, ij) fluid += only_below(ij, s->p.n, W(&s->nb, ij));
  s->wet[i] = sum(fluid);
  s->press[i] = 0;
}
/* Eq. (13)   P_k = K_k B'(lambda_k) of the k-th wall particle, which stays and does not attract
 * Eq. (7)    returns mu_k B(lambda_k) / (rho_0 V0/dt^2) */
STAGE real compress_wall(const state *s, int k)
{
  const int i = s->p.n + k;
  if (s->wet[i] <= 0) return 0;
  const real e = larger(density(s, i) / s->rho0 - 1, 0);
  s->press[i] = modulus(s, i) * slope_of_energy(s, e);
  return s->p.m[i] / s->mass * sq(s->dt) / s->rho0 * modulus(s, i) * energy_of(s, e);
}

/* a_j; at walls that of the wall particle, 0, or a_i; 0 in Eq. (12) */
STAGE lanes partner(const state *s, struct packet ij, real mine, lanes its)
{
  if (s->form == (real)EQ_12) return NO_LANES;
  if (s->wall_pressure == (real)WALLS_ORDINARY) return its;
  const real wall = s->wall_pressure == (real)WALLS_MIRRORED ? mine : 0;
  return wall + only_below(ij, s->p.n, its - wall);
}

/* Eq. (13)   A+_ij = -K_i a_ij,   A+_ij + A-_ij = P_i a_ij,   a_ij = dt^2 m_j/rho_0^2 W'_ij/r_ij
 * Eq. (14)   S_i = sum_j (A+_ij + A+_ji),   pull_i = sum_j (A_ij + A_ji) (x_j - x_i);
 *            in Eq. (12) without A_ji.   Returns S_i. */
STAGE real gather(const state *s, int i)
{
  const real P_i = s->press[i], K_i = modulus(s, i);
  lanes S = NO_LANES;
  vecs pull = NO_VECS;
  for_neighbours (s, i, ij) {
    const lanes a = positive(ij.r, of(s->p.m, ij) * slope_over_r(&s->nb, ij));
    const lanes K_j = s->bulk ? of(s->bulk, ij) : K_i + NO_LANES;
    S += a * (K_i + partner(s, ij, K_i, K_j));
    pull = add(pull, scale(a * (P_i + partner(s, ij, P_i, of(s->press, ij))), ij.x));
  }
  const real unit = light(&s->p, i) * sq(s->dt / s->rho0);
  s->diag[i] = unit * sum(S);
  s->pull[i] = times(unit, sum(pull));
  return s->diag[i];
}

/* Eq. (20)   alpha_i = min(-psi_i / (grad psi_i . dx_i), 1),   grad psi_i = -m_i/dt^2 D_i dx_i */
STAGE real step_length(const state *s, int i, real D, vec dx)
{
  const real slope = D * inner(dx, dx);
  if (s->step_length == (real)STEP_NONE || slope <= 0) return 1;
  if (s->step_length == (real)STEP_REPAIRED && s->p.rho[i] <= s->rho0) return 1;
  return smaller(own_energy(s, i) / slope, 1);
}

/* Eq. (14)   dx_i = (x*_i - x_i + pull_i) / D_i,   D_i = 1 + S_i/beta
 * Eq. (19)   x_i + alpha_i dx_i,   and the pressure with it:   p_i + alpha_i (P_i - p_i) / D_i
 * Returns |dt^2/m_i grad_i Psi|^2. */
STAGE real substitute(const state *s, int i)
{
  const real D = 1 + (s->diagonal == (real)COMMON ? s->common : s->diag[i]) / s->beta;
  const vec residual = sub(s->pull[i], s->shift[i]), dx = times(1 / D, residual);
  const real alpha = step_length(s, i, D, dx);
  s->next[i] = madd(s->shift[i], alpha, dx);
  s->next_p[i] = s->p.p[i] + alpha * (s->press[i] - s->p.p[i]) / D;
  return inner(residual, residual);
}

/* x_i = the next iterate */
STAGE void settle(const state *s, int i)
{
  s->p.x[i] = plus(s->p.x[i], sub(s->next[i], s->shift[i]));
  s->shift[i] = s->next[i];
  s->p.p[i] = s->next_p[i];
}

/* Alg. 1   x^0_i = x*_i */
STAGE void begin(const state *s, int i)
{
  s->shift[i] = zero();
  s->p.p[i] = 0;
}

/* Alg. 1   v_i = (x_i - x^n_i)/dt = v*_i + (x_i - x*_i)/dt */
STAGE void finish(const state *s, int i) { s->p.v[i] = madd(s->p.v[i], 1 / s->dt, s->shift[i]); }

/* --- Sec. 4.3: acceleration of the iteration on shift, which p follows */

struct accelerator {
  struct chebyshev chebyshev;
  struct anderson anderson;
  int fast;     /* was this iterate accelerated? */
  double merit; /* of the last iterate that was kept */
};

static struct anderson anderson_of(const state *s)
{
  struct anderson a;
  vec *const df[] = {s->df1, s->df2, s->df3, s->df4, s->df5};
  vec *const dg[] = {s->dg1, s->dg2, s->dg3, s->dg4, s->dg5};
  real *const dp[] = {s->dp1, s->dp2, s->dp3, s->dp4, s->dp5};
  a.depth = (int)s->history;
  a.field.n = s->p.n * DIM;
  a.field.g = (real *)s->next;
  a.x = (const real *)s->shift;
  a.follow.n = s->p.n;
  a.follow.g = s->next_p;
  for (int k = 0; k < ANDERSON_MOST; k++) {
    a.df[k] = (real *)df[k];
    a.field.dg[k] = (real *)dg[k];
    a.follow.dg[k] = dp[k];
  }
  anderson_begin(&a);
  return a;
}

/* Eq. (21), with a safeguard: an accelerated iterate that is worse than the last one is taken back
 * to what Eq. (14) proposed instead (Peng et al. 2018). */
static void anderson_step(const state *s, struct accelerator *a, double merit)
{
  if (a->fast && s->safeguard != (real)GUARD_NONE && merit > a->merit) {
    anderson_retreat(&a->anderson);
    a->fast = 0;
    return;
  }
  a->merit = merit;
  a->fast = a->anderson.has_last;
  anderson_advance(&a->anderson);
}

/* Eq. (22), (23) */
static void chebyshev_step(const state *s, struct accelerator *a)
{
  const int n = s->p.n;
  const struct chebyshev_field x = {n * DIM, (const real *)s->shift, (real *)s->next,
                                    (real *)s->last};
  const struct chebyshev_field p = {n, s->p.p, s->next_p, s->last_p};
  struct chebyshev *c = &a->chebyshev;
  const real matched = 1 - 1 / (1 + s->S * larger(s->stiff_ratio, 1) / s->beta);
  if (c->k == 0) c->rho = s->spectral_radius > 0 ? s->spectral_radius : smaller(matched, MOST_RHO);
  chebyshev_next(c);
  chebyshev_apply(c, x);
  chebyshev_apply(c, p);
}

static void accelerate(const state *s, struct accelerator *a, double psi, double residual)
{
  if (s->acceleration == (real)CHEBYSHEV) chebyshev_step(s, a);
  if (s->acceleration == (real)ANDERSON)
    anderson_step(s, a, s->safeguard == (real)GUARD_PSI ? psi : residual);
}

/* --- Algorithm 1 */

/* P of every particle, and Psi / (rho_0 V0/dt^2) */
static status press_all(struct run *run, state *s, double *psi)
{
  double of_walls = 0;
  sum_over(compress, s, s->p.n, psi);
  if (s->wet) sum_over(compress_wall, s, s->p.n_all - s->p.n, &of_walls);
  *psi += of_walls;
  return *psi < HUGE_VAL ? OK : run_diverged(run, "the energy Psi is not a number");
}

/* Find positions that minimise Psi, starting from x*. */
static status minimise(struct run *run, state *s)
{
  const int fixed = (int)s->fixed_iterations, most = fixed > 0 ? fixed : (int)s->max_iterations;
  struct accelerator a;
  double psi, largest, square, eps = 0;
  int k = 0, reached = 0;
  memset(&a, 0, sizeof a);
  if (s->acceleration == (real)ANDERSON) a.anderson = anderson_of(s);
  sweep(begin, s);
  for (;; k++) {
    TRY(press_all(run, s, &psi));
    if (k == most) break;
    largest_over(gather, s, s->p.n, &largest);
    s->common = (real)largest;
    sum_over(substitute, s, s->p.n, &square);
    eps = sqrt(square / s->p.n) / (double)s->dx;
    reached = !fixed && eps <= (double)s->tolerance;
    if (reached) break;
    accelerate(s, &a, psi, square);
    sweep(settle, s);
  }
  run_iterations(run, "substitution", k, eps, fixed || reached);
  return OK;
}

static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(run_forces(run)); /* v* = v + dt f */
  TRY(run_move(run));   /* x* = x + dt v* */
  TRY(run_neighbours(run));
  if (s->wet) {
    TRY(run_wall_rows(run));
    sweep_over(reach, s, s->p.n_all - s->p.n);
  }
  TRY(minimise(run, s));
  sweep(finish, s);
  return OK;
}

/* S_i of Eq. (14) in a full lattice of modulus K */
static double lattice_S(const state *s)
{
  const struct kernel *kernel = &s->nb.kernel;
  const int reach = (int)(kernel->R / s->dx) + 1, deep = DIM == 3 ? reach : 0;
  double total = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const real r = s->dx * sqrt((real)(a * a + b * b + c * c));
        if (r > 0) total -= (double)(kernel_dW(kernel, r, DIM) / r);
      }
  const int sides = s->form == (real)EQ_12 ? 1 : 2;
  return sides * (double)(s->K * sq(s->dt / s->rho0) * s->mass) * total;
}

/* K_i = 0: not known */
STAGE void no_modulus(const state *s, int i) { s->bulk[i] = 0; }
/* K_i, where they differ and K_i is not known:   K_i = stiff_ratio K */
STAGE void give_modulus(const state *s, int i)
{
  if (s->bulk[i] > 0) return;
  const int other = i < s->p.n && (s->p.x[i].c[0] > s->split || (s->p.fluid && s->p.fluid[i] > 0));
  s->bulk[i] = other ? s->stiff_ratio * s->K : s->K;
}

/* mu = K V0 */
static status resolve_stiffness(state *s)
{
  real V0 = 1;
  for (int d = 0; d < DIM; d++) V0 *= s->dx;
  if (s->K > 0 && s->mu > 0)
    return user_error("K is %g Pa and mu is %g J: one follows from the other, allowed is to give "
                      "one of them",
                      (double)s->K, (double)s->mu);
  s->given = s->K > 0 || s->mu > 0;
  if (s->mu > 0) s->K = s->mu / V0;
  if (s->K <= 0) s->K = DEFAULT_K;
  s->mu = s->K * V0;
  s->S = (real)lattice_S(s);
  return OK;
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  TRY(resolve_stiffness(s));
  if (s->fixed_iterations <= 0 && s->tolerance <= 0) s->fixed_iterations = DEFAULT_N;
  if (s->bulk) {
    sweep_over(no_modulus, s, s->p.n_all);
    sweep_over(give_modulus, s, s->p.n_all);
  }
  return run_neighbours(run); /* the first step's viscosity */
}

/* cosh(n arcosh x), x >= 1 */
static double chebyshev_polynomial(int n, double x) { return cosh(n * acosh(x)); }

/* The part of K that N iterations make act: 1 - (1 - 1/D)^N, which is 95 % at S = N beta/3, and
 * with polynomials, of which Chebyshev's are the best that know only a bound, 1 - 1/T_N(1/(1 -
 * 1/D)). */
static double resolved(const state *s, int N)
{
  const double left = 1 - 1 / (1 + (double)(s->S / s->beta));
  if (!(left > 0)) return 1;
  return s->acceleration == (real)PLAIN ? 1 - pow(left, N)
                                        : 1 - 1 / chebyshev_polynomial(N, 1 / left);
}

/* K_eff = K B''(1) G^2,   G^2 = (m/rho_0)^2 |sum_j sin(k.x_ij) grad W_ij|^2/k^2 at k -> 0 */
static double effective_modulus(const state *s)
{
  const double angle[3] = {1e-3, 0, 0}, dx = (double)s->dx, V = (double)(s->mass / s->rho0);
  const struct kernel *kernel = &s->nb.kernel;
  const double unit = V * dx / angle[0], mode = lattice_mode(kernel, dx, angle);
  return (double)s->K * (1 + (double)s->energy) * unit * unit * mode * lattice_spread(kernel, dx);
}

/* The largest beta with which the stiffest mode's factor 1 - (1 + s)/(1 + S/beta) is above -1,
 *   s = dt^2 K/rho_0 (m/rho_0)^2 |sum_j sin(k.x_ij) grad W_ij|^2. */
static double largest_beta(const state *s)
{
  const double dx = (double)s->dx, V = (double)(s->mass / s->rho0), dt = (double)s->dt;
  const struct kernel *kernel = &s->nb.kernel;
  const double stiffest = lattice_stiffest(kernel, dx) * lattice_spread(kernel, dx);
  const double most = dt * dt * (double)(s->K / s->rho0) * V * V * stiffest;
  return most > 1 ? 2 * (double)s->S / (most - 1) : HUGE_VAL;
}

/* A stiffness that was asked for and that the iterations do not reach, and a fluid that the default
 * makes so soft that its own speed would compress it by a tenth. */
static void warn(const void *self, double speed, char *text, size_t size)
{
  const state *s = (const state *)self;
  const int N = (int)(s->fixed_iterations > 0 ? s->fixed_iterations : s->max_iterations);
  const double enough = 1 - pow(1 - 3 / (N + 3.0), N), part = resolved(s, N);
  const double modulus = part * effective_modulus(s);
  const double squeeze = (double)s->rho0 * speed * speed / (2 * modulus);
  if (s->acceleration == (real)PLAIN && (double)s->beta > largest_beta(s)) {
    snprintf(text, size, "beta %g is beyond %.3g, where iterations diverge", (double)s->beta,
             largest_beta(s));
    return;
  }
  if (part >= enough || (!s->given && squeeze < 0.1)) return;
  if (s->given)
    snprintf(text, size,
             "S = %.3g is more than %d iterations resolve, N/3 = %.3g with beta = 1: "
             "the fluid has %.2g %% of its stiffness K = %g Pa",
             (double)s->S, N, N / 3.0, 100 * part, (double)s->K);
  else
    snprintf(text, size,
             "S = %.3g is more than %d iterations resolve, N/3 = %.3g with beta = 1: "
             "the fluid is so soft (%.2g Pa) that its speed compresses it by %.2g %%",
             (double)s->S, N, N / 3.0, modulus, 100 * squeeze);
}

/* New particles have no modulus yet. */
static status changed(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  if (s->bulk) sweep(give_modulus, s);
  return OK;
}

static int uses(const void *self, const char *field)
{
  const state *s = (const state *)self;
  if (strcmp(field, "wet") == 0)
    return s->wall_pressure == (real)WALLS_ORDINARY && s->form == (real)EQ_14;
  if (strcmp(field, "bulk") == 0) return s->stiff_ratio != 1;
  if (strncmp(field, "last", 4) == 0) return s->acceleration == (real)CHEBYSHEV;
  if (field[0] == 'd' && field[1] != 'i')
    return s->acceleration == (real)ANDERSON && field[2] - '0' <= (int)s->history;
  return 1;
}

static const struct param params[] = PARAM_TABLE(PARAMS);
static const struct field fields[] = FIELD_TABLE(FIELDS);

const struct solver solver_sisph = {
  .abi = SOLVER_ABI,
  .name = "sisph",
  .about = "Semi-implicit SPH: successive substitution of positions that minimise a bulk energy",
  .paper = "X. He, S. Liu, Y. Guo, J. Shi, Y. Qiao, A Semi-Implicit SPH Method for Compressible "
           "and Incompressible Flows with Improved Convergence, Comput. Graph. Forum (2025)",
  .doi = "10.1111/cgf.70043",
  .differences = DIFFERENCES,
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(p),
  .can = CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) |
         CAN(PERIODIC) | CAN(ISOTROPIC) | CAN(FLUIDS) | CAN(MOVING_WALLS) | CAN(EMITTERS) |
         CAN(VISCOSITY) | CAN(TENSION),
  .params = params,
  .num_params = COUNT(params),
  .fields = fields,
  .num_fields = COUNT(fields),
  .state_size = sizeof(state),
  .start = start,
  .step = step,
  .changed = changed,
  .project = NULL,
  .max_dt = NULL,
  .uses = uses,
  .stop = NULL,
  .warn = warn,
};
