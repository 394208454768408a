/* Convergence of SISPH's iteration in one step: what is left of Eq. (7),
 *
 *   Psi/(m/h^2) = sum_i |x_i - x*_i|^2/2 + h^2 K/rho_0 B(lambda_i),   m = rho_0 V_0,  mu = K V_0,
 *
 * with lambda over the pairs within R at x*, after k = 1, 2, ... iterations, of runs of one step
 * that differ in fixed_iterations (their curve is their label up to the comma), without gravity,
 * walls or XSPH:
 *
 *   error     (Psi_k - Psi_min)/(Psi_0 - Psi_min),   Psi_min the least of all runs with the same
 *             energy and K, of which one should go by a tolerance (fixed_iterations = 0)
 *   Eq. (18)  the same with the curve's own last iterate in the place of the minimum
 *
 * Each run of some ms has its own noise: the time of k iterations is that of the line through all
 * runs of a curve whose slope is the median of those between two of them (Sen 1968, J. Am. Stat.
 * Assoc. 63, 1379).
 *
 * With the argument `functions` also B_0, B_1, B_2 and their slopes, Eqs. (15) - (17). Values: the
 * iterations and the time at which a curve passes 0.1, 0.01 and 0.001, what its last iterate
 * leaves. He et al. 2025, Comput. Graph. Forum, Sec. 4.3, Figs. 5 and 6. */
#include "../../core/base/sorted.h"
#include "lambda.h"

enum { MOST = 64 };

struct point {
  double k, psi, time;
};
struct curve {
  const struct figure_run *run; /* one of them */
  char name[128];
  double psi_start;
  int n;
  struct point point[MOST];
};

/* B_n and B_n', Eqs. (15) - (17), lambda = 1 + e */
static double energy(int n, double e)
{
  const double lambda = 1 + e;
  if (n == 0) return e * e / 2;
  return n == 1 ? (pow(lambda, 3) - 1) / 3 - e : (pow(lambda, 4) - 1) / 4 - e;
}
static double slope(int n, double e) { return pow(1 + e, n + 1) - 1; }

static int energy_number(const struct figure_run *run)
{
  const char *word =
    json_string_value(json_object_get(json_object_get(run->facts, "parameters"), "energy"));
  return word && word[0] == 'B' ? word[1] - '0' : 0;
}

/* lambda_i at x over the pairs that are within R at x*: a step looks for neighbours once. */
struct pair_sum {
  struct lambda_sum sum;
  const double *x;
  long i;
};

static void add_pair(int j, double r_start, void *self)
{
  struct pair_sum *s = self;
  const double *a = s->x + 3 * s->i, *b = s->x + 3 * j;
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  (void)r_start;
  lambda_add(j, sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), &s->sum);
}

/* sum_i B(lambda_i) */
static status bulk(const struct figure_run *run, const double *x, const double *target, long n,
                   double *sum)
{
  struct pair_sum s = {.x = x};
  struct near near;
  s.sum.kernel = lambda_kernel(run);
  s.sum.dim = (int)program_fact(run, "dim");
  const double full =
    lambda_lattice(&s.sum.kernel, s.sum.dim, program_fact(run, "parameters.spacing"));
  const status begun = near_begin(&near, target, (int)n, s.sum.kernel.R);
  *sum = 0;
  for (s.i = 0; begun == OK && s.i < n; s.i++) {
    s.sum.sum = 0;
    near_each(&near, target + 3 * s.i, add_pair, &s);
    *sum += energy(energy_number(run), fmax(s.sum.sum / full - 1, 0));
  }
  near_end(&near);
  return begun;
}

/* Psi of positions x [n][3] with the start x* of the iteration. */
static status psi_of(const struct figure_run *run, const double *x, const double *target, long n,
                     double *psi)
{
  const double h = program_fact(run, "parameters.dt"), K = program_fact(run, "parameters.K");
  double of_bulk, moved = 0;
  TRY(bulk(run, x, target, n, &of_bulk));
  for (long k = 0; k < 3 * n; k++) moved += (x[k] - target[k]) * (x[k] - target[k]) / 2;
  *psi = moved + h * h * K / program_fact(run, "parameters.rho0") * of_bulk;
  return OK;
}

/* Psi of the first iterate, x*, and of the last one of a run. */
static status energies(const struct figure_run *run, double *start, double *end)
{
  struct result_numbers x0 = {0, 0, NULL}, v0 = {0, 0, NULL}, x = {0, 0, NULL};
  const double h = program_fact(run, "parameters.dt");
  status result = result_read_array(run->file, 0, "position", &x0);
  if (result == OK) result = result_read_array(run->file, 0, "velocity", &v0);
  if (result == OK)
    result = result_read_array(run->file, result_read_frames(run->file) - 1, "position", &x);
  for (long i = 0; result == OK && i < 3 * x.rows; i++) x0.values[i] += h * v0.values[i]; /* x* */
  if (result == OK) result = psi_of(run, x.values, x0.values, x.rows, end);
  if (result == OK) result = psi_of(run, x0.values, x0.values, x.rows, start);
  free(x0.values);
  free(v0.values);
  free(x.values);
  return result;
}

/* --- curves */

static void curve_name(const struct figure_run *run, char *name, size_t size)
{
  snprintf(name, size, "%.*s", (int)strcspn(run->label, ","), run->label);
}

static struct curve *curve_of(struct curve *curves, int *n, const struct figure_run *run)
{
  char name[128];
  curve_name(run, name, sizeof name);
  for (int k = 0; k < *n; k++)
    if (strcmp(curves[k].name, name) == 0) return &curves[k];
  struct curve *c = &curves[(*n)++];
  *c = (struct curve){.run = run};
  memcpy(c->name, name, sizeof name);
  return c;
}

static int same_problem(const struct figure_run *a, const struct figure_run *b)
{
  return energy_number(a) == energy_number(b) &&
         program_fact(a, "parameters.K") == program_fact(b, "parameters.K");
}

/* The least Psi that any run of the same problem reached: Psi has more than one minimum. */
static double minimum_for(const struct curve *curves, int n, const struct curve *c)
{
  double least = HUGE_VAL;
  for (int k = 0; k < n; k++)
    for (int j = 0; j < curves[k].n && same_problem(curves[k].run, c->run); j++)
      least = fmin(least, curves[k].point[j].psi);
  return least;
}

static double left_after(const struct curve *c, const struct point *point, double least)
{
  return (point->psi - least) / (c->psi_start - least);
}

/* Where a curve first passes `level`, between its points on a logarithmic scale. */
static double passing(const struct curve *c, double least, double level, int of_time)
{
  double before = 0, last = 0; /* log 1 at k = 0 */
  for (int k = 0; k < c->n; k++) {
    const double at = of_time ? c->point[k].time : c->point[k].k;
    const double now = log(fmax(left_after(c, &c->point[k], least), 1e-300));
    if (now <= log(level)) return before + (at - before) * (log(level) - last) / (now - last);
    before = at;
    last = now;
  }
  return (double)NAN;
}

static double median(double *values, int n)
{
  sort_numbers(values, n);
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

static void smooth_times(struct curve *c)
{
  static double values[MOST * MOST];
  int n = 0;
  if (c->n < 2) return;
  for (int k = 0; k < c->n; k++)
    for (int j = 0; j < k; j++)
      values[n++] = (c->point[k].time - c->point[j].time) / (c->point[k].k - c->point[j].k);
  const double slope = median(values, n);
  for (int k = 0; k < c->n; k++) values[k] = c->point[k].time - slope * c->point[k].k;
  const double start = median(values, c->n);
  for (int k = 0; k < c->n; k++) c->point[k].time = start + slope * c->point[k].k;
}

static void put_values(struct program *p, const struct curve *c, double least)
{
  program_run_value(p, "iterations_1", c->name, passing(c, least, 1e-1, 0));
  program_run_value(p, "iterations_2", c->name, passing(c, least, 1e-2, 0));
  program_run_value(p, "iterations_3", c->name, passing(c, least, 1e-3, 0));
  program_run_value(p, "time_2", c->name, passing(c, least, 1e-2, 1));
  program_run_value(p, "left", c->name, left_after(c, &c->point[c->n - 1], least));
}

static status write_curve(struct program *p, const struct curve *c, double least)
{
  const double last = c->point[c->n - 1].psi;
  FILE *out = program_data(p, c->name, "", "iterations k | error | Eq. (18) | time [s]");
  if (!out) return ERR_IO;
  fprintf(out, "0 1 1 0\n");
  for (int k = 0; k < c->n; k++)
    fprintf(out, "%g %.8g %.8g %.8g\n", c->point[k].k, left_after(c, &c->point[k], least),
            left_after(c, &c->point[k], last), c->point[k].time);
  fclose(out);
  put_values(p, c, least);
  return OK;
}

static status write_functions(struct program *p)
{
  for (int n = 0; n < 3; n++) {
    char name[8];
    snprintf(name, sizeof name, "B%d", n);
    FILE *out = program_data(p, name, "", "lambda | B | slope of B");
    if (!out) return ERR_IO;
    for (int k = 0; k <= 100; k++)
      fprintf(out, "%.8g %.8g %.8g\n", 1 + k * 0.01, energy(n, k * 0.01), slope(n, k * 0.01));
    fclose(out);
    program_run_value(p, "energy", name, energy(n, 0.1));
    program_run_value(p, "slope", name, slope(n, 0.1));
  }
  return OK;
}

static status treat_all(struct program *p, struct curve *curves)
{
  int n = 0;
  for (int k = 0; k < p->n; k++) {
    struct curve *c = curve_of(curves, &n, &p->run[k]);
    if (c->n == MOST) return user_error("'%s': more than %d points", c->name, MOST);
    struct point *point = &c->point[c->n++];
    point->k = program_fact(&p->run[k], "parameters.fixed_iterations");
    point->time = program_fact(&p->run[k], "timing.solver");
    TRY(energies(&p->run[k], &c->psi_start, &point->psi));
  }
  for (int k = 0; k < n; k++)
    if (curves[k].point[0].k > 0) {
      smooth_times(&curves[k]);
      TRY(write_curve(p, &curves[k], minimum_for(curves, n, &curves[k])));
    }
  return OK;
}

int main(int argc, char **argv)
{
  struct program p;
  status result = program_begin(&p, argc, argv);
  struct curve *curves = result == OK ? calloc((size_t)p.n + 1, sizeof *curves) : NULL;
  if (result == OK && !curves) result = status_set(ERR_MEMORY, "out of memory");
  if (result == OK) result = treat_all(&p, curves);
  if (result == OK && p.num_arguments > 0 && strcmp(p.argument[0], "functions") == 0)
    result = write_functions(&p);
  free(curves);
  return program_end(&p, result);
}
