/* memory.h - memory where the particles live (host, or device in the CUDA variants), counted. */
#ifndef MEMORY_H
#define MEMORY_H
#include <stddef.h>
#include "status.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of particle memory, 64-byte aligned, contents undefined (all-ones, NaN as reals, with
 * SPHBENCH_POISON). NULL: none left. */
void *memory_take(size_t bytes);
void memory_give(void *block, size_t bytes);

/* Fill with NaN (reals) or -1 (ints); to see stale reads in tests. */
void memory_poison(void *block, size_t bytes);

/* Between host and particle memory. */
void memory_to_host(void *host, const void *block, size_t bytes);
void memory_from_host(void *block, const void *host, size_t bytes);
void memory_copy(void *to, const void *from, size_t bytes);

/* Is fresh and stale memory poisoned (environment SPHBENCH_POISON=1)? */
int memory_poisoned(void);

/* Bytes taken now, and the most so far. */
size_t memory_taken(void);
size_t memory_peak(void);

#ifdef __cplusplus
}
#endif
#endif
