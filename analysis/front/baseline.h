/* baseline.h - what was measured once and is to stay so: results/baselines/NAME.json.
 *
 *   about    text
 *   rules    {metric: {abs, rel, side, why}}: how far a value may go: |value - baseline| <= abs +
 *            rel |baseline|; side: both (also if there is none), above (only what lies above
 *            fails) or below; SCENE/metric and f32/metric come before metric
 *   curves   {series: {abs, rel, why}}: for the three numbers that are compared of a curve,
 * relative to the curve's size seeds    {sigmas, why}: how far the median over seeds may go, in its
 * standard deviations builds   {hash: compiler and flags} of the runs runs     {"SCENE with SOLVER
 * (VARIANT) ARGUMENTS": {date, build, status, bits, values: {metric: number}, span: [from, to],
 * curves: {series: [CURVE_BINS means and the end]}}} history  [{date, commit, reason, changes}] of
 * `bless`, the last one last
 *
 * Runs that differ only by their seed are one entry, "... --seed *", with the medians as `values`,
 * their `mad` (median absolute deviation) and the number of `seeds`. Runs that differ only by their
 * spacing, three or more, have an entry more, "... --spacing *", with the orders of their errors.
 *
 * A value that is not a number is never recorded and never passes. */
#ifndef BASELINE_H
#define BASELINE_H
#include <jansson.h>
#include "files.h"

/* All finished runs of RESULTS, a folder with runs, or one run's JSON file: a new object like
 * `runs` above, with every series that `curves` names (NULL: none); `builds` [NULL: not wanted] is
 * filled. ERR_USER: there is none. */
status baseline_collect(const char *results, const json_t *curves, json_t *builds, json_t **runs);

/* Put together what differs only by its seed, add the orders over the spacing. ERR_MEMORY. */
status baseline_group(json_t *runs);

/* Read and check a baseline. ERR_USER with file and line, or key. */
status baseline_read(const char *path, json_t **baseline);

/* Write it, a line per run: values to 7 digits, curves to 5. ERR_IO, ERR_MEMORY. */
status baseline_write(const char *path, const json_t *baseline);

/* The rule for a metric of a run (its key in `runs`): the first there is of SCENE/METRIC,
 * f32/METRIC in single precision, METRIC, f32/default in single precision, default; NULL: none. */
const json_t *baseline_rule(const json_t *rules, const char *run, const char *metric);

/* The rules that a new baseline starts with. */
json_t *baseline_default_rules(void);
json_t *baseline_default_curves(void);
json_t *baseline_default_seeds(void);

/* --- curves */

enum { CURVE_BINS = 6 };

/* A curve by its means over CURVE_BINS equal parts of the time from `span[0]` to `span[1]`, of the
 * straight lines between its points. null: not known all over that part. */
json_t *curve_sample(const json_t *time, const json_t *curve, const double span[2]);

/* What is compared of two sampled curves. */
struct curve_parts {
  double apart;         /* root of the mean squared difference of the means */
  double rate[2];       /* change over the span of the line that fits best: now, before */
  double size, largest; /* of the one before: root mean square, largest absolute value */
};
struct curve_parts curve_compare(const json_t *now, const json_t *before);

/* Slope of the line that fits y [n] on x [n] best, by least squares; NaN: there is none. */
double slope_of(const double *x, const double *y, int n);

/* --- comparing */

struct comparison {
  const char *run;
  char name[64]; /* of a metric; CURVE.curve, CURVE.rate; METRIC.spread; "bits",
                    "status" or "run" */
  double value, baseline, tolerance;
  double excess; /* difference over tolerance; infinite where there is nothing to compare */
  int pass, side;
  char note[160]; /* what else is to say; "" */
};
struct comparisons {
  int bitwise; /* runs have to be the same in every bit */
  struct comparison *row;
  int n, room, failed, runs;
  int identical; /* runs with the same bits throughout */
  int same_build;
  int extra; /* runs or metrics that the baseline does not know */
};

/* Compare runs (of baseline_collect) with a baseline, worst first. The rows point into both. A run
 * on a GPU is compared with the baseline's on the processor where that has none of its own.
 * ERR_MEMORY. */
status baseline_compare(const json_t *runs, const json_t *baseline, struct comparisons *out);

#endif
