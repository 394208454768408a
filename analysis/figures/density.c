/* Density of every particle of a run's last frame over the rest density, lambda_i, over fluid and
 * walls: x, y (3-D: height) and lambda_i. Values: the mean lambda of the particles left and right
 * of SPLIT [m] (the argument; none: all are left) between 0.25 and 0.75 of its height. */
#include "lambda.h"

/* Fluid first, then walls. */
static status all_points(const struct figure_run *run, struct result_numbers *x, long *n)
{
  struct result_numbers walls = {0, 0, NULL};
  TRY(result_read_array(run->file, result_read_frames(run->file) - 1, "position", x));
  *n = x->rows;
  if (!result_read_has(run->file, "walls/position")) return OK;
  status result = result_read_series(run->file, "walls/position", &walls);
  double *more = realloc(x->values, (size_t)(x->rows + walls.rows) * 3 * sizeof *more);
  if (more) x->values = more;
  if (!more) result = status_set(ERR_MEMORY, "out of memory");
  if (result == OK) {
    memcpy(more + 3 * x->rows, walls.values, (size_t)walls.rows * 3 * sizeof *more);
    x->rows += walls.rows;
  }
  free(walls.values);
  return result;
}

struct halves {
  double low, high, sum[2];
  int n[2];
};

static struct halves means(const double *x, const double *lambda, long n, int up, double split)
{
  struct halves h = {.low = HUGE_VAL, .high = -HUGE_VAL};
  for (long i = 0; i < n; i++) {
    h.low = fmin(h.low, x[3 * i + up]);
    h.high = fmax(h.high, x[3 * i + up]);
  }
  for (long i = 0; i < n; i++) {
    const double part = (x[3 * i + up] - h.low) / (h.high - h.low);
    const int half = x[3 * i] > split;
    if (part < 0.25 || part > 0.75) continue;
    h.sum[half] += lambda[i];
    h.n[half]++;
  }
  return h;
}

static status write(struct program *p, const struct figure_run *run, const double *x,
                    const double *lambda, long n)
{
  const int up = (int)program_fact(run, "dim") - 1;
  FILE *out = program_data(p, run->label, "", "x [m] | y [m] | density over rest density [1]");
  if (!out) return ERR_IO;
  for (long i = 0; i < n; i++) fprintf(out, "%.6g %.6g %.6g\n", x[3 * i], x[3 * i + up], lambda[i]);
  fclose(out);
  const double split = p->num_arguments > 0 ? strtod(p->argument[0], NULL) : HUGE_VAL;
  const struct halves h = means(x, lambda, n, up, split);
  program_run_value(p, "lambda_left", run->label, h.sum[0] / h.n[0]);
  program_run_value(p, "lambda_right", run->label, h.sum[1] / h.n[1]);
  return OK;
}

static status treat(struct program *p, const struct figure_run *run)
{
  struct result_numbers x;
  long n;
  TRY(all_points(run, &x, &n));
  double *lambda = malloc((size_t)n * sizeof *lambda);
  status result =
    lambda ? lambda_all(run, x.values, n, x.rows, lambda) : status_set(ERR_MEMORY, "out of memory");
  if (result == OK) result = write(p, run, x.values, lambda, n);
  free(lambda);
  free(x.values);
  return result;
}

int main(int argc, char **argv)
{
  return program_each(argc, argv, treat);
}
