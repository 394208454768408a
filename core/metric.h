/* metric.h - what analysis gets to see of a run, and the table of everything that is measured. */
#ifndef METRIC_H
#define METRIC_H
#include "base/status.h"
#include "neighbours/pairs.h"
#ifdef __cplusplus
extern "C" {
#endif

/* What the metrics keep of the start of a run: made once, by metrics_start_make. */
struct metrics_start {
  int n;
  int *layers;   /* by label: whole layers of fluid around it, at most METRICS_LAYERS [n] */
  double volume; /* that the fluid occupies, measured as in volume_change [m^d] */
};
enum { METRICS_LAYERS = 3 };

/* The state of a run at one time, on the host, in the order of the store (not of the labels).
 * Arrays that the run does not have are NULL. */
struct snapshot {
  int n, n_all;        /* fluid particles; fluid and wall particles */
  const vec *x, *v;    /* [n_all] m, m/s */
  const real *p, *rho; /* [n] Pa, kg/m^3: as the solver left them; NULL if it has none */
  const int *id;       /* [n] label from the start */
  const real *light;   /* [n] rest density rho0 over the particle's own; NULL: one fluid */
  double time, dt;
  long step;
  double rho0, dx, mass; /* kg/m^3, m, kg per particle of density rho0 (2-D: kg/m) */
  double support;        /* support radius [m] */
  vec gravity;
  vec low, high;                /* domain that particles must not leave [m] */
  vec period;                   /* 0 where open */
  int num_start;                /* fluid particles at the start */
  const vec *x_start, *v_start; /* by label [num_start] */
  /* NULL: found anew in every call, which costs as much as all the rest */
  const struct metrics_start *start;
  /* fluid -> fluid and walls, cubic kernel; built on first use */
  const struct pairs *(*pairs)(const struct snapshot *);
  void *cache;
};

/* METRIC(name, unit, about) */
enum metric_number {
#define METRIC(name, unit, about) METRIC_##name,
#include "../analysis/metrics.def"
#undef METRIC
  NUM_METRICS,
  /* the first ones every run has; the others are scenes' own */
  NUM_GENERAL_METRICS = METRIC_particles_lost + 1
};

/* Values of one sample: NaN where nothing was measured. */
struct measures {
  double value[NUM_METRICS];
};
#define MEASURE(measures, name, number) ((measures)->value[METRIC_##name] = (number))

extern const char *const metric_names[NUM_METRICS];
extern const char *const metric_units[NUM_METRICS];
extern const char *const metric_about[NUM_METRICS];

/* From x_start, num_start, dx, low, high and period of `now`. Errors: ERR_MEMORY. */
status metrics_start_make(const struct snapshot *now, struct metrics_start *start);
void metrics_start_free(struct metrics_start *start);

/* The metrics that need no truth: distribution, energy, momenta, density, volume, losses. Sets all
 * others to NaN. */
void metrics_measure(const struct snapshot *now, struct measures *out);

#ifdef __cplusplus
}
#endif
#endif
