/* How well particles of a run move and lie together, over its frames:
 *
 *   variance   sum_i |v_i - <v>_i|^2 / sum_i |v_i - V|^2,   <v>_i the mean over the neighbours
 *              within 2.1 dx, V the mean of all: 0 where particles move as one fluid, 1 where each
 *              goes its own way
 *   sheets     area (2-D: length) of thin sheets: particles whose neighbours within 2.1 dx lie flat
 *              (smallest eigenvalue of their second moments below a tenth of the next one), each
 *              with the square (2-D: length) of the distance of its nearest neighbour, at most
 *              1.5 dx: clumps and lone particles cover little
 *   clumped    share of particles with a neighbour nearer than 0.5 dx
 *   tension    share of particles with a pressure below 0
 * Values: of the last frame, and the variance's mean over the frames. */
#include "near.h"
#include "program.h"

#define REACH 2.1   /* dx: 2 dx whatever the rounding */
#define FLAT 0.1    /* of the next eigenvalue */
#define WIDEST 1.5  /* dx: a particle covers no more */
#define CLUMPED 0.5 /* dx */
enum { FEWEST = 4 };

struct frame {
  const double *x, *v, *p; /* [n][3], [n][3], [n] */
  int n, dim;
  double dx;
};
struct around {
  const struct frame *f;
  int i, n;
  double mean_v[3], mean_x[3], moment[6], nearest;
};
struct found {
  double time, variance, sheets, clumped, tension;
};

static void add_neighbour(int j, double r, void *self)
{
  struct around *a = self;
  double d[3];
  if (j == a->i) return;
  for (int c = 0; c < 3; c++) {
    d[c] = (a->f->x[3 * j + c] - a->f->x[3 * a->i + c]) / a->f->dx;
    a->mean_v[c] += a->f->v[3 * j + c];
    a->mean_x[c] += d[c];
  }
  const double products[6] = {d[0] * d[0], d[1] * d[1], d[2] * d[2],
                              d[0] * d[1], d[0] * d[2], d[1] * d[2]};
  for (int c = 0; c < 6; c++) a->moment[c] += products[c];
  a->nearest = fmin(a->nearest, r);
  a->n++;
}

/* Eigenvalues of a symmetric matrix (xx, yy, zz, xy, xz, yz), rising, by the trigonometric
 * solution. */
static void eigenvalues(const double m[6], double value[3])
{
  const double mean = (m[0] + m[1] + m[2]) / 3, off = m[3] * m[3] + m[4] * m[4] + m[5] * m[5];
  const double a = m[0] - mean, b = m[1] - mean, c = m[2] - mean;
  const double size = sqrt((a * a + b * b + c * c + 2 * off) / 6);
  const double det =
    a * (b * c - m[5] * m[5]) - m[3] * (m[3] * c - m[5] * m[4]) + m[4] * (m[3] * m[5] - b * m[4]);
  const double part = size > 0 ? fmax(-1, fmin(1, det / (2 * size * size * size))) : 0;
  const double angle = acos(part) / 3, third = 2 * acos(-1.) / 3;
  value[2] = mean + 2 * size * cos(angle);
  value[0] = mean + 2 * size * cos(angle + third);
  value[1] = 3 * mean - value[0] - value[2];
}

/* Do the neighbours lie in a plane (2-D: on a line)? */
static int is_flat(const struct around *a)
{
  double centred[6], value[3];
  const int pair[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  const int fewest = a->f->dim == 2 ? 2 : FEWEST;
  if (a->n < fewest) return 0;
  for (int c = 0; c < 3; c++)
    centred[c] = a->moment[c] / a->n - a->mean_x[c] * a->mean_x[c] / a->n / a->n;
  for (int c = 0; c < 3; c++)
    centred[3 + c] =
      a->moment[3 + c] / a->n - a->mean_x[pair[c][0]] * a->mean_x[pair[c][1]] / a->n / a->n;
  eigenvalues(centred, value);
  return a->f->dim == 2 ? value[1] < FLAT * value[2] : value[0] < FLAT * value[1];
}

static double covered(const struct around *a)
{
  const double side = fmin(a->nearest, WIDEST * a->f->dx);
  return a->f->dim == 2 ? side : side * side;
}

static void mean_velocity(const struct frame *f, double mean[3])
{
  for (int c = 0; c < 3; c++) {
    mean[c] = 0;
    for (int i = 0; i < f->n; i++) mean[c] += f->v[3 * i + c] / f->n;
  }
}

static status measure(const struct frame *f, struct found *found)
{
  struct near near;
  double mean[3], apart = 0, all = 0;
  mean_velocity(f, mean);
  const status begun = near_begin(&near, f->x, f->n, REACH * f->dx);
  for (int i = 0; begun == OK && i < f->n; i++) {
    struct around a = {.f = f, .i = i, .nearest = HUGE_VAL};
    near_each(&near, f->x + 3 * i, add_neighbour, &a);
    for (int c = 0; c < 3; c++) {
      const double v = f->v[3 * i + c], own = v - mean[c];
      const double off = a.n > 0 ? v - a.mean_v[c] / a.n : 0;
      apart += off * off;
      all += own * own;
    }
    if (is_flat(&a)) found->sheets += covered(&a);
    found->clumped += (a.nearest < CLUMPED * f->dx) / (double)f->n;
    found->tension += (f->p && f->p[i] < 0) / (double)f->n;
  }
  found->variance = all > 0 ? apart / all : 0;
  near_end(&near);
  return begun;
}

static status read_frame(const struct figure_run *run, long k, struct found *found)
{
  struct result_numbers x, v, p = {0, 0, NULL};
  TRY(result_read_array(run->file, k, "position", &x));
  status result = result_read_array(run->file, k, "velocity", &v);
  if (result == OK) result = result_read_array(run->file, k, "pressure", &p);
  const struct frame f = {
    x.values,    result == OK ? v.values : NULL, p.values,
    (int)x.rows, (int)program_fact(run, "dim"),  program_fact(run, "parameters.spacing")};
  *found = (struct found){.time = result_read_time(run->file, k)};
  if (result == OK) result = measure(&f, found);
  free(x.values);
  if (f.v) free(v.values);
  free(p.values);
  return result;
}

static status treat(struct program *p, const struct figure_run *run)
{
  FILE *out = program_data(p, run->label, "",
                           "time t [s] | variance of neighbours' velocities [1] | sheets [m^(d-1)] "
                           "| clumped [1] | tension [1]");
  const long frames = result_read_frames(run->file);
  struct found found = {0};
  double sum = 0;
  status result = out ? OK : ERR_IO;
  for (long k = 0; result == OK && k < frames; k++) {
    if ((result = read_frame(run, k, &found)) != OK) break;
    sum += found.variance / (double)frames;
    fprintf(out, "%.8g %.8g %.8g %.8g %.8g\n", found.time, found.variance, found.sheets,
            found.clumped, found.tension);
  }
  if (out) fclose(out);
  program_run_value(p, "variance", run->label, found.variance);
  program_run_value(p, "variance_mean", run->label, sum);
  program_run_value(p, "sheets", run->label, found.sheets);
  program_run_value(p, "clumped", run->label, found.clumped);
  program_run_value(p, "tension", run->label, found.tension);
  return result;
}

int main(int argc, char **argv)
{
  return program_each(argc, argv, treat);
}
