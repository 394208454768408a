/* result_sample.h - a small run, made up, for the tests of result files. */
#ifndef RESULT_SAMPLE_H
#define RESULT_SAMPLE_H
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../core/io/provenance.h"
#include "../../core/io/result_file.h"
#include "../../core/io/run_facts.h"

enum { SAMPLE_MOST = 6, SAMPLE_FRAMES = 3, SAMPLE_STEPS = 20, SAMPLE_DIM = 2 };
static const int sample_count[SAMPLE_FRAMES] = {5, 6, 4};
static const int sample_order[SAMPLE_FRAMES][SAMPLE_MOST] = {
  {4, 2, 0, 1, 3}, {5, 4, 3, 2, 1, 0}, {1, 0, 3, 2}};

/* What particle `label` has in frame k, as the file should give it. */
static double sample_value(const char *name, int k, int label, int component)
{
  if (strcmp(name, "id") == 0) return label;
  if (component >= SAMPLE_DIM) return 0;
  return 0.1 * label + 10 * k + 100 * component + (double)strlen(name);
}

/* Arrays of frame k in the order of the store: `order` sorts them by label. */
struct sample_frame {
  double x[SAMPLE_MOST][SAMPLE_DIM];
  float v[SAMPLE_MOST][SAMPLE_DIM], pressure[SAMPLE_MOST];
  int id[SAMPLE_MOST];
  struct result_array arrays[4];
  struct result_set set;
};

static void sample_fill(struct sample_frame *frame, int k)
{
  const struct result_array arrays[] = {
    {"position", "m", "position", SAMPLE_DIM, RESULT_DOUBLE, frame->x},
    {"velocity", "m/s", "velocity", SAMPLE_DIM, RESULT_FLOAT, frame->v},
    {"pressure", "Pa", "pressure", 1, RESULT_FLOAT, frame->pressure},
    {"id", "1", "label given at the start", 1, RESULT_INT, frame->id}};
  memcpy(frame->arrays, arrays, sizeof arrays);
  for (int row = 0; row < sample_count[k]; row++) {
    const int i = sample_order[k][row];
    for (int d = 0; d < SAMPLE_DIM; d++) {
      frame->x[i][d] = sample_value("position", k, row, d);
      frame->v[i][d] = (float)sample_value("velocity", k, row, d);
    }
    frame->pressure[i] = (float)sample_value("pressure", k, row, 0);
    frame->id[i] = row;
  }
  frame->set = (struct result_set){sample_count[k], sample_order[k], 4, frame->arrays};
}

static status sample_add_frame(struct result_file *file, int k)
{
  struct sample_frame frame;
  const struct fact numbers[] = {{"step", "1", "number of the step", 10 * k, NULL},
                                 {"total_energy", "J", "energy", 2.5 - k, NULL}};
  sample_fill(&frame, k);
  return result_file_add_frame(file, 0.5 * k, &frame.set, 2, numbers);
}

/* Set: the same run on another day, on another machine, with other threads and another speed. */
static int sample_elsewhere;

static void sample_go_elsewhere(struct provenance *provenance, struct fact *phases)
{
  static const char *const argv[] = {"../sphbench", "run"};
  phases[1].value = sample_elsewhere ? 9.5 : 1.5;
  if (!sample_elsewhere) return;
  strcpy(provenance->date, "1999-12-31T23:59:59Z");
  strcpy(provenance->cpu, "another");
  provenance->threads = 7;
  provenance->argc = 2;
  provenance->argv = argv;
}

/* The facts of the sample; everything that they point to is static. */
static struct run_facts sample_facts(enum run_status end)
{
  static double time[SAMPLE_STEPS], gamma[SAMPLE_STEPS], iterations[SAMPLE_STEPS];
  static const struct fact_column series[] = {{"time", "s", "time", time},
                                              {"gamma_mean", "1", "distribution", gamma},
                                              {"iterations", "1", "of the step", iterations}};
  static const struct fact_column steps[] = {{"iterations", "1", "of the step", iterations},
                                             {"residual", "1", "left by the solve", gamma}};
  static struct fact parameters[] = {{"dt", "s", "time step", 0.001, NULL},
                                     {"kernel", "1", "smoothing kernel", 0, "cubic"}};
  static struct fact metrics[] = {{"gamma_mean", "1", "distribution", 0.25, NULL},
                                  {"pressure_error", "1", "against the truth", 0, NULL}};
  static struct fact phases[] = {{"neighbours", "s", "pair lists", 0.5, NULL},
                                 {"solver", "s", "pressure", 1.5, NULL},
                                 {"integrate", "s", "moving", 0.25, NULL},
                                 {"other", "s", "the rest", 0.25, NULL}};
  static const struct fact fields[] = {{"x", "B", "position", 16, NULL},
                                       {"v", "B", "velocity", 8, NULL}};
  static const char *const argv[] = {"sphbench", "run", "sample \xff"};
  static struct provenance provenance;
  provenance_fill(&provenance, 2, 3, argv);
  sample_go_elsewhere(&provenance, phases);
  metrics[1].value = (double)NAN;
  for (int i = 0; i < SAMPLE_STEPS; i++) {
    time[i] = 0.05 * i;
    gamma[i] = i == 7 ? (double)INFINITY : 1.0 / (1 + i);
    iterations[i] = i % 5;
  }
  return (struct run_facts){.scene = "sample-scene",
                            .solver = "sample-solver",
                            .variant = "openmp-2d-f64",
                            .dim = SAMPLE_DIM,
                            .parameters = parameters,
                            .num_parameters = 2,
                            .status = end,
                            .reason = end == RUN_DONE ? NULL : "because it was asked to",
                            .steps = SAMPLE_STEPS,
                            .particles = 4,
                            .walls = 2,
                            .time_end = 1,
                            .iterations = {2, 4, 40},
                            .residual_last = 1e-3,
                            .metrics = metrics,
                            .num_metrics = 2,
                            .series = {SAMPLE_STEPS, 3, series},
                            .per_step = {SAMPLE_STEPS, 2, steps},
                            .timing = {phases, 4, 2.5, 0.125, (double)NAN},
                            .memory = {24, sample_elsewhere ? 1 << 22 : 1 << 20, fields, 2},
                            .provenance = &provenance};
}

/* The whole sample, walls and a virtual set included, into `path`. */
static inline status sample_write(const char *path, enum run_status end)
{
  static const double wall_x[2][SAMPLE_DIM] = {{-1, -2}, {1, -2}};
  const struct result_array wall = {"position", "m", "position", SAMPLE_DIM, RESULT_DOUBLE, wall_x};
  struct run_facts facts = sample_facts(end);
  struct result_file *file;
  status result = result_file_open(&file, path, &facts);
  if (result != OK) return result;
  result = result_file_add_walls(file, &(struct result_set){2, NULL, 1, &wall});
  for (int k = 0; k < SAMPLE_FRAMES && result == OK; k++) {
    facts.series.rows = facts.per_step.rows = 5 * (k + 1);
    result = sample_add_frame(file, k);
    if (result == OK) result = result_file_add_series(file, &facts);
  }
  if (result == OK) result = result_file_add_virtual(file, &(struct result_set){2, NULL, 1, &wall});
  facts.series.rows = facts.per_step.rows = SAMPLE_STEPS;
  if (result == OK) return result_file_finish(file, &facts);
  result_file_discard(file);
  return result;
}

#endif
