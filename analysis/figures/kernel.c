/* The cubic spline with its derivatives, and where a particle under tension between two pressure
 * points stands in the region W'' >= 0, in which attraction pulls it away from the middle: with
 * pressures on its neighbours (one kind of particles) and half-way to them (two kinds).
 * Dual-particle paper, Sec. 3.2 and Fig. 5; Swegle et al. 1995, J. Comput. Phys. 116, 123. */
#define DIM 2
#define REAL double
#include "../../core/sph/kernels.h"
#include "program.h"

#define SUPPORT 2.5 /* dx, as in the paper's Sec. 7 */
enum { SAMPLES = 2000 };

/* R^3 W''(r) in 1-D, by central differences of W', which is piecewise quadratic: exact but in the
 * two cells where its pieces meet. */
static double curvature(const struct kernel *k, double r)
{
  const double h = 1e-6;
  return (kernel_dW(k, r + h, 1) - kernel_dW(k, fmax(r - h, 0), 1)) / (h + fmin(r, h));
}

/* Where W'' passes 0 [R]: by halving. */
static double inflection(const struct kernel *k)
{
  double low = 0.1, high = 0.9;
  for (int step = 0; step < 50; step++) {
    const double middle = (low + high) / 2;
    if (curvature(k, middle) < 0)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Between two points `gap` apart [R], the share of places that lie in W'' >= 0 of either. */
static double unstable_share(const struct kernel *k, double gap)
{
  int unstable = 0;
  for (int s = 0; s < SAMPLES; s++) {
    const double from_left = gap * (s + 0.5) / SAMPLES;
    unstable += curvature(k, from_left) >= 0 || curvature(k, gap - from_left) >= 0;
  }
  return (double)unstable / SAMPLES;
}

/* sum_J W''(x - x_J) over points at (offset + k) dx, but for x itself: above 0, attraction by equal
 * pressures of all of them drives a particle at 0 away. In units of 1/R^3. */
static double stiffness(const struct kernel *k, double offset)
{
  double sum = 0;
  for (int j = -4; j <= 4; j++) {
    const double r = fabs(offset + j) / SUPPORT;
    if (r > 0) sum += curvature(k, r);
  }
  return sum;
}

static status write_curves(struct program *p, const struct kernel *k)
{
  FILE *out = program_data(p, "kernel", "", "r/R | W R | W' R^2 | W'' R^3 | unstable");
  if (!out) return ERR_IO;
  for (int s = -SAMPLES / 4; s <= SAMPLES / 4; s++) {
    const double r = 4. * s / SAMPLES, size = fabs(r);
    fprintf(out, "%.8g %.8g %.8g %.8g %d\n", r, kernel_W(k, size, 1),
            kernel_dW(k, size, 1) * (r < 0 ? -1 : 1), curvature(k, size), curvature(k, size) >= 0);
  }
  fclose(out);
  return OK;
}

/* Of the two points that pull a particle between them, the net force over its place. */
static status write_force(struct program *p, const struct kernel *k, const char *name, double gap)
{
  FILE *out = program_data(p, name, "", "x/dx | net pull of the two points R^2");
  if (!out) return ERR_IO;
  for (int s = 0; s <= 200; s++) {
    const double x = gap * (s / 200. - 0.5) * 0.98;
    /* each pulls towards itself with |W'| */
    const double right = -kernel_dW(k, gap / 2 - x, 1), left = -kernel_dW(k, gap / 2 + x, 1);
    fprintf(out, "%.8g %.8g\n", x * SUPPORT, right - left);
  }
  fclose(out);
  return OK;
}

static status write_all(struct program *p)
{
  const struct kernel k = kernel_make(KERNEL_CUBIC, 1, 1);
  const double dx = 1 / SUPPORT;
  TRY(write_curves(p, &k));
  TRY(write_force(p, &k, "one-particle", 2 * dx));
  TRY(write_force(p, &k, "dual-particle", dx));
  program_value(p, "inflection", inflection(&k));
  program_value(p, "spacing", dx);
  program_value(p, "unstable_one", unstable_share(&k, 2 * dx));
  program_value(p, "unstable_dual", unstable_share(&k, dx));
  program_value(p, "middle_one", curvature(&k, dx));
  program_value(p, "middle_dual", curvature(&k, dx / 2));
  program_value(p, "stiffness_one", stiffness(&k, 0));
  program_value(p, "stiffness_dual", stiffness(&k, 0.5));
  return OK;
}

int main(int argc, char **argv)
{
  struct program p;
  status result = program_begin(&p, argc, argv);
  if (result == OK) result = write_all(&p);
  return program_end(&p, result);
}
