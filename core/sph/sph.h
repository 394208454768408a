/* sph.h - the words of the dual dialect: what C17 and CUDA C++20 both read. DIM and REAL come from
 * the variant. */
#ifndef SPH_H
#define SPH_H
#ifdef __cplusplus
#include <cmath>
#else
#include <tgmath.h> /* sqrt(real) is sqrtf in the f32 build */
#undef I            /* of complex.h; here I is a virtual particle */
#endif
#include <stddef.h>
#ifndef DIM
#error "the variant defines DIM (2 or 3)"
#endif
#ifndef REAL
#error "the variant defines REAL (float or double)"
#endif

typedef REAL real;
typedef struct {
  real c[DIM];
} vec;

#ifdef __CUDACC__
#define STAGE __host__ __device__ static __forceinline__
#else
#define STAGE static inline __attribute__((always_inline, unused))
#endif

#define PI ((real)3.14159265358979323846)

STAGE vec zero(void)
{
  vec r;
  for (int d = 0; d < DIM; d++) r.c[d] = 0;
  return r;
}
STAGE vec sub(vec a, vec b)
{
  for (int d = 0; d < DIM; d++) a.c[d] -= b.c[d];
  return a;
}
STAGE vec plus(vec a, vec b)
{
  for (int d = 0; d < DIM; d++) a.c[d] += b.c[d];
  return a;
}
STAGE vec times(real s, vec a)
{
  for (int d = 0; d < DIM; d++) a.c[d] *= s;
  return a;
}
STAGE vec madd(vec a, real s, vec b) /* a + s b */
{
  for (int d = 0; d < DIM; d++) a.c[d] += s * b.c[d];
  return a;
}
STAGE real inner(vec a, vec b)
{
  real s = 0;
  for (int d = 0; d < DIM; d++) s += a.c[d] * b.c[d];
  return s;
}
STAGE real sq(real a) { return a * a; }
STAGE real larger(real a, real b) { return a > b ? a : b; }
STAGE real smaller(real a, real b) { return a < b ? a : b; }
#endif
