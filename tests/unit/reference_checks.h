/* What the tests of the reference solutions share. */
#ifndef REFERENCE_CHECKS_H
#define REFERENCE_CHECKS_H
#include "../../analysis/reference/reference.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))
#define PI 3.14159265358979323846

/* NaN never passes. */
static inline void close_to(const char *what, double got, double want, double tolerance)
{
  if (!(fabs(got - want) <= tolerance))
    fail_msg("%s: %.17g, not %.17g: off by %.3g, allowed %.3g", what, got, want, got - want,
             tolerance);
}

static inline double sq(double x) { return x * x; }

/* Derivative by fourth-order central differences of step h. */
static inline double derivative(double (*f)(double), double t, double h)
{
  return (8 * (f(t + h) - f(t - h)) - f(t + 2 * h) + f(t - 2 * h)) / (12 * h);
}

/* Midpoint rule, n points: for smooth functions that vanish or are even at the ends. */
static inline double midpoint(double (*f)(double), double from, double to, int n)
{
  double sum = 0;
  for (int i = 0; i < n; i++) sum += f(from + (to - from) * (i + 0.5) / n);
  return sum * (to - from) / n;
}
#endif
