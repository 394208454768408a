#include "ceilings.h"

#include <omp.h>
#include <stdlib.h>

#include "../base/clock.h"
#include "../sph/lanes.h"

enum { CHAINS = 12, REPEATS = 5, TRIAD = 1 << 24 }; /* three arrays of 128 MB */

/* a = b + s c; counts the two reads and the write (not the write-allocate). */
static double triad_bandwidth(void)
{
  double *a = malloc(sizeof(double) * TRIAD), *b = malloc(sizeof(double) * TRIAD),
         *c = malloc(sizeof(double) * TRIAD);
  double best = 0;
  if (a && b && c) {
#pragma omp parallel for schedule(static)
    for (int i = 0; i < TRIAD; i++) {
      a[i] = 0;
      b[i] = i;
      c[i] = 1;
    }
    for (int k = 0; k < REPEATS; k++) {
      const double begun = clock_now();
#pragma omp parallel for schedule(static)
      for (int i = 0; i < TRIAD; i++) a[i] = b[i] + 3 * c[i];
      const double rate = 3.0 * sizeof(double) * TRIAD / (clock_now() - begun);
      if (rate > best) best = rate;
    }
  }
  free(a);
  free(b);
  free(c);
  return best;
}

/* Independent chains of multiply-adds in registers. */
static real chains(long rounds)
{
  lanes x[CHAINS];
  for (int k = 0; k < CHAINS; k++) x[k] = (real)k + NO_LANES;
  const lanes factor = (real)0.999999 + NO_LANES, term = (real)1e-6 + NO_LANES;
  for (long n = 0; n < rounds; n++)
    for (int k = 0; k < CHAINS; k++) x[k] = x[k] * factor + term;
  lanes total = NO_LANES;
  for (int k = 0; k < CHAINS; k++) total += x[k];
  return sum(total);
}

static double peak_flops(void)
{
  const long rounds = 4000000;
  double best = 0;
  for (int k = 0; k < REPEATS; k++) {
    double check = 0;
    const double begun = clock_now();
#pragma omp parallel reduction(+ : check)
    check += (double)chains(rounds);
    const double work = 2.0 * LANES * CHAINS * (double)rounds * omp_get_max_threads();
    const double rate = work / (clock_now() - begun);
    if (rate > best && check > 0) best = rate;
  }
  return best;
}

struct ceilings ceilings_measure(void)
{
  return (struct ceilings){.bandwidth = triad_bandwidth(), .flops = peak_flops()};
}
