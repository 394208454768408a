/* Pair lists. The candidates of a cell, that is the particles around it that are near enough to the
 * box of its own particles, are copied once and side by side; then each particle of the cell tests
 * LANES of them at a time. Compiled without contraction of products and sums, so that one and the
 * same expression decides for (i, j) and for (j, i), in every lane and on every path. */
#include "neighbours.h"

#include <assert.h>
#include <limits.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "compress.h"

enum {
  CHUNK = 1024, /* particles whose rows a thread writes at a time: they stay in its second cache */
  MAX_SETS = 8
};

/* What one thread works with. */
struct worker {
  real *c[DIM]; /* candidates' coordinates [capacity] */
  int *index;   /* and numbers in the list */
  int num, capacity;
  int *slots; /* rows of a chunk */
  size_t used, slot_capacity;
  int failed;
};

struct pair_scratch {
  struct worker *workers;
  int num_workers;
  real *axes; /* coordinates of the listed sets, axis by axis */
  size_t axes_capacity;
  struct compressor compressor;
};

/* A set that is listed. */
struct listed {
  const real *c[DIM]; /* coordinates in cell order [n + LANES] */
  const int *first;
  int offset;
};

/* One call of pairs_build. */
struct job {
  const struct grid *grid;
  const struct cell_set *from;
  struct listed to[MAX_SETS];
  int num_to, row_offset;
  int images; /* bit d: axis d is periodic and any cell may need images, not only one at the seam */
  struct pair_list *list;
  struct pair_scratch *scratch;
};

struct box {
  vec low, high;
};

static int reserve_candidates(struct worker *w, int more)
{
  const long long wanted = (long long)w->num + more + LANES;
  if (wanted <= w->capacity) return 1;
  if (wanted > INT_MAX / 2) return 0;
  const int capacity = (int)(wanted + wanted / 2);
  for (int d = 0; d < DIM; d++) {
    real *c = (real *)realloc(w->c[d], sizeof(real) * (size_t)capacity);
    if (!c) return 0;
    w->c[d] = c;
  }
  int *index = (int *)realloc(w->index, sizeof(int) * (size_t)capacity);
  if (!index) return 0;
  w->index = index;
  w->capacity = capacity;
  return 1;
}

static int reserve_slots(struct worker *w, size_t more)
{
  const size_t wanted = w->used + more;
  if (wanted <= w->slot_capacity) return 1;
  if (wanted > INT_MAX) return 0;
  const size_t capacity = wanted + wanted / 2;
  int *slots = (int *)realloc(w->slots, sizeof(int) * capacity);
  if (!slots) return 0;
  w->slots = slots;
  w->slot_capacity = capacity;
  return 1;
}

STAGE lanes load(const real *a) { return (lanes) * (const loose_lanes *)a; }

/* Copy the particles [begin, end) of a set that are within the support of the box. Rounding is
 * monotonic, so that no sum of squares below is larger than that of a pair with a particle in the
 * box: none is missed. */
static int collect(const struct job *job, struct worker *w, const struct listed *set, int begin,
                   int end, const struct box *box)
{
  const struct compressor *const squeeze = &job->scratch->compressor;
  const real limit = sq(job->grid->support);
  if (!reserve_candidates(w, end - begin)) return 0;
  int num = w->num;
  for (int j = begin; j < end; j += LANES) {
    lanes x[DIM], far = NO_LANES;
    for (int d = 0; d < DIM; d++) {
      x[d] = load(set->c[d] + j);
      const lanes gap = positive(box->low.c[d] - x[d], box->low.c[d] - x[d]) +
                        positive(x[d] - box->high.c[d], x[d] - box->high.c[d]);
      far = d == 0 ? gap * gap : far + gap * gap;
    }
    const int left = end - j, all = left < LANES ? (1 << left) - 1 : (1 << LANES) - 1;
    const int bits = bits_of(far < limit) & all;
    for (int d = 0; d < DIM; d++) compress_reals(squeeze, w->c[d] + num, x[d], bits);
    compress_ints(squeeze, w->index + num, j + set->offset + INDEX_NUMBERS, bits);
    num += number_of(bits);
  }
  w->num = num;
  return 1;
}

/* The cells around a cell, axis by axis; an axis that the variant lacks has one. */
struct surroundings {
  struct stretches near[3];
  int images; /* may a neighbour be nearest through a periodic side? */
};

static struct surroundings look_around(const struct job *job, int cell)
{
  const struct grid *grid = job->grid;
  struct surroundings s = {{{1, {0, 0}, {0, 0}}}, job->images};
  for (int d = DIM - 1; d >= 0; d--) {
    const int c = cell % grid->cells[d];
    cell /= grid->cells[d];
    s.near[3 - DIM + d] = grid_near(grid, d, c, 1);
    s.images |= grid->period.c[d] > 0 && (c == 0 || c == grid->cells[d] - 1);
  }
  return s;
}

static struct box box_of(const vec *x, int begin, int end)
{
  struct box box;
  for (int d = 0; d < DIM; d++) {
    box.low.c[d] = (real)INFINITY;
    box.high.c[d] = -(real)INFINITY;
  }
  for (int i = begin; i < end; i++)
    for (int d = 0; d < DIM; d++) {
      box.low.c[d] = smaller(x[i].c[d], box.low.c[d]);
      box.high.c[d] = larger(x[i].c[d], box.high.c[d]);
    }
  return box;
}

static int collect_set(const struct job *job, struct worker *w, const struct listed *set,
                       const struct stretches near[3], const struct box *box)
{
  const int *cells = job->grid->cells;
  for (int k = 0; k < near[0].num; k++)
    for (int a = near[0].from[k]; a <= near[0].to[k]; a++)
      for (int l = 0; l < near[1].num; l++)
        for (int b = near[1].from[l]; b <= near[1].to[l]; b++)
          for (int m = 0; m < near[2].num; m++) {
            const int *first = set->first + (a * cells[DIM - 2] + b) * cells[DIM - 1];
            if (!collect(job, w, set, first[near[2].from[m]], first[near[2].to[m] + 1], box))
              return 0;
          }
  return 1;
}

/* Test the candidates, LANES at a time; returns the length of the row. */
STAGE int write_row(const struct job *job, const struct worker *w, vec x, int *row, int images)
{
  const struct compressor *const squeeze = &job->scratch->compressor;
  const real limit = sq(job->grid->support);
  const vec period = job->grid->period;
  int length = 0;
  for (int k = 0; k < w->num; k += LANES) {
    lanes square = NO_LANES;
    for (int d = 0; d < DIM; d++) {
      lanes apart = x.c[d] - load(w->c[d] + k);
      if (images && period.c[d] > 0) apart = nearest_image(apart, period.c[d]);
      square = d == 0 ? apart * apart : square + apart * apart;
    }
    const int bits = bits_of(square < limit);
    compress_ints(squeeze, row + length, *(const loose_index_lanes *)(w->index + k), bits);
    length += number_of(bits);
  }
  return length;
}

static int write_rows(const struct job *job, struct worker *w, int begin, int end, int images)
{
  int *first = job->list->first + job->row_offset, *last = job->list->last + job->row_offset;
  for (int i = begin; i < end; i++) {
    if (!reserve_slots(w, (size_t)w->num + 2 * LANES)) return 0;
    int *row = w->slots + w->used;
    const vec x = job->from->x[i];
    const int length = images ? write_row(job, w, x, row, 1) : write_row(job, w, x, row, 0);
    first[i] = (int)w->used;
    last[i] = (int)w->used + length;
    w->used += (size_t)length;
    for (int k = length; k % LANES; k++, w->used++) row[k] = row[length - 1];
  }
  return 1;
}

/* The rows of the particles [begin, end), which fill whole cells. */
static int list_cell(const struct job *job, struct worker *w, int cell, int begin, int end)
{
  const struct surroundings around = look_around(job, cell);
  struct box box = box_of(job->from->x, begin, end);
  for (int d = 0; around.images && d < DIM; d++) {
    box.low.c[d] = -(real)INFINITY;
    box.high.c[d] = (real)INFINITY;
  }
  w->num = 0;
  for (int s = 0; s < job->num_to; s++)
    if (!collect_set(job, w, &job->to[s], around.near, &box)) return 0;
  for (int k = w->num; k < w->num + LANES && w->capacity > 0; k++) { /* never neighbours */
    for (int d = 0; d < DIM; d++) w->c[d][k] = (real)NAN;
    w->index[k] = 0;
  }
  return write_rows(job, w, begin, end, around.images);
}

/* The first cell that begins at particle i or later. */
static int cell_from(const struct job *job, int i)
{
  int low = 0, high = job->grid->num_cells;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (job->from->first[middle] < i)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void list_chunk(const struct job *job, struct worker *w, int chunk)
{
  const int *first = job->from->first;
  const int to = cell_from(job, (chunk + 1) * CHUNK);
  w->used = 0;
  for (int cell = cell_from(job, chunk * CHUNK); cell < to && !w->failed; cell++)
    if (first[cell + 1] > first[cell])
      w->failed = !list_cell(job, w, cell, first[cell], first[cell + 1]);
}

/* Put a chunk's rows at slot `at` of the list. */
static void place_chunk(const struct job *job, const struct worker *w, int chunk, int at)
{
  const int *cell_first = job->from->first;
  const int begin = cell_first[cell_from(job, chunk * CHUNK)];
  const int end = cell_first[cell_from(job, (chunk + 1) * CHUNK)];
  int *first = job->list->first + job->row_offset, *last = job->list->last + job->row_offset;
  if (w->used > 0) memcpy(job->list->list + at, w->slots, sizeof(int) * w->used);
  for (int i = begin; i < end; i++) {
    first[i] += at;
    last[i] += at;
  }
}

/* List all chunks, one after the other from slot `begin` on, as far as there is room; returns the
 * end that they need, -1 where memory ran out. */
static long long list_chunks(const struct job *job, int begin)
{
  const int chunks = (job->from->n + CHUNK - 1) / CHUNK, room = job->list->slot_capacity - LANES;
  long long end = begin;
  int failed = 0;
#pragma omp parallel for ordered schedule(dynamic, 1) if (chunks > 1)
  for (int chunk = 0; chunk < chunks; chunk++) {
    struct worker *w = &job->scratch->workers[omp_get_thread_num()];
    long long at;
    list_chunk(job, w, chunk);
#pragma omp ordered
    {
      at = end;
      end += (long long)w->used;
      failed |= w->failed;
    }
    if (!w->failed && at + (long long)w->used <= room) place_chunk(job, w, chunk, (int)at);
  }
  return failed ? -1 : end;
}

static status reserve_list(struct pair_list *list, long long slots)
{
  if (slots > INT_MAX)
    return status_set(ERR_MEMORY, "a pair list of %lld pairs is too long", slots);
  if (slots <= list->slot_capacity) return OK;
  int *more = (int *)realloc(list->list, sizeof(int) * (size_t)slots);
  if (!more) return status_set(ERR_MEMORY, "no memory for a pair list of %lld pairs", slots);
  list->list = more;
  list->slot_capacity = (int)slots;
  return OK;
}

static status reserve_rows(struct pair_list *list, int rows)
{
  if (rows <= list->row_capacity) return OK;
  const size_t bytes = sizeof(int) * ((size_t)rows + (size_t)rows / 8);
  int *first = (int *)realloc(list->first, bytes);
  if (first) list->first = first;
  int *last = (int *)realloc(list->last, bytes);
  if (last) list->last = last;
  if (!first || !last) return status_set(ERR_MEMORY, "no memory for a pair list of %d rows", rows);
  list->row_capacity = rows + rows / 8;
  return OK;
}

static void free_workers(struct pair_scratch *scratch)
{
  for (int k = 0; k < scratch->num_workers; k++) {
    struct worker *w = &scratch->workers[k];
    for (int d = 0; d < DIM; d++) free(w->c[d]);
    free(w->index);
    free(w->slots);
  }
  free(scratch->workers);
  scratch->workers = NULL;
  scratch->num_workers = 0;
}

static status reserve_scratch(struct pair_list *list, size_t reals)
{
  if (!list->scratch) {
    list->scratch = (struct pair_scratch *)calloc(1, sizeof *list->scratch);
    if (!list->scratch) return status_set(ERR_MEMORY, "no memory for the neighbour search");
    compressor_init(&list->scratch->compressor);
  }
  struct pair_scratch *scratch = list->scratch;
  if (scratch->num_workers < omp_get_max_threads()) {
    free_workers(scratch);
    scratch->workers =
      (struct worker *)calloc((size_t)omp_get_max_threads(), sizeof(struct worker));
    if (!scratch->workers) return status_set(ERR_MEMORY, "no memory for the neighbour search");
    scratch->num_workers = omp_get_max_threads();
  }
  for (int k = 0; k < scratch->num_workers; k++) scratch->workers[k].failed = 0;
  if (reals > scratch->axes_capacity) {
    free(scratch->axes);
    scratch->axes_capacity = reals + reals / 8;
    scratch->axes = (real *)malloc(sizeof(real) * scratch->axes_capacity);
    if (!scratch->axes) {
      scratch->axes_capacity = 0;
      return status_set(ERR_MEMORY, "no memory to search %zu coordinates", reals);
    }
  }
  return OK;
}

/* The coordinates of a set, axis by axis, with LANES spare ones after each axis; returns the next
 * free place. */
static real *split_axes(struct listed *listed, const struct cell_set *set, real *free_axes)
{
  const int n = set->n;
  for (int d = 0; d < DIM; d++) {
    real *c = free_axes + (size_t)d * ((size_t)n + LANES);
    for (int k = 0; k < LANES; k++) c[n + k] = 0;
    listed->c[d] = c;
  }
  real *c = free_axes;
  const vec *x = set->x;
#pragma omp parallel for schedule(static) if (n > 8 * CHUNK)
  for (int i = 0; i < n; i++)
    for (int d = 0; d < DIM; d++) c[(size_t)d * ((size_t)n + LANES) + (size_t)i] = x[i].c[d];
  return free_axes + DIM * ((size_t)n + LANES);
}

/* Axes with a period on which images must be looked for in every cell, and not only at the seam, as
 * bits. */
static int images_everywhere(const struct grid *grid, const struct cell_set *set)
{
  int axes = 0;
  for (int d = 0; d < DIM; d++) {
    const real low = grid->low.c[d], period = grid->period.c[d];
    if (!(period > 0)) continue;
    int outside = period * grid->inv_side.c[d] > (real)grid->cells[d] + (real)0.5;
    const vec *x = set->x;
    const int n = set->n;
#pragma omp parallel for schedule(static) if (n > 8 * CHUNK) reduction(| : outside)
    for (int i = 0; i < n; i++) outside |= x[i].c[d] < low || x[i].c[d] > low + period;
    axes |= outside << d;
  }
  return axes;
}

status pairs_build(struct pair_list *list, const struct grid *grid, const struct cell_set *from,
                   int row_offset, const struct cell_set *to, const int *offset, int num_to)
{
  assert(num_to <= MAX_SETS && (row_offset == 0 || row_offset == list->pairs.rows));
  assert(from->first[grid->num_cells] == from->n);
  const int begin = row_offset > 0 ? list->pairs.slots : 0;
  struct job job = {
    .grid = grid, .from = from, .num_to = num_to, .row_offset = row_offset, .list = list};
  size_t reals = 0;
  for (int s = 0; s < num_to; s++) reals += DIM * ((size_t)to[s].n + LANES);
  TRY(reserve_scratch(list, reals));
  TRY(reserve_rows(list, row_offset + from->n));
  TRY(reserve_list(list, begin + LANES));
  job.scratch = list->scratch;
  job.images = images_everywhere(grid, from);
  real *axes = list->scratch->axes;
  for (int s = 0; s < num_to; s++) {
    axes = split_axes(&job.to[s], &to[s], axes);
    job.to[s].first = to[s].first;
    job.to[s].offset = offset[s];
    job.images |= images_everywhere(grid, &to[s]);
  }
  long long end = list_chunks(&job, begin);
  if (end > list->slot_capacity - LANES) {
    TRY(reserve_list(list, end + (end - begin) / 8 + LANES));
    end = list_chunks(&job, begin);
  }
  if (end < 0) return status_set(ERR_MEMORY, "no memory for the pairs of %d particles", from->n);
  for (int k = 0; k < LANES; k++) list->list[end + k] = 0;
  list->pairs.first = list->first;
  list->pairs.last = list->last;
  list->pairs.list = list->list;
  list->pairs.rows = row_offset + from->n;
  list->pairs.slots = (int)end;
  list->pairs.period = grid->period;
  list->pairs.periodic = 0;
  for (int d = 0; d < DIM; d++) list->pairs.periodic |= grid->period.c[d] > 0;
  return OK;
}

void pair_list_free(struct pair_list *list)
{
  if (list->scratch) {
    free_workers(list->scratch);
    free(list->scratch->axes);
  }
  free(list->scratch);
  free(list->first);
  free(list->last);
  free(list->list);
  *list = (struct pair_list){0};
}
