/* `sphbench doctor`: what is installed and built, and how quiet the machine is. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include "../../core/base/sorted.h"
#include "../../core/base/clock.h"
#include "../../core/io/provenance.h"
#include "arguments.h"
#include "front.h"
#include "process.h"
#include "runs.h"
#include "variants.h"

struct tool {
  const char *name, *argv[5], *for_what;
};
static const struct tool tools[] = {
  {"gnuplot", {"gnuplot", "--version"}, "draws the figures"},
  {"GSL", {"pkg-config", "--modversion", "gsl"}, "exact solutions to compare with"},
  {"cyaml", {"pkg-config", "--modversion", "libcyaml"}, "scene files and recipes"},
  {"jansson", {"pkg-config", "--modversion", "jansson"}, "results for machines"},
  {"cmocka", {"pkg-config", "--modversion", "cmocka"}, "tests"},
  {"h5py",
   {"/usr/bin/python3", "-c", "import h5py; print(h5py.__version__)"},
   "reading results in Python"},
  {"VTK",
   {"/usr/bin/python3", "-c", "import vtk; print(vtk.vtkVersion().GetVTKVersion())"},
   "test of the result files"},
  {"nvcc", {"sh", "-c", "nvcc --version | sed -n 's/.*release //p'"}, "builds the CUDA variants"},
};

static void print_first_line(const char *name, char *text, const char *otherwise)
{
  if (text) text[strcspn(text, "\n")] = '\0';
  printf("  %-12s %s\n", name, text && *text ? text : otherwise);
  free(text);
}

static void print_tools(void)
{
  struct provenance p;
  printf("installed:\n");
  for (size_t k = 0; k < sizeof tools / sizeof *tools; k++) {
    const struct path missing = path_of("missing (%s)", tools[k].for_what);
    print_first_line(tools[k].name, process_output(tools[k].argv), missing.text);
  }
  provenance_fill(&p, 1, 0, NULL);
  for (int k = 0; k < p.num_libraries; k++)
    if (strcmp(p.libraries[k][0], "hdf5") == 0) printf("  %-12s %s\n", "HDF5", p.libraries[k][1]);
  printf("built: %s, commit %.12s%s\n", p.compiler, p.commit, p.dirty ? " with changes" : "");
}

static void print_variants(void)
{
  printf("variants:\n");
  for (int k = 0; k < NUM_VARIANTS; k++) {
    const struct variant v = variant_number(k);
    const struct path name = variant_name(&v);
    struct path unused;
    printf("  %-16s %s\n", name.text,
           variant_executable(&v, &unused) == OK ? "built" : "not built");
  }
}

static void print_machine(void)
{
  static const char *const gpu[] = {"nvidia-smi", "--query-gpu=name", "--format=csv,noheader",
                                    NULL};
  struct provenance p;
  struct sysinfo memory;
  double load[3] = {0, 0, 0};
  provenance_fill(&p, 1, 0, NULL);
  printf("machine:\n  %-12s %s\n", "CPU", p.cpu);
  print_first_line("GPU", process_output(gpu), "none");
  printf("  %-12s %d for this program, %ld in the machine\n", "cores", processors(),
         sysconf(_SC_NPROCESSORS_ONLN));
  if (sysinfo(&memory) == 0)
    printf("  %-12s %.1f GiB\n", "memory",
           (double)memory.totalram * memory.mem_unit / (1024.0 * 1024 * 1024));
  if (getloadavg(load, 3) == 3)
    printf("  %-12s %.2f in the last minute, %.2f in the last five%s\n", "load", load[0], load[1],
           load[0] > 0.5 ? ": times measured now are not to be trusted" : "");
}

/* About a millisecond of work that the compiler cannot leave out. */
static double equal_work(void)
{
  const double begun = clock_now();
  volatile double sum = 0;
  for (int k = 0; k < 400000; k++) sum = sum + 1.0;
  return clock_now() - begun;
}

static void print_clock(void)
{
  enum { TIMES = 200 };
  double took[TIMES], step = 1;
  for (int k = 0; k < 1000; k++) {
    const double now = clock_now();
    double then = now;
    while (!(then > now)) then = clock_now();
    if (then - now < step) step = then - now;
  }
  for (int k = 0; k < TIMES; k++) took[k] = equal_work();
  sort_numbers(took, TIMES);
  const double median = took[TIMES / 2];
  printf("clock:\n  %-12s %.0f ns\n", "resolution", 1e9 * step);
  printf("  %-12s %.1f %% between quartiles, slowest %.0f %% over the median of %d equal pieces of "
         "%.2g ms\n",
         "noise", 100 * (took[3 * TIMES / 4] - took[TIMES / 4]) / median,
         100 * (took[TIMES - 1] / median - 1), TIMES, 1e3 * median);
}

status verb_doctor(int argc, char **argv)
{
  const struct arguments what = {"doctor", NULL, 0, NULL, 0, NULL};
  TRY(arguments_parse(&what, argc, argv));
  print_tools();
  print_variants();
  print_machine();
  print_clock();
  return OK;
}
