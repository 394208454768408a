/* Sorting and counting on a GPU by CUB. Its headers are slow to compile: this is the only file that
 * includes them, compiled once for all variants. */
#include "cuda.h"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cub/device/device_select.cuh>

/* Call one of CUB's algorithms, given as call(room, &bytes): first for the room that it needs, then
 * to do its work. */
template <class F> static status with_room(const char *what, F call)
{
  static struct room room;
  size_t bytes = 0;
  if (!works(call((void *)NULL, bytes), what)) return failed();
  void *data = room_of(&room, bytes + 1);
  if (!data)
    return status_set(ERR_MEMORY, "no memory on the GPU for '%s' (%zu bytes)", what, bytes);
  return works(call(data, bytes), what) ? OK : failed();
}

status device_sort_by(const int *key, int *sorted, const int *value, int *order, int n, int bits)
{
  return with_room("sort", [=](void *room, size_t &bytes) {
    return cub::DeviceRadixSort::SortPairs(room, bytes, key, sorted, value, order, n, 0, bits);
  });
}

status device_sum_before(const int *count, long long *before, int n)
{
  return with_room("sum", [=](void *room, size_t &bytes) {
    return cub::DeviceScan::ExclusiveScan(room, bytes, count, before, ::cuda::std::plus<>{}, 0LL,
                                          n);
  });
}

/* keys[0 .. *number-1] = the keys without repetitions, in ascending order */
static status sort_and_drop(unsigned long long *keys, int n, unsigned long long *sorted,
                            int *number)
{
  TRY(with_room("keys_unique", [=](void *room, size_t &bytes) {
    return cub::DeviceRadixSort::SortKeys(room, bytes, keys, sorted, n);
  }));
  return with_room("keys_unique", [=](void *room, size_t &bytes) {
    return cub::DeviceSelect::Unique(room, bytes, sorted, keys, number, n);
  });
}

int device_keys_unique(unsigned long long *keys, int n)
{
  const unsigned long long none = ~0ULL;
  static struct room sorted_room, number_room;
  if (n <= 0) return n;
  void *const sorted = room_of(&sorted_room, sizeof *keys * (size_t)n);
  int *const number = (int *)room_of(&number_room, sizeof(int)), unique = 0;
  if (!sorted || !number) return -1;
  if (sort_and_drop(keys, n, (unsigned long long *)sorted, number) != OK) return -1;
  memory_to_host(&unique, number, sizeof unique);
  if (failed() != OK) return -1;
  unsigned long long last = none;
  memory_to_host(&last, keys + unique - 1, sizeof last);
  return last == none ? unique - 1 : unique;
}
