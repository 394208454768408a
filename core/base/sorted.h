/* sorted.h - numbers in rising order. */
#ifndef SORTED_H
#define SORTED_H
#include <stdlib.h>

static inline int ascending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* values [n], none of them NaN, rise afterwards. */
static inline void sort_numbers(double *values, int n)
{
  qsort(values, (size_t)n, sizeof *values, ascending);
}
#endif
