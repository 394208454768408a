/* study_file.h - benchmarks/precision/SCENE.yaml: which sizes, steps and tolerances of a scene are
 * worth a sweep (docs/precision.md). A scene without such a file gets rules that fit any. */
#ifndef STUDY_FILE_H
#define STUDY_FILE_H
#include "study.h"

struct study_sweep {
  double t_end;
  double *spacing, *dt, *tolerance;
  unsigned num_spacing, num_dt, num_tolerance;
};

struct study_file {
  char *scene;
  char **set; /* KEY=VALUE, for every run */
  unsigned num_set;
  struct study_sweep full, quick; /* of precision */
  struct study_sweep levels;      /* of convergence: spacing */
  double jitter;                  /* of its disturbed starts [dx] */
};

/* Read it, if there is one, and fill study->plan, levels and jitter. ERR_USER with file, line and
 * column. */
status study_file_read(struct study *study);

#endif
