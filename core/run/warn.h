/* warn.h - what a user may have typed by accident: told before a run starts, which goes on all the
 * same. docs/stability.md has the limits. */
#ifndef WARN_H
#define WARN_H
#include "run.h"

enum { MOST_WARNINGS = 6, WARNING_TEXT = 240 };

/* Clauses without a full stop. */
struct warnings {
  int n;
  char text[MOST_WARNINGS][WARNING_TEXT];
  const char *list[MOST_WARNINGS]; /* those [n] */
};

/* What is known of a run that has not started to step:
 *   a particle crosses more than R in a step, at the largest speed that the energy of the start
 *     allows (0.2 R is usual), or by gravity alone;
 *   explicit viscosity beyond 2/(nu V L), L of lattice_most_friction;
 *   surface tension beyond sqrt(rho0 dx^3/(2 pi sigma)), Brackbill, Kothe & Zemach 1992,
 *     doi:10.1016/0021-9991(92)90240-Y;
 *   XSPH of more than 1 per step;
 *   what the solver's own `warn` says.
 * A solver that divides its steps (max_dt) is measured by its substeps. */
void run_warnings(const struct run *run, struct warnings *out);

/* All of them as one sentence on stderr; nothing where there is none. */
void warnings_say(const struct warnings *warnings);

/* The largest speed of fluid, walls and emitters, and what the fluid would win by falling to the
 * lowest particle of all [m/s]. */
double run_energy_speed(const struct run *run);
#endif
