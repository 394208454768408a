/* places.h - finding the particle that is nearest to a point, on the host, in constant time: a hash
 * of cells. For the checks of a scene and for analysis; solvers use pair lists (core/neighbours).
 */
#ifndef PLACES_H
#define PLACES_H
#include "../base/status.h"
#include "../sph/sph.h"
#ifdef __cplusplus
extern "C" {
#endif

struct places {
  const vec *x; /* the particles, not owned [n] */
  int n;
  double side; /* of a cell [m] */
  vec period;  /* 0 where open [m] */
  int *head, *next;
  unsigned long long mask;
};

/* Index n particles in cells of `side` [m], which should be near the distances that will be asked
 * for. Particles that are not finite are left out. x must stay until places_free. Errors:
 * ERR_MEMORY. */
status places_make(struct places *places, const vec *x, int n, double side, vec period);

/* The particle nearest to `at`, other than number `except` (-1: none), if it is nearer than `reach`
 * [m]; else -1. *distance (may be NULL) is then its distance, and `reach` when there is none. */
int places_nearest(const struct places *places, vec at, double reach, int except, double *distance);

void places_free(struct places *places);

#ifdef __cplusplus
}
#endif
#endif
