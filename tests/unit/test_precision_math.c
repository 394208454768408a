/* What is concluded from times and errors: planted data with known answers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "../../analysis/front/orders.h"
#include "../../analysis/front/statistics.h"

#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))
#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

/* --- intervals: ranks from tables of the sign test --- */

static void median_and_ranks(void **state)
{
  (void)state;
  static const struct {
    int n, low, high; /* ranks from 1 */
    double median, coverage;
  } known[] = {
    {1, 1, 1, 1, 0},
    {2, 1, 2, 1.5, 0.5},
    {5, 1, 5, 3, 0.9375}, /* no interval of 95 % exists */
    {6, 1, 6, 3.5, 0.96875},
    {8, 1, 8, 4.5, 0.9921875},
    {9, 2, 8, 5, 0.9609375},
    {10, 2, 9, 5.5, 1 - 22.0 / 1024},
    {20, 6, 15, 10.5, 1 - 2 * 21700.0 / 1048576},
  };
  for (int k = 0; k < COUNT(known); k++) {
    double values[32];
    for (int i = 0; i < known[k].n; i++) values[i] = 1 + (7 * i + 3) % known[k].n;
    if (known[k].n % 7 == 0) fail();
    const struct interval found = interval_of_median(values, known[k].n);
    assert_near(found.median, known[k].median, 0);
    assert_near(found.low, known[k].low, 0);
    assert_near(found.high, known[k].high, 0);
    assert_near(found.coverage, known[k].coverage, 1e-12);
  }
}

/* One run that was disturbed moves neither the median nor, from 9 on, the interval much. */
static void median_resists_outliers(void **state)
{
  (void)state;
  double values[] = {1.00, 1.01, 1.02, 0.99, 0.98, 1.00, 1.01, 0.99, 50};
  const struct interval found = interval_of_median(values, COUNT(values));
  assert_near(found.median, 1, 0);
  assert_near(found.low, 0.99, 0);
  assert_near(found.high, 1.02, 0);
}

/* --- fronts --- */

static void front_of_known_points(void **state)
{
  (void)state;
  const double cost[] = {1, 2, 3, 4, 2, 5, NAN, 1, HUGE_VAL, 4};
  const double error[] = {1, 0.5, 0.6, 0.1, 0.5, 0.1, 0.01, 2, 0.001, NAN};
  const int expected[] = {1, 1, 0, 1, 0, 0, 0, 0, 0, 0};
  int on[COUNT(cost)];
  pareto_front(cost, error, COUNT(cost), on);
  for (int k = 0; k < COUNT(cost); k++) assert_int_equal(on[k], expected[k]);
}

/* --- the cheapest --- */

/* Solver 0 is exact and slow, 1 fast and crude, 2 the planted slow one, 3 has no valid time. */
static const struct candidate planted[] = {
  {0, 0, 0.005, 8.0, 7.9, 8.1},    {0, 1, 0.02, 4.0, 3.9, 4.1},   {0, 2, 0.08, 2.0, 1.9, 2.1},
  {1, 3, 0.09, 1.0, 0.98, 1.03},   {1, 4, 0.029, 3.0, 2.9, 3.95}, {1, 5, 0.028, 2.8, 2.7, 2.9},
  {2, 6, 0.001, 80.0, 79.0, 81.0}, {3, 7, 0.001, NAN, NAN, NAN},  {3, 8, NAN, 0.1, 0.1, 0.1},
};

static void cheapest_by_target(void **state)
{
  (void)state;
  struct candidate best[COUNT(planted)];
  assert_int_equal(rank_cheapest(planted, COUNT(planted), 0.1, best), 3);
  assert_int_equal(best[0].point, 3);
  assert_int_equal(best[1].point, 2);
  assert_int_equal(best[2].point, 6);
  assert_int_equal(rank_cheapest(planted, COUNT(planted), 0.03, best), 3);
  assert_int_equal(best[0].point, 5);
  assert_int_equal(best[1].point, 1);
  assert_int_equal(rank_cheapest(planted, COUNT(planted), 0.01, best), 2);
  assert_int_equal(best[0].point, 0);
  assert_near(slower_by(&best[0], &best[1], 1.05), 10, 1e-12);
  assert_int_equal(rank_cheapest(planted, COUNT(planted), 0.0001, best), 0);
}

static void differences_below_noise_are_none(void **state)
{
  (void)state;
  const struct candidate a = {0, 0, 0.1, 1.0, 0.99, 1.01}, b = {1, 1, 0.1, 1.04, 1.03, 1.05};
  const struct candidate wide = {1, 1, 0.1, 1.5, 1.0, 2.0};
  assert_near(slower_by(&a, &b, 1.0), 1.04, 1e-12);
  assert_near(slower_by(&a, &b, 1.05), 0, 0);
  assert_near(slower_by(&a, &wide, 1.05), 0, 0);
  const double first[] = {1, 2, 3}, again[] = {1.1, 1.9, 3};
  assert_near(noise_floor(first, again, 3), 1.1, 1e-12);
  assert_near(noise_floor(again, first, 3), 1.1, 1e-12);
  assert_near(noise_floor(first, again, 0), 1, 0);
  double many[40], others[40]; /* two of 40 may be worse */
  for (int k = 0; k < 40; k++) {
    many[k] = 2;
    others[k] = k < 2 ? 20 : k < 3 ? 2.1 : 2;
  }
  assert_near(noise_floor(many, others, 40), 1.05, 1e-12);
}

static void slow_points_are_dropped_first(void **state)
{
  (void)state;
  int keep[COUNT(planted)];
  assert_int_equal(drop_slow(planted, COUNT(planted), 1000, keep), 0);
  assert_true(keep[6] && !keep[7] && !keep[8]);
  /* point 3 does not count as waste, nor does 6, the only one of its solver: the slowest go */
  assert_int_equal(drop_slow(planted, COUNT(planted), 90, keep), 2);
  assert_true(!keep[0] && !keep[1] && keep[2] && keep[6]);
  const struct candidate wasteful[] = {
    {0, 0, 0.1, 1, 1, 1}, {0, 1, 0.1, 3, 3, 3}, {0, 2, 0.01, 9, 9, 9}, {0, 3, 0.2, 2.5, 2, 3}};
  assert_int_equal(drop_slow(wasteful, 4, 13, keep), 1);
  assert_true(keep[0] && !keep[1] && keep[2] && keep[3]);
  assert_int_equal(drop_slow(wasteful, 4, 0, keep), 3); /* one stays, whatever it takes */
}

/* --- profiles: three problems, three solvers, worked out by hand --- */

static void profiles_of_known_costs(void **state)
{
  (void)state;
  const double cost[] = {1, 2, 4, 3, 1, NAN, 5, -1, 5};
  const struct profile p = {cost, 3, 3};
  assert_near(performance_profile(&p, 0, 1), 2.0 / 3, 1e-12);
  assert_near(performance_profile(&p, 1, 1), 1.0 / 3, 1e-12);
  assert_near(performance_profile(&p, 2, 1), 1.0 / 3, 1e-12);
  assert_near(performance_profile(&p, 0, 3), 1, 1e-12);
  assert_near(performance_profile(&p, 1, 2), 2.0 / 3, 1e-12);
  assert_near(performance_profile(&p, 1, 1e30), 2.0 / 3, 1e-12); /* a failure is never solved */
  assert_near(data_profile(&p, 0, 3), 2.0 / 3, 1e-12);
  assert_near(data_profile(&p, 2, 4.5), 1.0 / 3, 1e-12);
  assert_near(pairwise_wins(&p, 0, 1), 2.0 / 3, 1e-12);
  assert_near(pairwise_wins(&p, 1, 2), 2.0 / 3, 1e-12);
  assert_near(pairwise_wins(&p, 2, 1), 1.0 / 3, 1e-12);
}

/* --- orders --- */

static void exact_orders(void **state)
{
  (void)state;
  struct level levels[5];
  struct order fit;
  for (int k = 0; k < 5; k++) levels[k] = (struct level){pow(0.5, k), 3 * pow(0.5, 2 * k), 0};
  assert_int_equal(order_fit(levels, 5, 0, &fit), OK);
  assert_near(fit.order, 2, 1e-12);
  assert_near(fit.low, 2, 1e-6);
  assert_near(fit.high, 2, 1e-6);
  assert_near(exp(fit.level), 3, 1e-12);
  assert_near(order_local(&levels[0], &levels[1], 0), 2, 1e-12);
  levels[2].error = NAN; /* a run that failed is left out */
  assert_int_equal(order_fit(levels, 5, 0, &fit), OK);
  assert_int_equal(fit.n, 4);
  assert_near(fit.order, 2, 1e-12);
  assert_int_equal(order_fit(levels, 3, 0, &fit), ERR_USER);
}

/* Errors against the result at a finite step look of a higher order than they are, unless that is
 * reckoned with. */
static void orders_against_a_reference(void **state)
{
  (void)state;
  const double r = 1.0 / 32, orders[] = {0.5, 1, 2, 4};
  for (int o = 0; o < COUNT(orders); o++) {
    struct level levels[4];
    struct order fit;
    for (int k = 0; k < 4; k++) {
      const double h = pow(0.5, k);
      levels[k] = (struct level){h, 0.7 * (pow(h, orders[o]) - pow(r, orders[o])), 0};
    }
    assert_int_equal(order_fit(levels, 4, r, &fit), OK);
    assert_near(fit.order, orders[o], 1e-9);
    assert_near(order_local(&levels[2], &levels[3], r), orders[o], 1e-9);
    if (orders[o] <= 1) {
      assert_int_equal(order_fit(levels, 4, 0, &fit), OK);
      assert_true(fit.order > orders[o] + 0.05);
    }
  }
}

/* A textbook line with scatter: x = 0..3, y = 0, 1.2, 1.8, 3. By hand: slope 0.96, residuals
 * -0.06, 0.18, -0.18, 0.06, their squares 0.072; slope's sd sqrt(0.072/2/5), t(2, 0.975) 4.302653.
 */
static void interval_of_an_order(void **state)
{
  (void)state;
  const double y[] = {0, 1.2, 1.8, 3};
  struct level levels[4];
  struct order fit;
  for (int k = 0; k < 4; k++) levels[k] = (struct level){exp(k), exp(y[k]), 0};
  assert_int_equal(order_fit(levels, 4, 0, &fit), OK);
  const double half = 4.302652729911275 * sqrt(0.072 / 2 / 5);
  assert_near(fit.order, 0.96, 1e-12);
  assert_near(fit.low, 0.96 - half, 1e-9);
  assert_near(fit.high, 0.96 + half, 1e-9);
}

/* Weights: the level that scatters between starts hardly counts; and the interval is not narrower
 * than the starts' scatter, however well the line fits. */
static void weights_of_an_order(void **state)
{
  (void)state;
  struct level levels[5];
  struct order fit;
  for (int k = 0; k < 5; k++) levels[k] = (struct level){pow(0.5, k), pow(0.5, k), 0.01};
  levels[4].error *= 3;
  levels[4].sd = 100;
  assert_int_equal(order_fit(levels, 5, 0, &fit), OK);
  assert_near(fit.order, 1, 1e-6);
  assert_true(fit.high - fit.low > 0.01);
  for (int k = 0; k < 5; k++) levels[k].sd = 0;
  assert_int_equal(order_fit(levels, 5, 0, &fit), OK);
  assert_true(fit.order < 0.8);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(median_and_ranks),
    cmocka_unit_test(median_resists_outliers),
    cmocka_unit_test(front_of_known_points),
    cmocka_unit_test(cheapest_by_target),
    cmocka_unit_test(differences_below_noise_are_none),
    cmocka_unit_test(slow_points_are_dropped_first),
    cmocka_unit_test(profiles_of_known_costs),
#ifdef SPHBENCH_HAVE_GSL
    cmocka_unit_test(exact_orders),
    cmocka_unit_test(orders_against_a_reference),
    cmocka_unit_test(interval_of_an_order),
    cmocka_unit_test(weights_of_an_order),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
