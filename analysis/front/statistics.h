/* statistics.h - what is concluded from measured times and errors. Nothing here runs or reads. */
#ifndef STATISTICS_H
#define STATISTICS_H

/* Median and the interval between two order statistics, which holds it with probability `coverage`
 * whatever the distribution is (binomial; at least 0.95 from 6 values on, less below, where it is
 * from the smallest to the largest). */
struct interval {
  double median, low, high, coverage;
};
/* Sorts the n >= 1 values. */
struct interval interval_of_median(double *values, int n);

/* on[k] = 1 where no other of the n points has a smaller cost and error (or one equal, the other
 * smaller, or both equal and a smaller number); 0 also where either is not finite. */
void pareto_front(const double *cost, const double *error, int n, int *on);

/* What a solver was measured at. */
struct candidate {
  int solver, point;
  double error, time, low, high; /* low, high: interval of the time */
};
/* The cheapest candidate of each solver whose error is at most `target`, the fastest first, into
 * best [n]; returns their number. Candidates without finite error and time do not count. */
int rank_cheapest(const struct candidate *all, int n, double target, struct candidate *best);

/* How many times slower b is than a; 0: none, as the factor is within that of the noise floor
 * (>= 1) or the intervals overlap. */
double slower_by(const struct candidate *a, const struct candidate *b, double floor);

/* The noise floor: a factor between a[k] and b[k], times of the same thing [n], that 95 % of them
 * keep to (the largest below n = 20); 1 for n = 0. */
double noise_floor(const double *a, const double *b, int n);

/* Times that are worth measuring within a budget: of candidates whose `time` is a rough one, drops
 * (keep[k] = 0) those that are most times slower than a candidate of the same solver with no larger
 * error, down to twice, then the slowest of all, until the others' sum is at most `budget`. At
 * least one of each solver stays. Returns the number dropped. */
int drop_slow(const struct candidate *all, int n, double budget, int *keep);

/* --- profiles. cost [problems * solvers], by problem; not finite or <= 0: not solved --- */

/* Dolan & More 2002, Math. Program. 91, 201: the part of the problems that solver `s` solves within
 * tau times the least cost of all solvers. */
struct profile {
  const double *cost;
  int problems, solvers;
};
double performance_profile(const struct profile *p, int s, double tau);

/* More & Wild 2009, SIAM J. Optim. 20, 172: the part that it solves at a cost up to `kappa`. */
double data_profile(const struct profile *p, int s, double kappa);

/* The part of the problems in which solver a costs less than b (a failure costs most; two failures
 * are no win). */
double pairwise_wins(const struct profile *p, int a, int b);

#endif
