/* sisph_objective.h - Psi of Eq. (7) of semi-implicit SPH on the fixtures of tests/data, by double
 * loops, and its equations for KINSOL. Nothing of the solver is used.
 *
 * A fixture holds 4^3 particles: x* and the least point of Psi from it. m = rho0 dx^3, rho0 = 1000,
 * dx = 5 mm, h = 1 ms; the spiky kernel times a scale at which a full lattice has rho = rho0.
 *   Psi = sum_i m/(2 h^2) |x_i - x*_i|^2 + mu B(max(lambda_i, 1)),  lambda = rho/rho0
 * and Eq. (14) is the descent  (1 + S_i) (x_i' - x_i) = -h^2/m grad_i Psi  with
 * S_i = 2 mu h^2/rho0 sum_j |W'_ij|/r_ij. */
#ifndef SISPH_OBJECTIVE_H
#define SISPH_OBJECTIVE_H
#include "reference_checks.h"

enum { BLOCK = 64, BLOCK_NUMBERS = 3 * BLOCK };
enum { SISPH_B0, SISPH_B1, SISPH_B2 };

struct block {
  int kind;
  double dx, h, rho0, mu, m, R, scale;
  double start[BLOCK_NUMBERS], least[BLOCK_NUMBERS]; /* x* and the minimiser of the file, m */
};

/* W and -W'/r of the spiky kernel, scaled */
static inline void block_kernel(const struct block *b, double r, double *W, double *slope_over_r)
{
  const double u = 1 - r / b->R, norm = b->scale * 15 / (PI * b->R * b->R * b->R);
  *W = u > 0 ? norm * u * u * u : 0;
  if (slope_over_r) *slope_over_r = u > 0 ? norm * 3 * u * u / (b->R * r) : 0;
}

static inline double block_distance(const double *x, int i, int j)
{
  double r2 = 0;
  for (int d = 0; d < 3; d++) r2 += sq(x[3 * i + d] - x[3 * j + d]);
  return sqrt(r2);
}

/* rho summed over the infinite lattice is rho0 */
static inline double block_scale(struct block *b)
{
  double total = 0, W;
  b->scale = 1;
  for (int i = -3; i <= 3; i++)
    for (int j = -3; j <= 3; j++)
      for (int k = -3; k <= 3; k++) {
        block_kernel(b, b->dx * sqrt((double)(i * i + j * j + k * k)), &W, NULL);
        total += W;
      }
  return b->rho0 / (b->m * total);
}

static inline void block_read(struct block *b, const char *name, int kind, double support)
{
  char path[512], line[1024];
  int rows = 0;
  *b = (struct block){.kind = kind, .dx = 0.005, .h = 1e-3, .rho0 = 1000, .mu = 1};
  b->m = b->rho0 * b->dx * b->dx * b->dx;
  b->R = support * b->dx;
  b->scale = block_scale(b);
  snprintf(path, sizeof path, SPHBENCH_SOURCE_DIR "/tests/data/sisph_fixture_64_%s.csv", name);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    int i;
    double s[3], m[3];
    if (sscanf(line, "%d,%lf,%lf,%lf,%lf,%lf,%lf", &i, s, s + 1, s + 2, m, m + 1, m + 2) != 7)
      continue;
    memcpy(b->start + 3 * i, s, sizeof s);
    memcpy(b->least + 3 * i, m, sizeof m);
    rows++;
  }
  fclose(file);
  assert_int_equal(rows, BLOCK);
}

/* B(1 + e) and its slope */
static inline double block_energy(int kind, double e)
{
  return kind == SISPH_B0   ? e * e / 2
         : kind == SISPH_B1 ? e * e * (1 + e / 3)
                            : e * e * (1.5 + e + e * e / 4);
}
static inline double block_slope(int kind, double e)
{
  return kind == SISPH_B0 ? e : kind == SISPH_B1 ? e * (2 + e) : e * (3 + 3 * e + e * e);
}

/* e_i = max(rho_i/rho0 - 1, 0) */
static inline double block_excess(const struct block *b, const double *x, int i)
{
  double rho = 0, W;
  for (int j = 0; j < BLOCK; j++) {
    block_kernel(b, block_distance(x, i, j), &W, NULL);
    rho += b->m * W;
  }
  return fmax(rho / b->rho0 - 1, 0);
}

static inline double block_psi(const struct block *b, const double *x)
{
  long double total = 0;
  for (int k = 0; k < BLOCK_NUMBERS; k++) total += b->m / (2 * sq(b->h)) * sq(x[k] - b->start[k]);
  for (int i = 0; i < BLOCK; i++) total += b->mu * block_energy(b->kind, block_excess(b, x, i));
  return (double)total;
}

/* h^2/m grad Psi [m], and S_i where wanted */
static inline void block_gradient(const struct block *b, const double *x, double *gradient,
                                  double *S)
{
  double slope[BLOCK];
  const double factor = b->mu * sq(b->h) / b->rho0;
  for (int i = 0; i < BLOCK; i++) slope[i] = block_slope(b->kind, block_excess(b, x, i));
  for (int i = 0; i < BLOCK; i++) {
    double pull[3] = {0}, stiff = 0;
    for (int j = 0; j < BLOCK; j++) {
      double W, w;
      if (j == i) continue;
      block_kernel(b, block_distance(x, i, j), &W, &w);
      stiff += 2 * factor * w;
      for (int d = 0; d < 3; d++)
        pull[d] -= factor * (slope[i] + slope[j]) * w * (x[3 * i + d] - x[3 * j + d]);
    }
    for (int d = 0; d < 3; d++) gradient[3 * i + d] = x[3 * i + d] - b->start[3 * i + d] + pull[d];
    if (S) S[i] = stiff;
  }
}

/* For KINSOL, in units of dx: Eq. (14), and what it changes */
static inline void block_sweep(const double *x, double *out, void *block)
{
  const struct block *b = block;
  double at[BLOCK_NUMBERS], gradient[BLOCK_NUMBERS], S[BLOCK];
  for (int k = 0; k < BLOCK_NUMBERS; k++) at[k] = x[k] * b->dx;
  block_gradient(b, at, gradient, S);
  for (int k = 0; k < BLOCK_NUMBERS; k++) out[k] = x[k] - gradient[k] / (1 + S[k / 3]) / b->dx;
}
static inline void block_defect(const double *x, double *out, void *block)
{
  block_sweep(x, out, block);
  for (int k = 0; k < BLOCK_NUMBERS; k++) out[k] -= x[k];
}

/* The least point by KINSOL, in m: the sweep from x* with Anderson's acceleration over 5 steps, or
 * Newton-Krylov on what a sweep changes, after `sweeps` of them. Returns its iterations. */
static inline int block_fixed_point(const struct block *b, double *x)
{
  const struct reference_equations e = {BLOCK_NUMBERS, block_sweep, (void *)b, 1e-13, 3000, 5};
  int iterations;
  for (int k = 0; k < BLOCK_NUMBERS; k++) x[k] = b->start[k] / b->dx;
  if (reference_fixed_point(&e, x, &iterations)) fail_msg("%s", reference_error());
  for (int k = 0; k < BLOCK_NUMBERS; k++) x[k] *= b->dx;
  return iterations;
}
static inline int block_newton(const struct block *b, int sweeps, double *x)
{
  const struct reference_equations e = {BLOCK_NUMBERS, block_defect, (void *)b,
                                        1e-14,         100,          BLOCK_NUMBERS};
  double next[BLOCK_NUMBERS];
  int iterations;
  for (int k = 0; k < BLOCK_NUMBERS; k++) x[k] = b->start[k] / b->dx;
  for (; sweeps > 0; sweeps--) {
    block_sweep(x, next, (void *)b);
    memcpy(x, next, sizeof next);
  }
  if (reference_newton_krylov(&e, x, &iterations)) fail_msg("%s", reference_error());
  for (int k = 0; k < BLOCK_NUMBERS; k++) x[k] *= b->dx;
  return iterations;
}
#endif
