/* benchmark.h - the contract of a scene: where the particles are, what is asked of a solver, and
 * what is true. */
#ifndef BENCHMARK_H
#define BENCHMARK_H
#include "metric.h"
#include "scene/scene.h"
#include "solver.h"
#ifdef __cplusplus
extern "C" {
#endif

struct benchmark {
  const char *name;   /* REQUIRED: as users type it */
  const char *about;  /* REQUIRED: one line */
  const char *source; /* REQUIRED: citation */
  unsigned asks; /* REQUIRED: CAN(..) that every run of it needs; GRAVITY, XSPH, WALLS are added
                    from what build made */
  unsigned dims; /* REQUIRED: CAN(2D) | CAN(3D); the lower one is the default */
  unsigned
    measures[2]; /* REQUIRED: bits (1 << METRIC_..) of the scene's own metrics, in words of 32 */
  const struct param *params; /* its own, besides the common ones of scene.h */
  int num_params;
  size_t
    state_size; /* of `self`, which begins with its params; no pointers: it is saved as it is */
  /* The common parameters' defaults for this scene (dt, t_end, spacing, support, ...), before the
   * user's. Optional. */
  void (*defaults)(struct scene_params *common);
  /* Fill the scene. REQUIRED. */
  status (*build)(struct scene *scene, void *self);
  /* Prescribed motion: called before every step with the time at its end; may set velocities.
   * Optional. */
  void (*drive)(struct scene *scene, const void *self, struct particles p, double time);
  /* The scene's errors against its truth, called at every sample; `out` keeps NaN where it has
   * none. Optional. */
  void (*measure)(void *self, const struct snapshot *now, struct measures *out);
  int projection; /* one projection of v at fixed x, in place of time integration (needs
                     CAN(PROJECT)) */
  /* METRIC_.. that is the error of a run against the truth. 0: of the errors that it measures
   * trajectory_error, else velocity_error, else the first one. Optional. */
  int judged_by;
};
/* Both words of `measures`, from LIST(M, word) = M(word, name) | M(word, name) ...: right wherever
 * a metric stands in its table. */
#define MEASURES_IN(word, name) (METRIC_##name / 32 == (word) ? 1u << (METRIC_##name % 32) : 0u)
#define MEASURES_OF(LIST)                      \
  {                                            \
    LIST(MEASURES_IN, 0), LIST(MEASURES_IN, 1) \
  }

#define BENCHMARK(name) extern const struct benchmark benchmark_##name;
#include "../benchmarks/benchmarks.def"
#undef BENCHMARK

#ifdef __cplusplus
}
#endif
#endif
