/* Laws of what a scene may be made of: several fluids, rigid bodies, moving walls, Akinci's walls,
 * emitters. Where a solver takes part, all that can do it are tried. */
#include "../../core/base/memory.h"
#include "laws.h"

static double mass_of(const struct snapshot *now, int i)
{
  return now->light ? now->mass / (double)now->light[i] : now->mass;
}

static struct run *run_of(const struct solver *solver, struct scene *scene, int steps)
{
  struct run *run;
  if (run_create(solver, NULL, scene, 0, &run) != OK)
    fail_msg("%s: %s", solver->name, status_sentence());
  for (int k = 0; k < steps; k++) {
    assert_int_equal(run_step(run), OK);
    if (run->diverged) fail_msg("%s: %s", solver->name, run->reason);
  }
  return run;
}

static vec point(double x, double height)
{
  vec at = zero();
  at.c[0] = (real)x;
  at.c[DIM - 1] = (real)height;
  return at;
}

/* --- several fluids */

/* The upper half of a block is ten times lighter. */
static struct scene two_fluids(double gravity, double jitter)
{
  struct scene s = block(gravity, jitter, 1, zero());
  int light, k = 0;
  assert_int_equal(scene_find_fluid(&s, 100, 0, &light), OK);
  assert_int_equal(scene_set_fluid(&s, 0, light), OK);
  for (int i = 0; i < s.n; i++)
    if (s.x[i].c[DIM - 1] < 0) s.fluid_of[i] = 0, k++;
  assert_true(k == s.n / 2 || DIM == 3);
  return s;
}

/* sum m_i v_i with the true masses, against what the particles exchange */
static void momentum_of_two_fluids(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(FLUIDS) | CAN(MOMENTUM))
  {
    struct scene scene = two_fluids(0, 0.15);
    struct run *run = run_of(solver, &scene, 4);
    struct snapshot now;
    assert_int_equal(run_snapshot(run, &now), OK);
    double exchanged = 0, lost[DIM] = {0};
    for (int i = 0; i < now.n; i++) {
      const double m = mass_of(&now, i);
      const vec dv = sub(now.v[i], now.v_start[now.id[i]]);
      exchanged += m * norm_of(dv);
      for (int d = 0; d < DIM; d++) lost[d] += m * (double)dv.c[d];
    }
    for (int d = 0; d < DIM; d++)
      if (!(fabs(lost[d]) <= 100 * ROUNDING * exchanged))
        fail_msg("%s: two fluids lose %g of %g kg m/s", solver->name, lost[d], exchanged);
    assert_true(exchanged > 0);
    snapshot_free(&now);
    run_free(run);
  }
}

/* Heavy and light fall alike. */
static void two_fluids_fall_alike(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(FLUIDS))
  {
    struct scene scene = two_fluids(9.81, 0);
    for (int i = 0; i < scene.n; i++) scene.v[i] = zero();
    struct outcome out = outcome_of(solver, &scene, 5);
    for (int i = 0; i < out.n; i++) {
      const double wrong = norm_of(sub(out.v[i], point(0, -9.81 * 5 * DT)));
      if (!(wrong < ROUNDING * 9.81 * 5 * DT)) fail_msg("%s: falls by %g", solver->name, wrong);
    }
    outcome_free(&out);
  }
}

/* --- rigid bodies */

static struct scene body_alone(double density, double gravity, vec velocity, const double spin[3])
{
  struct scene s = empty_scene(gravity);
  struct scene_body body;
  memset(&body, 0, sizeof body);
  body.density = density;
  body.velocity = velocity;
  memcpy(body.spin, spin, sizeof body.spin);
  vec low = zero(), high = zero();
  for (int d = 0; d < DIM; d++) high.c[d] = (real)((d + 2) * DX); /* 2 x 3 or 2 x 3 x 4 particles */
  assert_int_equal(scene_fill_box(&s, low, high, zero(), NULL), OK);
  assert_int_equal(scene_make_body(&s, 0, &body), OK);
  assert_int_equal(scene_add(&s, point(5, 5), zero()), OK); /* a run needs some fluid */
  return s;
}

static const struct solver *some_solver(unsigned asks)
{
  for (int k = 0; k < num_solvers; k++)
    if (!solver_lacks(solvers[k], asks | (DIM == 2 ? CAN(2D) : CAN(3D)))) return solvers[k];
  return NULL;
}

/* Far from fluid a body keeps its spin's angular momentum, falls freely, and stays rigid. */
static void body_falls_and_turns(void **unused)
{
  (void)unused;
  const double spin[3] = {3, -2, 5};
  struct scene scene = body_alone(500, 9.81, point(1, 2), spin);
  const vec start = scene.body[0].centre;
  struct run *run = run_of(some_solver(CAN(BODIES)), &scene, 0);
  const struct body *b = &run->body[0];
  double before[3], far = 0;
  memcpy(before, b->angular, sizeof before);
  for (int k = 0; k < 200; k++) assert_int_equal(run_step(run), OK);
  const double t = 200 * DT;
  assert_true(fabs(b->centre[0] - (double)start.c[0] - t) < 1e-7);
  assert_true(fabs(b->velocity[DIM - 1] - (2 - 9.81 * t)) < 1e-5);
  for (int d = 0; d < 3; d++) assert_true(fabs(b->angular[d] - before[d]) < 1e-15);
  if (DIM == 2) assert_true(fabs(atan2(b->turn[1][0], b->turn[0][0]) - 5 * t) < 1e-6);
  struct snapshot now;
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int i = now.n; i < now.n_all; i++)
    for (int j = now.n; j < now.n_all; j++) far = fmax(far, norm_of(sub(now.x[i], now.x[j])));
  const double diagonal = DX * (DIM == 2 ? sqrt(1 + 4) : sqrt(1 + 4 + 9));
  assert_true(fabs(far - diagonal) < ROUNDING * DX);
  snapshot_free(&now);
  run_free(run);
}

/* Free rotation about no axis of inertia (3-D): energy 1/2 L.omega is kept to first order in dt. */
static double energy_drift(double dt)
{
  const double spin[3] = {3, -2, 5};
  struct scene scene = body_alone(500, 0, zero(), spin);
  scene.common.dt = dt;
  struct run *run = run_of(some_solver(CAN(BODIES)), &scene, 1);
  const struct body *b = &run->body[0];
  double start = 0, end = 0;
  for (int d = 0; d < 3; d++) start += b->angular[d] * b->spin[d];
  while (run->time < 0.2 - dt / 2) assert_int_equal(run_step(run), OK);
  for (int d = 0; d < 3; d++) end += b->angular[d] * b->spin[d];
  run_free(run);
  return fabs(end / start - 1);
}
static void free_rotation(void **unused)
{
  (void)unused;
  const double coarse = energy_drift(2e-3), fine = energy_drift(1e-3);
  if (DIM == 2)
    assert_true(coarse < 1e-12);
  else
    assert_true(fine < 0.01 && fine < 0.6 * coarse);
}

/* F = sum_i sum_b m_i m_b p_i/rho_i^2 grad_i W_ib and its torque, by a double loop: fluid around a
 * body with some pressure. */
static void push_is_the_sum_over_pairs(void **unused)
{
  (void)unused;
  struct scene scene = block(0, 0.2, 0, zero());
  struct scene_body body;
  int first = 0;
  memset(&body, 0, sizeof body);
  body.density = 700;
  for (int i = 0; i < scene.n; i++) { /* the particles in the middle go last */
    int inside = 1;
    for (int d = 0; d < DIM; d++) inside &= fabs((double)scene.x[i].c[d]) < 2.2 * DX;
    if (inside) continue;
    const vec x = scene.x[first];
    scene.x[first++] = scene.x[i];
    scene.x[i] = x;
  }
  const double weight = 700 * (scene.n - first) * pow(DX, DIM);
  assert_int_equal(scene_make_body(&scene, first, &body), OK);
  struct run *run = run_of(some_solver(CAN(BODIES)), &scene, 0);
  struct view *s = run->view;
  assert_int_equal(run_neighbours(run), OK);
  assert_int_equal(run_density(run), OK);
  const int n = s->p.n, all = s->p.n_all;
  real *p = malloc(sizeof(real) * (size_t)all), *rho = malloc(sizeof(real) * (size_t)all);
  vec *x = malloc(sizeof(vec) * (size_t)all);
  memory_to_host(x, s->p.x, sizeof(vec) * (size_t)all);
  memory_to_host(rho, s->p.rho, sizeof(real) * (size_t)n);
  for (int i = 0; i < n; i++) p[i] = (real)(1000 * (1 + sin(300 * (double)x[i].c[0])));
  memory_from_host(s->p.p, p, sizeof(real) * (size_t)n);
  double force[3] = {0}, turn = 0, m = (double)s->mass;
  const struct body *b = &run->body[0];
  assert_true(fabs(b->mass - weight) < 1e-9 * weight);
  for (int i = 0; i < n; i++)
    for (int k = n; k < all; k++) {
      const vec r = sub(x[i], x[k]);
      const double far = norm_of(r);
      const double W1 = (double)kernel_dW(&s->nb.kernel, (real)far, DIM) / far;
      const double size = m * m * (double)p[i] / ((double)rho[i] * (double)rho[i]) * W1;
      double arm[DIM];
      for (int d = 0; d < DIM; d++) {
        force[d] += size * (double)r.c[d];
        arm[d] = (double)x[k].c[d] - b->centre[d];
      }
      turn += size * (arm[0] * (double)r.c[1] - arm[1] * (double)r.c[0]);
    }
  bodies_push(run, DT);
  for (int d = 0; d < DIM; d++) {
    const double got = b->velocity[d] * b->mass / DT;
    if (!(fabs(got - force[d]) < ROUNDING * norm_of(point(force[0], force[DIM - 1]))))
      fail_msg("force %g N, not %g", got, force[d]);
  }
  assert_true(fabs(b->angular[2] / DT - turn) < ROUNDING * fabs(turn) && fabs(turn) > 0);
  free(p);
  free(rho);
  free(x);
  run_free(run);
}

/* What a body gives to the fluid it gets back: a block runs into a body of its own size. */
static void impact_keeps_momentum(void **unused)
{
  (void)unused;
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(BODIES))
  {
    struct scene scene = block(0, 0, 0, point(1, 0));
    const int n = scene.n;
    struct scene_body body;
    memset(&body, 0, sizeof body);
    body.density = 1000;
    vec low = zero(), high = zero();
    for (int d = 0; d < DIM; d++)
      low.c[d] = (real)(-SIDE * DX / 2), high.c[d] = (real)(SIDE * DX / 2);
    low.c[0] = (real)(SIDE * DX / 2), high.c[0] = (real)(SIDE * DX);
    assert_int_equal(scene_fill_box(&scene, low, high, zero(), NULL), OK);
    assert_int_equal(scene_make_body(&scene, n, &body), OK);
    struct run *run = run_of(solver, &scene, 20);
    struct snapshot now;
    assert_int_equal(run_snapshot(run, &now), OK);
    double fluid = 0;
    const double before = now.n * pow(DX, DIM) * 1000;
    for (int i = 0; i < now.n; i++) fluid += (double)now.v[i].c[0] * pow(DX, DIM) * 1000;
    const double solid = run->body[0].velocity[0] * run->body[0].mass;
    print_message("%-12s body got %.3f of the momentum, %.2g is missing\n", solver->name,
                  solid / before, 1 - (solid + fluid) / before);
    if (!(solid > 0.1 * before && fabs(solid + fluid - before) < 0.1 * solid))
      fail_msg("%s: of %g kg m/s fluid keeps %g, the body gets %g", solver->name, before, fluid,
               solid);
    snapshot_free(&now);
    run_free(run);
  }
}

/* --- prescribed motion */

static void walls_follow_their_motion(void **unused)
{
  (void)unused;
  struct scene_body motion;
  memset(&motion, 0, sizeof motion);
  motion.velocity = point(0.2, 0);
  motion.period = 0.1;
  struct scene scene = empty_scene(0);
  vec low = zero(), high = zero();
  for (int d = 0; d < DIM; d++) high.c[d] = (real)(4 * DX);
  assert_int_equal(scene_wall_box(&scene, low, high, 1, 0), OK);
  assert_int_equal(scene_move_walls(&scene, 0, &motion), OK);
  vec middle = zero();
  for (int d = 0; d < DIM; d++) middle.c[d] = (real)(2.01 * DX);
  assert_int_equal(scene_add(&scene, middle, zero()), OK);
  const double first = (double)scene.wall_x[0].c[0];
  double lowest = 0;
  struct run *run = run_of(some_solver(CAN(MOVING_WALLS)), &scene, 30);
  struct snapshot now;
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int b = now.n; b < now.n_all; b++)
    lowest = b == now.n ? (double)now.x[b].c[0] : fmin(lowest, (double)now.x[b].c[0]);
  /* the integral of V cos(2 pi t/T), by the midpoint rule of the steps */
  const double way = 0.2 * 0.1 / (2 * M_PI) * sin(2 * M_PI * 0.3);
  assert_true(fabs(lowest - first - way) < 1e-3 * way);
  snapshot_free(&now);
  run_free(run);
}

/* --- Akinci's walls */

/* Of a straight row of spacing dx in 2-D, a flat square layer in 3-D: m_b = rho0 gamma / sum W(k
 * dx), with gamma such that a half space of the lattice at dx from it is as dense as the whole
 * lattice. */
static void weights_of_walls(void **unused)
{
  (void)unused;
  struct scene scene = empty_scene(0);
  scene.common.walls = WALLS_AKINCI;
  assert_int_equal(scene_wall_layers(&scene), 1);
  vec low = zero(), high = zero();
  for (int d = 0; d < DIM; d++) high.c[d] = (real)(20 * DX);
  assert_int_equal(scene_wall_box(&scene, low, high, 1, 0), OK);
  assert_int_equal(scene_add(&scene, times((real)(10 * DX), point(1, 1)), zero()), OK);
  struct run *run = run_of(some_solver(CAN(WALLS)), &scene, 0);
  const struct kernel k = run->view->nb.kernel;
  double layer[7] = {0}, all = 0; /* sums of W over the lattice's layers, k - 3 from a particle */
  for (int k_of = -3; k_of <= 3; k_of++)
    for (int a = -3; a <= 3; a++)
      for (int b = DIM == 3 ? -3 : 0; b <= (DIM == 3 ? 3 : 0); b++)
        layer[k_of + 3] +=
          (double)kernel_W(&k, (real)(DX * sqrt((double)(a * a + b * b + k_of * k_of))), DIM);
  for (int l = 0; l < 7; l++) all += layer[l];
  const double missing = all - layer[3] - layer[4] - layer[5] - layer[6];
  const double expected = 1000 / all * missing / layer[4]; /* V_0 fills what is missing */
  real *m = malloc(sizeof(real) * (size_t)run->view->p.n_all);
  memory_to_host(m, run->view->p.m, sizeof(real) * (size_t)run->view->p.n_all);
  int flat = 0;
  for (int b = 1; b < run->view->p.n_all; b++) flat += fabs((double)m[b] / expected - 1) < 1e-5;
  const int inner_side = 20 - 2 * 2; /* away from the edges */
  assert_true(flat >= (DIM == 2 ? 4 * inner_side : 6 * inner_side * inner_side));
  assert_true((double)m[1] > 1000 * pow(DX, DIM)); /* one layer stands for several */
  free(m);
  run_free(run);
}

/* --- emitters */

static void fluid_flows_in(void **unused)
{
  (void)unused;
  const int steps = 40; /* at 0.5 m/s and dt 1 ms: two layers' ways */
  FOR_SOLVERS(solver, CAN(FREE_SURFACE) | CAN(EMITTERS))
  {
    struct scene scene = empty_scene(0);
    struct scene_emitter e;
    memset(&e, 0, sizeof e);
    e.centre = point(0, 0);
    e.direction = point(3, 0); /* any length */
    e.width = 4 * DX, e.depth = 3 * DX, e.speed = 0.5, e.begin = 0.005, e.end = HUGE_VAL;
    assert_int_equal(scene_add(&scene, point(-1, 0), zero()), OK);
    assert_int_equal(scene_add_emitter(&scene, &e), OK);
    struct run *run = run_of(solver, &scene, steps);
    struct snapshot now;
    assert_int_equal(run_snapshot(run, &now), OK);
    /* layers at t = 5 and 25 ms (the next one comes at 45 ms) */
    assert_int_equal(now.n, 1 + 2 * (DIM == 2 ? 4 : 12));
    char seen[64] = {0};
    for (int i = 0; i < now.n; i++) {
      assert_true(now.id[i] >= 0 && now.id[i] < now.n && !seen[now.id[i]]);
      seen[now.id[i]] = 1;
      if (now.id[i] == 0) continue;
      const double due = now.id[i] <= (DIM == 2 ? 4 : 12) ? 5e-3 : 25e-3;
      const double way = 0.5 * (now.time - due);
      if (!(fabs((double)now.x[i].c[0] - way) < 0.05 * DX))
        fail_msg("%s: a particle has come %g m, not %g", solver->name, (double)now.x[i].c[0], way);
    }
    snapshot_free(&now);
    run_free(run);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(momentum_of_two_fluids),
    cmocka_unit_test(two_fluids_fall_alike),
    cmocka_unit_test(body_falls_and_turns),
    cmocka_unit_test(free_rotation),
    cmocka_unit_test(push_is_the_sum_over_pairs),
    cmocka_unit_test(impact_keeps_momentum),
    cmocka_unit_test(walls_follow_their_motion),
    cmocka_unit_test(weights_of_walls),
    cmocka_unit_test(fluid_flows_in),
  };
  return cmocka_run_group_tests_name("parts " SPHBENCH_VARIANT, tests, NULL, NULL);
}
