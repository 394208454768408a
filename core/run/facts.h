/* facts.h - collects what is told about a run into run_facts. */
#ifndef FACTS_H
#define FACTS_H
#include "../io/provenance.h"
#include "driver.h"
#include "warn.h"

struct facts {
  struct run_facts run;
  struct provenance provenance;
  struct warnings warnings;
  struct fact metrics[NUM_METRICS], phases[NUM_PHASES], fields[MAX_FIELDS + 2];
  struct fact_column series[NUM_METRICS + 3], steps[3];
};

/* What is known before the first step. */
void facts_start(struct facts *f, const struct options *o, const struct plan *plan,
                 const struct run *run, int threads);

/* The series and counters as they are now. */
void facts_update(struct facts *f, const struct plan *plan, const struct run *run,
                  const struct record *record);

/* Everything at the end; `seconds` is the wall time of the stepping. */
void facts_end(struct facts *f, const struct plan *plan, const struct run *run,
               const struct record *record, enum run_status end, const char *reason,
               double seconds);
#endif
