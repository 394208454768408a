/* figure_plan.h - what figures would run, how long and how large, without running it. */
#ifndef FIGURE_PLAN_H
#define FIGURE_PLAN_H
#include "runs.h"

/* Print the runs of a queue, each with its particles and steps, as the run itself would resolve
 * them, and an estimate of time and memory: the same arguments' last time where they were run, else
 * the time per particle and step and the bytes per particle of the solver's last run in these
 * results (of the same scene where there is one). A solver that was never run has none. ERR_IO,
 * ERR_MEMORY. */
status figure_plan_show(const struct queue *queue);

#endif
