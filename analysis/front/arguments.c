#include "arguments.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static status unknown(const struct arguments *what, const char *found)
{
  const char *names[32];
  for (int k = 0; k < what->num_flags; k++) names[k] = what->flags[k].name;
  const char *near = nearest_name(found, names, what->num_flags);
  if (near)
    return user_error("%s: unknown flag '%s'; the nearest known one is '%s'", what->verb, found,
                      near);
  return user_error("%s: unknown flag '%s'; 'sphbench --help' lists the known ones", what->verb,
                    found);
}

/* argv[*i] is the flag; its value is behind '=' or the next argument. */
static status take(const struct arguments *what, const struct flag *flag, char **argv, int *i)
{
  char *equals = strchr(argv[*i], '=');
  if (!flag->text) {
    if (equals) return user_error("%s: %s takes no value", what->verb, flag->name);
    *flag->is_on = 1;
    return OK;
  }
  *flag->text = equals ? equals + 1 : argv[++*i];
  return *flag->text ? OK : user_error("%s: %s needs a value", what->verb, flag->name);
}

static status parse_flag(const struct arguments *what, char **argv, int *i)
{
  const size_t length = strcspn(argv[*i], "=");
  for (int k = 0; k < what->num_flags; k++)
    if (strlen(what->flags[k].name) == length && !strncmp(argv[*i], what->flags[k].name, length))
      return take(what, &what->flags[k], argv, i);
  return unknown(what, argv[*i]);
}

status arguments_parse(const struct arguments *what, int argc, char **argv)
{
  int names = 0;
  for (int i = 2; i < argc; i++) {
    if (argv[i][0] == '-' && argv[i][1]) {
      TRY(parse_flag(what, argv, &i));
    } else if (names < what->most_names) {
      what->names[names++] = argv[i];
    } else {
      return user_error("%s: '%s' was not expected", what->verb, argv[i]);
    }
  }
  if (what->num_names) *what->num_names = names;
  return OK;
}

status argument_whole(const char *flag, const char *text, long low, long high, long *value)
{
  char *end;
  if (!text) return OK;
  errno = 0;
  *value = strtol(text, &end, 10);
  if (end == text || *end || errno == ERANGE)
    return user_error("%s: '%s' is not a whole number", flag, text);
  if (*value < low || *value > high)
    return user_error("%s: %s found, allowed is %ld to %ld", flag, text, low, high);
  return OK;
}

status arguments_sets(int argc, char **argv, char **set, int most, int *num_sets)
{
  for (int i = 2; i < argc; i++) {
    char *value = strncmp(argv[i], "--set=", 6) == 0              ? argv[i] + 6
                  : strcmp(argv[i], "--set") == 0 && i + 1 < argc ? argv[i + 1]
                                                                  : NULL;
    if (!value) continue;
    if (!strchr(value, '=')) return user_error("--set: '%s' found, KEY=VALUE expected", value);
    if (*num_sets == most) return user_error("--set: more than %d of them", most);
    set[(*num_sets)++] = value;
  }
  return OK;
}
