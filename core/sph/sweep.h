/* sweep.h - sweep(stage, s): call stage(s, i) for every particle i; sum_over and largest_over:
 * reduce a stage's value. A stage writes only what belongs to i, so there are no atomics, and sums
 * run over fixed chunks: the same bits for any number of threads and either direction. */
#ifndef SWEEP_H
#define SWEEP_H
#include "../base/clock.h"
#include "sph.h"

#define REDUCE_CHUNK 1024 /* elements that are summed in order; chunks are then summed in order */
#define SWEEP_BLOCK \
  32 /* particles in a row; backwards is block by block, so that both ways run the same code */
#define SWEEP_GRAIN 512 /* below this many particles a parallel loop costs more than it saves */

#ifdef __CUDACC__
#include "../backend/sweep_cuda.h"
#else
#ifdef __cplusplus
extern "C" {
#endif
extern int sweep_reversed; /* walk backwards: results must not notice (tests) */
/* Room for numbers of `chunks` chunks, or for *room, at least 1, where there is no memory. */
double *reduce_scratch(int chunks, int *room);
#ifdef __cplusplus
}
#endif

#define sweep_over(stage, s, count)                                                             \
  do {                                                                                          \
    static struct stage_clock clock_ = {#stage, 0, 0, 0, 0, 0};                                 \
    const double begun_ = stage_begin(&clock_);                                                 \
    const int n_ = (count), back_ = sweep_reversed;                                             \
    const int blocks_ = (n_ + SWEEP_BLOCK - 1) / SWEEP_BLOCK;                                   \
    _Pragma("omp parallel for schedule(static) if (n_ > SWEEP_GRAIN)") for (int b_ = 0;         \
                                                                            b_ < blocks_; b_++) \
    {                                                                                           \
      const int from_ = (back_ ? blocks_ - 1 - b_ : b_) * SWEEP_BLOCK;                          \
      const int to_ = from_ + SWEEP_BLOCK < n_ ? from_ + SWEEP_BLOCK : n_;                      \
      for (int k_ = from_; k_ < to_; k_++) stage(s, k_);                                        \
    }                                                                                           \
    stage_end(&clock_, begun_, n_);                                                             \
  } while (0)

#define reduce_over_(stage, s, count, result, start, combine)                                  \
  do {                                                                                         \
    static struct stage_clock clock_ = {#stage, 0, 0, 0, 0, 0};                                \
    const double begun_ = stage_begin(&clock_);                                                \
    const int n_ = (count), chunks_ = (n_ + REDUCE_CHUNK - 1) / REDUCE_CHUNK;                  \
    double all_ = start;                                                                       \
    int room_;                                                                                 \
    double *part_ = reduce_scratch(chunks_, &room_);                                           \
    for (int first_ = 0; first_ < chunks_; first_ += room_) {                                  \
      const int num_ = chunks_ - first_ < room_ ? chunks_ - first_ : room_;                    \
      _Pragma("omp parallel for schedule(static) if (n_ > SWEEP_GRAIN)") for (int c_ = 0;      \
                                                                              c_ < num_; c_++) \
      {                                                                                        \
        const int from_ = (first_ + c_) * REDUCE_CHUNK;                                        \
        const int to_ = from_ + REDUCE_CHUNK < n_ ? from_ + REDUCE_CHUNK : n_;                 \
        double a_ = start;                                                                     \
        for (int k_ = from_; k_ < to_; k_++) {                                                 \
          const double b_ = (double)stage(s, k_);                                              \
          a_ = combine(a_, b_);                                                                \
        }                                                                                      \
        part_[c_] = a_;                                                                        \
      }                                                                                        \
      for (int c_ = 0; c_ < num_; c_++) all_ = combine(all_, part_[c_]);                       \
    }                                                                                          \
    *(result) = all_;                                                                          \
    stage_end(&clock_, begun_, n_);                                                            \
  } while (0)
#define REDUCE_SUM_(a, b) ((a) + (b))
#define REDUCE_MAX_(a, b) ((a) > (b) ? (a) : (b))

/* *result = sum (or largest) over i of the real that stage(s, i) returns; a NaN makes the sum NaN
 */
#define sum_over(stage, s, count, result) reduce_over_(stage, s, count, result, 0.0, REDUCE_SUM_)
#define largest_over(stage, s, count, result) \
  reduce_over_(stage, s, count, result, -1e300, REDUCE_MAX_)
#endif

#define sweep(stage, s) sweep_over(stage, s, (s)->p.n)
#endif
