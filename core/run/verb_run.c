/* `sphbench run`: one scene with one solver. */
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../base/memory.h"
#include "../base/progress.h"
#include "../io/h5.h"
#include "../io/out_path.h"
#include "../io/result_file.h"
#include "../io/result_json.h"
#include "facts.h"
#include "restart.h"

/* One run from the command line and everything that is open for it. */
struct session {
  const struct options *o;
  struct plan plan;
  struct run *run;
  struct record record;
  struct facts facts;
  struct result_file *file;
  struct progress bar;
  long frames, next_frame, steps;
  double next_sample, t_end;
  char *checkpoint;                         /* the file of --checkpoint; NULL: there is none */
  double checkpoint_every, checkpoint_next; /* [s] of wall time */
};
enum { MOST_STEPS = 1000000000 };

static volatile sig_atomic_t stop_signal;
static void on_signal(int number) { stop_signal = number; }

static const char *stop_reason(void)
{
  return stop_signal == SIGINT   ? "stopped by Ctrl-C"
         : stop_signal == SIGHUP ? "stopped as its terminal was closed"
                                 : "stopped by SIGTERM";
}

static void catch_signals(void)
{
  static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
  struct sigaction action, before;
  memset(&action, 0, sizeof action);
  action.sa_handler = on_signal;
  for (int k = 0; k < COUNT(numbers); k++) {
    sigaction(numbers[k], NULL, &before);
    if (numbers[k] == SIGHUP && before.sa_handler == SIG_IGN) continue; /* nohup */
    sigaction(numbers[k], &action, NULL);
  }
  signal(SIGXFSZ, SIG_IGN); /* a limit on the size of files is met like a full disk */
}

/* order[label] = place in the snapshot, so that row k of every frame is particle k. */
static int *order_by_label(const struct snapshot *now)
{
  int *order = malloc(sizeof(int) * (size_t)(now->n + 1));
  for (int i = 0; order && i < now->n; i++) order[now->id[i]] = i;
  return order;
}

static enum result_type real_type(void) { return sizeof(real) == 4 ? RESULT_FLOAT : RESULT_DOUBLE; }

static status write_frame(struct session *s, const struct snapshot *now)
{
  struct result_array arrays[5] = {{"position", "m", "position", DIM, real_type(), now->x},
                                   {"velocity", "m/s", "velocity", DIM, real_type(), now->v}};
  int n = 2;
  if (now->p)
    arrays[n++] = (struct result_array){"pressure", "Pa", "pressure", 1, real_type(), now->p};
  else if (store_public(&s->run->store, "p")) /* at the start: every frame has the same arrays */
    arrays[n++] = (struct result_array){"pressure", "Pa", "pressure", 1, real_type(), NULL};
  arrays[n++] =
    (struct result_array){"id", "1", "label given at the start", 1, RESULT_INT, now->id};
  int *order = order_by_label(now);
  real *none = calloc((size_t)now->n + 1, sizeof(real));
  if (!order || !none) {
    free(order);
    free(none);
    return status_set(ERR_MEMORY, "no memory for a frame");
  }
  for (int k = 0; k < n; k++)
    if (!arrays[k].data) arrays[k].data = none;
  const struct result_set fluid = {now->n, order, n, arrays};
  struct fact numbers[2 + MOST_BODIES * BODY_NUMBERS] = {
    {"step", "1", "number of steps so far", (double)now->step, NULL},
    {"iterations", "1", "of the last step", s->run->step_iterations, NULL}};
  const int num = 2 + bodies_report(s->run, numbers + 2);
  const status result = result_file_add_frame(s->file, now->time, &fluid, num, numbers);
  free(order);
  free(none);
  return result;
}

static status write_walls(struct session *s, const struct snapshot *now)
{
  const int n = now->n_all - now->n;
  if (n == 0) return OK;
  const struct result_array array = {"position", "m",         "position of wall particles",
                                     DIM,        real_type(), now->x + now->n};
  const struct result_set walls = {n, NULL, 1, &array};
  return result_file_add_walls(s->file, &walls);
}

static double frame_time(const struct session *s)
{
  return s->t_end * (double)s->next_frame / (double)s->frames;
}

/* Sample the metrics and write a frame, each when it is due. Of a state that is not finite there is
 * neither: the last frame is one that can be drawn. */
static status sample(struct session *s, int last)
{
  struct run *run = s->run;
  const double eps = 1e-9 * run->dt;
  const int sample_due = last || run->time >= s->next_sample - eps;
  const int frame_due = s->file && (last || run->time >= frame_time(s) - run->dt / 2);
  if (run->not_finite || (!sample_due && !frame_due)) return OK;
  struct snapshot now;
  TRY(run_snapshot(run, &now));
  status result = OK;
  if (sample_due) {
    result = record_sample(&s->record, run, &s->plan.setting, &now);
    s->next_sample += s->t_end / run->scene.common.samples;
    if (s->next_sample < run->time) s->next_sample = run->time;
  }
  if (frame_due && result == OK) {
    const enum phase before = clock_enter(PHASE_OUTPUT);
    if (run->step == 0) result = write_walls(s, &now);
    if (result == OK) result = write_frame(s, &now);
    facts_update(&s->facts, &s->plan, run, &s->record);
    if (result == OK) result = result_file_add_series(s->file, &s->facts.run);
    while (s->next_frame <= s->frames && frame_time(s) <= run->time + run->dt / 2) s->next_frame++;
    clock_enter(before);
  }
  snapshot_free(&now);
  return result;
}

/* Prescribed motion of the scene, on a host copy of the particles. */
static status drive(struct session *s, double time)
{
  const struct setting *set = &s->plan.setting;
  if (!set->benchmark || !set->benchmark->drive) return OK;
  struct particles p = s->run->view->p, host = {.n = p.n, .n_all = p.n_all};
  host.x = malloc(sizeof(vec) * (size_t)(p.n_all + 1));
  host.v = malloc(sizeof(vec) * (size_t)(p.n_all + 1));
  host.id = malloc(sizeof(int) * (size_t)(p.n + 1));
  const int ready = host.x && host.v && host.id;
  if (ready) {
    memory_to_host(host.x, p.x, sizeof(vec) * (size_t)p.n_all);
    memory_to_host(host.v, p.v, sizeof(vec) * (size_t)p.n_all);
    memory_to_host(host.id, p.id, sizeof(int) * (size_t)p.n);
    set->benchmark->drive(&s->run->scene, set->self, host, time);
    memory_from_host(p.x, host.x, sizeof(vec) * (size_t)p.n_all);
    memory_from_host(p.v, host.v, sizeof(vec) * (size_t)p.n_all);
  }
  free(host.x);
  free(host.v);
  free(host.id);
  return ready ? OK : status_set(ERR_MEMORY, "no memory for the prescribed motion");
}

static struct checkpoint checkpoint_of(struct session *s)
{
  return (struct checkpoint){s->facts.run.scene, &s->plan, s->run, &s->record, &s->next_sample};
}

static status prepare_checkpoint(struct session *s)
{
  const char *text = s->o->checkpoint;
  char *end;
  if (!text) return OK;
  s->checkpoint_every = strtod(text, &end);
  if (end == text || *end || !(s->checkpoint_every >= 0))
    return user_error("--checkpoint: '%s' found, allowed is a number of seconds, at least 0", text);
  if (s->plan.setting.benchmark && s->plan.setting.benchmark->projection)
    return user_error("--checkpoint: scene '%s' is a single step", s->o->name);
  s->checkpoint = checkpoint_path(s->o);
  if (!s->checkpoint) return status_set(ERR_MEMORY, "no memory for the name of a file");
  s->checkpoint_next = clock_now() + s->checkpoint_every;
  return restart_prepare(s->run);
}

/* When it is time, and when the run is stopped; before the samples that are due in this step. */
static status checkpoint(struct session *s)
{
  if (!s->checkpoint || s->run->diverged) return OK;
  if (!stop_signal && clock_now() < s->checkpoint_next) return OK;
  const struct checkpoint c = checkpoint_of(s);
  TRY(checkpoint_save(s->checkpoint, &c));
  s->checkpoint_next = clock_now() + s->checkpoint_every;
  return OK;
}

static status go_on(struct session *s)
{
  const struct checkpoint c = checkpoint_of(s);
  if (!s->o->restart) return OK;
  TRY(checkpoint_load(s->o->restart, &c));
  if (s->run->step > s->steps)
    return user_error("--restart: '%s' stands at %.6g s, --t-end is %.6g s", s->o->restart,
                      s->run->time, s->t_end);
  return sample(s, s->run->step == s->steps);
}

/* A signal is looked at once per step, so that the last step always leaves a sample and a frame. */
static status step_to_end(struct session *s)
{
  struct run *run = s->run;
  TRY(go_on(s));
  int last = stop_signal || run->step == s->steps;
  while (!last) {
    TRY(drive(s, run->time + run->dt));
    TRY(run_step(run));
    TRY(record_step(&s->record, run));
    TRY(checkpoint(s));
    last = stop_signal || run->diverged || run->step == s->steps;
    TRY(sample(s, last));
    char note[64];
    snprintf(note, sizeof note, "t = %.4g s, %d iterations", run->time, run->step_iterations);
    progress_show(&s->bar, (double)run->step / (double)s->steps, note);
  }
  return OK;
}

static status project_once(struct session *s)
{
  TRY(run_project(s->run));
  TRY(record_step(&s->record, s->run));
  return sample(s, 1);
}

static void print_summary(const struct session *s)
{
  const struct run_facts *f = &s->facts.run;
  printf("%s with %s (%s): %ld particles, %ld steps to t = %.6g s, %.2f iterations per step\n",
         f->scene, f->solver, f->variant, f->particles, f->steps, f->time_end, f->iterations.mean);
  if (f->reason) printf("%s: %s\n", f->status == RUN_DIVERGED ? "diverged" : "stopped", f->reason);
  for (int k = 0; k < f->num_metrics; k++)
    if (isfinite(f->metrics[k].value))
      printf("  %-22s %12.6g %s\n", f->metrics[k].name, f->metrics[k].value, f->metrics[k].unit);
  printf("time:");
  for (int k = 0; k < f->timing.num_phases; k++)
    if (f->timing.phases[k].value > 5e-4)
      printf(" %s %.3f s", f->timing.phases[k].name, f->timing.phases[k].value);
  printf(", in all %.3f s; %.3g us per particle and step\n", f->timing.total,
         1e6 * f->timing.per_step / (double)(f->particles > 0 ? f->particles : 1));
}

static enum run_status how_it_ended(const struct session *s, const char **reason)
{
  const struct run *run = s->run;
  *reason = run->diverged ? run->reason : NULL;
  if (run->diverged) return RUN_DIVERGED;
  if (run->step == s->steps) return RUN_DONE;
  *reason = stop_reason();
  return RUN_INTERRUPTED;
}

/* The files and the words at the end of a run that was carried out, whatever came of it. */
static status finish(struct session *s, double seconds)
{
  const struct run *run = s->run;
  const struct options *o = s->o;
  const char *reason;
  const enum run_status end = how_it_ended(s, &reason);
  judge_end(s->run);
  facts_end(&s->facts, &s->plan, run, &s->record, end, reason, seconds);
  if (s->file) {
    struct result_file *file = s->file;
    s->file = NULL;
    TRY(result_file_finish(file, &s->facts.run));
  }
  if (o->json) TRY(result_json_write(o->json, &s->facts.run));
  if (!o->quiet && !(o->json && strcmp(o->json, "-") == 0)) print_summary(s);
  if (o->explain) explain(run);
  if (end == RUN_DONE) return OK;
  return status_set(ERR_RUN, "the run %s at t = %.6g s (step %ld): %s",
                    run->diverged ? "diverged" : "was stopped", run->time, run->step, reason);
}

static status dry_run(const struct session *s)
{
  const struct run *run = s->run;
  struct warnings warnings;
  run_warnings(run, &warnings);
  warnings_say(&warnings);
  printf("%s with %s (%s): %d fluid and %d wall particles, %ld steps of %g s\n", s->o->name,
         run->solver->name, SPHBENCH_VARIANT, run->view->p.n, run->view->p.n_all - run->view->p.n,
         s->steps, run->dt);
  for (int k = 0; k < s->plan.num_parameters; k++) {
    const struct fact *f = &s->plan.parameters[k];
    if (f->word)
      printf("  %-18s %-12s %s\n", f->name, f->word, f->about);
    else
      printf("  %-18s %-12.9g %s [%s]\n", f->name, f->value, f->about, f->unit);
  }
  if (s->o->explain) explain(run);
  return OK;
}

static status count_steps(struct session *s)
{
  const struct setting *set = &s->plan.setting;
  const double steps = ceil(set->scene.common.t_end / set->scene.common.dt - 1e-9);
  s->t_end = set->scene.common.t_end;
  s->steps = set->benchmark && set->benchmark->projection ? 1 : (long)fmin(steps, MOST_STEPS + 1.0);
  if (s->steps <= MOST_STEPS) return OK;
  return user_error("--t-end, --dt: %g s in steps of %g s are %.3g steps, allowed are at most %d",
                    s->t_end, set->scene.common.dt, steps, MOST_STEPS);
}

static int same_file(const char *a, const char *b)
{
  struct stat one, other;
  if (!a || !b || stat(a, &one) || stat(b, &other)) return a && b && strcmp(a, b) == 0;
  return one.st_dev == other.st_dev && one.st_ino == other.st_ino && S_ISREG(one.st_mode);
}

/* Can this file be written? Nothing is left of the attempt. */
static status try_path(const char *path, int allow_stream)
{
  struct out_path out;
  TRY(out_path_begin(&out, path, allow_stream));
  out_path_discard(&out);
  return OK;
}

/* What would only be found after the run: files in each other's way, or that cannot be. */
static status check_outputs(const struct options *o, int from_file)
{
  if (same_file(o->output, o->json))
    return user_error("-o and --json: both are '%s', allowed are two files", o->json);
  if (from_file && (same_file(o->output, o->name) || same_file(o->json, o->name)))
    return user_error("'%s' is the scene file, allowed is another file to write to", o->name);
  if (o->json && strcmp(o->json, "-") == 0 && o->explain)
    return user_error("--explain, --json -: both write to standard output");
  if (o->json && strcmp(o->json, "-") != 0) TRY(try_path(o->json, 1));
  return o->output ? try_path(o->output, 0) : OK;
}

static status start(struct session *s, int threads)
{
  facts_start(&s->facts, s->o, &s->plan, s->run, threads);
  catch_signals();
  return s->o->output ? result_file_open(&s->file, s->o->output, &s->facts.run) : OK;
}

static status carry_out(struct session *s, int threads)
{
  struct setting *set = &s->plan.setting;
  TRY(count_steps(s));
  TRY(check_outputs(s->o, !set->benchmark));
  TRY(run_create(s->plan.solver, s->plan.solver_values, &set->scene, set->asks, &s->run));
  plan_resolve(&s->plan, s->run);
  s->run->judge.planned = s->steps;
  s->run->judge.driven = set->benchmark && set->benchmark->drive;
  if (s->o->dry_run) return dry_run(s);
  TRY(start(s, threads));
  TRY(prepare_checkpoint(s));
  warnings_say(&s->facts.warnings);
  progress_begin(&s->bar, s->o->name, s->o->quiet);
  clock_reset();
  const double begun = clock_now();
  status result = sample(s, 0);
  if (result == OK)
    result = set->benchmark && set->benchmark->projection ? project_once(s) : step_to_end(s);
  progress_end(&s->bar);
  return result == OK ? finish(s, clock_now() - begun) : result;
}

status verb_run(const struct options *o)
{
  struct session s;
  memset(&s, 0, sizeof s);
  s.o = o;
  long threads;
  TRY(option_whole("--threads", o->threads, 1, 1024, omp_get_max_threads(), &threads));
  TRY(option_whole("--frames", o->frames, 1, 1000000, 50, &s.frames));
  omp_set_num_threads((int)threads);
  visits_wanted = o->count_pairs;
  h5_start(); /* HDF5 crashes where it finds no memory to start in */
  int other_dim = 0;
  status result = plan_make(o, &s.plan, &other_dim);
  if (result == OK && other_dim) {
    plan_free(&s.plan);
    return switch_dimension(o, other_dim);
  }
  if (result == OK) result = carry_out(&s, (int)threads);
  result_file_discard(s.file);
  free(s.checkpoint);
  record_free(&s.record);
  if (s.run) run_free(s.run);
  plan_free(&s.plan);
  return result;
}
