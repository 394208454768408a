/* How fast fixed-point iterations converge or diverge. A periodic lattice that is pressed by 0.1 %
 * and disturbed a little keeps all pressures above 0, so that an iteration is linear, and what it
 * does to the mode exp(i k.x) of the error is a factor. With too much relaxation the stiffest mode
 * grows by it: the velocities after N iterations are a power iteration for the largest factor.
 *
 *   DFSPH, IISPH   1 - r theta_k                    theta_k = |sum_j sin(k.x_ij) grad W_ij|^2
 *   PCISPH         1 - r theta_k/2                            / sum_j |grad W_ij|^2
 *   PBF            1 - theta_k g/(g + epsilon)      g = (m/rho0)^2 sum_j |grad W_ij|^2
 *   SISPH          1 - (1 + s_k)/(1 + S/beta)       s_k = dt^2 K/rho0 (m/rho0)^2 |sum_j ...|^2
 *
 * theta_k here is a sum of its own over all wave vectors that fit, kernel included. */
#include "choices.h"

#ifndef REAL_IS_FLOAT
enum { ACROSS = DIM == 2 ? 16 : 8, FEW = 34, MORE = 40 };
static const double PRESSED = 0.999, SMALL = 1e-11; /* dx */

/* The parameter that relaxes an iteration, and how. */
enum knob { RELAXATION, HALF_RELAXATION, EPSILON, BETA };
static const struct method {
  const char *solver, *param;
  enum knob knob;
} methods[] = {{"dfsph", "relaxation", RELAXATION},
               {"iisph", "relaxation", RELAXATION},
               {"pcisph", "relaxation", HALF_RELAXATION},
               {"pbf", "epsilon", EPSILON},
               {"sisph", "beta", BETA}};

struct setup {
  const struct solver *solver;
  double value[MOST_PARAMS], support;
};

/* --- theory */

/* Cubic spline, dW/dr with h = R/2. */
static double spline_slope(double r, double h)
{
  const double q = r / h, s = DIM == 2 ? 10 / (7 * acos(-1) * h * h) : 1 / (acos(-1) * h * h * h);
  return q < 1 ? s / h * (-3 * q + 2.25 * q * q) : q < 2 ? -0.75 * s / h * (2 - q) * (2 - q) : 0;
}
static double spline(double r, double h)
{
  const double q = r / h, s = DIM == 2 ? 10 / (7 * acos(-1) * h * h) : 1 / (acos(-1) * h * h * h);
  return q < 1 ? s * (1 - 1.5 * q * q + 0.75 * q * q * q) : q < 2 ? s / 4 * pow(2 - q, 3) : 0;
}

struct sums {
  double wave2, spread, springs,
    volume; /* |sum sin grad W|^2, sum |grad W|^2, sum |W'|/r, m/rho0 */
};

static struct sums sums_of(double support, const double k[3])
{
  const double h = support * DX / 2, a = DX * PRESSED;
  const int reach = (int)support + 1, deep = DIM == 3 ? reach : 0;
  double wave[3] = {0}, total = 0;
  struct sums s = {0, 0, 0, 0};
  for (int x = -reach; x <= reach; x++)
    for (int y = -reach; y <= reach; y++)
      for (int z = -deep; z <= deep; z++) {
        const double r0 = sqrt(x * x + y * y + z * z), at[3] = {x, y, z};
        total += spline(DX * r0, h);
        if (r0 == 0) continue;
        const double w = spline_slope(a * r0, h), phase = k[0] * x + k[1] * y + k[2] * z;
        for (int d = 0; d < DIM; d++) wave[d] += sin(phase) * w * at[d] / r0;
        s.spread += w * w;
        s.springs -= w / (a * r0);
      }
  s.wave2 = wave[0] * wave[0] + wave[1] * wave[1] + wave[2] * wave[2];
  s.volume = 1 / total;
  return s;
}

static double value_of(const struct setup *s, const char *name)
{
  return s->value[param_number(s->solver, name)];
}

static double factor(const struct setup *s, const struct method *m, const struct sums *at)
{
  const double theta = at->wave2 / at->spread, r = value_of(s, m->param), V = at->volume;
  if (m->knob == RELAXATION) return 1 - r * theta;
  if (m->knob == HALF_RELAXATION) return 1 - r * theta / 2;
  const double g = V * V * at->spread * DX * DX;
  if (m->knob == EPSILON) return 1 - theta * g / (g + r);
  const double stiff = DT * DT * value_of(s, "K") / 1000;
  const double S = 2 * stiff * V * at->springs;
  return 1 - (1 + stiff * V * V * at->wave2) / (1 + S / r);
}

/* The largest factor of all waves that fit. */
static double largest_factor(const struct setup *s, const struct method *m)
{
  double most = 0;
  for (int i = 0; i < ACROSS; i++)
    for (int j = 0; j < ACROSS; j++)
      for (int l = 0; l < (DIM == 3 ? ACROSS : 1); l++) {
        const double unit = 2 * acos(-1) / ACROSS, k[3] = {unit * i, unit * j, unit * l};
        const struct sums at = sums_of(s->support, k);
        if (i || j || l) most = fmax(most, fabs(factor(s, m, &at)));
      }
  return most;
}

/* --- measurement */

static struct scene fill(double support)
{
  struct scene s = empty_scene(0);
  const double side = ACROSS * DX * PRESSED;
  unsigned bits = 1;
  s.common.support = support;
  for (int d = 0; d < DIM; d++) {
    s.low.c[d] = 0;
    s.high.c[d] = s.period.c[d] = (real)side;
  }
  for (int i = 0; i < ACROSS * ACROSS * (DIM == 3 ? ACROSS : 1); i++) {
    const int at[3] = {i % ACROSS, i / ACROSS % ACROSS, i / ACROSS / ACROSS};
    vec x;
    for (int d = 0; d < DIM; d++) {
      bits = bits * 1664525u + 1013904223u;
      const double off = SMALL * ((bits >> 8) / 16777216.0 - 0.5);
      x.c[d] = (real)((at[d] + 0.5 + off) * DX * PRESSED);
    }
    assert_int_equal(scene_add(&s, x, zero()), OK);
  }
  return s;
}

/* The root mean square of the velocities after a step of N iterations. */
static double speed_after(const struct setup *s, int N)
{
  struct scene scene = fill(s->support);
  struct setup now = *s;
  struct run *run;
  struct snapshot end;
  double square = 0;
  set_param(s->solver, now.value, "fixed_iterations", N);
  if (run_create(s->solver, now.value, &scene, 0, &run) != OK)
    fail_msg("%s: %s", s->solver->name, status_sentence());
  assert_int_equal(run_step(run), OK);
  if (run->diverged) fail_msg("%s: %s", s->solver->name, run->reason);
  assert_int_equal(run_snapshot(run, &end), OK);
  for (int i = 0; i < end.n; i++) square += (double)inner(end.v[i], end.v[i]);
  square /= end.n;
  snapshot_free(&end);
  run_free(run);
  return sqrt(square);
}

static struct setup setup_of(const struct method *m, double support)
{
  struct setup s = {.solver = solver_find(m->solver), .support = support};
  assert_non_null(s.solver);
  assert_true(s.solver->num_params <= MOST_PARAMS);
  for (int k = 0; k < s.solver->num_params; k++) s.value[k] = s.solver->params[k].initial;
  set_param(s.solver, s.value, "divergence_solver", 0);
  set_param(s.solver, s.value, "K", 1e9);
  return s;
}

/* The value of the knob at which the stiffest mode is multiplied by `wanted` < 0. */
static double knob_for(struct setup *s, const struct method *m, double wanted)
{
  double low = m->knob == EPSILON ? -0.3 : 1e-3, high = 30;
  for (int k = 0; k < 60; k++) {
    const double middle = 0.5 * (low + high);
    set_param(s->solver, s->value, m->param, middle);
    const int too_much = largest_factor(s, m) > wanted;
    const int falls = m->knob == EPSILON;
    if (too_much != falls)
      high = middle;
    else
      low = middle;
  }
  return high;
}

static void the_stiffest_mode_grows_as_predicted(void **unused)
{
  (void)unused;
  const double supports[] = {2, 2.5};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++)
    for (int n = 0; n < 2; n++) {
      const struct method *m = &methods[k];
      struct setup s = setup_of(m, supports[n]);
      set_param(s.solver, s.value, m->param, knob_for(&s, m, 1.5));
      const double predicted = largest_factor(&s, m);
      const double few = speed_after(&s, FEW), more = speed_after(&s, MORE);
      const double measured = pow(more / few, 1.0 / (MORE - FEW));
      print_message("%-7s R = %.1f dx, %s %.3f: grows by %.4f in an iteration, predicted %.4f\n",
                    m->solver, supports[n], m->param, value_of(&s, m->param), measured, predicted);
      if (!(fabs(measured / predicted - 1) < 0.03)) fail_msg("not as predicted");
    }
}

/* Less by a tenth than what makes the factor -1, and nothing grows. */
static void nothing_grows_within_the_bound(void **unused)
{
  (void)unused;
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    const struct method *m = &methods[k];
    struct setup s = setup_of(m, 2);
    set_param(s.solver, s.value, m->param, knob_for(&s, m, 1 + 1e-6));
    const double edge = value_of(&s, m->param);
    set_param(s.solver, s.value, m->param, m->knob == EPSILON ? 1.2 * edge + 0.02 : 0.9 * edge);
    const double few = speed_after(&s, 100), more = speed_after(&s, 200);
    print_message("%-7s %s %.3f: %.3g and %.3g m/s after 100 and 200 iterations\n", m->solver,
                  m->param, value_of(&s, m->param), few, more);
    if (!(more < 2.1 * few)) fail_msg("it grows");
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_stiffest_mode_grows_as_predicted),
    cmocka_unit_test(nothing_grows_within_the_bound),
  };
  return cmocka_run_group_tests_name("iterations " SPHBENCH_VARIANT, tests, NULL, NULL);
}
#else
int main(void) { return 77; } /* what grows from 1e-11 dx needs doubles */
#endif
