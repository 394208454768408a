/* internal.h - what the files of this library share. */
#ifndef REFERENCE_INTERNAL_H
#define REFERENCE_INTERNAL_H
#include "reference.h"
#include <complex.h>
#include <gsl/gsl_math.h>
#include <math.h>

#define PI 3.14159265358979323846
#define SQRT2 1.41421356237309504880

static inline double sq(double x) { return x * x; }

/* Records the sentence (as printf) that reference_error() will return, and hands status back. */
enum reference_status ref_fail(enum reference_status status, const char *format, ...)
#ifdef __GNUC__
  __attribute__((format(printf, 2, 3)))
#endif
  ;

/* y' = rate(y), n unknowns, by CVODE's Adams method from t = 0 to times of one sign, rising in
 * magnitude; visit gets y at the k-th and a status other than REFERENCE_OK ends the work. rate
 * returns 0, or > 0 where the step must be smaller, < 0 where nothing helps. */
struct ref_ode {
  const char *name; /* for the message */
  int n;
  double relative, absolute; /* tolerances of the step's error */
  int (*rate)(double t, const double *y, double *dy, void *user);
  int (*visit)(int k, const double *y, void *user);
  void *user;
};
struct ref_times {
  const double *t;
  int count;
};
enum reference_status ref_ode_integrate(const struct ref_ode *ode, const double *start,
                                        struct ref_times times);

/* Integral of f over [from, to], Gauss-Kronrod (61 points) on equal panels no longer than `panel`.
 * For analytic f with `panel` below its distance to the nearest singularity the error is rounding.
 */
struct ref_range {
  double from, to, panel;
};
double ref_integrate(const gsl_function *f, struct ref_range range);

/* Root of f(x) = target, where f is an integral from 0 with the integrand `slope` > 0: Newton from
 * start. Converges from the side where f is convex towards the root. */
struct ref_inverse {
  gsl_function slope;
  double panel, start;
};
double ref_invert_integral(const struct ref_inverse *f, double target);

/* sum over odd n of e^{-n w}/n^s (Legendre's chi function), Re w >= 0, |Im w| <= pi/2, s = 1, 2, 3.
 * Infinite for s = 1, w = 0. */
double complex ref_chi(int s, double complex w);

/* Sums over odd n of e^{i n theta} C_n/n^s, 0 <= eta <= beta, |theta| <= pi/2:
 * cosh: C_n = cosh(n(beta - eta))/cosh(n beta), sinh: C_n = sinh(n(beta - eta))/cosh(n beta).
 * These are the harmonic functions of a rectangle. No term overflows. */
struct ref_strip {
  double eta, theta, beta;
};
double complex ref_cosh_series(int s, struct ref_strip strip);
double complex ref_sinh_series(int s, struct ref_strip strip);
#endif
