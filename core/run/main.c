/* The entry of one variant: run, list, show, speed. The front end starts it. */

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "driver.h"
#include "plugins.h"

static const struct {
  const char *name;
  status (*run)(const struct options *);
} verbs[] = {{"run", verb_run}, {"list", verb_list}, {"show", verb_show}, {"speed", verb_speed}};

/* Without this a full disk or a closed pipe behind standard output would pass for success. */
static status check_stdout(status result)
{
  const int failed = fflush(stdout) || ferror(stdout);
  if (result != OK || !failed) return result;
  return status_set(ERR_IO, "cannot write to standard output: %s", strerror(errno));
}

static int report(status result)
{
  result = check_stdout(result);
  if (result != OK) fprintf(stderr, "sphbench: %s\n", status_sentence());
  return status_exit_code(result);
}

/* What --plugin names is loaded at once. What the environment names (a sweep's children) only where
 * it is needed: a run with a built-in solver must not suffer from a plug-in. */
static status load_plugins(const struct options *o)
{
  const char *inherited = getenv("SPHBENCH_PLUGIN");
  if (o->plugin) return plugins_load(o->plugin);
  if (!inherited) return OK;
  const int is_run = strcmp(o->verb, "run") == 0;
  return is_run && (!o->solver || solver_find(o->solver)) ? OK : plugins_load(inherited);
}

static status carry_out(const struct options *o)
{
  const char *names[COUNT(verbs)];
  for (int k = 0; k < COUNT(verbs); k++) {
    names[k] = verbs[k].name;
    if (!o->verb || strcmp(names[k], o->verb)) continue;
    if (o->help) {
      options_help(o);
      return OK;
    }
    TRY(options_check(o));
    TRY(load_plugins(o));
    return verbs[k].run(o);
  }
  const char *near = o->verb ? nearest_name(o->verb, names, COUNT(verbs)) : NULL;
  return near ? user_error("unknown verb '%s'; the nearest known one is '%s'", o->verb, near)
              : user_error("unknown verb '%s'", o->verb ? o->verb : "");
}

int main(int argc, char **argv)
{
  struct options o;
  /* tests: the direction of sweeps must not matter */
  if (getenv("SPHBENCH_REVERSED")) sweep_reversed = 1;
  const status parsed = options_parse(&o, argc, argv);
  return report(parsed == OK ? carry_out(&o) : parsed);
}
