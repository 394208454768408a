/* The points' timed runs (timed.h), in rounds. What was timed before, on this processor with this
 * executable, is not timed again. */
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "../../core/base/clock.h"
#include "../../core/base/progress.h"
#include "precision.h"

enum { START = 1 /* s, from starting a process to its first step, at most */ };
#define USUAL_START 0.06 /* s */

/* --- what was timed before: RESULTS/precision/SCENE/timings.jsonl --- */

static struct path timings_path(const struct precision *p)
{
  return path_of("%s/precision/%s/timings.jsonl", p->queue.results, p->study.ask.scene);
}

static const char *processor_name(const struct precision *p)
{
  for (int k = 0; k < p->n; k++) {
    const json_t *cpu = json_object_get(json_object_get(p->point[k].facts, "provenance"), "cpu");
    if (json_string_value(cpu)) return json_string_value(cpu);
  }
  return "";
}

static void take_time(struct precision *p, const json_t *line)
{
  const char *id = json_string_value(json_object_get(line, "id"));
  const char *cpu = json_string_value(json_object_get(line, "cpu"));
  const long arm = (long)json_integer_value(json_object_get(line, "arm"));
  const long threads = (long)json_integer_value(json_object_get(line, "threads"));
  if (!id || !cpu || strcmp(cpu, processor_name(p)) != 0) return;
  if (arm < 0 || arm >= ARMS || threads != p->threads) return;
  for (int k = 0; k < p->n; k++) {
    struct point *point = &p->point[k];
    if (!point->timed.argc || strcmp(point->timed.id, id) != 0) continue;
    if (point->taken[arm] == p->repeat) continue;
    const int at = point->taken[arm]++;
    point->seconds[arm][at] = fact_number(line, "seconds");
    point->setup[arm][at] = fact_number(line, "setup");
  }
}

static status take_earlier(struct precision *p)
{
  const struct path path = timings_path(p);
  char *text;
  size_t size;
  if (p->fresh || !path_is_file(path.text)) return OK;
  TRY(file_read(path.text, &text, &size));
  for (char *rest = text, *line; (line = strsep(&rest, "\n"));) {
    json_t *object = json_loads(line, 0, NULL);
    if (object) take_time(p, object);
    json_decref(object);
  }
  free(text);
  return OK;
}

static status note_time(const struct precision *p, const struct point *point, int arm,
                        const struct timed *timed)
{
  const double setup = point->setup[arm][point->taken[arm] - 1];
  const struct path path = timings_path(p);
  char date[32];
  const time_t now = time(NULL);
  struct tm utc;
  strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  json_t *line = json_pack(
    "{s:s, s:i, s:f, s:f, s:s, s:I, s:s, s:s, s:f, s:f, s:f}", "id", point->timed.id, "arm", arm,
    "seconds", point->seconds[arm][point->taken[arm] - 1], "setup", setup, "cpu", processor_name(p),
    "threads", (json_int_t)p->threads, "solver", point_solver(p, point), "date", date,
    "load_before", timed->load_before, "load_after", timed->load_after, "others", timed->others);
  return timed_note(path.text, line);
}

/* --- one timed run --- */

/* The facts that two runs of the same thing share to the last bit. */
static int same_results(const json_t *a, const json_t *b)
{
  static const char *const keys[] = {"steps", "time_end", "iterations.total",
                                     "metrics.kinetic_energy.value",
                                     "metrics.density_error_max.value"};
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
    const double x = fact_number(a, keys[k]), y = fact_number(b, keys[k]);
    if (x != y && !(isnan(x) && isnan(y))) return 0;
  }
  return 1;
}

/* Time of a run and of what it does before and after; a run that does not compute what the untimed
 * one did makes the point invalid. */
static void take_facts(struct point *point, int arm, const struct timed *timed)
{
  const char *word = json_string_value(json_object_get(timed->facts, "status"));
  if (!word || strcmp(word, "ok") != 0) {
    point->reason = text_make("its timed run ended otherwise: %s", word ? word : "without facts");
  } else if (!same_results(timed->facts, point->facts)) {
    point->reason = strdup("its timed run computed something else than the untimed one");
  } else {
    const int at = point->taken[arm]++;
    point->seconds[arm][at] = timed->seconds;
    point->setup[arm][at] = timed->wall - fact_number(timed->facts, "timing.total");
  }
}

static status time_once(struct precision *p, struct point *point, int arm)
{
  const struct path json = path_of("%s/timed-%d.tmp", p->folder.text, (int)getpid());
  const struct timed_request request = {&point->timed, &p->cores, p->threads,
                                        10 * point->rough + START, json.text};
  struct timed timed;
  TRY(timed_once(&request, &timed));
  p->wall += timed.wall;
  p->others += timed.others;
  const int before = point->taken[arm];
  if (timed.stopped)
    point->reason =
      text_make("its timed run takes longer than %.3g s, ten times the untimed one", request.limit);
  else
    take_facts(point, arm, &timed);
  json_decref(timed.facts);
  return point->taken[arm] > before ? note_time(p, point, arm, &timed) : OK;
}

/* With the shortest that is to be timed. */
static status warm_up(struct precision *p)
{
  int shortest = -1;
  for (int k = 0; k < p->n; k++) {
    const struct point *point = &p->point[k];
    if (!point->timed.argc || point->taken[0] == p->repeat) continue;
    if (shortest < 0 || point->rough < p->point[shortest].rough) shortest = k;
  }
  return shortest < 0 ? OK : timed_warm_up(&p->point[shortest].timed, &p->cores, p->threads);
}

/* --- the rounds --- */

static int arms_of(const struct precision *p) { return p->aa ? ARMS : 1; }

static double left_to_do(const struct precision *p)
{
  double seconds = 0;
  for (int k = 0; k < p->n; k++)
    for (int a = 0; a < arms_of(p) && p->point[k].timed.argc && !p->point[k].reason; a++)
      seconds += (p->point[k].rough + USUAL_START) * (double)(p->repeat - p->point[k].taken[a]);
  return seconds;
}

/* Turn number t of a round: which point and arm, there or back. */
static status take_turn(struct precision *p, long round, int t)
{
  const int at = timed_turn(round, t, p->n * arms_of(p));
  struct point *point = &p->point[at / arms_of(p)];
  const int arm = at % arms_of(p);
  if (!point->timed.argc || point->reason || point->taken[arm] > round) return OK;
  return time_once(p, point, arm);
}

static status take_rounds(struct precision *p)
{
  struct progress bar;
  status result = OK;
  const double all = left_to_do(p);
  progress_begin(&bar, "timing", p->quiet);
  for (long round = 0; round < p->repeat && result == OK; round++)
    for (int t = 0; t < p->n * arms_of(p) && result == OK; t++) {
      result = take_turn(p, round, t);
      const struct path note = path_of("round %ld of %ld", round + 1, p->repeat);
      if (all > 0) progress_show(&bar, 1 - left_to_do(p) / all, note.text);
    }
  progress_end(&bar);
  return result;
}

/* --- what to time --- */

static status prepare_point(struct precision *p, struct point *point)
{
  for (int a = 0; a < ARMS; a++) {
    point->seconds[a] = calloc((size_t)p->repeat, sizeof(double));
    point->setup[a] = calloc((size_t)p->repeat, sizeof(double));
    if (!point->seconds[a] || !point->setup[a]) return status_set(ERR_MEMORY, "out of memory");
  }
  return study_timed(&p->study, &point->knobs, &point->timed);
}

/* The valid points whose repetitions fit into what is left of the budget. */
static status choose(struct precision *p, int *keep)
{
  const double reserve = 15; /* s, to write and draw */
  struct candidate *all = calloc((size_t)p->n + 1, sizeof *all);
  if (!all) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < p->n; k++) {
    const struct point *point = &p->point[k];
    const double rough = point->reason ? (double)NAN : point->rough + USUAL_START;
    all[k] = (struct candidate){point->knobs.method, k, point->error, rough, rough, rough};
  }
  const double left = p->budget - (clock_now() - p->begun) - reserve;
  const double room = p->budget > 0 ? fmax(left, 0) / (double)(p->repeat * arms_of(p)) : HUGE_VAL;
  drop_slow(all, p->n, room, keep);
  free(all);
  return OK;
}

static status prepare(struct precision *p)
{
  int *keep = calloc((size_t)p->n + 1, sizeof *keep);
  status result = keep ? choose(p, keep) : status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < p->n && result == OK; k++) {
    struct point *point = &p->point[k];
    if (keep[k])
      result = prepare_point(p, point);
    else if (!point->reason && !point->note)
      point->note = text_make("not timed, for want of time: about %.2g s", point->rough);
  }
  free(keep);
  return result;
}

/* --- what the times say --- */

/* Medians of the times of even and of odd rounds, or of the two arms. */
static void split(const struct precision *p, const struct point *point, double *a, double *b)
{
  double part[2][256];
  int n[2] = {0, 0};
  const int arms = arms_of(p);
  for (int arm = 0; arm < arms; arm++)
    for (int k = 0; k < point->taken[arm] && k < 256; k++) {
      const int to = arms > 1 ? arm : k % 2;
      part[to][n[to]++] = point->seconds[arm][k];
    }
  *a = n[0] ? interval_of_median(part[0], n[0]).median : (double)NAN;
  *b = n[1] ? interval_of_median(part[1], n[1]).median : (double)NAN;
}

/* RESULTS/precision/noise.json: what the last --aa found on this machine. */
static struct path noise_path(const struct precision *p)
{
  return path_of("%s/precision/noise.json", p->queue.results);
}

static double known_floor(const struct precision *p)
{
  const struct path path = noise_path(p);
  json_t *noise = json_load_file(path.text, 0, NULL);
  const char *cpu = json_string_value(json_object_get(noise, "cpu"));
  const int mine = cpu && strcmp(cpu, processor_name(p)) == 0 &&
                   json_integer_value(json_object_get(noise, "threads")) == p->threads;
  const double floor = mine ? fact_number(noise, "floor") : 1;
  json_decref(noise);
  return floor >= 1 ? floor : 1;
}

static status keep_floor(const struct precision *p)
{
  const struct path path = noise_path(p);
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fprintf(file.stream, "{\"floor\": %.6g, \"threads\": %ld, \"scene\": \"%s\", \"cpu\": ", p->floor,
          p->threads, p->study.ask.scene);
  json_t *cpu = json_string(processor_name(p));
  json_dumpf(cpu, file.stream, JSON_ENCODE_ANY);
  json_decref(cpu);
  fputs("}\n", file.stream);
  return file_commit(&file);
}

static status find_floor(struct precision *p)
{
  double *a = calloc((size_t)p->n + 1, sizeof *a), *b = calloc((size_t)p->n + 1, sizeof *b);
  int n = 0;
  for (int k = 0; a && b && k < p->n; k++)
    if (p->point[k].taken[0] > 1 && !p->point[k].reason) split(p, &p->point[k], &a[n], &b[n]), n++;
  if (a && b) p->floor = noise_floor(a, b, n);
  p->floor_means =
    p->aa ? "each point timed under two names" : "even against odd repetitions of each point";
  free(a);
  free(b);
  if (!a || !b) return status_set(ERR_MEMORY, "out of memory");
  if (p->aa) return n ? keep_floor(p) : OK;
  const double known = known_floor(p);
  if (known > p->floor) {
    p->floor = known;
    p->floor_means = "the last --aa on this machine";
  }
  return OK;
}

static void summarise(const struct precision *p, struct point *point)
{
  if (point->taken[0] < p->repeat || point->reason) return;
  double *copy = malloc(sizeof *copy * (size_t)p->repeat);
  if (!copy) return;
  memcpy(copy, point->seconds[0], sizeof *copy * (size_t)p->repeat);
  point->time = interval_of_median(copy, (int)p->repeat);
  memcpy(copy, point->setup[0], sizeof *copy * (size_t)p->repeat);
  point->setup_median = interval_of_median(copy, (int)p->repeat).median;
  free(copy);
}

status times_take(struct precision *p)
{
  double load[1] = {0};
  if (getloadavg(load, 1) == 1) p->load = load[0];
  p->cores = cores_idle_first();
  TRY(prepare(p));
  TRY(take_earlier(p));
  TRY(warm_up(p));
  TRY(take_rounds(p));
  TRY(find_floor(p)); /* before anything is sorted */
  for (int k = 0; k < p->n; k++) summarise(p, &p->point[k]);
  return OK;
}
