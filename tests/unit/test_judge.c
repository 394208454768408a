/* The criteria of core/run/judge.h: each planted failure is found when it happens, for the right
 * reason and no other, and only what cannot go on ends the run. */
#include "../law/laws.h"

enum { STEPS = 40, WHEN = 12 /* the step that the fault is planted in */ };

/* --- a solver that does nothing but what is planted --- */

enum fault {
  NOTHING,
  BREAK_POSITION,
  BREAK_VELOCITY,
  GIVE_UP,
  SHOOT,
  THROW_OUT,
  LEAK_ONE,
  CLUMP,
  HEAT,
  STRETCH,
  COLLAPSE,
  HIT_CAP,
  HIT_CAP_SELDOM
};

typedef struct {
  VIEW;
} state;

static enum fault planted;

static void stretch(const state *s, real along, real across)
{
  for (int i = 0; i < s->p.n; i++) {
    s->p.x[i] = times(along, s->p.x[i]);
    s->p.x[i].c[DIM - 1] *= across / along;
  }
}

/* Every other particle of the middle at one place: the gaps are too small to be no fluid. */
static void clump(const state *s)
{
  const double part = 0.3 * SIDE * DX;
  for (int i = 0; i < s->p.n; i++) {
    int cell = 0, inside = 1;
    for (int d = 0; d < DIM; d++) {
      cell += (int)floor((double)s->p.x[i].c[d] / DX);
      inside &= fabs((double)s->p.x[i].c[d]) < part;
    }
    if (inside && cell % 2 == 0) s->p.x[i] = times((real)1e-3, s->p.x[i]);
  }
}

/* Far out, but neither fast nor denser there. */
static void throw_out(const state *s, int n)
{
  for (int i = 0; i < n; i++) s->p.x[i].c[i % DIM] += (real)(i % 3 ? 30 : -30);
}

static void plant(const state *s)
{
  const real hole = (real)NAN;
  const int n = s->p.n;
  if (planted == BREAK_POSITION) s->p.x[n / 2].c[0] = hole;
  if (planted == BREAK_VELOCITY) s->p.v[n - 1].c[DIM - 1] = (real)INFINITY;
  if (planted == SHOOT) s->p.v[0].c[0] = (real)1e4;
  if (planted == THROW_OUT) throw_out(s, n / 4);
  if (planted == LEAK_ONE) throw_out(s, 1);
  if (planted == CLUMP) clump(s);
  for (int i = 0; i < n && planted == HEAT; i++) s->p.v[i] = times((real)1.1, s->p.v[i]);
  if (planted == STRETCH) stretch(s, (real)1.08, (real)1.08);
  if (planted == COLLAPSE) stretch(s, 1, (real)0.8);
}

static status step(struct run *run, void *self)
{
  const long number = run_step_number(run) + 1; /* of this step */
  TRY(run_move(run));
  TRY(run_neighbours(run));
  TRY(run_forces(run));
  if (planted == HIT_CAP) run_iterations(run, "pressure", 9, 1, number < WHEN);
  if (planted == HIT_CAP_SELDOM) run_iterations(run, "pressure", 9, 1, number % 30 != 0);
  if (number != WHEN) return OK;
  if (planted == GIVE_UP) return run_diverged(run, "planted");
  plant(self);
  return OK;
}

static const struct solver planting = {
  .abi = SOLVER_ABI,
  .name = "planting",
  .about = "moves particles, and plants failures",
  .paper = "none",
  .doi = "none",
  .differences = "",
  .can = ~0u,
  .state_size = sizeof(state),
  .step = step,
};

/* --- the runs --- */

static struct run *carry_out(enum fault fault, struct scene *scene, int driven)
{
  struct run *run;
  struct record record = {0};
  struct setting setting = {0};
  planted = fault;
  assert_int_equal(run_create(&planting, NULL, scene, 0, &run), OK);
  run->judge.planned = STEPS;
  run->judge.driven = driven;
  for (int k = 0; k <= STEPS && !run->diverged; k++) {
    struct snapshot now;
    if (k > 0) assert_int_equal(run_step(run), OK);
    if (run->not_finite) break;
    assert_int_equal(run_snapshot(run, &now), OK);
    assert_int_equal(record_sample(&record, run, &setting, &now), OK);
    snapshot_free(&now);
  }
  judge_end(run);
  record_free(&record);
  return run;
}

static struct run *spinning(enum fault fault)
{
  struct scene scene = block(0, 0, 1, zero());
  return carry_out(fault, &scene, 0);
}

static int found(const struct run *run, enum criterion_number number)
{
  return run->judge.found >> number & 1u;
}

/* Is this the first, at that step, with a value beyond its limit? */
static void first_is(const struct run *run, enum criterion_number number, long step)
{
  const struct judged *first = run->judge.first;
  if (run->judge.n == 0) fail_msg("%s was not found", criteria[number].word);
  if (strcmp(first->criterion, criteria[number].word) != 0)
    fail_msg("%s was expected, %s found (%g, allowed %g)", criteria[number].word, first->criterion,
             first->value, first->limit);
  assert_true(fabs(first->time - (double)step * DT) < 1e-9);
  assert_true(first->value > first->limit);
  assert_string_equal(first->unit, criteria[number].unit);
}

static void a_sound_run_breaks_nothing(void **unused)
{
  (void)unused;
  struct run *run = spinning(NOTHING);
  assert_int_equal(run->judge.n, 0);
  assert_int_equal(run->step, STEPS);
  assert_true(run->judge.fastest > 0.05 && run->judge.fastest < 0.3);
  run_free(run);
}

static void what_is_not_finite_ends_the_run(void **unused)
{
  (void)unused;
  const enum fault faults[] = {BREAK_POSITION, BREAK_VELOCITY};
  for (int k = 0; k < 2; k++) {
    struct run *run = spinning(faults[k]);
    first_is(run, CRITERION_NOT_FINITE, WHEN);
    assert_int_equal(run->judge.n, 1);
    assert_true(run->diverged);
    assert_int_equal(run->step, WHEN);
    run_free(run);
  }
}

static void a_solver_that_gives_up(void **unused)
{
  (void)unused;
  struct run *run = spinning(GIVE_UP);
  first_is(run, CRITERION_GAVE_UP, WHEN);
  assert_string_equal(run->reason, "planted");
  run_free(run);
}

static void speed_ends_the_run(void **unused)
{
  (void)unused;
  struct run *run = spinning(SHOOT);
  first_is(run, CRITERION_SPEED, WHEN);
  assert_true(fabs(run->judge.first[0].value - 1e4) < 1);
  assert_true(run->judge.first[0].limit == run->speed_limit);
  assert_true(run->diverged);
  assert_int_equal(run->step, WHEN);
  run_free(run);
}

static void much_outside_is_blow_up_a_little_a_leak(void **unused)
{
  (void)unused;
  struct run *run = spinning(THROW_OUT);
  first_is(run, CRITERION_OUTSIDE, WHEN);
  assert_true(fabs(run->judge.first[0].value - (double)(run->view->p.n / 4) / run->view->p.n) <
              1e-9);
  assert_true(found(run, CRITERION_LEAK) && !run->diverged);
  run_free(run);
  run = spinning(LEAK_ONE);
  first_is(run, CRITERION_LEAK, WHEN);
  assert_true(run->judge.first[0].value == 1 && run->judge.n == 1);
  assert_false(criteria[CRITERION_LEAK].is_blow_up);
  assert_int_equal(run->step, STEPS);
  run_free(run);
}

static void density_and_volume_see_what_only_looks_alive(void **unused)
{
  (void)unused;
  struct run *run = spinning(CLUMP);
  first_is(run, CRITERION_DENSITY, WHEN);
  assert_true(run->judge.n == 1 && !run->diverged);
  run_free(run);
  run = spinning(STRETCH);
  first_is(run, CRITERION_VOLUME, WHEN);
  assert_true(run->judge.n == 1 && !run->diverged);
  run_free(run);
  run = spinning(COLLAPSE);
  first_is(run, CRITERION_VOLUME, WHEN);
  run_free(run);
}

/* The volume of what is spread too wide cannot be measured, that of three particles means nothing.
 */
static void volume_is_judged_where_there_is_one(void **unused)
{
  (void)unused;
  struct scene wide = block(0, 0, 1, zero()), few = empty_scene(0);
  vec x = zero();
  x.c[0] = x.c[1] = 1000;
  for (int d = 0; d < DIM; d++) wide.high.c[d] = 2000;
  assert_int_equal(scene_add(&wide, x, zero()), OK);
  struct run *run = carry_out(NOTHING, &wide, 0);
  assert_int_equal(run->judge.n, 0);
  run_free(run);
  for (int k = 0; k < 3; k++) {
    vec away = zero();
    x.c[0] = (real)(k * DX);
    x.c[1] = 0;
    away.c[0] = (real)(k - 1);
    assert_int_equal(scene_add(&few, x, away), OK);
  }
  run = carry_out(NOTHING, &few, 0);
  assert_int_equal(run->judge.n, 0);
  run_free(run);
}

/* A start that is denser than twice rho0 is judged by itself. */
static void a_compressed_start_is_no_failure(void **unused)
{
  (void)unused;
  struct scene scene = block(0, 0, 1, zero());
  for (int i = 0; i < scene.n; i++) scene.x[i] = times((real)0.5, scene.x[i]);
  struct run *run = carry_out(NOTHING, &scene, 0);
  assert_false(found(run, CRITERION_DENSITY));
  assert_true(run->judge.density > 3);
  run_free(run);
}

static void energy_is_judged_where_the_system_is_closed(void **unused)
{
  (void)unused;
  struct run *run = spinning(HEAT);
  first_is(run, CRITERION_ENERGY, WHEN);
  assert_int_equal(run->judge.n, 1);
  assert_true(!run->diverged);
  run_free(run);
  struct scene scene = block(0, 0, 1, zero());
  run = carry_out(HEAT, &scene, 1);
  assert_int_equal(run->judge.n, 0);
  run_free(run);
}

/* Falling freely is no growth, though the kinetic energy is 0 at the start. */
static void falling_wins_no_energy(void **unused)
{
  (void)unused;
  struct scene scene = block(9.81, 0, 0, zero());
  struct run *run = carry_out(NOTHING, &scene, 0);
  assert_int_equal(run->judge.n, 0);
  run_free(run);
  /* so long a fall, in such steps, that the rounding of time is more than a tenth of what the block
   * had, but not of what it won: falling by its own height takes 14 steps */
  scene = block(9.81, 0, 0, zero());
  scene.common.dt = sqrt(SIDE * DX / 9.81) / 14;
  run = carry_out(NOTHING, &scene, 0);
  assert_int_equal(run->judge.n, 0);
  assert_true(run->judge.growth > 0.02);
  run_free(run);
}

static void caps_count_by_steps(void **unused)
{
  (void)unused;
  struct run *run = spinning(HIT_CAP);
  first_is(run, CRITERION_ITERATIONS, WHEN + 2); /* the third step of 40 is more than 5 % */
  assert_true(run->judge.n == 1 && !run->diverged);
  run_free(run);
  run = spinning(HIT_CAP_SELDOM);
  assert_int_equal(run->judge.n, 0);
  assert_int_equal(run->judge.capped_steps, STEPS / 30);
  run_free(run);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_sound_run_breaks_nothing),
    cmocka_unit_test(what_is_not_finite_ends_the_run),
    cmocka_unit_test(a_solver_that_gives_up),
    cmocka_unit_test(speed_ends_the_run),
    cmocka_unit_test(much_outside_is_blow_up_a_little_a_leak),
    cmocka_unit_test(density_and_volume_see_what_only_looks_alive),
    cmocka_unit_test(volume_is_judged_where_there_is_one),
    cmocka_unit_test(a_compressed_start_is_no_failure),
    cmocka_unit_test(energy_is_judged_where_the_system_is_closed),
    cmocka_unit_test(falling_wins_no_energy),
    cmocka_unit_test(caps_count_by_steps),
  };
  return cmocka_run_group_tests_name("judge " SPHBENCH_VARIANT, tests, NULL, NULL);
}
