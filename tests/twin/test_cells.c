/* The grid, the sort into it and sets of keys against brute force, for any number of threads. */
#include "worlds.h"

static void short_period(void **unused)
{
  (void)unused;
  struct grid grid;
  vec period = zero();
  period.c[DIM - 1] = (real)0.199;
  assert_int_equal(grid_fit(&grid, zero(), everywhere(1), period, (real)0.1, 10), ERR_USER);
  assert_non_null(strstr(status_sentence(), "0.199"));
  assert_non_null(strstr(status_sentence(), DIM == 3 ? "along z" : "along y"));
  period.c[DIM - 1] = 2 * (real)0.1;
  assert_int_equal(grid_fit(&grid, zero(), everywhere(1), period, (real)0.1, 10), OK);
}

static void sort_is_stable(void **unused)
{
  (void)unused;
  enum { N = 40000 };
  static vec x[N];
  static int order[3][N];
  struct grid grid;
  struct cell_set set = {0};
  for (int i = 0; i < N; i++) x[i] = somewhere(1);
  x[17].c[0] = (real)NAN;
  assert_int_equal(grid_fit(&grid, zero(), everywhere(1), zero(), (real)0.07, N), OK);
  for (int k = 0; k < 3; k++) {
    omp_set_num_threads(1 << k);
    assert_int_equal(cell_sort(&set, &grid, x, N, order[k]), OK);
    assert_memory_equal(order[k], order[0], sizeof order[0]);
    assert_int_equal(set.n, N);
    assert_int_equal(set.first[grid.num_cells], N);
    for (int c = 0; c < grid.num_cells; c++)
      for (int i = set.first[c]; i < set.first[c + 1]; i++) {
        assert_int_equal(grid_cell_of(&grid, x[order[k][i]], order[k][i]), c);
        assert_true(i == set.first[c] || order[k][i] > order[k][i - 1]);
      }
  }
  omp_set_num_threads(omp_get_num_procs());
  cell_set_free(&set);
}

static void permute_moves_bytes(void **unused)
{
  (void)unused;
  enum { N = 20000, MOST = 40 };
  static unsigned char from[N * MOST], to[N * MOST];
  static int order[N];
  for (int i = 0; i < N * MOST; i++) from[i] = (unsigned char)(256 * uniform());
  for (int i = 0; i < N; i++) order[i] = (int)((long long)i * 7919 % N);
  for (size_t bytes = 1; bytes <= MOST; bytes++) {
    permute(to, from, order, N, bytes);
    for (size_t i = 0; i < N; i++)
      assert_memory_equal(to + i * bytes, from + (size_t)order[i] * bytes, bytes);
  }
}

/* No particle within `reach` supports may be overlooked; without wrapping none is seen further than
 * reach + 1 cells away. */
static void occupied_cells(void **unused)
{
  (void)unused;
  for (int cut = 0; cut < 2; cut++) {
    struct world w = world_make(1, 60, 0, DIM == 3 ? (real)0.1 : (real)0.03);
    for (int i = 0; i < w.n[0]; i++) w.x[0][i] = somewhere(1);
    if (cut) w.x[0][3] = everywhere((real)1e9);
    world_sort(&w, 0);
    int yes = 0, no = 0;
    for (int k = 0; k < 1000; k++) {
      const int reach = 1 + k % 2;
      const vec x = plus(somewhere((real)1.4), everywhere((real)-0.2));
      int near = 0, seen = 0;
      for (int i = 0; i < w.n[0]; i++) {
        real most = 0;
        for (int d = 0; d < DIM; d++) most = larger(most, fabs(x.c[d] - w.x[0][i].c[d]));
        near |= most < w.support * (real)reach;
        seen |=
          most < w.support * ((real)reach + (real)1.001) + (real)0.2; /* clamped from 0.2 outside */
      }
      const int found = grid_occupied(&w.grid, w.set[0].first, x, reach);
      assert_true(found || !near);
      assert_true(cut || seen || !found);
      yes += found;
      no += !found;
    }
    assert_true(yes > 100 && no > 20);
    world_free(&w);
  }
}

static int compare_keys(const void *a, const void *b)
{
  const unsigned long long p = *(const unsigned long long *)a, q = *(const unsigned long long *)b;
  return (p > q) - (p < q);
}

static void unique_keys(void **unused)
{
  (void)unused;
  enum { N = 60000 };
  static unsigned long long keys[N], twin[N];
  const unsigned long long range[] = {1, 100, 30000, 1ULL << 40};
  for (int k = 0; k < 16; k++) {
    const int n = k < 4 ? k : k < 8 ? 500 : N;
    for (int i = 0; i < n; i++) {
      const real u = uniform(), v = uniform();
      keys[i] = twin[i] = (unsigned long long)((double)u * (double)range[k % 4]) << (k % 3 * 12);
      if (v < (real)0.1) keys[i] = twin[i] = ~keys[i];
    }
    qsort(twin, (size_t)n, sizeof *twin, compare_keys);
    int left = 0;
    for (int i = 0; i < n; i++)
      if (twin[i] != ~0ULL && (left == 0 || twin[i] != twin[left - 1])) twin[left++] = twin[i];
    omp_set_num_threads(1 << k / 4);
    assert_int_equal(keys_unique(keys, n), left);
    assert_memory_equal(keys, twin, sizeof *keys * (size_t)left);
  }
  omp_set_num_threads(omp_get_num_procs());
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(short_period, begin_test),
    cmocka_unit_test_setup(sort_is_stable, begin_test),
    cmocka_unit_test_setup(permute_moves_bytes, begin_test),
    cmocka_unit_test_setup(occupied_cells, begin_test),
    cmocka_unit_test_setup(unique_keys, begin_test),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
