/* The host's scratch for reductions, and the direction of sweeps. */
#include <stdlib.h>

#include "sweep.h"

int sweep_reversed;

double *reduce_scratch(int chunks)
{
  static double *scratch;
  static int capacity;
  if (chunks > capacity) {
    double *grown = realloc(scratch, sizeof(double) * (size_t)chunks);
    if (!grown) return scratch; /* 8 kB per million particles: the run itself failed long before */
    scratch = grown;
    capacity = chunks;
  }
  return scratch;
}
