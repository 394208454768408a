/* `compare` and `bless`: the reader of baselines, that of results, and what is written. An input is
 * a baseline, a line "%%" and the JSON of a run. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <string.h>

#include "../../analysis/front/front.h"
#include "fuzz.h"

enum { MARK = 4 }; /* letters of "\n%%\n" */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  const uint8_t *mark = memmem(data, size, "\n%%\n", MARK);
  const size_t first = mark ? (size_t)(mark - data) : size;
  const uint8_t *run = mark ? mark + MARK : data;
  char *baseline = (char *)fuzz_file("baseline.json", data, first);
  char *result = (char *)fuzz_file("run.json", run, mark ? size - first - MARK : size);
  char *compare[] = {"sphbench", "compare", result, baseline, "--json", "-", "--junit", "-", NULL};
  char *bless[] = {"sphbench", "bless", result, baseline, "--reason", "fuzzed", NULL};
  (void)verb_compare(4, compare); /* the table */
  (void)verb_compare(8, compare);
  (void)verb_bless(6, bless);
  return 0;
}
