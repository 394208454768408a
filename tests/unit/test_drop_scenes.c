/* Scenes whose exact motion is affine: that the truth obeys the equations of motion and the numbers
 * published here before, that exact particles have no error and shifted ones the right one. */
#include "../../analysis/truth_drops.h"
#include "stage.h"

static int no_truths(void)
{
  const struct truth_drop drop = {2, 1, {1, -1, 0}, 0};
  struct truth_affine motion;
  truth_drop_at(&drop, 0.1, &motion);
  return isnan(motion.peak);
}

/* --- truths --- */

/* Any motion of this file at a time. */
struct motion {
  enum { DROP, ELLIPSE, DISC } kind;
  struct truth_drop drop; /* its pull is 0 for the others */
};
static struct truth_affine motion_at(const struct motion *m, double t)
{
  struct truth_affine now;
  if (m->kind == DROP) truth_drop_at(&m->drop, t, &now);
  if (m->kind == ELLIPSE) truth_spinning_ellipse_at(1.4, 0.7, 1.3, t, &now);
  if (m->kind == DISC) truth_spinning_disc_at(1.1, 1.3, t, &now);
  return now;
}

static const struct motion motions[] = {
  {DROP, {2, 1.5, {-2, 2, 0}, 0}}, {DROP, {2, 1.5, {2, -2, 0}, 3}},
  {DROP, {2, 1.5, {-2, 2, 0}, 3}}, {DROP, {3, 1.5, {-1, -1, 2}, 0}},
  {DROP, {3, 1.5, {1, -3, 2}, 3}}, {ELLIPSE, {2, 0, {0, 0, 0}, 0}},
  {DISC, {2, 0, {0, 0, 0}, 0}},
};

/* x'' = - grad p/rho - pull x, that is map'' = (2 bowl - pull) map; map' = rate map; the volume is
 * kept; p is 0 on the image of the surface. By differences of the exact motion. */
static void test_motions_obey_euler(void **state)
{
  const double h = 1e-3, t = 0.4;
  (void)state;
  if (no_truths()) skip();
  for (int k = 0; k < COUNT(motions); k++) {
    const struct motion *m = &motions[k];
    const struct truth_affine a = motion_at(m, t - h), b = motion_at(m, t), c = motion_at(m, t + h);
    for (int i = 0; i < m->drop.dim; i++)
      for (int j = 0; j < m->drop.dim; j++) {
        const double speed = (c.map[i][j] - a.map[i][j]) / (2 * h);
        const double curve = (c.map[i][j] - 2 * b.map[i][j] + a.map[i][j]) / (h * h);
        double moving = 0, force = -m->drop.pull * b.map[i][j];
        for (int l = 0; l < 3; l++) {
          moving += b.rate[i][l] * b.map[l][j];
          force += 2 * b.bowl[i][l] * b.map[l][j];
        }
        assert_true(fabs(speed - moving) < 1e-4);
        assert_true(fabs(curve - force) < 1e-4);
      }
    const struct truth_affine start = motion_at(m, 0);
    for (int i = 0; i < m->drop.dim && m->kind == DROP; i++) {
      assert_true(fabs(start.map[i][i] - 1) < 1e-12);
      assert_true(fabs(start.rate[i][i] - m->drop.strain[i]) < 1e-12);
    }
    double trace = 0;
    for (int i = 0; i < 3; i++) trace += b.rate[i][i];
    assert_true(fabs(trace) < 1e-12);
  }
}

/* Numbers of tests/data: elliptical_drop.csv, ellipsoid_drop_3d.csv, oscillating_drop_A0eqB.csv,
 * rotating_ellipse_patch.csv. */
static void test_motions_have_known_numbers(void **state)
{
  const struct truth_drop plane = {2, 1, {-100, 100, 0}, 0}, round = {3, 2, {-50, -50, 100}, 0};
  const struct truth_drop field = {2, 1, {1, -1, 0}, 1};
  struct truth_affine now;
  (void)state;
  if (no_truths()) skip();
  truth_drop_at(&plane, 0.0038, &now);
  near_to(now.map[0][0], 0.69482125228695964, 1e-14, 1e-14);
  near_to(now.rate[1][1], 88.489890705457836, 1e-11, 1e-11);
  near_to(now.peak, 3065.8057833958662, 1e-9, 1e-9);
  truth_drop_at(&round, 0.005, &now);
  near_to(now.map[2][2], 1.5445362460352191, 1e-11, 1e-11);
  near_to(now.rate[2][2] * now.map[2][2], 114.92488159264188, 1e-8, 1e-8);
  near_to(now.peak, 4 * 1183.5918204074809, 1e-7, 1e-7);
  truth_drop_at(&field, 1.2068357521005973, &now);
  near_to(now.map[0][0], 1.9318516525781366, 1e-13, 1e-13);
  near_to(now.peak, 0.25, 1e-13, 1e-13);
  assert_true(fabs(truth_drop_period(&field) - 4.8273430084023893) < 1e-13);
  truth_spinning_ellipse_at(sqrt(2), sqrt(0.5), 1, 1, &now);
  near_to(now.map[1][0] * sqrt(2), -1.3421894827186839, 1e-13, 1e-13);
  near_to(now.map[0][1] * sqrt(0.5), 0.55563224554532247, 1e-13, 1e-13);
  near_to(now.peak, -0.1963833360253671, 1e-13, 1e-13);
}

/* An ellipse that is nearly round is a disc with a wave of two crests. */
static void test_disc_wave(void **state)
{
  struct truth_affine now;
  const double e = 1e-6, t = 1.7;
  (void)state;
  assert_true(isnan(truth_spinning_disc_wave(1, 1, 1)));
  assert_true(truth_spinning_disc_wave(5, 1, 0) == 1);
  if (no_truths()) skip();
  truth_spinning_ellipse_at(1 + e, 1 - e, 1, t, &now);
  const double x = now.map[0][0] * (1 + e), y = now.map[0][1] * (1 - e);
  const double z = now.map[1][0] * (1 + e), w = now.map[1][1] * (1 - e);
  const double mean = (x * x + y * y + z * z + w * w) / 2, cross = x * z + y * w;
  const double half = (x * x + y * y - z * z - w * w) / 2;
  const double wave = sqrt(half * half + cross * cross) / (2 * mean);
  assert_true(fabs(wave / e / truth_spinning_disc_wave(2, 1, t) - 1) < 1e-5);
}

/* --- scenes --- */

static const struct benchmark *const drops[] = {
  &benchmark_elliptical_drop, &benchmark_oscillating_drop, &benchmark_rotating_ellipse,
  &benchmark_rotating_disc};

static int here(const struct benchmark *b)
{
  return (b->dims & (DIM == 2 ? CAN(2D) : CAN(3D))) != 0;
}

static struct truth_affine truth_of(const struct benchmark *b, double t)
{
  const struct truth_drop strained = {DIM, 1, {-100, DIM == 2 ? 100 : 0, DIM == 2 ? 0 : 100}, 0};
  const struct truth_drop swinging = {DIM, 1, {1, DIM == 2 ? -1 : 0, DIM == 2 ? 0 : -1}, 1};
  struct truth_affine now;
  if (b == &benchmark_elliptical_drop) truth_drop_at(&strained, t, &now);
  if (b == &benchmark_oscillating_drop) truth_drop_at(&swinging, t, &now);
  if (b == &benchmark_rotating_ellipse)
    truth_spinning_ellipse_at(1.4142135623730951, 0.70710678118654752, 1, t, &now);
  if (b == &benchmark_rotating_disc) truth_spinning_disc_at(1, 1, t, &now);
  return now;
}

/* Move the particles from their start as the truth does, with its pressure. */
static void move_exactly(struct stage *s, double t)
{
  const struct truth_affine m = truth_of(s->b, t);
  s->now.time = t;
  s->now.step = 10;
  for (int i = 0; i < s->now.n; i++) {
    double x[3] = {0}, p = m.peak;
    for (int d = 0; d < DIM; d++)
      for (int e = 0; e < DIM; e++) x[d] += m.map[d][e] * (double)s->scene.x[i].c[e];
    for (int d = 0; d < DIM; d++) {
      double v = 0;
      for (int e = 0; e < DIM; e++) {
        v += m.rate[d][e] * x[e];
        p -= x[d] * m.bowl[d][e] * x[e];
      }
      s->brute.x[i].c[d] = (real)x[d];
      s->brute.v[i].c[d] = (real)v;
    }
    s->p[i] = (real)(s->now.rho0 * p);
  }
}

static struct stage coarse(const struct benchmark *b, double jitter)
{
  struct stage s = prepare(b);
  set_param(&s, "jitter", jitter);
  if (DIM == 3) set_param(&s, "spacing", 0.15);
  build(&s);
  return s;
}

/* Whole area or volume; v as the truth says at the particles' places, displaced ones included. */
static void test_starts(void **state)
{
  (void)state;
  for (int k = 0; k < 2 * COUNT(drops); k++) {
    const struct benchmark *b = drops[k / 2];
    if (!here(b) || no_truths()) continue;
    struct stage s = coarse(b, k % 2 ? 0.2 : 0);
    const struct truth_affine m = truth_of(b, 0);
    const double cell = pow(s.now.dx, DIM), whole = DIM == 2 ? 3.14159265 : 4.18879;
    assert_true(fabs(s.scene.n * cell / whole - 1) < (DIM == 2 ? 0.01 : 0.05));
    assert_true(s.scene.jittered == (k % 2));
    const vec before = s.scene.x[7];
    scene_apply_jitter(&s.scene); /* as is done after build: not a second time */
    near_to(s.scene.x[7].c[0], before.c[0], 0, 0);
    for (int i = 0; i < s.scene.n; i++)
      for (int d = 0; d < DIM; d++) {
        double v = 0;
        for (int e = 0; e < DIM; e++) v += m.rate[d][e] * (double)s.scene.x[i].c[e];
        near_to(s.scene.v[i].c[d], v, 1e-11, 1e-4);
      }
    near_to(s.scene.pull, b == &benchmark_oscillating_drop, 0, 0);
    end(&s);
  }
}

static void test_exact_particles_have_no_error(void **state)
{
  (void)state;
  if (no_truths()) skip();
  for (int k = 0; k < COUNT(drops); k++) {
    const struct benchmark *b = drops[k];
    if (!here(b)) continue;
    struct stage s = coarse(b, 0.1);
    move_exactly(&s, 0.6 * s.scene.common.t_end);
    const struct measures out = measured(&s);
    near_to(VALUE(out, trajectory_error), 0, 1e-12, 1e-5);
    near_to(VALUE(out, velocity_error), 0, 1e-12, 1e-5);
    near_to(VALUE(out, axes_error), 0, 1e-12, 1e-5);
    near_to(VALUE(out, energy_error), 0, 1e-12, 1e-5);
    near_to(VALUE(out, pressure_error), 0, 1e-11, 1e-4);
    near_to(VALUE(out, centre_pressure_error), 0, 1e-11, 1e-4);
    if (k >= 2) near_to(VALUE(out, spin_error), 0, 1e-12, 1e-5);
    end(&s);
  }
}

static double root_mean_square(const struct stage *s, int d)
{
  double sum = 0;
  for (int i = 0; i < s->now.n; i++) sum += (double)s->brute.x[i].c[d] * (double)s->brute.x[i].c[d];
  return sqrt(sum / s->now.n);
}

/* 10 % too long along the last axis, 20 % too fast, pressure 1.25 times, particles stored in
 * reverse. */
static void test_planted_errors(void **state)
{
  (void)state;
  if (no_truths()) skip();
  struct stage s = coarse(&benchmark_elliptical_drop, 0);
  const int n = s.now.n;
  move_exactly(&s, 0.005);
  double a2 = 0, last = root_mean_square(&s, DIM - 1), moved = 0, wrong = 0;
  for (int d = 0; d < DIM; d++) a2 += root_mean_square(&s, d) * root_mean_square(&s, d);
  for (int i = 0; i < n; i++)
    for (int d = 0; d < DIM; d++) moved += pow((double)(s.brute.x[i].c[d] - s.scene.x[i].c[d]), 2);
  for (int i = 0; i < n; i++) {
    wrong += pow(0.1 * (double)s.brute.x[i].c[DIM - 1], 2);
    s.brute.x[i].c[DIM - 1] *= (real)1.1;
  }
  for (int i = 0; i < n / 2; i++) {
    const vec x = s.brute.x[i], v = s.brute.v[i];
    s.brute.x[i] = s.brute.x[n - 1 - i];
    s.brute.v[i] = s.brute.v[n - 1 - i];
    s.brute.x[n - 1 - i] = x;
    s.brute.v[n - 1 - i] = v;
  }
  for (int i = 0; i < n; i++) s.brute.id[i] = n - 1 - i;
  struct measures out = measured(&s);
  near_to(VALUE(out, axes_error), 0.1 * last / sqrt(a2), 1e-9, 1e-5);
  near_to(VALUE(out, trajectory_error), sqrt(wrong / moved), 1e-9, 1e-5);
  near_to(VALUE(out, energy_error), 0, 1e-9, 1e-5);
  end(&s);

  s = coarse(&benchmark_elliptical_drop, 0);
  move_exactly(&s, 0.005);
  for (int i = 0; i < n; i++) {
    s.brute.v[i] = times((real)1.2, s.brute.v[i]);
    s.p[i] *= (real)1.25;
  }
  out = measured(&s);
  near_to(VALUE(out, velocity_error), 0.2, 1e-9, 1e-5);
  near_to(VALUE(out, velocity_error_l1), 0.2, 1e-9, 1e-5);
  near_to(VALUE(out, velocity_error_max), 0.2, 1e-9, 1e-5);
  assert_true(VALUE(out, velocity_error_p999) <= VALUE(out, velocity_error_max));
  assert_true(VALUE(out, velocity_error_p999) > 0.9 * 0.2);
  near_to(VALUE(out, energy_error), 0.44, 1e-9, 1e-5);
  near_to(VALUE(out, pressure_error), 0.25, 1e-9, 1e-5);
  near_to(VALUE(out, pressure_error_l1), 0.25, 1e-9, 1e-5);
  near_to(VALUE(out, pressure_error_max), 0.25, 1e-9, 1e-5);
  near_to(VALUE(out, centre_pressure_error), 0.25, 1e-9, 1e-5);
  /* one stray particle: in the mean its part, in the largest all of it, in the percentile nothing
   */
  move_exactly(&s, 0.005);
  double sum = 0, largest = 0;
  for (int i = 0; i < n; i++) {
    const double speed = sqrt((double)inner(s.brute.v[i], s.brute.v[i]));
    sum += speed;
    largest = fmax(largest, speed);
  }
  s.brute.v[n / 2].c[0] += (real)(7 * largest);
  out = measured(&s);
  near_to(VALUE(out, velocity_error_l1), 7 * largest / sum, 1e-8, 1e-4);
  near_to(VALUE(out, velocity_error_max), 7, 1e-8, 1e-4);
  assert_true(VALUE(out, velocity_error_p999) < (n > 1001 ? 1e-4 : 8));
  s.now.p = NULL; /* a method without pressure */
  out = measured(&s);
  assert_true(isnan(VALUE(out, pressure_error)) && isnan(VALUE(out, centre_pressure_error)));
  s.now.step = 0;
  assert_true(isnan(VALUE(measured(&s), trajectory_error)));
  end(&s);
}

/* Turned a little too far: the angular momentum and the axes are right, the paths are not. */
static void test_turned_ellipse(void **state)
{
  const double turn = 1e-3;
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  struct stage s = coarse(&benchmark_rotating_ellipse, 0);
  move_exactly(&s, 1);
  for (int i = 0; i < s.now.n; i++) {
    vec *both[] = {&s.brute.x[i], &s.brute.v[i]};
    for (int k = 0; k < 2; k++) {
      const double a = (double)both[k]->c[0], b = (double)both[k]->c[1];
      both[k]->c[0] = (real)(cos(turn) * a - sin(turn) * b);
      both[k]->c[1] = (real)(sin(turn) * a + cos(turn) * b);
    }
  }
  struct measures out = measured(&s);
  near_to(VALUE(out, axes_error), 0, 1e-12, 1e-5);
  near_to(VALUE(out, spin_error), 0, 1e-12, 1e-5);
  assert_true(VALUE(out, trajectory_error) > 5e-4 && VALUE(out, trajectory_error) < 2e-3);
  for (int i = 0; i < s.now.n; i++) s.brute.v[i] = times((real)0.9, s.brute.v[i]);
  near_to(VALUE(measured(&s), spin_error), 0.1, 1e-9, 1e-5);
  end(&s);
}

/* A particle that has come back: relative to the farthest way so far. */
static void test_travel_is_the_largest_so_far(void **state)
{
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  struct stage s = coarse(&benchmark_oscillating_drop, 0);
  move_exactly(&s, 1.2068357521005973);
  double moved = 0;
  for (int i = 0; i < s.now.n; i++) {
    const vec way = sub(s.brute.x[i], s.scene.x[i]);
    moved += (double)inner(way, way);
  }
  near_to(VALUE(measured(&s), energy_error), 0, 1e-12, 1e-5);
  for (int i = 0; i < s.now.n; i++) s.brute.x[i] = times((real)1.1, s.brute.x[i]);
  near_to(VALUE(measured(&s), energy_error), 0.21, 1e-9, 1e-4); /* all of it is in the field */
  move_exactly(&s, 4.8273430084023893);
  for (int i = 0; i < s.now.n; i++) s.brute.x[i].c[0] += (real)0.01;
  near_to(VALUE(measured(&s), trajectory_error), 0.01 * sqrt(s.now.n / moved), 1e-9, 1e-4);
  end(&s);
}

/* Samples of the exact swinging: its period, and 3 % more for a run that is 3 % late. */
static void test_period(void **state)
{
  (void)state;
  if (DIM == 3 || no_truths()) skip();
  for (int late = 0; late < 2; late++) {
    struct stage s = coarse(&benchmark_oscillating_drop, 0);
    double found = (double)NAN;
    for (int k = 0; k <= 100; k++) {
      const double t = 4.8273430084023893 * k / 100;
      move_exactly(&s, late ? t / 1.03 : t);
      s.now.step = k;
      s.now.time = t;
      found = VALUE(measured(&s), period_error);
      if (k < 49) assert_true(isnan(found)); /* half a period is needed */
    }
    near_to(found, 0.03 * late, 1e-4, 1e-3);
    end(&s);
  }
}

static void test_wave_on_the_disc(void **state)
{
  (void)state;
  if (DIM == 3) skip();
  for (int m = 2; m < 8; m++) {
    struct stage s = prepare(&benchmark_rotating_disc);
    set_param(&s, "crests", m);
    set_param(&s, "wave_height", 0.01);
    set_param(&s, "radius", 2);
    build(&s);
    s.now.time = 0;
    const double noise = m % 4 == 0 ? 2e-3 : 2e-4; /* the lattice itself has waves of 4 crests */
    near_to(VALUE(measured(&s), mode_amplitude), 0.02, noise, noise);
    s.now.time = 1; /* as high as at the start, but should be higher */
    const double truth = truth_spinning_disc_wave(m, 1, 1);
    near_to(VALUE(measured(&s), mode_error), 1 - 1 / truth, 0.05, 0.05);
    assert_true(isnan(VALUE(measured(&s), trajectory_error)));
    end(&s);
  }
  struct stage s = prepare(&benchmark_rotating_disc);
  set_param(&s, "crests", 1);
  refused(s.b->build(&s.scene, s.self), "whole numbers from 2");
  end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_motions_obey_euler),
    cmocka_unit_test(test_motions_have_known_numbers),
    cmocka_unit_test(test_disc_wave),
    cmocka_unit_test(test_starts),
    cmocka_unit_test(test_exact_particles_have_no_error),
    cmocka_unit_test(test_planted_errors),
    cmocka_unit_test(test_turned_ellipse),
    cmocka_unit_test(test_travel_is_the_largest_so_far),
    cmocka_unit_test(test_period),
    cmocka_unit_test(test_wave_on_the_disc),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
