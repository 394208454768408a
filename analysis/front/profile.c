/* `sphbench profile`: over the scenes and targets of several precision.json files, which solver is
 * how often how near to the best (Dolan & More 2002), and how much it needs to get there (More &
 * Wild 2009). A problem is a scene with a target error; a solver's cost is that of its cheapest
 * point within the target. */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../core/base/sorted.h"
#include "arguments.h"
#include "figure.h"
#include "front.h"
#include "json_out.h"
#include "statistics.h"
#include "variants.h"

enum { MOST_FILES = 256, MOST_SOLVERS = 64, MOST_PROBLEMS = 1024 };

struct problem {
  char *name; /* "scene, 3 %" */
  double time[MOST_SOLVERS], pairs[MOST_SOLVERS];
};

struct profiles {
  const char *files[MOST_FILES], *out, *json;
  int num_files, quiet;
  char *solver[MOST_SOLVERS];
  int num_solvers;
  struct problem *problem;
  int num_problems;
  double *time, *pairs; /* [problems * solvers] */
};

static int place_of(struct profiles *p, const char *name)
{
  for (int k = 0; k < p->num_solvers; k++)
    if (strcmp(p->solver[k], name) == 0) return k;
  if (p->num_solvers == MOST_SOLVERS) return -1;
  p->solver[p->num_solvers] = strdup(name);
  return p->num_solvers++;
}

static void take_point(struct profiles *p, struct problem *problem, const json_t *point,
                       double target)
{
  const char *name = json_string_value(json_object_get(point, "solver"));
  const json_t *error = json_object_get(point, "error"), *time = json_object_get(point, "time");
  const json_t *pairs = json_object_get(point, "pairs"),
               *size = json_object_get(point, "particles");
  if (!name || !json_is_true(json_object_get(point, "valid"))) return;
  const int s = place_of(p, name);
  if (s < 0 || !json_is_number(error) || json_number_value(error) > target) return;
  if (json_is_number(time)) problem->time[s] = fmin(problem->time[s], json_number_value(time));
  if (json_is_number(pairs) && json_number_value(size) > 0)
    problem->pairs[s] = fmin(problem->pairs[s], json_number_value(pairs) / json_number_value(size));
}

/* Solvers that the file knows take part even if none of their points is valid. */
static void take_names(struct profiles *p, const json_t *points)
{
  size_t k;
  json_t *point;
  json_array_foreach((json_t *)points, k, point)
  {
    const char *name = json_string_value(json_object_get(point, "solver"));
    if (name) place_of(p, name);
  }
}

static status add_problem(struct profiles *p, const json_t *file, double target)
{
  const char *scene = json_string_value(json_object_get(file, "scene"));
  struct problem *more = realloc(p->problem, (size_t)(p->num_problems + 1) * sizeof *more);
  if (!more) return status_set(ERR_MEMORY, "out of memory for the problems");
  p->problem = more;
  struct problem *problem = &p->problem[p->num_problems++];
  problem->name = text_make("%s, %g %%", scene, 100 * target);
  for (int s = 0; s < MOST_SOLVERS; s++) problem->time[s] = problem->pairs[s] = HUGE_VAL;
  size_t k;
  json_t *point;
  json_array_foreach(json_object_get(file, "points"), k, point)
  {
    take_point(p, problem, point, target);
  }
  return OK;
}

static status take_file(struct profiles *p, const char *path)
{
  static const double targets[] = {0.1, 0.03, 0.01};
  json_error_t error;
  json_t *file = json_load_file(path, 0, &error);
  const json_t *points = json_object_get(file, "points");
  if (!file) return user_error("profile: '%s': %s", path, error.text);
  status result = OK;
  if (!json_is_array(points) || !json_is_string(json_object_get(file, "scene")))
    result =
      user_error("profile: '%s' is not a precision.json, which has a scene and points", path);
  if (result == OK) take_names(p, points);
  for (size_t t = 0; t < sizeof targets / sizeof *targets && result == OK; t++)
    result = p->num_problems < MOST_PROBLEMS
               ? add_problem(p, file, targets[t])
               : user_error("profile: more than %d problems", MOST_PROBLEMS);
  json_decref(file);
  return result;
}

/* A problem that no solver solves says nothing about them. */
static void drop_unsolved(struct profiles *p)
{
  int kept = 0;
  for (int k = 0; k < p->num_problems; k++) {
    int solved = 0;
    for (int s = 0; s < p->num_solvers; s++) solved |= isfinite(p->problem[k].time[s]);
    if (solved)
      p->problem[kept++] = p->problem[k];
    else
      free(p->problem[k].name);
  }
  p->num_problems = kept;
}

static status gather(struct profiles *p)
{
  for (int k = 0; k < p->num_files; k++) TRY(take_file(p, p->files[k]));
  drop_unsolved(p);
  if (p->num_problems == 0)
    return user_error("profile: no solver comes within 10 %% in any of these files");
  const size_t n = (size_t)p->num_problems * (size_t)p->num_solvers;
  p->time = calloc(n, sizeof *p->time);
  p->pairs = calloc(n, sizeof *p->pairs);
  if (!p->time || !p->pairs) return status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < p->num_problems; k++)
    for (int s = 0; s < p->num_solvers; s++) {
      p->time[k * p->num_solvers + s] = p->problem[k].time[s];
      p->pairs[k * p->num_solvers + s] = p->problem[k].pairs[s];
    }
  return OK;
}

/* --- where a profile rises --- */

/* The costs of all, or their ratios to the least of each problem, sorted: where any profile may
 * rise. Returns their number. */
static int steps_of(const struct profile *profile, int ratios, double *steps)
{
  int n = 0;
  for (int k = 0; k < profile->problems; k++) {
    const double *cost = profile->cost + k * profile->solvers;
    double best = HUGE_VAL;
    for (int s = 0; s < profile->solvers; s++) best = fmin(best, cost[s]);
    for (int s = 0; s < profile->solvers; s++)
      if (isfinite(cost[s])) steps[n++] = ratios ? cost[s] / best : cost[s];
  }
  sort_numbers(steps, n);
  return n;
}

/* One file per solver: where, and what part of the problems is solved by there. */
static status write_profile(const struct profiles *p, int s, int ratios, const char *suffix,
                            double *last)
{
  const struct profile profile = {ratios ? p->time : p->pairs, p->num_problems, p->num_solvers};
  const struct path name = data_name(p->solver[s], suffix);
  const struct path path = path_of("%s/%s", p->out, name.text);
  double *steps = calloc((size_t)(p->num_problems * p->num_solvers) + 1, sizeof *steps);
  struct new_file file;
  if (!steps) return status_set(ERR_MEMORY, "out of memory");
  const int n = steps_of(&profile, ratios, steps);
  status result = file_begin(&file, path.text);
  if (result == OK) {
    fprintf(file.stream, "# columns: %s | part of %d problems\n",
            ratios ? "time over the least time" : "pairs visited per particle", p->num_problems);
    for (int k = 0; k < n; k++) {
      const double part =
        ratios ? performance_profile(&profile, s, steps[k]) : data_profile(&profile, s, steps[k]);
      fprintf(file.stream, "%.8g %.8g\n", steps[k], part);
    }
    result = file_commit(&file);
  }
  if (n > 0) *last = fmax(*last, steps[n - 1]);
  free(steps);
  return result;
}

/* --- what is written --- */

static status write_data(const struct profiles *p, const struct names *known)
{
  const struct path path = path_of("%s/contents.gp", p->out);
  double last_ratio = 1, last_pairs = 1;
  struct new_file file;
  TRY(file_begin(&file, path.text));
  fprintf(file.stream,
          "# What there is to draw; written by sphbench profile.\nn = %d\nproblems = %d\n"
          "array performance[%d]\narray data[%d]\narray title[%d]\narray colour[%d]\n",
          p->num_solvers, p->num_problems, MOST_SOLVERS, MOST_SOLVERS, MOST_SOLVERS, MOST_SOLVERS);
  for (int s = 0; s < p->num_solvers; s++) {
    int colour = 0;
    while (colour < known->n && strcmp(known->name[colour], p->solver[s]) != 0) colour++;
    const struct path one = data_name(p->solver[s], "-performance");
    const struct path two = data_name(p->solver[s], "-data");
    status result = write_profile(p, s, 1, "-performance", &last_ratio);
    if (result == OK) result = write_profile(p, s, 0, "-data", &last_pairs);
    if (result != OK) {
      file_discard(&file);
      return result;
    }
    put_text(file.stream, "performance", s + 1, one.text);
    put_text(file.stream, "data", s + 1, two.text);
    put_text(file.stream, "title", s + 1, p->solver[s]);
    fprintf(file.stream, "colour[%d] = %d\n", s + 1, colour + 1);
  }
  fprintf(file.stream, "last_ratio = %.8g\nlast_pairs = %.8g\n", last_ratio, last_pairs);
  return file_commit(&file);
}

static json_t *whole(const struct profiles *p)
{
  const struct profile times = {p->time, p->num_problems, p->num_solvers};
  json_t *solvers = json_array(), *problems = json_array();
  for (int s = 0; s < p->num_solvers; s++) {
    json_t *wins = json_object();
    for (int o = 0; o < p->num_solvers; o++)
      if (o != s) json_object_set_new(wins, p->solver[o], json_real(pairwise_wins(&times, s, o)));
    json_array_append_new(solvers,
                          json_pack("{s:s, s:f, s:f, s:f, s:o}", "solver", p->solver[s], "fastest",
                                    performance_profile(&times, s, 1), "within_twice",
                                    performance_profile(&times, s, 2), "solved",
                                    performance_profile(&times, s, HUGE_VAL), "faster_than", wins));
  }
  for (int k = 0; k < p->num_problems; k++) {
    json_t *time = json_object(), *pairs = json_object();
    for (int s = 0; s < p->num_solvers; s++) {
      json_object_set_new(time, p->solver[s], json_out_number(p->problem[k].time[s]));
      json_object_set_new(pairs, p->solver[s], json_out_number(p->problem[k].pairs[s]));
    }
    json_array_append_new(problems, json_pack("{s:s, s:o, s:o}", "problem", p->problem[k].name,
                                              "time", time, "pairs_per_particle", pairs));
  }
  return json_pack("{s:o, s:o}", "solvers", solvers, "problems", problems);
}

static void say(const struct profiles *p)
{
  const struct profile times = {p->time, p->num_problems, p->num_solvers};
  printf("%d problems, each a scene with a target error that some solver reaches\n",
         p->num_problems);
  printf("  %-12s %8s %14s %8s\n", "solver", "fastest", "within twice", "solved");
  for (int s = 0; s < p->num_solvers; s++)
    printf("  %-12s %6.0f %% %12.0f %% %6.0f %%\n", p->solver[s],
           100 * performance_profile(&times, s, 1), 100 * performance_profile(&times, s, 2),
           100 * performance_profile(&times, s, HUGE_VAL));
}

static status draw(const struct profiles *p)
{
  const struct path data = data_folder();
  static const char *const names[] = {"performance-profile", "data-profile"};
  for (int k = 0; k < 2; k++) {
    const struct drawing drawing = {names[k], p->out,
                                    path_of("%s/paper-figures/%s.gp", data.text, names[k]),
                                    path_of("%s", p->out)};
    TRY(drawing_make(&drawing));
    if (!p->quiet) printf("%s/%s.png\n%s/%s.svg\n", p->out, names[k], p->out, names[k]);
  }
  return OK;
}

static status work(struct profiles *p)
{
  const struct path path = path_of("%s/profile.json", p->out);
  struct names known = {NULL, 0};
  TRY(gather(p));
  TRY(folder_make(p->out));
  TRY(solver_names(&known));
  status result = write_data(p, &known);
  names_free(&known);
  if (result == OK) result = json_out_finish(whole(p), path.text, NULL);
  if (result == OK && p->json) result = json_out_finish(whole(p), p->json, NULL);
  p->quiet |= p->json && strcmp(p->json, "-") == 0;
  if (result == OK && !p->quiet) say(p);
  return result == OK ? draw(p) : result;
}

status verb_profile(int argc, char **argv)
{
  static struct profiles p;
  p = (struct profiles){.out = "results/precision/profile"};
  const struct flag flags[] = {
    {"-o", &p.out, NULL}, {"--json", &p.json, NULL}, {"--quiet", NULL, &p.quiet}};
  const struct arguments what = {"profile", flags,      sizeof flags / sizeof *flags,
                                 p.files,   MOST_FILES, &p.num_files};
  TRY(arguments_parse(&what, argc, argv));
  if (p.num_files == 0)
    return user_error("profile: FILEs are missing, precision.json of one scene or more");
  TRY(gnuplot_check());
  const status result = work(&p);
  for (int k = 0; k < p.num_problems; k++) free(p.problem[k].name);
  for (int s = 0; s < p.num_solvers; s++) free(p.solver[s]);
  free(p.problem);
  free(p.time);
  free(p.pairs);
  return result;
}
