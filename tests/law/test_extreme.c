/* What no scene file can hold, for every solver: places that are no numbers or beyond all others,
 * no particle at all, and a far origin. No run may crash, hang or lose a particle; a run may end,
 * and then says why. */
#include "laws.h"

/* Some steps; the particles that are left must be those of the start. */
static void survives(const struct solver *solver, struct scene *scene, const char *what)
{
  struct run *run;
  struct record record = {0};
  struct setting setting = {0};
  const int n = scene->n;
  assert_int_equal(run_create(solver, NULL, scene, 0, &run), OK);
  for (int k = 0; k < 5 && !run->diverged; k++) {
    struct snapshot now;
    if (run_step(run) != OK) fail_msg("%s, %s: %s", solver->name, what, status_sentence());
    if (run->not_finite) break;
    assert_int_equal(run_snapshot(run, &now), OK);
    assert_int_equal(record_sample(&record, run, &setting, &now), OK);
    assert_int_equal(now.n, n);
    snapshot_free(&now);
  }
  if (run->diverged) {
    print_message("%-12s %s: %s\n", solver->name, what, run->reason);
    assert_true(run->judge.n > 0);
  }
  record_free(&record);
  run_free(run);
}

static void one_particle_at_1e30(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(GRAVITY))
  for (int axis = 0; axis < DIM; axis++) {
    struct scene scene = block(9.81, 0, 1, zero());
    vec far = zero();
    far.c[axis] = (real)(axis ? -1e30 : 1e30);
    assert_int_equal(scene_add(&scene, far, zero()), OK);
    survives(solver, &scene, "a particle at 1e30 m");
  }
}

/* Particles that single precision can hardly tell apart. */
static void far_from_the_origin(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0, 1, zero());
    for (int i = 0; i < scene.n; i++)
      for (int d = 0; d < DIM; d++) scene.x[i].c[d] += (real)1e6;
    for (int d = 0; d < DIM; d++) scene.high.c[d] = (real)2e6;
    survives(solver, &scene, "1000 km from the origin");
  }
}

/* Everything at one place, which scene_check refuses: a run may meet it on its way. */
static void all_at_one_place(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0, 0, zero());
    for (int i = 0; i < scene.n; i++) scene.x[i] = zero();
    survives(solver, &scene, "all at one place");
  }
}

static void no_particle(void **unused)
{
  (void)unused;
  struct scene scene = empty_scene(9.81);
  assert_int_equal(scene_check(&scene), ERR_USER);
  assert_non_null(strstr(status_sentence(), "no "));
  scene_free(&scene);
}

static void a_place_that_is_no_number_is_named(void **unused)
{
  (void)unused;
  const real wrong[] = {(real)NAN, (real)INFINITY, -(real)INFINITY};
  for (int k = 0; k < 6; k++) {
    struct scene scene = block(0, 0, 0, zero());
    (k < 3 ? scene.x : scene.v)[17].c[1] = wrong[k % 3];
    assert_int_equal(scene_check(&scene), ERR_USER);
    if (!strstr(status_sentence(), "fluid particle 17 ")) fail_msg("%s", status_sentence());
    scene_free(&scene);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(one_particle_at_1e30),
    cmocka_unit_test(far_from_the_origin),
    cmocka_unit_test(all_at_one_place),
    cmocka_unit_test(no_particle),
    cmocka_unit_test(a_place_that_is_no_number_is_named),
  };
  return cmocka_run_group_tests_name("extreme " SPHBENCH_VARIANT, tests, NULL, NULL);
}
