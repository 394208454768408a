/* The dual-particle strategies against their formulas by double loops (Liu et al. 2024), with the
 * matrix written out. */
#include "twin_solvers.h"

enum { SA, SB, SC };
enum { MOST_VIRTUAL = 3000 };

struct choices {
  int strategy, saturated, adjoint, real_density,
    iterations; /* iterations of CG; 0: solve by elimination */
  double kappa;
};

/* Virtual particles and the linear system on them. */
static struct {
  int n;
  double X[MOST_VIRTUAL][DIM], V[MOST_VIRTUAL], D[MOST_VIRTUAL], p[MOST_VIRTUAL];
  double lift[MOST_VIRTUAL][DIM];
  int fluid[MOST_VIRTUAL];
} s;
static double (*A)[MOST_VIRTUAL];

static double between(const double *a, const double *b)
{
  double r2 = 0;
  for (int d = 0; d < DIM; d++) r2 += (a[d] - b[d]) * (a[d] - b[d]);
  return sqrt(r2);
}
static double W_at(const struct cloud *c, double r)
{
  return (double)kernel_W(&c->kernel, (real)r, DIM);
}
static double dW_at(const struct cloud *c, double r)
{
  return (double)kernel_dW(&c->kernel, (real)r, DIM);
}
static double volume(const struct cloud *c, int j)
{
  return j < c->n ? c->mass / c->rho[j] : c->mass / c->rho0;
}

/* S.B: five PBF iterations on copies of the fluid */
static void even_out(const struct cloud *c)
{
  static double lambda[TWIN_MOST], shift[TWIN_MOST][DIM];
  memset(lambda, 0, sizeof lambda);
  static char close[TWIN_MOST][TWIN_MOST]; /* pairs as they were at the real particles */
  for (int i = 0; i < c->n_all; i++)
    for (int j = 0; j < c->n_all; j++) close[i][j] = twin_distance(c, i, j) < (double)c->kernel.R;
  for (int k = 0; k < 5; k++) {
    for (int i = 0; i < c->n; i++) {
      double rho = 0, squares = 0, own[DIM] = {0};
      for (int j = 0; j < c->n_all; j++) {
        const double r = between(s.X[i], s.X[j]);
        if (!close[i][j]) continue;
        rho += c->mass * W_at(c, r);
        for (int d = 0; d < DIM && r > 0; d++) {
          const double g = c->mass / c->rho0 * dW_at(c, r) * (s.X[i][d] - s.X[j][d]) / r;
          own[d] += g;
          squares += g * g;
        }
      }
      for (int d = 0; d < DIM; d++) squares += own[d] * own[d];
      lambda[i] = -fmax(rho / c->rho0 - 1, 0) / (squares + 1e-6 / (c->dx * c->dx));
    }
    memset(shift, 0, sizeof shift);
    for (int i = 0; i < c->n; i++)
      for (int j = 0; j < c->n_all; j++) {
        const double r = between(s.X[i], s.X[j]);
        for (int d = 0; d < DIM && r > 0 && close[i][j]; d++)
          shift[i][d] +=
            (lambda[i] + lambda[j]) * c->mass / c->rho0 * dW_at(c, r) * (s.X[i][d] - s.X[j][d]) / r;
      }
    for (int i = 0; i < c->n; i++)
      for (int d = 0; d < DIM; d++) s.X[i][d] += shift[i][d];
  }
}

/* S.C: is the node at `k` within the stencil of particle i's nearest node? */
static int in_stencil(const struct cloud *c, int i, const int *k)
{
  int others = 0, far = 0;
  for (int d = 0; d < DIM; d++) {
    const int off = abs(k[d] - (int)rint(c->x[i][d] / c->dx));
    others += off != 0;
    far = off > far ? off : far;
  }
  return far <= 1 || (far == 2 && others == 1);
}

static void nodes(const struct cloud *c)
{
  const int reach = 16;
  int k[3];
  s.n = 0;
  for (k[0] = -reach; k[0] <= reach; k[0]++)
    for (k[1] = -reach; k[1] <= reach; k[1]++)
      for (k[2] = DIM == 3 ? -reach : 0; k[2] <= (DIM == 3 ? reach : 0); k[2]++) {
        int found = 0;
        for (int i = 0; i < c->n_all && !found; i++) found = in_stencil(c, i, k);
        if (!found) continue;
        assert_true(s.n < MOST_VIRTUAL);
        for (int d = 0; d < DIM; d++) s.X[s.n][d] = c->dx * k[d];
        s.n++;
      }
}

static void generate(const struct cloud *c, const struct choices *o)
{
  if (o->strategy == SC) {
    nodes(c);
    return;
  }
  s.n = c->n_all;
  memcpy(s.X, c->x, sizeof(double) * DIM * (size_t)c->n_all);
  if (o->strategy == SB) even_out(c);
}

/* Eqs. (7), (8), (11), (12), (13) for one virtual particle */
static void source(const struct cloud *c, const struct choices *o, int I)
{
  double cI = 0, cf = 0, V2 = 0, rho = 0, vbar[DIM] = {0}, div = 0, grad[DIM] = {0};
  for (int j = 0; j < c->n_all; j++) {
    const double w = W_at(c, between(s.X[I], c->x[j])), V = volume(c, j);
    cI += V * w;
    V2 += V * V * w;
    rho += c->mass * w;
    if (j >= c->n) continue;
    cf += V * w;
    for (int d = 0; d < DIM; d++) vbar[d] += V * c->v[j][d] * w;
  }
  s.fluid[I] = cf > 0.001 * cI;
  for (int j = 0; j < c->n_all && s.fluid[I]; j++) {
    const double r = between(s.X[I], c->x[j]);
    for (int d = 0; d < DIM && r > 0; d++) {
      const double Vg = volume(c, j) * dW_at(c, r) * (s.X[I][d] - c->x[j][d]) / r;
      div += Vg * (c->v[j][d] - vbar[d] / cf);
      grad[d] += Vg;
    }
  }
  double dense = fmax(rho / c->rho0 - 1, 0);
  if (o->strategy == SB) dense = I < c->n ? fmax(c->rho[I] / c->rho0 - 1, 0) : 0;
  if (o->strategy == SC && o->real_density) {
    dense = 0;
    for (int j = 0; j < c->n && s.fluid[I]; j++)
      dense += volume(c, j) * (c->rho[j] / c->rho0 - 1) * W_at(c, between(s.X[I], c->x[j])) / cf;
    dense = fmax(dense, 0);
  }
  s.V[I] = o->saturated ? c->mass / c->rho0 * fmin(1, cI / 0.85) : V2;
  s.D[I] = s.fluid[I] ? -div / c->dt + o->kappa * dense / (c->dt * c->dt) : 0;
  for (int d = 0; d < DIM; d++) s.lift[I][d] = s.fluid[I] ? grad[d] / cf : 0;
}

/* Eq. (15), full lattice */
static double alpha_zero(const struct cloud *c)
{
  double total = 0;
  for (int a = -4; a <= 4; a++)
    for (int b = -4; b <= 4; b++)
      for (int e = DIM == 3 ? -4 : 0; e <= (DIM == 3 ? 4 : 0); e++) {
        const double r = c->dx * sqrt((double)(a * a + b * b + e * e));
        if (r > 0) total -= dW_at(c, r) / r;
      }
  return 2 / c->rho0 * c->mass / c->rho0 * total;
}

/* Eqs. (14), (15) with solid particles removed */
static void matrix(const struct cloud *c)
{
  const double alpha0 = alpha_zero(c);
  for (int I = 0; I < s.n; I++) {
    double full = 0, to_solid = 0;
    for (int J = 0; J < s.n; J++) {
      const double r = between(s.X[I], s.X[J]);
      const double a = r > 0 ? -2 / c->rho0 * s.V[J] * dW_at(c, r) / r : 0;
      A[I][J] = s.fluid[I] && s.fluid[J] ? -a : 0;
      full += a;
      if (!s.fluid[J]) to_solid += a;
    }
    A[I][I] = s.fluid[I] ? fmax(fmax(full, alpha0) - to_solid, 1e-6 * alpha0) : 1;
  }
}

/* Jacobi-preconditioned CG in <a, b> = sum V a b, so many iterations from 0 */
static void conjugate_gradients(int iterations)
{
  static double r[MOST_VIRTUAL], d[MOST_VIRTUAL], q[MOST_VIRTUAL];
  double rz = 0;
  for (int I = 0; I < s.n; I++) {
    s.p[I] = 0;
    r[I] = s.D[I];
    d[I] = r[I] / A[I][I];
    rz += s.V[I] * r[I] * d[I];
  }
  for (int k = 0; k < iterations; k++) {
    double dq = 0, rz_new = 0;
    for (int I = 0; I < s.n; I++) {
      q[I] = 0;
      for (int J = 0; J < s.n; J++) q[I] += A[I][J] * d[J];
      dq += s.V[I] * d[I] * q[I];
    }
    for (int I = 0; I < s.n; I++) {
      s.p[I] += rz / dq * d[I];
      r[I] -= rz / dq * q[I];
      rz_new += s.V[I] * r[I] * r[I] / A[I][I];
    }
    for (int I = 0; I < s.n; I++) d[I] = r[I] / A[I][I] + rz_new / rz * d[I];
    rz = rz_new;
  }
}

/* Gauss without pivoting: the matrix is diagonally dominant. */
static void eliminate(void)
{
  for (int k = 0; k < s.n; k++)
    for (int I = k + 1; I < s.n; I++) {
      const double f = A[I][k] / A[k][k];
      if (f == 0) continue;
      for (int J = k; J < s.n; J++) A[I][J] -= f * A[k][J];
      s.D[I] -= f * s.D[k];
    }
  for (int I = s.n - 1; I >= 0; I--) {
    double rest = s.D[I];
    for (int J = I + 1; J < s.n; J++) rest -= A[I][J] * s.p[J];
    s.p[I] = rest / A[I][I];
  }
}

/* Eqs. (16), (17), (18) */
static void correct(struct cloud *c, const struct choices *o)
{
  static double dv[TWIN_MOST][DIM];
  for (int i = 0; i < c->n; i++) {
    double G[DIM] = {0}, weight = 0, p = 0;
    for (int J = 0; J < s.n; J++) {
      const double r = between(c->x[i], s.X[J]), V = s.fluid[J] ? s.V[J] : 0, w = W_at(c, r);
      weight += V * w;
      p += V * w * s.p[J];
      for (int d = 0; d < DIM; d++) {
        if (r > 0) G[d] += V * s.p[J] * dW_at(c, r) * (c->x[i][d] - s.X[J][d]) / r;
        if (o->adjoint) G[d] += V * s.p[J] * w * s.lift[J][d];
      }
    }
    for (int d = 0; d < DIM; d++) c->v[i][d] -= c->dt / (o->adjoint ? c->rho[i] : c->rho0) * G[d];
    c->p[i] = weight > 0 ? p / weight : 0;
  }
  for (int i = 0; i < c->n; i++) {
    for (int d = 0; d < DIM; d++) dv[i][d] = 0;
    for (int j = c->n; j < c->n_all; j++) {
      double approach = 0;
      for (int d = 0; d < DIM; d++) approach += (c->v[i][d] - c->v[j][d]) * c->normal[j][d];
      for (int d = 0; d < DIM; d++)
        dv[i][d] -= c->mass / c->rho0 * twin_W(c, i, j) * fmin(approach, 0) * c->normal[j][d];
    }
  }
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += dv[i][d];
}

/* Algorithm 1 */
static void twin_step(struct cloud *c, const struct choices *o)
{
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) {
      c->x[i][d] += c->dt * c->v[i][d];
      c->v[i][d] += c->dt * c->gravity[d];
    }
  twin_density(c);
  if (c->xsph > 0) twin_viscosity(c, NULL);
  generate(c, o);
  for (int I = 0; I < s.n; I++) source(c, o, I);
  matrix(c);
  if (o->iterations)
    conjugate_gradients(o->iterations);
  else
    eliminate();
  correct(c, o);
}

static const struct solver *const strategies[] = {&solver_dual_sa, &solver_dual_sb,
                                                  &solver_dual_sc};

static void compare(const struct choices *o, int walls, unsigned long long seed)
{
  static struct cloud a, b;
  cloud_make(&a, DIM == 2 ? 11 : 6, walls, KERNEL_CUBIC, seed);
  a.xsph = (double)(real)0.05;
  b = a;
  const struct setting settings[] = {{"volume", o->saturated},
                                     {"gradient", o->adjoint},
                                     {"kappa", o->kappa},
                                     {"tolerance", 1e-14},
                                     {"fixed_iterations", o->iterations},
                                     {o->strategy == SC ? "density" : NULL, o->real_density},
                                     {NULL, 0}};
  cloud_run(&a, strategies[o->strategy], settings, 1);
  twin_step(&b, o);
  assert_same_cloud(&a, &b, o->iterations ? 1 : 2);
}

/* Four iterations of CG, which rounding cannot hide: everything but the end of the solve. */
static void one_step(void **unused)
{
  (void)unused;
  for (int strategy = SA; strategy <= SC; strategy++)
    for (int form = 0; form < 4; form++)
      for (int walls = 0; walls < 2; walls++) {
        const struct choices o = {strategy, form & 1, form >> 1, form & 1, 4, (double)(real)0.1};
        print_message("%s, form %d, %s\n", strategies[strategy]->name, form,
                      walls ? "walls" : "free");
        compare(&o, walls, 11 + (unsigned long long)form);
      }
}

#ifndef REAL_IS_FLOAT
/* Converged CG against elimination: the weighted inner product solves the printed, unsymmetric
 * system. */
static void converged_step(void **unused)
{
  (void)unused;
  for (int strategy = SA; strategy <= SC; strategy++) {
    const struct choices o = {strategy, 1, 0, strategy != SA, 0, 0.1};
    compare(&o, 1, 5);
  }
}
#endif

int main(void)
{
  A = malloc(sizeof(double) * MOST_VIRTUAL * (size_t)MOST_VIRTUAL);
  if (!A) return 77;
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(one_step),
#ifndef REAL_IS_FLOAT
    cmocka_unit_test(converged_step),
#endif
  };
  const int failed = cmocka_run_group_tests_name("dual twin " SPHBENCH_VARIANT, tests, NULL, NULL);
  free(A);
  return failed;
}
