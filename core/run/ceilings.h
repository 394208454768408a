/* ceilings.h - what this machine can do at most, measured in the same run as the solvers. */
#ifndef CEILINGS_H
#define CEILINGS_H
struct ceilings {
  double bandwidth; /* bytes per second of a triad over arrays far larger than the caches */
  double flops;     /* multiply-adds in `real` per second, times two */
};
/* With as many threads as OpenMP has now. Takes about a second. Zeros when there is no memory for
 * it. */
struct ceilings ceilings_measure(void);
#endif
