/* lattice.h - what a full square or cubic lattice of spacing dx says about Jacobi iterations and
 * about forces of old velocities. */
#ifndef LATTICE_H
#define LATTICE_H
#include "kernels.h"

/* sum_j |grad W_ij|^2 around a particle of the lattice, where sum_j grad W_ij = 0 [1/m^(2d+2)] */
static inline double lattice_spread(const struct kernel *kernel, double dx)
{
  const int reach = (int)ceil((double)kernel->R / dx), deep = DIM == 3 ? reach : 0;
  double spread = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const double r = dx * sqrt((double)(a * a + b * b + c * c));
        const double slope = r > 0 ? (double)kernel_dW(kernel, (real)r, DIM) : 0;
        spread += slope * slope;
      }
  return spread;
}

/* Sum of W over the lattice's row (2-D) or plane (3-D) at k dx from a point of it [1/m^d] */
static inline double lattice_layer(const struct kernel *kernel, double dx, int k)
{
  const int reach = (int)ceil((double)kernel->R / dx), deep = DIM == 3 ? reach : 0;
  double sum = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -deep; b <= deep; b++)
      sum += (double)kernel_W(kernel, (real)(dx * sqrt((double)(a * a + b * b + k * k))), DIM);
  return sum;
}

/* One mode exp(i k.x), k = angle/dx [DIM], of the pressure operator of DFSPH and PBF,
 *   A p_i = sum_j (a_i - a_j).grad W_ij,   a_i = sum_j (p_i + p_j) grad W_ij:
 * its eigenvalue over A's diagonal, |sum_j sin(k.x_ij) grad W_ij|^2 / sum_j |grad W_ij|^2. */
static inline double lattice_mode(const struct kernel *kernel, double dx, const double angle[DIM])
{
  const int reach = (int)ceil((double)kernel->R / dx), deep = DIM == 3 ? reach : 0;
  double wave[3] = {0, 0, 0}, diagonal = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const double at[3] = {(double)a, (double)b, (double)c};
        const double r = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        if (r > 0) {
          const double slope = (double)kernel_dW(kernel, (real)(dx * r), DIM);
          double phase = 0;
          for (int d = 0; d < DIM; d++) phase += angle[d] * at[d];
          for (int d = 0; d < DIM; d++) wave[d] += sin(phase) * slope * at[d] / r;
          diagonal += slope * slope;
        }
      }
  return diagonal > 0 ? (wave[0] * wave[0] + wave[1] * wave[1] + wave[2] * wave[2]) / diagonal : 0;
}

/* The largest eigenvalue theta_max of that A over its diagonal: a Jacobi iteration on it converges
 * for a relaxation below 2/theta_max. Searched along the axis and the diagonals, where the maxima
 * lie (compared with power iterations on periodic lattices for all kernels, R = 1.2 .. 3 dx). */
static inline double lattice_stiffest(const struct kernel *kernel, double dx)
{
  const int steps = 32;
  double largest = 0;
  for (int axes = 1; axes <= DIM; axes++)
    for (int k = 1; k < steps; k++) {
      double angle[3] = {0, 0, 0};
      for (int d = 0; d < axes; d++) angle[d] = (double)PI * k / steps;
      const double mode = lattice_mode(kernel, dx, angle);
      if (mode > largest) largest = mode;
    }
  return largest;
}

/* One mode exp(i k.x), k = angle/dx [DIM] along an axis or a diagonal, of
 *   L v_i = 2 sum_j |W'_ij|/r_ij (v_i - v_j)               if full
 *         = 2 (d+2) sum_j |W'_ij|/r_ij e e.(v_i - v_j)     if not:
 * its largest eigenvalue [1/m^(d+2)], that of motion along k. */
static inline double lattice_friction(const struct kernel *kernel, double dx,
                                      const double angle[DIM], int full)
{
  const int reach = (int)ceil((double)kernel->R / dx), deep = DIM == 3 ? reach : 0;
  double all = 0, along = 0, k2 = 0;
  for (int d = 0; d < DIM; d++) k2 += angle[d] * angle[d];
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const double at[3] = {(double)a, (double)b, (double)c};
        const double r2 = at[0] * at[0] + at[1] * at[1] + at[2] * at[2], r = sqrt(r2);
        if (r2 > 0) {
          double phase = 0;
          for (int d = 0; d < DIM; d++) phase += angle[d] * at[d];
          const double slope = (double)kernel_dW(kernel, (real)(dx * r), DIM);
          const double pull = -2 * slope / (dx * r) * (1 - cos(phase));
          all += pull;
          along += pull * phase * phase / (k2 * r2);
        }
      }
  return full ? all : (DIM + 2) * along;
}

/* The largest of these: forces nu V L v of old velocities, V the volume of a particle, are stable
 * up to dt = 2/(nu V) over it. */
static inline double lattice_most_friction(const struct kernel *kernel, double dx, int full)
{
  const int steps = 32;
  double largest = 0;
  for (int axes = 1; axes <= DIM; axes++)
    for (int k = 1; k <= steps; k++) {
      double angle[3] = {0, 0, 0};
      for (int d = 0; d < axes; d++) angle[d] = (double)PI * k / steps;
      const double mode = lattice_friction(kernel, dx, angle, full);
      if (mode > largest) largest = mode;
    }
  return largest;
}
#endif
