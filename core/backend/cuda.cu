/* The backend that keeps particles in a GPU's memory: that memory, and what launches share. */
#include "backend.h"
#include "cuda.h"

#include <math.h>
#include <stdlib.h>

enum {
  SLACK = 64, /* bytes past the end of a block, as on the host */
  JOIN_THREADS = 1024
};

/* --- what failed, and waiting ---------------------------------------------------------------- */

static struct {
  cudaError_t error;
  const char *what;
} failure;

int works(cudaError_t error, const char *what)
{
  if (error != cudaSuccess && failure.error == cudaSuccess) {
    failure.error = error;
    failure.what = what;
  }
  return error == cudaSuccess;
}

int launched(const char *what) { return works(cudaGetLastError(), what); }

status failed(void)
{
  if (failure.error == cudaSuccess) return OK;
  return status_set(ERR_RUN, "the GPU failed in '%s' or shortly before: %s", failure.what,
                    cudaGetErrorString(failure.error));
}

static void settle(void) { works(cudaDeviceSynchronize(), "waiting"); }

__global__ void combine(double *part, int blocks, int largest);

/* Is there a GPU with code for it in this executable? */
static cudaError_t look_for_gpu(void)
{
  int devices = 0;
  struct cudaFuncAttributes kernel;
  const cudaError_t error = cudaGetDeviceCount(&devices);
  if (error != cudaSuccess) return error;
  return devices > 0 ? cudaFuncGetAttributes(&kernel, (const void *)combine) : cudaErrorNoDevice;
}

static const char *reason_of(cudaError_t error)
{
  int driver = 0;
  const cudaError_t asked = cudaDriverGetVersion(&driver);
  return asked == cudaSuccess && driver == 0 ? "no NVIDIA driver" : cudaGetErrorString(error);
}

status backend_check(void)
{
  static int found;
  if (found) return failed();
  const cudaError_t error = look_for_gpu();
  if (error != cudaSuccess)
    return status_set(ERR_SKIPPED,
                      "this variant needs a GPU that it was built for, and found none: %s "
                      "('--backend openmp' needs none)",
                      reason_of(error));
  found = 1;
  clock_settle = settle;
  return OK;
}

/* --- memory ---------------------------------------------------------------------------------- */

static size_t taken, peak;

int memory_poisoned(void)
{
  static int poisoned = -1;
  if (poisoned < 0) poisoned = getenv("SPHBENCH_POISON") != NULL;
  return poisoned;
}

void *device_take(size_t bytes)
{
  void *block = NULL;
  const cudaError_t error = cudaMalloc(&block, bytes + SLACK);
  if (error == cudaErrorMemoryAllocation)
    (void)cudaGetLastError(); /* no failure of the next launch */
  else
    works(error, "cudaMalloc");
  return error == cudaSuccess ? block : NULL;
}

void device_give(void *block) { works(cudaFree(block), "cudaFree"); }

void *memory_take(size_t bytes)
{
  void *block = device_take(bytes);
  if (!block) return NULL;
  taken += bytes;
  if (taken > peak) peak = taken;
  if (memory_poisoned()) memory_poison(block, bytes + SLACK);
  return block;
}

void memory_give(void *block, size_t bytes)
{
  if (!block) return;
  taken -= bytes;
  device_give(block);
}

void memory_poison(void *block, size_t bytes)
{
  works(cudaMemset(block, 0xff, bytes), "memory_poison");
}

static void copy(void *to, const void *from, size_t bytes, enum cudaMemcpyKind kind)
{
  if (bytes > 0) works(cudaMemcpy(to, from, bytes, kind), "cudaMemcpy");
}

void memory_to_host(void *host, const void *block, size_t bytes)
{
  copy(host, block, bytes, cudaMemcpyDeviceToHost);
}

void memory_from_host(void *block, const void *host, size_t bytes)
{
  copy(block, host, bytes, cudaMemcpyHostToDevice);
}

void memory_copy(void *to, const void *from, size_t bytes)
{
  copy(to, from, bytes, cudaMemcpyDeviceToDevice);
}

size_t memory_taken(void) { return taken; }
size_t memory_peak(void) { return peak; }

void *room_of(struct room *room, size_t bytes)
{
  if (bytes <= room->bytes && room->data) return room->data;
  device_give(room->data);
  room->bytes = bytes + bytes / 4;
  room->data = device_take(room->bytes);
  if (!room->data) room->bytes = 0;
  return room->data;
}

status grow(int **block, size_t *capacity, size_t wanted, size_t kept, const char *what)
{
  if (wanted <= *capacity) return OK;
  const size_t room = wanted + wanted / 8;
  int *more = (int *)device_take(sizeof(int) * room);
  if (!more) return status_set(ERR_MEMORY, "no memory on the GPU for %zu %s", wanted, what);
  if (kept > 0) memory_copy(more, *block, sizeof(int) * kept);
  device_give(*block);
  *block = more;
  *capacity = room;
  return OK;
}

/* --- sweeps and reductions ------------------------------------------------------------------- */

static cudaEvent_t begun, ended; /* of the launch that is being timed */

static int timed(void)
{
  static int asked = -1;
  if (asked < 0)
    asked = getenv("SPHBENCH_STAGE_TIMES") && works(cudaEventCreate(&begun), "timing") &&
            works(cudaEventCreate(&ended), "timing");
  return asked;
}

void launch_begin(struct stage_clock *stage)
{
  stage_begin(stage);
  if (timed()) works(cudaEventRecord(begun), "timing");
}

void launch_end(struct stage_clock *stage, int count)
{
  launched(stage->name);
  stage->calls++;
  stage->items += count;
  if (!timed()) return;
  float milliseconds = 0;
  works(cudaEventRecord(ended), "timing");
  works(cudaEventSynchronize(ended), stage->name);
  works(cudaEventElapsedTime(&milliseconds, begun, ended), "timing");
  stage->seconds += 1e-3 * (double)milliseconds;
}

double *reduce_room(int blocks)
{
  static struct room room;
  return (double *)room_of(&room, sizeof(double) * ((size_t)blocks + 1));
}

template <bool largest> __device__ static void combine_in(double *part, int blocks)
{
  double a = largest ? -1e300 : 0;
  for (int k = (int)threadIdx.x; k < blocks; k += JOIN_THREADS) a = reduce_two<largest>(a, part[k]);
  a = reduce_block<largest, JOIN_THREADS>(a);
  if (threadIdx.x == 0) part[blocks] = a;
}

/* part[blocks] = all of part[0 .. blocks-1]. Of one block, so that the order is fixed. */
__global__ void __launch_bounds__(JOIN_THREADS) combine(double *part, int blocks, int largest)
{
  if (largest)
    combine_in<true>(part, blocks);
  else
    combine_in<false>(part, blocks);
}

double reduce_blocks(double *part, int blocks, int largest)
{
  double all = (double)NAN;
  if (!part) {
    works(cudaErrorMemoryAllocation, "a reduction");
    return all;
  }
  combine<<<1, JOIN_THREADS>>>(part, blocks, largest);
  if (launched("combine")) memory_to_host(&all, part + blocks, sizeof all);
  return failed() == OK ? all : (double)NAN;
}
