/* The kernels' constants by GSL's Gauss-Kronrod rule: W integrates to 1 over its support, -W' back
 * to W(0), and (the gradient's consistency) -r W' to the number of dimensions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "../../core/sph/kernels.h"

#ifdef SPHBENCH_HAVE_REFERENCE
#include <gsl/gsl_integration.h>

#define ROUNDING (sizeof(real) == 4 ? 2e-6 : 1e-13)

enum what { VALUE, SLOPE, MOMENT };
struct integrand {
  struct kernel kernel;
  int dim;
  enum what what;
};

/* f(r) times the surface of a ball of radius r, or -W' alone */
static double at(double r, void *p)
{
  const struct integrand *f = p;
  const double pi = 3.14159265358979323846;
  const double shell = f->dim == 1 ? 2 : f->dim == 2 ? 2 * pi * r : 4 * pi * r * r;
  const double slope = (double)kernel_dW(&f->kernel, (real)r, f->dim);
  if (f->what == SLOPE) return -slope;
  return shell * (f->what == VALUE ? (double)kernel_W(&f->kernel, (real)r, f->dim) : -r * slope);
}

/* Polynomials on both sides of the spline's knot at R/2, which 61 points integrate exactly */
static double integral(const struct integrand *f)
{
  const double R = (double)f->kernel.R;
  gsl_function function = {at, (void *)f};
  double near, far, error, magnitude, spread;
  gsl_integration_qk61(&function, 0, R / 2, &near, &error, &magnitude, &spread);
  gsl_integration_qk61(&function, R / 2, R, &far, &error, &magnitude, &spread);
  return near + far;
}

static void kernels_have_their_norms(void **unused)
{
  (void)unused;
  for (int kind = 0; kind < NUM_KERNELS; kind++)
    for (int dim = 1; dim <= 3; dim++) {
      struct integrand f = {kernel_make(kind, (real)0.75, dim), dim, VALUE};
      const double one = integral(&f), top = (double)kernel_W(&f.kernel, 0, dim);
      f.what = SLOPE;
      const double fall = integral(&f);
      f.what = MOMENT;
      const double d = integral(&f);
      print_message("kernel %d, %d-D: off by %.1e, %.1e, %.1e\n", kind, dim, one - 1,
                    fall / top - 1, d / dim - 1);
      assert_true(fabs(one - 1) < ROUNDING);
      assert_true(fabs(fall / top - 1) < ROUNDING);
      assert_true(fabs(d / dim - 1) < ROUNDING);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(kernels_have_their_norms)};
  return cmocka_run_group_tests_name("kernel norms " SPHBENCH_VARIANT, tests, NULL, NULL);
}
#else
int main(void)
{
  puts("The kernels' norms were not integrated: no GSL (libgsl-dev).");
  return 77;
}
#endif
