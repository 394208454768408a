/* options.h - what a user typed, as the command-line contract has it. */
#ifndef OPTIONS_H
#define OPTIONS_H
#include "../base/status.h"

/* O(member, flag, argument, meaning): every flag of the verbs that a variant carries out. */
#define OPTION_LIST(O)                                                                                 \
  O(solver, "--solver", "NAME", "pressure solver (sphbench list solvers)")                             \
  O(solvers, "--solvers", "A,B", "only these solvers")                                                 \
  O(dt, "--dt", "S", "time step [s]")                                                                  \
  O(t_end, "--t-end", "S", "end of the simulated time [s]")                                            \
  O(spacing, "--spacing", "M", "particle spacing [m]")                                                 \
  O(dim, "--dim", "2|3", "number of dimensions")                                                       \
  O(seed, "--seed", "N", "seed of everything random")                                                  \
  O(precision, "--precision", "float|double", "arithmetic")                                            \
  O(backend, "--backend", "openmp|cuda", "machine")                                                    \
  O(threads, "--threads", "N", "number of threads")                                                    \
  O(frames, "--frames", "N", "frames in the result file, besides the start")                           \
  O(output, "-o", "FILE", "result file (.vtkhdf)")                                                     \
  O(json, "--json", "FILE", "facts of the run as JSON; - for standard output")                         \
  O(particles, "--particles", "N", "about so many particles (speed)")

/* O(member, flag, meaning) */
#define SWITCH_LIST(O)                                                         \
  O(quiet, "--quiet", "say nothing but errors")                                \
  O(explain, "--explain", "say what the scene needed and what was left out")   \
  O(dry_run, "--dry-run", "resolve and check everything, run nothing")         \
  O(help, "--help", "this text")

enum { MAX_SETS = 64 };
struct options {
  const char *verb, *name;        /* "run", "rotating-patch"; NULL if missing */
#define O(member, flag, argument, meaning) const char *member;
  OPTION_LIST(O)
#undef O
#define O(member, flag, meaning) int member;
  SWITCH_LIST(O)
#undef O
  const char *set[MAX_SETS];      /* KEY=VALUE */
  int num_sets;
  int json_output;                /* --json was given (list and show take no file) */
  int argc;
  char **argv;
};

/* Errors: ERR_USER with the flag, what was found, and the nearest known one. */
status options_parse(struct options *o, int argc, char **argv);
void options_help(void);

/* A whole number of a flag in [low, high]; `initial` where text is NULL. */
status option_whole(const char *flag, const char *text, long low, long high, long initial, long *value);
#endif
