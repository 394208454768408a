/* Drops with surface tension, for every solver that can apply it. */
#include "laws.h"

enum { AKINCI, HE, EDGE = DIM == 2 ? 12 : 8 };

static struct run *start(const struct solver *solver, struct scene *scene)
{
  struct run *run;
  double values[64];
  for (int k = 0; k < solver->num_params; k++) {
    values[k] = solver->params[k].initial;
    /* without it nothing holds the density against a force */
    if (strcmp(solver->params[k].name, "kappa") == 0) values[k] = 0.1;
  }
  if (run_create(solver, values, scene, 0, &run) != OK)
    fail_msg("%s: %s", solver->name, status_sentence());
  return run;
}

static void advance(struct run *run)
{
  assert_int_equal(run_step(run), OK);
  if (run->diverged) fail_msg("%s: %s", run->solver->name, run->reason);
}

/* How far from round: sum_d x_d^4 over |x|^4, less its value for a ball, 3/(DIM + 2). */
static double out_of_round(const struct run *run)
{
  double fourth = 0, all = 0;
  for (int i = 0; i < run->view->p.n; i++) {
    const vec x = run->view->p.x[i];
    for (int d = 0; d < DIM; d++) fourth += pow((double)x.c[d], 4);
    all += pow((double)inner(x, x), 2);
  }
  return fabs(fourth / all - 3.0 / (DIM + 2));
}

/* A square or cube rounds off. */
static void corners_vanish(void **unused)
{
  (void)unused;
  for (int form = AKINCI; form <= HE; form++)
    FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(TENSION) | CAN(VISCOSITY))
    {
      struct scene s = empty_scene(0);
      vec low, high;
      for (int d = 0; d < DIM; d++) {
        low.c[d] = (real)(-EDGE * DX / 2);
        high.c[d] = (real)(EDGE * DX / 2);
      }
      assert_int_equal(scene_fill_box(&s, low, high, zero(), NULL), OK);
      s.common.tension = 5, s.common.tension_form = form;
      s.common.viscosity = 2, s.common.viscosity_form = 1;
      struct run *run = start(solver, &s);
      const double before = out_of_round(run);
      for (int k = 0; k < 50; k++) advance(run);
      const double after = out_of_round(run);
      print_message("%-12s %s: %.3f out of round, then %.3f\n", solver->name,
                    form == HE ? "he" : "akinci", before, after);
      assert_true(after < 0.75 * before);
      run_free(run);
    }
}

/* A round drop of radius a that is set going as v = (x, -y) swings with omega^2 = 6 sigma/(rho a^3)
 * in 2-D (Lamb, Hydrodynamics, Art. 273, for n = 2 in a plane): what sigma is from five times at
 * which it is round. A drop of 20 dx is only so round: within a factor of two. */
static void drop_swings(void **unused)
{
  (void)unused;
  const struct solver *solver = solver_find("dfsph");
  const double a = 0.1, sigma = 1, omega = sqrt(6 * sigma / (1000 * a * a * a));
  double round_at[5] = {0}, before = 0;
  struct scene s = empty_scene(0);
  if (DIM == 3) skip();
  assert_int_equal(scene_fill_disc(&s, zero(), a, zero()), OK);
  for (int i = 0; i < s.n; i++) {
    s.v[i].c[0] = (real)(0.15 * omega) * s.x[i].c[0];
    s.v[i].c[1] = (real)(-0.15 * omega) * s.x[i].c[1];
  }
  s.common.tension = sigma;
  s.common.dt = 2e-3;
  struct run *run = start(solver, &s);
  for (int found = 0, k = 0; found < 5; k++) {
    double wide = 0;
    assert_true(run->time < 20 / omega);
    advance(run);
    for (int i = 0; i < run->view->p.n; i++) {
      const vec x = run->view->p.x[i];
      wide += (double)(x.c[0] * x.c[0] - x.c[1] * x.c[1]);
    }
    if (k > 5 && wide * before < 0) round_at[found++] = run->time;
    before = wide;
  }
  const double shown =
    sigma * pow(4 * 3.141592653589793 / (omega * (round_at[4] - round_at[0])), 2);
  print_message("asked %g N/m, shown %.3g N/m\n", sigma, shown);
  assert_true(shown > 0.5 * sigma && shown < 2 * sigma);
  run_free(run);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(corners_vanish),
    cmocka_unit_test(drop_swings),
  };
  return cmocka_run_group_tests_name("drops " SPHBENCH_VARIANT, tests, NULL, NULL);
}
