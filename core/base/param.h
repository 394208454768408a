/* param.h - named numbers and choices of solvers and scenes, each described once by a row. */
#ifndef PARAM_H
#define PARAM_H
#include <stddef.h>
#include "status.h"
#ifdef __cplusplus
extern "C" {
#endif

/* One parameter. A unit that contains '|' lists the words of a choice, whose value is the word's
 * number from 0. A parameter of unit WHOLE takes whole numbers only. */
#define WHOLE "count"
struct param {
  const char *name;
  double initial, low, high; /* default and allowed range, both ends included */
  const char *unit, *meaning;
  size_t offset; /* of the `real` in the state */
};

#define PARAM_MEMBER(name, initial, low, high, unit, meaning) real name;
#define PARAM_ROW(name, initial, low, high, unit, meaning) \
  {#name, initial, low, high, unit, meaning, offsetof(state, name)},
#define PARAM_TABLE(LIST) \
  {                       \
    LIST(PARAM_ROW)       \
  }
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

/* The value [number, or index of the word of a choice] that `text` means for p, within p's range;
 * else the user's error. `where` names the place of the text ("--set", "plan.yaml:12"). */
status param_parse(const struct param *p, const char *text, const char *where, double *value);

/* The text that a user would write for this value; buf of at least 64 bytes is returned. */
char *param_text(const struct param *p, double value, char *buf);

const struct param *param_find(const struct param *params, int n, const char *name);

#ifdef __cplusplus
}
#endif
#endif
