/* gnuplot: once for SVG, once for PNG, on the data files only. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "figure.h"
#include "process.h"
#include "variants.h"

status gnuplot_check(void)
{
  static const char *const argv[] = {"gnuplot", "--version", NULL};
  char *version = process_output(argv);
  const int missing = !version;
  free(version);
  return missing
           ? user_error("gnuplot is missing, which draws the figures; as root: apt-get install "
                        "gnuplot-nox")
           : OK;
}

static char *quoted(const char *name, const char *text)
{
  char *result = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&result, &size);
  if (!out) return NULL;
  put_text(out, name, 0, text);
  fclose(out);
  return result;
}

/* The last line that gnuplot wrote, which says what is wrong. */
static status drawing_failed(const struct path *script, const struct path *log)
{
  char *text = NULL;
  size_t size;
  if (file_read(log->text, &text, &size) != OK)
    return user_error("gnuplot failed on '%s'", script->text);
  while (size > 0 && strchr(" \n", text[size - 1])) text[--size] = '\0';
  const char *line = strrchr(text, '\n');
  const status result =
    user_error("gnuplot failed on '%s': %s", script->text, line ? line + 1 : text);
  free(text);
  return result;
}

/* Is the picture newer than its data and its scripts? */
static int is_up_to_date(const struct drawing *d, const char *picture, const char *shared)
{
  struct path folder = d->script;
  struct stat about;
  *strrchr(folder.text, '/') = '\0';
  return stat(picture, &about) == 0 && about.st_mtime > folder_newest(d->data.text) &&
         about.st_mtime > folder_newest(folder.text) && about.st_mtime > folder_newest(shared);
}

static status draw_kind(const struct drawing *d, const char *kind)
{
  const struct path folder = data_folder(), shared = path_of("%s/paper-figures/", folder.text);
  const struct path temp = path_of("%s/%s.%s.tmp", d->data.text, d->name, kind);
  const struct path log = path_of("%s/gnuplot.log", d->data.text);
  const struct path whole = path_of("%s/%s.%s", d->out, d->name, kind);
  char absolute[4096];
  if (is_up_to_date(d, whole.text, shared.text)) return OK;
  if (!realpath(d->script.text, absolute))
    return user_error("the figure '%s' has no script '%s'", d->name, d->script.text);
  char *set[] = {quoted("kind", kind), quoted("shared", shared.text),
                 quoted("picture", strrchr(temp.text, '/') + 1)};
  const char *const argv[] = {"gnuplot", "-e", set[0], "-e", set[1], "-e", set[2], absolute, NULL};
  const struct process process = {.argv = argv, .folder = d->data.text, .log = log.text};
  int exit_code = 0;
  status result = process_wait(&process, &exit_code);
  for (int k = 0; k < 3; k++) free(set[k]);
  if (result != OK) return result;
  if (exit_code || !path_is_file(temp.text)) return drawing_failed(&d->script, &log);
  if (rename(temp.text, whole.text)) return status_set(ERR_IO, "cannot write '%s'", whole.text);
  unlink(log.text);
  return OK;
}

status drawing_make(const struct drawing *drawing)
{
  TRY(draw_kind(drawing, "svg"));
  return draw_kind(drawing, "png");
}

status figure_draw(struct figure *f, const char *out)
{
  const struct drawing drawing = {f->recipe->name, out,
                                  path_of("%s/%s.gp", f->folder.text, f->recipe->name), f->data};
  return drawing_make(&drawing);
}
