/* `sphbench frames`: the frames of a result file as PNG, and as a film, without ParaView. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../core/base/sorted.h"
#include "../../core/io/result_read.h"
#include "arguments.h"
#include "figure.h"
#include "front.h"
#include "process.h"
#include "variants.h"

struct colour {
  const char *name, *array, *label;
  int from_zero;
};
static const struct colour colours[] = {{"speed", "velocity", "speed [m/s]", 1},
                                        {"p", "pressure", "pressure [Pa]", 0}};
enum { NUM_COLOURS = sizeof colours / sizeof *colours, MOST_VALUES = 1000000 };

struct request {
  const char *file, *out, *colour, *film;
  int quiet;
};

struct frames {
  const struct request *request;
  const struct colour *colour;
  struct result_read *file;
  struct path data, stem; /* stem: of the pictures, OUT/NAME */
  long n, stride;         /* every stride-th value tells of the range of colours */
  double *value;
  long num_values;
  double low[2], high[2]; /* of positions [m] */
  double spacing;         /* [m] */
  double dim;             /* of the run; positions always have three components */
};

static status parse(struct request *r, int argc, char **argv)
{
  const struct flag flags[] = {{"-o", &r->out, NULL},
                               {"--colour", &r->colour, NULL},
                               {"--film", &r->film, NULL},
                               {"--quiet", NULL, &r->quiet}};
  int names = 0;
  const struct arguments what = {"frames", flags, sizeof flags / sizeof *flags,
                                 &r->file, 1,     &names};
  *r = (struct request){.out = "frames", .colour = "speed"};
  TRY(arguments_parse(&what, argc, argv));
  return names == 1 ? OK : user_error("frames needs a result file (.vtkhdf)");
}

static status find_colour(const char *name, const struct colour **colour)
{
  for (int k = 0; k < NUM_COLOURS; k++)
    if (strcmp(name, colours[k].name) == 0) {
      *colour = &colours[k];
      return OK;
    }
  return user_error("--colour: '%s' found, allowed is speed or p", name);
}

static status check_film(const char *film)
{
  static const char *const argv[] = {"ffmpeg", "-version", NULL};
  if (!film) return OK;
  char *version = process_output(argv);
  const int missing = !version;
  free(version);
  return missing ? user_error("--film: ffmpeg is missing, which makes films; as root: apt-get "
                              "install ffmpeg")
                 : OK;
}

/* --- data --- */

/* A particle as it is drawn: two coordinates, the depth behind them, and the colour. */
struct mark {
  double x, y, depth, value;
};

static int farther(const void *a, const void *b)
{
  const struct mark *p = a, *q = b;
  return p->depth < q->depth ? 1 : p->depth > q->depth ? -1 : 0;
}

static void widen(struct frames *f, double x, double y)
{
  const double at[2] = {x, y};
  for (int c = 0; c < 2; c++) {
    f->low[c] = fmin(f->low[c], at[c]);
    f->high[c] = fmax(f->high[c], at[c]);
  }
}

/* last: the axis that points up. 3-D is looked at along y: x to the right, z up, what is near over
 * what is far. */
static long take_marks(const struct result_numbers *x, const struct result_numbers *q, int last,
                       struct mark *mark)
{
  long n = 0;
  for (long i = 0; i < x->rows && (!q || i < q->rows); i++) {
    const double *at = x->values + i * x->components;
    double square = 0;
    for (int c = 0; q && c < q->components; c++)
      square += q->values[i * q->components + c] * q->values[i * q->components + c];
    const double value = !q ? 0 : q->components == 1 ? q->values[i] : sqrt(square);
    if (!isfinite(at[0]) || !isfinite(at[last]) || !isfinite(value)) continue;
    mark[n++] = (struct mark){at[0], at[last], last == 2 ? at[1] : 0, value};
  }
  if (last == 2) qsort(mark, (size_t)n, sizeof *mark, farther);
  return n;
}

/* The marks of positions x and, unless NULL, values q become a file of the data folder. */
static status write_marks(struct frames *f, const struct result_numbers *x,
                          const struct result_numbers *q, const char *name)
{
  const struct path path = path_of("%s/%s", f->data.text, name);
  struct mark *mark = calloc((size_t)x->rows + 1, sizeof *mark);
  struct new_file file;
  status result = mark ? file_begin(&file, path.text) : status_set(ERR_MEMORY, "out of memory");
  const long n = result == OK ? take_marks(x, q, f->dim > 2 ? 2 : 1, mark) : 0;
  for (long i = 0; i < n; i++) {
    widen(f, mark[i].x, mark[i].y);
    fprintf(file.stream, "%.6g %.6g %.6g\n", mark[i].x, mark[i].y, mark[i].value);
    if (q && i % f->stride == 0 && f->num_values < MOST_VALUES)
      f->value[f->num_values++] = mark[i].value;
  }
  free(mark);
  return result == OK ? file_commit(&file) : result;
}

static status write_frame(struct frames *f, long k)
{
  const struct path name = path_of("%ld.dat", k);
  struct result_numbers x, q;
  TRY(result_read_array(f->file, k, "position", &x));
  status result = result_read_array(f->file, k, f->colour->array, &q);
  if (result == OK) {
    if (k == 0) f->stride = 1 + f->n * x.rows / (MOST_VALUES / 2);
    result = write_marks(f, &x, &q, name.text);
    free(q.values);
  }
  free(x.values);
  return result;
}

static status write_walls(struct frames *f)
{
  struct result_numbers x;
  if (!result_read_has(f->file, "walls/position")) return OK;
  TRY(result_read_series(f->file, "walls/position", &x));
  const status result = write_marks(f, &x, NULL, "walls.dat");
  free(x.values);
  return result;
}

/* What 99 % of all particles at all times lie in: one that flew off shall not hide the others. */
static void colour_range(struct frames *f, double *low, double *high)
{
  sort_numbers(f->value, (int)f->num_values);
  const long cut = f->num_values / 200;
  *low = f->colour->from_zero || f->num_values == 0 ? 0 : f->value[cut];
  *high = f->num_values ? f->value[f->num_values - 1 - cut] : 1;
  if (!(*high > *low)) *high = *low + 1;
}

static void put_title(struct frames *f, FILE *out)
{
  char scene[128], solver[128];
  if (result_read_text(f->file, "scene", scene, sizeof scene) != OK) *scene = '\0';
  if (result_read_text(f->file, "solver", solver, sizeof solver) != OK) *solver = '\0';
  const struct path title = path_of("%s with %s", scene, solver);
  put_text(out, "title_text", 0, title.text);
}

static status write_contents(struct frames *f)
{
  const struct path path = path_of("%s/contents.gp", f->data.text);
  struct new_file file;
  double low, high;
  TRY(file_begin(&file, path.text));
  FILE *out = file.stream;
  colour_range(f, &low, &high);
  fprintf(out, "frames = %ld\narray time[frames]\n", f->n);
  for (long k = 0; k < f->n; k++)
    fprintf(out, "time[%ld] = %.9g\n", k + 1, result_read_time(f->file, k));
  fprintf(out, "spacing = %.9g\nx0 = %.9g\nx1 = %.9g\ny0 = %.9g\ny1 = %.9g\n", f->spacing,
          f->low[0] - f->spacing, f->high[0] + f->spacing, f->low[1] - f->spacing,
          f->high[1] + f->spacing);
  fprintf(out, "colour_low = %.9g\ncolour_high = %.9g\n", low, high);
  put_text(out, "label_up", 0, f->dim > 2 ? "z [m]" : "y [m]");
  put_text(out, "label_colour", 0, f->colour->label);
  put_text(out, "walls", 0, result_read_has(f->file, "walls/position") ? "walls.dat" : "");
  put_title(f, out);
  return file_commit(&file);
}

/* --- pictures --- */

static status gnuplot_says(const struct path *log)
{
  char *said = run_last_words(log->text);
  const status result = user_error("gnuplot failed on the frames: %s", said ? said : "");
  free(said);
  return result;
}

static status draw(const struct frames *f)
{
  const struct path folder = data_folder(), shared = path_of("%s/paper-figures/", folder.text);
  const struct path script = path_of("%s/paper-figures/film.gp", folder.text);
  const struct path log = path_of("%s/gnuplot.log", f->data.text);
  const struct path set = path_of("shared = '%s'", shared.text);
  char whole[4096];
  if (!realpath(script.text, whole)) return status_set(ERR_IO, "'%s' is missing", script.text);
  const char *const argv[] = {"gnuplot", "-e", set.text, whole, NULL};
  const struct process process = {.argv = argv, .folder = f->data.text, .log = log.text};
  int code;
  TRY(process_wait(&process, &code));
  if (code) return gnuplot_says(&log);
  for (long k = 0; k < f->n; k++) {
    const struct path from = path_of("%s/%ld.png", f->data.text, k);
    const struct path to = path_of("%s_%04ld.png", f->stem.text, k);
    if (rename(from.text, to.text)) return gnuplot_says(&log);
  }
  return OK;
}

/* 25 pictures a second, to be shown by any player. */
static status make_film(const struct frames *f, const char *film)
{
  const struct path pictures = path_of("%s_%%04d.png", f->stem.text);
  const struct path log = path_of("%s/ffmpeg.log", f->data.text);
  const char *dot = strrchr(film, '.');
  const struct path temp = path_of("%s.tmp%s", film, dot && !strchr(dot, '/') ? dot : ".mp4");
  const char *const argv[] = {"ffmpeg",     "-y",       "-nostdin", "-loglevel",   "error",
                              "-framerate", "25",       "-i",       pictures.text, "-frames:v",
                              NULL,         "-pix_fmt", "yuv420p",  temp.text,     NULL};
  const char *with[sizeof argv / sizeof *argv];
  const struct path count = path_of("%ld", f->n);
  memcpy(with, argv, sizeof argv);
  with[10] = count.text;
  const struct process process = {.argv = with, .log = log.text};
  int code;
  TRY(process_wait(&process, &code));
  if (code == 0 && rename(temp.text, film) == 0) return OK;
  char *said = run_last_words(log.text);
  const status result = user_error("--film: '%s' cannot be made: %s", film, said ? said : "");
  free(said);
  unlink(temp.text);
  return result;
}

/* --- all of it --- */

static status find_folder(struct frames *f)
{
  const char *slash = strrchr(f->request->file, '/');
  const char *name = slash ? slash + 1 : f->request->file;
  TRY(folder_make(f->request->out));
  f->stem = path_of("%s/%.*s", f->request->out, (int)strcspn(name, "."), name);
  f->data = path_of("%s/.frames-XXXXXX", f->request->out);
  return mkdtemp(f->data.text)
           ? OK
           : status_set(ERR_IO, "cannot write into '%s': %s", f->request->out, strerror(errno));
}

static void remove_data(const struct frames *f)
{
  struct names names = folder_names(f->data.text);
  for (int k = 0; k < names.n; k++) {
    const struct path path = path_of("%s/%s", f->data.text, names.name[k]);
    unlink(path.text);
  }
  names_free(&names);
  rmdir(f->data.text);
}

static status make_all(struct frames *f)
{
  for (long k = 0; k < f->n; k++) TRY(write_frame(f, k));
  TRY(write_walls(f));
  TRY(write_contents(f));
  TRY(draw(f));
  if (f->request->film) TRY(make_film(f, f->request->film));
  if (f->request->quiet) return OK;
  printf("%s_%04d.png to %s_%04ld.png\n", f->stem.text, 0, f->stem.text, f->n - 1);
  if (f->request->film) printf("%s\n", f->request->film);
  return OK;
}

static status make(struct frames *f)
{
  f->n = result_read_frames(f->file);
  if (f->n == 0) return user_error("'%s' has no frames", f->request->file);
  if (result_read_number(f->file, "run/parameters/spacing", &f->spacing) != OK) f->spacing = 0;
  if (result_read_number(f->file, "run/dim", &f->dim) != OK) f->dim = 2;
  f->value = calloc(MOST_VALUES, sizeof(double));
  if (!f->value) return status_set(ERR_MEMORY, "out of memory");
  TRY(find_folder(f));
  const status result = make_all(f);
  remove_data(f);
  return result;
}

status verb_frames(int argc, char **argv)
{
  struct request r;
  struct frames f = {
    .request = &r, .stride = 1, .low = {HUGE_VAL, HUGE_VAL}, .high = {-HUGE_VAL, -HUGE_VAL}};
  TRY(parse(&r, argc, argv));
  TRY(find_colour(r.colour, &f.colour));
  TRY(check_film(r.film));
  TRY(gnuplot_check());
  TRY(result_read_open(&f.file, r.file));
  const status result = make(&f);
  result_read_close(f.file);
  free(f.value);
  return result;
}
