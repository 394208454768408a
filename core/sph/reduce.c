/* The host's scratch for reductions, and the direction of sweeps. */
#include <stdlib.h>

#include "sweep.h"

int sweep_reversed;

/* Where no memory is left, the room that there was does: the sums go on in parts. */
double *reduce_scratch(int chunks, int *room)
{
  enum { FIRST = 64 };
  static double first[FIRST], *grown;
  static int capacity = FIRST;
  if (chunks > capacity) {
    double *more = realloc(grown, sizeof(double) * (size_t)chunks);
    if (more) {
      grown = more;
      capacity = chunks;
    }
  }
  *room = capacity;
  return grown ? grown : first;
}
