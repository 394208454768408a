/* twin_dual.h - the projection on virtual particles by double loops (Liu et al. 2024), with the
 * matrix written out. The test that includes this places the virtual particles. */
#ifndef TWIN_DUAL_H
#define TWIN_DUAL_H
#include "twin_solvers.h"

enum { MOST_VIRTUAL = 3000 };
enum { DENSITY_VIRTUAL, DENSITY_REAL, DENSITY_COPIED };

struct choices {
  int strategy, saturated, adjoint, density, iterations; /* iterations of CG; 0: by elimination */
  int each;                                              /* virtual particles per particle */
  double kappa;
  int on_particles; /* virtual particles are copies: those of walls count as full */
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

/* Fill s.n and s.X from the cloud. */
static void generate(const struct cloud *c, const struct choices *o);
/* alpha_0 of Eq. (15): the full lattice of virtual particles */
static double alpha_zero(const struct cloud *c, const struct choices *o);

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
  if (o->density == DENSITY_COPIED) dense = I < c->n ? fmax(c->rho[I] / c->rho0 - 1, 0) : 0;
  if (o->density == DENSITY_REAL) {
    dense = 0;
    for (int j = 0; j < c->n && s.fluid[I]; j++)
      dense += volume(c, j) * (c->rho[j] / c->rho0 - 1) * W_at(c, between(s.X[I], c->x[j])) / cf;
    dense = fmax(dense, 0);
  }
  const double V0 = c->mass / c->rho0;
  const int in_wall = o->on_particles && I >= c->n && !s.fluid[I];
  s.V[I] = (in_wall ? V0 : o->saturated ? V0 * fmin(1, cI / 0.85) : V2) / o->each;
  s.D[I] = s.fluid[I] ? -div / c->dt + o->kappa * dense / (c->dt * c->dt) : 0;
  for (int d = 0; d < DIM; d++) s.lift[I][d] = s.fluid[I] ? grad[d] / cf : 0;
}

/* Eqs. (14), (15) with solid particles removed */
static void matrix(const struct cloud *c, const struct choices *o)
{
  const double alpha0 = alpha_zero(c, o);
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
  matrix(c, o);
  if (o->iterations)
    conjugate_gradients(o->iterations);
  else
    eliminate();
  correct(c, o);
}
#endif
