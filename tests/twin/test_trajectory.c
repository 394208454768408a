/* Weakly compressible SPH in time, at fixed spacing, against the ordinary differential equation
 * that it discretises, integrated by CVODE from double loops over all particles
 * (analysis/reference/particles.c); and that integration against known numbers. */
#include "../../analysis/reference/reference.h"
#include "twin_solvers.h"

#define SOUND 5.0
#define TIME 0.25

static void kernel_of(double r, double w[2], void *cloud)
{
  const struct cloud *c = cloud;
  w[0] = (double)kernel_W(&c->kernel, (real)r, DIM);
  w[1] = (double)kernel_dW(&c->kernel, (real)r, DIM);
}

static double rho0[TWIN_MOST];

static struct reference_particles equation(struct cloud *c)
{
  return (struct reference_particles){.n = c->n,
                                      .dim = DIM,
                                      .m = c->mass,
                                      .c = SOUND,
                                      .gamma = 1,
                                      .support = (double)c->kernel.R,
                                      .rho0 = rho0,
                                      .kernel = kernel_of,
                                      .user = c};
}

static void follow(struct cloud *c, const struct reference_particles *p, double t, double *error)
{
  static double x[TWIN_MOST * DIM], v[TWIN_MOST * DIM];
  memcpy(x, c->x, sizeof x), memcpy(v, c->v, sizeof v);
  if (reference_particle_flow(p, t, x, v, error)) fail_msg("%s", reference_error());
  memcpy(c->x, x, sizeof x), memcpy(c->v, v, sizeof v);
}

/* A disc or ball that stretches and turns, and contracts from the start: its density sums fall
 * below rho0 near the surface, and p may be negative. */
static void drop(struct cloud *c, double spacing)
{
  memset(c, 0, sizeof *c);
  c->dx = spacing;
  c->rho0 = 1;
  c->kernel = kernel_make(KERNEL_WENDLAND4, (real)(2.5 * c->dx), DIM);
  c->mass = twin_mass(c);
  const int most = (int)(1 / spacing) + 1;
  for (int a = -most; a <= most; a++)
    for (int b = -most; b <= most; b++)
      for (int e = DIM == 3 ? -most : 0; e <= (DIM == 3 ? most : 0); e++) {
        const double at[3] = {a * spacing, b * spacing, e * spacing};
        if (at[0] * at[0] + at[1] * at[1] + at[2] * at[2] > 1 + 1e-9) continue;
        assert_true(c->n < TWIN_MOST);
        for (int d = 0; d < DIM; d++) c->x[c->n][d] = at[d];
        c->v[c->n][0] = -at[0] + at[1] / 2;
        c->v[c->n][1] = at[1] - at[0] / 2;
        rho0[c->n++] = c->rho0;
      }
  c->n_all = c->n;
}

/* 81 particles, dx = 0.2, support 2.6 dx, c = 14, rho0_i = rho_i(0), v = (-x, y), to t = 0.5:
 * computed once by a program of its own with CVODE at 1e-13. */
static void test_known_drop(void **unused)
{
  (void)unused;
  if (DIM == 3) skip();
  static const struct {
    int kernel;
    double energy, highest, tolerance;
  } known[] = {{KERNEL_WENDLAND4, 0.8242085606534, 1.554995627434, 1e-11},
               {KERNEL_WENDLAND2, 0.8186628735959, 1.553505716676, 1e-10},
               {KERNEL_CUBIC, 0.8197628313632, 1.543094771099, 1e-9}};
  for (int k = 0; k < COUNT(known); k++) {
    static struct cloud c;
    double error, energy = 0, highest = 0, momentum[2] = {0}, spin = 0;
    drop(&c, 0.2);
    assert_int_equal(c.n, 81);
    c.kernel = kernel_make(known[k].kernel, (real)0.52, DIM);
    c.mass = c.dx * c.dx;
    twin_density(&c);
    memcpy(rho0, c.rho, sizeof rho0);
    for (int i = 0; i < c.n; i++) c.v[i][0] = -c.x[i][0], c.v[i][1] = c.x[i][1];
    struct reference_particles p = equation(&c);
    p.c = 14;
    follow(&c, &p, 0.5, &error);
    for (int i = 0; i < c.n; i++) {
      energy += c.mass / 2 * (c.v[i][0] * c.v[i][0] + c.v[i][1] * c.v[i][1]);
      highest = fmax(highest, c.x[i][1]);
      for (int d = 0; d < 2; d++) momentum[d] += c.mass * c.v[i][d];
      spin += c.mass * (c.x[i][0] * c.v[i][1] - c.x[i][1] * c.v[i][0]);
    }
    print_message("kernel %d: kinetic energy off by %.1e, highest by %.1e, said %.1e; momentum "
                  "%.0e %.0e, angular %.0e\n",
                  known[k].kernel, energy - known[k].energy, highest - known[k].highest, error,
                  momentum[0], momentum[1], spin);
    assert_true(fabs(energy - known[k].energy) < known[k].tolerance);
    assert_true(fabs(highest - known[k].highest) < known[k].tolerance);
    assert_true(fabs(momentum[0]) + fabs(momentum[1]) + fabs(spin) < 1e-14);
    assert_true(error < 1e-8);
    assert_true(fabs(highest - known[k].highest) < error + 1e-12);
  }
}

/* The solver from `start` in `steps` steps of one substep each: position and velocity errors. */
static void run_solver(const struct cloud *start, const struct cloud *truth, int steps, int half,
                       double off[2])
{
  static struct cloud c;
  const struct setting settings[] = {{"c", SOUND}, {"gamma", 1}, {"clamp", 2},
                                     {"alpha", 0}, {"cfl", 2},   {NULL, 0}};
  c = *start;
  c.dt = TIME / steps;
  for (int i = 0; i < c.n && half; i++)
    for (int d = 0; d < DIM; d++) c.x[i][d] -= c.dt / 2 * c.v[i][d];
  cloud_run(&c, &solver_wcsph, settings, steps);
  for (int i = 0; i < c.n && half; i++)
    for (int d = 0; d < DIM; d++) c.x[i][d] += c.dt / 2 * c.v[i][d];
  off[0] = apart(c.x[0], truth->x[0], c.n * DIM, 1);
  off[1] = apart(c.v[0], truth->v[0], c.n * DIM, 1);
}

/* A step moves and then pushes: symplectic Euler, of first order. From positions half a step back
 * it is the leapfrog, of second order at positions half a step on. */
static void test_order_in_time(void **unused)
{
  (void)unused;
  enum { LEVELS = 5 };
  static struct cloud start, truth;
  double error, off[LEVELS][2];
  drop(&start, DIM == 3 ? 0.25 : 0.125);
  truth = start;
  const struct reference_particles p = equation(&truth);
  follow(&truth, &p, TIME, &error);
  print_message("%d particles, reference good to %.1e\n", start.n, error);
  for (int half = 0; half < 2; half++) {
    const double order = 1 + half;
    for (int k = 0; k < LEVELS; k++) {
      run_solver(&start, &truth, 64 << k, half, off[k]);
      print_message("%s, %3d steps: x %.3e", half ? "leapfrog" : "Euler", 64 << k, off[k][0]);
      print_message(", v %.3e", off[k][1]);
      for (int q = 0; q < 2 && k > 0; q++)
        print_message("%s %.3f", q ? "," : "; orders", log2(off[k - 1][q] / off[k][q]));
      print_message("\n");
    }
    for (int q = 0; q < 2; q++) {
      const double last = log2(off[LEVELS - 2][q] / off[LEVELS - 1][q]);
      assert_true(fabs(last - order) < (half ? 0.02 : 0.1));
      assert_true(error < 1e-3 * off[LEVELS - 1][q]);
    }
    assert_true(off[LEVELS - 1][0] < (half ? 1e-5 : 2e-3));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_known_drop),
    cmocka_unit_test(test_order_in_time),
  };
  return cmocka_run_group_tests_name("trajectory " SPHBENCH_VARIANT, tests, NULL, NULL);
}
