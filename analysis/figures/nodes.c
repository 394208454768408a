/* The virtual particles of S.C over the real ones, at the times given as arguments [s]: the nodes
 * of the fixed grid that lie around the particles of a frame, nearest node and stencil as in
 * solvers/dual.c (dual-particle paper, Sec. 5.1; walls, which bring nodes of their own, are left
 * out). LABEL-k-real.dat and LABEL-k-virtual.dat for time k. Values: their numbers at the first. */
#include "../../core/base/status.h"
#define DIM 2
#define REAL double
#include "../../core/neighbours/node_keys.h"
#include "program.h"

enum { STENCIL = 13 };
static const int around[STENCIL][2] = {{0, 0},  {1, 0},  {-1, 0}, {0, 1},   {0, -1},
                                       {1, 1},  {1, -1}, {-1, 1}, {-1, -1}, {2, 0},
                                       {-2, 0}, {0, 2},  {0, -2}};

static int by_key(const void *a, const void *b)
{
  const unsigned long long x = *(const unsigned long long *)a, y = *(const unsigned long long *)b;
  return x < y ? -1 : x > y;
}

static long unique(unsigned long long *key, long n)
{
  long kept = 0;
  qsort(key, (size_t)n, sizeof *key, by_key);
  for (long k = 0; k < n; k++)
    if (k == 0 || key[k] != key[k - 1]) key[kept++] = key[k];
  return kept;
}

/* The nodes of spacing s around the particles; to be released by free(). NULL: no memory. */
static unsigned long long *nodes_of(const struct result_numbers *x, double s, long *n)
{
  unsigned long long *key = malloc((size_t)(x->rows + 1) * STENCIL * sizeof *key);
  *n = 0;
  for (long i = 0; key && i < x->rows; i++) {
    const double *at = x->values + i * x->components;
    const long long nearest[2] = {node_whole(floor(at[0] / s + 0.5)),
                                  node_whole(floor(at[1] / s + 0.5))};
    for (int k = 0; k < STENCIL; k++) {
      const long long node[2] = {nearest[0] + around[k][0], nearest[1] + around[k][1]};
      key[(*n)++] = key_of(node);
    }
  }
  if (key) *n = unique(key, *n);
  return key;
}

static long frame_near(const struct figure_run *run, double time)
{
  long best = 0;
  for (long k = 1; k < result_read_frames(run->file); k++)
    if (fabs(result_read_time(run->file, k) - time) <
        fabs(result_read_time(run->file, best) - time))
      best = k;
  return best;
}

static status write_points(struct program *p, const struct figure_run *run,
                           const struct result_numbers *x, int number)
{
  char suffix[64];
  const double s =
    program_fact(run, "parameters.spacing") * program_fact(run, "parameters.virtual_spacing");
  long n;
  unsigned long long *key = nodes_of(x, s, &n);
  if (!key) return status_set(ERR_MEMORY, "out of memory");
  snprintf(suffix, sizeof suffix, "-%d-real", number);
  FILE *real_ones = program_data(p, run->label, suffix, "x [m] | y [m]");
  snprintf(suffix, sizeof suffix, "-%d-virtual", number);
  FILE *virtual_ones = program_data(p, run->label, suffix, "x [m] | y [m]");
  for (long i = 0; real_ones && i < x->rows; i++)
    fprintf(real_ones, "%.6g %.6g\n", x->values[3 * i], x->values[3 * i + 1]);
  for (long k = 0; virtual_ones && k < n; k++) {
    long long node[2];
    node_of(key[k], node);
    fprintf(virtual_ones, "%.6g %.6g\n", s * (double)node[0], s * (double)node[1]);
  }
  const status result = real_ones && virtual_ones ? OK : ERR_IO;
  if (real_ones) fclose(real_ones);
  if (virtual_ones) fclose(virtual_ones);
  free(key);
  if (number == 1) program_value(p, "nodes_per_particle", (double)n / (double)x->rows);
  return result;
}

static status treat(struct program *p, const struct figure_run *run)
{
  for (int k = 0; k < p->num_arguments; k++) {
    struct result_numbers x;
    const long frame = frame_near(run, strtod(p->argument[k], NULL));
    TRY(result_read_array(run->file, frame, "position", &x));
    const status written = write_points(p, run, &x, k + 1);
    free(x.values);
    TRY(written);
  }
  return OK;
}

int main(int argc, char **argv)
{
  return program_each(argc, argv, treat);
}
