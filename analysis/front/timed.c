#include "timed.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "../../core/base/clock.h"
#include "process.h"

int timed_turn(long round, int t, int n) { return round % 2 ? n - 1 - t : t; }

status timed_note(const char *path, json_t *line)
{
  char *text = line ? json_dumps(line, JSON_COMPACT) : NULL;
  json_decref(line);
  if (!text) return status_set(ERR_MEMORY, "out of memory for '%s'", path);
  FILE *file = fopen(path, "a");
  const int failed = !file || fprintf(file, "%s\n", text) < 0;
  free(text);
  if ((file && fclose(file)) || failed)
    return status_set(ERR_IO, "cannot write '%s': %s", path, strerror(errno));
  return OK;
}

/* Wait for at most `limit` seconds; 0 if it had to be stopped. */
static int wait_until(pid_t child, double limit, struct rusage *used)
{
  const struct timespec pause = {.tv_nsec = 500 * 1000};
  const double begun = clock_now();
  int state;
  for (;;) {
    const pid_t ended = wait4(child, &state, WNOHANG, used);
    if (ended == child || (ended < 0 && errno != EINTR)) return 1;
    if (clock_now() - begun > limit) break;
    nanosleep(&pause, NULL);
  }
  kill(child, SIGKILL);
  wait4(child, &state, 0, used);
  return 0;
}

static double load(void)
{
  double last_minute = 0;
  return getloadavg(&last_minute, 1) == 1 ? last_minute : 0;
}

static double seconds_of(struct timeval t) { return (double)t.tv_sec + 1e-6 * (double)t.tv_usec; }

static status start(const struct timed_request *r, pid_t *child)
{
  char threads[16];
  snprintf(threads, sizeof threads, "%ld", r->threads);
  const char *const more[] = {"--threads", threads, "--quiet", r->json ? "--json" : NULL, r->json};
  enum { NUM_MORE = sizeof more / sizeof *more };
  const char **argv = calloc((size_t)r->run->argc + NUM_MORE + 2, sizeof *argv);
  if (!argv) return status_set(ERR_MEMORY, "out of memory");
  argv[0] = r->run->executable.text;
  for (int k = 0; k < r->run->argc; k++) argv[1 + k] = r->run->argv[k];
  for (int k = 0; k < NUM_MORE; k++) argv[1 + r->run->argc + k] = more[k];
  const struct process process = {.argv = argv,
                                  .log = "/dev/null",
                                  .one_thread = r->threads == 1,
                                  .cores = r->cores->processor,
                                  .num_cores = (int)(r->threads <= r->cores->n ? r->threads : 0)};
  const status result = process_start(&process, child);
  free(argv);
  return result;
}

/* What the run did itself, from its facts. */
static double own_seconds(const json_t *facts)
{
  const json_t *timing = json_object_get(facts, "timing");
  return json_number_value(json_object_get(timing, "total")) -
         json_number_value(json_object_get(timing, "metrics")) -
         json_number_value(json_object_get(timing, "output"));
}

status timed_once(const struct timed_request *r, struct timed *result)
{
  pid_t child;
  struct rusage used, mine_before, mine;
  memset(&used, 0, sizeof used);
  *result = (struct timed){.load_before = load()};
  const double busy = cores_busy_seconds(), begun = clock_now();
  getrusage(RUSAGE_SELF, &mine_before);
  TRY(start(r, &child));
  result->stopped = !wait_until(child, r->limit, &used);
  result->wall = clock_now() - begun;
  getrusage(RUSAGE_SELF, &mine);
  result->others = cores_busy_seconds() - busy - seconds_of(used.ru_utime) -
                   seconds_of(used.ru_stime) - seconds_of(mine.ru_utime) -
                   seconds_of(mine.ru_stime) + seconds_of(mine_before.ru_utime) +
                   seconds_of(mine_before.ru_stime);
  result->load_after = load();
  result->facts = r->json ? json_load_file(r->json, 0, NULL) : NULL;
  result->seconds = own_seconds(result->facts);
  if (r->json) unlink(r->json);
  return OK;
}

status timed_warm_up(const struct run *run, const struct cores *cores, long threads)
{
  const struct timed_request request = {run, cores, threads, 3600, NULL};
  const double begun = clock_now(), enough = 0.5;
  status result = OK;
  for (int k = 0; k < 50 && result == OK && (k == 0 || clock_now() - begun < enough); k++) {
    struct timed unused;
    result = timed_once(&request, &unused);
  }
  return result;
}
