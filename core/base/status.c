#include "status.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROOM = 2048, TAIL = 512 };
static char sentence[ROOM];

/* Of a sentence that is too long the middle goes: at its end stands what is allowed. */
static void keep_tail(int length, const char *format, va_list arguments)
{
  char *whole = malloc((size_t)length + 1);
  if (!whole) return;
  vsnprintf(whole, (size_t)length + 1, format, arguments);
  snprintf(sentence + ROOM - TAIL, TAIL, " ... %s", whole + length - (TAIL - 6));
  free(whole);
}

status status_set(status code, const char *format, ...)
{
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = vsnprintf(sentence, sizeof sentence, format, arguments);
  if (length >= ROOM) keep_tail(length, format, again);
  va_end(again);
  va_end(arguments);
  for (char *c = sentence; *c; c++) /* what a user typed may hold line ends and escapes */
    if ((unsigned char)*c < ' ' || *c == 127) *c = '?';
  return code;
}

const char *status_sentence(void) { return sentence; }

int status_exit_code(status code)
{
  switch (code) {
#define S(name, exit_code, text) \
  case name: return exit_code;
    STATUS_LIST(S)
#undef S
  default: return 3;
  }
}

/* Levenshtein distance, cut off where it no longer matters; words of up to 63 letters. */
static int edit_distance(const char *a, const char *b)
{
  const size_t m = strlen(a), n = strlen(b);
  if (m > 63 || n > 63) return 99;
  int row[64];
  for (size_t j = 0; j <= n; j++) row[j] = (int)j;
  for (size_t i = 1; i <= m; i++) {
    int diagonal = row[0];
    row[0] = (int)i;
    for (size_t j = 1; j <= n; j++) {
      const int above = row[j], change = diagonal + (a[i - 1] != b[j - 1]);
      int best = above + 1 < row[j - 1] + 1 ? above + 1 : row[j - 1] + 1;
      if (change < best) best = change;
      diagonal = above;
      row[j] = best;
    }
  }
  return row[n];
}

const char *nearest_name(const char *wanted, const char *const *names, int n)
{
  const char *best = NULL;
  int nearest = (int)strlen(wanted) / 2 + 1;
  for (int i = 0; i < n; i++) {
    const int distance = edit_distance(wanted, names[i]);
    if (distance <= nearest && (!best || distance < nearest)) {
      nearest = distance;
      best = names[i];
    }
  }
  return best;
}
