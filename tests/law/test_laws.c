/* Laws that hold for every solver in the registry. */
#include "laws.h"

#include <omp.h>

/* Nothing acts on a full lattice at rest. */
static void rest_stays_at_rest(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0, 0, zero());
    struct outcome out = outcome_of(solver, &scene, 5);
    double fastest = 0;
    for (int i = 0; i < out.n; i++) fastest = fmax(fastest, norm_of(out.v[i]));
    if (fastest > ROUNDING * DX / DT)
      fail_msg("%s: at rest, but a particle moves at %g m/s", solver->name, fastest);
    outcome_free(&out);
  }
}

/* A block in free fall is rigid, and every particle has v = n dt g. */
static void free_fall_is_exact(void **unused)
{
  (void)unused;
  const int steps = 10;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(GRAVITY))
  {
    struct scene scene = block(9.81, 0, 0, zero()), start = copy_of(&scene);
    struct outcome out = outcome_of(solver, &scene, steps);
    vec fall = zero();
    fall.c[DIM - 1] = (real)(-9.81 * steps * DT);
    for (int i = 0; i < out.n; i++) {
      const double wrong = norm_of(sub(out.v[i], fall));
      if (wrong > ROUNDING * 9.81 * steps * DT)
        fail_msg("%s: particle %d falls with a velocity that is wrong by %g m/s", solver->name, i,
                 wrong);
      const vec moved = sub(out.x[i], start.x[i]), moved0 = sub(out.x[0], start.x[0]);
      assert_true(norm_of(sub(moved, moved0)) < ROUNDING * DX);
    }
    const double way = -(double)sub(out.x[0], start.x[0]).c[DIM - 1], unit = 9.81 * DT * DT;
    /* symplectic Euler: the sum of the velocities before or after each kick */
    assert_true(way > (steps * (steps - 1) / 2 - 0.01) * unit &&
                way < (steps * (steps + 1) / 2 + 0.01) * unit);
    outcome_free(&out);
    scene_free(&start);
  }
}

static void lonely_particle_goes_straight(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = empty_scene(0);
    vec x = zero(), v = zero();
    v.c[0] = (real)0.25;
    v.c[1] = (real)-0.5;
    assert_int_equal(scene_add(&scene, x, v), OK);
    struct outcome out = outcome_of(solver, &scene, 16);
    assert_true(fabs((double)out.x[0].c[0] - 0.25 * 16 * DT) < ROUNDING * DX);
    assert_true(fabs((double)out.x[0].c[1] + 0.5 * 16 * DT) < ROUNDING * DX);
    assert_true(norm_of(sub(out.v[0], v)) < ROUNDING * 0.5);
    outcome_free(&out);
  }
}

/* A frame that moves by whole spacings per step (so that a world-fixed grid falls on itself) sees
 * the same. */
static void galilean(void **unused)
{
  (void)unused;
  const int steps = 4;
  vec drift = zero();
  drift.c[0] = (real)(DX / DT);
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene still = block(0, 0.05, 1, zero()), moving = copy_of(&still);
    for (int i = 0; i < moving.n; i++) moving.v[i] = plus(moving.v[i], drift);
    struct outcome a = outcome_of(solver, &still, steps), b = outcome_of(solver, &moving, steps);
    for (int i = 0; i < b.n; i++) {
      b.v[i] = sub(b.v[i], drift);
      b.x[i] = madd(b.x[i], (real)(-steps * DT), drift);
    }
    const double wrong = largest_difference(a.v, b.v, a.n);
    if (wrong > 50 * ROUNDING)
      fail_msg("%s: a moving frame sees velocities that differ by %g m/s", solver->name, wrong);
    outcome_free(&a);
    outcome_free(&b);
  }
}

static vec swap_axes(vec a)
{
  const real first = a.c[0];
  a.c[0] = a.c[1];
  a.c[1] = first;
  return a;
}

/* Reflection at the diagonal: x and y change places. */
static void mirror(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0.05, 1, zero()), mirrored = copy_of(&scene);
    for (int i = 0; i < mirrored.n; i++) {
      mirrored.x[i] = swap_axes(mirrored.x[i]);
      mirrored.v[i] = swap_axes(mirrored.v[i]);
    }
    struct outcome a = outcome_of(solver, &scene, 4), b = outcome_of(solver, &mirrored, 4);
    for (int i = 0; i < b.n; i++) b.v[i] = swap_axes(b.v[i]);
    const double wrong = largest_difference(a.v, b.v, a.n);
    if (wrong > 50 * ROUNDING)
      fail_msg("%s: the mirror image differs by %g m/s", solver->name, wrong);
    outcome_free(&a);
    outcome_free(&b);
  }
}

static vec turn(vec a)
{
  const real c = (real)cos(0.7), s = (real)sin(0.7), x = a.c[0], y = a.c[1];
  a.c[0] = c * x - s * y;
  a.c[1] = s * x + c * y;
  return a;
}

/* Rotation by an angle that no lattice knows. Methods with a grid fixed in space do not promise
 * this: theirs is measured only. */
static void rotation(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0.05, 1, zero()), turned = copy_of(&scene);
    for (int i = 0; i < turned.n; i++) {
      turned.x[i] = turn(turned.x[i]);
      turned.v[i] = turn(turned.v[i]);
    }
    struct outcome a = outcome_of(solver, &scene, 4), b = outcome_of(solver, &turned, 4);
    for (int i = 0; i < a.n; i++) a.v[i] = turn(a.v[i]);
    const double wrong = largest_difference(a.v, b.v, a.n);
    print_message("%-12s seen at an angle velocities differ by %.2g m/s\n", solver->name, wrong);
    if (!(wrong < (solver->can & CAN(ISOTROPIC) ? 50 * ROUNDING : 1)))
      fail_msg("%s: seen at an angle, velocities differ by %g m/s", solver->name, wrong);
    outcome_free(&a);
    outcome_free(&b);
  }
}

/* The order in which particles were given changes nothing but rounding. */
static void relabelling(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0.05, 1, zero()), turned = copy_of(&scene);
    const int n = scene.n;
    for (int i = 0; i < n; i++) {
      turned.x[i] = scene.x[n - 1 - i];
      turned.v[i] = scene.v[n - 1 - i];
    }
    struct outcome a = outcome_of(solver, &scene, 4), b = outcome_of(solver, &turned, 4);
    double wrong = 0;
    for (int i = 0; i < n; i++) wrong = fmax(wrong, norm_of(sub(a.v[i], b.v[n - 1 - i])));
    if (wrong > 50 * ROUNDING)
      fail_msg("%s: other labels change velocities by %g m/s", solver->name, wrong);
    outcome_free(&a);
    outcome_free(&b);
  }
}

/* Linear momentum: pairwise symmetric methods keep it to rounding; others state that they do not,
 * and lose less than a tenth of what they exchange. */
static void momentum(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE))
  {
    struct scene scene = block(0, 0.15, 1, zero()), start = copy_of(&scene);
    struct outcome out = outcome_of(solver, &scene, 4);
    vec lost = zero();
    double exchanged = 0;
    for (int i = 0; i < out.n; i++) {
      const vec change = sub(out.v[i], start.v[i]);
      lost = plus(lost, change);
      exchanged += norm_of(change);
    }
    const double defect = exchanged > 0 ? norm_of(lost) / exchanged : 0;
    print_message("%-12s momentum defect %.2e of what was exchanged\n", solver->name, defect);
    if (!(defect < (solver->can & CAN(MOMENTUM) ? 100 * ROUNDING : 0.1)))
      fail_msg("%s: loses %g of the momentum that it exchanges", solver->name, defect);
    outcome_free(&out);
    scene_free(&start);
  }
}

/* The same bits for 1, 2 and 4 threads, and forwards and backwards. */
static void bits(void **unused)
{
  (void)unused;
  const int threads[] = {1, 2, 4, 2}, reversed[] = {0, 0, 0, 1};
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(GRAVITY))
  {
    struct outcome first = {0};
    for (int k = 0; k < 4; k++) {
      omp_set_num_threads(threads[k]);
      sweep_reversed = reversed[k];
      struct scene scene = block(9.81, 0.1, 1, zero());
      struct outcome out = outcome_of(solver, &scene, 3);
      if (k == 0) {
        first = out;
        continue;
      }
      if (memcmp(first.x, out.x, sizeof(vec) * (size_t)out.n) ||
          memcmp(first.v, out.v, sizeof(vec) * (size_t)out.n))
        fail_msg("%s: other bits with %d threads%s", solver->name, threads[k],
                 reversed[k] ? ", reversed" : "");
      outcome_free(&out);
    }
    outcome_free(&first);
  }
  sweep_reversed = 0;
  omp_set_num_threads(2);
}

/* A field of a solver's own is not called as a public one, nor twice: files name them all. */
static void names_of_fields(void **unused)
{
  (void)unused;
#define FIELD(type, name, where, life, unit, meaning) #name,
  static const char *const taken[] = {
#include "../../core/particles/fields.def"
  };
#undef FIELD
  FOR_SOLVERS(solver, 0)
  {
    for (int k = 0; k < solver->num_fields; k++) {
      const char *name = solver->fields[k].name;
      int same = 0;
      for (int j = 0; j < k; j++) same += strcmp(solver->fields[j].name, name) == 0;
      for (int j = 0; j < NUM_FIELDS; j++) same += strcmp(taken[j], name) == 0;
      if (same) fail_msg("%s: the field '%s' is there already", solver->name, name);
    }
  }
}

/* `--set KEY=VALUE` and a result file know a parameter by its name alone: the scenes' common ones,
 * a scene's and a solver's. */
static void names_of_parameters(void **unused)
{
  (void)unused;
  for (int k = 0; k < num_solvers; k++)
    for (int j = 0; j < solvers[k]->num_params; j++) {
      const char *name = solvers[k]->params[j].name;
      if (param_find(scene_param_rows, num_scene_params, name))
        fail_msg("%s: every scene has a parameter '%s'", solvers[k]->name, name);
      for (int b = 0; b < num_benchmarks; b++)
        if (param_find(benchmarks[b]->params, benchmarks[b]->num_params, name))
          fail_msg("%s: scene %s has a parameter '%s' too", solvers[k]->name, benchmarks[b]->name,
                   name);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(names_of_fields),
    cmocka_unit_test(names_of_parameters),
    cmocka_unit_test(rest_stays_at_rest),
    cmocka_unit_test(free_fall_is_exact),
    cmocka_unit_test(lonely_particle_goes_straight),
    cmocka_unit_test(galilean),
    cmocka_unit_test(mirror),
    cmocka_unit_test(rotation),
    cmocka_unit_test(relabelling),
    cmocka_unit_test(momentum),
    cmocka_unit_test(bits),
  };
  return cmocka_run_group_tests_name("laws " SPHBENCH_VARIANT, tests, NULL, NULL);
}
