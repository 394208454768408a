#include "plugins.h"

#include <dirent.h>
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../plugin.h"
#include "driver.h"

enum { LONGEST = 2 * PATH_MAX }; /* of folder and name */

/* As in the names of files: "2d-f64", and "cuda-2d-f64" on a GPU. */
static const char *variant_in_names(void)
{
  const char *usual = "openmp-";
  const int is_usual = strncmp(SPHBENCH_VARIANT, usual, strlen(usual)) == 0;
  return SPHBENCH_VARIANT + (is_usual ? strlen(usual) : 0);
}

/* --- is it one? */

static status check_build(const char *file, const struct plugin_build *b)
{
  static const struct plugin_build here = PLUGIN_BUILD;
  if (b->abi != here.abi)
    return user_error("--plugin: '%s' was built for the interface %d of solvers, this program has "
                      "%d: build it again",
                      file, b->abi, here.abi);
  if (strcmp(b->variant, here.variant) != 0 || b->dim != here.dim ||
      b->real_bytes != here.real_bytes)
    return user_error("--plugin: '%s' was built for the variant '%s', this is '%s'", file,
                      b->variant, here.variant);
  if (b->lanes == here.lanes && b->view_bytes == here.view_bytes &&
      b->solver_bytes == here.solver_bytes && strcmp(b->layout, here.layout) == 0)
    return OK;
  return user_error("--plugin: '%s' was built with the headers of another version of sphbench: "
                    "build it again",
                    file);
}

static int is_name(const char *name)
{
  const char *allowed = "abcdefghijklmnopqrstuvwxyz0123456789-";
  return name && *name && strlen(name) < 40 && strspn(name, allowed) == strlen(name);
}

static status check_solver(const char *file, const struct solver *s)
{
  const char *lacks = s->abi != SOLVER_ABI                         ? "abi = SOLVER_ABI"
                      : !s->about || !s->paper || !s->doi          ? "about, paper and doi"
                      : !s->differences                            ? "differences"
                      : !s->step                                   ? "step"
                      : s->state_size < sizeof(struct view)        ? "a state that begins with VIEW"
                      : !s->project && s->can & CAN(PROJECT)       ? "project, with CAN(PROJECT)"
                      : !(s->can & (DIM == 2 ? CAN(2D) : CAN(3D))) ? "CAN(2D) or CAN(3D)"
                                                                   : NULL;
  if (!is_name(s->name))
    return user_error("--plugin: '%s' names its solver '%s', allowed are lower case, digits and "
                      "hyphens, less than 40",
                      file, s->name ? s->name : "");
  if (lacks) return user_error("--plugin: '%s': solver '%s' lacks %s", file, s->name, lacks);
  const struct solver *other = solver_find(s->name);
  if (other)
    return user_error("--plugin: '%s': there is a solver '%s' already%s%s", file, s->name,
                      plugin_file(other) ? ", from " : "",
                      plugin_file(other) ? plugin_file(other) : "");
  return OK;
}

static status load(const char *file)
{
  char whole[PATH_MAX]; /* without a '/' it would be looked for elsewhere */
  dlerror();
  void *object = dlopen(realpath(file, whole) ? whole : file, RTLD_NOW | RTLD_LOCAL);
  const char *why = object ? NULL : dlerror();
  if (!object) return user_error("--plugin: %s", why ? why : "a shared object cannot be loaded");
  const struct plugin_build *build = dlsym(object, "sphbench_build");
  const struct solver *solver = dlsym(object, "sphbench_solver");
  status result = build && solver
                    ? check_build(file, build)
                    : user_error("--plugin: '%s' is no plug-in: it has no %s", file,
                                 build ? "sphbench_solver" : "sphbench_build (SPHBENCH_PLUGIN)");
  if (result == OK) result = check_solver(file, solver);
  if (result == OK) result = solver_add(solver, realpath(file, whole) ? whole : file);
  if (result != OK) dlclose(object);
  return result;
}

/* --- where is it? */

static int ends_with(const char *name, const char *end)
{
  const size_t n = strlen(name), e = strlen(end);
  return n > e && strcmp(name + n - e, end) == 0;
}

static int other_by_name(const struct dirent **a, const struct dirent **b)
{
  return strcmp((*a)->d_name, (*b)->d_name);
}

static status load_folder(const char *folder)
{
  struct dirent **entry;
  char end[64];
  int found = 0;
  status result = OK;
  snprintf(end, sizeof end, "-%s.so", variant_in_names());
  const int n = scandir(folder, &entry, NULL, other_by_name);
  for (int k = 0; k < n; k++) {
    char file[LONGEST];
    const int is_cuda = strstr(entry[k]->d_name, "-cuda-") && !strstr(end, "-cuda-");
    if (ends_with(entry[k]->d_name, end) && !is_cuda && result == OK) {
      snprintf(file, sizeof file, "%s/%s", folder, entry[k]->d_name);
      result = load(file);
      found = 1;
    }
    free(entry[k]);
  }
  if (n >= 0) free(entry);
  if (found) return result;
  return user_error("--plugin: folder '%s' holds no plug-in for this variant, NAME%s", folder, end);
}

static status load_path(const char *path)
{
  struct stat about;
  char file[LONGEST];
  if (stat(path, &about) == 0) return S_ISDIR(about.st_mode) ? load_folder(path) : load(path);
  snprintf(file, sizeof file, "%s-%s.so", path, variant_in_names());
  if (stat(file, &about) == 0) return load(file);
  return user_error("--plugin: there is neither '%s' nor '%s'", path, file);
}

status plugins_load(const char *paths)
{
  char path[PATH_MAX];
  for (const char *at = paths; *at;) {
    const size_t length = strcspn(at, ",");
    if (length >= sizeof path) return user_error("--plugin: a path is too long");
    memcpy(path, at, length);
    path[length] = '\0';
    if (length) TRY(load_path(path));
    at += length + (at[length] == ',');
  }
  return OK;
}

void plugin_report(const struct solver *solver, struct provenance *p)
{
  const char *file = plugin_file(solver);
  FILE *in = file && p->num_libraries < COUNT(p->libraries) ? fopen(file, "rb") : NULL;
  unsigned long long hash = 0xcbf29ce484222325ULL; /* FNV-1a */
  if (!in) return;
  for (int c; (c = getc(in)) != EOF;) hash = (hash ^ (unsigned char)c) * 0x100000001b3ULL;
  fclose(in);
  char(*row)[40] = p->libraries[p->num_libraries++];
  snprintf(row[0], sizeof row[0], "%.31s plug-in", solver->name);
  snprintf(row[1], sizeof row[1], "%016llx", hash);
}
