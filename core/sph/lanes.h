/* lanes.h - a value per pair: LANES neighbours at a time on the CPU, one on the GPU.
 *
 * An author of stages needs: `lanes` and `vecs` (a real or vec per pair), + - * / on lanes, dot,
 * add, scale, sum(), at_least(), where(). Loads by neighbour are in pairs.h. Lanes past the end of
 * a row are masked in W and gradW, so every term of a pair sum must contain one of them. */
#ifndef LANES_H
#define LANES_H
#include "sph.h"

#ifdef __CUDACC__

typedef real lanes;
typedef vec vecs;
#define LANES 1
#define NO_LANES ((real)0)
#define NO_VECS zero()

STAGE real dot(vec a, vec b) { return inner(a, b); }
STAGE vec add(vec a, vec b) { return plus(a, b); }
STAGE vec scale(real s, vec a) { return times(s, a); }
STAGE real sum(real a) { return a; }
STAGE vec sum(vec a) { return a; }
STAGE real root(real a) { return sqrt(a); }
STAGE real at_least(real a, real low) { return a > low ? a : low; }
STAGE real at_most(real a, real high) { return a < high ? a : high; }
STAGE real positive(real condition, real a) { return condition > 0 ? a : 0; }
STAGE real or_else(real a, real b) { return a > 0 ? a : b; }

#else

#define LANES_BYTES 32
#define LANES ((int)(LANES_BYTES / sizeof(real)))
typedef real lanes __attribute__((vector_size(LANES_BYTES)));
typedef struct {
  lanes c[DIM];
} vecs;
#define NO_LANES ((lanes){0})
#define NO_VECS ((vecs){{{0}}})

/* The integer that is as wide as a real, LANES at a time: what comparisons of lanes give. */
#ifdef REAL_IS_FLOAT
typedef int lane_mask __attribute__((vector_size(LANES_BYTES)));
#define LANE_NUMBERS ((lane_mask){0, 1, 2, 3, 4, 5, 6, 7})
#define EACH_LANE(E) ((lanes){E(0), E(1), E(2), E(3), E(4), E(5), E(6), E(7)})
#define EACH_INDEX(E) ((lane_mask){E(0), E(1), E(2), E(3), E(4), E(5), E(6), E(7)})
#else
typedef long long lane_mask __attribute__((vector_size(LANES_BYTES)));
#define LANE_NUMBERS ((lane_mask){0, 1, 2, 3})
#define EACH_LANE(E) ((lanes){E(0), E(1), E(2), E(3)})
#define EACH_INDEX(E) ((lane_mask){E(0), E(1), E(2), E(3)})
#endif

STAGE lanes mask_lanes(lane_mask mask, lanes a) { return (lanes)(mask & (lane_mask)a); }
STAGE lanes at_least(lanes a, real low)
{
  const lane_mask more = a > low;
  return (lanes)((more & (lane_mask)a) | (~more & (lane_mask)(low + NO_LANES)));
}
STAGE lanes at_most(lanes a, real high)
{
  const lane_mask less = a < high;
  return (lanes)((less & (lane_mask)a) | (~less & (lane_mask)(high + NO_LANES)));
}
/* a where condition > 0, else 0 */
STAGE lanes positive(lanes condition, lanes a) { return mask_lanes(condition > 0, a); }

/* a where a > 0, else b */
STAGE lanes or_else(lanes a, real b)
{
  const lane_mask more = a > 0;
  return (lanes)((more & (lane_mask)a) | (~more & (lane_mask)(b + NO_LANES)));
}

STAGE lanes root(lanes a)
{
  for (int l = 0; l < LANES; l++) a[l] = sqrt(a[l]);
  return a;
}
STAGE lanes dot(vecs a, vecs b)
{
  lanes s = a.c[0] * b.c[0];
  for (int d = 1; d < DIM; d++) s += a.c[d] * b.c[d];
  return s;
}
STAGE vecs add(vecs a, vecs b)
{
  for (int d = 0; d < DIM; d++) a.c[d] += b.c[d];
  return a;
}
STAGE vecs scale(lanes s, vecs a)
{
  for (int d = 0; d < DIM; d++) a.c[d] *= s;
  return a;
}
/* Over the lanes, as a fixed tree: the same bits everywhere. */
STAGE real sum_lanes(lanes a)
{
#ifdef REAL_IS_FLOAT
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
#else
  return (a[0] + a[2]) + (a[1] + a[3]);
#endif
}
STAGE vec sum_vecs(vecs a)
{
  vec r;
  for (int d = 0; d < DIM; d++) r.c[d] = sum_lanes(a.c[d]);
  return r;
}
#define sum(a) _Generic((a), lanes : sum_lanes, vecs : sum_vecs)(a)

#endif
#endif
