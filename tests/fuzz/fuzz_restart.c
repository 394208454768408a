/* `run --restart FILE`: what a run takes from a file, and the steps that follow. An input is edits
 * of a sound file. */
#include <stdio.h>
#include <stdlib.h>

#include "../../core/run/driver.h"
#include "edits.h"
#include "fuzz.h"

/* HDF5 1.10 loses memory of its own when it gives up on a damaged file; ours is still looked at. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) { return "leak:libhdf5"; }

/* Two drops of few particles, with walls, a body and two fluids. */
static const char scene[] = "name: fuzzed\n"
                            "dim: 2\n"
                            "params: {spacing: 0.25, dt: 0.001, t_end: 0.004}\n"
                            "fluid:\n"
                            "  - box: {low: [0, 0], high: [0.75, 0.5]}\n"
                            "  - box: {low: [0, 0.5], high: [0.5, 0.75]}\n"
                            "    rho0: 800\n"
                            "walls:\n"
                            "  - box: {low: [0, 0], high: [2, 2], layers: 1}\n"
                            "bodies:\n"
                            "  - box: {low: [1, 1], high: [1.5, 1.25]}\n"
                            "    density: 500\n";

struct paths {
  const char *scene;
  char restart[128], out[128];
};

/* Run the scene to `t_end`, from the file or from its start with a file written in each step. */
static status run(struct paths *p, const char *t_end, int restart, int writes)
{
  char *words[] = {"sphbench", "run",         (char *)p->scene, "--solver", "dfsph", "--quiet",
                   "--frames", "1",           "--threads",      "1",        "-o",    p->out,
                   "--t-end",  (char *)t_end, "--checkpoint",   "0",        NULL};
  struct options o;
  if (restart) {
    words[14] = "--restart";
    words[15] = p->restart;
  }
  TRY(options_parse(&o, 16, words));
  if (!writes) o.output = NULL;
  return verb_run(&o);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static struct paths paths;
  static struct fuzz_bytes sound;
  if (!sound.data) {
    paths.scene = fuzz_file("scene.yaml", scene, sizeof scene - 1);
    snprintf(paths.out, sizeof paths.out, "%s/out.vtkhdf", fuzz_folder());
    snprintf(paths.restart, sizeof paths.restart, "%s/out.restart", fuzz_folder());
    if (run(&paths, "0.002", 0, 1) != OK) abort();
    sound = fuzz_read(paths.restart);
  }
  fuzz_file("out.restart", sound.data, sound.size);
  edits_apply(paths.restart, data, size);
  const int writes = size % 4 == 0; /* a result file takes most of the time */
  (void)run(&paths, "0.004", 1, writes);
  return 0;
}
