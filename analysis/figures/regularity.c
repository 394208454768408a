/* Do particles clump, or does the flow press their rows together? A flow that keeps areas and
 * stretches a lattice more than twofold brings its rows nearer than 0.5 dx without any
 * instability. The deformation of a particle's surroundings is the matrix F that fits
 *
 *   x_j(t) - x_i(t) = F (x_j(0) - x_i(0))
 *
 * over the neighbours that it had at the start within 1.5 dx, in least squares: pairs that draw
 * together do not show in it, a flow does. Over the frames of a run in the plane:
 *
 *   clumped    share of particles with another one nearer than 0.5 dx
 *   squeezed   share of those where the smaller singular value of F is below 0.5
 *   elsewhere  share of clumped ones among the others: clumped by themselves
 *
 * Values: of the last frame, and elsewhere's largest. */
#include "near.h"
#include "program.h"

#define CLUMPED 0.5   /* dx */
#define SQUEEZED 0.5  /* singular value */
#define SURROUND 1.45 /* dx: the eight next on a square lattice */

struct sums {
  const double *start, *x; /* [n][3] */
  int i;
  double yX[2][2], XX[2][2];
};
struct nearest {
  int i;
  double r;
};
struct shares {
  double clumped, squeezed, elsewhere;
};

static void add_deformed(int j, double r, void *self)
{
  struct sums *s = self;
  (void)r;
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      const double X = s->start[3 * j + b] - s->start[3 * s->i + b];
      s->yX[a][b] += (s->x[3 * j + a] - s->x[3 * s->i + a]) * X;
      s->XX[a][b] += (s->start[3 * j + a] - s->start[3 * s->i + a]) * X;
    }
}

static void keep_nearest(int j, double r, void *self)
{
  struct nearest *n = self;
  if (j != n->i) n->r = fmin(n->r, r);
}

/* The smaller singular value of F = yX XX^-1; 1 where the neighbours lie on a line. */
static double least_stretch(const struct sums *s)
{
  const double det = s->XX[0][0] * s->XX[1][1] - s->XX[0][1] * s->XX[1][0];
  const double trace = s->XX[0][0] + s->XX[1][1];
  double F[2][2], squares = 0;
  if (!(det > 1e-6 * trace * trace)) return 1;
  for (int a = 0; a < 2; a++) {
    F[a][0] = (s->yX[a][0] * s->XX[1][1] - s->yX[a][1] * s->XX[1][0]) / det;
    F[a][1] = (s->yX[a][1] * s->XX[0][0] - s->yX[a][0] * s->XX[0][1]) / det;
    squares += F[a][0] * F[a][0] + F[a][1] * F[a][1];
  }
  const double area = F[0][0] * F[1][1] - F[0][1] * F[1][0];
  const double largest = (squares + sqrt(fmax(squares * squares - 4 * area * area, 0))) / 2;
  return largest > 0 ? fabs(area) / sqrt(largest) : 0;
}

static status measure(const double *start, const double *x, int n, double dx, struct shares *found)
{
  struct near before = {.n = 0}, now = {.n = 0};
  status result = near_begin(&before, start, n, SURROUND * dx);
  if (result == OK) result = near_begin(&now, x, n, dx);
  int clumped = 0, squeezed = 0, elsewhere = 0;
  for (int i = 0; result == OK && i < n; i++) {
    struct sums sums = {.start = start, .x = x, .i = i};
    struct nearest nearest = {i, HUGE_VAL};
    near_each(&before, start + 3 * i, add_deformed, &sums);
    near_each(&now, x + 3 * i, keep_nearest, &nearest);
    const int is_clumped = nearest.r < CLUMPED * dx, is_squeezed = least_stretch(&sums) < SQUEEZED;
    clumped += is_clumped;
    squeezed += is_squeezed;
    elsewhere += is_clumped && !is_squeezed;
  }
  near_end(&before);
  near_end(&now);
  found->clumped = clumped / (double)n;
  found->squeezed = squeezed / (double)n;
  found->elsewhere = squeezed < n ? elsewhere / (double)(n - squeezed) : 0;
  return result;
}

static status treat(struct program *p, const struct figure_run *run)
{
  const double dx = program_fact(run, "parameters.spacing");
  const long frames = result_read_frames(run->file);
  struct result_numbers start = {0, 0, NULL}, x;
  struct shares found = {0, 0, 0};
  double most = 0;
  if (program_fact(run, "dim") != 2)
    return user_error("'%s': a run in the plane is needed", run->label);
  TRY(result_read_array(run->file, 0, "position", &start));
  FILE *out =
    program_data(p, run->label, "",
                 "time t [s] | clumped [1] | squeezed by the flow [1] | clumped elsewhere [1]");
  status result = out ? OK : ERR_IO;
  for (long k = 0; result == OK && k < frames; k++) {
    if ((result = result_read_array(run->file, k, "position", &x)) != OK) break;
    if (x.rows == start.rows) result = measure(start.values, x.values, (int)x.rows, dx, &found);
    free(x.values);
    most = fmax(most, found.elsewhere);
    fprintf(out, "%.8g %.8g %.8g %.8g\n", result_read_time(run->file, k), found.clumped,
            found.squeezed, found.elsewhere);
  }
  if (out) fclose(out);
  free(start.values);
  program_run_value(p, "clumped", run->label, found.clumped);
  program_run_value(p, "squeezed", run->label, found.squeezed);
  program_run_value(p, "elsewhere", run->label, found.elsewhere);
  program_run_value(p, "elsewhere_most", run->label, most);
  return result;
}

int main(int argc, char **argv)
{
  return program_each(argc, argv, treat);
}
