/* From what the user typed to a solver, its parameters and a filled scene. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../scene/scene_file.h"
#include "driver.h"

static status unknown(const char *kind, const char *name, const char *const *names, int n)
{
  const char *near = nearest_name(name, names, n);
  if (near) return user_error("unknown %s '%s'; the nearest known one is '%s'", kind, name, near);
  return user_error("unknown %s '%s'; 'sphbench list %ss' lists them", kind, name, kind);
}

status solver_require(const char *name, const struct solver **solver)
{
  if (!name) return user_error("run needs --solver NAME; 'sphbench list solvers' lists them");
  *solver = solver_find(name);
  if (*solver) return OK;
  const char *names[64];
  int n = 0;
  for (; n < solver_count() && n < 64; n++) names[n] = solver_number(n)->name;
  return unknown("solver", name, names, n);
}

static status unknown_scene(const char *name)
{
  const char *names[64];
  int n = 0;
  for (; n < num_benchmarks && n < 64; n++) names[n] = benchmarks[n]->name;
  return unknown("scene", name, names, n);
}

static int looks_like_file(const char *name)
{
  struct stat about;
  return strchr(name, '/') || strstr(name, ".y") || stat(name, &about) == 0;
}

/* The scene's own defaults, before the user's values. */
static status open_setting(const struct options *o, struct setting *set)
{
  if (!o->name) return user_error("%s needs a scene; 'sphbench list scenes' lists them", o->verb);
  for (int k = 0; k < num_scene_params; k++)
    *(double *)((char *)&set->scene.common + scene_param_rows[k].offset) =
      scene_param_rows[k].initial;
  set->benchmark = benchmark_find(o->name);
  if (set->benchmark) {
    const struct benchmark *b = set->benchmark;
    set->self = calloc(1, b->state_size + 1);
    if (!set->self) return status_set(ERR_MEMORY, "no memory for the scene");
    for (int k = 0; k < b->num_params; k++)
      *(real *)((char *)set->self + b->params[k].offset) = (real)b->params[k].initial;
    if (b->defaults) b->defaults(&set->scene.common);
    return OK;
  }
  if (!looks_like_file(o->name)) return unknown_scene(o->name);
  TRY(scene_file_load(o->name, &set->file));
  scene_file_defaults(set->file, &set->scene.common);
  return OK;
}

/* Set `key` where it belongs: scene, then solver. */
static status set_value(struct plan *plan, const char *key, const char *text, const char *where)
{
  struct setting *set = &plan->setting;
  const struct benchmark *b = set->benchmark;
  const struct param *p = param_find(scene_param_rows, num_scene_params, key);
  double value;
  if (p) {
    TRY(param_parse(p, text, where, &value));
    *(double *)((char *)&set->scene.common + p->offset) = value;
    return OK;
  }
  if (b && (p = param_find(b->params, b->num_params, key))) {
    TRY(param_parse(p, text, where, &value));
    *(real *)((char *)set->self + p->offset) = (real)value;
    return OK;
  }
  p = param_find(plan->solver->params, plan->solver->num_params, key);
  if (p) return param_parse(p, text, where, &plan->solver_values[p - plan->solver->params]);
  const char *names[128];
  int n = 0;
  for (int k = 0; k < num_scene_params && n < 128; k++) names[n++] = scene_param_rows[k].name;
  for (int k = 0; b && k < b->num_params && n < 128; k++) names[n++] = b->params[k].name;
  for (int k = 0; k < plan->solver->num_params && n < 128; k++)
    names[n++] = plan->solver->params[k].name;
  const char *near = nearest_name(key, names, n);
  return near ? user_error(
                  "%s: neither the scene nor the solver has a parameter '%s'; the nearest is '%s'",
                  where, key, near)
              : user_error("%s: neither the scene nor the solver has a parameter '%s'", where, key);
}

static status set_values(const struct options *o, struct plan *plan)
{
  for (int k = 0; k < o->num_sets; k++) {
    char key[64], where[96];
    const char *equals = strchr(o->set[k], '=');
    snprintf(key, sizeof key, "%.*s", (int)(equals - o->set[k]), o->set[k]);
    snprintf(where, sizeof where, "--set %s", key);
    TRY(set_value(plan, key, equals + 1, where));
  }
  if (o->dt) TRY(set_value(plan, "dt", o->dt, "--dt"));
  if (o->t_end) TRY(set_value(plan, "t_end", o->t_end, "--t-end"));
  if (o->spacing) TRY(set_value(plan, "spacing", o->spacing, "--spacing"));
  return OK;
}

static status report_value(struct plan *plan, const struct param *p, double value)
{
  struct fact *f = &plan->parameters[plan->num_parameters];
  char *word = plan->words[plan->num_parameters++];
  const int is_choice = strchr(p->unit, '|') != NULL;
  *f = (struct fact){p->name, is_choice ? "1" : p->unit, p->meaning, value,
                     is_choice ? param_text(p, value, word) : NULL};
  return OK;
}

static status report_values(struct plan *plan)
{
  const struct setting *set = &plan->setting;
  const int own = set->benchmark ? set->benchmark->num_params : 0;
  const int total = num_scene_params + own + plan->solver->num_params + 1;
  static const struct param seed = {"seed", 1, 0, 0, "1", "seed of everything random", 0};
  plan->parameters = calloc((size_t)total, sizeof *plan->parameters);
  plan->words = calloc((size_t)total, sizeof *plan->words);
  if (!plan->parameters || !plan->words)
    return status_set(ERR_MEMORY, "no memory for the parameters");
  for (int k = 0; k < num_scene_params; k++)
    report_value(plan, &scene_param_rows[k],
                 *(const double *)((const char *)&set->scene.common + scene_param_rows[k].offset));
  for (int k = 0; k < own; k++) {
    const struct param *p = &set->benchmark->params[k];
    report_value(plan, p, (double)*(const real *)((const char *)set->self + p->offset));
  }
  for (int k = 0; k < plan->solver->num_params; k++)
    report_value(plan, &plan->solver->params[k], plan->solver_values[k]);
  return report_value(plan, &seed, (double)set->scene.seed);
}

/* Which dimension the scene runs in when it is not this executable's; the user's error if none fits
 * --dim. */
static status check_dimension(const struct options *o, const struct setting *set, int *other_dim)
{
  const unsigned here = DIM == 2 ? CAN(2D) : CAN(3D);
  const unsigned dims = set->benchmark                   ? set->benchmark->dims
                        : scene_file_dim(set->file) == 2 ? CAN(2D)
                                                         : CAN(3D);
  *other_dim = 0;
  if (dims & here) return OK;
  if (o->dim)
    return user_error("--dim: %s found, scene '%s' is %s-D only", o->dim, o->name,
                      DIM == 2 ? "3" : "2");
  *other_dim = 5 - DIM;
  return OK;
}

static status fill_scene(const struct options *o, struct setting *set)
{
  struct scene *s = &set->scene;
  long seed;
  TRY(option_whole("--seed", o->seed, 0, 2147483647, 1, &seed));
  s->seed = (unsigned long long)seed;
  s->gravity = zero();
  s->gravity.c[DIM - 1] = (real)-s->common.gravity;
  TRY(set->benchmark ? set->benchmark->build(s, set->self) : scene_file_build(set->file, s));
  if (s->common.jitter > 0) scene_apply_jitter(s);
  set->asks = scene_asks(s) | (set->benchmark ? set->benchmark->asks : 0u);
  if (set->benchmark && set->benchmark->projection) set->asks |= CAN(PROJECT);
  return scene_check(s);
}

status plan_make(const struct options *o, struct plan *plan, int *other_dim)
{
  memset(plan, 0, sizeof *plan);
  TRY(solver_require(o->solver, &plan->solver));
  TRY(open_setting(o, &plan->setting));
  TRY(check_dimension(o, &plan->setting, other_dim));
  if (*other_dim) return OK;
  plan->solver_values = calloc((size_t)plan->solver->num_params + 1, sizeof(double));
  if (!plan->solver_values) return status_set(ERR_MEMORY, "no memory for the parameters");
  for (int k = 0; k < plan->solver->num_params; k++)
    plan->solver_values[k] = plan->solver->params[k].initial;
  TRY(set_values(o, plan));
  TRY(fill_scene(o, &plan->setting));
  return report_values(plan);
}

void plan_resolve(struct plan *plan, const struct run *run)
{
  const struct solver *solver = plan->solver;
  struct fact *fact = plan->parameters + plan->num_parameters - 1 - solver->num_params;
  for (int k = 0; k < solver->num_params; k++, fact++) {
    const real taken = *(const real *)((const char *)run->state + solver->params[k].offset);
    if (!fact->word && taken != (real)fact->value) fact->value = (double)taken;
  }
}

void plan_free(struct plan *plan)
{
  free(plan->solver_values);
  free(plan->parameters);
  free(plan->words);
  free(plan->setting.self);
  scene_file_free(plan->setting.file);
  scene_free(&plan->setting.scene);
  memset(plan, 0, sizeof *plan);
}
