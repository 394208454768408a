/* kernels.h - smoothing kernels with support radius R, normalised in 1-D, 2-D and 3-D.
 *   cubic spline   Monaghan 1992, h = R/2
 *   spiky          Desbrun & Gascuel 1996; Mueller et al. 2003
 *   Wendland C2/C4 Wendland 1995; Dehnen & Aly 2012
 * All are written in u = 1 - r/R, so that every one of them vanishes at u = 0. */
#ifndef KERNELS_H
#define KERNELS_H
#include "sph.h"

enum kernel_kind { KERNEL_CUBIC, KERNEL_SPIKY, KERNEL_WENDLAND2, KERNEL_WENDLAND4, NUM_KERNELS };
#define KERNEL_CHOICES "cubic|spiky|wendland2|wendland4"

struct kernel {
  int kind;      /* enum kernel_kind */
  real R, inv_R; /* support radius [m] and its inverse */
  real w, dw;    /* W = w f(u) [1/m^d],  dW/dr = -dw g(u) [1/m^(d+1)] */
};

/* The kernel of `kind` with support R [m] in `dim` dimensions (1, 2 or 3). */
STAGE struct kernel kernel_make(int kind, real R, int dim)
{
  /* norms of f over the unit ball; rows: cubic, spiky, wendland2, wendland4; f as in kernel_f */
  const double pi = 3.14159265358979323846;
  const double norm[NUM_KERNELS][3] = {
    {8.0 / 3, 80 / (7 * pi), 16 / pi},
    {2.0, 10 / pi, 15 / pi},
    {5.0 / 4, 7 / pi, 21 / (2 * pi)},
    {3.0 / 2, 9 / pi, 495 / (32 * pi)},
  };
  double volume = 1;
  for (int d = 0; d < dim; d++) volume *= (double)R;
  struct kernel k;
  k.kind = kind;
  k.R = R;
  k.inv_R = 1 / R;
  k.w = (real)(norm[kind][dim - 1] / volume);
  k.dw = (real)(norm[kind][dim - 1] / volume / (double)R);
  return k;
}

/* f(u): W = w f(u). Wendland in 1-D is another polynomial: (1-q)^3 (1+3q) and (1-q)^5 (1+5q+8q^2).
 */
STAGE real kernel_W(const struct kernel *k, real r, int dim)
{
  const real u = 1 - r * k->inv_R, q = 1 - u;
  if (u <= 0) return 0;
  const real v = larger(u - (real)0.5, 0);
  switch (k->kind) {
  case KERNEL_CUBIC: return k->w * (u * u * u - 4 * v * v * v);
  case KERNEL_SPIKY: return k->w * (u * u * u);
  case KERNEL_WENDLAND2:
    return k->w * (dim == 1 ? u * u * u * (1 + 3 * q) : sq(sq(u)) * (1 + 4 * q));
  default:
    return k->w * (dim == 1 ? sq(sq(u)) * u * (1 + 5 * q + 8 * q * q)
                            : sq(sq(u)) * sq(u) * (1 + 6 * q + (real)35 / 3 * q * q));
  }
}

/* dW/dr <= 0 */
STAGE real kernel_dW(const struct kernel *k, real r, int dim)
{
  const real u = 1 - r * k->inv_R, q = 1 - u;
  if (u <= 0) return 0;
  const real v = larger(u - (real)0.5, 0);
  switch (k->kind) {
  case KERNEL_CUBIC: return -k->dw * (3 * u * u - 12 * v * v);
  case KERNEL_SPIKY: return -k->dw * (3 * u * u);
  case KERNEL_WENDLAND2: return -k->dw * (dim == 1 ? 12 * q * u * u : 20 * q * u * u * u);
  default:
    return -k->dw * (dim == 1 ? 14 * q * sq(sq(u)) * (1 + 4 * q)
                              : (real)56 / 3 * q * sq(sq(u)) * u * (1 + 5 * q));
  }
}
#endif
