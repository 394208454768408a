/* The search on a GPU: bounding boxes, sorting by cell, pair lists. It is compiled without
 * contraction of products and sums, as the search on the host is, so that both list the same
 * pairs. */
#include "../neighbours/neighbours.h"
#include "cuda.h"

#include <assert.h>
#include <limits.h>

enum { MAX_SETS = 8, BOUNDS_BLOCKS = 256 };

/* The index of this thread among all of a launch. */
#define THREAD ((long long)blockIdx.x * LAUNCH_THREADS + threadIdx.x)

/* --- positions ------------------------------------------------------------------------------- */

struct bounds {
  vec low, high;
  int bad;
};

__host__ __device__ static struct bounds no_bounds(void)
{
  struct bounds none;
  for (int d = 0; d < DIM; d++) {
    none.low.c[d] = (real)INFINITY;
    none.high.c[d] = -(real)INFINITY;
  }
  none.bad = 0;
  return none;
}

__host__ __device__ static void join_bounds(struct bounds *a, const struct bounds *b)
{
  for (int d = 0; d < DIM; d++) {
    a->low.c[d] = smaller(b->low.c[d], a->low.c[d]);
    a->high.c[d] = larger(b->high.c[d], a->high.c[d]);
  }
  a->bad += b->bad;
}

__device__ static struct bounds bounds_of(vec x)
{
  struct bounds own = no_bounds();
  for (int d = 0; d < DIM; d++) own.bad |= !(x.c[d] - x.c[d] == 0);
  if (!own.bad) own.low = own.high = x;
  return own;
}

__global__ void __launch_bounds__(LAUNCH_THREADS)
  bounds_kernel(const vec *x, int n, struct bounds *part)
{
  __shared__ struct bounds of_thread[LAUNCH_THREADS];
  struct bounds own = no_bounds();
  for (long long i = THREAD; i < n; i += (long long)gridDim.x * LAUNCH_THREADS) {
    const struct bounds one = bounds_of(x[i]);
    join_bounds(&own, &one);
  }
  of_thread[threadIdx.x] = own;
  for (int half = LAUNCH_THREADS / 2; half > 0; half /= 2) {
    __syncthreads();
    if ((int)threadIdx.x < half)
      join_bounds(&of_thread[threadIdx.x], &of_thread[threadIdx.x + half]);
  }
  if (threadIdx.x == 0) part[blockIdx.x] = of_thread[0];
}

static int device_positions_bounds(const vec *x, int n, vec *low, vec *high)
{
  static struct room room;
  struct bounds part[BOUNDS_BLOCKS], all = no_bounds();
  const int wanted = launch_blocks(n), blocks = wanted < BOUNDS_BLOCKS ? wanted : BOUNDS_BLOCKS;
  struct bounds *const device_part = (struct bounds *)room_of(&room, sizeof part);
  *low = *high = zero();
  if (blocks == 0) return 0;
  if (!device_part) return n;
  bounds_kernel<<<blocks, LAUNCH_THREADS>>>(x, n, device_part);
  if (!launched("positions_bounds")) return n;
  memory_to_host(part, device_part, sizeof *part * (size_t)blocks);
  if (failed() != OK) return n;
  for (int k = 0; k < blocks; k++) join_bounds(&all, &part[k]);
  for (int d = 0; d < DIM && all.bad < n; d++) {
    low->c[d] = all.low.c[d] + 0; /* + 0: no -0 */
    high->c[d] = all.high.c[d] + 0;
  }
  return all.bad;
}

/* --- sorting --------------------------------------------------------------------------------- */

__global__ void __launch_bounds__(LAUNCH_THREADS)
  cells_kernel(const __grid_constant__ struct grid grid, const vec *x, int n, int *cell, int *index)
{
  const long long i = THREAD;
  if (i >= n) return;
  cell[i] = grid_cell_of(&grid, x[i], (int)i);
  index[i] = (int)i;
}

/* first[c] = number of particles in cells before c, for c = 0 .. num_cells, by bisection of the
 * sorted cells. */
__global__ void __launch_bounds__(LAUNCH_THREADS)
  first_kernel(const int *cell, int n, int *first, int num_cells)
{
  const long long c = THREAD;
  if (c > num_cells) return;
  int low = 0, high = n;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (cell[middle] < c)
      low = middle + 1;
    else
      high = middle;
  }
  first[c] = low;
}

static int bits_of(int most)
{
  int bits = 1;
  while (most >> bits > 0) bits++;
  return bits;
}

static status device_cell_sort(struct cell_set *set, const struct grid *grid, const vec *x, int n,
                               int *order)
{
  const int num_cells = grid->num_cells;
  size_t capacity = (size_t)set->capacity;
  TRY(failed());
  TRY(grow(&set->first, &capacity, (size_t)num_cells + 1, 0, "cells"));
  set->capacity = (int)capacity;
  TRY(grow(&set->work, &set->work_capacity, 3 * (size_t)n, 0, "numbers to sort by cell"));
  int *const cell = set->work, *const sorted = cell + n, *const index = sorted + n;
  if (n > 0) {
    cells_kernel<<<launch_blocks(n), LAUNCH_THREADS>>>(*grid, x, n, cell, index);
    if (!launched("cells of particles")) return failed();
    TRY(device_sort_by(cell, sorted, index, order, n, bits_of(num_cells - 1)));
  }
  first_kernel<<<launch_blocks(num_cells + 1), LAUNCH_THREADS>>>(sorted, n, set->first, num_cells);
  set->n = n;
  return launched("first particle of a cell") ? OK : failed();
}

/* A thread copies one word, so that neighbouring threads write side by side. */
template <class word>
__global__ void __launch_bounds__(LAUNCH_THREADS)
  permute_kernel(word *to, const word *from, const int *order, long long count, int words)
{
  const long long k = THREAD;
  if (k < count) to[k] = from[(long long)order[k / words] * words + k % words];
}

template <class word>
static void permute_words(void *to, const void *from, const int *order, int n, size_t bytes)
{
  const int words = (int)(bytes / sizeof(word));
  const long long count = (long long)n * words;
  const unsigned blocks = (unsigned)((count + LAUNCH_THREADS - 1) / LAUNCH_THREADS);
  if (blocks == 0) return;
  permute_kernel<<<blocks, LAUNCH_THREADS>>>((word *)to, (const word *)from, order, count, words);
  launched("permute");
}

static void device_permute(void *to, const void *from, const int *order, int n, size_t bytes)
{
  if (bytes % 8 == 0)
    permute_words<unsigned long long>(to, from, order, n, bytes);
  else if (bytes % 4 == 0)
    permute_words<unsigned>(to, from, order, n, bytes);
  else
    permute_words<unsigned char>(to, from, order, n, bytes);
}

/* --- pair lists ------------------------------------------------------------------------------ */

/* One call of pairs_build, as a kernel sees it. */
struct job {
  struct grid grid;
  const vec *from; /* [n] */
  int n, num_to;
  struct {
    const vec *x;
    const int *first;
    int offset;
  } to[MAX_SETS];
};

/* |a - b|^2, through the period's sides where that is nearer */
__device__ static real square_apart(const struct grid *grid, vec a, vec b)
{
  real square = 0;
  for (int d = 0; d < DIM; d++) {
    const real period = grid->period.c[d];
    real apart = a.c[d] - b.c[d];
    if (period > 0) apart = nearest_image(apart, period);
    square += apart * apart;
  }
  return square;
}

/* The neighbours of x among the particles [begin, end) of a set: their number, and themselves where
 * there is a row. */
__device__ static int find_in(const struct job *job, int set, int begin, int end, vec x, int *row)
{
  const real limit = sq(job->grid.support);
  int found = 0;
  for (int j = begin; j < end; j++)
    if (square_apart(&job->grid, x, job->to[set].x[j]) < limit) {
      if (row) row[found] = job->to[set].offset + j;
      found++;
    }
  return found;
}

/* The same among all sets, in the order of their cells. */
__device__ static int find(const struct job *job, vec x, int *row)
{
  const struct grid *const grid = &job->grid;
  struct stretches near[3] = {{1, {0, 0}, {0, 0}}};
  for (int d = 0; d < DIM; d++) near[3 - DIM + d] = grid_near(grid, d, grid_cell(grid, x, d), 1);
  int found = 0;
  for (int s = 0; s < job->num_to; s++)
    for (int k = 0; k < near[0].num; k++)
      for (int a = near[0].from[k]; a <= near[0].to[k]; a++)
        for (int l = 0; l < near[1].num; l++)
          for (int b = near[1].from[l]; b <= near[1].to[l]; b++)
            for (int m = 0; m < near[2].num; m++) {
              const int *first =
                job->to[s].first + (a * grid->cells[DIM - 2] + b) * grid->cells[DIM - 1];
              found += find_in(job, s, first[near[2].from[m]], first[near[2].to[m] + 1], x,
                               row ? row + found : NULL);
            }
  return found;
}

/* count[i] = length of row i; count[n] = 0 */
__global__ void __launch_bounds__(LAUNCH_THREADS)
  count_kernel(const __grid_constant__ struct job job, int *count)
{
  const long long i = THREAD;
  if (i <= job.n) count[i] = i < job.n ? find(&job, job.from[i], NULL) : 0;
}

/* Write row i from slot begin + before[i] on. */
__global__ void __launch_bounds__(LAUNCH_THREADS)
  fill_kernel(const __grid_constant__ struct job job, const long long *before, int begin,
              int *first, int *last, int *list)
{
  const long long i = THREAD;
  if (i >= job.n) return;
  const int at = begin + (int)before[i];
  first[i] = at;
  last[i] = at + find(&job, job.from[i], list + at);
}

/* before[i] = number of pairs in rows before i, i = 0 .. n: in 64 bits, since a list that is too
 * long must be noticed. */
static status count_pairs(const struct job *job, long long **before, long long *total)
{
  static struct room counts, sums;
  const int n = job->n;
  int *const count = (int *)room_of(&counts, sizeof(int) * ((size_t)n + 1));
  long long *const sum = (long long *)room_of(&sums, sizeof(long long) * ((size_t)n + 1));
  if (!count || !sum)
    return status_set(ERR_MEMORY, "no memory on the GPU to count the pairs of %d particles", n);
  count_kernel<<<launch_blocks(n + 1), LAUNCH_THREADS>>>(*job, count);
  if (!launched("pairs_build")) return failed();
  TRY(device_sum_before(count, sum, n + 1));
  memory_to_host(total, sum + n, sizeof *total);
  *before = sum;
  return failed();
}

static status reserve_rows(struct pair_list *list, int rows, int kept)
{
  size_t first_room = (size_t)list->row_capacity, last_room = first_room;
  TRY(grow(&list->first, &first_room, (size_t)rows, (size_t)kept, "rows of pairs"));
  TRY(grow(&list->last, &last_room, (size_t)rows, (size_t)kept, "rows of pairs"));
  list->row_capacity = (int)last_room;
  return OK;
}

static status reserve_slots(struct pair_list *list, long long slots, int kept)
{
  size_t room = (size_t)list->slot_capacity;
  if (slots > INT_MAX - INT_MAX / 8)
    return status_set(ERR_MEMORY, "a pair list of %lld pairs is too long", slots);
  TRY(grow(&list->list, &room, (size_t)slots, (size_t)kept, "pairs"));
  list->slot_capacity = (int)room;
  return OK;
}

static status device_pairs_build(struct pair_list *list, const struct grid *grid,
                                 const struct cell_set *from, int row_offset,
                                 const struct cell_set *to, const int *offset, int num_to)
{
  assert(num_to <= MAX_SETS && (row_offset == 0 || row_offset == list->pairs.rows));
  const int begin = row_offset > 0 ? list->pairs.slots : 0;
  struct job job = {};
  long long *before = NULL, total = 0;
  job.grid = *grid;
  job.from = from->x;
  job.n = from->n;
  job.num_to = num_to;
  for (int s = 0; s < num_to; s++) {
    job.to[s].x = to[s].x;
    job.to[s].first = to[s].first;
    job.to[s].offset = offset[s];
  }
  TRY(failed());
  TRY(count_pairs(&job, &before, &total));
  TRY(reserve_rows(list, row_offset + from->n, row_offset));
  TRY(reserve_slots(list, begin + total + 1, begin));
  if (from->n > 0)
    fill_kernel<<<launch_blocks(from->n), LAUNCH_THREADS>>>(
      job, before, begin, list->first + row_offset, list->last + row_offset, list->list);
  if (!launched("pairs_build")) return failed();
  list->pairs.first = list->first;
  list->pairs.last = list->last;
  list->pairs.list = list->list;
  list->pairs.rows = row_offset + from->n;
  list->pairs.slots = (int)(begin + total);
  list->pairs.period = grid->period;
  list->pairs.periodic = 0;
  for (int d = 0; d < DIM; d++) list->pairs.periodic |= grid->period.c[d] > 0;
  return OK;
}

/* --- the search as a table ------------------------------------------------------------------- */

static void device_pair_list_free(struct pair_list *list)
{
  device_give(list->first);
  device_give(list->last);
  device_give(list->list);
  *list = pair_list{};
}

static void device_cell_set_free(struct cell_set *set)
{
  device_give(set->first);
  device_give(set->work);
  *set = cell_set{};
}

const struct search particle_search = {
  .positions_bounds = device_positions_bounds,
  .cell_sort = device_cell_sort,
  .permute = device_permute,
  .pairs_build = device_pairs_build,
  .keys_unique = device_keys_unique,
  .pair_list_free = device_pair_list_free,
  .cell_set_free = device_cell_set_free,
};
