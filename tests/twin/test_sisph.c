/* Semi-implicit SPH against its formulas by double loops (He et al. 2025), in the paper's own
 * form: mu [J], W scaled so that lambda_i = V0 sum_j W_ij, positions and not increments. */
#include "twin_solvers.h"

enum { B0, B1, B2 };
enum { EQ_12, EQ_14 };
enum { STEP_NONE, STEP_PRINTED, STEP_REPAIRED };
enum { PLAIN, CHEBYSHEV, ANDERSON };
enum { ORDINARY, STILL, MIRRORED };
enum { GUARD_NONE, GUARD_PSI, GUARD_RESIDUAL };
enum { MOST_ITERATIONS = 16, COMPONENTS = DIM + 1 };

struct choices {
  int iterations, energy, form, walls, step_length, common, acceleration, depth, guard, unclamped,
    mixed;
  double beta, radius, K, ratio, split;
};
static const struct choices usual = {
  .iterations = 3, .form = EQ_14, .depth = 1, .beta = 1, .K = 1e6, .ratio = 1, .split = 1e30};

/* --- one sweep of Eq. (12) or (14) from the positions in c */

static char near[TWIN_MOST][TWIN_MOST];
static double x_star[TWIN_MOST][DIM], mu[TWIN_MOST], lambda[TWIN_MOST], S[TWIN_MOST];
static double residual[TWIN_MOST][DIM];
static int retreats;

static double V0(const struct cloud *c) { return pow(c->dx, DIM); }
static double true_mass(const struct cloud *c, int i) { return c->rho0 / c->light[i] * V0(c); }
static double B(int energy, double l)
{
  return energy == B0   ? (l - 1) * (l - 1) / 2
         : energy == B1 ? (l * l * l - 1) / 3 - l + 1
                        : (pow(l, 4) - 1) / 4 - l + 1;
}
static double B_plus(int energy, double l) { return pow(l, energy + 1); }

static void twin_neighbours(const struct cloud *c)
{
  for (int i = 0; i < c->n_all; i++)
    for (int j = 0; j < c->n_all; j++) near[i][j] = twin_distance(c, i, j) < (double)c->kernel.R;
}

/* Eq. (5), (6) and the clamp; walls never attract */
static void twin_lambda(struct cloud *c, const struct choices *o)
{
  for (int i = 0; i < c->n_all; i++) {
    c->rho[i] = 0;
    for (int j = 0; j < c->n_all; j++)
      if (near[i][j]) c->rho[i] += c->mass * twin_W(c, i, j);
    lambda[i] = c->rho[i] / c->rho0;
    if (lambda[i] < 1 && (i >= c->n || !o->unclamped)) lambda[i] = 1;
  }
}

/* psi_i of Eq. (7) */
static double twin_psi(const struct cloud *c, const struct choices *o, int i)
{
  double square = 0;
  for (int d = 0; d < DIM; d++) square += pow(c->x[i][d] - x_star[i][d], 2);
  return true_mass(c, i) * square / (2 * c->dt * c->dt) + mu[i] * B(o->energy, lambda[i]);
}

/* (dt^2/rho0_i) W'/r with the scaled W */
static double twin_a(const struct cloud *c, int i, int j)
{
  const double r = twin_distance(c, i, j), scaled = c->mass / (c->rho0 * V0(c));
  const double slope = (double)kernel_dW(&c->kernel, (real)r, DIM);
  return near[i][j] && r > 0 ? c->dt * c->dt * c->light[i] / c->rho0 * scaled * slope / r : 0;
}

/* S of a full lattice */
static double twin_lattice_S(const struct cloud *c, const struct choices *o)
{
  double total = 0;
  for (int a = -9; a <= 9; a++)
    for (int b = -9; b <= 9; b++)
      for (int d = DIM == 3 ? -9 : 0; d <= (DIM == 3 ? 9 : 0); d++) {
        const double r = c->dx * sqrt((double)(a * a + b * b + d * d));
        if (r > 0) total -= (double)kernel_dW(&c->kernel, (real)r, DIM) / r;
      }
  const double K = o->K * fmax(o->ratio, 1);
  return (o->form == EQ_14 ? 2 : 1) * K * pow(c->dt / c->rho0, 2) * c->mass * total;
}

/* S_i and the residual x*_i + sum A- (x_j - x_i) + sum A+ x_j - (1 + S_i) x_i of Eq. (12), (14) */
static void twin_sums(const struct cloud *c, const struct choices *o, int i)
{
  long double top[DIM], sum_plus = 0; /* what follows cancels */
  for (int d = 0; d < DIM; d++) top[d] = x_star[i][d];
  for (int j = 0; j < c->n_all; j++) {
    const int k = j >= c->n && o->walls == MIRRORED ? i : j; /* presses as i does */
    const int still = j >= c->n && o->walls == STILL;
    const double a = twin_a(c, i, j);
    double plus = -mu[i] * a, minus = mu[i] * a * B_plus(o->energy, lambda[i]);
    if (o->form == EQ_14 && !still) {
      plus += -mu[k] * a;
      minus += mu[k] * a * B_plus(o->energy, lambda[k]);
    }
    sum_plus += plus;
    for (int d = 0; d < DIM; d++)
      top[d] += (long double)minus * (c->x[j][d] - c->x[i][d]) + (long double)plus * c->x[j][d];
  }
  S[i] = (double)sum_plus;
  for (int d = 0; d < DIM; d++)
    residual[i][d] = (double)(top[d] - (1 + sum_plus) * (long double)c->x[i][d]);
}

/* Eq. (20), as printed or repaired; the slope is grad psi_i . dx_i */
static double twin_alpha(const struct cloud *c, const struct choices *o, int i, const double *dx)
{
  double slope = 0;
  if (o->step_length == STEP_NONE) return 1;
  if (o->step_length == STEP_REPAIRED && c->rho[i] <= c->rho0) return 1;
  for (int d = 0; d < DIM; d++) slope -= true_mass(c, i) / (c->dt * c->dt) * residual[i][d] * dx[d];
  return slope < 0 ? fmin(-twin_psi(c, o, i) / slope, 1) : 1;
}

/* g = what the sweep proposes: positions and, behind them, the pressures that acted; f = its step
 */
static double twin_substitute(struct cloud *c, const struct choices *o, double (*g)[COMPONENTS],
                              double (*f)[DIM])
{
  double largest = 0, square = 0;
  for (int i = 0; i < c->n; i++) twin_sums(c, o, i);
  for (int i = 0; i < c->n; i++) largest = fmax(largest, S[i]);
  for (int i = 0; i < c->n; i++) {
    const double D = 1 + (o->common ? largest : S[i]) / o->beta;
    double dx[DIM];
    for (int d = 0; d < DIM; d++) dx[d] = residual[i][d] / D, square += pow(residual[i][d], 2);
    const double alpha = twin_alpha(c, o, i, dx);
    const double P = mu[i] / V0(c) * (B_plus(o->energy, lambda[i]) - 1);
    for (int d = 0; d < DIM; d++) {
      f[i][d] = alpha * dx[d];
      g[i][d] = c->x[i][d] + f[i][d];
    }
    g[i][DIM] = c->p[i] + alpha * (P - c->p[i]) / D;
  }
  return square;
}

/* --- Eq. (21) - (23) */

static double past_g[MOST_ITERATIONS][TWIN_MOST][COMPONENTS];
static double past_f[MOST_ITERATIONS][TWIN_MOST][DIM];
static double past_x[MOST_ITERATIONS + 1][TWIN_MOST][COMPONENTS];

static long double residual_product(int n, int a, int b)
{
  long double total = 0;
  for (int i = 0; i < n; i++)
    for (int d = 0; d < DIM; d++) total += (long double)past_f[a][i][d] * past_f[b][i][d];
  return total;
}

/* Eq. (21): the a with sum 1 and the smallest |sum a_q f_q| over sweeps from..k, by Lagrange's
 * conditions and Gauss-Jordan with pivots */
static void twin_weights(int n, int from, int k, double *a)
{
  const int m = k - from + 1, size = m + 1;
  long double A[8][9];
  const long double unit = residual_product(n, k, k);
  for (int r = 0; r < size; r++)
    for (int q = 0; q <= size; q++)
      A[r][q] = r == m || q == m ? (r == m && q == m ? 0 : 1)
                : q < size       ? residual_product(n, from + r, from + q) / unit
                                 : 0;
  for (int r = 0; r < size; r++) A[r][size] = r == m;
  for (int p = 0; p < size; p++) {
    int best = p;
    for (int r = p; r < size; r++) best = fabsl(A[r][p]) > fabsl(A[best][p]) ? r : best;
    for (int q = 0; q <= size; q++) {
      const long double keep = A[p][q];
      A[p][q] = A[best][q], A[best][q] = keep;
    }
    for (int r = 0; r < size; r++) {
      const long double factor = A[r][p] / A[p][p];
      for (int q = 0; r != p && q <= size; q++) A[r][q] -= factor * A[p][q];
    }
  }
  for (int q = 0; q < m; q++) a[q] = (double)(A[q][size] / A[q][q]);
}

/* x_{k+1} of the accelerated iteration; `from` is the first sweep that Anderson may use */
static double twin_next(const struct choices *o, int n, int k, int from, int i, int d)
{
  static double a[8];
  if (o->acceleration == ANDERSON) {
    if (i == 0 && d == 0) twin_weights(n, from, k, a);
    double x = 0;
    for (int q = from; q <= k; q++) x += a[q - from] * past_g[q][i][d];
    return x;
  }
  double omega = 1;
  for (int q = 2; q <= k + 1 && o->acceleration == CHEBYSHEV; q++)
    omega = q == 2 ? 2 / (2 - o->radius * o->radius) : 4 / (4 - o->radius * o->radius * omega);
  const double before = k > 0 ? past_x[k - 1][i][d] : 0;
  return k > 0 ? omega * (past_g[k][i][d] - before) + before : past_g[k][i][d];
}

static void put(struct cloud *c, double (*x)[COMPONENTS])
{
  for (int i = 0; i < c->n; i++) {
    for (int d = 0; d < DIM; d++) c->x[i][d] = x[i][d];
    c->p[i] = x[i][DIM];
  }
}

static void twin_minimise(struct cloud *c, const struct choices *o)
{
  int from = 0, fast = 0;
  double kept = 0;
  const double matched = twin_lattice_S(c, o) / o->beta;
  struct choices now = *o;
  for (int k = 0; k < o->iterations; k++) {
    double psi = 0;
    twin_lambda(c, o);
    for (int i = 0; i < c->n; i++) psi += twin_psi(c, o, i);
    for (int i = c->n; i < c->n_all && o->walls == ORDINARY; i++)
      psi += mu[i] * B(o->energy, lambda[i]);
    for (int i = 0; i < c->n; i++) {
      for (int d = 0; d < DIM; d++) past_x[k][i][d] = c->x[i][d];
      past_x[k][i][DIM] = c->p[i];
    }
    const double square = twin_substitute(c, o, past_g[k], past_f[k]);
    if (o->radius == 0) now.radius = fmin(matched / (1 + matched), 0.995);
    const double merit = o->guard == GUARD_PSI ? psi : square;
    if (o->acceleration == ANDERSON && o->guard != GUARD_NONE && fast && merit > kept) {
      put(c, past_g[k - 1]);
      from = k + 1, fast = 0, retreats++;
      continue;
    }
    kept = merit;
    fast = o->acceleration == ANDERSON && k > from;
    if (k - from > o->depth) from = k - o->depth;
    if (o->acceleration == PLAIN) {
      put(c, past_g[k]);
      continue;
    }
    for (int i = 0; i < c->n; i++)
      for (int d = 0; d < COMPONENTS; d++)
        past_x[k + 1][i][d] = twin_next(&now, c->n, k, from, i, d);
    put(c, past_x[k + 1]);
  }
}

/* Algorithm 1 */
static void twin_step(struct cloud *c, const struct choices *o)
{
  static double old[TWIN_MOST][DIM];
  memcpy(old, c->x, sizeof old);
  memset(c->p, 0, sizeof c->p);
  for (int i = 0; i < c->n; i++) {
    for (int d = 0; d < DIM; d++) {
      c->v[i][d] += c->dt * c->gravity[d];
      c->x[i][d] += c->dt * c->v[i][d];
      x_star[i][d] = c->x[i][d];
    }
  }
  twin_neighbours(c);
  twin_minimise(c, o);
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] = (c->x[i][d] - old[i][d]) / c->dt;
  twin_lambda(c, o);
}

/* --- both, from the same cloud */

static void compare(int side, int walls, int kernel, int steps, struct choices o)
{
  static struct cloud run, twin;
  const struct setting settings[] = {
    {"energy", o.energy},
    {"form", o.form},
    {"wall_pressure", o.walls},
    {"fixed_iterations", o.iterations},
    {"K", o.K},
    {"stiff_ratio", o.ratio},
    {"split", o.split},
    {"clamp", o.unclamped},
    {"step_length", o.step_length},
    {"diagonal", o.common},
    {"beta", o.beta},
    {"acceleration", o.acceleration},
    {"spectral_radius", o.radius},
    {"history", o.depth},
    {"safeguard", o.guard},
    {NULL, 0},
  };
  cloud_make(&run, side, walls, kernel, 7 + (unsigned long long)walls);
  if (o.mixed) cloud_mix(&run);
  twin = run;
  for (int i = 0; i < run.n_all; i++) {
    const int other = i < run.n && (run.x[i][0] > o.split || (o.mixed && i % 2 == 0));
    mu[i] = o.K * V0(&run) * (other ? o.ratio : 1);
  }
  cloud_run(&run, &solver_sisph, settings, steps);
  retreats = 0;
  for (int k = 0; k < steps; k++) twin_step(&twin, &o);
  assert_same_cloud(&run, &twin, steps);
}

enum { SIDE = DIM == 3 ? 6 : 13 };

static void test_energies(void **unused)
{
  (void)unused;
  for (int energy = B0; energy <= B2; energy++) {
    struct choices o = usual;
    o.energy = energy;
    compare(SIDE, 0, KERNEL_SPIKY, 1, o);
  }
}
static void test_walls(void **unused)
{
  (void)unused;
  struct choices o = usual;
  for (o.walls = ORDINARY; o.walls <= MIRRORED; o.walls++) compare(SIDE, 1, KERNEL_CUBIC, 1, o);
  o.walls = ORDINARY;
  o.form = EQ_12;
  compare(SIDE, 1, KERNEL_CUBIC, 1, o);
}
static void test_unclamped(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.unclamped = 1;
  o.energy = B1;
  compare(SIDE, 1, KERNEL_WENDLAND2, 1, o);
}
static void test_diagonals(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.common = 1;
  compare(SIDE, 1, KERNEL_SPIKY, 1, o);
  o.beta = 3;
  compare(SIDE, 0, KERNEL_SPIKY, 1, o);
  o.common = 0;
  compare(SIDE, 0, KERNEL_SPIKY, 1, o);
}
static void test_step_lengths(void **unused)
{
  (void)unused;
  struct choices o = usual;
  for (o.step_length = STEP_PRINTED; o.step_length <= STEP_REPAIRED; o.step_length++)
    for (o.energy = B0; o.energy <= B2; o.energy++)
      compare(SIDE, o.energy == B2, KERNEL_SPIKY, 1, o);
}
static void test_soft_beside_stiff(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.ratio = 0.125;
  o.split = 0.4375;
  compare(SIDE, 1, KERNEL_SPIKY, 1, o);
}
/* Two fluids, the lighter one also softer. */
static void test_two_fluids(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.mixed = 1;
  compare(SIDE, 1, KERNEL_SPIKY, 1, o);
  o.ratio = 0.25;
  o.common = 1;
  o.step_length = STEP_REPAIRED;
  compare(SIDE, 0, KERNEL_CUBIC, 1, o);
}
static void test_chebyshev(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.acceleration = CHEBYSHEV;
  o.iterations = 5;
  o.radius = 0.875;
  compare(SIDE, 0, KERNEL_SPIKY, 1, o);
  o.radius = 0;
  o.common = 1;
  compare(SIDE, 1, KERNEL_SPIKY, 1, o);
  o.K = 1.28e8; /* beyond the cap on the matched radius */
  compare(SIDE, 0, KERNEL_SPIKY, 1, o);
}
static void test_anderson(void **unused)
{
  (void)unused;
  for (int depth = 1; depth <= 3; depth++) {
    struct choices o = usual;
    o.acceleration = ANDERSON;
    o.iterations = 5;
    o.depth = depth;
    compare(SIDE, depth % 2, KERNEL_SPIKY, 1, o);
  }
}
/* Both safeguards act: Psi with walls in it and, where it is no objective, with more to take back;
 * and the residual. */
static void test_safeguards(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.acceleration = ANDERSON;
  o.iterations = 12;
  o.guard = GUARD_PSI;
  o.walls = MIRRORED;
  compare(SIDE, 1, KERNEL_SPIKY, 1, o);
  assert_true(retreats > 0);
  o.walls = ORDINARY;
  o.beta = 3;
  o.K = DIM == 2 ? 2.56e8 : 1.6e7;
  o.energy = DIM == 2 ? B0 : B2;
  o.depth = DIM == 2 ? 1 : 3;
  compare(SIDE, 1, KERNEL_SPIKY, 1, o);
  assert_true(retreats > 0);
  o.guard = GUARD_RESIDUAL;
  o.energy = B2;
  o.depth = 3;
  o.K = 8e6;
  compare(SIDE, 0, KERNEL_SPIKY, 1, o);
  assert_true(retreats > 0);
}
static void test_two_steps(void **unused)
{
  (void)unused;
  struct choices o = usual;
  o.acceleration = ANDERSON;
  compare(SIDE, 0, KERNEL_CUBIC, 2, o);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_energies),     cmocka_unit_test(test_walls),
    cmocka_unit_test(test_unclamped),    cmocka_unit_test(test_diagonals),
    cmocka_unit_test(test_step_lengths), cmocka_unit_test(test_soft_beside_stiff),
    cmocka_unit_test(test_two_fluids),   cmocka_unit_test(test_chebyshev),
    cmocka_unit_test(test_anderson),     cmocka_unit_test(test_safeguards),
    cmocka_unit_test(test_two_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
