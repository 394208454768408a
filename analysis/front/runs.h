/* runs.h - runs that are carried out once: a queue of requests, each known by what it computes and
 * by the executable that computes it. Results lie in RESULTS/runs/<id>.json, .vtkhdf and .log, and
 * the end of each is a line of RESULTS/journal.jsonl. The whole may be killed at any time; what was
 * finished is not run again. */
#ifndef RUNS_H
#define RUNS_H
#include "journal.h"

/* One run as a user would type it; NULL: the scene's or the program's own default. */
struct run_request {
  const char *scene, *solver;
  const char *dim, *precision, *backend, *dt, *t_end, *spacing, *frames, *seed, *threads;
  int count_pairs;
  char *const *set; /* KEY=VALUE [num_sets] */
  int num_sets;
  const char *vary, *value; /* one parameter more, by its name; NULL: none */
};

struct run {
  char id[HASH_TEXT];
  struct path executable, name; /* name: of the variant */
  char **argv;                  /* NULL-terminated, without the files to write */
  int argc, threads;
  char *what; /* the arguments behind `run SCENE --solver NAME`, as one text */
  enum outcome outcome;
  char *reason;
  double seconds;
  int finished; /* has an outcome */
};

struct queue {
  struct run *run;
  int n, room;
  const char *results;
  struct journal journal;
  int jobs;     /* threads of all runs at once, or one run that has more */
  double limit; /* [s] that a run may take; 0: any */
  long memory;  /* [MiB] that a run may hold; 0: any */
  int quiet;    /* no progress */
  int done;     /* were run just now */
};

/* What a request is to be run as, without running it: executable, arguments, id. ERR_USER, ERR_IO,
 * ERR_MEMORY. */
status run_make(const struct run_request *request, struct run *run);
void run_release(struct run *run);

/* Open the journal of `results`, making the folder. ERR_IO, ERR_USER. */
status queue_open(struct queue *queue, const char *results);

/* The same for one of several processes that work into `results` at once; `part` names it. */
status queue_open_part(struct queue *queue, const char *results, const char *part);

/* Add a request, or find the one that is the same; its number in *number. ERR_USER: its variant is
 * not built; ERR_IO, ERR_MEMORY. */
status queue_add(struct queue *queue, const struct run_request *request, int *number);

/* Add the run of these arguments: argv [argc], as struct run has them, copied. ERR_USER, ERR_IO,
 * ERR_MEMORY. */
status queue_add_arguments(struct queue *queue, const char *const *argv, int argc, int *number);

/* Carry out what is not finished, up to `jobs` at once. ERR_RUN: stopped by Ctrl-C or SIGTERM
 * (after the children stopped); ERR_IO. A run that fails is no error here but an outcome. */
status queue_work(struct queue *queue);

/* Seconds that the last run with the same arguments took, by any build; 0: it was never run. */
double queue_known_time(const struct queue *queue, const struct run *run);

/* That, or the mean of the queue's finished runs, or 10 s where there is none. */
double queue_expected_time(const struct queue *queue, const struct run *run);

/* The file of a run: suffix "json", "vtkhdf" or "log". */
struct path run_file(const char *results, const char *id, const char *suffix);

/* Why a run ended with OUTCOME_OOM; written and read back. */
#define OOM_REASON "needs more than %ld MiB"

/* The last line of a log, without the program's name; to be released by free(). */
char *run_last_words(const char *log);

void queue_close(struct queue *queue);

/* Processors that this process may use. */
int processors(void);

#endif
