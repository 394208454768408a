/* The solvers and scenes of this executable. */
#include <string.h>

#include "driver.h"

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

const struct solver *solver_find(const char *name)
{
  for (int k = 0; k < num_solvers; k++)
    if (strcmp(solvers[k]->name, name) == 0) return solvers[k];
  return NULL;
}

const struct benchmark *benchmark_find(const char *name)
{
  for (int k = 0; k < num_benchmarks; k++)
    if (strcmp(benchmarks[k]->name, name) == 0) return benchmarks[k];
  return NULL;
}
