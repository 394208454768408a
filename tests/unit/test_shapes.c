/* Shapes: how many particles, where, and that neighbours share none. */
#include "cloud.h"

static void test_counts_are_robust_to_rounding(void **state)
{
  static const struct {
    double side, dx;
    int count;
  } cases[] = {{0.24, 0.005, 48}, {0.24, 0.0075, 32}, {0.3, 0.1, 3},    {0.7, 0.01, 70},
               {1, 1. / 3, 3},    {0.35, 0.025, 14},  {1.6, 0.01, 160}, {0.0051, 0.0051, 1}};
  (void)state;
  for (int k = 0; k < COUNT(cases); k++) {
    struct scene s = new_scene(cases[k].dx);
    const double side = cases[k].side;
    vec high = all_axes(side);
    high.c[DIM - 1] = (real)cases[k].dx; /* a row or sheet is enough */
    must(scene_fill_box(&s, zero(), high, zero(), NULL));
    assert_int_equal(s.n, DIM == 2 ? cases[k].count : cases[k].count * cases[k].count);
    scene_free(&s);
    s = new_scene(cases[k].dx); /* away from the origin, where coordinates round more */
    must(scene_fill_box(&s, all_axes(-side / 2), all_axes(side / 2), zero(), NULL));
    assert_int_equal(s.n, (int)pow(cases[k].count, DIM));
    scene_free(&s);
  }
}

static void test_box_positions(void **state)
{
  struct scene s = new_scene(0.1);
  int first = -1;
  (void)state;
  must(scene_add(&s, all_axes(-1), zero()));
  must(scene_fill_box(&s, all_axes(1), scene_at(1.2, 1.3, 1.3), scene_at(2, 0, 3), &first));
  assert_int_equal(first, 1);
  assert_int_equal(s.n, DIM == 2 ? 1 + 2 * 3 : 1 + 2 * 3 * 3);
  for (int i = first; i < s.n; i++) {
    near_to(s.v[i].c[0], 2, 0, 0);
    near_to(s.v[i].c[DIM - 1], 3, 0, 0);
    for (int d = 0; d < DIM; d++) {
      const double k = ((double)s.x[i].c[d] - 1) / 0.1 - 0.5;
      near_to(k, round(k), 1e-12, 1e-5);
      assert_true(k > -0.1 && k < 2.1);
    }
  }
  near_to(s.x[1].c[0], 1.05, 1e-15, 1e-7);
  near_to(s.x[2].c[DIM - 1], 1.15, 1e-15, 1e-7); /* the last axis runs fastest */
  scene_free(&s);
}

static int left_half(const void *self, vec x) { return (double)x.c[0] < *(const double *)self; }

static void test_where_and_disc(void **state)
{
  struct scene s = new_scene(0.01);
  const double middle = 0.5, radius = 0.123;
  (void)state;
  must(scene_fill_where(&s, zero(), scene_at(1, 0.02, 0.02), left_half, &middle, zero()));
  assert_int_equal(s.n, DIM == 2 ? 50 * 2 : 50 * 2 * 2);
  const int before = s.n;
  must(scene_fill_disc(&s, all_axes(3), radius, zero()));
  const double cells = (s.n - before) * pow(0.01, DIM);
  const double exact = DIM == 2 ? 3.14159265 * radius * radius : 4.18879 * radius * radius * radius;
  near_to(cells, exact, 0.02 * exact, 0.02 * exact);
  vec sum = zero();
  for (int i = before; i < s.n; i++) {
    const vec e = sub(s.x[i], all_axes(3));
    sum = plus(sum, e);
    assert_true((double)sqrt(inner(e, e)) < radius + 1e-6);
  }
  for (int d = 0; d < DIM; d++) near_to(sum.c[d] / (s.n - before), 0, 1e-12, 1e-4);
  scene_free(&s);
}

/* A square cut by a slanted line into two polygons: together they hold each cell once. */
static void test_polygons_share_nothing(void **state)
{
  static const double whole[][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  static const double left[][2] = {{0, 0}, {0.3, 0}, {0.8, 1}, {0, 1}};
  static const double right[][2] = {{0.3, 0}, {1, 0}, {1, 1}, {0.8, 1}};
  static const double star[][2] = {{0, 0}, {1, 0}, {1, 1}, {0.5, 0.5}, {0, 1}}; /* not convex */
  (void)state;
  struct scene s = new_scene(0.05), t = new_scene(0.05), u = new_scene(0.05);
  must(scene_fill_polygon(&s, whole, 4, 0, 0.1, zero()));
  assert_int_equal(s.n, DIM == 2 ? 400 : 800);
  must(scene_fill_polygon(&t, left, 4, 0, 0.1, zero()));
  const int in_left = t.n;
  must(scene_fill_polygon(&t, right, 4, 0, 0.1, zero()));
  near_to(in_left, 0.55 * s.n, 0.02 * s.n, 0.02 * s.n);
  assert_in_range(t.n, (int)(0.97 * s.n),
                  (int)(1.03 * s.n)); /* the right one has its own lattice */
  must(scene_fill_polygon(&u, star, 5, 0, 0.1, zero()));
  near_to(u.n, 0.75 * s.n, 0.03 * s.n, 0.03 * s.n);
  scene_free(&s);
  scene_free(&t);
  scene_free(&u);
}

static void test_polygon_edge_on_centres(void **state)
{
  /* the common edge x = 0.25 runs through cell centres: one of the two has them, not both */
  static const double left[][2] = {{0, 0}, {0.25, 0}, {0.25, 1}, {0, 1}};
  static const double right[][2] = {{0.25, 0}, {0.75, 0},  {0.75, 1},
                                    {0, 1},    {0, 0.999}, {0.25, 0.999}};
  struct scene s = new_scene(0.1);
  (void)state;
  must(scene_fill_polygon(&s, left, 4, 0, 0.1, zero()));
  const int in_left = s.n;
  must(scene_fill_polygon(&s, right, 6, 0, 0.1, zero()));
  assert_int_equal(s.n - in_left, 50); /* x = 0.25 .. 0.65: the edge is the right one's */
  assert_int_equal(in_left, 20);
  scene_domain_around(&s, 1);
  must(scene_check(&s));
  scene_free(&s);
}

/* Every cell around the box once, at (k + 1/2) dx from its faces, normals of length 1 inwards. */
static void test_wall_box(void **state)
{
  struct scene s = new_scene(0.1);
  const vec low = all_axes(-0.2), high = scene_at(0.4, 0.3, 0.8);
  const int inner_cells = DIM == 2 ? 6 * 10 : 6 * 5 * 10, layers = 3;
  (void)state;
  must(scene_wall_box(&s, low, high, layers, 0));
  assert_int_equal(s.n_wall, (DIM == 2 ? 12 * 16 : 12 * 11 * 16) - inner_cells);
  int corners = 0;
  for (int i = 0; i < s.n_wall; i++) {
    double outside = 0, normal2 = 0;
    int axes = 0;
    for (int d = 0; d < DIM; d++) {
      const double x = (double)s.wall_x[i].c[d], n = (double)s.wall_n[i].c[d];
      const double below = (double)low.c[d] - x, above = x - (double)high.c[d];
      outside = fmax(outside, fmax(below, above));
      normal2 += n * n;
      axes += n != 0;
      assert_true(below > 0 ? n > 0 : above > 0 ? n < 0 : n == 0);
      assert_true((double)s.wall_v[i].c[d] == 0);
    }
    corners += axes == DIM;
    near_to(normal2, 1, 1e-14, 1e-6);
    const double k = outside / 0.1 - 0.5;
    near_to(k, round(k), 1e-12, 1e-5);
    assert_true(k > -0.1 && k < layers - 0.9);
  }
  assert_int_equal(corners, (int)pow(2 * layers, DIM));
  scene_fill_box(&s, low, high, zero(), NULL);
  assert_int_equal(s.n, inner_cells);
  scene_domain_around(&s, 1);
  must(scene_check(&s)); /* fluid and walls share no place */
  scene_free(&s);
}

static void test_open_top(void **state)
{
  struct scene s = new_scene(0.1);
  (void)state;
  must(scene_wall_box(&s, zero(), scene_at(1, 1, 0.5), 2, 1));
  for (int i = 0; i < s.n_wall; i++) {
    assert_true((double)s.wall_x[i].c[DIM - 1] < 0.5);
    assert_true((double)s.wall_n[i].c[DIM - 1] >= 0);
  }
  assert_int_equal(s.n_wall, DIM == 2 ? 14 * 7 - 50 : 14 * 14 * 7 - 500);
  scene_free(&s);
  s = new_scene(0.03); /* 1 / 0.03 is no whole number: the walls still close */
  must(scene_wall_box(&s, zero(), all_axes(1), 1, 0));
  double gap = 0;
  for (int i = 0; i < s.n_wall && DIM == 2; i++) {
    double nearest = 9, second = 9;
    for (int j = 0; j < s.n_wall; j++) {
      const vec e = sub(s.wall_x[i], s.wall_x[j]);
      const double r = (double)sqrt(inner(e, e));
      if (j == i) continue;
      second = r < nearest ? nearest : r < second ? r : second;
      nearest = fmin(nearest, r);
    }
    gap = fmax(gap, second);
  }
  assert_true(gap < 1.02 * 0.03 + 1e-6);
  scene_free(&s);
}

static void test_shapes_refuse(void **state)
{
  static const double line[][2] = {{0, 0}, {1, 0}};
  static const double flat[][2] = {{0, 0}, {1, 0}, {2, 0}};
  static const double bad[][2] = {{0, 0}, {1, 0}, {(double)NAN, 1}};
  struct scene s = new_scene(0.1);
  (void)state;
  refused(scene_fill_box(&s, all_axes(1), all_axes(0), zero(), NULL), "side above 0");
  refused(scene_fill_box(&s, zero(), all_axes((double)NAN), zero(), NULL), "finite");
  refused(scene_fill_box(&s, zero(), all_axes((double)INFINITY), zero(), NULL), "finite");
  refused(scene_fill_box(&s, zero(), scene_at(0.01, 1, 1), zero(), NULL), "half the spacing");
  refused(scene_fill_box(&s, zero(), all_axes(1e6), zero(), NULL), "1e9");
  refused(scene_fill_box(&s, all_axes(-1e30), all_axes(1e30), zero(), NULL), "1e9");
  refused(scene_fill_disc(&s, zero(), -1, zero()), "radius");
  refused(scene_fill_disc(&s, zero(), (double)NAN, zero()), "radius");
  refused(scene_fill_disc(&s, zero(), 1e9, zero()), "1e9");
  refused(scene_fill_disc(&s, all_axes((double)NAN), 1, zero()), "finite");
  refused(scene_fill_polygon(&s, line, 2, 0, 1, zero()), "3 or more");
  refused(scene_fill_polygon(&s, flat, 3, 0, 1, zero()), "side above 0");
  refused(scene_fill_polygon(&s, bad, 3, 0, 1, zero()), "corner 3");
  refused(scene_wall_box(&s, zero(), all_axes(1), 0, 0), "layers");
  refused(scene_wall_box(&s, zero(), all_axes(1), 2000000000, 0), "1e+09");
  assert_int_equal(s.n + s.n_wall, 0);
  scene_free(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_counts_are_robust_to_rounding),
    cmocka_unit_test(test_box_positions),
    cmocka_unit_test(test_where_and_disc),
    cmocka_unit_test(test_polygons_share_nothing),
    cmocka_unit_test(test_polygon_edge_on_centres),
    cmocka_unit_test(test_wall_box),
    cmocka_unit_test(test_open_top),
    cmocka_unit_test(test_shapes_refuse),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
