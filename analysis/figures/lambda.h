/* lambda.h - density over rest density of points, by a run's own kernel, so that a full lattice has
 * exactly 1: lambda_i = sum_j W_ij / sum_j W_lattice, with i itself. */
#ifndef FIGURE_LAMBDA_H
#define FIGURE_LAMBDA_H
#ifndef DIM
#define DIM 2 /* of vec, which is not used; kernels are asked by number */
#define REAL double
#endif
#include "../../core/sph/kernels.h"
#include "near.h"
#include "program.h"

struct lambda_sum {
  struct kernel kernel;
  int dim;
  double sum;
};

static inline void lambda_add(int j, double r, void *self)
{
  struct lambda_sum *s = self;
  (void)j;
  s->sum += kernel_W(&s->kernel, r, s->dim);
}

/* sum_j W_ij of a full lattice of spacing dx [1/m^d] */
static inline double lambda_lattice(const struct kernel *k, int dim, double dx)
{
  const int reach = (int)ceil(k->R / dx), deep = dim == 3 ? reach : 0;
  double sum = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++)
        sum += kernel_W(k, dx * sqrt((double)(a * a + b * b + c * c)), dim);
  return sum;
}

static inline struct kernel lambda_kernel(const struct figure_run *run)
{
  static const char *const kinds[] = {"cubic", "spiky", "wendland2", "wendland4"};
  const char *word =
    json_string_value(json_object_get(json_object_get(run->facts, "parameters"), "kernel"));
  const double dx = program_fact(run, "parameters.spacing");
  int kind = 0;
  while (word && kind < 3 && strcmp(word, kinds[kind]) != 0) kind++;
  return kernel_make(kind, program_fact(run, "parameters.support") * dx,
                     (int)program_fact(run, "dim"));
}

/* lambda[i] of the first n of n_all points x [n_all][3]. ERR_MEMORY. */
static inline status lambda_all(const struct figure_run *run, const double *x, long n, long n_all,
                                double *lambda)
{
  struct lambda_sum s = {.kernel = lambda_kernel(run), .dim = (int)program_fact(run, "dim")};
  const double full = lambda_lattice(&s.kernel, s.dim, program_fact(run, "parameters.spacing"));
  struct near near;
  const status begun = near_begin(&near, x, (int)n_all, s.kernel.R);
  for (long i = 0; begun == OK && i < n; i++) {
    s.sum = 0;
    near_each(&near, x + 3 * i, lambda_add, &s);
    lambda[i] = s.sum / full;
  }
  near_end(&near);
  return begun;
}
#endif
