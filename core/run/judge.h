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

/* C(NAME, word, unit of the value, limit, blow-up, meaning), the worst first. A limit of 0 is one
 * that the run has of its own. Those of the steps (NOT_FINITE, SPEED) end the run; the others are
 * noted at samples. A leak is no blow-up. */
#define CRITERION_LIST(C)                                                                         \
  C(NOT_FINITE, "not-finite", "1", 0, 1, "a position or velocity is no number, or infinite")      \
  C(GAVE_UP, "gave-up", "1", 0, 1, "the solver itself gave the run up")                           \
  C(SPEED, "speed", "m/s", 0, 1,                                                                  \
    "a particle is 10 times faster than any energy of the start "                                 \
    "allows")                                                                                     \
  C(OUTSIDE, "outside", "1", 0.05, 1, "part of the fluid more than a support outside the domain") \
  C(DENSITY, "density", "rho0", 2, 1, "largest density; the limit is that of the start if more")  \
  C(ENERGY, "energy", "1", 0.1, 1,                                                                \
    "growth of kinetic and potential energy, where the system is "                                \
    "closed, over what the fluid had at the start and has won by falling")                        \
  C(VOLUME, "volume", "1", 0.1, 1, "relative change of volume, where no fluid flows in")          \
  C(ITERATIONS, "iterations", "1", 0.05, 1, "part of the steps in which a solve hit its cap")     \
  C(LEAK, "leak", "particles", 0, 0, "fluid more than a support outside the domain")
#define C(name, word, unit, limit, blow_up, meaning) CRITERION_##name,
enum criterion_number { CRITERION_LIST(C) NUM_CRITERIA };
#undef C
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
