/* hybrid_twin.h - the hybrid particle-grid methods once more: on a dense grid, by double loops over
 * cells and particles, straight from the formulas of Liu et al. 2024, Sec. 6.3, Jiang et al. 2015
 * and Harlow & Welch 1965. */
#ifndef HYBRID_TWIN_H
#define HYBRID_TWIN_H
#include "twin_solvers.h"

enum { PIC, APIC, FLIP, NFLIP };
enum { FILLED, OCCUPIED, FRACTION };
enum { AIR, WATER, SOLID };
enum { LOW = -7, NUM = DIM == 2 ? 28 : 20, NUM_CELLS = DIM == 2 ? NUM * NUM : NUM * NUM * NUM };

struct choices {
  int method, surface, real_density;
  int iterations; /* of CG; 0: solve by elimination */
  double blend, spacing, kappa;
};
/* The cells, and what the particles carry from step to step. */
static struct {
  double h, C[TWIN_MOST][DIM][DIM], slip[TWIN_MOST][DIM];
  int exists[NUM_CELLS], kind[NUM_CELLS], known[NUM_CELLS][DIM];
  double fill[NUM_CELLS], excess[NUM_CELLS], p[NUM_CELLS];
  double load[NUM_CELLS][DIM], old[NUM_CELLS][DIM], u[NUM_CELLS][DIM], wall[NUM_CELLS][DIM];
} g;

static inline int whole(int I, int d)
{
  for (int e = 0; e < d; e++) I /= NUM;
  return I % NUM + LOW;
}
/* The cell a step along axis d from I; -1 where there is none. */
static inline int beside(int I, int d, int step)
{
  int stride = 1;
  for (int e = 0; e < d; e++) stride *= NUM;
  const int k = whole(I, d) + step - LOW;
  return k >= 0 && k < NUM && g.exists[I + stride * step] ? I + stride * step : -1;
}
static inline double hat(double r) { return fmax(0, 1 - fabs(r)); }
/* from a particle to the low face d of a cell, or to its centre with d < 0, along axis e, in h */
static inline double off(int I, int d, const double *x, int e)
{
  return whole(I, e) + (e == d ? 0 : 0.5) - x[e] / g.h;
}
static inline double weight(int I, int d, const double *x)
{
  double w = 1;
  for (int e = 0; e < DIM; e++) w *= hat(off(I, d, x, e));
  return w;
}

/* --- cells and P2G */

static inline void twin_cells(const struct cloud *c)
{
  for (int I = 0; I < NUM_CELLS; I++) {
    g.exists[I] = 0;
    for (int i = 0; i < c->n && !g.exists[I]; i++) {
      g.exists[I] = 1;
      for (int d = 0; d < DIM; d++)
        g.exists[I] &= abs(whole(I, d) - (int)floor(c->x[i][d] / g.h)) <= 1;
    }
  }
}

static inline void twin_faces(const struct cloud *c, const struct choices *o, int I, int d)
{
  double mass = 0, momentum = 0, number = 0, flow = 0;
  for (int i = 0; i < c->n_all; i++) {
    const double w = weight(I, d, c->x[i]);
    double v = c->v[i][d];
    if (i >= c->n) {
      number += w;
      flow += w * v;
      continue;
    }
    for (int e = 0; e < DIM && o->method == APIC; e++)
      v += g.C[i][d][e] * off(I, d, c->x[i], e) * g.h;
    mass += c->mass * w;
    momentum += c->mass * w * v;
  }
  g.load[I][d] = mass;
  g.old[I][d] = mass > 0 ? momentum / mass : 0;
  g.wall[I][d] = number > 0 ? flow / number : 0;
}

static inline void twin_kind(const struct cloud *c, const struct choices *o, int I)
{
  double fluid = 0, solid = 0, volume = 0, crowd = 0;
  int inside = 0;
  for (int i = 0; i < c->n_all; i++) {
    const double w = weight(I, -1, c->x[i]), share = w * pow(c->dx / g.h, DIM);
    if (i >= c->n) {
      solid += share;
      continue;
    }
    fluid += share;
    volume += c->mass / c->rho[i] * w;
    crowd += c->mass / c->rho[i] * (c->rho[i] / c->rho0 - 1) * w;
    int here = 1;
    for (int d = 0; d < DIM; d++) here &= (int)floor(c->x[i][d] / g.h) == whole(I, d);
    inside |= here;
  }
  g.fill[I] = fluid;
  g.excess[I] = fmax(o->real_density ? (volume > 0 ? crowd / volume : 0) : fluid - 1, 0);
  int touched = 1;
  for (int d = 0; d < DIM; d++) {
    const int H = beside(I, d, 1);
    touched &= H >= 0 && g.load[I][d] > 0.01 * c->mass && g.load[H][d] > 0.01 * c->mass;
  }
  const int filled = o->surface == FRACTION ? fluid > 0.5 : fluid >= 0.4;
  const int wet = o->surface == OCCUPIED ? inside : filled && (touched || inside);
  g.kind[I] = solid > 0.5 ? SOLID : wet ? WATER : AIR;
}

/* --- the projection */

/* the low face d of I, with the walls' condition */
static inline double twin_held(int I, int d)
{
  const int J = beside(I, d, -1), above = g.kind[I], below = J < 0 ? above : g.kind[J];
  if ((above == SOLID) == (below == SOLID)) return g.old[I][d];
  if (above == WATER || below == WATER) return g.wall[I][d];
  return below == SOLID ? fmax(g.old[I][d], g.wall[I][d]) : fmin(g.old[I][d], g.wall[I][d]);
}
/* part of the way to air cell J at which p = 0 */
static inline double twin_way(const struct choices *o, int I, int J)
{
  if (o->surface != FRACTION || g.fill[J] >= 0.5) return 1;
  return fmax((g.fill[I] - 0.5) / (g.fill[I] - g.fill[J]), 0.01);
}

static double matrix[TWIN_MOST][TWIN_MOST], rhs[TWIN_MOST], solution[TWIN_MOST];
static int water[TWIN_MOST], row_of[NUM_CELLS], num_rows;

static inline void twin_row(const struct cloud *c, const struct choices *o, int row)
{
  const int I = water[row];
  const double unit = 1 / (c->rho0 * g.h * g.h);
  double div = 0;
  memset(matrix[row], 0, sizeof matrix[row]);
  for (int d = 0; d < DIM; d++) {
    const int H = beside(I, d, 1);
    if (g.load[I][d] > 0 && g.load[H][d] > 0) div += (twin_held(H, d) - twin_held(I, d)) / g.h;
    for (int step = -1; step <= 1; step += 2) {
      const int J = beside(I, d, step);
      if (g.kind[J] == WATER) matrix[row][row_of[J]] = -unit;
      if (g.kind[J] == WATER) matrix[row][row] += unit;
      if (g.kind[J] == AIR) matrix[row][row] += unit / twin_way(o, I, J);
    }
  }
  if (matrix[row][row] < 1e-6 * unit) matrix[row][row] = 1e-6 * unit;
  rhs[row] = -div / c->dt + o->kappa * g.excess[I] / (c->dt * c->dt);
}

/* CG with Jacobi's preconditioner, so many iterations from 0 */
static inline void twin_cg(int iterations)
{
  static double r[TWIN_MOST], d[TWIN_MOST], q[TWIN_MOST];
  double rz = 0;
  for (int k = 0; k < num_rows; k++) {
    solution[k] = 0;
    r[k] = rhs[k];
    d[k] = r[k] / matrix[k][k];
    rz += r[k] * d[k];
  }
  for (int it = 0; it < iterations; it++) {
    double dq = 0, after = 0;
    for (int k = 0; k < num_rows; k++) {
      q[k] = 0;
      for (int l = 0; l < num_rows; l++) q[k] += matrix[k][l] * d[l];
      dq += d[k] * q[k];
    }
    for (int k = 0; k < num_rows; k++) {
      solution[k] += rz / dq * d[k];
      r[k] -= rz / dq * q[k];
      after += r[k] * r[k] / matrix[k][k];
    }
    for (int k = 0; k < num_rows; k++) d[k] = r[k] / matrix[k][k] + after / rz * d[k];
    rz = after;
  }
}
/* Gauss without pivoting: the matrix is positive definite. */
static inline void twin_eliminate(void)
{
  for (int k = 0; k < num_rows; k++)
    for (int i = k + 1; i < num_rows; i++) {
      const double f = matrix[i][k] / matrix[k][k];
      for (int j = k; j < num_rows && f != 0; j++) matrix[i][j] -= f * matrix[k][j];
      rhs[i] -= f * rhs[k];
    }
  for (int i = num_rows - 1; i >= 0; i--) {
    double rest = rhs[i];
    for (int j = i + 1; j < num_rows; j++) rest -= matrix[i][j] * solution[j];
    solution[i] = rest / matrix[i][i];
  }
}

static inline void twin_pressure(const struct cloud *c, const struct choices *o)
{
  num_rows = 0;
  for (int I = 0; I < NUM_CELLS; I++) {
    g.p[I] = 0;
    if (!g.exists[I] || g.kind[I] != WATER) continue;
    assert_true(num_rows < TWIN_MOST);
    row_of[I] = num_rows;
    water[num_rows++] = I;
  }
  for (int k = 0; k < num_rows; k++) twin_row(c, o, k);
  if (o->iterations)
    twin_cg(o->iterations);
  else
    twin_eliminate();
  for (int k = 0; k < num_rows; k++) g.p[water[k]] = solution[k];
}

static inline void twin_correct(const struct cloud *c, const struct choices *o, int I, int d)
{
  const int J = beside(I, d, -1), above = g.kind[I];
  const int below = J < 0 ? above : g.kind[J];
  const double pJ = J < 0 ? 0 : g.p[J];
  double gradient = 0;
  if (above == WATER && below == WATER) gradient = g.p[I] - pJ;
  if (above == WATER && below == AIR) gradient = g.p[I] / twin_way(o, I, J);
  if (above == AIR && below == WATER) gradient = -pJ / twin_way(o, J, I);
  g.u[I][d] = twin_held(I, d) - c->dt / c->rho0 * gradient / g.h;
  g.known[I][d] = above == WATER || below == WATER || (above == SOLID) != (below == SOLID);
}

/* one layer of faces that touch no fluid */
static inline void twin_spread(void)
{
  static int reached[NUM_CELLS][DIM];
  memcpy(reached, g.known, sizeof reached);
  for (int I = 0; I < NUM_CELLS; I++)
    for (int d = 0; d < DIM && g.exists[I]; d++) {
      double total = 0;
      int num = 0;
      for (int e = 0; e < DIM && !g.known[I][d]; e++)
        for (int step = -1; step <= 1; step += 2) {
          const int K = beside(I, e, step);
          if (K < 0 || !g.known[K][d]) continue;
          total += g.kind[I] == SOLID ? g.u[K][d] : g.u[K][d] - g.old[K][d];
          num++;
        }
      if (!num) continue;
      g.u[I][d] = (g.kind[I] == SOLID ? 0 : g.old[I][d]) + total / num;
      reached[I][d] = 1;
    }
  memcpy(g.known, reached, sizeof reached);
}

/* --- G2P and the step */

static inline void twin_particle(struct cloud *c, const struct choices *o, int i)
{
  double now[DIM] = {0}, before[DIM] = {0}, p = 0, open = 0;
  memset(g.C[i], 0, sizeof g.C[i]);
  for (int I = 0; I < NUM_CELLS; I++) {
    if (!g.exists[I]) continue;
    const double centre = g.kind[I] == SOLID ? 0 : weight(I, -1, c->x[i]);
    p += centre * g.p[I];
    open += centre;
    for (int d = 0; d < DIM; d++) {
      const double w = weight(I, d, c->x[i]);
      if (w == 0) continue;
      now[d] += w * g.u[I][d];
      before[d] += w * g.old[I][d];
      for (int e = 0; e < DIM; e++) {
        const double r = off(I, d, c->x[i], e);
        g.C[i][d][e] += (r > 0 ? 1 : -1) / g.h * w / hat(r) * g.u[I][d];
      }
    }
  }
  c->p[i] = open > 0 ? p / open : 0;
  for (int d = 0; d < DIM; d++) {
    c->v[i][d] = now[d] + (o->method >= FLIP ? o->blend * (c->v[i][d] - before[d]) : 0);
    g.slip[i][d] = o->method == FLIP ? now[d] - c->v[i][d] : 0;
  }
}

/* twice Eq. (17) of Liu et al., at most all of the approach */
static inline void twin_hold(struct cloud *c, int i)
{
  double dv[DIM] = {0}, total = 0;
  for (int j = c->n; j < c->n_all; j++) {
    const double w = 2 * c->mass / c->rho0 * twin_W(c, i, j);
    double approach = 0;
    for (int d = 0; d < DIM; d++) approach += (c->v[i][d] - c->v[j][d]) * c->normal[j][d];
    for (int d = 0; d < DIM; d++) dv[d] -= w * fmin(approach, 0) * c->normal[j][d];
    total += w;
  }
  for (int d = 0; d < DIM; d++) c->v[i][d] += dv[d] / fmax(total, 1);
}

static inline void twin_project(struct cloud *c, const struct choices *o)
{
  g.h = (double)(real)(o->spacing * c->dx);
  twin_cells(c);
  for (int I = 0; I < NUM_CELLS; I++)
    for (int d = 0; d < DIM && g.exists[I]; d++) twin_faces(c, o, I, d);
  for (int I = 0; I < NUM_CELLS; I++)
    if (g.exists[I]) twin_kind(c, o, I);
  twin_pressure(c, o);
  for (int I = 0; I < NUM_CELLS; I++)
    for (int d = 0; d < DIM && g.exists[I]; d++) twin_correct(c, o, I, d);
  for (int k = 0; k < DIM; k++) twin_spread();
  for (int i = 0; i < c->n; i++) twin_particle(c, o, i);
  for (int i = 0; i < c->n && o->method == NFLIP; i++) twin_hold(c, i);
}

static inline void twin_start(void)
{
  memset(g.C, 0, sizeof g.C);
  memset(g.slip, 0, sizeof g.slip);
}
static inline void twin_step(struct cloud *c, const struct choices *o)
{
  for (int i = 0; i < c->n; i++)
    for (int d = 0; d < DIM; d++) {
      c->x[i][d] += c->dt * (c->v[i][d] + g.slip[i][d]);
      c->v[i][d] += c->dt * c->gravity[d];
    }
  twin_density(c);
  if (c->xsph > 0) twin_viscosity(c, NULL);
  twin_project(c, o);
}
#endif
