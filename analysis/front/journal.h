/* journal.h - RESULTS/journal.jsonl: one line of JSON for each run that came to an end. The line is
 * written after the run's files are whole, so a run without a line is not finished. Processes that
 * share one RESULTS, perhaps from several machines, each write a part of their own,
 * journal-NAME.part.jsonl; every reader reads the parts too, and the next to write alone takes them
 * in. */
#ifndef JOURNAL_H
#define JOURNAL_H
#include "files.h"

/* How a run ended. O(name, word, meaning) */
#define OUTCOME_LIST(O)                                                          \
  O(OK, "ok", "ran to its end")                                                  \
  O(DIVERGED, "diverged", "failed numerically, which is a result")               \
  O(UNABLE, "skipped",                                                           \
    "was refused: the solver cannot do this scene, or a mistake in the request") \
  O(CRASHED, "crashed", "ended by a signal or without a result")                 \
  O(TIMEOUT, "timeout", "was stopped at its time limit")                         \
  O(OOM, "oom", "needed more memory than its limit")                             \
  O(INTERRUPTED, "interrupted", "was stopped from outside, and is to be run again")
#define O(name, word, meaning) OUTCOME_##name,
enum outcome { OUTCOME_LIST(O) NUM_OUTCOMES };
#undef O
extern const char *const outcome_words[NUM_OUTCOMES];

struct journal_entry {
  char id[HASH_TEXT];
  enum outcome outcome;
  int exit_code;
  double seconds;                        /* wall time */
  char *reason;                          /* "" where there is nothing to say */
  char *scene, *solver, *variant, *what; /* what: the arguments behind `run SCENE --solver NAME` */
  char date[32];                         /* ISO 8601, UTC, of the end */
};

struct journal {
  struct journal_entry *entry;
  int n, room;
  int file;   /* -1: only read */
  int shared; /* of a part: the journal, locked against one who writes alone; 0: none */
};

/* Read results/journal.jsonl and its parts, none if they are missing; a line that is torn or not
 * ours is passed over. With `write` the journal is locked for this process, and the parts become
 * lines of it. ERR_IO; ERR_USER: another process has it, or a part of it. */
status journal_open(struct journal *journal, const char *results, int write);

/* The same for one of several processes, which adds to the part `name` alone. ERR_IO; ERR_USER:
 * another process has this part, or all of the journal. */
status journal_open_part(struct journal *journal, const char *results, const char *name);

/* The last entry of this id, or NULL. */
const struct journal_entry *journal_find(const struct journal *journal, const char *id);

/* Number of entries of this id. */
int journal_count(const struct journal *journal, const char *id);

/* Add a line (and the entry, whose texts are copied). ERR_IO. */
status journal_add(struct journal *journal, const struct journal_entry *entry);

void journal_close(struct journal *journal);

#endif
