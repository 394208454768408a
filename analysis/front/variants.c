#include "variants.h"

#include <string.h>
#include <unistd.h>

struct variant variant_number(int k)
{
  return (struct variant){k & 4 ? "cuda" : "openmp", k & 1 ? "f32" : "f64", k & 2 ? 3 : 2};
}

/* --- what the command line asks for --- */

struct choice {
  const char *flag, *word[2], *means[2];
};
static const struct choice choices[] = {
  {"--backend", {"openmp", "cuda"}, {"openmp", "cuda"}},
  {"--dim", {"2", "3"}, {"2", "3"}},
  {"--precision", {"double", "float"}, {"f64", "f32"}},
};
enum { BACKEND, DIMENSION, PRECISION, NUM_CHOICES };

/* The value of a flag at argv[i], as "--flag value" or "--flag=value"; NULL if it is another one.
 * A flag at the end has none: the variant says so. */
static const char *value_at(const char *flag, int argc, char **argv, int i)
{
  const size_t length = strlen(flag);
  if (strncmp(argv[i], flag, length) != 0) return NULL;
  if (argv[i][length] == '=') return argv[i] + length + 1;
  return argv[i][length] == '\0' && i + 1 < argc ? argv[i + 1] : NULL;
}

static status take(const struct choice *choice, const char *text, const char **means)
{
  for (int k = 0; k < 2; k++) {
    if (strcmp(text, choice->word[k]) != 0) continue;
    *means = choice->means[k];
    return OK;
  }
  return user_error("%s: '%s' found, allowed is %s or %s", choice->flag, text, choice->word[0],
                    choice->word[1]);
}

status variant_choose(int argc, char **argv, struct variant *v)
{
  const char *means[NUM_CHOICES] = {v->backend, v->dim == 3 ? "3" : "2", v->precision};
  for (int i = 1; i < argc; i++)
    for (int k = 0; k < NUM_CHOICES; k++) {
      const char *text = value_at(choices[k].flag, argc, argv, i);
      if (text) TRY(take(&choices[k], text, &means[k]));
    }
  *v = (struct variant){means[BACKEND], means[PRECISION], means[DIMENSION][0] - '0'};
  return OK;
}

/* --- where they lie --- */

struct path variant_name(const struct variant *v)
{
  return path_of("%s-%dd-%s", v->backend, v->dim, v->precision);
}

struct path variant_about(const struct variant *v)
{
  return path_of("%d-D in %s precision, %s", v->dim,
                 strcmp(v->precision, "f32") == 0 ? "single" : "double",
                 strcmp(v->backend, "cuda") == 0 ? "CUDA" : "OpenMP");
}

/* The folder of this executable. */
static struct path own_folder(void)
{
  struct path own = {{0}};
  const ssize_t length = readlink("/proc/self/exe", own.text, sizeof own.text - 1);
  char *slash = length > 0 ? strrchr(own.text, '/') : NULL;
  if (!slash) return path_of(".");
  *slash = '\0';
  return own;
}

static int find(const struct variant *v, struct path *executable)
{
  static const char *const places[] = {"variants", "../libexec/sphbench"};
  const struct path own = own_folder(), name = variant_name(v);
  for (int k = 0; k < 2; k++) {
    *executable = path_of("%s/%s/sphbench-%s", own.text, places[k], name.text);
    if (access(executable->text, X_OK) == 0) return 1;
  }
  return 0;
}

status program_executable(const char *name, struct path *executable)
{
  static const char *const places[] = {".", "../libexec/sphbench"};
  const struct path own = own_folder();
  for (int k = 0; k < 2; k++) {
    *executable = path_of("%s/%s/sphbench-analysis-%s", own.text, places[k], name);
    if (access(executable->text, X_OK) == 0) return OK;
  }
  return user_error("'sphbench-analysis-%s' is not built, which is made of "
                    "analysis/figures/%s.c",
                    name, name);
}

static int any_of(const char *backend)
{
  for (int k = 0; k < NUM_VARIANTS; k++) {
    const struct variant v = variant_number(k);
    struct path unused;
    if (strcmp(v.backend, backend) == 0 && find(&v, &unused)) return 1;
  }
  return 0;
}

status variant_executable(const struct variant *v, struct path *executable)
{
  if (find(v, executable)) return OK;
  const struct path about = variant_about(v), name = variant_name(v);
  if (strcmp(v->backend, "cuda") == 0 && !any_of("cuda"))
    return status_set(ERR_SKIPPED, "skipped: the CUDA variants are not built");
  return user_error("the variant '%s' (%s) is not built; 'sphbench list variants' lists those that "
                    "are",
                    name.text, about.text);
}

status variant_any(const struct variant *wanted, struct variant *found)
{
  struct path unused;
  *found = *wanted;
  for (int k = 0; k < NUM_VARIANTS && !find(found, &unused); k++) *found = variant_number(k);
  return find(found, &unused) ? OK : user_error("no variant of sphbench is built");
}

struct path data_folder(void)
{
  const struct path own = own_folder();
  const struct path installed = path_of("%s/../share/sphbench", own.text);
  const struct path recipes = path_of("%s/paper-figures", installed.text);
  return path_is_folder(recipes.text) ? installed : path_of("%s", SPHBENCH_SOURCE_DIR);
}
