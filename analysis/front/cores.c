#include "cores.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#ifdef SPHBENCH_HAVE_HWLOC
#include <hwloc.h>
#endif

/* --- which there are --- */

static void take_processor(struct cores *cores, int processor, const cpu_set_t *mine)
{
  if (processor < 0 || processor >= CPU_SETSIZE || !CPU_ISSET(processor, mine)) return;
  if (cores->n < MOST_CORES) cores->processor[cores->n++] = processor;
}

#ifdef SPHBENCH_HAVE_HWLOC
/* Of each core the first processor that this process may use. */
static void find_cores(struct cores *cores, const cpu_set_t *mine)
{
  hwloc_topology_t topology;
  if (hwloc_topology_init(&topology)) return;
  const int n =
    hwloc_topology_load(topology) ? 0 : hwloc_get_nbobjs_by_type(topology, HWLOC_OBJ_CORE);
  for (int k = 0; k < n; k++) {
    const hwloc_obj_t core = hwloc_get_obj_by_type(topology, HWLOC_OBJ_CORE, (unsigned)k);
    int processor = hwloc_bitmap_first(core->cpuset);
    while (processor >= 0 && !CPU_ISSET(processor, mine))
      processor = hwloc_bitmap_next(core->cpuset, processor);
    take_processor(cores, processor, mine);
  }
  hwloc_topology_destroy(topology);
}
#else
static void find_cores(struct cores *cores, const cpu_set_t *mine) { (void)cores, (void)mine; }
#endif

/* --- what happens on them: /proc/stat, proc(5) --- */

/* Seconds in which each processor was busy. */
static void read_busy(double *busy)
{
  const double tick = 1.0 / (double)sysconf(_SC_CLK_TCK);
  char line[512];
  FILE *file = fopen("/proc/stat", "r");
  while (file && fgets(line, sizeof line, file)) {
    int cpu;
    double user, nice, system, idle, wait, irq, soft, steal;
    if (sscanf(line, "cpu%d %lf %lf %lf %lf %lf %lf %lf %lf", &cpu, &user, &nice, &system, &idle,
               &wait, &irq, &soft, &steal) == 9 &&
        cpu >= 0 && cpu < CPU_SETSIZE)
      busy[cpu] = tick * (user + nice + system + irq + soft + steal);
  }
  if (file) fclose(file);
}

double cores_busy_seconds(void)
{
  double busy[CPU_SETSIZE] = {0}, sum = 0;
  cpu_set_t mine;
  if (sched_getaffinity(0, sizeof mine, &mine)) return 0;
  read_busy(busy);
  for (int k = 0; k < CPU_SETSIZE; k++)
    if (CPU_ISSET(k, &mine)) sum += busy[k];
  return sum;
}

static void sort_by(struct cores *cores, const double *busy)
{
  for (int i = 1; i < cores->n; i++) {
    const int one = cores->processor[i];
    int j = i;
    for (; j > 0 && busy[cores->processor[j - 1]] > busy[one]; j--)
      cores->processor[j] = cores->processor[j - 1];
    cores->processor[j] = one;
  }
}

struct cores cores_idle_first(void)
{
  const struct timespec pause = {.tv_nsec = 200 * 1000 * 1000};
  double before[CPU_SETSIZE] = {0}, busy[CPU_SETSIZE] = {0};
  struct cores cores = {.n = 0};
  cpu_set_t mine;
  if (sched_getaffinity(0, sizeof mine, &mine)) return cores;
  find_cores(&cores, &mine);
  if (cores.n == 0)
    for (int k = 0; k < CPU_SETSIZE; k++) take_processor(&cores, k, &mine);
  read_busy(before);
  nanosleep(&pause, NULL);
  read_busy(busy);
  for (int k = 0; k < CPU_SETSIZE; k++) busy[k] -= before[k];
  sort_by(&cores, busy);
  return cores;
}

void cores_text(const struct cores *cores, int count, char *text, size_t size)
{
  size_t at = 0;
  *text = '\0';
  for (int k = 0; k < count && k < cores->n && at < size; k++)
    at += (size_t)snprintf(text + at, size - at, "%s%d", k ? "," : "", cores->processor[k]);
}
