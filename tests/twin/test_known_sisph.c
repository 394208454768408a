/* Semi-implicit SPH against what is known of it: minimisers of Psi computed elsewhere, Psi's
 * gradient by differences, the stiffness that N iterations reach, momentum, rates of convergence.
 *
 * tests/data/sisph_fixture_64_*.csv are this project's own computations: 4^3 particles whose x* is
 * given by a formula in the files' headers, and the minimiser of Psi of Eq. (7) from it by Newton's
 * method with Cholesky's factors in long double, |grad Psi| < 1e-16 N. */
#include "twin_solvers.h"

enum { B0, B1, B2 };
enum { EQ_12, EQ_14 };
enum { OWN, COMMON };
enum { PLAIN, CHEBYSHEV, ANDERSON };
enum { CLAMPED, FREE };
enum { IS_DOUBLE = sizeof(real) == 8 };
#define SAID(condition, ...)    \
  do {                          \
    print_message(__VA_ARGS__); \
    assert_true(condition);     \
  } while (0)

/* --- Psi of Eq. (7) by double loops */

static double x_star[TWIN_MOST][DIM];

static double V0(const struct cloud *c) { return pow(c->dx, DIM); }

/* e = lambda - 1 */
static double energy(int kind, double e)
{
  return kind == B0 ? e * e / 2 : kind == B1 ? e * e * (1 + e / 3) : e * e * (1.5 + e + e * e / 4);
}

static double psi(const struct cloud *c, int kind, double mu)
{
  long double total = 0;
  for (int i = 0; i < c->n; i++) {
    double rho = 0, moved = 0;
    for (int j = 0; j < c->n; j++) rho += c->mass * twin_W(c, i, j);
    for (int d = 0; d < DIM; d++) moved += pow(c->x[i][d] - x_star[i][d], 2);
    total += c->rho0 * V0(c) * moved / (2 * c->dt * c->dt);
    total += mu * energy(kind, fmax(rho / c->rho0 - 1, 0));
  }
  return (double)total;
}

/* The fixtures' block: side^DIM particles, squeezed, with their jitter; at rest, so that x* = x */
static void block_make(struct cloud *c, double support, int side, double squeeze)
{
  memset(c, 0, sizeof *c);
  c->dx = (double)(real)0.005;
  c->dt = (double)(real)1e-3;
  c->rho0 = 1000;
  c->kernel = kernel_make(KERNEL_SPIKY, (real)(support * c->dx), DIM);
  c->mass = twin_mass(c);
  c->n = c->n_all = (int)lround(pow(side, DIM));
  assert_true(c->n <= TWIN_MOST);
  for (int id = 0; id < c->n; id++)
    for (int k = DIM - 1, rest = id; k >= 0; k--, rest /= side)
      c->x[id][k] =
        (double)(real)(squeeze * c->dx * (rest % side + 0.05 * sin(1 + 3.7 * id + 1.9 * k)));
  memcpy(x_star, c->x, sizeof x_star);
}

struct choices {
  int iterations, kind, form, diagonal, acceleration, depth, guard;
  double mu, beta, radius;
};
static const struct choices usual = {
  .iterations = 10, .form = EQ_14, .depth = 1, .guard = 2, .mu = 1, .beta = 1};

/* One step of the solver from x* = x; returns Psi */
static double minimise(struct cloud *c, struct choices o)
{
  const struct setting settings[] = {
    {"mu", o.mu},
    {"fixed_iterations", o.iterations},
    {"energy", o.kind},
    {"form", o.form},
    {"diagonal", o.diagonal},
    {"acceleration", o.acceleration},
    {"history", o.depth},
    {"safeguard", o.guard},
    {"beta", o.beta},
    {"spectral_radius", o.radius},
    {NULL, 0},
  };
  cloud_run(c, &solver_sisph, settings, 1);
  return psi(c, o.kind, o.mu);
}

static struct choices converging(int iterations)
{
  struct choices o = usual;
  o.acceleration = ANDERSON;
  o.depth = 5;
  o.iterations = iterations;
  return o;
}

/* --- minimisers computed elsewhere */

static void read_minimiser(const char *name, const struct cloud *c, double (*x)[DIM])
{
  char path[512], line[512];
  snprintf(path, sizeof path, SPHBENCH_SOURCE_DIR "/tests/data/sisph_fixture_64_%s.csv", name);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  int rows = 0;
  while (fgets(line, sizeof line, file)) {
    int id;
    double s[3], m[3];
    if (sscanf(line, "%d,%lf,%lf,%lf,%lf,%lf,%lf", &id, s, s + 1, s + 2, m, m + 1, m + 2) != 7)
      continue;
    for (int d = 0; d < DIM; d++) {
      assert_true(fabs(s[d] - c->x[id][d]) < 1e-12 * c->dx);
      x[id][d] = m[d];
    }
    rows++;
  }
  fclose(file);
  assert_int_equal(rows, c->n);
}

static void test_minimisers(void **unused)
{
  (void)unused;
  if (DIM == 2 || !IS_DOUBLE) skip();
  static const struct {
    const char *name;
    int kind, iterations;
    double support, before, least;
  } fixture[] = {
    {"B0", B0, 500, 2, 0.067633566341092344, 0.000436267083155639008},
    {"B1", B1, 500, 2, 0.14113940480221992, 0.000438185593968404566},
    {"B2", B2, 500, 2, 0.221092130827422758, 0.000438829677397419892},
    {"H1p2_B0", B0, 1000, 1.2, 0.0163330722781068655, 0.000633045379742224339},
  };
  for (int k = 0; k < 4; k++) {
    static struct cloud c;
    static double x[TWIN_MOST][DIM];
    struct choices o = converging(fixture[k].iterations);
    o.kind = fixture[k].kind;
    block_make(&c, fixture[k].support, 4, 0.95);
    read_minimiser(fixture[k].name, &c, x);
    const double before = psi(&c, o.kind, 1), after = minimise(&c, o);
    const double off = apart(c.x[0], x[0], c.n * DIM, c.dx);
    print_message("%-8s Psi(x*) off by %.1e, least Psi by %.1e, positions by %.1e dx\n",
                  fixture[k].name, before - fixture[k].before, after - fixture[k].least, off);
    assert_true(fabs(before - fixture[k].before) < 1e-14);
    assert_true(fabs(after - fixture[k].least) < 1e-15);
    assert_true(off < 1e-8);
  }
}

/* The plain iteration's error (Psi - least)/(Psi(x*) - least) after k sweeps, as found by an
 * independent program. */
static void test_plain_rate(void **unused)
{
  (void)unused;
  if (DIM == 2 || !IS_DOUBLE) skip();
  static const struct {
    int k;
    double error;
  } known[] = {{1, 0.651},    {2, 0.442},   {5, 0.157},    {10, 3.41e-2},
               {20, 2.21e-3}, {50, 3.6e-5}, {200, 1.8e-5}, {1000, 1.9e-6}};
  static struct cloud c;
  for (int k = 0; k < COUNT(known); k++) {
    struct choices o = usual;
    o.iterations = known[k].k;
    block_make(&c, 2, 4, 0.95);
    const double least = 0.000436267083155639008, before = psi(&c, B0, 1);
    const double error = (minimise(&c, o) - least) / (before - least);
    assert_true(fabs(error / known[k].error - 1) < 0.03);
  }
}

/* Eq. (14) is gradient descent on Psi:   (1 + S_i) (x^{k+1}_i - x^k_i) = -h^2/m grad_i Psi(x^k) */
static void test_gradient(void **unused)
{
  (void)unused;
  if (!IS_DOUBLE) skip();
  static struct cloud one, two;
  for (int kind = B0; kind <= B2; kind++) {
    struct choices o = usual;
    double worst = 0, largest = 0;
    o.kind = kind;
    o.mu = DIM == 3 ? 0.1 : 10;
    block_make(&one, 2, DIM == 3 ? 4 : 7, 0.95);
    two = one;
    o.iterations = 1, minimise(&one, o);
    o.iterations = 2, minimise(&two, o);
    for (int i = 0; i < one.n; i++) {
      double S = 0;
      for (int j = 0; j < one.n; j++) {
        const double r = twin_distance(&one, i, j), K = o.mu / V0(&one);
        const double slope = (double)kernel_dW(&one.kernel, (real)r, DIM);
        if (j != i) S -= 2 * K * pow(one.dt / one.rho0, 2) * one.mass * slope / r;
      }
      for (int d = 0; d < DIM; d++) {
        struct cloud *c = &one;
        const double at = c->x[i][d], step = 1e-5 * c->dx;
        c->x[i][d] = at + step;
        const double more = psi(c, kind, o.mu);
        c->x[i][d] = at - step;
        const double less = psi(c, kind, o.mu);
        c->x[i][d] = at;
        const double wanted = -c->dt * c->dt / (c->rho0 * V0(c)) * (more - less) / (2 * step);
        worst = fmax(worst, fabs((1 + S) * (two.x[i][d] - at) - wanted));
        largest = fmax(largest, fabs(wanted));
      }
    }
    SAID(worst < 1e-7 * largest, "B%d: fixed-point map off the gradient by %.1e\n", kind,
         worst / largest);
  }
}

/* --- momentum: exact with a common diagonal, else lost until converged */

static double defect(double support, struct choices o)
{
  static struct cloud c;
  double lost[DIM] = {0}, square = 0, exchanged = 0;
  block_make(&c, support, DIM == 3 ? 4 : 8, 0.95);
  if (DIM == 2) o.mu /= c.dx; /* about the same modulus */
  minimise(&c, o);
  for (int i = 0; i < c.n; i++) {
    double v2 = 0;
    for (int d = 0; d < DIM; d++) lost[d] += c.v[i][d], v2 += c.v[i][d] * c.v[i][d];
    exchanged += sqrt(v2);
  }
  for (int d = 0; d < DIM; d++) square += lost[d] * lost[d];
  return sqrt(square) / exchanged;
}

static void test_momentum(void **unused)
{
  (void)unused;
  const double rounding = IS_DOUBLE ? 1e-14 : 1e-5;
  for (int narrow = 0; narrow < 2; narrow++) {
    const double support = narrow ? 1.2 : 2;
    for (int N = 1; N <= 50; N = N == 1 ? 10 : 5 * N) {
      struct choices o = usual;
      o.iterations = N;
      const double own = defect(support, o);
      o.form = EQ_12;
      const double one_sided = defect(support, o);
      o.form = EQ_14;
      o.diagonal = COMMON;
      const double common = defect(support, o);
      o.acceleration = ANDERSON;
      const double accelerated = defect(support, o);
      SAID(common < rounding && accelerated < rounding && own < (narrow ? 0.1 : 5e-3) &&
             own > 10 * rounding,
           "R %g dx, N %2d: common %.1e, with Anderson %.1e, own %.1e, Eq. (12) %.1e\n", support, N,
           common, accelerated, own, one_sided);
    }
    if (IS_DOUBLE) assert_true(defect(support, converging(1500)) < 1e-8);
  }
}

/* --- rates: iterations to errors of 1e-1, 1e-2 and 1e-3 at S = 10, R = 1.2 dx, 3-D */

static void count_iterations(struct choices o, double least, int counts[3])
{
  static struct cloud start, c;
  block_make(&start, 1.2, 7, 0.95);
  const double before = psi(&start, B0, o.mu);
  for (int k = 0, N = 1; k < 3; N++) {
    assert_true(N < 100);
    o.iterations = N;
    c = start;
    const double error = (minimise(&c, o) - least) / (before - least);
    for (; k < 3 && error <= pow(10, -1 - k); k++) counts[k] = N;
  }
}

static void test_rates(void **unused)
{
  (void)unused;
  if (DIM == 2 || !IS_DOUBLE) skip();
  struct choices plain = usual;
  static struct cloud c;
  block_make(&c, 1.2, 7, 0.95);
  plain.mu = 10 / (0.81 * c.dt * c.dt / (c.rho0 * c.dx * c.dx * V0(&c)));
  struct choices best = converging(400), anderson = plain, chebyshev = plain, third = plain;
  struct choices common = plain, both = plain;
  best.mu = plain.mu;
  const double least = minimise(&c, best);
  anderson.acceleration = both.acceleration = ANDERSON;
  chebyshev.acceleration = CHEBYSHEV;
  chebyshev.radius = 0.9;
  third.beta = both.beta = 3;
  both.depth = 3;
  common.diagonal = COMMON;
  const struct {
    const char *name;
    struct choices o;
    int expected[3]; /* of another block of unknown shape; 0: none */
  } way[] = {
    {"plain", plain, {9, 20, 32}},           {"Anderson(1)", anderson, {3, 6, 10}},
    {"Chebyshev .9", chebyshev, {4, 7, 10}}, {"1 + S/3", third, {0, 0, 0}},
    {"common", common, {0, 0, 0}},           {"1 + S/3, Anderson(3)", both, {0, 0, 0}},
  };
  int n[6][3];
  for (int k = 0; k < 6; k++) {
    count_iterations(way[k].o, least, n[k]);
    print_message("%-21s %d/%d/%d\n", way[k].name, n[k][0], n[k][1], n[k][2]);
    for (int q = 0; q < 3 && way[k].expected[0]; q++)
      assert_true(3 * n[k][q] >= 2 * way[k].expected[q] && 2 * n[k][q] <= 3 * way[k].expected[q]);
  }
  const double faster = n[0][2] / (double)n[3][2], slower = n[4][2] / (double)n[0][2];
  assert_true(faster > 2.3 && faster < 3.3);
  assert_true(slower > 1.1 && slower < 1.7);
  assert_true(n[5][2] <= n[1][2] && n[5][2] <= n[2][2]);
}

/* --- stiffness: a long wave of displacement eps sin(k x) in a periodic lattice at rest gets the
 * acceleration -K_apparent/rho0 k^2 eps sin(k x) from one step */

static const double wave_eps = 0.02; /* [dx] */

static struct scene strip(int length, int width, double support)
{
  struct scene s;
  const double dx = 0.01;
  memset(&s, 0, sizeof s);
  s.n = s.capacity = length * (int)lround(pow(width, DIM - 1));
  s.x = calloc((size_t)s.n + 1, sizeof(vec));
  s.v = calloc((size_t)s.n + 1, sizeof(vec));
  for (int i = 0; i < s.n; i++) {
    for (int d = 0, rest = i, m = length; d < DIM; d++, rest /= m, m = width)
      s.x[i].c[d] = (real)(dx * (rest % m + 0.5));
    const double phase = 2 * (double)PI * (i % length + 0.5) / length;
    s.x[i].c[0] += (real)(dx * wave_eps * sin(phase));
  }
  for (int d = 0; d < DIM; d++)
    s.high.c[d] = s.period.c[d] = (real)(dx * (d == 0 ? length : width));
  s.common.spacing = dx, s.common.dt = 1e-3, s.common.t_end = 1, s.common.samples = 1;
  s.common.support = support, s.common.kernel = KERNEL_SPIKY, s.common.rho0 = 1000;
  return s;
}

static double resolved(const struct run *run, const char *name)
{
  const struct param *p = param_find(run->solver->params, run->solver->num_params, name);
  assert_non_null(p);
  return (double)*(const real *)((const char *)run->state + p->offset);
}

struct response {
  double S, modulus, pressure; /* K_apparent / K; amplitude of p over what would give that */
};

static struct response respond(int length, int width, double support, double K, int N)
{
  struct scene scene = strip(length, width, support);
  struct run *run;
  struct snapshot now;
  double values[64], v = 0, p = 0;
  const struct setting settings[] = {{"K", K}, {"fixed_iterations", N}, {"clamp", FREE}, {NULL, 0}};
  set_values(&solver_sisph, settings, values);
  assert_int_equal(run_create(&solver_sisph, values, &scene, 0, &run), OK);
  const struct scene_params *c = &run->scene.common;
  const double k = 2 * (double)PI / (length * c->spacing), eps = wave_eps * c->spacing;
  const double S = resolved(run, "S");
  assert_int_equal(run_step(run), OK);
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int i = 0; i < now.n; i++) {
    const double phase = 2 * (double)PI * (now.id[i] % length + 0.5) / length;
    v += 2.0 / now.n * (double)now.v[i].c[0] * sin(phase);
    p += 2.0 / now.n * (double)now.p[i] * cos(phase);
  }
  const double modulus = -v / c->dt * c->rho0 / (k * k * eps) / K;
  snapshot_free(&now);
  run_free(run);
  return (struct response){S, modulus, -p / (K * k * eps)};
}

/* K_apparent = K_eff (1 - (S/(1 + S))^N), K_eff = K G^2; and the pressure is the one that did it:
 * p = K_apparent/G k eps. */
static void test_stiffness(void **unused)
{
  (void)unused;
  static const double S[] = {0.1, 1, 10, 100, 400}, support[] = {1.2, 2};
  static const double G2[2][2] = {{0.0186, 0.0183}, {0.484, 0.598}};
  static const double chi[2][2] = {{0.55, 0.81}, {2.33, 3.35}};
  static const int N[] = {1, 10, 50};
  const int length = 128;
  double worst = 0, worst_p = 0;
  for (int r = 0; r < 2; r++) {
    const int width = r == 0 ? 4 : 6;
    const struct response unit = respond(length, width, support[r], 1e3, 20);
    const double G = sqrt(G2[r][DIM - 2]), K_of_chi = 1000 * 1e-4 / 1e-6; /* rho0 dx^2/dt^2 */
    print_message("R %g dx: K_eff/K %.4f, S/chi %.3f\n", support[r], unit.modulus,
                  unit.S * K_of_chi / 1e3);
    assert_true(fabs(unit.modulus / G2[r][DIM - 2] - 1) < 0.01);
    assert_true(fabs(unit.S * K_of_chi / 1e3 / chi[r][DIM - 2] - 1) < 0.01);
    for (int s = 0; s < 5; s++) {
      for (int k = 0; k < 3; k++) {
        const struct response now = respond(length, width, support[r], 1e3 * S[s] / unit.S, N[k]);
        const double phi = 1 - pow(S[s] / (1 + S[s]), N[k]);
        worst = fmax(worst, fabs(now.modulus / (G2[r][DIM - 2] * phi) - 1));
        worst_p = fmax(worst_p, fabs(now.pressure * G / now.modulus - 1));
      }
    }
  }
  SAID(worst < 0.06 && worst_p < 0.01,
       "K_apparent off the law by %.2g at most, the pressure by %.2g\n", worst, worst_p);
}

/* --- stiffness as given and as shown */

static status start_with(const struct setting *settings, double *K, double *mu)
{
  static struct cloud c;
  double values[64];
  struct run *run;
  block_make(&c, 2, 3, 1);
  struct scene scene = cloud_scene(&c);
  set_values(&solver_sisph, settings, values);
  const status made = run_create(&solver_sisph, values, &scene, 0, &run);
  if (made == OK) *K = resolved(run, "K"), *mu = resolved(run, "mu");
  run_free(run);
  return made;
}

static void test_resolved(void **unused)
{
  (void)unused;
  double K, mu;
  const double volume = pow(0.005, DIM);
  const struct setting by_K[] = {{"K", 3e5}, {NULL, 0}}, by_mu[] = {{"mu", 2}, {NULL, 0}};
  const struct setting none[] = {{NULL, 0}}, both[] = {{"K", 1}, {"mu", 2}, {NULL, 0}};
  assert_int_equal(start_with(by_K, &K, &mu), OK);
  assert_true(fabs(mu / (3e5 * volume) - 1) < 1e-6);
  assert_int_equal(start_with(by_mu, &K, &mu), OK);
  assert_true(fabs(K * volume / 2 - 1) < 1e-6);
  assert_int_equal(start_with(none, &K, &mu), OK);
  assert_true(K == 1e6);
  assert_int_equal(start_with(both, &K, &mu), ERR_USER);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_minimisers), cmocka_unit_test(test_plain_rate),
    cmocka_unit_test(test_gradient),   cmocka_unit_test(test_momentum),
    cmocka_unit_test(test_rates),      cmocka_unit_test(test_stiffness),
    cmocka_unit_test(test_resolved),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
