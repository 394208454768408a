/* baseline.h - what was measured once and is to stay so: results/baselines/NAME.json.
 *
 *   about    text
 *   rules    {metric: {abs, rel, side, why}}: how far a value may go: |value - baseline| <= abs +
 *            rel |baseline|; side: both, above (only what lies above fails) or below
 *   curves   {series: {abs, rel, why}}: for the largest difference, on the baseline's times,
 *            relative to the curve's largest value
 *   runs     {"SCENE with SOLVER (VARIANT) ARGUMENTS": {status, values: {metric: number}, series:
 *            {time: [..], NAME: [..]}}}
 *   history  [{date, commit, reason, changes}] of `bless`, the last one last
 *
 * A value that is not a number is never recorded and never passes. */
#ifndef BASELINE_H
#define BASELINE_H
#include <jansson.h>
#include "files.h"

/* All finished runs of RESULTS, a folder with runs, or one run's JSON file: a new object like
 * `runs` above, with every series that `curves` names (NULL: none). ERR_USER: there is none. */
status baseline_collect(const char *results, const json_t *curves, json_t **runs);

/* Read and check a baseline. ERR_USER with file and line, or key. */
status baseline_read(const char *path, json_t **baseline);

/* The rule of a metric in `rules`, or the one called "default"; NULL: neither. */
const json_t *baseline_rule(const json_t *rules, const char *metric);

/* The rules that a new baseline starts with. */
json_t *baseline_default_rules(void);
json_t *baseline_default_curves(void);

/* One comparison. */
struct comparison {
  const char *run, *name; /* name: of a metric, a curve, or "status" */
  double value, baseline, tolerance;
  double excess; /* difference over tolerance; infinite where there is nothing to compare */
  int pass, side;
  char note[160]; /* what else is to say; "" */
};
struct comparisons {
  struct comparison *row;
  int n, room, failed, runs;
  int extra; /* runs or metrics that the baseline does not know */
};

/* Compare runs (of baseline_collect) with a baseline, worst first. The rows point into both.
 * ERR_MEMORY. */
status baseline_compare(const json_t *runs, const json_t *baseline, struct comparisons *out);

#endif
