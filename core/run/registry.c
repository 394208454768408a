/* The solvers and scenes of this executable, and the solvers that plug-ins have added. */
#include <string.h>

#include "driver.h"
#include "plugins.h"

#define SOLVER(name) &solver_##name,
const struct solver *const solvers[] = {
#include "../../solvers/solvers.def"
};
#undef SOLVER
#define BENCHMARK(name) &benchmark_##name,
const struct benchmark *const benchmarks[] = {
#include "../../benchmarks/benchmarks.def"
};
#undef BENCHMARK
const int num_solvers = COUNT(solvers), num_benchmarks = COUNT(benchmarks);

enum { MOST_PLUGINS = 16 };
static struct {
  const struct solver *solver;
  char file[4096];
} plugin[MOST_PLUGINS];
static int num_plugins;

int solver_count(void) { return num_solvers + num_plugins; }

const struct solver *solver_number(int k)
{
  return k < num_solvers ? solvers[k] : plugin[k - num_solvers].solver;
}

status solver_add(const struct solver *solver, const char *file)
{
  if (num_plugins == MOST_PLUGINS)
    return user_error("--plugin: more than %d of them", MOST_PLUGINS);
  plugin[num_plugins].solver = solver;
  strncpy(plugin[num_plugins].file, file, sizeof plugin->file - 1);
  num_plugins++;
  return OK;
}

const char *plugin_file(const struct solver *solver)
{
  for (int k = 0; k < num_plugins; k++)
    if (plugin[k].solver == solver) return plugin[k].file;
  return NULL;
}

const struct solver *solver_find(const char *name)
{
  for (int k = 0; k < solver_count(); k++)
    if (strcmp(solver_number(k)->name, name) == 0) return solver_number(k);
  return NULL;
}

const struct benchmark *benchmark_find(const char *name)
{
  for (int k = 0; k < num_benchmarks; k++)
    if (strcmp(benchmarks[k]->name, name) == 0) return benchmarks[k];
  return NULL;
}
