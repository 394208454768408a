#include "provenance.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#include "h5.h"
#include "provenance_build.h"

/* "model name : Some CPU" on x86; ARM kernels give no name in words. */
static void find_cpu(char *model, size_t size)
{
  char line[256];
  snprintf(model, size, "unknown");
  FILE *file = fopen("/proc/cpuinfo", "r");
  if (!file) return;
  while (fgets(line, sizeof line, file)) {
    const char *value = strchr(line, ':');
    if (strncmp(line, "model name", strlen("model name")) != 0 || !value) continue;
    value += 1 + strspn(value + 1, " ");
    snprintf(model, size, "%.*s", (int)strcspn(value, "\n"), value);
    break;
  }
  fclose(file);
}

static void find_date(char *date, size_t size)
{
  const time_t now = time(NULL);
  struct tm utc;
  if (!gmtime_r(&now, &utc) || !strftime(date, size, "%Y-%m-%dT%H:%M:%SZ", &utc))
    snprintf(date, size, "unknown");
}

void provenance_add_library(struct provenance *p, const char *name, const char *version)
{
  const int room = (int)(sizeof p->libraries / sizeof *p->libraries);
  if (p->num_libraries == room) return;
  snprintf(p->libraries[p->num_libraries][0], sizeof p->libraries[0][0], "%s", name);
  snprintf(p->libraries[p->num_libraries][1], sizeof p->libraries[0][1], "%s", version);
  p->num_libraries++;
}

static void add_libraries(struct provenance *p)
{
  unsigned major = 0, minor = 0, release = 0;
  char version[40];
  h5_start();
  H5get_libversion(&major, &minor, &release);
  snprintf(version, sizeof version, "%u.%u.%u", major, minor, release);
  provenance_add_library(p, "hdf5", version);
  provenance_add_library(p, "jansson", JANSSON_VERSION);
}

void provenance_fill(struct provenance *p, int threads, int argc, const char *const *argv)
{
  *p = (struct provenance){.commit = SPHBENCH_COMMIT,
                           .compiler = SPHBENCH_COMPILER,
                           .flags = SPHBENCH_FLAGS,
                           .dirty = SPHBENCH_DIRTY,
                           .threads = threads,
                           .argc = argc,
                           .argv = argv};
  find_cpu(p->cpu, sizeof p->cpu);
  find_date(p->date, sizeof p->date);
  add_libraries(p);
}

long provenance_peak_rss(void)
{
  struct rusage usage;
  return getrusage(RUSAGE_SELF, &usage) ? 0 : usage.ru_maxrss * 1024; /* Linux counts in KiB */
}
