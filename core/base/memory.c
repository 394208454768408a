#include "memory.h"

#include <stdlib.h>
#include <string.h>

static size_t taken, peak;

int memory_poisoned(void)
{
  static int poisoned = -1;
  if (poisoned < 0) poisoned = getenv("SPHBENCH_POISON") != NULL;
  return poisoned;
}

void *memory_take(size_t bytes)
{
  void *block = NULL;
  if (posix_memalign(&block, 64, bytes + 64)) return NULL;
  taken += bytes;
  if (taken > peak) peak = taken;
  if (memory_poisoned())
    memory_poison(block, bytes + 64);
  else
    memset((char *)block + bytes, 0, 64);
  return block;
}

void memory_give(void *block, size_t bytes)
{
  if (!block) return;
  taken -= bytes;
  free(block);
}

void memory_poison(void *block, size_t bytes) { memset(block, 0xff, bytes); }
void memory_to_host(void *host, const void *block, size_t bytes) { memcpy(host, block, bytes); }
void memory_from_host(void *block, const void *host, size_t bytes) { memcpy(block, host, bytes); }
void memory_copy(void *to, const void *from, size_t bytes) { memcpy(to, from, bytes); }
size_t memory_taken(void) { return taken; }
size_t memory_peak(void) { return peak; }
