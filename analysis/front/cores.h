/* cores.h - the machine's cores: which are idle, and what others do on them. With hwloc
 * (https://www.open-mpi.org/projects/hwloc) a core with several hardware threads counts once;
 * without it each processor counts. */
#ifndef CORES_H
#define CORES_H
#include <stddef.h>

enum { MOST_CORES = 256 };
struct cores {
  int processor[MOST_CORES]; /* one of each core, as the system numbers them */
  int n;
};

/* The cores that this process may use, those first that were idle in the last fifth of a second,
 * for which it waits. */
struct cores cores_idle_first(void);

/* Seconds since the machine's start in which some process was on one of the processors that this
 * one may use, summed over them; 0 where the system does not tell. */
double cores_busy_seconds(void);

/* "0,2": the first `count` of them. */
void cores_text(const struct cores *cores, int count, char *text, size_t size);

#endif
