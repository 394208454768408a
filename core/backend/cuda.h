/* cuda.h - what the files of the CUDA backend share: failures, and device memory that nobody
 * counts. Everything runs in the default stream, one thing after the other; only copies to the host
 * wait. */
#ifndef CUDA_BACKEND_H
#define CUDA_BACKEND_H
#include "../base/memory.h"
#include "sweep_cuda.h"

/* Is `error` none? The first one is kept, with `what` was done: most calls can tell nobody. */
int works(cudaError_t error, const char *what);

/* Did the kernel start that was launched just now? */
int launched(const char *what);

/* OK, or ERR_RUN with the sentence of the first failure. */
status failed(void);

/* Memory on the GPU; NULL: none left, which the caller tells. */
void *device_take(size_t bytes);
void device_give(void *block);

/* A block that is used again and again, for one thing at a time. Zero-initialise. */
struct room {
  void *data;
  size_t bytes;
};

/* At least so many bytes, with undefined contents; NULL: none left. */
void *room_of(struct room *room, size_t bytes);

/* Make room for `wanted` ints in place of *capacity, of which the first `kept` stay. */
status grow(int **block, size_t *capacity, size_t wanted, size_t kept, const char *what);

/* sorted, order = key, value [n each] in ascending order of the keys, which are >= 0 and have at
 * most so many bits; equal keys keep their order. */
status device_sort_by(const int *key, int *sorted, const int *value, int *order, int n, int bits);

/* before[i] = count[0] + .. + count[i-1] [n] */
status device_sum_before(const int *count, long long *before, int n);

/* keys_unique of neighbours.h, for keys on the GPU */
int device_keys_unique(unsigned long long *keys, int n);
#endif
