/* The reader of result files, with all that it can be asked for, and the frames of a figure. An
 * input of more than LONGEST_EDITS bytes is a file as it stands, a shorter one edits of a sound
 * one. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../analysis/front/figure.h"
#include "../../core/io/h5.h"
#include "../../core/io/result_read.h"
#include "../unit/result_sample.h"
#include "edits.h"
#include "fuzz.h"

/* HDF5 1.10 loses memory of its own when it gives up on a damaged file; ours is still looked at. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) { return "leak:libhdf5"; }

#define RESULT "runs/run.vtkhdf"
enum { LONGEST_EDITS = 1024 }; /* no HDF5 file is as short */

static void touch(struct result_numbers *n)
{
  volatile double sum = 0;
  for (long i = 0; i < n->rows * n->components; i++) sum = sum + n->values[i];
  free(n->values);
}

struct reading {
  struct result_read *file;
  const char *group;
};

static void read_one(const char *name, void *self)
{
  const struct reading *reading = self;
  struct result_numbers numbers;
  char path[300], text[40];
  double number;
  snprintf(path, sizeof path, "%s/%s", reading->group, name);
  if (result_read_series(reading->file, path, &numbers) == OK) touch(&numbers);
  (void)result_read_number(reading->file, path, &number);
  (void)result_read_text(reading->file, path, text, sizeof text);
}

static void read_array(const char *name, void *self)
{
  const struct reading *reading = self;
  struct result_numbers numbers;
  for (long k = 0; k < result_read_frames(reading->file) && k < 4; k++)
    if (result_read_array(reading->file, k, name, &numbers) == OK) touch(&numbers);
}

static void read_all(struct result_read *file)
{
  static const char *const groups[] = {"metrics", "metrics/steps",  "metrics/final",
                                       "run",     "run/parameters", "walls"};
  char text[40];
  for (size_t k = 0; k < sizeof groups / sizeof *groups; k++) {
    struct reading reading = {file, groups[k]};
    (void)result_read_names(file, groups[k], read_one, &reading);
  }
  struct reading reading = {file, "VTKHDF/PointData"};
  read_array("position", &reading);
  (void)result_read_names(file, "VTKHDF/PointData", read_array, &reading);
  (void)result_read_text(file, "scene", text, sizeof text);
  (void)result_read_text(file, "status", text, sizeof text);
}

static void draw(const char *colour)
{
  double times[] = {0, 0.5}, windows[] = {0, 1, 0, 1}, colours[] = {0, 1};
  struct recipe recipe = {.name = "fuzzed",
                          .extract = {.times = times, .num_times = 2, .colour = (char *)colour},
                          .windows = windows,
                          .num_windows = 4,
                          .colours = colours,
                          .num_colours = 2};
  struct figure_case one = {.label = "run"};
  struct figure figure = {.recipe = &recipe, .cases = &one, .n = 1, .files = json_array()};
  struct run run = {.id = "run", .finished = 1, .outcome = OUTCOME_OK};
  const struct queue queue = {.run = &run, .n = 1, .results = fuzz_folder()};
  FILE *contents = fopen("/dev/null", "w");
  figure.data = path_of("%s", fuzz_folder());
  if (contents) (void)extract_frames(&figure, &queue, contents);
  if (contents) fclose(contents);
  json_decref(figure.files);
}

static const char *make_file(const uint8_t *data, size_t size)
{
  static char sound[128];
  static struct fuzz_bytes sample;
  if (size > LONGEST_EDITS) return fuzz_file(RESULT, data, size);
  if (!sample.data) {
    snprintf(sound, sizeof sound, "%s/sound.vtkhdf", fuzz_folder());
    if (sample_write(sound, RUN_DONE) != OK) abort();
    sample = fuzz_read(sound);
  }
  const char *path = fuzz_file(RESULT, sample.data, sample.size);
  edits_apply(path, data, size);
  return path;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct result_read *file;
  h5_start();
  if (result_read_open(&file, make_file(data, size)) != OK) return 0;
  read_all(file);
  result_read_close(file);
  draw("speed");
  draw("pressure");
  return 0;
}
