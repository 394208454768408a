/* timed.h - runs whose time counts. Each is a process of its own on idle cores that are its alone
 * as far as this program decides: nothing else of ours runs beside it, and its threads do not move.
 * Runs take turns there and back (A B C, C B A, ...), so that a machine that gets slower favours
 * none. What the rest of the machine did meanwhile is kept with the time. */
#ifndef TIMED_H
#define TIMED_H
#include <jansson.h>
#include "cores.h"
#include "runs.h"

struct timed {
  double wall;                    /* [s], with the start of the process */
  double seconds;                 /* [s], without start, metrics and output */
  double load_before, load_after; /* processes that wanted a core, mean of the last minute */
  double others;                  /* core seconds of other processes meanwhile */
  int stopped;                    /* 1: it had to be, at its limit */
  json_t *facts;                  /* what it says of itself; NULL: nothing. To be released */
};

/* One such run, of `threads` threads, on the first of the cores, for at most `limit` seconds; json:
 * where it writes its facts, which are removed. ERR_IO: it cannot be started; ERR_MEMORY. That it
 * fails otherwise is no error. */
struct timed_request {
  const struct run *run;
  const struct cores *cores;
  long threads;
  double limit;
  const char *json;
};
status timed_once(const struct timed_request *request, struct timed *result);

/* Run it for half a second, or once, without taking the time, for the machine's sake: its clock,
 * its caches, the file's pages. */
status timed_warm_up(const struct run *run, const struct cores *cores, long threads);

/* Who of `n` has turn number t of a round. */
int timed_turn(long round, int t, int n);

/* Add an object as a line to a file, and release it. ERR_IO, ERR_MEMORY. */
status timed_note(const char *path, json_t *line);

/* --- timings.c: the times of a queue's runs, in RESULTS/timings.jsonl --- */

/* Take what is missing to `repeat` times of each run that ended ok, on this kind of processor, and
 * print medians with intervals and a warning where the machine was busy. ERR_IO, ERR_MEMORY;
 * ERR_RUN: stopped. */
struct timings_settings {
  long repeat, threads;
  int fresh, quiet;
};
status timings_take(const struct queue *queue, const struct timings_settings *settings);

#endif
