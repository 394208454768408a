#include "options.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
  const char *flag, *argument, *meaning;
  size_t offset;
} flags[] = {
#define O(member, flag, argument, meaning) {flag, argument, meaning, offsetof(struct options, member)},
    OPTION_LIST(O)
#undef O
#define O(member, flag, meaning) {flag, NULL, meaning, offsetof(struct options, member)},
    SWITCH_LIST(O)
#undef O
    {"--set", "KEY=VALUE", "a parameter of the solver or the scene (sphbench show NAME)", 0},
};
enum { NUM_FLAGS = sizeof flags / sizeof *flags };

static status unknown_flag(const char *flag)
{
  const char *names[NUM_FLAGS];
  for (int k = 0; k < NUM_FLAGS; k++) names[k] = flags[k].flag;
  const char *near = nearest_name(flag, names, NUM_FLAGS);
  return near ? user_error("unknown flag '%s'; the nearest known one is '%s'", flag, near)
              : user_error("unknown flag '%s'; 'sphbench --help' lists the known ones", flag);
}

static status take_flag(struct options *o, int k, const char *value)
{
  if (strcmp(flags[k].flag, "--set") == 0) {
    if (!strchr(value, '=')) return user_error("--set: '%s' found, KEY=VALUE expected", value);
    if (o->num_sets == MAX_SETS) return user_error("--set: more than %d of them", MAX_SETS);
    o->set[o->num_sets++] = value;
  } else if (flags[k].argument) {
    *(const char **)((char *)o + flags[k].offset) = value;
  } else {
    *(int *)((char *)o + flags[k].offset) = 1;
  }
  return OK;
}

/* One flag at argv[*i], as "--flag value" or "--flag=value". */
static status parse_flag(struct options *o, int argc, char **argv, int *i)
{
  const char *text = argv[*i], *equals = strchr(text, '=');
  const size_t length = equals && strncmp(text, "--", 2) == 0 ? (size_t)(equals - text) : strlen(text);
  for (int k = 0; k < NUM_FLAGS; k++) {
    if (strlen(flags[k].flag) != length || strncmp(flags[k].flag, text, length) != 0) continue;
    const char *value = NULL;
    if (flags[k].argument) {
      if (o->verb && strcmp(flags[k].flag, "--json") == 0 && (!strcmp(o->verb, "list") || !strcmp(o->verb, "show"))) {
        o->json_output = 1; /* without a file: to standard output */
        return OK;
      }
      value = text[length] == '=' ? text + length + 1 : *i + 1 < argc ? argv[++*i] : NULL;
      if (!value) return user_error("%s needs a value: %s", flags[k].flag, flags[k].argument);
    } else if (text[length] == '=') {
      return user_error("%s takes no value", flags[k].flag);
    }
    return take_flag(o, k, value);
  }
  return unknown_flag(text);
}

status options_parse(struct options *o, int argc, char **argv)
{
  memset(o, 0, sizeof *o);
  o->argc = argc;
  o->argv = argv;
  for (int i = 1; i < argc; i++) {
    if (argv[i][0] == '-' && argv[i][1]) {
      TRY(parse_flag(o, argc, argv, &i));
    } else if (!o->verb) {
      o->verb = argv[i];
    } else if (!o->name) {
      o->name = argv[i];
    } else {
      return user_error("'%s' was not expected after '%s %s'", argv[i], o->verb, o->name);
    }
  }
  return OK;
}

void options_help(void)
{
  for (int k = 0; k < NUM_FLAGS; k++) {
    char left[64];
    snprintf(left, sizeof left, "%s %s", flags[k].flag, flags[k].argument ? flags[k].argument : "");
    printf("  %-24s %s\n", left, flags[k].meaning);
  }
}

status option_whole(const char *flag, const char *text, long low, long high, long initial, long *value)
{
  *value = initial;
  if (!text) return OK;
  char *end;
  errno = 0;
  *value = strtol(text, &end, 10);
  if (end == text || *end || errno == ERANGE)
    return user_error("%s: '%s' is not a whole number", flag, text);
  if (*value < low || *value > high)
    return user_error("%s: %s found, allowed is %ld to %ld", flag, text, low, high);
  return OK;
}
