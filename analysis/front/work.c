/* Carrying out a queue: children side by side, and what became of each. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <jansson.h>

#include "../../core/base/clock.h"
#include "../../core/base/progress.h"
#include "process.h"
#include "runs.h"

enum {
  MOST_JOBS = 256,
  PATIENCE = 20 /* s, at most, from asking a child to stop until it is killed */
};

struct child {
  pid_t pid; /* 0: free */
  int run;
  double begun, expected; /* [s]; expected 0: not known */
  double stopped;         /* when it was told to, having reached the limit; 0: it was not */
};

struct work {
  struct queue *queue;
  struct child child[MOST_JOBS];
  int jobs, next, todo;
  struct progress bar;
  double stopped; /* when the children were asked to stop; 0: they were not */
  status failed;  /* of the front end itself: nothing new is started */
  char sentence[1024];
};

static volatile sig_atomic_t stop_signal;
static void on_signal(int number) { stop_signal = number; }

static void fail(struct work *w, status result)
{
  if (w->failed != OK || result == OK) return;
  w->failed = result;
  snprintf(w->sentence, sizeof w->sentence, "%s", status_sentence());
}

/* --- starting --- */

static status start(struct work *w, struct child *child, int number)
{
  struct run *run = &w->queue->run[number];
  const struct path json = run_file(w->queue->results, run->id, "json");
  const struct path frames = run_file(w->queue->results, run->id, "vtkhdf");
  const struct path log = run_file(w->queue->results, run->id, "log");
  const char *const files[] = {"-o", frames.text, "--json", json.text, "--quiet"};
  enum { NUM_FILES = sizeof files / sizeof *files };
  const char **argv = calloc((size_t)run->argc + NUM_FILES + 2, sizeof *argv);
  if (!argv) return status_set(ERR_MEMORY, "out of memory");
  argv[0] = run->executable.text;
  for (int k = 0; k < run->argc; k++) argv[1 + k] = run->argv[k];
  for (int k = 0; k < NUM_FILES; k++) argv[1 + run->argc + k] = files[k];
  unlink(json.text); /* what a stopped run left would be taken for the new result */
  unlink(frames.text);
  const struct process process = {
    .argv = argv, .log = log.text, .one_thread = 1, .most_memory = w->queue->memory};
  *child = (struct child){
    .run = number, .begun = clock_now(), .expected = queue_known_time(w->queue, run)};
  const status started = process_start(&process, &child->pid);
  if (started != OK) child->pid = 0;
  free(argv);
  return started;
}

/* Threads of the runs that are at work. */
static int running_threads(const struct work *w)
{
  int n = 0;
  for (int j = 0; j < w->jobs; j++)
    if (w->child[j].pid) n += w->queue->run[w->child[j].run].threads;
  return n;
}

static void start_some(struct work *w)
{
  for (int j = 0; j < w->jobs && w->failed == OK && !stop_signal; j++) {
    if (w->child[j].pid) continue;
    while (w->next < w->queue->n && w->queue->run[w->next].finished) w->next++;
    if (w->next == w->queue->n) return;
    const int taken = running_threads(w);
    if (taken > 0 && taken + w->queue->run[w->next].threads > w->jobs) return;
    fail(w, start(w, &w->child[j], w->next++));
  }
}

/* --- what became of a child --- */

char *run_last_words(const char *path)
{
  char *text;
  size_t size;
  if (file_read(path, &text, &size) != OK) return strdup("");
  while (size > 0 && text[size - 1] == '\n') text[--size] = '\0';
  const char *line = strrchr(text, '\n');
  line = line ? line + 1 : text;
  if (strncmp(line, "sphbench: ", 10) == 0) line += 10;
  char *copy = strdup(line);
  free(text);
  return copy;
}

static char *crash_reason(int exit_code, char *said)
{
  char *reason = exit_code > 128 ? text_make("ended by signal %d (%s)", exit_code - 128,
                                             strsignal(exit_code - 128))
                                 : text_make("ended with exit code %d: %s", exit_code, said);
  free(said);
  return reason;
}

/* "diverged" or "interrupted" and why, from the run's own facts. */
static int said_in_json(const char *path, char **reason)
{
  json_t *facts = json_load_file(path, 0, NULL);
  const char *word = json_string_value(json_object_get(facts, "status"));
  const char *why = json_string_value(json_object_get(facts, "reason"));
  const int is_diverged = word && strcmp(word, "diverged") == 0;
  const int is_interrupted = word && strcmp(word, "interrupted") == 0;
  if (is_diverged) {
    const double at = json_number_value(json_object_get(facts, "time_end"));
    *reason = text_make("%s at t = %.4g s", why ? why : "diverged", at);
  }
  json_decref(facts);
  return is_diverged ? OUTCOME_DIVERGED : is_interrupted ? OUTCOME_INTERRUPTED : OUTCOME_CRASHED;
}

/* Did it run into the limit on memory? It says so itself, or it was full when a signal ended it,
 * since not every method asks whether it was given what it asked for. */
static int was_full(const struct queue *queue, int exit_code, const char *said, long peak)
{
  if (queue->memory == 0) return 0;
  if (exit_code > 128) return peak > queue->memory * 3 / 4;
  return exit_code == 3 && said && (strstr(said, "no memory") || strstr(said, "out of memory"));
}

/* By signals that no run sends itself. */
static int is_killed(int exit_code)
{
  return exit_code == 128 + SIGKILL || exit_code == 128 + SIGTERM || exit_code == 128 + SIGINT;
}

static int classify(struct work *w, const struct run *run, int exit_code, long peak, char **reason)
{
  const struct path json = run_file(w->queue->results, run->id, "json");
  const struct path log = run_file(w->queue->results, run->id, "log");
  int outcome = OUTCOME_CRASHED;
  *reason = NULL;
  if (exit_code == 0 && path_is_file(json.text)) {
    *reason = strdup("");
    return OUTCOME_OK;
  }
  if (exit_code == 3) outcome = said_in_json(json.text, reason);
  if (outcome != OUTCOME_CRASHED) return outcome;
  if (w->stopped > 0) return OUTCOME_INTERRUPTED;
  *reason = run_last_words(log.text);
  if (exit_code == 2) {
    if (!*reason || strncmp(*reason, "cannot write", 12) != 0) return OUTCOME_UNABLE;
    fail(w, status_set(ERR_IO, "%s", *reason)); /* a full disk says nothing about the solver */
    return OUTCOME_INTERRUPTED;
  }
  if (exit_code == 77) return OUTCOME_UNABLE;
  if (was_full(w->queue, exit_code, *reason, peak)) {
    free(*reason);
    *reason = text_make(OOM_REASON, w->queue->memory);
    return OUTCOME_OOM;
  }
  *reason = crash_reason(exit_code, *reason);
  return is_killed(exit_code) ? OUTCOME_INTERRUPTED : OUTCOME_CRASHED;
}

/* Skipped on a machine that lacks something: may go better next time. */
static int is_final(int exit_code) { return exit_code != 77 && exit_code != 127; }

static void tell(struct work *w, const struct run *run)
{
  const int failed = run->outcome == OUTCOME_CRASHED;
  if (w->queue->quiet || (w->bar.on && !failed)) return;
  const double shown = w->bar.shown;
  if (w->bar.on) fprintf(stderr, "\r\033[K");
  fprintf(stderr, "[%d/%d] %s with %s", w->queue->done, w->todo, run->argv[1], run->argv[3]);
  if (*run->what) fprintf(stderr, " (%s)", run->what);
  fprintf(stderr, ": %s, %.1f s%s%s\n", outcome_words[run->outcome], run->seconds,
          run->reason && *run->reason ? ": " : "", run->reason ? run->reason : "");
  w->bar.shown = shown;
}

/* peak: the most memory that it held [MiB] */
static void take_end(struct work *w, struct child *child, int state, long peak)
{
  struct run *run = &w->queue->run[child->run];
  const int exit_code = WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
  child->pid = 0;
  run->seconds = clock_now() - child->begun;
  const int too_long = child->stopped > 0 && exit_code != 0;
  if (too_long) run->reason = text_make("takes longer than %g s", w->queue->limit);
  const int outcome = too_long ? OUTCOME_TIMEOUT : classify(w, run, exit_code, peak, &run->reason);
  run->outcome = (enum outcome)outcome;
  if (outcome == OUTCOME_INTERRUPTED && !run->reason)
    run->reason = strdup(w->stopped > 0 ? "stopped with the sweep" : "was stopped");
  run->finished = w->stopped > 0 ? outcome != OUTCOME_INTERRUPTED : 1;
  w->queue->done += run->finished;
  if (run->finished) tell(w, run);
  struct journal_entry entry = {.outcome = run->outcome,
                                .exit_code = exit_code,
                                .seconds = run->seconds,
                                .reason = run->reason,
                                .scene = run->argv[1],
                                .solver = run->argv[3],
                                .variant = run->name.text,
                                .what = run->what};
  memcpy(entry.id, run->id, sizeof entry.id);
  if (too_long || outcome == OUTCOME_OOM || is_final(exit_code))
    fail(w, journal_add(&w->queue->journal, &entry));
}

/* --- progress --- */

static double running_for(const struct work *w, int number)
{
  for (int j = 0; j < w->jobs; j++)
    if (w->child[j].pid && w->child[j].run == number) return clock_now() - w->child[j].begun;
  return 0;
}

static void show(struct work *w, const char *const *notes)
{
  double done = 0, all = 0;
  const char *name = "";
  for (int k = 0; k < w->queue->n; k++) {
    const struct run *run = &w->queue->run[k];
    if (!notes[k]) continue; /* was finished before */
    const double whole = run->finished ? run->seconds : queue_expected_time(w->queue, run);
    const double so_far = run->finished ? whole : running_for(w, k);
    if (!run->finished && so_far > 0) name = notes[k];
    all += whole;
    done += so_far < 0.95 * whole || run->finished ? so_far : 0.95 * whole;
  }
  const struct path note = path_of("%d of %d, %s", w->queue->done, w->todo, name);
  if (all > 0) progress_show(&w->bar, done / all, note.text);
}

/* --- the loop --- */

static void stop_children(struct work *w)
{
  const double now = clock_now();
  const int number = w->stopped > 0 && now - w->stopped > PATIENCE ? SIGKILL : SIGTERM;
  if (w->stopped > 0 && number == SIGTERM) return;
  if (!(w->stopped > 0)) w->stopped = now;
  for (int j = 0; j < w->jobs; j++)
    if (w->child[j].pid) kill(w->child[j].pid, number);
}

/* A run at its limit is asked to stop, and killed when it does not within the limit again. */
static void keep_limit(struct work *w)
{
  const double shortest = 2, patience = fmin(PATIENCE, fmax(shortest, w->queue->limit));
  const double now = clock_now(), limit = w->queue->limit;
  for (int j = 0; j < w->jobs && limit > 0 && !(w->stopped > 0); j++) {
    struct child *child = &w->child[j];
    if (!child->pid || now - child->begun < limit) continue;
    if (child->stopped > 0 && now - child->stopped < patience) continue;
    kill(child->pid, child->stopped > 0 ? SIGKILL : SIGTERM);
    if (!(child->stopped > 0)) child->stopped = now;
  }
}

static int running(const struct work *w)
{
  int n = 0;
  for (int j = 0; j < w->jobs; j++) n += w->child[j].pid != 0;
  return n;
}

static void collect(struct work *w)
{
  for (int j = 0; j < w->jobs; j++) {
    int state;
    struct rusage used; /* ru_maxrss [KiB] */
    if (w->child[j].pid && wait4(w->child[j].pid, &state, WNOHANG, &used) > 0)
      take_end(w, &w->child[j], state, used.ru_maxrss / 1024);
  }
}

static void loop(struct work *w, const char *const *notes)
{
  const struct timespec pause = {.tv_nsec = 20 * 1000 * 1000};
  start_some(w);
  while (running(w) > 0) {
    if (stop_signal || w->failed != OK) stop_children(w);
    keep_limit(w);
    nanosleep(&pause, NULL);
    collect(w);
    start_some(w);
    show(w, notes);
  }
}

/* What to show beside the bar for each run that is to be done; NULL for the others. */
static char **make_notes(struct work *w)
{
  char **notes = calloc((size_t)w->queue->n + 1, sizeof *notes);
  for (int k = 0; notes && k < w->queue->n; k++) {
    const struct run *run = &w->queue->run[k];
    if (run->finished) continue;
    w->todo++;
    notes[k] = text_make("%s, %s", run->argv[1], run->argv[3]);
  }
  return notes;
}

status queue_work(struct queue *queue)
{
  static struct work w; /* large, and there is one */
  struct sigaction action = {.sa_handler = on_signal}, before[2];
  w = (struct work){.queue = queue, .jobs = queue->jobs < MOST_JOBS ? queue->jobs : MOST_JOBS};
  char **notes = make_notes(&w);
  if (!notes) return status_set(ERR_MEMORY, "out of memory");
  stop_signal = 0;
  queue->done = 0;
  sigaction(SIGINT, &action, &before[0]);
  sigaction(SIGTERM, &action, &before[1]);
  progress_begin(&w.bar, "runs", queue->quiet);
  loop(&w, (const char *const *)notes);
  progress_end(&w.bar);
  sigaction(SIGINT, &before[0], NULL);
  sigaction(SIGTERM, &before[1], NULL);
  for (int k = 0; k < queue->n; k++) free(notes[k]);
  free(notes);
  if (w.failed != OK) return status_set(w.failed, "%s", w.sentence);
  if (stop_signal)
    return status_set(ERR_RUN, "stopped; %d of %d runs were finished and will not be run again",
                      queue->done, w.todo);
  return OK;
}
