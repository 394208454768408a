/* Variational staggered SPH against its formulas by double loops (He et al. 2020), with the matrix
 * written out, and its operators against fields that they know exactly. */
#include "twin_solvers.h"

struct choices {
  int symmetric, correction, shifting, iterations; /* of CG; 0: solve by elimination */
  double factor, separation, surface_below, kappa, bulk, surface;
};

static struct {
  double alpha[TWIN_MOST], D[TWIN_MOST], p[TWIN_MOST];
  int at_surface[TWIN_MOST];
} s;
static double A[TWIN_MOST][TWIN_MOST];

static double weight(const struct cloud *c, double r)
{
  const double q = r / (double)c->kernel.R;
  return r > 0 && q < 1 ? 1 - q * q * q * q : 0;
}
static double apart_by(const struct cloud *c, double r)
{
  return fmax(r, (double)(real)0.4 * (double)c->kernel.R);
}
static double towards(const struct cloud *c, int i, int j, int d)
{
  const double r = twin_distance(c, i, j);
  return r > 0 ? (c->x[i][d] - c->x[j][d]) / r : 0;
}
/* 1/alpha_i + 1/alpha_j, walls with alpha_i */
static double shares(const struct cloud *c, int i, int j)
{
  return 1 / s.alpha[i] + 1 / s.alpha[j < c->n ? j : i];
}

static void lattice(const struct cloud *c, double *alpha_max, double *a_max)
{
  double alpha = 0, second = 0;
  for (int a = -4; a <= 4; a++)
    for (int b = -4; b <= 4; b++)
      for (int e = DIM == 3 ? -4 : 0; e <= (DIM == 3 ? 4 : 0); e++) {
        const double r = c->dx * sqrt((double)(a * a + b * b + e * e));
        alpha += weight(c, r);
        second += weight(c, r) / pow(apart_by(c, r), 2);
      }
  *alpha_max = alpha;
  *a_max = 2 / alpha * second;
}

/* normal part of v_i - v_wall that the wall j takes away */
static double into(const struct cloud *c, const struct choices *o, int i, int j)
{
  double u = 0;
  for (int d = 0; d < DIM; d++) u += (c->v[i][d] - c->v[j][d]) * c->normal[j][d];
  return u < 0 ? u : o->separation * u;
}

static void assemble(const struct cloud *c, const struct choices *o)
{
  double alpha_max, a_max;
  lattice(c, &alpha_max, &a_max);
  for (int i = 0; i < c->n; i++) {
    s.alpha[i] = 0;
    for (int j = 0; j < c->n_all; j++) s.alpha[i] += weight(c, twin_distance(c, i, j));
    s.alpha[i] = fmax(s.alpha[i], alpha_max);
  }
  memset(A, 0, sizeof A);
  for (int i = 0; i < c->n; i++) {
    double full = 0, walls = 0, div = 0;
    for (int j = 0; j < c->n_all; j++) {
      const double r = twin_distance(c, i, j), w = weight(c, r) * shares(c, i, j);
      const double a = w / pow(apart_by(c, r), 2);
      full += a;
      if (j < c->n)
        A[i][j] -= a;
      else
        walls += a;
      for (int d = 0; d < DIM; d++) {
        const double u =
          j < c->n ? c->v[i][d] - c->v[j][d] : 2 * into(c, o, i, j) * c->normal[j][d];
        div += w / apart_by(c, r) * u * towards(c, i, j, d);
      }
    }
    s.at_surface[i] = full < (double)(real)o->surface_below * a_max;
    A[i][i] = fmax(fmax(full, a_max) - walls, 1e-6 * a_max);
    s.D[i] = -c->rho0 / (2 * c->dt) * div +
             o->kappa * fmax(c->rho[i] / c->rho0 - 1, 0) * c->rho0 / (DIM * c->dt * c->dt);
  }
}

/* Jacobi-preconditioned CG, so many iterations from 0 */
static void conjugate_gradients(int n, int iterations)
{
  static double r[TWIN_MOST], d[TWIN_MOST], q[TWIN_MOST];
  double rz = 0;
  for (int i = 0; i < n; i++) {
    s.p[i] = 0;
    r[i] = s.D[i];
    d[i] = r[i] / A[i][i];
    rz += r[i] * d[i];
  }
  for (int k = 0; k < iterations; k++) {
    double dq = 0, rz_new = 0;
    for (int i = 0; i < n; i++) {
      q[i] = 0;
      for (int j = 0; j < n; j++) q[i] += A[i][j] * d[j];
      dq += d[i] * q[i];
    }
    for (int i = 0; i < n; i++) {
      s.p[i] += rz / dq * d[i];
      r[i] -= rz / dq * q[i];
      rz_new += r[i] * r[i] / A[i][i];
    }
    for (int i = 0; i < n; i++) d[i] = r[i] / A[i][i] + rz_new / rz * d[i];
    rz = rz_new;
  }
}

/* Gauss without pivoting: m x = b, rows of `stride` numbers */
static void eliminate(double *m, int stride, double *b, double *x, int n)
{
  for (int k = 0; k < n; k++)
    for (int i = k + 1; i < n; i++) {
      const double f = m[i * stride + k] / m[k * stride + k];
      for (int j = k; j < n && f != 0; j++) m[i * stride + j] -= f * m[k * stride + j];
      b[i] -= f * b[k];
    }
  for (int i = n - 1; i >= 0; i--) {
    x[i] = b[i];
    for (int j = i + 1; j < n; j++) x[i] -= m[i * stride + j] * x[j];
    x[i] /= m[i * stride + i];
  }
}

static void correct(struct cloud *c, const struct choices *o)
{
  static double dv[TWIN_MOST][DIM];
  const double factor = o->factor > 0 ? o->factor : DIM;
  for (int i = 0; i < c->n; i++) {
    double mean[DIM] = {0}, wall[DIM] = {0}, moment[DIM][DIM] = {{0}}, change[DIM];
    for (int j = 0; j < c->n_all; j++) {
      const double r = twin_distance(c, i, j), w = weight(c, r), far = apart_by(c, r);
      const double pj = j < c->n ? s.p[j] : s.p[i], b = 0.5 * shares(c, i, j) * w;
      const double p = o->symmetric ? pj + s.p[i] : s.at_surface[i] ? pj : pj - s.p[i];
      double push = 0;
      for (int d = 0; d < DIM && j >= c->n; d++)
        push += into(c, o, i, j) * c->normal[j][d] * towards(c, i, j, d);
      for (int d = 0; d < DIM; d++) {
        const double e = towards(c, i, j, d);
        mean[d] += b / far * p * e;
        wall[d] -= factor / s.alpha[i] * w * push * e;
        for (int k = 0; k < DIM; k++) moment[d][k] += b * r / far * e * towards(c, i, j, k);
      }
    }
    if (o->correction && !o->symmetric && !s.at_surface[i])
      eliminate(moment[0], DIM, mean, change, DIM);
    else
      for (int d = 0; d < DIM; d++) change[d] = factor * mean[d];
    for (int d = 0; d < DIM; d++) dv[i][d] = c->dt / c->rho0 * change[d] + wall[d];
    c->p[i] = s.p[i];
  }
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) c->v[i][d] += dv[i][d];
}

/* pairs that are neighbours when shifting begins stay so */
static void shift(struct cloud *c, const struct choices *o)
{
  static double home[TWIN_MOST][DIM], move[TWIN_MOST][DIM], squeeze[TWIN_MOST];
  static char close[TWIN_MOST][TWIN_MOST];
  memcpy(home, c->x, sizeof home);
  for (int i = 0; i < c->n; i++)
    for (int j = 0; j < c->n_all; j++) close[i][j] = twin_distance(c, i, j) < (double)c->kernel.R;
  for (int step = 0; step < o->shifting; step++) {
    memset(squeeze, 0, sizeof squeeze);
    for (int i = 0; i < c->n; i++) {
      double rho = 0, slopes = 0;
      for (int j = 0; j < c->n_all; j++) {
        if (close[i][j]) rho += c->mass * twin_W(c, i, j);
        if (close[i][j] && j != i)
          slopes -= (double)kernel_dW(&c->kernel, (real)twin_distance(c, i, j), DIM);
      }
      squeeze[i] = fmax(rho / c->rho0 - 1, 0) / slopes;
    }
    for (int i = 0; i < c->n; i++) {
      double bulk[DIM] = {0}, g[DIM] = {0}, total = 0, length = 0;
      for (int j = 0; j < c->n_all; j++) {
        const double r = twin_distance(c, i, j), w = weight(c, r) / pow(apart_by(c, r), 2);
        if (!close[i][j]) continue;
        total += w;
        for (int d = 0; d < DIM; d++) {
          bulk[d] -= (squeeze[i] + squeeze[j]) * twin_grad(c, i, j, d);
          g[d] += w * towards(c, i, j, d);
        }
      }
      for (int d = 0; d < DIM; d++) length += g[d] * g[d] / (total * total);
      for (int d = 0; d < DIM; d++)
        move[i][d] = (double)(real)0.3 * (home[i][d] - c->x[i][d]) + o->bulk * c->dx * bulk[d] -
                     o->surface * c->dx * sqrt(length) * g[d] / total;
    }
    for (int i = 0; i < c->n; i++)
      for (int d = 0; d < DIM; d++) c->x[i][d] += move[i][d];
  }
}

static void twin_step(struct cloud *c, const struct choices *o)
{
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) {
      c->x[i][d] += c->dt * c->v[i][d];
      c->v[i][d] += c->dt * c->gravity[d];
    }
  twin_density(c);
  if (c->xsph > 0) twin_viscosity(c, NULL);
  assemble(c, o);
  if (o->iterations)
    conjugate_gradients(c->n, o->iterations);
  else
    eliminate(A[0], TWIN_MOST, s.D, s.p, c->n);
  correct(c, o);
  shift(c, o);
}

static void compare(const struct choices *o, int walls, unsigned long long seed)
{
  static struct cloud a, b;
  cloud_make(&a, DIM == 2 ? 11 : 6, walls, KERNEL_CUBIC, seed);
  a.xsph = (double)(real)0.05;
  b = a;
  const struct setting settings[] = {{"gradient", o->symmetric},
                                     {"correction", o->correction},
                                     {"factor", o->factor},
                                     {"separation", o->separation},
                                     {"surface_below", o->surface_below},
                                     {"kappa", o->kappa},
                                     {"shifting", o->shifting},
                                     {"shift_bulk", o->bulk},
                                     {"shift_surface", o->surface},
                                     {"tolerance", 1e-14},
                                     {"fixed_iterations", o->iterations},
                                     {NULL, 0}};
  cloud_run(&a, &solver_vssph, settings, 1);
  twin_step(&b, o);
  assert_same_cloud(&a, &b, o->iterations ? 1 : 2);
}

/* Four iterations of CG, which rounding cannot hide: everything but the end of the solve. */
static void one_step(void **unused)
{
  (void)unused;
  const struct choices forms[] = {
    {0, 0, 0, 4, 0, 1, 1, 0.125, 0, 0},         /* the defaults, with a density term */
    {1, 0, 0, 4, 1, 0.5, 1, 0, 0, 0},           /* symmetric, mean of the pairs, walls let go */
    {0, 1, 0, 4, 0, 1, 0.75, 0.125, 0, 0},      /* kernel correction inside */
    {0, 0, 3, 4, 0, 0.25, 1, 0, 0.5, 0.015625}, /* shifting */
  };
  for (int form = 0; form < 4; form++)
    for (int walls = 0; walls < 2; walls++) {
      print_message("form %d, %s\n", form, walls ? "walls" : "free");
      compare(&forms[form], walls, 11 + (unsigned long long)form);
    }
}

#ifndef REAL_IS_FLOAT
/* Converged CG against elimination: the matrix is symmetric without weights. */
static void converged_step(void **unused)
{
  (void)unused;
  const struct choices o = {0, 0, 0, 0, 0, 1, 1, 0.125, 0, 0};
  compare(&o, 0, 5);
  compare(&o, 1, 6);
}
#endif

/* Without walls the symmetric gradient keeps linear and angular momentum to rounding: it is the
 * adjoint of a source that sees no rotation. */
static void symmetric_keeps_momentum(void **unused)
{
  (void)unused;
  static struct cloud a, b;
  cloud_make(&a, DIM == 2 ? 11 : 6, 0, KERNEL_CUBIC, 3);
  b = a;
  const struct setting settings[] = {{"gradient", 1}, {"kappa", 0}, {NULL, 0}};
  cloud_run(&a, &solver_vssph, settings, 0);
  double spin = 0, lost[DIM] = {0}, exchanged = 0;
  for (int i = 0; i < a.n; i++) {
    double dv[DIM];
    for (int d = 0; d < DIM; d++) {
      dv[d] = a.v[i][d] - b.v[i][d];
      lost[d] += dv[d];
      exchanged += fabs(dv[d]);
    }
    spin += (b.x[i][0] * dv[1] - b.x[i][1] * dv[0]) / a.dx;
  }
  for (int d = 0; d < DIM; d++) assert_true(fabs(lost[d]) < TWIN_TOLERANCE * exchanged);
  assert_true(fabs(spin) < 20 * TWIN_TOLERANCE * exchanged);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(one_step),
#ifndef REAL_IS_FLOAT
    cmocka_unit_test(converged_step),
#endif
    cmocka_unit_test(symmetric_keeps_momentum),
  };
  return cmocka_run_group_tests_name("vssph twin " SPHBENCH_VARIANT, tests, NULL, NULL);
}
