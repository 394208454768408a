/* options.h - what a user typed, as the command-line contract has it. */
#ifndef OPTIONS_H
#define OPTIONS_H
#include "../base/status.h"

/* The verbs that a variant carries out, as bits: which of them take a flag. */
enum { FOR_RUN = 1, FOR_SPEED = 2, FOR_LISTS = 4, FOR_MANY = FOR_RUN | FOR_SPEED, FOR_ALL = 7 };

/* O(member, flag, argument, verbs, meaning) */
#define OPTION_LIST(O)                                                                           \
  O(solver, "--solver", "NAME", FOR_RUN, "pressure solver (sphbench list solvers)")              \
  O(solvers, "--solvers", "A,B", FOR_SPEED, "only these solvers")                                \
  O(dt, "--dt", "S", FOR_RUN, "time step [s]")                                                   \
  O(t_end, "--t-end", "S", FOR_RUN, "end of the simulated time [s]")                             \
  O(spacing, "--spacing", "M", FOR_RUN, "particle spacing [m]")                                  \
  O(dim, "--dim", "2|3", FOR_ALL, "number of dimensions")                                        \
  O(seed, "--seed", "N", FOR_RUN, "seed of everything random")                                   \
  O(precision, "--precision", "float|double", FOR_ALL, "arithmetic")                             \
  O(backend, "--backend", "openmp|cuda", FOR_ALL, "machine")                                     \
  O(threads, "--threads", "N", FOR_MANY, "number of threads")                                    \
  O(frames, "--frames", "N", FOR_RUN, "frames in the result file, besides the start")            \
  O(output, "-o", "FILE", FOR_RUN, "result file (.vtkhdf)")                                      \
  O(checkpoint, "--checkpoint", "S", FOR_RUN, "write FILE.restart every S seconds of wall time") \
  O(restart, "--restart", "FILE", FOR_RUN, "go on from such a file, with the same arguments")    \
  O(json, "--json", "FILE", FOR_ALL, "the facts as JSON; - for standard output")                 \
  O(plugin, "--plugin", "PATH", FOR_ALL, "solvers from outside (docs/plug-ins.md)")              \
  O(particles, "--particles", "N", FOR_SPEED, "about so many particles")

/* O(member, flag, verbs, meaning) */
#define SWITCH_LIST(O)                                                                     \
  O(quiet, "--quiet", FOR_RUN, "say nothing but errors")                                   \
  O(explain, "--explain", FOR_RUN, "say what the scene needed and what was left out")      \
  O(count_pairs, "--count-pairs", FOR_RUN, "count the neighbour pairs that are visited")   \
  O(dry_run, "--dry-run", FOR_RUN, "resolve and check the request, run and write nothing") \
  O(help, "--help", FOR_ALL, "this text")

enum { MAX_SETS = 64 };
struct options {
  const char *verb, *name; /* "run", "rotating-patch"; NULL if missing */
#define O(member, flag, argument, verbs, meaning) const char *member;
  OPTION_LIST(O)
#undef O
#define O(member, flag, verbs, meaning) int member;
  SWITCH_LIST(O)
#undef O
  const char *set[MAX_SETS]; /* KEY=VALUE */
  int num_sets;
  int json_output; /* --json was given (list and show take no file) */
  int argc;
  char **argv;
};

/* Errors: ERR_USER with the flag, what was found, and the nearest known one. */
status options_parse(struct options *o, int argc, char **argv);
/* ERR_USER where a flag was given that the verb does not take. */
status options_check(const struct options *o);
/* The flags of o->verb. */
void options_help(const struct options *o);

/* A whole number of a flag in [low, high]; `initial` where text is NULL. */
status option_whole(const char *flag, const char *text, long low, long high, long initial,
                    long *value);
#endif
