#include "options.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
  const char *flag, *argument, *meaning;
  int verbs;
  size_t offset;
} flags[] = {
#define O(member, flag, argument, verbs, meaning) \
  {flag, argument, meaning, verbs, offsetof(struct options, member)},
  OPTION_LIST(O)
#undef O
#define O(member, flag, verbs, meaning) \
  {flag, NULL, meaning, verbs, offsetof(struct options, member)},
    SWITCH_LIST(O)
#undef O
      {"--set", "KEY=VALUE", "a parameter of the solver or the scene (sphbench show NAME)", FOR_RUN,
       offsetof(struct options, num_sets)},
};
enum { NUM_FLAGS = sizeof flags / sizeof *flags };

static int is_flag(const char *text)
{
  int known = strncmp(text, "--", 2) == 0;
  for (int k = 0; k < NUM_FLAGS; k++) known |= strcmp(flags[k].flag, text) == 0;
  return known;
}

static int verb_bit(const char *verb)
{
  if (verb && strcmp(verb, "run") == 0) return FOR_RUN;
  return verb && strcmp(verb, "speed") == 0 ? FOR_SPEED : FOR_LISTS;
}

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

/* The value of flag k at argv[*i]: behind its '=', or the next argument, unless that is a flag. */
static status find_value(int k, int argc, char **argv, int *i, const char **value)
{
  const size_t length = strlen(flags[k].flag);
  *value = NULL;
  if (argv[*i][length] == '=')
    *value = argv[*i] + length + 1;
  else if (*i + 1 < argc && !is_flag(argv[*i + 1]))
    *value = argv[++*i];
  if (*value && **value) return OK;
  return user_error("%s needs a value: %s", flags[k].flag, flags[k].argument);
}

/* One flag at argv[*i], as "--flag value" or "--flag=value". */
static status parse_flag(struct options *o, int argc, char **argv, int *i)
{
  const char *text = argv[*i], *value = NULL;
  const size_t length = strncmp(text, "--", 2) == 0 ? strcspn(text, "=") : strlen(text);
  int k = 0;
  while (k < NUM_FLAGS && (strlen(flags[k].flag) != length || strncmp(flags[k].flag, text, length)))
    k++;
  if (k == NUM_FLAGS) return unknown_flag(text);
  const int to_stdout = verb_bit(o->verb) == FOR_LISTS && strcmp(flags[k].flag, "--json") == 0;
  if ((to_stdout || !flags[k].argument) && text[length] == '=')
    return user_error("%s takes no value", flags[k].flag);
  o->json_output |= to_stdout; /* list and show write to standard output, not to a file */
  if (to_stdout) return OK;
  if (flags[k].argument) TRY(find_value(k, argc, argv, i, &value));
  return take_flag(o, k, value);
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

/* Was flag k given? A pointer, a switch or the number of --set. */
static int is_given(const struct options *o, int k)
{
  const char *member = (const char *)o + flags[k].offset;
  if (flags[k].argument && strcmp(flags[k].flag, "--set"))
    return *(const char *const *)member != NULL;
  return *(const int *)member != 0;
}

status options_check(const struct options *o)
{
  for (int k = 0; k < NUM_FLAGS; k++)
    if (is_given(o, k) && !(flags[k].verbs & verb_bit(o->verb)))
      return user_error("%s takes no %s; 'sphbench %s --help' lists its flags", o->verb,
                        flags[k].flag, o->verb);
  return OK;
}

void options_help(const struct options *o)
{
  const int bit = verb_bit(o->verb);
  printf("sphbench %s%s\n", o->verb,
         bit == FOR_RUN     ? " SCENE --solver NAME [FLAG]..."
         : bit == FOR_LISTS ? " [NAME] [FLAG]..."
                            : " [FLAG]...");
  for (int k = 0; k < NUM_FLAGS; k++) {
    char left[64];
    if (!(flags[k].verbs & bit)) continue;
    snprintf(left, sizeof left, "%s %s", flags[k].flag, flags[k].argument ? flags[k].argument : "");
    printf("  %-24s %s\n", left, flags[k].meaning);
  }
}

status option_whole(const char *flag, const char *text, long low, long high, long initial,
                    long *value)
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
