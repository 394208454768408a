/* Scenes: common parameters, jitter, domain, what a user can get wrong, and the index of places. */
#include "../../core/scene/places.h"
#include "cloud.h"

static void test_common_parameters(void **state)
{
  struct scene_params params;
  (void)state;
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&params + scene_param_rows[k].offset) = k + 0.5;
  near_to(params.spacing, 0.5, 0, 0);
  near_to(params.samples, num_scene_params - 0.5, 0, 0);
  const struct param *kernel = param_find(scene_param_rows, num_scene_params, "kernel");
  double value;
  assert_non_null(kernel);
  must(param_parse(kernel, "wendland2", "test", &value));
  near_to(value, KERNEL_WENDLAND2, 0, 0);
  for (int k = 0; k < num_scene_params; k++) {
    const struct param *p = &scene_param_rows[k];
    assert_true(p->low <= p->initial && p->initial <= p->high);
  }
}

static void test_wall_layers(void **state)
{
  static const double support[] = {2.5, 2, 1.6667, 3.0000000001, 1.05};
  static const int layers[] = {4, 3, 3, 4, 3};
  struct scene s = new_scene(0.1);
  (void)state;
  for (int k = 0; k < COUNT(support); k++) {
    s.common.support = support[k];
    assert_int_equal(scene_wall_layers(&s), layers[k]);
  }
}

static void test_arrays_grow(void **state)
{
  struct scene s = new_scene(1);
  (void)state;
  for (int i = 0; i < 5000; i++) must(scene_add(&s, all_axes(i), all_axes(-i)));
  assert_int_equal(s.n, 5000);
  for (int i = 0; i < 5000; i++) {
    near_to(s.x[i].c[0], i, 0, 0);
    near_to(s.v[i].c[DIM - 1], -i, 0, 0);
  }
  refused(scene_reserve(&s, 2e9, 0), "1e+09");
  refused(scene_reserve(&s, (double)NAN, 0), "1e+09");
  scene_free(&s);
  assert_int_equal(s.n, 0);
  assert_null(s.x);
}

/* --- jitter --- */

static struct scene jittered(unsigned long long seed, double jitter)
{
  struct scene s = new_scene(0.1);
  s.seed = seed;
  s.common.jitter = jitter;
  must(scene_fill_box(&s, zero(), scene_at(4, 1, 4), zero(), NULL));
  scene_apply_jitter(&s);
  return s;
}

static void test_jitter(void **state)
{
  (void)state;
  struct scene still = jittered(7, 0), a = jittered(7, 0.25), b = jittered(7, 0.25),
               c = jittered(8, 0.25), wide = jittered(7 + (1ull << 32), 0.25);
  double sum = 0, sum2 = 0, most = 0;
  int like_c = 0, like_wide = 0;
  for (int i = 0; i < a.n; i++)
    for (int d = 0; d < DIM; d++) {
      const double e = ((double)a.x[i].c[d] - (double)still.x[i].c[d]) / 0.1;
      assert_true(a.x[i].c[d] == b.x[i].c[d]);
      like_c += a.x[i].c[d] == c.x[i].c[d];
      like_wide += a.x[i].c[d] == wide.x[i].c[d];
      sum += e;
      sum2 += e * e;
      most = fmax(most, fabs(e));
    }
  const double numbers = (double)a.n * DIM, deviation = 0.25 / sqrt(3);
  assert_true(most <= 0.2501 && most > 0.245);
  near_to(sum / numbers, 0, 4 * deviation / sqrt(numbers), 4 * deviation / sqrt(numbers));
  near_to(sqrt(sum2 / numbers), deviation, 0.02 * deviation, 0.02 * deviation);
  assert_true(like_c < 5 && like_wide < 5);
  scene_free(&still);
  scene_free(&a);
  scene_free(&b);
  scene_free(&c);
  scene_free(&wide);
}

/* The first numbers of the stream: a change of generator or of its counters would change every
 * baseline. From Philox 4x32 with key (seed, 0) and counter (particle, 0, 0, 0). */
static void test_jitter_is_philox(void **state)
{
  struct scene s = jittered(0, 1);
  (void)state;
  /* known answer of philox4x32x10 for counter 0 and key 0 (Random123's kat_vectors): 6627e8d5
   * e169c58d */
  near_to((double)s.x[0].c[0], 0.05 + 0.1 * (2 * (0x6627e8d5u + 0.5) / 4294967296.0 - 1), 1e-15,
          1e-7);
  near_to((double)s.x[0].c[1], 0.05 + 0.1 * (2 * (0xe169c58du + 0.5) / 4294967296.0 - 1), 1e-15,
          1e-7);
  scene_free(&s);
}

/* --- what a user can get wrong --- */

static struct scene block(void)
{
  struct scene s = new_scene(0.1);
  must(scene_fill_box(&s, zero(), all_axes(1), zero(), NULL));
  scene_domain_around(&s, 0.5);
  return s;
}

static void test_domain(void **state)
{
  struct scene s = block();
  (void)state;
  for (int d = 0; d < DIM; d++) {
    near_to(s.low.c[d], 0.05 - 0.5, 1e-14, 1e-6);
    near_to(s.high.c[d], 0.95 + 0.5, 1e-14, 1e-6);
  }
  must(scene_check(&s));
  s.x[3].c[0] = 2;
  refused(scene_check(&s), "fluid particle 3 at (2, ");
  refused(scene_check(&s), "outside the domain");
  s.period.c[0] = 2;
  must(scene_check(&s));
  scene_free(&s);
}

static void test_check_finds_no_particle_and_nan(void **state)
{
  struct scene none = new_scene(0.1), s = block();
  (void)state;
  refused(scene_check(&none), "no fluid particle");
  s.x[5].c[1] = (real)NAN;
  refused(scene_check(&s), "fluid particle 5");
  s.x[5].c[1] = (real)INFINITY;
  refused(scene_check(&s), "finite");
  scene_free(&s);
  s = block();
  must(scene_wall_box(&s, zero(), all_axes(1), 1, 0));
  s.wall_x[2].c[0] = (real)NAN;
  refused(scene_check(&s), "wall particle 2");
  s.wall_x[2].c[0] = -5;
  s.v[4].c[1] = (real)INFINITY;
  refused(scene_check(&s), "fluid particle 4 moves");
  scene_free(&s);
}

static void test_check_finds_overlaps(void **state)
{
  struct scene s = block();
  char words[96];
  const int n = s.n;
  (void)state;
  must(scene_fill_box(&s, all_axes(0.9), all_axes(1.2), zero(), NULL));
  scene_domain_around(&s, 0.5);
  snprintf(words, sizeof words, "fluid particle %d and fluid particle %d are both at (0.95, ",
           n - 1, n);
  refused(scene_check(&s), words);
  scene_free(&s);
  s = block(); /* half a cell apart is no overlap that the check knows */
  must(scene_fill_box(&s, all_axes(0.95), all_axes(1.25), zero(), NULL));
  scene_domain_around(&s, 0.5);
  must(scene_check(&s));
  scene_free(&s);
  s = block();
  must(scene_wall_box(&s, all_axes(0.2), all_axes(0.8), 1, 0));
  refused(scene_check(&s), "and wall particle");
  scene_free(&s);
  s = block(); /* nearer than rounding, on both sides of a cell's border */
  s.x[0] = all_axes(0.1);
  s.x[1] = scene_at(0.1 - (IN_FLOAT ? 1e-8 : 1e-9), 0.1, 0.1);
  refused(scene_check(&s), "shapes overlap");
  scene_free(&s);
  s = block(); /* across a periodic border */
  s.period.c[0] = 1;
  s.x[0].c[0] = 0;
  s.x[n - 1] = s.x[0];
  s.x[n - 1].c[0] = 1;
  refused(scene_check(&s), "shapes overlap");
  scene_free(&s);
}

/* What is 1e30 m away rounds as coarsely as it likes; the others are still apart. */
static void test_check_of_one_far_away(void **state)
{
  struct scene s = block();
  vec far = zero();
  (void)state;
  far.c[1] = (real)1e30;
  must(scene_add(&s, far, zero()));
  scene_domain_around(&s, 0.5);
  must(scene_check(&s));
  must(scene_add(&s, far, zero()));
  refused(scene_check(&s), "shapes overlap");
  scene_free(&s);
}

static void test_check_of_many_is_fast(void **state)
{
  struct scene s = new_scene(0.001);
  (void)state; /* a check of all pairs would need 1e10 distances */
  must(scene_fill_box(&s, zero(), DIM == 2 ? all_axes(0.3) : scene_at(0.045, 0.045, 0.045), zero(),
                      NULL));
  scene_domain_around(&s, 0.01);
  must(scene_check(&s));
  scene_free(&s);
}

/* --- places against brute force --- */

static unsigned random_state = 12345;
static double random_in(double low, double high)
{
  random_state = random_state * 1664525u + 1013904223u;
  return low + (high - low) * (random_state >> 8) / 16777216.0;
}

static double wrapped(double x, double period)
{
  return period > 0 ? x - period * round(x / period) : x;
}

static int nearest_by_force(const vec *x, int n, vec at, vec period, double *distance)
{
  int found = -1;
  for (int j = 0; j < n; j++) {
    double r2 = 0;
    for (int d = 0; d < DIM; d++) {
      const double e = wrapped((double)x[j].c[d] - (double)at.c[d], (double)period.c[d]);
      r2 += e * e;
    }
    if (sqrt(r2) < *distance) {
      *distance = sqrt(r2);
      found = j;
    }
  }
  return found;
}

static void test_places_find_the_nearest(void **state)
{
  enum { N = 300 };
  vec x[N + 1];
  (void)state;
  for (int trial = 0; trial < 40; trial++) {
    vec period = zero();
    period.c[0] = trial % 2 ? 1 : 0;
    period.c[DIM - 1] = trial % 4 == 3 ? 1 : 0;
    for (int i = 0; i <= N; i++)
      for (int d = 0; d < DIM; d++) x[i].c[d] = (real)random_in(0, 1);
    x[7].c[0] = (real)NAN;
    struct places places;
    must(places_make(&places, x, N, random_in(0.02, 0.3), period));
    for (int k = 0; k < 50; k++) {
      vec at;
      for (int d = 0; d < DIM; d++) at.c[d] = (real)random_in(-0.1, 1.1);
      const double reach = random_in(0.01, 0.4);
      double found = 0, expected = reach;
      const int i = places_nearest(&places, at, reach, -1, &found);
      const int j = nearest_by_force(x, N, at, period, &expected);
      assert_true((i < 0) == (j < 0));
      near_to(found, expected, 1e-12, 1e-6);
    }
    double distance;
    assert_int_equal(places_nearest(&places, x[3], 0.5, -1, &distance), 3);
    assert_true(places_nearest(&places, x[3], 0.5, 3, &distance) != 3);
    assert_int_equal(places_nearest(&places, x[7], 0.5, -1, &distance), -1);
    places_free(&places);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_common_parameters),
    cmocka_unit_test(test_wall_layers),
    cmocka_unit_test(test_arrays_grow),
    cmocka_unit_test(test_jitter),
    cmocka_unit_test(test_jitter_is_philox),
    cmocka_unit_test(test_domain),
    cmocka_unit_test(test_check_finds_no_particle_and_nan),
    cmocka_unit_test(test_check_finds_overlaps),
    cmocka_unit_test(test_check_of_one_far_away),
    cmocka_unit_test(test_check_of_many_is_fast),
    cmocka_unit_test(test_places_find_the_nearest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
