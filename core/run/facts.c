#include "facts.h"

#include <math.h>
#include <string.h>

#include "../scene/scene_file.h"
#include "plugins.h"

/* Does this scene report the metric? The general ones always, a scene's own only if it measures
 * them. */
static int reported(const struct plan *plan, int metric)
{
  if (metric < NUM_GENERAL_METRICS) return 1;
  const struct benchmark *b = plan->setting.benchmark;
  return b && (b->measures[metric / 32] >> (metric % 32) & 1u);
}

void facts_start(struct facts *f, const struct options *o, const struct plan *plan,
                 const struct run *run, int threads)
{
  memset(f, 0, sizeof *f);
  provenance_fill(&f->provenance, threads, o->argc, (const char *const *)o->argv);
  plugin_report(run->solver, &f->provenance);
  f->run.provenance = &f->provenance;
  f->run.scene = plan->setting.benchmark ? o->name : scene_file_name(plan->setting.file);
  f->run.solver = run->solver->name;
  f->run.variant = SPHBENCH_VARIANT;
  f->run.dim = DIM;
  f->run.parameters = plan->parameters;
  f->run.num_parameters = plan->num_parameters;
  f->run.status = RUN_RUNNING;
  f->run.particles = run->view->p.n;
  f->run.walls = run->view->p.n_all - run->view->p.n;
  for (int d = 0; d < DIM; d++) f->run.period[d] = (double)run->scene.period.c[d];
  run_warnings(run, &f->warnings);
  f->run.warnings = f->warnings.list;
  f->run.num_warnings = f->warnings.n;
  f->run.residual_last = NAN;
}

static void add_series(struct facts *f, const char *name, const char *unit, const char *about,
                       const double *values)
{
  const int k = f->run.series.num_columns++;
  f->series[k] = (struct fact_column){name, unit, about, values};
}

void facts_update(struct facts *f, const struct plan *plan, const struct run *run,
                  const struct record *r)
{
  f->run.particles = run->view->p.n;
  f->run.steps = run->step;
  f->run.time_end = run->time;
  f->run.series.columns = f->series;
  f->run.series.num_columns = 0;
  f->run.series.rows = r->rows;
  add_series(f, "time", "s", "simulated time", r->sample[SAMPLE_TIME]);
  for (int k = 0; k < NUM_METRICS; k++)
    if (reported(plan, k))
      add_series(f, metric_names[k], metric_units[k], metric_about[k], r->sample[k]);
  add_series(f, "iterations", "1", "mean per step since the sample before",
             r->sample[SAMPLE_ITERATIONS]);
  add_series(f, "residual", "1", "relative residual of the last step", r->sample[SAMPLE_RESIDUAL]);
  static const char *const names[3][3] = {{"time", "s", "simulated time"},
                                          {"iterations", "1", "iterations of the step"},
                                          {"residual", "1", "relative residual of the step"}};
  for (int k = 0; k < 3; k++)
    f->steps[k] = (struct fact_column){names[k][0], names[k][1], names[k][2], r->step[k]};
  f->run.per_step.rows = r->steps;
  f->run.per_step.num_columns = 3;
  f->run.per_step.columns = f->steps;
}

static void end_iterations(struct facts *f, const struct run *run, const struct record *r)
{
  const double steps = run->step > 0 ? (double)run->step : 1;
  long total = 0, most = 0;
  for (int k = 0; k < run->num_iterations; k++) {
    const struct iterations *it = &run->iterations[k];
    total += it->total;
    f->run.iterations.solve[k] = (struct fact_solve){
      it->what, (double)it->total / steps, it->most, it->total, it->solves, it->capped};
  }
  f->run.iterations.num_solves = run->num_iterations;
  for (long k = 0; k < r->steps; k++)
    if (r->step[1][k] > (double)most) most = (long)r->step[1][k];
  f->run.iterations.total = total;
  f->run.iterations.max = most;
  f->run.iterations.mean = (double)total / steps;
  if (run->num_iterations > 0) f->run.residual_last = run->step_residual;
}

static void end_memory(struct facts *f, const struct run *run)
{
  const double n = run->view->p.n > 0 ? run->view->p.n : 1;
  f->run.memory.bytes_per_particle = run_bytes_per_particle(run);
  f->run.memory.peak_rss_bytes = provenance_peak_rss();
  f->run.memory.fields = f->fields;
  for (int k = 0; k < run->store.num_fields; k++) {
    const struct store_field *field = &run->store.field[k];
    f->fields[k] =
      (struct fact){field->row.name, "B", field->row.meaning, (double)field->capacity / n, NULL};
  }
  f->run.memory.num_fields = run->store.num_fields;
}

void facts_end(struct facts *f, const struct plan *plan, const struct run *run,
               const struct record *r, enum run_status end, const char *reason, double seconds)
{
  facts_update(f, plan, run, r);
  f->run.status = end;
  f->run.reason = reason;
  end_iterations(f, run, r);
  f->run.metrics = f->metrics;
  for (int k = 0; k < NUM_METRICS; k++)
    if (reported(plan, k))
      f->metrics[f->run.num_metrics++] =
        (struct fact){metric_names[k], metric_units[k], metric_about[k], r->last.value[k], NULL};
  double phase[NUM_PHASES];
  clock_phases(phase);
  for (int k = 0; k < NUM_PHASES; k++)
    f->phases[k] = (struct fact){clock_phase_name((enum phase)k), "s",
                                 clock_phase_about((enum phase)k), phase[k], NULL};
  f->run.timing.phases = f->phases;
  f->run.timing.num_phases = NUM_PHASES;
  const double work = seconds - phase[PHASE_METRICS] - phase[PHASE_OUTPUT];
  const long here = run->step - run->first_step;
  f->run.timing.total = seconds;
  f->run.timing.per_step = here > 0 ? work / (double)here : 0;
  const long iterations = f->run.iterations.total - run->first_iterations;
  f->run.timing.per_iteration = iterations > 0 ? phase[PHASE_SOLVER] / (double)iterations : 0;
  f->run.pairs_visited = visits_total(run);
  f->run.judged = run->judge.first;
  f->run.num_judged = run->judge.n;
  f->run.speed_max = run->judge.fastest;
  f->run.energy_growth = run->judge.has_start ? run->judge.growth : (double)NAN;
  end_memory(f, run);
}
