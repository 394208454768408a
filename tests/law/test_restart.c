/* A run that was saved and loaded does, bit for bit, what the undisturbed one does: every solver on
 * scenes with each of the things that a scene may be made of. */
#include <unistd.h>

#include "../../core/base/memory.h"
#include "../../core/run/restart.h"
#include "laws.h"

enum { BEFORE = 7, AFTER = 6 };

static vec point(double x, double height)
{
  vec at = zero();
  at.c[0] = (real)x;
  at.c[DIM - 1] = (real)height;
  return at;
}

/* --- scenes */

static struct scene spinning(void) { return block(0, 0.1, 5, zero()); }

static struct scene sticky(void)
{
  struct scene s = block(9.81, 0.1, 5, zero());
  s.common.xsph = 0.05;
  s.common.viscosity = 0.1;
  s.common.viscosity_form = 0;
  s.common.tension = 0.01;
  return s;
}

static struct scene stiff_paste(void)
{
  struct scene s = block(9.81, 0.1, 5, zero());
  s.common.viscosity = 5;
  s.common.viscosity_form = 1;
  return s;
}

static struct scene periodic(void)
{
  struct scene s = block(0, 0.1, 0, point(0.9, 0.3));
  for (int d = 0; d < DIM; d++) {
    s.low.c[d] = (real)(-SIDE * DX / 2);
    s.high.c[d] = (real)(SIDE * DX / 2);
    s.period.c[d] = (real)(SIDE * DX);
  }
  return s;
}

static void sides(struct scene *s)
{
  vec low, high;
  for (int d = 0; d < DIM; d++) {
    low.c[d] = (real)(-SIDE * DX / 2);
    high.c[d] = (real)(SIDE * DX / 2);
  }
  high.c[0] += (real)(2 * DX);
  assert_int_equal(scene_wall_box(s, low, high, scene_wall_layers(s), 1), OK);
}

static struct scene in_a_tank(void)
{
  struct scene s = block(9.81, 0.1, 0, point(0.5, 0));
  sides(&s);
  s.common.viscosity = 0.1;
  return s;
}

static struct scene two_fluids(void)
{
  struct scene s = block(0, 0.1, 5, zero());
  int light;
  assert_int_equal(scene_find_fluid(&s, 100, 0, &light), OK);
  assert_int_equal(scene_set_fluid(&s, 0, light), OK);
  for (int i = 0; i < s.n; i++)
    if (s.x[i].c[DIM - 1] < 0) s.fluid_of[i] = 0;
  return s;
}

/* Fluid flows in above a tank in which a body floats: layers before and after the file. */
static struct scene busy(void)
{
  struct scene s = in_a_tank();
  struct scene_body body;
  struct scene_emitter e;
  vec low = point(-3 * DX, SIDE * DX / 2 + DX), high = point(0, SIDE * DX / 2 + 3 * DX);
  memset(&body, 0, sizeof body);
  memset(&e, 0, sizeof e);
  body.density = 700;
  if (DIM == 3) high.c[1] = (real)(2 * DX);
  const int first = s.n;
  assert_int_equal(scene_fill_box(&s, low, high, zero(), NULL), OK);
  assert_int_equal(scene_make_body(&s, first, &body), OK);
  e.centre = point(3 * DX, SIDE * DX);
  e.direction = point(0, -1);
  e.width = 3 * DX, e.depth = 3 * DX, e.speed = DX / (4 * DT), e.end = HUGE_VAL;
  assert_int_equal(scene_add_emitter(&s, &e), OK);
  return s;
}

static const struct {
  const char *name;
  struct scene (*make)(void);
} scenes[] = {{"spinning", spinning}, {"sticky", sticky},       {"stiff paste", stiff_paste},
              {"periodic", periodic}, {"in a tank", in_a_tank}, {"two fluids", two_fluids},
              {"busy", busy}};

/* --- comparison */

static struct run *make(const struct solver *solver, int which)
{
  struct run *run;
  struct scene scene = scenes[which].make();
  if (run_create(solver, NULL, &scene, 0, &run) != OK)
    fail_msg("%s: %s", solver->name, status_sentence());
  return run;
}

static int steps_on(struct run *run, int steps)
{
  for (int k = 0; k < steps && !run->diverged; k++) assert_int_equal(run_step(run), OK);
  return !run->diverged;
}

static void walk(struct run *run, const char *path, int saving)
{
  struct shelf shelf;
  if (shelf_open(&shelf, path, saving) != OK) fail_msg("%s", status_sentence());
  restart_walk(&shelf, run);
  if (shelf_close(&shelf) != OK) fail_msg("%s", status_sentence());
}

/* Every field that outlives the step, and the numbers beside them. */
static void compare(const struct run *a, const struct run *b, const char *what)
{
  const char *name = a->solver->name;
  assert_int_equal(a->view->p.n, b->view->p.n);
  assert_int_equal(a->step, b->step);
  assert_true(a->time == b->time && a->num_labels == b->num_labels);
  assert_int_equal(a->num_iterations, b->num_iterations);
  for (int k = 0; k < a->num_iterations; k++) {
    assert_string_equal(a->iterations[k].what, b->iterations[k].what);
    if (a->iterations[k].total != b->iterations[k].total ||
        a->iterations[k].solves != b->iterations[k].solves ||
        a->iterations[k].capped != b->iterations[k].capped ||
        a->iterations[k].most != b->iterations[k].most)
      fail_msg("%s, %s: %ld iterations of '%s' in %ld solves, not %ld in %ld", name, what,
               a->iterations[k].total, a->iterations[k].what, a->iterations[k].solves,
               b->iterations[k].total, b->iterations[k].solves);
  }
  for (int k = 0; k < a->store.num_fields; k++) {
    const struct store_field *f = &a->store.field[k], *g = &b->store.field[k];
    const size_t bytes = f->row.bytes * (size_t)a->store.count[f->row.where];
    if (f->row.life != KEPT && !f->is_public) continue;
    if (f->row.life != KEPT && (f->row.where != FLUID || f->row.components != 1)) continue;
    assert_int_equal(a->store.count[f->row.where], b->store.count[f->row.where]);
    if (memcmp(f->data, g->data, bytes) != 0)
      fail_msg("%s, %s: field '%s' differs", name, what, f->row.name);
  }
  for (int k = 0; a->body && k < a->scene.num_bodies; k++)
    if (memcmp(a->body[k].centre, b->body[k].centre, sizeof a->body[k].centre) ||
        memcmp(a->body[k].turn, b->body[k].turn, sizeof a->body[k].turn) ||
        memcmp(a->body[k].angular, b->body[k].angular, sizeof a->body[k].angular))
      fail_msg("%s, %s: body %d differs", name, what, k + 1);
}

static void restarted_is_undisturbed(void **unused)
{
  (void)unused;
  char path[] = "/tmp/sphbench-restart-XXXXXX";
  const int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  for (int which = 0; which < COUNT(scenes); which++) {
    struct scene scene = scenes[which].make();
    const unsigned asks = scene_asks(&scene);
    scene_free(&scene);
    FOR_SOLVERS(solver, asks)
    {
      struct run *whole = make(solver, which), *second = make(solver, which);
      assert_int_equal(restart_prepare(whole), OK);
      if (steps_on(whole, BEFORE)) {
        walk(whole, path, 1);
        walk(whole, path, 1); /* saving changes nothing */
        walk(second, path, 0);
        compare(whole, second, scenes[which].name);
        const int well = steps_on(whole, AFTER);
        assert_int_equal(steps_on(second, AFTER), well);
        compare(whole, second, scenes[which].name);
      } else {
        print_message("%s, %s: %s\n", solver->name, scenes[which].name, whole->reason);
      }
      run_free(whole);
      run_free(second);
    }
  }
  unlink(path);
}

/* A file that is cut short, of another size, or none at all is refused with a sentence. */
static void bad_files_are_refused(void **unused)
{
  (void)unused;
  char path[] = "/tmp/sphbench-restart-XXXXXX";
  const int file = mkstemp(path);
  struct shelf shelf;
  assert_true(file >= 0);
  close(file);
  assert_int_equal(shelf_open(&shelf, path, 0), ERR_USER);
  assert_non_null(strstr(status_sentence(), path));
  struct run *small = make(solvers[0], 0), *large = make(solvers[0], 4);
  assert_int_equal(restart_prepare(small), OK);
  walk(small, path, 1);
  assert_int_equal(shelf_open(&shelf, path, 0), OK);
  assert_int_equal(restart_walk(&shelf, large), ERR_USER);
  assert_int_equal(shelf_close(&shelf), ERR_USER);
  run_free(small);
  run_free(large);
  unlink(path);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(restarted_is_undisturbed),
    cmocka_unit_test(bad_files_are_refused),
  };
  return cmocka_run_group_tests_name("restart " SPHBENCH_VARIANT, tests, NULL, NULL);
}
