/* `compare` and `bless`: the reader of baselines, that of results, and what is written. An input is
 * a baseline and the JSON of up to six runs, with a line "%%" before each of them. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "../../analysis/front/front.h"
#include "fuzz.h"

enum { MARK = 4 /* letters of "\n%%\n" */, MOST_RUNS = 6 };

/* The part up to the next mark; *data moves behind that. */
static size_t part(const uint8_t **data, const uint8_t *end)
{
  const uint8_t *begin = *data, *mark = memmem(begin, (size_t)(end - begin), "\n%%\n", MARK);
  *data = mark ? mark + MARK : end;
  return (size_t)((mark ? mark : end) - begin);
}

/* RESULTS/runs/0.json and so on; those of the input before are gone. */
static void write_runs(const uint8_t *data, const uint8_t *end)
{
  for (int k = 0; k < MOST_RUNS; k++) {
    char name[32];
    snprintf(name, sizeof name, "runs/%d.json", k);
    const uint8_t *run = data;
    const size_t size = part(&data, end);
    const char *path = fuzz_file(name, run, size);
    if (size == 0) unlink(path);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  const uint8_t *end = data + size, *begin = data;
  char *baseline = (char *)fuzz_file("baseline.json", begin, part(&data, end));
  char *results = (char *)fuzz_folder();
  char *compare[] = {"sphbench", "compare", results, baseline, "--json", "-", "--junit", "-", NULL};
  char *bless[] = {"sphbench", "bless", results, baseline, "--reason", "fuzzed", NULL};
  write_runs(data, end);
  (void)verb_compare(4, compare); /* the table */
  (void)verb_compare(8, compare);
  (void)verb_bless(6, bless);
  return 0;
}
