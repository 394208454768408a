/* arguments.h - flags of the verbs that the front end carries out itself. */
#ifndef ARGUMENTS_H
#define ARGUMENTS_H
#include "../../core/base/status.h"

/* A flag: one with a value stores it in *text, one without sets *is_on. */
struct flag {
  const char *name;
  const char **text;
  int *is_on;
};

/* Parse argv[2] and on (behind the verb). What is no flag is put into names [most] (in order);
 * *num_names may be NULL where none is allowed. ERR_USER. */
struct arguments {
  const char *verb;
  const struct flag *flags;
  int num_flags;
  const char **names;
  int most_names, *num_names;
};
status arguments_parse(const struct arguments *what, int argc, char **argv);

/* The values of all --set KEY=VALUE, which may be given several times: into set [most]. ERR_USER.
 */
status arguments_sets(int argc, char **argv, char **set, int most, int *num_sets);

/* A whole number in [low, high]; *value is kept where text is NULL. ERR_USER. */
status argument_whole(const char *flag, const char *text, long low, long high, long *value);

#endif
