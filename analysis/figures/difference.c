/* How far runs of one scene are from the first one, frame by frame, in cells of SIDE [m] (the
 * argument), since single particles part by chaos and their numbers may differ:
 *
 *   velocity   sqrt(sum m |v - v1|^2 / sum m |v1|^2) over the cells that both fill, by the first
 *              one's mass
 *   place      sum |m - m1| / (2 sum m1) over all cells: the share of the mass that is elsewhere
 *   front      largest x that a hundredth of the fluid passes [m]
 * Values: of the last frame, and the largest velocity difference. */
#include "program.h"

struct cell {
  long at[3];
  double m, v[3];
};
struct field {
  struct cell *cell;
  long n;
  double time, front;
};

static int by_place(const void *a, const void *b)
{
  return memcmp(((const struct cell *)a)->at, ((const struct cell *)b)->at, sizeof(long[3]));
}

/* Cells of one place become one, with the mean velocity. */
static long gather(struct cell *cell, long n)
{
  long kept = 0;
  qsort(cell, (size_t)n, sizeof *cell, by_place);
  for (long k = 0; k < n; k++) {
    if (kept > 0 && by_place(&cell[kept - 1], &cell[k]) == 0) {
      struct cell *to = &cell[kept - 1];
      for (int c = 0; c < 3; c++)
        to->v[c] = (to->m * to->v[c] + cell[k].m * cell[k].v[c]) / (to->m + cell[k].m);
      to->m += cell[k].m;
    } else {
      cell[kept++] = cell[k];
    }
  }
  return kept;
}

static int falling(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x < y) - (x > y);
}

static double front_of(const struct result_numbers *x)
{
  double *along = malloc((size_t)(x->rows + 1) * sizeof *along), front = NAN;
  for (long i = 0; along && i < x->rows; i++) along[i] = x->values[3 * i];
  if (along && x->rows > 0) {
    qsort(along, (size_t)x->rows, sizeof *along, falling);
    front = along[x->rows / 100];
  }
  free(along);
  return front;
}

/* field->cell is to be released by free(). */
static status read_field(const struct figure_run *run, long k, double side, struct field *field)
{
  struct result_numbers x, v;
  const double mass = pow(program_fact(run, "parameters.spacing"), program_fact(run, "dim"));
  *field = (struct field){.time = result_read_time(run->file, k)};
  TRY(result_read_array(run->file, k, "position", &x));
  status result = result_read_array(run->file, k, "velocity", &v);
  field->cell = malloc((size_t)(x.rows + 1) * sizeof *field->cell);
  if (result == OK && !field->cell) result = status_set(ERR_MEMORY, "out of memory");
  for (long i = 0; result == OK && i < x.rows; i++) {
    struct cell *c = &field->cell[i];
    memset(c, 0, sizeof *c);
    c->m = mass;
    for (int d = 0; d < 3; d++) {
      c->at[d] = (long)floor(x.values[3 * i + d] / side);
      c->v[d] = v.values[3 * i + d];
    }
  }
  if (result == OK) {
    field->n = gather(field->cell, x.rows);
    field->front = front_of(&x);
    free(v.values);
  }
  free(x.values);
  return result;
}

struct difference {
  double velocity, place;
};

static struct difference between(const struct field *first, const struct field *other)
{
  double apart = 0, size = 0, elsewhere = 0, all = 0;
  for (long k = 0; k < first->n; k++) {
    const struct cell *a = &first->cell[k];
    const struct cell *b = bsearch(a, other->cell, (size_t)other->n, sizeof *b, by_place);
    all += a->m;
    elsewhere += b ? fmax(a->m - b->m, 0) : a->m;
    for (int c = 0; b && c < 3; c++) {
      apart += a->m * (a->v[c] - b->v[c]) * (a->v[c] - b->v[c]);
      size += a->m * a->v[c] * a->v[c];
    }
  }
  return (struct difference){size > 0 ? sqrt(apart / size) : 0, elsewhere / all};
}

/* The frame of `run` at a time; -1: none within a millisecond. */
static long frame_at(const struct figure_run *run, double time)
{
  for (long k = 0; k < result_read_frames(run->file); k++)
    if (fabs(result_read_time(run->file, k) - time) < 1e-3) return k;
  return -1;
}

static status compare(struct program *p, const struct figure_run *run, double side, long frame,
                      FILE *out, struct difference *d)
{
  struct field a = {0}, b = {0};
  const double time = result_read_time(p->run[0].file, frame);
  const long other = frame_at(run, time);
  if (other < 0) return OK; /* it ended before */
  status result = read_field(&p->run[0], frame, side, &a);
  if (result == OK) result = read_field(run, other, side, &b);
  if (result == OK) {
    *d = between(&a, &b);
    fprintf(out, "%.8g %.8g %.8g %.8g\n", time, d->velocity, d->place, b.front);
    program_run_value(p, "front", run->label, b.front);
  }
  free(a.cell);
  free(b.cell);
  return result;
}

static status treat(struct program *p, const struct figure_run *run, double side)
{
  FILE *out = program_data(p, run->label, "", "time t [s] | velocity [1] | place [1] | front [m]");
  struct difference d = {0, 0};
  double largest = 0;
  status result = out ? OK : ERR_IO;
  for (long k = 0; result == OK && k < result_read_frames(p->run[0].file); k++) {
    result = compare(p, run, side, k, out, &d);
    largest = fmax(largest, d.velocity);
  }
  if (out) fclose(out);
  program_run_value(p, "velocity", run->label, d.velocity);
  program_run_value(p, "place", run->label, d.place);
  program_run_value(p, "velocity_largest", run->label, largest);
  return result;
}

int main(int argc, char **argv)
{
  struct program p;
  status result = program_begin(&p, argc, argv);
  const double side = result == OK && p.num_arguments == 1 ? strtod(p.argument[0], NULL) : 0;
  if (result == OK && !(side > 0)) result = user_error("one argument is needed, the cells' side");
  for (int k = 0; result == OK && k < p.n; k++) result = treat(&p, &p.run[k], side);
  return program_end(&p, result);
}
