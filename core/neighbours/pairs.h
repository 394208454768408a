/* pairs.h - walking the pairs of a particle. A pair list from set A to set B is CSR whose rows
 * start at multiples of LANES; the slots past a row's end hold valid indices and are masked in W
 * and gradW. A set paired with itself lists i itself too (r = 0), as the sums in the papers do. */
#ifndef PAIRS_H
#define PAIRS_H
#include "../sph/kernels.h"
#include "../sph/lanes.h"
#if defined(__AVX2__) && !defined(__CUDACC__)
#include <immintrin.h>
#endif

struct pairs {
  const int *first,
    *last;         /* row i of A: slots first[i] .. last[i]-1                     [rows], [rows] */
  const int *list; /* index in B                                                  [slots] */
  const vec *xi, *xj; /* positions of A and of B                                     [m] */
  struct kernel kernel;
  vec period;   /* side of a periodic domain, 0 where it is open               [m] */
  int periodic; /* is any side periodic? */
  int rows, slots;
  long *visits; /* pairs visited so far, by row; NULL: nobody counts                   [rows] */
};

/* A packet of up to LANES pairs (i, j). */
struct packet {
  int i, k, left;
  const int *j;
  vecs x;  /* x_i - x_j */
  lanes r; /* |x_i - x_j| */
};

#ifdef __CUDACC__

STAGE real of(const real *a, const packet &ij) { return a[*ij.j]; }
STAGE vec of(const vec *a, const packet &ij) { return a[*ij.j]; }
STAGE vec difference(vec a, vec b) { return sub(a, b); }
STAGE real only(const packet &ij, real a)
{
  (void)ij;
  return a;
}
STAGE real only_below(const packet &ij, int n, real a) { return *ij.j < n ? a : 0; }
STAGE real nearest_image(real x, real period) { return x - period * rint(x / period); }
STAGE void keep(real *a, const packet &ij, real value) { a[ij.k] = value; }
STAGE real kept(const real *a, const packet &ij) { return a[ij.k]; }

#else

STAGE lanes of_real(const real *a, struct packet ij)
{
#define ONE(l) a[ij.j[l]]
  return EACH_LANE(ONE);
#undef ONE
}

/* The transpose of LANES consecutive vec; 3-D reads one real past each vec: arrays have a spare
 * element at their end. */
STAGE vecs of_vec(const vec *a, struct packet ij)
{
  const int *j = ij.j;
  vecs r;
#if defined(__AVX2__) && DIM == 3 && defined(REAL_IS_FLOAT)
#define F4(l) _mm_loadu_ps((const float *)&a[j[l]])
#define F8(l) _mm256_insertf128_ps(_mm256_castps128_ps256(F4(l)), F4(l + 4), 1)
  const __m256 a0 = F8(0), a1 = F8(1), a2 = F8(2), a3 = F8(3);
  const __m256 b0 = _mm256_unpacklo_ps(a0, a1), b1 = _mm256_unpackhi_ps(a0, a1);
  const __m256 b2 = _mm256_unpacklo_ps(a2, a3), b3 = _mm256_unpackhi_ps(a2, a3);
  r.c[0] = (lanes)_mm256_shuffle_ps(b0, b2, 0x44);
  r.c[1] = (lanes)_mm256_shuffle_ps(b0, b2, 0xEE);
  r.c[2] = (lanes)_mm256_shuffle_ps(b1, b3, 0x44);
#undef F4
#undef F8
#elif defined(__AVX2__) && DIM == 3
#define D4(l) _mm256_loadu_pd((const double *)&a[j[l]])
  const __m256d a0 = D4(0), a1 = D4(1), a2 = D4(2), a3 = D4(3);
  const __m256d b0 = _mm256_unpacklo_pd(a0, a1), b1 = _mm256_unpackhi_pd(a0, a1);
  const __m256d b2 = _mm256_unpacklo_pd(a2, a3), b3 = _mm256_unpackhi_pd(a2, a3);
  r.c[0] = (lanes)_mm256_permute2f128_pd(b0, b2, 0x20);
  r.c[1] = (lanes)_mm256_permute2f128_pd(b1, b3, 0x20);
  r.c[2] = (lanes)_mm256_permute2f128_pd(b0, b2, 0x31);
#undef D4
#else
#define ONE(l) a[j[l]].c[d]
  for (int d = 0; d < DIM; d++) r.c[d] = EACH_LANE(ONE);
#undef ONE
#endif
  return r;
}
#define of(a, ij) _Generic(*(a), real : of_real, vec : of_vec)(a, ij)

STAGE vecs difference(vec a, vecs b)
{
  for (int d = 0; d < DIM; d++) b.c[d] = a.c[d] - b.c[d];
  return b;
}
/* a in the lanes that hold a pair, 0 in the others */
STAGE lanes only(struct packet ij, lanes a) { return mask_lanes(LANE_NUMBERS < ij.left, a); }
/* a in the lanes whose neighbour's index is below n (n = p.n: fluid, not wall), 0 in the others */
STAGE lanes only_below(struct packet ij, int n, lanes a)
{
#define ONE(l) ij.j[l]
  const lane_mask j = EACH_INDEX(ONE);
#undef ONE
  return mask_lanes(j < n, a);
}

STAGE lanes nearest_image(lanes x, real period)
{
  for (int l = 0; l < LANES; l++) x[l] -= period * rint(x[l] / period);
  return x;
}
/* One real per slot of a pair list: written whole packets at a time, since rows start at multiples
 * of LANES. */
STAGE void keep(real *a, struct packet ij, lanes value) { *(lanes *)(a + ij.k) = value; }
STAGE lanes kept(const real *a, struct packet ij) { return *(const lanes *)(a + ij.k); }

#endif

/* a_i - a_j of a set paired with itself */
#define diff(a, ij) difference((a)[(ij).i], of(a, ij))

STAGE struct packet packet_first(const struct pairs *list, int i)
{
  struct packet ij;
  ij.i = i;
  ij.k = list->first[i];
  ij.left = 0;
  ij.j = list->list;
  ij.x = NO_VECS;
  ij.r = NO_LANES;
  if (list->visits) list->visits[i] += list->last[i] - list->first[i];
  return ij;
}
STAGE int packet_get(const struct pairs *list, struct packet *ij)
{
  ij->left = list->last[ij->i] - ij->k;
  if (ij->left <= 0) return 0;
  ij->j = list->list + ij->k;
  ij->x = difference(list->xi[ij->i], of(list->xj, *ij));
  if (list->periodic)
    for (int d = 0; d < DIM; d++)
      if (list->period.c[d] > 0) ij->x.c[d] = nearest_image(ij->x.c[d], list->period.c[d]);
  ij->r = root(dot(ij->x, ij->x));
  return 1;
}
/* The row's slots without positions: for sums over kept coefficients. */
STAGE int packet_get_bare(const struct pairs *list, struct packet *ij)
{
  ij->left = list->last[ij->i] - ij->k;
  ij->j = list->list + ij->k;
  return ij->left > 0;
}

#define for_pairs(pairs, i, ij) \
  for (struct packet ij = packet_first(pairs, i); packet_get(pairs, &ij); ij.k += LANES)
#define for_slots(pairs, i, ij) \
  for (struct packet ij = packet_first(pairs, i); packet_get_bare(pairs, &ij); ij.k += LANES)
/* the neighbours of a particle in the list that the runner keeps in every state */
#define for_neighbours(s, i, ij) for_pairs (&(s)->nb, i, ij)

/* W(r_ij) */
STAGE lanes W(const struct pairs *nb, struct packet ij)
{
  const struct kernel k = nb->kernel;
  const lanes u = at_least(1 - ij.r * k.inv_R, 0), u2 = u * u;
  lanes f;
  switch (k.kind) {
  case KERNEL_CUBIC: {
    const lanes v = at_least(u - (real)0.5, 0);
    f = u2 * u - 4 * v * v * v;
    break;
  }
  case KERNEL_SPIKY: f = u2 * u; break;
  case KERNEL_WENDLAND2: f = u2 * u2 * (5 - 4 * u); break;
  default: f = u2 * u2 * u2 * ((real)56 / 3 + u * ((real)-88 / 3 + (real)35 / 3 * u));
  }
  return only(ij, k.w * f);
}

/* -dW/dr (r_ij) >= 0 */
STAGE lanes slope(const struct pairs *nb, struct packet ij)
{
  const struct kernel k = nb->kernel;
  const lanes u = at_least(1 - ij.r * k.inv_R, 0), u2 = u * u;
  lanes g;
  switch (k.kind) {
  case KERNEL_CUBIC: {
    const lanes v = at_least(u - (real)0.5, 0);
    g = 3 * u2 - 12 * v * v;
    break;
  }
  case KERNEL_SPIKY: g = 3 * u2; break;
  case KERNEL_WENDLAND2: g = 20 * (1 - u) * u2 * u; break;
  default: g = (real)56 / 3 * (1 - u) * u2 * u2 * u * (6 - 5 * u);
  }
  return only(ij, k.dw * g);
}

/* -dW/dr / r: bounded for the smooth kernels; where r = 0 the factor x_ij = 0 wins */
STAGE lanes slope_over_r(const struct pairs *nb, struct packet ij)
{
  const struct kernel k = nb->kernel;
  if (k.kind == KERNEL_WENDLAND2) {
    const lanes u = at_least(1 - ij.r * k.inv_R, 0);
    return only(ij, 20 * k.dw * k.inv_R * (u * u * u));
  }
  return slope(nb, ij) / at_least(ij.r, (real)1e-6 * k.R);
}

/* grad_i W(x_i - x_j) */
STAGE vecs gradW(const struct pairs *nb, struct packet ij)
{
  return scale(-slope_over_r(nb, ij), ij.x);
}
#endif
