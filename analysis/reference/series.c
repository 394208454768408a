/* Sums, integrals and messages that the other files of this library share. */
#include "internal.h"
#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_zeta.h>
#include <stdarg.h>
#include <stdio.h>

static _Thread_local char message[512];

const char *reference_error(void) { return message; }

enum reference_status ref_fail(enum reference_status status, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  return status;
}

double ref_integrate(const gsl_function *f, struct ref_range range)
{
  const double length = range.to - range.from;
  const int panels = 1 + (int)(fabs(length) / range.panel);
  double total = 0;
  for (int k = 0; k < panels; k++) {
    const double a = range.from + length * k / panels;
    const double b = k + 1 == panels ? range.to : range.from + length * (k + 1) / panels;
    double part, error, magnitude, spread;
    gsl_integration_qk61(f, a, b, &part, &error, &magnitude, &spread);
    total += part;
  }
  return total;
}

double ref_invert_integral(const struct ref_inverse *f, double target)
{
  double x = f->start;
  double last = INFINITY;
  for (int k = 0; k < 100; k++) {
    const double value = ref_integrate(&f->slope, (struct ref_range){0, x, f->panel});
    const double step = (target - value) / f->slope.function(x, f->slope.params);
    /* Near the root the steps shrink quadratically; once they stop shrinking they are rounding. */
    const bool rounding = fabs(step) <= 1e-13 * fabs(x) && fabs(step) >= last;
    if (step == 0 || rounding) break;
    x += step;
    last = fabs(step);
  }
  return x;
}

/* Lerch's expansion (Erdelyi et al. 1953, Higher Transcendental Functions, 1.11), |w| < pi, with
 * eta(2m) = sum (-1)^(k+1)/k^2m:
 *   chi_2 = pi^2/8 - w/2 (1 - log(w/2)) + sum_m (-1)^m eta(2m) w (w/pi)^2m/(2m (2m+1))
 *   chi_3 = 7 zeta(3)/8 - pi^2 w/8 + w^2/4 (3/2 - log(w/2))
 *           - sum_m (-1)^m eta(2m) w^2 (w/pi)^2m/(2m (2m+1) (2m+2)) */
static double complex chi_near_one(int s, double complex w)
{
  const double complex logarithm = clog(w / 2);
  double complex head, power;
  if (s == 2) {
    head = PI * PI / 8 - w / 2 * (1 - logarithm);
    power = -w;
  } else {
    head = 0.875 * gsl_sf_zeta_int(3) - PI * PI / 8 * w + w * w / 4 * (1.5 - logarithm);
    power = w * w;
  }
  double complex tail = 0;
  const double complex ratio = (w / PI) * (w / PI);
  for (int m = 1; m <= 60; m++) {
    power *= m == 1 ? ratio : -ratio;
    const double weight = s == 2 ? 2 * m * (2 * m + 1.0) : 2 * m * (2 * m + 1.0) * (2 * m + 2.0);
    const double complex term = power * gsl_sf_eta_int(2 * m) / weight;
    tail += term;
    if (cabs(term) < 1e-18 * cabs(w)) break;
  }
  return head + tail;
}

double complex ref_chi(int s, double complex w)
{
  if (s == 1) return w == 0 ? INFINITY : -0.5 * clog(ctanh(w / 2));
  if (w == 0) return s == 2 ? PI * PI / 8 : 0.875 * gsl_sf_zeta_int(3);
  if (creal(w) <= 1) return chi_near_one(s, w);
  double complex sum = 0;
  for (int n = 1; n * creal(w) < 45; n += 2) sum += cexp(-n * w) / (s == 2 ? sq(n) : sq(n) * n);
  return sum;
}

/* What the mirror images at distance 2 beta add to chi_s(e^-(eta - i theta)). */
static double complex images(int s, struct ref_strip p, int sign)
{
  double complex sum = 0;
  const double first = 2 * p.beta - p.eta;
  for (int n = 1; n * first < 45; n += 2) {
    const double near = exp(-n * first), far = exp(-n * (2 * p.beta + p.eta));
    const double weight = (near - sign * far) / ((1 + exp(-2 * n * p.beta)) * pow(n, s));
    sum += sign * weight * cexp(I * n * p.theta);
  }
  return sum;
}

double complex ref_cosh_series(int s, struct ref_strip strip)
{
  return ref_chi(s, strip.eta - I * strip.theta) + images(s, strip, 1);
}

double complex ref_sinh_series(int s, struct ref_strip strip)
{
  return ref_chi(s, strip.eta - I * strip.theta) + images(s, strip, -1);
}
