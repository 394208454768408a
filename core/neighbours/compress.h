/* compress.h - keep some lanes and close the gaps: what turns LANES distance tests into list
 * entries.
 *
 * `bits` has one bit per lane. Up to LANES elements are written at `to`, of which the first (number
 * of bits) count. */
#ifndef COMPRESS_H
#define COMPRESS_H
#include <string.h>
#include "pairs.h"

/* LANES reals or ints anywhere in memory */
typedef real loose_lanes
  __attribute__((vector_size(LANES_BYTES), aligned(sizeof(real)), may_alias));
typedef int index_lanes __attribute__((vector_size(LANES_BYTES / sizeof(real) * sizeof(int))));
typedef int loose_index_lanes
  __attribute__((vector_size(LANES_BYTES / sizeof(real) * sizeof(int)), aligned(4), may_alias));
#ifdef REAL_IS_FLOAT
#define INDEX_NUMBERS ((index_lanes){0, 1, 2, 3, 4, 5, 6, 7})
#else
#define INDEX_NUMBERS ((index_lanes){0, 1, 2, 3})
#endif

#if defined(__AVX2__) && !defined(PLAIN_SEARCH)

/* Where each lane comes from, as 8 numbers of 32-bit pieces: bytes, so that all fit in 2 KiB of the
 * first cache. */
struct compressor {
  unsigned char pieces[1 << LANES][8];
#ifndef REAL_IS_FLOAT
  unsigned char lane[1 << LANES][4];
#endif
};

static inline void compressor_init(struct compressor *c)
{
  memset(c, 0, sizeof *c);
  for (int bits = 0; bits < 1 << LANES; bits++)
    for (int lane = 0, to = 0; lane < LANES; lane++) {
      if (!(bits >> lane & 1)) continue;
#ifdef REAL_IS_FLOAT
      c->pieces[bits][to++] = (unsigned char)lane;
#else
      c->pieces[bits][2 * to] = (unsigned char)(2 * lane);
      c->pieces[bits][2 * to + 1] = (unsigned char)(2 * lane + 1);
      c->lane[bits][to++] = (unsigned char)lane;
#endif
    }
}

STAGE __m256i compressor_pieces(const struct compressor *c, int bits)
{
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)c->pieces[bits]));
}

STAGE int number_of(int bits) { return __builtin_popcount((unsigned)bits); }

STAGE void compress_reals(const struct compressor *c, real *to, lanes a, int bits)
{
  const __m256i moved = _mm256_permutevar8x32_epi32((__m256i)a, compressor_pieces(c, bits));
  _mm256_storeu_si256((__m256i *)(void *)to, moved);
}

#ifdef REAL_IS_FLOAT
STAGE int bits_of(lane_mask mask) { return _mm256_movemask_ps((__m256)mask); }
STAGE void compress_ints(const struct compressor *c, int *to, index_lanes a, int bits)
{
  compress_reals(c, (real *)(void *)to, (lanes)a, bits);
}
#else
STAGE int bits_of(lane_mask mask) { return _mm256_movemask_pd((__m256d)mask); }
STAGE void compress_ints(const struct compressor *c, int *to, index_lanes a, int bits)
{
  int bytes;
  memcpy(&bytes, c->lane[bits], sizeof bytes);
  const __m128i from = _mm_cvtepu8_epi32(_mm_cvtsi32_si128(bytes));
  _mm_storeu_ps((float *)(void *)to, _mm_permutevar_ps((__m128)a, from));
}
#endif

#else

struct compressor {
  int unused;
};
static inline void compressor_init(struct compressor *c) { c->unused = 0; }

STAGE int bits_of(lane_mask mask)
{
  int bits = 0;
  for (int l = 0; l < LANES; l++) bits |= (int)(mask[l] & 1) << l;
  return bits;
}
STAGE int number_of(int bits)
{
  int number = 0;
  for (int l = 0; l < LANES; l++) number += bits >> l & 1;
  return number;
}
STAGE void compress_reals(const struct compressor *c, real *to, lanes a, int bits)
{
  (void)c;
  for (int l = 0, n = 0; l < LANES; n += bits >> l & 1, l++) to[n] = a[l];
}
STAGE void compress_ints(const struct compressor *c, int *to, index_lanes a, int bits)
{
  (void)c;
  for (int l = 0, n = 0; l < LANES; n += bits >> l & 1, l++) to[n] = a[l];
}

#endif
#endif
