/* node_keys.h - nodes or cells of an unbounded grid as sortable keys: KEY_BITS bits per axis, first
 * axis highest, so that nodes that follow each other on the last axis have keys one apart. */
#ifndef NODE_KEYS_H
#define NODE_KEYS_H
#include "../sph/sph.h"

enum { KEY_BITS = DIM == 2 ? 31 : 21 };
#define NO_KEY (~0ULL) /* dropped by run_unique_keys */
#define KEY_ZERO (1LL << (KEY_BITS - 1))

STAGE unsigned long long key_of(const long long k[DIM])
{
  unsigned long long key = 0;
  for (int d = 0; d < DIM; d++) key = key << KEY_BITS | (unsigned long long)(k[d] + KEY_ZERO);
  return key;
}
STAGE void node_of(unsigned long long key, long long k[DIM])
{
  for (int d = DIM - 1; d >= 0; d--, key >>= KEY_BITS)
    k[d] = (long long)(key & ((1ULL << KEY_BITS) - 1)) - KEY_ZERO;
}
/* A whole number of the grid as a coordinate of a node: far ones come to the border, so that the
 * nodes around them have keys too. */
STAGE long long node_whole(real q)
{
  const real limit = (real)(KEY_ZERO - 4);
  return (long long)larger(smaller(q, limit), -limit);
}
/* Place of a key among n sorted ones; -1 where it is not. */
STAGE int key_find(const unsigned long long *keys, int n, unsigned long long key)
{
  int low = 0, high = n;
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (keys[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < n && keys[low] == key ? low : -1;
}
#endif
