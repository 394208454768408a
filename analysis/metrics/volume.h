/* volume.h - the volume that a cloud of particles occupies, gaps between them included. */
#ifndef VOLUME_H
#define VOLUME_H
#include "../../core/sph/sph.h"

/* A cloud in its domain; particles outside low .. high or at no finite place do not count. */
struct cloud {
  const vec *x; /* [n] m */
  int n;
  double dx;             /* particle spacing [m] */
  vec low, high, period; /* m; period 0 where open */
};

/* Volume [m^d] of the points within 1.5 dx of a particle that are at least dx away from any point
 * which is not: the morphological closing of the cloud with balls of 1.5 dx, half a spacing wider
 * (Serra 1982). On nodes dx/4 apart (3-D: dx/2; wider apart for clouds that are spread very thin),
 * with distances to sub-node precision. NaN when the cloud is spread so thin that nodes dx apart
 * would be too many, or without memory. */
double occupied_volume(const struct cloud *cloud);
#endif
