/* Anderson and Chebyshev on linear iterations g_i(x) = e_i x_i + b_i, whose errors are known. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../../core/linear/anderson.h"
#include "../../core/linear/chebyshev.h"

enum { N = 2500, FOLLOWERS = 1300 }; /* more than one chunk of a reduction */
static const double rounding = sizeof(real) == 4 ? 2e-5 : 1e-12;

static real x[N], g[N], last[N], px[FOLLOWERS], pg[FOLLOWERS];
static real df[ANDERSON_MOST][N], dg[ANDERSON_MOST][N], dp[ANDERSON_MOST][FOLLOWERS];

/* `kinds` eigenvalues between -0.9 and 0.9 in turn */
static double eigenvalue(int i, int kinds)
{
  return kinds > 1 ? -0.9 + 1.8 * (i % kinds) / (kinds - 1) : 0.9;
}
static double solution(int i) { return 1 + 0.001 * i; }
static double start(int i) { return cos(0.7 * i); }
static double error(int i) { return (double)x[i] - solution(i); }

static void propose(int kinds)
{
  for (int i = 0; i < N; i++)
    g[i] = (real)(solution(i) + eigenvalue(i, kinds) * ((double)x[i] - solution(i)));
}
static double largest_error(void)
{
  double most = 0;
  for (int i = 0; i < N; i++) most = fmax(most, fabs(error(i)));
  return most;
}

static double T(int k, double t) { return fabs(t) <= 1 ? cos(k * acos(t)) : cosh(k * acosh(t)); }

/* error_k = T_k(e/rho) / T_k(1/rho) error_0 */
static void test_chebyshev(void **unused)
{
  (void)unused;
  const double rho = 0.95;
  struct chebyshev s = {{0, NULL, NULL, NULL}, (real)rho, 0, 0};
  const struct chebyshev_field field = {N, x, g, last};
  for (int i = 0; i < N; i++) x[i] = (real)start(i);
  for (int k = 1; k <= 12; k++) {
    propose(7);
    chebyshev_next(&s);
    chebyshev_apply(&s, field);
    memcpy(x, g, sizeof x);
    for (int i = 0; i < N; i++) {
      const double ratio = T(k, eigenvalue(i, 7) / rho) / T(k, 1 / rho);
      assert_true(fabs(error(i) - ratio * (start(i) - solution(i))) < 10 * rounding);
    }
  }
}

static struct anderson anderson_make(int depth)
{
  struct anderson s;
  memset(&s, 0, sizeof s);
  s.depth = depth;
  s.field.n = N, s.field.g = g, s.x = x;
  s.follow.n = FOLLOWERS, s.follow.g = pg;
  for (int k = 0; k < depth; k++) s.df[k] = df[k], s.field.dg[k] = dg[k], s.follow.dg[k] = dp[k];
  for (int i = 0; i < N; i++) x[i] = (real)start(i);
  anderson_begin(&s);
  return s;
}

/* With as many columns as there are eigenvalues, the next value is the solution: to the half of the
 * digits that normal equations keep, and one step later to all. */
static void test_anderson_is_exact(void **unused)
{
  (void)unused;
  for (int kinds = 1; kinds <= ANDERSON_MOST; kinds++) {
    struct anderson s = anderson_make(kinds);
    for (int k = 0; k <= kinds; k++) {
      assert_true(largest_error() > 1e-3);
      propose(kinds);
      anderson_advance(&s);
      memcpy(x, g, sizeof x);
    }
    assert_true(largest_error() < sqrt(rounding));
    for (int k = 0; k < 3; k++) { /* and stays so, though its columns vanish */
      propose(kinds);
      anderson_advance(&s);
      memcpy(x, g, sizeof x);
      assert_true(largest_error() < 100 * rounding);
    }
  }
}

/* Depth 1:   x_{k+1} = g_k - gamma (g_k - g_{k-1}),   gamma = f_k.(f_k - f_{k-1})/|f_k -
 * f_{k-1}|^2; a field that is a linear function of x and is mixed alike stays that function. */
static void test_anderson_of_depth_one(void **unused)
{
  (void)unused;
  static double f_last[N], g_last[N], wanted[N];
  struct anderson s = anderson_make(1);
  for (int k = 0; k < 6; k++) {
    double over = 0, under = 0;
    propose(9);
    for (int i = 0; i < FOLLOWERS; i++) pg[i] = 3 - 2 * g[i];
    for (int i = 0; i < N; i++) {
      const double f = (double)g[i] - (double)x[i], change = f - f_last[i];
      over += f * change, under += change * change;
      f_last[i] = f;
    }
    const double gamma = k > 0 ? over / under : 0;
    for (int i = 0; i < N; i++) {
      wanted[i] = (double)g[i] - gamma * ((double)g[i] - g_last[i]);
      g_last[i] = (double)g[i];
    }
    anderson_advance(&s);
    for (int i = 0; i < N; i++) assert_true(fabs((double)g[i] - wanted[i]) < 10 * rounding);
    for (int i = 0; i < FOLLOWERS; i++)
      assert_true(fabs((double)pg[i] - (3 - 2 * (double)g[i])) < 20 * rounding);
    memcpy(x, g, sizeof x);
  }
}

/* Retreat gives what was proposed before the last advance, and the next advance is plain. */
static void test_retreat(void **unused)
{
  (void)unused;
  static real before[N];
  struct anderson s = anderson_make(3);
  for (int k = 0; k < 5; k++) {
    propose(9);
    for (int i = 0; i < FOLLOWERS; i++) pg[i] = px[i] = 3 - 2 * g[i];
    memcpy(before, g, sizeof g);
    anderson_advance(&s);
    memcpy(x, g, sizeof x);
  }
  propose(9);
  anderson_retreat(&s);
  assert_memory_equal(g, before, sizeof g);
  assert_memory_equal(pg, px, sizeof px);
  memcpy(x, g, sizeof x);
  propose(9);
  memcpy(before, g, sizeof g);
  anderson_advance(&s);
  assert_memory_equal(g, before, sizeof g);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_chebyshev),
    cmocka_unit_test(test_anderson_is_exact),
    cmocka_unit_test(test_anderson_of_depth_one),
    cmocka_unit_test(test_retreat),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
