/* The memory and the search of a variant's backend against those of the host: the same bits.
 * Trivial for the OpenMP variants, whose backend is the host. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka wants the five above */
#include <cmocka.h>

#include "../../core/backend/backend.h"
#include "../../core/base/memory.h"
#include "../../core/neighbours/neighbours.h"

static unsigned long long seed = 1;
static unsigned random_bits(void)
{
  seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
  return (unsigned)(seed >> 33);
}
static real uniform(void) { return (real)((double)random_bits() / 2147483648.0); }

/* A set of particles: unsorted and sorted positions on the host, and in particle memory (`there`).
 */
struct particle_set {
  int n;
  vec *x, *there, *sorted_there;
  int *order, *order_there;
  struct cell_set cells, cells_there;
};

static struct particle_set set_make(int n)
{
  struct particle_set s = {.n = n};
  s.x = (vec *)calloc((size_t)n + 1, sizeof(vec));
  s.order = (int *)calloc((size_t)n + 1, sizeof(int));
  s.there = (vec *)memory_take(sizeof(vec) * ((size_t)n + 1));
  s.sorted_there = (vec *)memory_take(sizeof(vec) * ((size_t)n + 1));
  s.order_there = (int *)memory_take(sizeof(int) * ((size_t)n + 1));
  assert_true(s.x && s.order && s.there && s.sorted_there && s.order_there);
  return s;
}

static void set_free(struct particle_set *s)
{
  memory_give(s->there, sizeof(vec) * ((size_t)s->n + 1));
  memory_give(s->sorted_there, sizeof(vec) * ((size_t)s->n + 1));
  memory_give(s->order_there, sizeof(int) * ((size_t)s->n + 1));
  particle_search.cell_set_free(&s->cells_there);
  cell_set_free(&s->cells);
  free(s->x);
  free(s->order);
}

static void set_fill(struct particle_set *s, real side)
{
  for (int i = 0; i < s->n; i++)
    for (int d = 0; d < DIM; d++) s->x[i].c[d] = side * uniform();
}

/* A host copy of `bytes` of particle memory, to be freed. */
static void *fetch(const void *there, size_t bytes)
{
  void *here = malloc(bytes + 1);
  assert_non_null(here);
  memory_to_host(here, there, bytes);
  return here;
}

static void assert_same(const void *here, const void *there, size_t bytes)
{
  void *copy = fetch(there, bytes);
  assert_memory_equal(here, copy, bytes);
  free(copy);
}

/* Sort by both searches; positions are in cell order after that, here and there. */
static void sort_both(struct particle_set *s, const struct grid *grid)
{
  const size_t bytes = sizeof(vec) * (size_t)s->n;
  memory_from_host(s->there, s->x, bytes);
  assert_int_equal(cell_sort(&s->cells, grid, s->x, s->n, s->order), OK);
  assert_int_equal(particle_search.cell_sort(&s->cells_there, grid, s->there, s->n, s->order_there),
                   OK);
  assert_int_equal(s->cells_there.n, s->n);
  assert_same(s->order, s->order_there, sizeof(int) * (size_t)s->n);
  assert_same(s->cells.first, s->cells_there.first, sizeof(int) * ((size_t)grid->num_cells + 1));
  particle_search.permute(s->sorted_there, s->there, s->order_there, s->n, sizeof(vec));
  vec *sorted = (vec *)malloc(bytes + 1);
  permute(sorted, s->x, s->order, s->n, sizeof(vec));
  memcpy(s->x, sorted, bytes);
  free(sorted);
  assert_same(s->x, s->sorted_there, bytes);
  s->cells.x = s->x;
  s->cells_there.x = s->sorted_there;
}

/* The rows [0, list->rows), padding aside. */
static void assert_same_rows(const struct pair_list *here, const struct pair_list *there)
{
  const size_t rows = (size_t)here->pairs.rows;
  assert_int_equal(there->pairs.rows, here->pairs.rows);
  assert_int_equal(there->pairs.periodic, here->pairs.periodic);
  assert_memory_equal(&there->pairs.period, &here->pairs.period, sizeof(vec));
  int *first = (int *)fetch(there->pairs.first, sizeof(int) * rows);
  int *last = (int *)fetch(there->pairs.last, sizeof(int) * rows);
  int *list = (int *)fetch(there->pairs.list, sizeof(int) * (size_t)there->pairs.slots);
  for (size_t i = 0; i < rows; i++) {
    const int length = here->last[i] - here->first[i];
    assert_int_equal(last[i] - first[i], length);
    assert_true(first[i] >= 0 && last[i] <= there->pairs.slots);
    if (i > 0) assert_true(first[i] >= last[i - 1]);
    assert_memory_equal(list + first[i], here->list + here->first[i], sizeof(int) * (size_t)length);
  }
  free(first);
  free(last);
  free(list);
}

static struct grid grid_of(const struct particle_set *s, int num, real support, real period)
{
  vec low = zero(), high = zero(), sides = zero();
  int total = 0;
  struct grid grid;
  for (int k = 0; k < num; k++) {
    vec a, b, c, d;
    assert_int_equal(particle_search.positions_bounds(s[k].there, s[k].n, &c, &d),
                     positions_bounds(s[k].x, s[k].n, &a, &b));
    assert_memory_equal(&a, &c, sizeof(vec));
    assert_memory_equal(&b, &d, sizeof(vec));
    for (int axis = 0; axis < DIM; axis++) {
      low.c[axis] = k == 0 ? a.c[axis] : smaller(a.c[axis], low.c[axis]);
      high.c[axis] = k == 0 ? b.c[axis] : larger(b.c[axis], high.c[axis]);
    }
    total += s[k].n;
  }
  for (int axis = 0; axis < DIM && period > 0; axis++) {
    sides.c[axis] = period;
    low.c[axis] = 0;
  }
  assert_int_equal(grid_fit(&grid, low, high, sides, support, total), OK);
  return grid;
}

static void upload(struct particle_set *s)
{
  memory_from_host(s->there, s->x, sizeof(vec) * (size_t)s->n);
}

/* Lists from both of two sets to both, in one list, as a run makes them. */
static void compare_lists(struct particle_set s[2], struct pair_list *here, struct pair_list *there,
                          real support, real period)
{
  upload(&s[0]);
  upload(&s[1]);
  const struct grid grid = grid_of(s, 2, support, period);
  sort_both(&s[0], &grid);
  sort_both(&s[1], &grid);
  const int offset[2] = {0, s[0].n};
  const struct cell_set to[2] = {s[0].cells, s[1].cells},
                        to_there[2] = {s[0].cells_there, s[1].cells_there};
  for (int k = 0; k < 2; k++) {
    assert_int_equal(pairs_build(here, &grid, &to[k], offset[k], to, offset, 2), OK);
    assert_int_equal(
      particle_search.pairs_build(there, &grid, &to_there[k], offset[k], to_there, offset, 2), OK);
    assert_same_rows(here, there);
  }
  assert_int_equal(backend_check(), OK);
}

static void test_lists(void **unused)
{
  (void)unused;
  static const int sizes[] = {300, 3000, 500}; /* lists grow, and shrink */
  for (int periodic = 0; periodic < 2; periodic++) {
    struct pair_list here = {0}, there = {0};
    for (int k = 0; k < 3; k++) {
      struct particle_set s[2] = {set_make(sizes[k]), set_make(sizes[k] / 3)};
      const real side = (real)pow(sizes[k], 1.0 / DIM), support = (real)2.3;
      set_fill(&s[0], side);
      set_fill(&s[1], side);
      s[0].x[7] = s[0].x[8]; /* two at one place */
      compare_lists(s, &here, &there, support, periodic ? side : 0);
      set_free(&s[0]);
      set_free(&s[1]);
    }
    particle_search.pair_list_free(&there);
    pair_list_free(&here);
    assert_null(there.list);
  }
}

/* Exactly on a lattice many pairs are exactly at the support, and particles exactly on the sides of
 * cells. */
static void test_lists_on_lattice(void **unused)
{
  (void)unused;
  for (int k = 0; k < 4; k++) {
    const int side = DIM == 2 ? 20 : 9, n = side * side * (DIM == 2 ? 1 : side);
    struct particle_set s[2] = {set_make(n), set_make(1)};
    struct pair_list here = {0}, there = {0};
    for (int i = 0; i < n; i++)
      for (int d = 0, rest = i; d < DIM; d++, rest /= side)
        s[0].x[i].c[d] = (real)0.1 * (real)(rest % side) - (k < 2 ? 1 : 0);
    compare_lists(s, &here, &there, (real)0.2, k % 2 ? (real)0.1 * (real)side : 0);
    particle_search.pair_list_free(&there);
    pair_list_free(&here);
    set_free(&s[0]);
    set_free(&s[1]);
  }
}

/* A particle far away cuts the grid; particles that are not finite have no neighbours and break
 * nothing. */
static void test_lists_of_wreckage(void **unused)
{
  (void)unused;
  struct particle_set s[2] = {set_make(400), set_make(50)};
  struct pair_list here = {0}, there = {0};
  set_fill(&s[0], 10);
  set_fill(&s[1], 10);
  s[0].x[5].c[0] = (real)1e6;
  s[0].x[6].c[DIM - 1] = (real)-1e7;
  s[0].x[17].c[1] = (real)NAN;
  s[0].x[18].c[0] = (real)INFINITY;
  s[1].x[3].c[0] = -(real)INFINITY;
  compare_lists(s, &here, &there, 1, 0);
  for (int i = 0; i < s[0].n; i++) s[0].x[i].c[0] = (real)NAN;
  compare_lists(s, &here, &there, 1, 0);
  particle_search.pair_list_free(&there);
  pair_list_free(&here);
  set_free(&s[0]);
  set_free(&s[1]);
}

static void test_empty_sets(void **unused)
{
  (void)unused;
  struct particle_set s[2] = {set_make(5), set_make(0)};
  struct pair_list here = {0}, there = {0};
  set_fill(&s[0], 1);
  compare_lists(s, &here, &there, 2, 0);
  particle_search.pair_list_free(&there);
  pair_list_free(&here);
  set_free(&s[0]);
  set_free(&s[1]);
}

static void test_bounds(void **unused)
{
  (void)unused;
  static const int sizes[] = {1, 127, 128, 129, 40000};
  for (int k = 0; k < 5; k++) {
    struct particle_set s = set_make(sizes[k]);
    vec a, b, c, d;
    set_fill(&s, 3);
    s.x[0] = zero();
    s.x[0].c[0] = -s.x[0].c[0];
    s.x[sizes[k] / 2].c[1] = (real)NAN;
    upload(&s);
    assert_int_equal(positions_bounds(s.x, s.n, &a, &b), 1);
    assert_int_equal(particle_search.positions_bounds(s.there, s.n, &c, &d), 1);
    assert_memory_equal(&a, &c, sizeof(vec));
    assert_memory_equal(&b, &d, sizeof(vec));
    set_free(&s);
  }
}

static void test_permute(void **unused)
{
  (void)unused;
  static const size_t sizes[] = {1, 4, 8, 12, 16, 24, 40};
  enum { N = 1000 };
  unsigned char from[40 * N], to[40 * N];
  int order[N];
  for (int i = 0; i < N; i++) order[i] = (i * 377 + 11) % N;
  for (int i = 0; i < 40 * N; i++) from[i] = (unsigned char)random_bits();
  int *order_there = (int *)memory_take(sizeof order);
  void *from_there = memory_take(sizeof from), *to_there = memory_take(sizeof to);
  memory_from_host(order_there, order, sizeof order);
  memory_from_host(from_there, from, sizeof from);
  for (int k = 0; k < 7; k++) {
    permute(to, from, order, N, sizes[k]);
    particle_search.permute(to_there, from_there, order_there, N, sizes[k]);
    assert_same(to, to_there, sizes[k] * N);
  }
  particle_search.permute(to_there, from_there, order_there, 0, 8);
  memory_give(order_there, sizeof order);
  memory_give(from_there, sizeof from);
  memory_give(to_there, sizeof to);
}

static void test_keys(void **unused)
{
  (void)unused;
  enum { N = 5000 };
  static const int sizes[] = {0, 1, 2, 100, N};
  unsigned long long keys[N];
  unsigned long long *there = (unsigned long long *)memory_take(sizeof keys);
  for (int mode = 0; mode < 3; mode++)
    for (int k = 0; k < 5; k++) {
      for (int i = 0; i < N; i++)
        keys[i] = mode == 2 ? ~0ULL : (unsigned long long)(random_bits() % 700) << 40;
      for (int i = 0; mode == 1 && i < N; i += 3) keys[i] = ~0ULL; /* no key */
      memory_from_host(there, keys, sizeof keys);
      const int left = keys_unique(keys, sizes[k]);
      assert_int_equal(particle_search.keys_unique(there, sizes[k]), left);
      assert_same(keys, there, sizeof *keys * (size_t)left);
    }
  memory_give(there, sizeof keys);
}

static void test_memory(void **unused)
{
  (void)unused;
  const size_t before = memory_taken(), bytes = 1000;
  unsigned char ones[1000], numbers[1000];
  for (int i = 0; i < 1000; i++) {
    ones[i] = 0xff;
    numbers[i] = (unsigned char)random_bits();
  }
  void *a = memory_take(bytes), *b = memory_take(bytes);
  assert_true(a && b && (size_t)a % 64 == 0 && (size_t)b % 64 == 0);
  assert_int_equal(memory_taken(), before + 2 * bytes);
  assert_true(memory_peak() >= before + 2 * bytes);
  memory_poison(a, bytes);
  assert_same(ones, a, bytes);
  memory_from_host(a, numbers, bytes);
  memory_copy(b, a, bytes);
  assert_same(numbers, b, bytes);
  memory_give(a, bytes);
  memory_give(b, bytes);
  memory_give(NULL, bytes);
  assert_int_equal(memory_taken(), before);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_memory),
    cmocka_unit_test(test_bounds),
    cmocka_unit_test(test_permute),
    cmocka_unit_test(test_keys),
    cmocka_unit_test(test_lists),
    cmocka_unit_test(test_lists_on_lattice),
    cmocka_unit_test(test_lists_of_wreckage),
    cmocka_unit_test(test_empty_sets),
  };
  const status machine = backend_check();
  if (machine != OK) {
    fprintf(stderr, "%s\n", status_sentence());
    return status_exit_code(machine);
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
