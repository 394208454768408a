/* metric.h - what analysis gets to see of a run, and the table of everything that is measured. */
#ifndef METRIC_H
#define METRIC_H
#include "base/status.h"
#include "neighbours/pairs.h"
#ifdef __cplusplus
extern "C" {
#endif

/* The state of a run at one time, on the host, in the order of the store (not of the labels). Arrays that the run does not
 * have are NULL. */
struct snapshot {
  int n, n_all;           /* fluid particles; fluid and wall particles */
  const vec *x, *v;       /* [n_all] m, m/s */
  const real *p, *rho;    /* [n] Pa, kg/m^3: as the solver left them; NULL if it has none */
  const int *id;          /* [n] label from the start */
  double time, dt;
  long step;
  double rho0, dx, mass;  /* kg/m^3, m, kg per particle (2-D: kg/m) */
  double support;         /* support radius [m] */
  vec gravity;
  vec low, high;          /* domain that particles must not leave [m] */
  vec period;             /* 0 where open */
  int num_start;          /* fluid particles at the start */
  const vec *x_start, *v_start; /* by label [num_start] */
  const struct pairs *(*pairs)(const struct snapshot *); /* fluid -> fluid and walls, cubic kernel; built on first use */
  void *cache;
};

/* METRIC(name, unit, about) */
enum metric_number {
#define METRIC(name, unit, about) METRIC_##name,
#include "../analysis/metrics.def"
#undef METRIC
  NUM_METRICS
};

/* Values of one sample: NaN where nothing was measured. */
struct measures {
  double value[NUM_METRICS];
};
#define MEASURE(measures, name, number) ((measures)->value[METRIC_##name] = (number))

extern const char *const metric_names[NUM_METRICS], *const metric_units[NUM_METRICS], *const metric_about[NUM_METRICS];

/* The metrics that need no truth: distribution, energy, momenta, density, volume, losses. */
void metrics_measure(const struct snapshot *now, struct measures *out);

#ifdef __cplusplus
}
#endif
#endif
