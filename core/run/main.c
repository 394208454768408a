/* The entry of one variant: run, list, show, speed. The front end starts it. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "driver.h"

static const struct {
  const char *name;
  status (*run)(const struct options *);
} verbs[] = {{"run", verb_run}, {"list", verb_list}, {"show", verb_show}, {"speed", verb_speed}};

static int report(status result)
{
  if (result != OK) fprintf(stderr, "sphbench: %s\n", status_sentence());
  return status_exit_code(result);
}

int main(int argc, char **argv)
{
  struct options o;
  if (getenv("SPHBENCH_REVERSED")) sweep_reversed = 1; /* tests: the direction of sweeps must not matter */
  const status parsed = options_parse(&o, argc, argv);
  if (parsed != OK) return report(parsed);
  const char *names[COUNT(verbs)];
  for (int k = 0; k < COUNT(verbs); k++) {
    if (o.verb && strcmp(verbs[k].name, o.verb) == 0) return report(verbs[k].run(&o));
    names[k] = verbs[k].name;
  }
  const char *near = o.verb ? nearest_name(o.verb, names, COUNT(verbs)) : NULL;
  return report(near ? user_error("unknown verb '%s'; the nearest known one is '%s'", o.verb, near)
                     : user_error("unknown verb '%s'", o.verb ? o.verb : ""));
}
