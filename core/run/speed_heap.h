/* speed_heap.h - the case of `sphbench speed`: a settled heap of fluid in a box, and its times. */
#ifndef SPEED_HEAP_H
#define SPEED_HEAP_H
#include "run.h"

#define SUPPORT 2.0      /* dx: four particle radii */
#define EQUAL_ERROR 1e-3 /* mean compression at which solvers are compared */

/* The step that keeps the mean compression at or below EQUAL_ERROR, by the largest tolerance of the
 * solver's that does; NAN where none does, or where the solver has none and misses it. */
struct equal_case {
  double step, error, tolerance, iterations; /* us per particle; achieved; asked; per step */
};

/* A run on the heap after a few steps, with `iterations` fixed ones, or if 0 by that tolerance (0:
 * the solver's own). Errors: those of run_create and run_step. */
status heap_open(const struct solver *solver, int particles, int iterations, double tolerance,
                 struct run **run);

/* Seconds per step, the best of some rounds, and of that the neighbour search's. ERR_RUN: it
 * diverged. */
status heap_time(struct run *run, double *step, double *search);

status heap_at_equal_error(const struct solver *solver, int particles, struct equal_case *equal);

#endif
