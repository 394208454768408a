/* The limits that warnings are about: what a lattice says of explicit viscosity, of sound and of
 * iterations, against all wave vectors and against what really happens. */
#include "../../core/run/warn.h"
#include "../../core/sph/lattice.h"
#include "../law/laws.h"

enum { WAVES = DIM == 2 ? 24 : 10, ACROSS = DIM == 2 ? 16 : 8 };

/* The largest eigenvalue of a symmetric matrix, by powers. */
static double largest_eigenvalue(double A[DIM][DIM])
{
  double v[DIM], value = 0;
  for (int d = 0; d < DIM; d++) v[d] = 1 + 0.3 * d;
  for (int k = 0; k < 200; k++) {
    double w[DIM], norm = 0;
    for (int a = 0; a < DIM; a++) {
      w[a] = 0;
      for (int b = 0; b < DIM; b++) w[a] += A[a][b] * v[b];
      norm += w[a] * w[a];
    }
    value = sqrt(norm);
    for (int a = 0; a < DIM; a++) v[a] = value > 0 ? w[a] / value : 1;
  }
  return value;
}

/* The friction of one wave vector, all of it [1/m^(d+2)]. */
static double friction(const struct kernel *kernel, const double k[3], int full)
{
  double M[DIM][DIM] = {{0}};
  const int reach = 1 + (int)((double)kernel->R / DX), deep = DIM == 3 ? reach : 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const double x[3] = {a * DX, b * DX, c * DX};
        const double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        if (r == 0) continue;
        double phase = 0;
        for (int d = 0; d < DIM; d++) phase += k[d] * x[d];
        const double pull = -2 * (double)kernel_dW(kernel, (real)r, DIM) / r * (1 - cos(phase));
        for (int m = 0; m < DIM; m++)
          for (int n = 0; n < DIM; n++)
            M[m][n] += pull * (full ? m == n : (DIM + 2) * x[m] * x[n] / (r * r));
      }
  return largest_eigenvalue(M);
}

static double stiffest_friction(const struct kernel *kernel, int full)
{
  double most = 0;
  for (int i = 0; i <= WAVES; i++)
    for (int j = 0; j <= WAVES; j++)
      for (int l = 0; l <= (DIM == 3 ? WAVES : 0); l++) {
        const double unit = (double)PI / WAVES / DX, k[3] = {i * unit, j * unit, l * unit};
        most = fmax(most, friction(kernel, k, full));
      }
  return most;
}

static void friction_of_all_waves(void **unused)
{
  (void)unused;
  for (int full = 0; full < 2; full++)
    for (int s = 0; s < 4; s++) {
      const struct kernel kernel = kernel_make(0, (real)((1.5 + 0.5 * s) * DX), DIM);
      const double found = lattice_most_friction(&kernel, DX, full);
      const double all = stiffest_friction(&kernel, full);
      if (fabs(found / all - 1) > 0.02)
        fail_msg("full %d, R %g: %g", full, 1.5 + s / 2., found / all);
    }
}

/* --- what happens at that step */

typedef struct {
  VIEW;
} state;

/* The runner's forces alone, at rest in space. */
static status step(struct run *run, void *self)
{
  (void)self;
  TRY(run_neighbours(run));
  return run_forces(run);
}

static const struct solver solver_still = {
  .abi = SOLVER_ABI,
  .name = "still",
  .about = "forces alone",
  .paper = "none",
  .doi = "none",
  .differences = "",
  .needs = HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(V),
  .can = ~0u,
  .state_size = sizeof(state),
  .step = step,
};

static struct scene fill(double nu, double dt, int full)
{
  struct scene s = empty_scene(0);
  unsigned bits = 1;
  s.common.viscosity = nu * s.common.rho0;
  s.common.viscosity_form = VISCOSITY_EXPLICIT;
  s.common.viscosity_pairs = full;
  s.common.dt = dt;
  vec low = zero(), high;
  for (int d = 0; d < DIM; d++) {
    s.low.c[d] = 0;
    s.high.c[d] = s.period.c[d] = high.c[d] = (real)(ACROSS * DX);
  }
  assert_int_equal(scene_fill_box(&s, low, high, zero(), NULL), OK);
  for (int i = 0; i < s.n; i++)
    for (int d = 0; d < DIM; d++) {
      bits = bits * 1664525u + 1013904223u;
      s.v[i].c[d] = (real)((double)(bits >> 8) / (1 << 24) - 0.5);
    }
  return s;
}

/* The factor by which what is left grows in a step, and the warnings before the first one. */
static double growth(double nu, double dt, int full, struct warnings *warnings)
{
  struct scene scene = fill(nu, dt, full);
  struct run *run;
  double before = 0, after = 0;
  assert_int_equal(run_create(&solver_still, NULL, &scene, 0, &run), OK);
  run->speed_limit = 0;
  run_warnings(run, warnings);
  for (int k = 0; k < 60; k++) {
    double sum;
    assert_int_equal(run_step(run), OK);
    physics_health(run->view, &sum, &after);
    if (k == 49) before = after;
  }
  run_free(run);
  return pow(after / before, 0.1);
}

static void viscosity_grows_beyond_its_limit(void **unused)
{
  (void)unused;
  const struct kernel kernel = kernel_make(0, (real)(2.5 * DX), DIM);
  for (int full = 0; full < 2; full++) {
    struct warnings w;
    const double nu = 0.1,
                 V =
                   DX * DX * (DIM == 3 ? DX : 1); /* of the lattice, to the ripple of the kernel */
    const double dt = 2 / (nu * V * lattice_most_friction(&kernel, DX, full));
    const double below = growth(nu, 0.95 * dt, full, &w);
    assert_int_equal(w.n, 0);
    const double beyond = growth(nu, 1.05 * dt, full, &w);
    assert_int_equal(w.n, 1);
    print_message("viscosity, full %d: stable up to %.4f dx^2/nu, factors %.3f and %.3f\n", full,
                  dt * nu / (DX * DX), below, beyond);
    assert_true(below < 1 && beyond > 1);
  }
}

/* --- the scale of speed */

static void speeds_that_the_energy_allows(void **unused)
{
  (void)unused;
  struct scene scene = block(9.81, 0, 0, zero());
  struct run *run;
  const double fall = (SIDE - 1) * DX;
  scene.v[0].c[0] = 2;
  assert_int_equal(run_create(&solver_still, NULL, &scene, 0, &run), OK);
  assert_true(fabs(run_energy_speed(run) / sqrt(4 + 2 * 9.81 * fall) - 1) < 1e-5);
  run_free(run);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(friction_of_all_waves),
    cmocka_unit_test(viscosity_grows_beyond_its_limit),
    cmocka_unit_test(speeds_that_the_energy_allows),
  };
  return cmocka_run_group_tests_name("warnings " SPHBENCH_VARIANT, tests, NULL, NULL);
}
