/* clock.h - wall time per phase and per stage, for nothing: sweep() knows the stage's name. */
#ifndef CLOCK_H
#define CLOCK_H
#ifdef __cplusplus
extern "C" {
#endif

#define PHASE_LIST(P)                                                   \
  P(OTHER, "other", "set-up, sampling and whatever is not named")       \
  P(NEIGHBOURS, "neighbours", "sorting and pair lists")                 \
  P(SOLVER, "solver", "the pressure solver's own work")                 \
  P(INTEGRATE, "integrate", "moving particles, body forces, viscosity") \
  P(METRICS, "metrics", "evaluation of metrics and truths")             \
  P(OUTPUT, "output", "writing results")

#define P(name, text, about) PHASE_##name,
enum phase { PHASE_LIST(P) NUM_PHASES };
#undef P

/* Monotonic wall time [s]. */
double clock_now(void);

/* Time spent from now on belongs to `phase`; returns the phase before, to be restored. */
enum phase clock_enter(enum phase phase);

/* Waits for work that was only queued, at the end of each phase; set by backends that queue. */
extern void (*clock_settle)(void);

/* Seconds spent in each phase so far [NUM_PHASES], and their names. */
void clock_phases(double seconds[NUM_PHASES]);
const char *clock_phase_name(enum phase phase);
const char *clock_phase_about(enum phase phase);
void clock_reset(void);

/* One per sweep in the source text, static, linked on its first use. */
struct stage_clock {
  const char *name;
  double seconds;
  long calls, items;
  int listed;
  struct stage_clock *next;
};
double stage_begin(struct stage_clock *stage);
void stage_end(struct stage_clock *stage, double begun, long items);

/* The stages that ran, in the order of their first use; NULL when none did. */
const struct stage_clock *stage_list(void);

#ifdef __cplusplus
}
#endif
#endif
