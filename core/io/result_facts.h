/* result_facts.h - the groups /run and /metrics of a result file; for result_file.c only. */
#ifndef RESULT_FACTS_H
#define RESULT_FACTS_H
#include "h5.h"
#include "run_facts.h"

/* What is known before the first step, with status "running". */
void result_facts_start(struct h5 *h, const struct run_facts *facts);

/* New rows of facts->series and facts->per_step. */
void result_facts_series(struct h5 *h, const struct run_facts *facts);

/* What is known at the end, with the final status. */
void result_facts_end(struct h5 *h, const struct run_facts *facts);

#endif
