/* Weakly compressible SPH against its formulas by double loops, its sound waves against the
 * lattice's dispersion relation, and its energy (Monaghan 1994, Becker & Teschner 2007). */
#include "twin_solvers.h"

enum { SUMMED, CONTINUITY };
enum { BY_DENSITY, CLAMPED, FREE };
enum { NONE, MIRRORED };
struct choices {
  int density, clamp, walls;
  double c, gamma, alpha, cfl;
};

static double carried[TWIN_MOST], mean[TWIN_MOST]; /* density by continuity; p over the substeps */

/* 10 times the largest speed by energy */
static double twin_sound(const struct cloud *c)
{
  double drift[DIM] = {0}, deepest = -HUGE_VAL, most = 0, heaviest = 0;
  for (int i = 0; i < c->n; i++) {
    heaviest = fmax(heaviest, 1 / c->light[i]);
    for (int d = 0; d < DIM; d++) drift[d] += c->v[i][d] / c->n;
  }
  for (int j = 0; j < c->n_all; j++) {
    double depth = 0;
    for (int d = 0; d < DIM; d++) depth += c->gravity[d] * c->x[j][d];
    deepest = fmax(deepest, depth);
  }
  for (int j = 0; j < c->n_all; j++) {
    double v2 = 0;
    for (int d = 0; d < DIM; d++) v2 += (c->v[j][d] - drift[d]) * (c->v[j][d] - drift[d]);
    if (j < c->n) v2 += 2 * deepest;
    for (int d = 0; d < DIM && j < c->n; d++) v2 -= 2 * c->gravity[d] * c->x[j][d];
    most = fmax(most, j < c->n ? v2 / c->light[j] : v2 * heaviest);
  }
  return 10 * sqrt(most);
}

static int twin_substeps(const struct cloud *c, const struct choices *o)
{
  double lightest = 0;
  for (int i = 0; i < c->n; i++) lightest = fmax(lightest, c->light[i]);
  const double sound = o->c * sqrt(lightest) * (1 + 0.6 * o->alpha);
  return (int)ceil(c->dt * sound / (o->cfl * (double)c->kernel.R / 2));
}

/* d rho_i/dt = sum_j m_j v_ij.grad W_ij */
static void twin_continuity(const struct cloud *c)
{
  for (int i = 0; i < c->n; i++)
    for (int j = 0; j < c->n_all; j++)
      for (int d = 0; d < DIM; d++)
        carried[i] += c->dt * c->mass * (c->v[i][d] - c->v[j][d]) * twin_grad(c, i, j, d);
}

/* Monaghan's Pi_ij with the mean density and speed of sound; for two fluids with the harmonic mean
 * of the impedances z = rho c/sqrt(light) over rho_i rho_j */
static double twin_Pi(const struct cloud *c, const struct choices *o, int i, int j)
{
  const double h = (double)c->kernel.R / 2, r = twin_distance(c, i, j);
  double approach = 0;
  for (int d = 0; d < DIM; d++) approach += (c->v[i][d] - c->v[j][d]) * (c->x[i][d] - c->x[j][d]);
  if (approach >= 0 || j >= c->n) return 0;
  const double zi = c->rho[i] * o->c / sqrt(c->light[i]), zj = c->rho[j] * o->c / sqrt(c->light[j]);
  const double mu = h * approach / (r * r + 0.01 * h * h);
  return -o->alpha * mu * 2 * zi * zj / (zi + zj) / (c->rho[i] * c->rho[j]);
}

static void twin_push(struct cloud *c, const struct choices *o)
{
  static double dv[TWIN_MOST][DIM];
  memset(dv, 0, sizeof dv);
  for (int i = 0; i < c->n; i++)
    for (int j = 0; j < c->n_all; j++) {
      const double own = c->p[i] / (c->rho[i] * c->rho[i]);
      double push = own + twin_Pi(c, o, i, j);
      if (j < c->n) push += c->p[j] / (c->rho[j] * c->rho[j]);
      if (j >= c->n && o->walls == MIRRORED) push += own;
      for (int d = 0; d < DIM; d++)
        dv[i][d] -= c->dt * c->light[i] * c->mass * push * twin_grad(c, i, j, d);
    }
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += dv[i][d];
}

static void twin_substep(struct cloud *c, const struct choices *o)
{
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->x[i][d] += c->dt * c->v[i][d];
  if (o->density == CONTINUITY) twin_continuity(c);
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += c->dt * c->gravity[d];
  twin_density(c);
  if (c->xsph > 0) twin_viscosity(c, NULL);
  if (o->density == CONTINUITY) memcpy(c->rho, carried, sizeof carried);
  for (int i = 0; i < c->n; i++) {
    const double B = c->rho0 * o->c * o->c / o->gamma;
    c->p[i] = B * (pow(c->rho[i] / c->rho0, o->gamma) - 1);
    if (o->clamp == CLAMPED && c->p[i] < 0) c->p[i] = 0;
  }
  twin_push(c, o);
}

static void twin_step(struct cloud *c, const struct choices *o)
{
  const int n = twin_substeps(c, o);
  const double dt = c->dt, xsph = c->xsph;
  memset(mean, 0, sizeof mean);
  c->dt = dt / n, c->xsph = xsph / n;
  for (int k = 0; k < n; k++) {
    twin_substep(c, o);
    for (int i = 0; i < c->n; i++) mean[i] += c->p[i] / n;
  }
  c->dt = dt, c->xsph = xsph;
  memcpy(c->p, mean, sizeof mean);
}

enum { SIDE = DIM == 3 ? 6 : 13 };

/* Run and twin of a cloud; c = 0: as the energy says. */
static void compare_clouds(const struct cloud *start, int steps, struct choices o)
{
  static struct cloud run, twin;
  const struct setting settings[] = {
    {"density", o.density},
    {"clamp", o.clamp},
    {"wall_pressure", o.walls},
    {"c", o.c},
    {"gamma", o.gamma},
    {"alpha", o.alpha},
    {"cfl", o.cfl},
    {NULL, 0},
  };
  run = twin = *start;
  cloud_run(&run, &solver_wcsph, settings, steps);
  if (o.c == 0) o.c = twin_sound(&twin);
  if (o.clamp == BY_DENSITY) o.clamp = o.density == SUMMED ? CLAMPED : FREE;
  for (int i = 0; i < twin.n; i++) carried[i] = twin.rho0;
  for (int k = 0; k < steps; k++) twin_step(&twin, &o);
  if (getenv("TWIN_SHOW")) print_message("%d substeps, ", twin_substeps(start, &o));
  assert_same_cloud(&run, &twin, steps);
}

static void compare(int walls, int kernel, double xsph, int steps, struct choices o)
{
  static struct cloud c;
  cloud_make(&c, SIDE, walls, kernel, 17 + (unsigned long long)walls);
  c.xsph = (double)(real)xsph;
  compare_clouds(&c, steps, o);
}

static void test_free_fluid(void **unused)
{
  (void)unused;
  compare(0, KERNEL_CUBIC, 0, 1, (struct choices){SUMMED, BY_DENSITY, NONE, 8, 7, 0, 0.25});
  compare(0, KERNEL_SPIKY, 0, 1, (struct choices){SUMMED, FREE, NONE, 8, 1, 0, 0.5});
}
static void test_walls(void **unused)
{
  (void)unused;
  compare(1, KERNEL_WENDLAND2, 0, 1, (struct choices){SUMMED, CLAMPED, NONE, 8, 7, 0, 0.25});
  compare(1, KERNEL_WENDLAND2, 0, 1, (struct choices){SUMMED, FREE, MIRRORED, 8, 7, 0, 0.25});
}
static void test_continuity(void **unused)
{
  (void)unused;
  compare(1, KERNEL_CUBIC, 0, 1, (struct choices){CONTINUITY, BY_DENSITY, NONE, 16, 7, 0, 0.25});
  compare(0, KERNEL_CUBIC, 0, 3, (struct choices){CONTINUITY, CLAMPED, NONE, 16, 7, 0, 0.5});
}
static void test_artificial_viscosity(void **unused)
{
  (void)unused;
  compare(1, KERNEL_WENDLAND4, 0, 1, (struct choices){SUMMED, CLAMPED, NONE, 8, 7, 2, 0.25});
  compare(1, KERNEL_CUBIC, 0, 2, (struct choices){CONTINUITY, FREE, NONE, 8, 7, 0.125, 0.5});
}
static void test_scenes_viscosity(void **unused)
{
  (void)unused;
  compare(0, KERNEL_CUBIC, 0.05, 2, (struct choices){SUMMED, CLAMPED, NONE, 8, 7, 0, 0.5});
  compare(1, KERNEL_CUBIC, 0.05, 1, (struct choices){CONTINUITY, FREE, NONE, 8, 7, 0, 0.25});
}

/* The speed of sound that the energy asks: fluid alone, above still walls, towards fast ones. */
static void test_speed_of_sound(void **unused)
{
  (void)unused;
  static struct cloud c;
  const struct choices o = {CONTINUITY, FREE, NONE, 0, 7, 0, 0.4};
  for (int walls = 0; walls <= 2; walls++) {
    cloud_make(&c, SIDE, walls > 0, KERNEL_CUBIC, 3);
    if (walls == 1)
      for (int j = c.n; j < c.n_all; j++) c.v[j][0] = 0;
    if (walls == 2)
      for (int j = c.n; j < c.n_all; j++) c.v[j][0] = 8;
    compare_clouds(&c, 1, o);
  }
}

static void test_two_fluids(void **unused)
{
  (void)unused;
  static struct cloud c;
  cloud_make(&c, SIDE, 1, KERNEL_CUBIC, 23);
  cloud_mix(&c);
  compare_clouds(&c, 1, (struct choices){SUMMED, CLAMPED, NONE, 8, 7, 0.5, 0.25});
  compare_clouds(&c, 1, (struct choices){SUMMED, CLAMPED, MIRRORED, 8, 7, 0, 0.25});
  compare_clouds(&c, 1, (struct choices){CONTINUITY, FREE, NONE, 0, 7, 0, 0.4});
}

/* --- sound waves on a periodic lattice, against the linearised equations */

/* The lattice's box and wave: `squeeze` times dx apart, `wave` periods along x. */
struct sound {
  int side[3], wave, density, steps;
  double squeeze, c;
};
enum { LONG = 8, WIDE = 6 };
static const double WAVE_SIZE = sizeof(real) == 4 ? 1e-4 : 1e-7; /* of v over c */
static const double WAVE_TOLERANCE = sizeof(real) == 4 ? 2e-2 : 1e-5;

/* d2W/dx^2 at distance (x, r) */
static double twin_curvature(const struct kernel *k, double x, double r)
{
  const double e = (sizeof(real) == 4 ? 1e-2 : 1e-4) * (double)k->R;
  const double up = (double)kernel_dW(k, (real)(r + e), DIM);
  const double down = (double)kernel_dW(k, (real)(r - e), DIM);
  const double along = x * x / (r * r);
  return (up - down) / (2 * e) * along + (double)kernel_dW(k, (real)r, DIM) / r * (1 - along);
}

/* omega^2 = (c_s^2 - 2 p0/rho) |m sum sin(k x) W' x/r|^2 / rho^2
 *           + 2 m p0/rho^2 sum W_xx (1 - cos k x),   c_s^2 = dp/drho, of waves along x */
static double dispersion(const struct cloud *c, const struct sound *s)
{
  const double a = s->squeeze * c->dx, k = 2 * M_PI * s->wave / (LONG * a), gamma = 7;
  const int deep = DIM == 3 ? 4 : 0;
  double rho = 0, slope = 0, curvature = 0;
  for (int x = -4; x <= 4; x++)
    for (int y = -4; y <= 4; y++)
      for (int z = -deep; z <= deep; z++) {
        const double r = a * sqrt((double)(x * x + y * y + z * z));
        rho += c->mass * (double)kernel_W(&c->kernel, (real)r, DIM);
        if (r == 0 || r > (double)c->kernel.R) continue;
        slope += c->mass * sin(k * a * x) * (double)kernel_dW(&c->kernel, (real)r, DIM) * a * x / r;
        curvature += c->mass * twin_curvature(&c->kernel, a * x, r) * (1 - cos(k * a * x));
      }
  const double ratio = rho / c->rho0;
  const double p0 = c->rho0 * s->c * s->c / gamma * (pow(ratio, gamma) - 1);
  const double c2 = s->c * s->c * pow(ratio, gamma - 1);
  return (c2 - 2 * p0 / rho) * slope * slope / (rho * rho) + 2 * p0 / (rho * rho) * curvature;
}

static double lattice_x(const struct cloud *c, const struct sound *s, int i, int d)
{
  const int row = d == 0 ? i % LONG : d == 1 ? i / LONG % WIDE : i / LONG / WIDE;
  return s->squeeze * c->dx * (row + 0.5);
}
static double wave_at(const struct cloud *c, const struct sound *s, int i)
{
  /* even at half a spacing, so that the shortest wave is not 0 on all particles */
  const double x = lattice_x(c, s, i, 0) - lattice_x(c, s, 0, 0);
  return cos(2 * M_PI * s->wave * x / (LONG * s->squeeze * c->dx));
}

/* Amplitude of the velocity after all steps, over that at the start. */
static double measured_wave(struct cloud *c, const struct sound *s)
{
  const struct setting settings[] = {
    {"c", s->c}, {"alpha", 0}, {"density", s->density}, {"clamp", FREE}, {NULL, 0}};
  double values[64], amplitude = 0, norm = 0;
  for (int i = 0; i < c->n; i++) {
    for (int d = 0; d < DIM; d++) c->x[i][d] = lattice_x(c, s, i, d), c->v[i][d] = 0;
    c->v[i][0] = WAVE_SIZE * s->c * wave_at(c, s, i);
  }
  struct scene scene = cloud_scene(c);
  for (int d = 0; d < DIM; d++) {
    scene.low.c[d] = 0;
    scene.high.c[d] = scene.period.c[d] = (real)(s->squeeze * c->dx * (d == 0 ? LONG : WIDE));
  }
  struct run *run;
  struct snapshot now;
  set_values(&solver_wcsph, settings, values);
  assert_int_equal(run_create(&solver_wcsph, values, &scene, 0, &run), OK);
  for (int k = 0; k < s->steps; k++) assert_int_equal(run_step(run), OK);
  assert_false(run->diverged);
  assert_int_equal(run->iterations[0].last, 1); /* substeps */
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int i = 0; i < now.n; i++) {
    const double wave = wave_at(c, s, now.id[i]);
    amplitude += (double)now.v[i].c[0] * wave;
    norm += WAVE_SIZE * s->c * wave * wave;
  }
  snapshot_free(&now);
  run_free(run);
  return amplitude / norm;
}

/* x += dt v, v -= dt omega^2 x: what symplectic Euler makes of the wave, growing if omega^2 < 0 */
static void hear(int wave, double squeeze, int density, int stable)
{
  static struct cloud c;
  struct sound s = {{0}, wave, density, 30, squeeze, 20};
  cloud_make(&c, 2, 0, KERNEL_CUBIC, 1);
  memset(c.gravity, 0, sizeof c.gravity);
  c.n = c.n_all = LONG * WIDE * (DIM == 3 ? WIDE : 1);
  c.dt = (double)(real)(0.38 * (double)c.kernel.R / 2 / s.c);
  const double omega2 = dispersion(&c, &s), found = measured_wave(&c, &s);
  double x = 0, v = 1;
  for (int k = 0; k < s.steps; k++) {
    x += c.dt * v;
    v -= c.dt * omega2 * x;
  }
  if (getenv("TWIN_SHOW"))
    print_message("wave %d, squeeze %g: omega^2 %.6g, amplitude %.8f, found %.8f\n", wave, squeeze,
                  omega2, v, found);
  assert_true(stable ? omega2 >= -1e-9 * s.c * s.c : omega2 < 0);
  assert_true(fabs(found - v) < WAVE_TOLERANCE * fmax(1, fabs(v)));
}

static void test_sound_waves(void **unused)
{
  (void)unused;
  hear(1, 1, SUMMED, 1);
  hear(2, 1, SUMMED, 1);
  hear(1, 1, CONTINUITY, 1);
  hear(3, 1, CONTINUITY, 1);
}
/* under pressure, where the shortest wave is stable, and in tension, where it grows */
static void test_pressure_and_tension(void **unused)
{
  (void)unused;
  hear(1, 0.99, SUMMED, 1);
  hear(LONG / 2, 0.99, SUMMED, 1);
  hear(1, 1.01, SUMMED, 1);
  hear(LONG / 2, 1.01, SUMMED, 0);
}

/* --- energy */

/* sum_i m (v^2/2 - g.x + u),   u = int p/rho^2 drho, 0 at rho0 */
static double twin_energy(const struct cloud *c, const struct choices *o)
{
  double total = 0;
  for (int i = 0; i < c->n; i++) {
    double rho = 0;
    for (int j = 0; j < c->n_all; j++) rho += c->mass * twin_W(c, i, j);
    const double r = rho / c->rho0, g = o->gamma;
    const double u = o->c * o->c / g * (pow(r, g - 1) / (g - 1) + 1 / r - g / (g - 1));
    total += c->mass * (o->clamp == CLAMPED && r < 1 ? 0 : u);
    for (int d = 0; d < DIM; d++)
      total += c->mass * (c->v[i][d] * c->v[i][d] / 2 - c->gravity[d] * c->x[i][d]);
  }
  return total;
}

/* The largest error of the energy at the ends of some steps on walls at rest, over all of the
 * start. */
static double energy_error(struct choices o)
{
  static struct cloud start, c;
  const struct setting settings[] = {{"clamp", o.clamp}, {"wall_pressure", o.walls},
                                     {"c", o.c},         {"alpha", 0},
                                     {"cfl", o.cfl},     {NULL, 0}};
  double most = 0;
  cloud_make(&start, SIDE, 1, KERNEL_WENDLAND2, 29);
  for (int j = start.n; j < start.n_all; j++) start.v[j][0] = 0;
  for (int steps = 1; steps <= 6; steps++) {
    c = start;
    cloud_run(&c, &solver_wcsph, settings, steps);
    most = fmax(most, fabs(twin_energy(&c, &o) / twin_energy(&start, &o) - 1));
  }
  return most;
}

/* Plain walls: the error is that of the time step, of first order. Mirrored ones: it stays. */
static void test_energy(void **unused)
{
  (void)unused;
  for (int clamp = CLAMPED; clamp <= FREE; clamp++) {
    double error[2][2];
    for (int walls = NONE; walls <= MIRRORED; walls++)
      for (int fine = 0; fine <= 1; fine++)
        error[walls][fine] =
          energy_error((struct choices){SUMMED, clamp, walls, 10, 7, 0, fine ? 0.005 : 0.04});
    if (getenv("TWIN_SHOW"))
      print_message("energy off by %.3g, %.3g with 1/8 of the substep; mirrored %.3g, %.3g\n",
                    error[NONE][0], error[NONE][1], error[MIRRORED][0], error[MIRRORED][1]);
    assert_true(error[NONE][1] < 0.2 * error[NONE][0] && error[NONE][0] < 0.01);
    assert_true(error[MIRRORED][1] > 0.5 * error[MIRRORED][0]);
    assert_true(error[MIRRORED][1] > 5 * error[NONE][1]);
  }
}

/* A particle alone falls freely, whatever c: its density is below rho0. */
static void test_alone(void **unused)
{
  (void)unused;
  static struct cloud c;
  const struct setting settings[] = {{"cfl", 1}, {NULL, 0}};
  cloud_make(&c, 2, 0, KERNEL_CUBIC, 3);
  c.n = c.n_all = 1;
  const double v = c.v[0][DIM - 1];
  cloud_run(&c, &solver_wcsph, settings, 3);
  assert_true(fabs(c.v[0][DIM - 1] - (v + 3 * c.dt * c.gravity[DIM - 1])) < TWIN_TOLERANCE);
  assert_true(c.p[0] == 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_free_fluid),
    cmocka_unit_test(test_walls),
    cmocka_unit_test(test_continuity),
    cmocka_unit_test(test_artificial_viscosity),
    cmocka_unit_test(test_scenes_viscosity),
    cmocka_unit_test(test_speed_of_sound),
    cmocka_unit_test(test_two_fluids),
    cmocka_unit_test(test_sound_waves),
    cmocka_unit_test(test_pressure_and_tension),
    cmocka_unit_test(test_energy),
    cmocka_unit_test(test_alone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
