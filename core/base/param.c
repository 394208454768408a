#include "param.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int is_choice(const struct param *p) { return strchr(p->unit, '|') != NULL; }

static int is_whole(const struct param *p) { return strcmp(p->unit, WHOLE) == 0; }

const struct param *param_find(const struct param *params, int n, const char *name)
{
  for (int i = 0; i < n; i++)
    if (strcmp(params[i].name, name) == 0) return &params[i];
  return NULL;
}

/* The k-th word of a choice in buf; NULL past the last. */
static const char *choice_word(const struct param *p, int k, char *buf, size_t size)
{
  const char *word = p->unit;
  for (; k > 0 && word; k--) {
    word = strchr(word, '|');
    if (word) word++;
  }
  if (!word) return NULL;
  snprintf(buf, size, "%.*s", (int)strcspn(word, "|"), word);
  return buf;
}

status param_parse(const struct param *p, const char *text, const char *where, double *value)
{
  char word[64];
  if (is_choice(p)) {
    for (int k = 0; choice_word(p, k, word, sizeof word); k++)
      if (strcmp(word, text) == 0) {
        *value = k;
        return OK;
      }
    return user_error("%s: %s is '%s', allowed is one of %s", where, p->name, text, p->unit);
  }
  char *end;
  errno = 0;
  const double number = strtod(text, &end);
  while (*end == ' ') end++;
  if (end == text || *end || isnan(number) || (errno == ERANGE && fabs(number) > 1))
    return user_error("%s: %s is '%s', which is not a number [%s]", where, p->name, text, p->unit);
  if (is_whole(p) && number != rint(number))
    return user_error("%s: %s is %s, allowed are whole numbers from %g to %g", where, p->name, text,
                      p->low, p->high);
  if (number < p->low || number > p->high)
    return user_error("%s: %s is %s, allowed is %g to %g [%s]", where, p->name, text, p->low,
                      p->high, p->unit);
  *value = number;
  return OK;
}

char *param_text(const struct param *p, double value, char *buf)
{
  if (is_choice(p)) {
    if (!choice_word(p, (int)value, buf, 64)) snprintf(buf, 64, "?");
  } else {
    snprintf(buf, 64, "%.9g", value);
  }
  return buf;
}
