/* The step as a map: its Jacobian around a periodic lattice under pressure or tension, by central
 * differences, and the eigenvalues of it. For every solver that can run in a periodic domain the
 * spectral radius is printed; asserted is what theory states:
 *
 *   a lattice that is moved, or moves, as a whole stays so (eigenvalue 1)
 *   a gas of particles with an explicit equation of state has the dispersion of its discrete energy
 *     w^2(k) = (c^2/rho^2 - 2 p/rho^3) S S^T + 2 m p/rho^2 sum_j H(r_j) (1 - cos k.r_j),
 *     S = m sum_j grad W(r_j) sin k.r_j,  H = grad grad W,
 *   so that with symplectic Euler its map has the eigenvalues l + 1/l = 2 - dt^2 w^2: stable up to
 *   dt w = 2, and growing at the rate |w| where w^2 < 0, as Swegle, Hicks & Attaway 1995 found for
 *   tension (p W'' < 0), doi:10.1006/jcph.1995.1010.
 *
 * Nothing of the code under test is used for the theory, not even the kernel. */
#include "choices.h"

#if DIM == 2 && !defined(REAL_IS_FLOAT) && defined(SPHBENCH_HAVE_REFERENCE)
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>

enum { ACROSS = 6, N = ACROSS * ACROSS, HALF = 2 * N, ALL_DOF = 2 * HALF };

/* A solver with its parameters on a lattice whose spacing is `stretch` DX. */
struct lattice {
  const struct solver *solver;
  double value[MOST_PARAMS];
  double stretch, dt;
};

static int set(struct lattice *l, const char *name, double value)
{
  return set_param(l->solver, l->value, name, value);
}

static struct lattice make(const struct solver *solver, double stretch, double dt)
{
  struct lattice l = {.solver = solver, .stretch = stretch, .dt = dt};
  assert_true(solver->num_params <= MOST_PARAMS);
  for (int k = 0; k < solver->num_params; k++) l.value[k] = solver->params[k].initial;
  set(&l, "kappa", 0);
  return l;
}

/* As well as 100 iterations can; no better than differences do, and no fixed number of iterations:
 * in a periodic domain a pressure's equation is singular, and solvable only up to the disorder, so
 * that conjugate gradients run away when they are to do more. */
static void solve_well(struct lattice *l)
{
  for (int k = 0; k < l->solver->num_params; k++) {
    const struct param *p = &l->solver->params[k];
    if (strstr(p->name, "tolerance") || strstr(p->name, "error")) l->value[k] = 1e-4;
  }
  set(l, "max_iterations", 100);
}

static double place(const struct lattice *l, int dof)
{
  const int i = dof / 2, along = dof % 2 ? i / ACROSS : i % ACROSS;
  return (along + 0.5) * DX * l->stretch;
}

/* --- the map, in units of DX and DX/dt --- */

static void fill(const struct lattice *l, const double *z, struct scene *s)
{
  *s = empty_scene(0);
  s->common.dt = l->dt;
  for (int d = 0; d < DIM; d++) {
    s->low.c[d] = 0;
    s->high.c[d] = s->period.c[d] = (real)(ACROSS * DX * l->stretch);
  }
  for (int i = 0; i < N; i++) {
    vec x, v;
    for (int d = 0; d < DIM; d++) {
      x.c[d] = (real)(place(l, 2 * i + d) + DX * z[2 * i + d]);
      v.c[d] = (real)(DX / l->dt * z[HALF + 2 * i + d]);
    }
    assert_int_equal(scene_add(s, x, v), OK);
  }
}

/* Returns the largest |p| that acted, over rho0 (DX/dt)^2. */
static double map(const struct lattice *l, const double *z, double *out)
{
  struct scene scene;
  struct run *run;
  struct snapshot now;
  const double period = ACROSS * DX * l->stretch, unit = 1000 * DX * DX / (l->dt * l->dt);
  double most = 0;
  fill(l, z, &scene);
  if (run_create(l->solver, l->value, &scene, 0, &run) != OK)
    fail_msg("%s: %s", l->solver->name, status_sentence());
  assert_int_equal(run_step(run), OK);
  if (run->diverged) fail_msg("%s: %s", l->solver->name, run->reason);
  assert_int_equal(run_snapshot(run, &now), OK);
  for (int i = 0; i < N; i++)
    for (int d = 0; d < DIM; d++) {
      const int k = 2 * now.id[i] + d;
      const double moved = (double)now.x[i].c[d] - place(l, k);
      out[k] = (moved - period * rint(moved / period)) / DX;
      out[HALF + k] = (double)now.v[i].c[d] * l->dt / DX;
    }
  for (int i = 0; i < N && now.p; i++) most = fmax(most, fabs((double)now.p[i]) / unit);
  snapshot_free(&now);
  run_free(run);
  return most;
}

/* A column of the Jacobian. *kink: how far the map is from a straight line there, as a method is
 * that only resists what presses. */
static void column(const struct lattice *l, int dof, double *out, double *kink)
{
  const double step = 1e-6;
  double z[ALL_DOF] = {0}, above[ALL_DOF], below[ALL_DOF], rest[ALL_DOF];
  map(l, z, rest);
  z[dof] = step;
  map(l, z, above);
  z[dof] = -step;
  map(l, z, below);
  for (int k = 0; k < ALL_DOF; k++) {
    out[k] = (above[k] - below[k]) / (2 * step);
    *kink = fmax(*kink, fabs(above[k] + below[k] - 2 * rest[k]) / (2 * step));
  }
}

/* The number that a degree of freedom has when the lattice is moved by so many sites. */
static int moved(int dof, int right, int up)
{
  const int i = dof % HALF / 2;
  const int x = (i % ACROSS + right) % ACROSS, y = (i / ACROSS + up) % ACROSS;
  return dof / HALF * HALF + 2 * (x + ACROSS * y) + dof % 2;
}

/* All sites are alike: the columns of one particle are those of all. */
static gsl_matrix *jacobian(const struct lattice *l, double *kink)
{
  gsl_matrix *J = gsl_matrix_alloc(ALL_DOF, ALL_DOF);
  const int own[] = {0, 1, HALF, HALF + 1};
  double one[ALL_DOF];
  *kink = 0;
  for (int c = 0; c < 4; c++) {
    column(l, own[c], one, kink);
    for (int i = 0; i < N; i++)
      for (int k = 0; k < ALL_DOF; k++)
        gsl_matrix_set(J, (size_t)moved(k, i % ACROSS, i / ACROSS),
                       (size_t)moved(own[c], i % ACROSS, i / ACROSS), one[k]);
  }
  return J;
}

/* How far a column of another particle is from what its place says. */
static double unlike(const struct lattice *l, const gsl_matrix *J)
{
  double one[ALL_DOF], most = 0, kink = 0;
  const int dof = HALF + 2 * (ACROSS + 3) + 1;
  column(l, dof, one, &kink);
  for (int k = 0; k < ALL_DOF; k++)
    most = fmax(most, fabs(one[k] - gsl_matrix_get(J, (size_t)k, (size_t)dof)));
  return most;
}

static double spectral_radius(const gsl_matrix *J)
{
  gsl_matrix *copy = gsl_matrix_alloc(ALL_DOF, ALL_DOF);
  gsl_vector_complex *values = gsl_vector_complex_alloc(ALL_DOF);
  gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(ALL_DOF);
  double most = 0;
  gsl_matrix_memcpy(copy, J);
  gsl_eigen_nonsymm_params(0, 1, work);
  assert_int_equal(gsl_eigen_nonsymm(copy, values, work), 0);
  for (size_t k = 0; k < ALL_DOF; k++)
    most = fmax(most, gsl_complex_abs(gsl_vector_complex_get(values, k)));
  gsl_eigen_nonsymm_free(work);
  gsl_vector_complex_free(values);
  gsl_matrix_free(copy);
  return most;
}

/* J applied to a displacement of all, and to a velocity of all: how far they are from (1, 0) and
 * (1, 1). */
static double rigid_error(const gsl_matrix *J)
{
  double most = 0;
  for (size_t k = 0; k < ALL_DOF; k++)
    for (size_t d = 0; d < DIM; d++) {
      double shifted = 0, drifting = 0;
      for (size_t i = 0; i < N; i++) {
        shifted += gsl_matrix_get(J, k, 2 * i + d);
        drifting += gsl_matrix_get(J, k, HALF + 2 * i + d);
      }
      const int mine = k % 2 == d, is_place = k < HALF;
      most = fmax(most, fabs(shifted - (mine && is_place)));
      most = fmax(most, fabs(drifting - mine));
    }
  return most;
}

/* --- theory of the explicit gas --- */

/* Cubic spline with h = R/2 in 2-D: 10/(7 pi h^2) (1 - 1.5 q^2 + .75 q^3), (2 - q)^3/4. */
static double spline(double r, double h, int derivative)
{
  const double q = r / h, s = 10 / (7 * acos(-1) * h * h), two = 2 - q;
  if (q >= 2) return 0;
  if (derivative == 0)
    return s * (q < 1 ? 1 - 1.5 * q * q + 0.75 * q * q * q : two * two * two / 4);
  if (derivative == 1) return s / h * (q < 1 ? -3 * q + 2.25 * q * q : -0.75 * two * two);
  return s / (h * h) * (q < 1 ? -3 + 4.5 * q : 1.5 * two);
}

struct gas {
  double h, a, m, rho, p, c; /* a: spacing; p = c^2 (rho - rho0) */
};

static struct gas gas_of(const struct lattice *l, double c)
{
  const double h = 2.5 * DX / 2, rho0 = 1000;
  double full = 0, now = 0;
  for (int x = -3; x <= 3; x++)
    for (int y = -3; y <= 3; y++) {
      full += spline(DX * hypot(x, y), h, 0);
      now += spline(DX * l->stretch * hypot(x, y), h, 0);
    }
  const double m = rho0 / full, rho = m * now;
  return (struct gas){h, DX * l->stretch, m, rho, c * c * (rho - rho0), c};
}

/* The two w^2 of a wave vector, the smaller first. */
static void dispersion(const struct gas *g, double kx, double ky, double w2[2])
{
  double S[2] = {0}, M[2][2] = {{0}};
  for (int i = -3; i <= 3; i++)
    for (int j = -3; j <= 3; j++) {
      const double r = g->a * hypot(i, j), phase = g->a * (kx * i + ky * j);
      if (r == 0) continue;
      const double e[2] = {g->a * i / r, g->a * j / r};
      const double W1 = spline(r, g->h, 1), W2 = spline(r, g->h, 2);
      for (int a = 0; a < 2; a++) {
        S[a] += g->m * W1 * e[a] * sin(phase);
        for (int b = 0; b < 2; b++)
          M[a][b] += 2 * g->m * g->p / (g->rho * g->rho) * (1 - cos(phase)) *
                     (W2 * e[a] * e[b] + W1 / r * ((a == b) - e[a] * e[b]));
      }
    }
  const double stiff = g->c * g->c / (g->rho * g->rho) - 2 * g->p / (g->rho * g->rho * g->rho);
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) M[a][b] += stiff * S[a] * S[b];
  const double middle = (M[0][0] + M[1][1]) / 2;
  const double apart = hypot((M[0][0] - M[1][1]) / 2, M[0][1]);
  w2[0] = middle - apart;
  w2[1] = middle + apart;
}

/* The least and the largest w^2 of the waves that fit. */
static void extremes(const struct gas *g, double *least, double *most)
{
  *least = HUGE_VAL;
  *most = 0;
  for (int i = 0; i < ACROSS; i++)
    for (int j = 0; j < ACROSS; j++) {
      const double unit = 2 * acos(-1) / (ACROSS * g->a);
      double w2[2];
      dispersion(g, unit * i, unit * j, w2);
      *least = fmin(*least, w2[0]);
      *most = fmax(*most, w2[1]);
    }
}

/* |l| of the larger root of l^2 - (2 - dt^2 w^2) l + 1 = 0 */
static double root_of(double dt2w2)
{
  const double b = 1 - dt2w2 / 2;
  return b * b <= 1 ? 1 : fabs(b) + sqrt(b * b - 1);
}

static double theory_radius(const struct gas *g, double dt)
{
  double least, most;
  extremes(g, &least, &most);
  return fmax(root_of(dt * dt * least), root_of(dt * dt * most));
}

/* --- tests --- */

/* A method whose pressure follows a speed of sound explicitly, as a gas that conserves energy. */
static int make_gas(const struct solver *solver, double stretch, double dt, double c,
                    struct lattice *l)
{
  *l = make(solver, stretch, dt);
  const int is_free = choice(solver, "clamp", "free");
  if (!set(l, "c", c) || !set(l, "gamma", 1) || is_free < 0) return 0;
  set(l, "clamp", is_free);
  set(l, "alpha", 0);
  set(l, "cfl", 2); /* one substep */
  return 1;
}

/* Growth under tension, none under pressure, as the dispersion says. */
static void a_gas_grows_as_its_dispersion_says(void **unused)
{
  (void)unused;
  const double c = 10, dt = 2e-4, stretches[] = {1.01, 1, 0.99, 0.97};
  int found = 0;
  FOR_SOLVERS(solver, CAN(PERIODIC))
  {
    struct lattice l;
    for (int k = 0; k < 4 && make_gas(solver, stretches[k], dt, c, &l); k++) {
      const struct gas g = gas_of(&l, c);
      double kink;
      gsl_matrix *J = jacobian(&l, &kink);
      double least, most;
      extremes(&g, &least, &most);
      const double measured = spectral_radius(J), expected = theory_radius(&g, dt);
      const double W2 = spline(g.a, g.h, 2), P = g.p / (g.rho * g.rho);
      print_message("%-10s p %8.1f Pa: grows at %8.4f /s, dispersion %8.4f /s, Swegle's three "
                    "particles %8.4f /s\n",
                    solver->name, g.p, log(measured) / dt, log(expected) / dt,
                    P * W2 < 0 ? sqrt(-4 * g.m * P * W2) : 0);
      /* double eigenvalues are split by the root of what differences leave */
      assert_true(fabs(measured - expected) < (expected > 1 ? 1e-7 : 2e-4));
      if (P * W2 < 0) assert_true(expected > 1); /* Swegle's condition */
      assert_true(unlike(&l, J) < 1e-7);
      gsl_matrix_free(J);
      found = 1;
    }
  }
  if (!found) skip();
}

/* Explicit in time: stable while dt w < 2. */
static void a_gas_is_stable_up_to_its_acoustic_limit(void **unused)
{
  (void)unused;
  const double c = 10, stretch = 1;
  int found = 0;
  FOR_SOLVERS(solver, CAN(PERIODIC))
  {
    struct lattice l;
    double least, most;
    if (!make_gas(solver, stretch, 1e-4, c, &l)) continue;
    const struct gas g = gas_of(&l, c);
    extremes(&g, &least, &most);
    const double limit = 2 / sqrt(most);
    print_message("%-10s sound: stable up to dt = %.4f h/c\n", solver->name, limit * c / g.h);
    for (int beyond = 0; beyond < 2; beyond++) {
      l.dt = limit * (beyond ? 1.01 : 0.99);
      double kink;
      gsl_matrix *J = jacobian(&l, &kink);
      const double radius = spectral_radius(J);
      if (beyond)
        assert_true(fabs(radius - theory_radius(&g, l.dt)) < 1e-6);
      else
        assert_true(radius < 1 + 2e-4);
      gsl_matrix_free(J);
    }
    found = 1;
  }
  if (!found) skip();
}

/* Every method, at a state of rest: what moves as a whole stays so; without pressure nothing grows;
 * and a table. */
static void rest_is_neutral_and_rigid_motions_are_kept(void **unused)
{
  (void)unused;
  const double stretches[] = {0.99, 1.01}, dts[] = {1e-4, 1e-3, 1e-2};
  FOR_SOLVERS(solver, CAN(PERIODIC))
  for (int k = 0; k < 6; k++) {
    struct lattice l = make(solver, stretches[k / 3], dts[k % 3]);
    solve_well(&l);
    double kink;
    gsl_matrix *J = jacobian(&l, &kink);
    const double radius = spectral_radius(J), rigid = rigid_error(J);
    print_message("%-10s %s, dt %5.1f ms: spectral radius %9.6f, grows at %9.3f /s; rigid motion "
                  "to %.1e, kink %.1e\n",
                  solver->name, l.stretch < 1 ? "pressed  " : "stretched", 1e3 * l.dt, radius,
                  log(radius) / l.dt, rigid, kink);
    const double nothing[ALL_DOF] = {0};
    double unused_state[ALL_DOF];
    if (map(&l, nothing, unused_state) < 1e-12 && !(radius < 1 + 2e-4))
      fail_msg("%s: nothing acts, but disturbances grow by %g in a step", solver->name, radius);
    if (!(rigid < 1e-6)) fail_msg("%s does not keep a rigid motion", solver->name);
    gsl_matrix_free(J);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_gas_grows_as_its_dispersion_says),
    cmocka_unit_test(a_gas_is_stable_up_to_its_acoustic_limit),
    cmocka_unit_test(rest_is_neutral_and_rigid_motions_are_kept),
  };
  return cmocka_run_group_tests_name("spectrum " SPHBENCH_VARIANT, tests, NULL, NULL);
}
#else
int main(void) { return 77; } /* differences need doubles, eigenvalues the GSL, 3-D much time */
#endif
