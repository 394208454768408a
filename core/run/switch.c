/* From one variant to its sibling of the other dimension. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "driver.h"

status switch_dimension(const struct options *o, int dim)
{
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length < 0) return status_set(ERR_IO, "cannot find the executables beside this one");
  path[length] = '\0';
  char *place = strstr(path + (strrchr(path, '/') - path), DIM == 2 ? "-2d-" : "-3d-");
  if (!place) return status_set(ERR_IO, "'%s' has no sibling for %d-D", path, dim);
  place[1] = (char)('0' + dim);
  execv(path, o->argv);
  return status_set(ERR_IO, "the %d-D variant '%s' cannot be started", dim, path);
}
