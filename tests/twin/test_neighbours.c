/* The neighbour search against brute force: same rows, in the same order, for any number of threads
 * and on both code paths (with vector instructions as compiled, and in plain C). To be compiled as
 * core/neighbours is, without contraction. */
#include "worlds.h"

#define PLAIN_SEARCH
#define pairs_build plain_pairs_build
#define pair_list_free plain_pair_list_free
#include "../../core/neighbours/search.c"
#undef pairs_build
#undef pair_list_free

/* |a - b|^2 < R^2, every operation rounded, as the search decides it. */
static int are_near(const struct world *w, vec a, vec b)
{
  volatile real sum = 0;
  for (int d = 0; d < DIM; d++) {
    volatile real apart = a.c[d] - b.c[d];
    if (w->period.c[d] > 0) {
      volatile real turns = rint(apart / w->period.c[d]) * w->period.c[d];
      apart = apart - turns;
    }
    volatile real square = apart * apart;
    sum = sum + square;
  }
  return sum < w->support * w->support;
}

/* Compare the rows of set `from`, which begin at row_offset; returns the number of pairs. */
static long check_rows(const struct world *w, const struct pairs *list, int from, int row_offset,
                       const int *offset)
{
  long pairs = 0;
  for (int i = 0; i < w->n[from]; i++) {
    const int first = list->first[row_offset + i], last = list->last[row_offset + i];
    int k = first;
    assert_int_equal(first % LANES, 0);
    for (int s = 0; s < w->num_sets; s++)
      for (int j = 0; j < w->n[s]; j++) {
        if (!are_near(w, w->x[from][i], w->x[s][j])) continue;
        assert_true(k < last);
        assert_int_equal(list->list[k], offset[s] + j);
        k++;
      }
    assert_int_equal(k, last);
    for (; k % LANES; k++) assert_int_equal(list->list[k], list->list[last - 1]);
    assert_true(k <= list->slots);
    pairs += last - first;
  }
  return pairs;
}

typedef status build_function(struct pair_list *, const struct grid *, const struct cell_set *, int,
                              const struct cell_set *, const int *, int);

/* The list of all sets to all sets; the second one's numbers begin after a gap. */
static void build_all(const struct world *w, struct pair_list *list, build_function *build,
                      int offset[2])
{
  int rows = 0;
  offset[0] = 0;
  offset[1] = w->n[0] + 7;
  for (int s = 0; s < w->num_sets; s++) {
    assert_int_equal(build(list, &w->grid, &w->set[s], rows, w->set, offset, w->num_sets), OK);
    rows += w->n[s];
    assert_int_equal(list->pairs.rows, rows);
  }
  assert_true(list->slot_capacity >= list->pairs.slots + LANES);
  for (int k = 0; k < LANES; k++) assert_int_equal(list->list[list->pairs.slots + k], 0);
}

/* Returns the number of pairs. */
static long check_world(struct world *w, real origin)
{
  long pairs = 0;
  int offset[2];
  struct pair_list reference = {0};
  world_sort(w, origin);
  omp_set_num_threads(1);
  build_all(w, &reference, pairs_build, offset);
  const struct pairs *a = &reference.pairs;
  for (int s = 0; s < w->num_sets; s++) pairs += check_rows(w, a, s, s == 0 ? 0 : w->n[0], offset);
  for (int threads = 1; threads <= 4; threads *= 2)
    for (int plain = 0; plain < 2; plain++) {
      struct pair_list list = {0};
      omp_set_num_threads(threads);
      build_all(w, &list, plain ? plain_pairs_build : pairs_build, offset);
      const struct pairs *b = &list.pairs;
      assert_int_equal(a->slots, b->slots);
      assert_memory_equal(a->first, b->first, sizeof(int) * (size_t)a->rows);
      assert_memory_equal(a->last, b->last, sizeof(int) * (size_t)a->rows);
      assert_memory_equal(a->list, b->list, sizeof(int) * (size_t)(a->slots + LANES));
      (plain ? plain_pair_list_free : pair_list_free)(&list);
    }
  omp_set_num_threads(omp_get_num_procs());
  pair_list_free(&reference);
  return pairs;
}

static int is_listed(const struct pairs *list, int i, int j)
{
  for (int k = list->first[i]; k < list->last[i]; k++)
    if (list->list[k] == j) return 1;
  return 0;
}

static void check_symmetric(const struct world *w)
{
  struct pair_list list = {0};
  const int offset = 0;
  assert_int_equal(pairs_build(&list, &w->grid, w->set, 0, w->set, &offset, 1), OK);
  for (int i = 0; i < w->n[0]; i++) {
    assert_true(is_listed(&list.pairs, i, i));
    for (int k = list.first[i]; k < list.last[i]; k++)
      assert_true(is_listed(&list.pairs, list.list[k], i));
  }
  pair_list_free(&list);
}

static void compiled_without_contraction(void **unused)
{
  (void)unused;
  const real tiny = sizeof(real) == 4 ? (real)0x1p-12 : (real)0x1p-27;
  volatile real a = 1 + tiny, b = 1 + 2 * tiny;
  const real x = a, y = b;
  assert_true(x * x - y == 0);
}

static void open_cloud(void **unused)
{
  (void)unused;
  struct world w = world_make(1, 3000, 0, (real)0.1);
  for (int i = 0; i < w.n[0]; i++) w.x[0][i] = somewhere(1);
  assert_true(check_world(&w, 0) > w.n[0]);
  check_symmetric(&w);
  world_free(&w);
}

/* Pairs at exactly R, particles at exactly a cell's border: R is 1, 2 and 2.5 spacings, 0.1 is not
 * exact. */
static void lattices(void **unused)
{
  (void)unused;
  const real support[] = {1, 2, (real)2.5, (real)2.2360680, (real)1.7320508};
  for (int k = 0; k < 5; k++)
    for (int scaled = 0; scaled < 2; scaled++) {
      struct world w = world_cube(1200, support[k], 0);
      if (scaled) {
        w.support *= (real)0.1;
        for (int i = 0; i < w.n[0]; i++) w.x[0][i] = times((real)0.1, w.x[0][i]);
      }
      check_world(&w, 0);
      check_symmetric(&w);
      world_free(&w);
    }
}

/* Particles at the borders of cells and one step of the last digit to either side. */
static void cell_borders(void **unused)
{
  (void)unused;
  const real support[] = {1, (real)0.1, (real)0.3, (real)0.7, (real)1.1, (real)0.013};
  for (int k = 0; k < 6; k++) {
    struct world w = world_cube(1000, support[k], 0);
    for (int i = 0; i < w.n[0]; i++) w.x[0][i] = times(support[k], w.x[0][i]);
    world_sort(&w, 0);
    const struct grid grid = w.grid;
    for (int i = 0; i < w.n[0]; i++)
      for (int d = 0; d < DIM; d++) {
        real *c = &w.x[0][i].c[d];
        const real number = rint((*c - grid.low.c[d]) / support[k]);
        const real border = grid.low.c[d] + number / grid.inv_side.c[d];
        const int pick = (int)(3 * uniform());
        *c = pick == 0 ? border : nextafter(border, pick == 1 ? (real)1e9 : (real)-1e9);
      }
    check_world(&w, 0);
    check_symmetric(&w);
    world_free(&w);
  }
}

/* Pairs along an axis, as far apart as neighbours can be, in boxes so wide that rounding would move
 * them by cells. */
static void farthest_neighbours(void **unused)
{
  (void)unused;
  for (int wide = 0; wide < 4; wide++) {
    struct world w = world_make(1, 3000, 0, (real)1.0001);
    for (int i = 0; i < w.n[0]; i += 2) {
      vec *x = &w.x[0][i];
      const int d = i / 2 % DIM;
      x[0] = x[1] = somewhere((real)pow(10, wide + 2));
      x[1].c[d] += w.support;
      while (!are_near(&w, x[0], x[1])) x[1].c[d] = nextafter(x[1].c[d], (real)0);
    }
    assert_true(check_world(&w, 0) >= 2 * w.n[0]);
    world_free(&w);
  }
}

/* A period that holds its cells with nothing to spare, particles at the borders next to its seam.
 */
static void seam_borders(void **unused)
{
  (void)unused;
  const real supports[] = {10, 100, 1000, 3000};
  for (int k = 0; k < 4; k++) {
    struct world w = world_make(1, 600, 0, (real)0.1);
    w.period.c[0] = supports[k] * w.support * (real)1.0000012;
    const real last = w.period.c[0] - w.period.c[0] / supports[k];
    for (int i = 0; i < w.n[0]; i++) {
      w.x[0][i] = times((real)1e-5, somewhere(1));
      real *c = &w.x[0][i].c[0];
      *c = i % 2 ? last : 0;
      for (int up = (int)(7 * uniform()); up > 3; up--) *c = nextafter(*c, (real)1e9);
      for (int down = (int)(5 * uniform()); down > 0 && i % 2; down--) *c = nextafter(*c, (real)0);
    }
    check_world(&w, 0);
    check_symmetric(&w);
    world_free(&w);
  }
}

static void jittered_cubes(void **unused)
{
  (void)unused;
  struct world w = world_cube(4500, 2, (real)0.2);
  assert_true(check_world(&w, 0) > (DIM == 3 ? 25 : 10) * (long)w.n[0]);
  check_symmetric(&w);
  world_free(&w);
}

static void two_sets(void **unused)
{
  (void)unused;
  struct world w = world_make(2, 2100, 1300, (real)0.1);
  for (int i = 0; i < w.n[0]; i++) w.x[0][i] = somewhere(1);
  for (int i = 0; i < w.n[1]; i++) {
    w.x[1][i] = somewhere((real)1.2);
    w.x[1][i].c[0] *= (real)0.3;
  }
  check_world(&w, 0);
  world_free(&w);
}

static void empty_sets(void **unused)
{
  (void)unused;
  for (int k = 0; k < 4; k++) {
    struct world w = world_make(2, k & 1 ? 500 : 0, k & 2 ? 400 : 0, (real)0.2);
    for (int s = 0; s < 2; s++)
      for (int i = 0; i < w.n[s]; i++) w.x[s][i] = somewhere(1);
    check_world(&w, 0);
    world_free(&w);
  }
}

/* All axes periodic, one of them, and boxes of 2, 2.x, 3 and more supports; `beyond` moves
 * particles by whole periods. */
static void periodic_box(real in_supports, unsigned axes, int beyond)
{
  struct world w = world_make(1, 1100, 0, (real)0.125);
  const real side = in_supports * w.support, origin = (real)-0.3;
  for (int i = 0; i < w.n[0]; i++) {
    w.x[0][i] = plus(everywhere(origin), somewhere(side));
    for (int d = 0; d < DIM && beyond; d++)
      if (axes >> d & 1) w.x[0][i].c[d] += side * (real)((int)(7 * uniform()) - 3);
  }
  for (int d = 0; d < DIM; d++)
    if (axes >> d & 1) w.period.c[d] = side;
  check_world(&w, origin);
  check_symmetric(&w);
  world_free(&w);
}

static void periodic_boxes(void **unused)
{
  (void)unused;
  const real in_supports[] = {2, (real)2.5, 3, (real)3.2, 4, 5, (real)10.7, 40};
  for (int k = 0; k < 8; k++) {
    periodic_box(in_supports[k], (1u << DIM) - 1, 0);
    periodic_box(in_supports[k], 1, 0);
    periodic_box(in_supports[k], 1u << (DIM - 1), 0);
    if (k % 3 == 1) periodic_box(in_supports[k], (1u << DIM) - 1, 1);
  }
}

/* Lattices that a period continues: many pairs at exactly R through the seam. */
static void periodic_lattice(void **unused)
{
  (void)unused;
  struct world w = world_cube(1000, 2, 0);
  const int side = cube_side(1000);
  w.period = everywhere((real)side);
  const long pairs = check_world(&w, (real)(-(side / 2)));
  assert_int_equal(pairs, (DIM == 3 ? 27 : 9) * (long)w.n[0]);
  check_symmetric(&w);
  world_free(&w);
}

/* A period of very many supports: its cells are folded. */
static void wide_period(void **unused)
{
  (void)unused;
  struct world w = world_make(1, 1200, 0, 1);
  w.period = everywhere(20000);
  for (int i = 0; i < w.n[0]; i++)
    for (int d = 0; d < DIM; d++) w.x[0][i].c[d] = i % 2 ? 4 * uniform() : 20000 - 4 * uniform();
  assert_true(check_world(&w, 0) > 2 * w.n[0]);
  assert_true(most_in_a_cell(&w, 0) < 100);
  world_free(&w);
}

static void coincident(void **unused)
{
  (void)unused;
  struct world w = world_make(1, 1500, 0, (real)0.1);
  for (int i = 0; i < w.n[0]; i++) w.x[0][i] = i % 3 ? everywhere((real)0.7) : somewhere(1);
  assert_true(check_world(&w, 0) >= 1000 * 1000);
  world_free(&w);
}

static void far_away(void **unused)
{
  (void)unused;
  for (int k = 0; k < 4; k++) {
    struct world w = world_cube(4000, 2, (real)0.2);
    for (int d = 0; d < DIM; d++) {
      if (k == 0) w.x[0][77].c[d] = (real)1e30;
      if (k == 1) w.x[0][5].c[d] += (real)2e6;
      if (k > 1) w.x[0][99].c[d] = d == k - 2 ? (real)-1e30 : w.x[0][99].c[d];
      if (k == 3) w.x[0][100] = w.x[0][99];
    }
    check_world(&w, 0);
    assert_true(w.grid.wraps != 0);
    assert_true(most_in_a_cell(&w, 0) < 50);
    world_free(&w);
  }
}

/* Droplets in a box a hundred thousand times wider. */
static void archipelago(void **unused)
{
  (void)unused;
  struct world w = world_make(2, 2000, 1000, 1);
  vec islands[200];
  for (int k = 0; k < 200; k++) islands[k] = somewhere(100000);
  for (int s = 0; s < 2; s++)
    for (int i = 0; i < w.n[s]; i++) w.x[s][i] = plus(islands[i % 200], somewhere(2));
  assert_true(check_world(&w, 0) > 4 * w.n[0]);
  assert_true(most_in_a_cell(&w, 0) < 60);
  world_free(&w);
}

/* An explosion: distances from 0.1 to 1e30 on both sides. */
static void explosion(void **unused)
{
  (void)unused;
  struct world w = world_make(1, 4000, 0, 1);
  for (int i = 0; i < w.n[0]; i++)
    for (int d = 0; d < DIM; d++) {
      const real u = uniform(), far = (real)pow(10, 31 * (double)u - 1);
      w.x[0][i].c[d] = uniform() < (real)0.5 ? far : -far;
    }
  check_world(&w, 0);
  assert_true(most_in_a_cell(&w, 0) < 30);
  world_free(&w);
}

/* Particles along a line and on a lattice of wide spacing: folding must not heap them up. */
static void sparse_patterns(void **unused)
{
  (void)unused;
  for (int diagonal = 0; diagonal < 2; diagonal++) {
    struct world w = world_make(1, 3000, 0, 1);
    for (int i = 0; i < w.n[0]; i++)
      for (int d = 0, k = i; d < DIM; d++, k /= 16)
        w.x[0][i].c[d] = diagonal ? (real)i * (real)0.5 : (real)(d < DIM - 1 ? k % 16 : k) * 256;
    check_world(&w, 0);
    assert_true(most_in_a_cell(&w, 0) < 20);
    world_free(&w);
  }
}

static void not_finite(void **unused)
{
  (void)unused;
  struct world w = world_make(1, 3000, 0, (real)0.1);
  for (int i = 0; i < w.n[0]; i++) {
    w.x[0][i] = somewhere(1);
    const vec bad = everywhere(i % 8 == 1   ? (real)NAN
                               : i % 8 == 3 ? (real)INFINITY
                                            : -(real)INFINITY);
    if (i % 16 < 8 && i % 2)
      w.x[0][i] = bad;
    else if (i % 2)
      w.x[0][i].c[i / 2 % DIM] = bad.c[0];
  }
  vec low, high;
  assert_int_equal(positions_bounds(w.x[0], w.n[0], &low, &high), 1500);
  for (int d = 0; d < DIM; d++)
    assert_true(low.c[d] >= 0 && low.c[d] < high.c[d] && high.c[d] <= 1);
  check_world(&w, 0);
  assert_true(most_in_a_cell(&w, 0) < (DIM == 3 ? 40 : 80));
  for (int i = 0; i < w.n[0]; i++) w.x[0][i].c[0] = (real)NAN;
  assert_int_equal(positions_bounds(w.x[0], w.n[0], &low, &high), w.n[0]);
  assert_int_equal(check_world(&w, 0), 0);
  world_free(&w);
}

static void far_from_the_origin(void **unused)
{
  (void)unused;
  struct world w = world_cube(2500, 2, (real)0.2);
  for (int i = 0; i < w.n[0]; i++) w.x[0][i] = plus(w.x[0][i], everywhere((real)1e6));
  check_world(&w, 0);
  check_symmetric(&w);
  world_free(&w);
}

/* A list built again in the same memory, smaller and larger, is as good as new and keeps what it
 * has taken. */
static void memory_is_reused(void **unused)
{
  (void)unused;
  struct pair_list list = {0};
  const int n[] = {300, 2500, 40, 2500}, offset = 0;
  int capacity = 0;
  for (int k = 0; k < 4; k++) {
    struct world w = world_cube(n[k], 2, (real)0.2);
    world_sort(&w, 0);
    assert_int_equal(pairs_build(&list, &w.grid, w.set, 0, w.set, &offset, 1), OK);
    check_rows(&w, &list.pairs, 0, 0, &offset);
    if (k > 1) assert_int_equal(list.slot_capacity, capacity);
    capacity = list.slot_capacity;
    world_free(&w);
  }
  pair_list_free(&list);
  assert_null(list.list);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(compiled_without_contraction, begin_test),
    cmocka_unit_test_setup(open_cloud, begin_test),
    cmocka_unit_test_setup(lattices, begin_test),
    cmocka_unit_test_setup(cell_borders, begin_test),
    cmocka_unit_test_setup(farthest_neighbours, begin_test),
    cmocka_unit_test_setup(seam_borders, begin_test),
    cmocka_unit_test_setup(jittered_cubes, begin_test),
    cmocka_unit_test_setup(two_sets, begin_test),
    cmocka_unit_test_setup(empty_sets, begin_test),
    cmocka_unit_test_setup(periodic_boxes, begin_test),
    cmocka_unit_test_setup(periodic_lattice, begin_test),
    cmocka_unit_test_setup(wide_period, begin_test),
    cmocka_unit_test_setup(coincident, begin_test),
    cmocka_unit_test_setup(far_away, begin_test),
    cmocka_unit_test_setup(archipelago, begin_test),
    cmocka_unit_test_setup(explosion, begin_test),
    cmocka_unit_test_setup(sparse_patterns, begin_test),
    cmocka_unit_test_setup(not_finite, begin_test),
    cmocka_unit_test_setup(far_from_the_origin, begin_test),
    cmocka_unit_test_setup(memory_is_reused, begin_test),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
