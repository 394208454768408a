/* The rotating square patch in time: Cauchy's integral on the free surface, CVODE along it.
 *
 * Units L = omega = rho = 1. The fluid has the uniform vorticity -2, so that with W = phi + i psi
 * analytic u - i v = dW/dz + i conj(z). By the four-fold symmetry W is analytic in zeta = z^4, and
 * in that plane one side of the patch is a closed curve. On the free surface
 *   dz/dt = u + i v,   D phi/Dt = |grad phi|^2/2 + r^2/2 + 2 psi      (mean of phi: 0)
 * psi follows from phi by   pi i W_i = PV int W dzeta/(zeta - zeta_i),  whose real part
 *   int (psi - psi_i) Im(dzeta/(zeta - zeta_i)) = int (phi_i - phi) Re(dzeta/(zeta - zeta_i))
 * GMRES solves for psi. Nodes are even in a parameter alpha and crowd towards the corner, where W ~
 * z^2 log z. The integrand's own value at alpha_i is W' there: every derivative of what the nodes
 * carry, this one too, is the trigonometric interpolant's with the topmost modes damped. With the
 * same damping in both the scheme is stable, which it is not without any or in one of them alone:
 * Beale, Hou & Lowengrub 1996, SIAM J. Numer. Anal. 33, 1797. */
#include "internal.h"
#include "sundials_versions.h"
#include <gsl/gsl_sf_gamma.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_spgmr.h>

enum { LARGEST_SPACE = 100, FEWEST_NODES = 16, MOST_NODES = 512 };
static const double GRADING = 2, RESIDUAL = 1e-15, TOLERANCE = 1e-11;

/* What CVODE advances, y, holds x, y and phi of the nodes, one after the other. */
struct surface {
  int n;
  double *weight;                   /* [n] of the derivative by the nodes' distance */
  double *along_real, *along_imag;  /* [n][n] dzeta_k/(zeta_k - zeta_i), and W' for itself */
  double *psi, *h;                  /* [n] */
  double complex *zeta, *slope, *W; /* [n]; slope: d zeta/d alpha */
  SUNContext context;
  N_Vector b, x;
  SUNLinearSolver gmres;
  struct reference_patch_instant *out;
};

static double complex node(const struct surface *s, const double *y, int i)
{
  return y[i] + I * y[s->n + i];
}

static double complex power(double complex z, int n) { return n == 1 ? z : z * power(z, n - 1); }

/* The derivative by alpha of a periodic function at node i, from differences so that constants
 * cost no digits. */
static double complex derivative(const struct surface *s, const double complex *f, int i)
{
  double complex sum = 0;
  for (int k = 0; k < s->n; k++) sum += s->weight[(i - k + s->n) % s->n] * (f[k] - f[i]);
  return sum;
}

static void place(struct surface *s, const double *y)
{
  const int n = s->n;
  for (int i = 0; i < n; i++) s->zeta[i] = power(node(s, y, i), 4);
  for (int i = 0; i < n; i++) s->slope[i] = derivative(s, s->zeta, i);
  for (int i = 0; i < n; i++)
    for (int k = 0; k < n; k++) {
      double complex c = 0;
      if (k != i) c = s->slope[k] / (s->zeta[k] - s->zeta[i]) + s->weight[(i - k + n) % n];
      s->along_real[i * n + k] = 2 * PI / n * creal(c);
      s->along_imag[i * n + k] = 2 * PI / n * cimag(c);
    }
}

/* sum_k row_k (f_k - f_i) */
static double weighted(const struct surface *s, const double *matrix, const double *f, int i)
{
  const double *row = matrix + (ptrdiff_t)i * s->n;
  double sum = 0;
  for (int k = 0; k < s->n; k++) sum += row[k] * (f[k] - f[i]);
  return sum;
}

/* minus the left side above, plus the mean of psi, which is not determined otherwise */
static int times_matrix(void *surface, N_Vector in, N_Vector result)
{
  const struct surface *s = surface;
  const double *psi = N_VGetArrayPointer(in);
  double *out = N_VGetArrayPointer(result), mean = 0;
  for (int i = 0; i < s->n; i++) mean += psi[i] / s->n;
  for (int i = 0; i < s->n; i++) out[i] = mean - weighted(s, s->along_imag, psi, i);
  return 0;
}

/* psi of the analytic function with the real part phi on the surface, from the last place() */
static int conjugate(struct surface *s, const double *phi)
{
  double *b = N_VGetArrayPointer(s->b), size = 0;
  for (int i = 0; i < s->n; i++) {
    b[i] = -weighted(s, s->along_real, phi, i);
    size += sq(b[i]);
  }
  N_VConst(0, s->x);
  if (size > 0 && SUNLinSolSolve(s->gmres, NULL, s->x, s->b, RESIDUAL * sqrt(size)) < 0) return -1;
  memcpy(s->psi, N_VGetArrayPointer(s->x), s->n * sizeof *s->psi);
  for (int i = 0; i < s->n; i++) s->W[i] = phi[i] + I * s->psi[i];
  return 0;
}

/* dW/dz at node i */
static double complex gradient(const struct surface *s, const double *y, int i)
{
  return derivative(s, s->W, i) / s->slope[i] * 4 * power(node(s, y, i), 3);
}

static int rate(double t, const double *y, double *dy, void *surface)
{
  struct surface *s = surface;
  const int n = s->n;
  double *phi_rate = dy + 2 * n, mean = 0;
  (void)t;
  place(s, y);
  if (conjugate(s, y + 2 * n)) return -1;
  for (int i = 0; i < n; i++) {
    const double complex z = node(s, y, i), g = gradient(s, y, i), v = conj(g + I * conj(z));
    dy[i] = creal(v);
    dy[n + i] = cimag(v);
    phi_rate[i] = (sq(cabs(g)) + sq(cabs(z))) / 2 + 2 * s->psi[i];
    mean += phi_rate[i] / n;
  }
  for (int i = 0; i < n; i++) phi_rate[i] -= mean;
  return isfinite(mean) ? 0 : 1;
}

/* ---- what is read off ---- */

/* p = r^2/2 - |dW/dz|^2/2 - h with h harmonic; p = 0 on the surface and dW/dz = 0 at the centre,
 * whose pressure therefore is -h(0), by Cauchy's formula. W is overwritten. */
static int centre_pressure(struct surface *s, const double *y, double *p)
{
  double complex above = 0, below = 0;
  for (int i = 0; i < s->n; i++)
    s->h[i] = (sq(cabs(node(s, y, i))) - sq(cabs(gradient(s, y, i)))) / 2;
  if (conjugate(s, s->h)) return -1;
  for (int i = 0; i < s->n; i++) {
    above += s->slope[i] / s->zeta[i] * s->W[i];
    below += s->slope[i] / s->zeta[i];
  }
  *p = -creal(above / below);
  return 0;
}

/* Integrals over the patch as integrals along its surface:
 *   area = 1/2 int x dy - y dx,  R = int r^2 dA = 1/4 int r^2 (x dy - y dx)
 *   C = int x phi_y - y phi_x dA = -int phi d(r^2/2)
 *   L = C - R,  2 E = R - 2 C + int phi dpsi */
static struct reference_patch_invariants invariants(const struct surface *s, const double *y)
{
  double area = 0, R = 0, C = 0, D = 0;
  for (int i = 0; i < s->n; i++) {
    const double phi = creal(s->W[i]), r2 = sq(cabs(node(s, y, i)));
    const double complex step = r2 * s->slope[i] / (4 * s->zeta[i]); /* conj(z) dz/d alpha */
    area += cimag(step) / 2;
    R += r2 * cimag(step) / 4;
    C -= phi * creal(step);
    D += phi * cimag(derivative(s, s->W, i));
  }
  const double sides = 4 * 2 * PI / s->n;
  return (struct reference_patch_invariants){
    .kinetic_energy = sides * (R / 2 - C + D / 2),
    .angular_momentum = sides * (C - R),
    .area = sides * area,
  };
}

/* r at alpha, between nodes, by the trigonometric interpolant of zeta (n even) */
static double distance(const struct surface *s, double alpha)
{
  double complex above = 0;
  double below = 0;
  for (int k = 0; k < s->n; k++) {
    const double c = (k % 2 ? -1 : 1) / tan((alpha - 2 * PI * k / s->n) / 2);
    above += c * s->zeta[k];
    below += c;
  }
  return pow(cabs(above / below), 0.25);
}

/* The least of it, between the neighbours of the nearest node */
static double smallest_distance(const struct surface *s)
{
  int best = 0;
  for (int i = 1; i < s->n; i++)
    if (cabs(s->zeta[i]) < cabs(s->zeta[best])) best = i;
  double low = 2 * PI * (best - 1) / s->n, high = 2 * PI * (best + 1) / s->n;
  while (high - low > 1e-7) {
    const double a = low + 0.38 * (high - low), b = low + 0.62 * (high - low);
    *(distance(s, a) < distance(s, b) ? &high : &low) = distance(s, a) < distance(s, b) ? b : a;
  }
  return distance(s, (low + high) / 2);
}

static int look(int k, const double *y, void *surface)
{
  struct surface *s = surface;
  struct reference_patch_instant *out = s->out + k;
  place(s, y);
  if (conjugate(s, y + 2 * s->n)) return REFERENCE_NOT_CONVERGED;
  out->invariants = invariants(s, y);
  out->r_min.value = smallest_distance(s);
  out->r_tip = cabs(node(s, y, 0));
  if (out->side)
    for (int i = 0; i < s->n; i++) out->side[i] = (struct reference_vec){y[i], y[s->n + i]};
  return centre_pressure(s, y, &out->p_centre.value) ? REFERENCE_NOT_CONVERGED : REFERENCE_OK;
}

/* ---- the whole of it ---- */

static void close_surface(struct surface *s)
{
  if (s->gmres) SUNLinSolFree(s->gmres);
  if (s->x) N_VDestroy(s->x);
  if (s->b) N_VDestroy(s->b);
  if (s->context) SUNContext_Free(&s->context);
  free(s->weight);
  free(s->zeta);
}

static bool open_surface(struct surface *s)
{
  const size_t n = s->n;
  s->weight = calloc(2 * n * n + 3 * n, sizeof *s->weight);
  s->zeta = malloc(3 * n * sizeof *s->zeta);
  if (!s->weight || !s->zeta || REF_CREATE_CONTEXT(&s->context)) return false;
  s->psi = s->weight + n, s->h = s->psi + n, s->along_real = s->h + n;
  s->along_imag = s->along_real + n * n;
  s->slope = s->zeta + n, s->W = s->slope + n;
  for (int d = 0; d < s->n; d++)
    for (int k = 1; k < s->n / 2; k++)
      s->weight[d] -=
        2.0 / s->n * k * exp(-36 * pow(2.0 * k / s->n, 10)) * sin(2 * PI * k * d / s->n);
  s->b = N_VNew_Serial(s->n, s->context);
  s->x = N_VNew_Serial(s->n, s->context);
  if (!s->b || !s->x) return false;
  s->gmres = SUNLinSol_SPGMR(s->x, SUN_PREC_NONE, LARGEST_SPACE, s->context);
  return s->gmres && !SUNLinSolSetATimes(s->gmres, s, times_matrix) &&
         !SUNLinSolInitialize(s->gmres);
}

/* From the side x = 1/2, nodes at its parts I(.; GRADING, GRADING), the incomplete beta function */
static enum reference_status run(int nodes, double tolerance, struct ref_times times,
                                 struct reference_patch_instant *out)
{
  struct surface s = {.n = nodes, .out = out};
  double *y = calloc(3 * (size_t)nodes, sizeof *y);
  enum reference_status status = REFERENCE_NO_MEMORY;
  if (y && open_surface(&s)) {
    for (int i = 0; i < nodes; i++) {
      y[i] = 0.5;
      y[nodes + i] = gsl_sf_beta_inc(GRADING, GRADING, (i + 0.5) / nodes) - 0.5;
    }
    const struct ref_ode ode = {
      .name = "square patch",
      .n = 3 * nodes,
      .relative = tolerance,
      .absolute = tolerance,
      .rate = rate,
      .visit = look,
      .user = &s,
    };
    status = ref_ode_integrate(&ode, y, times);
  }
  close_surface(&s);
  free(y);
  return status == REFERENCE_NO_MEMORY ? ref_fail(status, "square patch: no memory") : status;
}

enum reference_status reference_square_patch_evolution(int nodes, const double *t_omega, int count,
                                                       struct reference_patch_instant *out)
{
  if (nodes % 4 || nodes < FEWEST_NODES || nodes > MOST_NODES || count < 1)
    return ref_fail(
      REFERENCE_BAD_ARGUMENT,
      "square patch: needs %d to %d nodes, a multiple of 4, and a time, not %d and %d",
      FEWEST_NODES, MOST_NODES, nodes, count);
  for (int k = 0; k < count; k++)
    if (!(t_omega[k] >= 0 && t_omega[k] <= 1.2) || (k > 0 && t_omega[k] <= t_omega[k - 1]))
      return ref_fail(REFERENCE_BAD_ARGUMENT,
                      "square patch: needs rising times from 0 to 1.2, not %g", t_omega[k]);
  const struct ref_times times = {t_omega, count};
  struct reference_patch_instant *coarse = calloc(count, sizeof *coarse);
  if (!coarse) return ref_fail(REFERENCE_NO_MEMORY, "square patch: no memory");
  enum reference_status status = run(nodes / 2, 10 * TOLERANCE, times, coarse);
  if (!status) status = run(nodes, TOLERANCE, times, out);
  for (int k = 0; k < count && !status; k++) {
    out[k].p_centre.error = fabs(out[k].p_centre.value - coarse[k].p_centre.value);
    out[k].r_min.error = fabs(out[k].r_min.value - coarse[k].r_min.value);
    if (k == 0) continue; /* differences may vanish in passing */
    out[k].p_centre.error = fmax(out[k].p_centre.error, out[k - 1].p_centre.error);
    out[k].r_min.error = fmax(out[k].r_min.error, out[k - 1].r_min.error);
  }
  free(coarse);
  return status;
}
