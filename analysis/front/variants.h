/* variants.h - the executables behind this command: one per backend, dimension and precision. */
#ifndef VARIANTS_H
#define VARIANTS_H
#include "files.h"

struct variant {
  const char *backend, *precision; /* "openmp", "f64" */
  int dim;
};

/* Every variant that can be built. */
enum { NUM_VARIANTS = 8 };
struct variant variant_number(int k);

/* What --backend, --dim and --precision of a command line ask for, beginning from *v. ERR_USER: a
 * word that is not allowed. */
status variant_choose(int argc, char **argv, struct variant *v);

/* "openmp-2d-f64" and what that means. */
struct path variant_name(const struct variant *v);
struct path variant_about(const struct variant *v);

/* Its executable. ERR_USER: it is not built; ERR_SKIPPED: no CUDA variant is. */
status variant_executable(const struct variant *v, struct path *executable);

/* Any variant that is built, `wanted` if it is; ERR_USER: none. All know the same names. */
status variant_any(const struct variant *wanted, struct variant *found);

/* The program sphbench-analysis-NAME of a figure. ERR_USER: it is not built. */
status program_executable(const char *name, struct path *executable);

/* Where the recipes of figures and the reference data lie: <this>/paper-figures, ... */
struct path data_folder(void);

#endif
