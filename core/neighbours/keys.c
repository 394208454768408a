/* Sets of whole numbers. Most keys come many times, so that repetitions go first, by hashing, and
 * sorting has little left to do. */
#include "neighbours.h"

#include <limits.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#define GRAIN 16384 /* keys per thread, below which it costs more than it saves */
#define NONE ULLONG_MAX

typedef unsigned long long key;

/* Keys that were met; at most half full. NONE, which is no key, marks an empty place. */
struct met {
  key *place;
  int log_size, num;
};

static size_t place_of(const struct met *met, key k)
{
  size_t at = (size_t)(((k ^ k >> 31) * 0x9E3779B97F4A7C15ULL) >> (64 - met->log_size));
  while (met->place[at] != NONE && met->place[at] != k)
    at = (at + 1) & (((size_t)1 << met->log_size) - 1);
  return at;
}

static int met_grow(struct met *met, int log_size)
{
  const struct met old = *met;
  const size_t size = (size_t)1 << log_size;
  met->place = (key *)malloc(sizeof(key) * size);
  if (!met->place) {
    met->place = old.place;
    return 0;
  }
  memset(met->place, 0xff, sizeof(key) * size);
  met->log_size = log_size;
  for (size_t k = 0; old.place && k < (size_t)1 << old.log_size; k++)
    if (old.place[k] != NONE) met->place[place_of(met, old.place[k])] = old.place[k];
  free(old.place);
  return 1;
}

/* Is it new? -1: no memory. */
static int met_add(struct met *met, key k)
{
  const size_t at = place_of(met, k);
  if (met->place[at] == k) return 0; /* NONE too: it meets an empty place */
  met->place[at] = k;
  met->num++;
  if (2 * (size_t)met->num > (size_t)1 << met->log_size && !met_grow(met, met->log_size + 2))
    return -1;
  return 1;
}

/* Move the first of each key to the front; returns how many, -1: no memory. */
static int drop_repeated(key *keys, int n)
{
  struct met met = {NULL, 0, 0};
  int left = 0, is_new = met_grow(&met, 10) ? 0 : -1;
  for (int i = 0; i < n && is_new >= 0; i++) {
    is_new = met_add(&met, keys[i]);
    if (is_new > 0) keys[left++] = keys[i];
  }
  free(met.place);
  return is_new < 0 ? -1 : left;
}

/* By least significant digits of 11 bits; those in which no two keys differ are skipped. */
static int sort_keys(key *keys, int n)
{
  enum { BITS = 11, SIZE = 1 << BITS };
  key *from = keys, *to = (key *)malloc(sizeof(key) * ((size_t)n + 1)), *const room = to,
      differ = 0;
  if (!room) return 0;
  for (int i = 1; i < n; i++) differ |= keys[i] ^ keys[0];
  for (int shift = 0; shift < 64; shift += BITS) {
    int count[SIZE] = {0}, place = 0;
    if (!(differ >> shift & (SIZE - 1))) continue;
    for (int i = 0; i < n; i++) count[from[i] >> shift & (SIZE - 1)]++;
    for (int digit = 0; digit < SIZE; digit++) {
      const int number = count[digit];
      count[digit] = place;
      place += number;
    }
    for (int i = 0; i < n; i++) to[count[from[i] >> shift & (SIZE - 1)]++] = from[i];
    key *const swap = from;
    from = to;
    to = swap;
  }
  if (from != keys) memcpy(keys, from, sizeof(key) * (size_t)n);
  free(room);
  return 1;
}

int keys_unique(unsigned long long *keys, int n)
{
  const int most = omp_get_max_threads(), wanted = 1 + n / GRAIN;
  const int parts = wanted < most ? wanted : most;
  int total = 0, failed = 0;
  int *left = (int *)calloc((size_t)parts, sizeof(int));
  if (!left) return -1;
#define PART(part) ((size_t)n * (size_t)(part) / (size_t)parts)
#pragma omp parallel for schedule(static) num_threads(parts)
  for (int part = 0; part < parts; part++)
    left[part] = drop_repeated(keys + PART(part), (int)(PART(part + 1) - PART(part)));
  for (int part = 0; part < parts; part++) {
    if (left[part] < 0) failed = 1;
    if (failed) break;
    memmove(keys + total, keys + PART(part), sizeof(key) * (size_t)left[part]);
    total += left[part];
  }
#undef PART
  free(left);
  if (failed || !sort_keys(keys, total)) return -1;
  int unique = 0;
  for (int i = 0; i < total; i++)
    if (unique == 0 || keys[i] != keys[unique - 1]) keys[unique++] = keys[i];
  return unique;
}
