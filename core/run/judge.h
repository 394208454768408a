/* judge.h - does a run still mean anything? Criteria that need no opinion; each is noted once, when
 * it first holds, and the first in time is why the run failed. docs/stability.md has the reasons
 * for the limits. */
#ifndef JUDGE_H
#define JUDGE_H
#include "../io/run_facts.h"
#include "../metric.h"
#ifdef __cplusplus
extern "C" {
#endif

enum criterion_number {
#define CRITERION(name, word, unit, limit, blow_up, meaning) CRITERION_##name,
#include "criteria.def"
#undef CRITERION
  NUM_CRITERIA
};
struct criterion {
  const char *word, *unit;
  double limit;
  int is_blow_up;
  const char *meaning;
};
extern const struct criterion criteria[NUM_CRITERIA];

/* What a run knows of itself. */
struct judge {
  struct judged first[NUM_CRITERIA]; /* in the order of time [n] */
  int n;
  unsigned found; /* bits of those */
  long planned;   /* steps of the whole run; 0: not known */
  int driven;     /* the scene moves particles itself */
  double fastest; /* largest speed so far [m/s] */
  long capped_solves, capped_steps;
  int has_start;
  double kinetic, stored; /* energies of the start: to the lowest particle [J, 2-D: J/m] */
  double density;         /* limit [rho0] */
  double growth;          /* largest so far, of energy [1]; NaN: not to be told */
};

struct run;

/* After every step; ends a run of which nothing can be expected any more. */
void judge_step(struct run *run);

/* At a sample; the first one is the start, which is not judged. */
void judge_sample(struct run *run, const struct snapshot *now, const struct measures *values);

/* What can only be said at the end. */
void judge_end(struct run *run);

#ifdef __cplusplus
}
#endif
#endif
