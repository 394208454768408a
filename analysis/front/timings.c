/* The times of a queue's runs: RESULTS/timings.jsonl, a line for each timed run. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "../../core/base/clock.h"
#include "../../core/base/progress.h"
#include "statistics.h"
#include "timed.h"

/* A run that is to be timed. */
struct timing {
  const struct run *run;
  json_t *facts;   /* of the untimed run, without its series */
  const char *cpu; /* of the facts */
  double rough;    /* [s] */
  double *seconds; /* [repeat] */
  int taken;
  const char *problem; /* why there are no more times; NULL: none */
};

struct timings {
  const struct timings_settings *settings;
  const struct queue *queue;
  struct path path, json;
  struct timing *timing;
  int n;
  struct cores cores;
  double load, wall, others; /* as in struct timed, over all */
};

static double number_in(const json_t *object, const char *group, const char *key)
{
  return json_number_value(json_object_get(json_object_get(object, group), key));
}

/* --- what is to be timed, and what was --- */

static status add(struct timings *t, const struct run *run)
{
  struct timing *timing = &t->timing[t->n];
  const struct path json = run_file(t->queue->results, run->id, "json");
  if (!run->finished || run->outcome != OUTCOME_OK) return OK;
  *timing = (struct timing){.run = run, .facts = json_load_file(json.text, 0, NULL)};
  if (!timing->facts) return status_set(ERR_IO, "'%s' cannot be read", json.text);
  json_object_del(timing->facts, "series");
  timing->cpu =
    json_string_value(json_object_get(json_object_get(timing->facts, "provenance"), "cpu"));
  if (!timing->cpu) timing->cpu = "";
  timing->rough = number_in(timing->facts, "timing", "total");
  timing->seconds = calloc((size_t)t->settings->repeat, sizeof(double));
  t->n++;
  return timing->seconds ? OK : status_set(ERR_MEMORY, "out of memory");
}

static void take_line(struct timings *t, const json_t *line)
{
  const char *id = json_string_value(json_object_get(line, "id"));
  const char *cpu = json_string_value(json_object_get(line, "cpu"));
  const long threads = (long)json_integer_value(json_object_get(line, "threads"));
  for (int k = 0; k < t->n && id && cpu && threads == t->settings->threads; k++) {
    struct timing *timing = &t->timing[k];
    if (strcmp(timing->run->id, id) || strcmp(timing->cpu, cpu)) continue;
    if (timing->taken < t->settings->repeat)
      timing->seconds[timing->taken++] = json_number_value(json_object_get(line, "seconds"));
  }
}

static status take_earlier(struct timings *t)
{
  char *text;
  size_t size;
  if (t->settings->fresh || !path_is_file(t->path.text)) return OK;
  TRY(file_read(t->path.text, &text, &size));
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));) {
    json_t *object = json_loads(line, 0, NULL);
    if (object) take_line(t, object);
    json_decref(object);
  }
  free(text);
  return OK;
}

/* --- taking --- */

static status note(const struct timings *t, const struct timing *timing, const struct timed *timed)
{
  char date[32], cores[64];
  const time_t now = time(NULL);
  struct tm utc;
  strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  cores_text(&t->cores, (int)t->settings->threads, cores, sizeof cores);
  return timed_note(t->path.text,
                    json_pack("{s:s, s:s, s:s, s:s, s:f, s:f, s:I, s:s, s:f, s:f, s:f, s:s, s:s}",
                              "id", timing->run->id, "scene", timing->run->argv[1], "solver",
                              timing->run->argv[3], "what", timing->run->what, "seconds",
                              timed->seconds, "wall", timed->wall, "threads",
                              (json_int_t)t->settings->threads, "cores", cores, "load_before",
                              timed->load_before, "load_after", timed->load_after, "others",
                              timed->others, "cpu", timing->cpu, "date", date));
}

/* A timed run that computes something else than the untimed one measures something else. */
static const char *problem_of(const struct timing *timing, const struct timed *timed)
{
  const json_t *word = json_object_get(timed->facts, "status");
  if (timed->stopped) return "takes ten times as long as before";
  if (!json_string_value(word) || strcmp(json_string_value(word), "ok") != 0)
    return "ended otherwise than the untimed run";
  return json_equal(json_object_get(timed->facts, "metrics"),
                    json_object_get(timing->facts, "metrics"))
           ? NULL
           : "computed something else than the untimed run";
}

static status take_one(struct timings *t, struct timing *timing)
{
  enum { START = 10 }; /* s that the start of a process may take where the machine is busy */
  const struct timed_request request = {timing->run, &t->cores, t->settings->threads,
                                        10 * timing->rough + START, t->json.text};
  struct timed timed;
  TRY(timed_once(&request, &timed));
  t->wall += timed.wall;
  t->others += fmax(timed.others, 0);
  timing->problem = problem_of(timing, &timed);
  json_decref(timed.facts);
  if (timing->problem) return OK;
  timing->seconds[timing->taken++] = timed.seconds;
  return note(t, timing, &timed);
}

static double left_to_do(const struct timings *t)
{
  double sum = 0;
  for (int k = 0; k < t->n; k++)
    if (!t->timing[k].problem)
      sum += (0.1 + t->timing[k].rough) * (double)(t->settings->repeat - t->timing[k].taken);
  return sum;
}

static status take_rounds(struct timings *t)
{
  struct progress bar;
  status result = OK;
  const double all = left_to_do(t);
  progress_begin(&bar, "timing", t->settings->quiet);
  for (long round = 0; round < t->settings->repeat; round++)
    for (int turn = 0; turn < t->n && result == OK; turn++) {
      struct timing *timing = &t->timing[timed_turn(round, turn, t->n)];
      if (timing->problem || timing->taken > round) continue;
      result = take_one(t, timing);
      const struct path words = path_of("round %ld of %ld", round + 1, t->settings->repeat);
      progress_show(&bar, 1 - left_to_do(t) / all, words.text);
    }
  progress_end(&bar);
  return result;
}

/* --- telling --- */

static void tell(struct timings *t)
{
  char cores[64];
  cores_text(&t->cores, (int)t->settings->threads, cores, sizeof cores);
  printf("%-22s %-12s %10s   %-23s %s\n", "scene", "solver", "median [s]", "interval of it [s]",
         "arguments");
  for (int k = 0; k < t->n; k++) {
    struct timing *timing = &t->timing[k];
    const struct run *run = timing->run;
    if (timing->problem) {
      printf("%-22s %-12s %10s   %s: %s\n", run->argv[1], run->argv[3], "-", run->what,
             timing->problem);
      continue;
    }
    const struct interval time = interval_of_median(timing->seconds, timing->taken);
    printf("%-22s %-12s %10.4g   [%9.4g, %9.4g]  %s\n", run->argv[1], run->argv[3], time.median,
           time.low, time.high, run->what);
  }
  printf("%ld times each, in rounds there and back, %ld thread%s%s%s: %s\n", t->settings->repeat,
         t->settings->threads, t->settings->threads > 1 ? "s" : "", *cores ? " on core " : "",
         cores, t->path.text);
}

/* Half a core that others take leaves no time of two cores alone; a larger machine shares its
 * memory and its clock. */
static void warn(const struct timings *t)
{
  if (t->settings->quiet) return;
  if (t->load > 0.5)
    fprintf(stderr, "the machine was busy before (load %.2f): the times are worth little\n",
            t->load);
  else if (t->others > 0.5 * t->wall)
    fprintf(stderr, "others kept %.2g cores busy meanwhile: the times are worth little\n",
            t->others / t->wall);
}

/* --- all of it --- */

static status take_all(struct timings *t)
{
  int some = -1;
  for (int k = 0; k < t->queue->n; k++) TRY(add(t, &t->queue->run[k]));
  TRY(take_earlier(t));
  for (int k = 0; k < t->n; k++)
    if (t->timing[k].taken < t->settings->repeat) some = k;
  if (some >= 0) {
    if (getloadavg(&t->load, 1) != 1) t->load = 0;
    t->cores = cores_idle_first();
    TRY(timed_warm_up(t->timing[some].run, &t->cores, t->settings->threads));
    TRY(take_rounds(t));
    warn(t);
  }
  if (!t->settings->quiet && t->n > 0) tell(t);
  return OK;
}

status timings_take(const struct queue *queue, const struct timings_settings *settings)
{
  struct timings t = {.settings = settings, .queue = queue};
  t.path = path_of("%s/timings.jsonl", queue->results);
  t.json = path_of("%s/timed-%d.tmp", queue->results, (int)getpid());
  t.timing = calloc((size_t)queue->n + 1, sizeof *t.timing);
  const status result = t.timing ? take_all(&t) : status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < t.n; k++) {
    json_decref(t.timing[k].facts);
    free(t.timing[k].seconds);
  }
  free(t.timing);
  return result;
}
