/* choices.h - a solver's parameters by name, for tests over the registry. */
#ifndef CHOICES_H
#define CHOICES_H
#include "laws.h"

enum { MOST_PARAMS = 64 };

static inline int param_number(const struct solver *solver, const char *name)
{
  for (int k = 0; k < solver->num_params; k++)
    if (strcmp(solver->params[k].name, name) == 0) return k;
  return -1;
}

/* Set value [num_params] of that name; returns whether there is one. */
static inline int set_param(const struct solver *solver, double *values, const char *name,
                            double value)
{
  const int k = param_number(solver, name);
  if (k >= 0) values[k] = value;
  return k >= 0;
}

/* The number of a word among "a|b|c"; -1: it is none. */
static inline int choice(const struct solver *solver, const char *name, const char *word)
{
  const int k = param_number(solver, name);
  int number = 0;
  if (k < 0) return -1;
  for (const char *at = solver->params[k].unit; *at; number++) {
    const size_t length = strcspn(at, "|");
    if (strlen(word) == length && strncmp(at, word, length) == 0) return number;
    at += length + (at[length] == '|');
  }
  return -1;
}
#endif
