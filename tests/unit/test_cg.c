/* Conjugate gradients on rings, where answers are known. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "../../core/linear/cg.h"

enum { N = 8, MOST = (N + 1) * 8 + 8 };

/* A ring of N unknowns, each coupled to both neighbours by 1/w_i, and one that stands alone. */
struct ring {
  int first[N + 1], last[N + 1], list[MOST];
  real coef[MOST], diag[N + 1], weight[N + 1], b[N + 1], x[N + 1], r[N + 1], d[N + 1], q[N + 1];
  struct cg cg;
};

static void ring_make(struct ring *g, real lift)
{
  memset(g, 0, sizeof *g);
  for (int i = 0; i <= N; i++) {
    g->first[i] = g->last[i] = i * LANES;
    g->weight[i] = (real)(1 + 0.25 * i);
    g->diag[i] = 1;
  }
  for (int i = 0; i < N; i++) {
    g->last[i] += 2;
    g->list[g->first[i]] = (i + 1) % N;
    g->list[g->first[i] + 1] = (i + N - 1) % N;
    g->coef[g->first[i]] = g->coef[g->first[i] + 1] = 1 / g->weight[i];
    g->diag[i] = (2 + lift) / g->weight[i];
  }
  g->cg.n = N + 1;
  g->cg.rows.first = g->first, g->cg.rows.last = g->last, g->cg.rows.list = g->list;
  g->cg.coef = g->coef, g->cg.diag = g->diag, g->cg.weight = g->weight;
  g->cg.b = g->b, g->cg.x = g->x, g->cg.r = g->r, g->cg.d = g->d, g->cg.q = g->q;
}

#define EXACT (sizeof(real) == 4 ? 1e-4 : 1e-10)

static double row(const struct ring *g, int i)
{
  return ((double)(2 * g->x[i]) - (double)g->x[(i + 1) % N] - (double)g->x[(i + N - 1) % N]) /
         (double)g->weight[i];
}

/* 2 x_i - x_i+1 - x_i-1 = w_i b_i has a solution where sum w_i b_i = 0. */
static void constants_cost_nothing(void **unused)
{
  (void)unused;
  static struct ring g;
  double total = 0, mean = 0;
  ring_make(&g, 0);
  for (int i = 0; i <= N; i++) g.b[i] = (real)(3 + sin(1.7 * i));
  for (int i = 0; i < N; i++) mean += (double)(g.weight[i] * g.b[i]), total += (double)g.weight[i];
  mean /= total;
  const struct cg_result result = cg_solve(&g.cg, EXACT / 10, 100);
  assert_true(result.converged && result.iterations <= N + 2);
  for (int i = 0; i < N; i++) assert_true(fabs(row(&g, i) - (3 + sin(1.7 * i) - mean)) < EXACT);
  assert_true(fabs((double)g.x[N] - (3 + sin(1.7 * N))) < EXACT); /* alone, and left alone */
}

/* With the least hold nothing is taken away: sum x_i lift = sum w_i b_i. */
static void held_rows_keep_their_mean(void **unused)
{
  (void)unused;
  static struct ring g;
  double sum_x = 0, sum_b = 0;
  ring_make(&g, (real)0.125);
  for (int i = 0; i < N; i++) g.b[i] = (real)(3 + sin(1.7 * i));
  const struct cg_result result = cg_solve(&g.cg, EXACT / 10, 100);
  assert_true(result.converged);
  for (int i = 0; i < N; i++) {
    sum_x += 0.125 * (double)g.x[i];
    sum_b += (double)g.weight[i] * (3 + sin(1.7 * i));
    assert_true(fabs(row(&g, i) + 0.125 * (double)g.x[i] / (double)g.weight[i] -
                     (3 + sin(1.7 * i))) < 10 * EXACT);
  }
  assert_true(fabs(sum_x - sum_b) < 100 * EXACT);
}

static void nothing_gives_nothing(void **unused)
{
  (void)unused;
  static struct ring g;
  ring_make(&g, (real)0.125);
  for (int i = 0; i <= N; i++) g.x[i] = 7;
  const struct cg_result result = cg_solve(&g.cg, EXACT, 100);
  assert_true(result.converged && result.iterations == 0);
  for (int i = 0; i <= N; i++) assert_true(g.x[i] == 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(constants_cost_nothing),
    cmocka_unit_test(held_rows_keep_their_mean),
    cmocka_unit_test(nothing_gives_nothing),
  };
  return cmocka_run_group_tests_name("cg " SPHBENCH_VARIANT, tests, NULL, NULL);
}
