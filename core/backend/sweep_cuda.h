/* sweep_cuda.h - sweeps and reductions as kernels: what sweep.h says, for particles on a GPU.
 *
 * A stage is a template argument, so that each has a kernel of its own, and the state is a kernel's
 * argument, so that it is read from constant memory. All is queued in the default stream. */
#ifndef SWEEP_CUDA_H
#define SWEEP_CUDA_H
#include "../base/clock.h"
#ifdef __cplusplus
extern "C" {
#endif

/* The first thread takes the last particle: no result may notice (tests). */
extern int sweep_reversed;

/* Around the launch of a stage's kernel, which is counted. With SPHBENCH_STAGE_TIMES in the
 * environment it is timed, too, and waited for. An error is kept for backend_check. */
void launch_begin(struct stage_clock *stage);
void launch_end(struct stage_clock *stage, int count);

/* Room for one number per block of a reduction, in particle memory; NULL: none left. */
double *reduce_room(int blocks);

/* The sum of those numbers, or the largest; 0 or -1e300 of none, NaN once the GPU failed. */
double reduce_blocks(double *part, int blocks, int largest);

#ifdef __cplusplus
}
#endif

/* Threads of a block, each with one particle. It fixes the order in which a reduction adds. */
enum { LAUNCH_THREADS = 128 };

static inline int launch_blocks(int count)
{
  return count > 0 ? 1 + (count - 1) / LAUNCH_THREADS : 0;
}

template <auto stage, class S>
__global__ void __launch_bounds__(LAUNCH_THREADS)
  sweep_kernel(const __grid_constant__ S s, int count, int reversed)
{
  const unsigned k = blockIdx.x * LAUNCH_THREADS + threadIdx.x;
  if (k < (unsigned)count) stage(&s, reversed ? count - 1 - (int)k : (int)k);
}

template <auto stage, class S>
static void sweep_launch(const S *s, int count, struct stage_clock *clock)
{
  const int blocks = launch_blocks(count);
  launch_begin(clock);
  if (blocks > 0) sweep_kernel<stage><<<blocks, LAUNCH_THREADS>>>(*s, count, sweep_reversed);
  launch_end(clock, count);
}

template <bool largest> __device__ static __forceinline__ double reduce_two(double a, double b)
{
  return largest ? (a > b ? a : b) : a + b;
}

/* Over the threads of a block, as a fixed tree; called once, by all. Thread 0 gets the result. */
template <bool largest, int threads> __device__ static __forceinline__ double reduce_block(double a)
{
  __shared__ double warp[threads / 32];
  for (int away = 16; away > 0; away /= 2)
    a = reduce_two<largest>(a, __shfl_down_sync(0xffffffffu, a, away));
  if (threadIdx.x % 32 == 0) warp[threadIdx.x / 32] = a;
  __syncthreads();
  for (int k = 1; k < threads / 32; k++) a = reduce_two<largest>(a, warp[k]);
  return a;
}

template <auto stage, bool largest, class S>
__global__ void __launch_bounds__(LAUNCH_THREADS)
  reduce_kernel(const __grid_constant__ S s, int count, double *part)
{
  const unsigned k = blockIdx.x * LAUNCH_THREADS + threadIdx.x;
  const double own = k < (unsigned)count ? (double)stage(&s, (int)k) : largest ? -1e300 : 0;
  const double all = reduce_block<largest, LAUNCH_THREADS>(own);
  if (threadIdx.x == 0) part[blockIdx.x] = all;
}

template <auto stage, bool largest, class S>
static double reduce_launch(const S *s, int count, struct stage_clock *clock)
{
  const int blocks = launch_blocks(count);
  double *part = reduce_room(blocks);
  launch_begin(clock);
  if (part && blocks > 0)
    reduce_kernel<stage, largest><<<blocks, LAUNCH_THREADS>>>(*s, count, part);
  launch_end(clock, count);
  return reduce_blocks(part, blocks, largest);
}

#define sweep_over(stage, s, count)                             \
  do {                                                          \
    static struct stage_clock clock_ = {#stage, 0, 0, 0, 0, 0}; \
    sweep_launch<stage>(s, count, &clock_);                     \
  } while (0)

#define reduce_over_(stage, s, count, result, largest)            \
  do {                                                            \
    static struct stage_clock clock_ = {#stage, 0, 0, 0, 0, 0};   \
    *(result) = reduce_launch<stage, largest>(s, count, &clock_); \
  } while (0)
#define sum_over(stage, s, count, result) reduce_over_(stage, s, count, result, false)
#define largest_over(stage, s, count, result) reduce_over_(stage, s, count, result, true)
#endif
