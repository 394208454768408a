/* Sums where no memory is left for their chunks: the same bits, only in parts. */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <cmocka.h>

#include "../../core/sph/sph.h"
#include "../../core/sph/sweep.h"

enum { MANY = 30000000, FEW = 50000 };

static double term(const void *self, int k)
{
  (void)self;
  return 1.0 / (1.0 + k % 1000003);
}

/* What the chunks are for: sums of REDUCE_CHUNK terms, then of these, each in order. */
static double by_hand(int n)
{
  double all = 0;
  for (int first = 0; first < n; first += REDUCE_CHUNK) {
    double part = 0;
    for (int k = first; k < n && k < first + REDUCE_CHUNK; k++) part += term(NULL, k);
    all += part;
  }
  return all;
}

static void forbid_memory(struct rlimit *before)
{
  getrlimit(RLIMIT_AS, before);
  setrlimit(RLIMIT_AS, &(struct rlimit){1 << 20, before->rlim_max});
}

static void test_without_memory(void **state)
{
  (void)state;
  const double expected = by_hand(MANY);
  double sum = 0, largest = 0;
  struct rlimit before;
  int room;
  sum_over(term, NULL, FEW, &sum); /* makes the threads, which need memory too */
  forbid_memory(&before);
  (void)reduce_scratch(INT_MAX / 2, &room);
  const int had = room;
  sum_over(term, NULL, MANY, &sum);
  largest_over(term, NULL, MANY, &largest);
  setrlimit(RLIMIT_AS, &before);
  assert_in_range(had, 1, MANY / REDUCE_CHUNK - 1); /* else nothing was shown */
  assert_memory_equal(&sum, &expected, sizeof sum);
  assert_true(largest == 1.0);
}

static void test_with_memory(void **state)
{
  (void)state;
  const double expected = by_hand(MANY);
  double sum = 0;
  int room;
  (void)reduce_scratch(MANY / REDUCE_CHUNK + 1, &room);
  assert_true(room >= MANY / REDUCE_CHUNK + 1);
  sum_over(term, NULL, MANY, &sum);
  assert_memory_equal(&sum, &expected, sizeof sum);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_without_memory),
                                     cmocka_unit_test(test_with_memory)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
