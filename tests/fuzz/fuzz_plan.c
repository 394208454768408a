/* The reader of plans, and the runs that they become. */
#include "../../analysis/front/plan.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static char *const names[] = {"dfsph", "sisph", "wcsph"};
  const struct names solvers = {(char **)names, 3};
  struct plan *plan;
  struct queue queue = {.results = fuzz_folder(), .journal = {.file = -1}};
  if (plan_read(fuzz_file("plan.yaml", data, size), &plan) != OK) return 0;
  (void)plan_expand(plan, &solvers, &queue);
  queue_close(&queue);
  plan_free(plan);
  return 0;
}
