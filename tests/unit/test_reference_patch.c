/* The rotating square patch's evolution, computed here, against the committed tables and laws. */
#include "reference_checks.h"

#define OWN_DATA SPHBENCH_SOURCE_DIR "/analysis/reference/data/"

enum { NODES = 128, MOST_TIMES = 25 };
static const double KE = 1.0 / 12, SPIN = -1.0 / 6, AREA = 1;

static void evolve(int nodes, const double *times, int count, struct reference_patch_instant *out)
{
  if (reference_square_patch_evolution(nodes, times, count, out)) fail_msg("%s", reference_error());
}

static double drift(const struct reference_patch_instant *now)
{
  return fmax(
    fabs(now->invariants.area - AREA),
    fmax(fabs(now->invariants.kinetic_energy - KE), fabs(now->invariants.angular_momentum - SPIN)));
}

/* The file's own errors are 1e-10 (5e-9 from 1.15 on) and 5e-9. */
static void test_table_and_program_agree(void **state)
{
  (void)state;
  const struct reference_series *p = reference_square_patch_p_centre();
  const struct reference_series *r = reference_square_patch_r_min();
  struct reference_patch_instant now[MOST_TIMES] = {0};
  double off[2] = {0}, most = 0, stated = 0;
  int count = 0;
  while (count < p->count && p->x[count] < 1.2 + 1e-12) count++;
  assert_int_equal(count, MOST_TIMES);
  evolve(NODES, p->x, count, now);
  for (int k = 0; k < count; k++) {
    const int late = p->x[k] > 1 + 1e-12;
    const double wrong = fabs(now[k].p_centre.value - p->y[k]);
    close_to("centre", now[k].p_centre.value, p->y[k], late ? 1e-7 : 1e-9);
    close_to("mid-edge", now[k].r_min.value, r->y[k], late ? 1e-6 : 3e-7);
    close_to("invariants", drift(now + k), 0, 1e-8);
    close_to("stated error", fmax(wrong - p->error[k], 0), 0, now[k].p_centre.error);
    if (!late) off[0] = fmax(off[0], wrong), stated = fmax(stated, now[k].p_centre.error);
    if (!late) off[1] = fmax(off[1], fabs(now[k].r_min.value - r->y[k]));
    most = fmax(most, drift(now + k));
  }
  assert_true(stated < 1e-8);
  print_message("to t omega = 1: p_c within %.1e (said: %.1e), r_min %.1e; invariants %.1e\n",
                off[0], stated, off[1], most);
}

/* From a square whose nodes crowd like alpha^2: N^-4 in the area, N^-2 in the node at the corner;
 * what the motion adds falls faster until CVODE's tolerance is left. */
static void test_nodes(void **state)
{
  (void)state;
  const double times[] = {0, 0.5, 1};
  struct reference_patch_instant now[3][3];
  memset(now, 0, sizeof now);
  double wrong[3][3];
  const double centre[] = {-0.14734270656302763113, -0.13296167036, -0.10382957399};
  for (int level = 0; level < 3; level++) {
    evolve(24 << level, times, 3, now[level]);
    for (int k = 0; k < 3; k++) wrong[level][k] = fabs(now[level][k].p_centre.value - centre[k]);
    print_message("%3d nodes: centre off by %.1e %.1e %.1e, invariants by %.1e\n", 24 << level,
                  wrong[level][0], wrong[level][1], wrong[level][2], drift(&now[level][2]));
  }
  for (int level = 0; level < 2; level++) {
    const double area = drift(&now[level][0]) / drift(&now[level + 1][0]);
    const double tip = (now[level][0].r_tip - sqrt(0.5)) / (now[level + 1][0].r_tip - sqrt(0.5));
    close_to("order of the area", log2(area), 4, 0.1);
    close_to("order of the corner", log2(tip), 2, 0.1);
    assert_true(wrong[level + 1][0] < wrong[level][0] / 30);
    assert_true(wrong[level + 1][2] < wrong[level][2] / 4);
    assert_true(drift(&now[level + 1][2]) < drift(&now[level][2]) / 4);
  }
  close_to("corner flies straight on", now[2][2].r_tip, 1, 2e-4);
}

/* The committed polygons lie on the computed outline, which is closed with the exact corners. */
static void test_outlines(void **state)
{
  (void)state;
  const double times[] = {0.5, 1};
  static const char *files[] = {"0p5", "1p0"};
  static struct reference_vec side[2][256], polygon[4 * 257];
  struct reference_patch_instant now[2] = {{.side = side[0]}, {.side = side[1]}};
  evolve(256, times, 2, now);
  for (int k = 0; k < 2; k++) {
    char path[256];
    struct reference_outline table, computed = {4 * 257, polygon};
    const struct reference_vec corner = {0.5 - times[k] / 2, -0.5 - times[k] / 2};
    double worst = 0;
    for (int i = 0; i < 4 * 257; i++) {
      struct reference_vec at = i % 257 ? side[k][i % 257 - 1] : corner;
      for (int turn = 0; turn < i / 257; turn++) at = (struct reference_vec){-at.y, at.x};
      polygon[i] = at;
    }
    snprintf(path, sizeof path, OWN_DATA "square_patch_outline_tw%s.csv", files[k]);
    if (reference_outline_read(path, &table)) fail_msg("%s", reference_error());
    for (int i = 0; i < table.count; i++)
      worst = fmax(worst, reference_outline_distance(&computed, table.points[i]));
    /* near the corner the nodes, and so the chords, are 1e-5 apart */
    close_to("outline", worst, 0, 2e-5);
    close_to("area", reference_outline_area(&computed), 1, 1e-4);
    print_message("outline at t omega = %g: %d points within %.1e\n", times[k], table.count, worst);
    reference_outline_free(&table);
  }
}

static void test_bad_arguments(void **state)
{
  (void)state;
  struct reference_patch_instant now[2] = {0};
  const double good[] = {0.1, 0.2}, falling[] = {0.2, 0.1}, late[] = {1, 1.3};
  assert_int_equal(reference_square_patch_evolution(30, good, 2, now), REFERENCE_BAD_ARGUMENT);
  assert_int_equal(reference_square_patch_evolution(8, good, 2, now), REFERENCE_BAD_ARGUMENT);
  assert_int_equal(reference_square_patch_evolution(32, good, 0, now), REFERENCE_BAD_ARGUMENT);
  assert_int_equal(reference_square_patch_evolution(32, falling, 2, now), REFERENCE_BAD_ARGUMENT);
  assert_int_equal(reference_square_patch_evolution(32, late, 2, now), REFERENCE_BAD_ARGUMENT);
  assert_true(strlen(reference_error()) > 10);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_table_and_program_agree),
    cmocka_unit_test(test_nodes),
    cmocka_unit_test(test_outlines),
    cmocka_unit_test(test_bad_arguments),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
