/* `sphbench stability`: the largest stable time step of each solver, maps, extreme cases. */
#include "stability.h"

#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "figure.h"
#include "front.h"

struct typed {
  const char *solvers, *json, *jobs, *timeout, *seeds, *jitter, *map, *dts, *ignore, *unused;
  const char *plan;
  int extreme;
};

static status parse(struct typed *t, struct stability *s, int argc, char **argv)
{
  const struct flag flags[] = {
    {"--solvers", &t->solvers, NULL}, {"--results", &s->results, NULL},
    {"--dim", &s->dim, NULL},         {"--precision", &s->precision, NULL},
    {"--backend", &s->backend, NULL}, {"--spacing", &s->spacing, NULL},
    {"--dt", &s->dt, NULL},           {"--t-end", &s->t_end, NULL},
    {"--set", &t->unused, NULL},      {"--seeds", &t->seeds, NULL},
    {"--jitter", &t->jitter, NULL},   {"--map", &t->map, NULL},
    {"--dts", &t->dts, NULL},         {"--ignore", &t->ignore, NULL},
    {"--timeout", &t->timeout, NULL}, {"--jobs", &t->jobs, NULL},
    {"--json", &t->json, NULL},       {"--quick", NULL, &s->quick},
    {"--extreme", NULL, &t->extreme}, {"--plan", &t->plan, NULL},
    {"--fresh", NULL, &s->fresh},     {"--quiet", NULL, &s->quiet},
  };
  const struct arguments what = {"stability", flags, sizeof flags / sizeof *flags,
                                 &s->scene,   1,     NULL};
  *t = (struct typed){.plan = "extreme"};
  s->results = "results";
  TRY(arguments_parse(&what, argc, argv));
  return arguments_sets(argc, argv, s->set, MOST_SETS, &s->num_sets);
}

/* KEY=V1,V2,... */
static status parse_map(struct map *map, const char *text)
{
  if (!text) return OK;
  const char *equals = strchr(text, '=');
  if (!equals || equals == text || !equals[1])
    return user_error("--map: '%s' found, KEY=VALUE,VALUE,... expected", text);
  if (strncmp(text, "dt=", 3) == 0)
    return user_error("--map: 'dt' is the other axis; --dts S,S,... chooses its values");
  map->key = strndup(text, (size_t)(equals - text));
  for (const char *at = equals + 1;; at += strcspn(at, ",") + 1) {
    const size_t length = strcspn(at, ",");
    if (length == 0) return user_error("--map: '%s' has a value that is empty", text);
    char **more = realloc(map->value, (size_t)(map->rows + 1) * sizeof *more);
    if (!more) return status_set(ERR_MEMORY, "out of memory");
    map->value = more;
    map->value[map->rows++] = strndup(at, length);
    if (!at[length]) return OK;
  }
}

/* Criteria that are no failure here. */
static status parse_ignored(struct stability *s, const char *text)
{
  char *copy = text ? strdup(text) : NULL;
  status result = OK;
  for (char *rest = copy, *word; result == OK && rest && (word = strsep(&rest, ","));) {
    const enum verdict v = verdict_named(word);
    if (v >= VERDICT_LEAK || v < VERDICT_NOT_FINITE) {
      const char *near = nearest_name(word, verdict_words, VERDICT_LEAK);
      result =
        user_error("--ignore: '%s' is no criterion%s%s%s; docs/stability.md lists them", word,
                   near ? "; the nearest is '" : "", near ? near : "", near ? "'" : "");
    } else {
      s->ignored |= 1u << v;
    }
  }
  free(copy);
  return result;
}

static status positive(const char *flag, const char *text, double *value)
{
  struct values one;
  if (!text) return OK;
  TRY(values_parse(flag, text, &one));
  if (one.n != 1) return user_error("%s: '%s' found, one number expected", flag, text);
  *value = one.value[0];
  return OK;
}

static int sets_jitter(const struct stability *s)
{
  for (int k = 0; k < s->num_sets; k++)
    if (strncmp(s->set[k], "jitter=", 7) == 0) return 1;
  return s->map.key && strcmp(s->map.key, "jitter") == 0;
}

static status take_numbers(const struct typed *t, struct stability *s, double *limit, long *jobs)
{
  const double quick_limit = 20, longest = 600; /* [s] */
  double unused;
  *limit = s->quick ? quick_limit : longest;
  *jobs = processors();
  s->num_seeds = 3;
  TRY(parse_map(&s->map, t->map));
  TRY(parse_ignored(s, t->ignore));
  TRY(values_parse("--dts", t->dts, &s->map.dts));
  TRY(positive("--dt", s->dt, &unused));
  TRY(argument_whole("--seeds", t->seeds, 1, 100, &s->num_seeds));
  TRY(argument_whole("--jobs", t->jobs, 1, 256, jobs));
  TRY(positive("--timeout", t->timeout, limit));
  s->jitter = sets_jitter(s) ? 0 : 1e-4;
  if (t->jitter && strcmp(t->jitter, "0") == 0)
    s->jitter = 0;
  else
    TRY(positive("--jitter", t->jitter, &s->jitter));
  return OK;
}

/* The name of a scene's folder: a file's without its path; a map has one of its own. */
static struct path scene_folder(const struct stability *s)
{
  const char *slash = strrchr(s->scene, '/');
  struct path name = path_of("%s", slash ? slash + 1 : s->scene);
  char *dot = strrchr(name.text, '.');
  if (dot) *dot = '\0';
  return path_of("%s/stability/%s%s%s%s%s", s->results, name.text, s->dim ? "-" : "",
                 s->dim ? s->dim : "", s->map.key ? "-" : "", s->map.key ? s->map.key : "");
}

/* A quick study has twice the spacing and a quarter of the time, unless they were given. */
static void make_quick(struct stability *s, char spacing[32], char t_end[32])
{
  const struct candidate_solver *c = &s->solver[0];
  for (int k = 0; k < s->num_solvers && c->refusal; k++) c = &s->solver[k];
  snprintf(spacing, 32, "%.6g", 2 * c->spacing);
  snprintf(t_end, 32, "%.6g", c->t_end / 4);
  const int spacing_typed = s->spacing || (s->map.key && !strcmp(s->map.key, "spacing"));
  for (int k = 0; k < s->num_solvers; k++) {
    if (!spacing_typed) s->solver[k].spacing *= 2;
    if (!s->t_end) s->solver[k].t_end /= 4;
  }
  if (!spacing_typed) s->spacing = spacing;
  if (!s->t_end) s->t_end = t_end;
}

static status work(struct stability *s, const struct typed *t)
{
  char spacing[32], t_end[32];
  TRY(stability_learn(s, t->solvers));
  if (s->quick) make_quick(s, spacing, t_end);
  TRY(limits_find(s));
  TRY(map_run(s));
  const int to_stdout = t->json && strcmp(t->json, "-") == 0;
  s->quiet |= to_stdout;
  stability_say(s);
  TRY(stability_write(s, t->json));
  return stability_draw(s);
}

static void release(struct stability *s)
{
  for (int k = 0; k < s->num_solvers; k++) {
    free(s->solver[k].name);
    free(s->solver[k].refusal);
  }
  for (int k = 0; k < s->map.rows; k++) free(s->map.value[k]);
  free(s->map.value);
  free(s->map.key);
  free(s->trial);
  queue_close(&s->queue);
}

static status search(struct stability *s, const struct typed *t, double limit, long jobs)
{
  TRY(gnuplot_check());
  s->folder = scene_folder(s);
  TRY(queue_open(&s->queue, s->results));
  s->queue.limit = limit;
  s->queue.jobs = (int)jobs;
  s->queue.quiet = s->quiet;
  return work(s, t);
}

status verb_stability(int argc, char **argv)
{
  static struct stability s; /* large, and there is one */
  struct typed t;
  double limit = 0;
  long jobs = 1;
  s = (struct stability){.queue = {.journal = {.file = -1}}};
  TRY(parse(&t, &s, argc, argv));
  status result = take_numbers(&t, &s, &limit, &jobs);
  if (result == OK && t.extreme) {
    const struct extreme_request request = {t.solvers, s.results, t.json,  t.plan,
                                            limit,     (int)jobs, s.quiet, s.fresh};
    result = s.scene ? user_error("stability: --extreme has scenes of its own; '%s' was not "
                                  "expected",
                                  s.scene)
                     : extreme_run(&request);
  } else if (result == OK && !s.scene) {
    result = user_error("stability: SCENE is missing; 'sphbench list scenes' lists them");
  } else if (result == OK) {
    result = search(&s, &t, limit, jobs);
  }
  release(&s);
  return result;
}
