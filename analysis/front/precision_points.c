/* From scene, solvers and knobs to points, and from their untimed runs to errors. */
#include <stdlib.h>
#include <string.h>

#include "precision.h"

#define K(name, word, meaning) word,
const char *const kind_words[NUM_KINDS] = {KIND_LIST(K)};
#undef K
#define K(name, word, meaning) meaning,
const char *const kind_meanings[NUM_KINDS] = {KIND_LIST(K)};
#undef K

const char *point_solver(const struct precision *p, const struct point *point)
{
  return p->study.method[point->knobs.method].name;
}

struct path point_words(const struct precision *p, const struct point *point)
{
  const struct knobs *k = &point->knobs;
  const struct method *m = &p->study.method[k->method];
  struct path words = path_of("dx %.4g", k->spacing);
  if (k->dt > 0) words = path_of("%s, dt %.4g", words.text, k->dt);
  if (m->num_tolerances > 0)
    words =
      path_of("%s, %s %.3g", words.text, m->tolerance[0].name, m->tolerance[0].initial * k->factor);
  return words;
}

/* --- making --- */

static double least(const struct values *values)
{
  double low = HUGE_VAL;
  for (int k = 0; k < values->n; k++) low = fmin(low, values->value[k]);
  return low;
}

/* What its error is measured against; 0: against the truth alone. */
static int reference_of(const struct precision *p, const struct point *point, struct knobs *knobs)
{
  const struct study *s = &p->study;
  *knobs = point->knobs;
  if (p->kind == KIND_ALGEBRAIC) knobs->factor = 0;
  if (p->kind == KIND_TEMPORAL)
    knobs->dt = study_dt(s, least(&s->plan.dt) / 4, point->knobs.spacing);
  if (p->kind == KIND_SPATIAL) knobs->dt /= 2;
  return p->kind == KIND_ALGEBRAIC || (p->kind != KIND_TOTAL && !s->is_projection);
}

static status add_point(struct precision *p, const struct knobs *knobs)
{
  struct knobs other;
  struct point *more = realloc(p->point, (size_t)(p->n + 1) * sizeof *more);
  if (!more) return status_set(ERR_MEMORY, "out of memory for the points");
  p->point = more;
  struct point *point = &p->point[p->n];
  *point = (struct point){.knobs = *knobs, .kind = p->kind, .reference = -1, .error = (double)NAN};
  point->density_error = point->visits = point->rough = point->setup_median = (double)NAN;
  point->time = (struct interval){(double)NAN, (double)NAN, (double)NAN, 0};
  p->n++;
  TRY(study_add(&p->study, knobs, &p->queue, &point->run));
  if (!reference_of(p, point, &other)) return OK;
  return study_add(&p->study, &other, &p->queue, &point->reference);
}

/* The knobs that each kind of error depends on are varied, the others held: where they do least
 * harm, or as the scene has them. */
static struct sweep_plan plan_of(const struct precision *p, const struct method *m)
{
  const struct values one = {.value = {1}, .n = 1};
  struct sweep_plan plan = p->study.plan;
  const struct values finest_dt = {.value = {least(&plan.dt)}, .n = 1};
  const struct values tightest = {.value = {least(&plan.tolerance)}, .n = 1};
  const struct values finest = {.value = {least(&plan.spacing)}, .n = 1};
  /* errors of solving and stepping are those of one system of particles */
  if (p->kind == KIND_ALGEBRAIC || p->kind == KIND_TEMPORAL) plan.spacing = finest;
  if (p->kind == KIND_ALGEBRAIC) plan.dt = one;
  if (p->kind == KIND_SPATIAL) plan.dt = finest_dt;
  if (p->kind == KIND_SPATIAL || p->kind == KIND_TEMPORAL) plan.tolerance = tightest;
  if (!method_iterates(m)) plan.tolerance = one;
  if (p->study.is_projection) plan.dt = one;
  return plan;
}

static status add_points(struct precision *p, int method)
{
  const struct study *s = &p->study;
  const struct sweep_plan plan = plan_of(p, &s->method[method]);
  const double finest = least(&plan.spacing);
  for (int x = 0; x < plan.spacing.n; x++)
    for (int t = 0; t < plan.dt.n; t++)
      for (int e = 0; e < plan.tolerance.n; e++) {
        const double spacing = plan.spacing.value[x];
        const double at = p->kind == KIND_SPATIAL ? finest : spacing; /* one step for all */
        const struct knobs knobs = {.method = method,
                                    .spacing = spacing,
                                    .dt = study_dt(s, plan.dt.value[t], at),
                                    .factor = plan.tolerance.value[e]};
        TRY(add_point(p, &knobs));
      }
  return OK;
}

status points_make(struct precision *p)
{
  const struct study *s = &p->study;
  for (int k = 0; k < s->num_methods; k++) {
    const int has_error = p->kind != KIND_ALGEBRAIC || method_iterates(&s->method[k]);
    if (s->method[k].refusal || !has_error) continue;
    TRY(add_points(p, k));
    if (p->aa && !s->ask.solvers) break; /* one solver says what the noise is */
  }
  if (p->kind == KIND_TEMPORAL && s->is_projection)
    return user_error("precision: '%s' is one projection and has no temporal error", s->ask.scene);
  return p->n ? OK
              : user_error("precision: none of the solvers has an %s error", kind_words[p->kind]);
}

void points_free(struct precision *p)
{
  for (int k = 0; k < p->n; k++) {
    struct point *point = &p->point[k];
    json_decref(point->facts);
    free(point->reason);
    free(point->note);
    run_release(&point->timed);
    for (int a = 0; a < ARMS; a++) {
      free(point->seconds[a]);
      free(point->setup[a]);
    }
  }
  free(p->point);
  p->point = NULL;
  p->n = 0;
}

/* --- reading --- */

/* Mean over the samples after the start. */
static double series_mean(const json_t *facts, const char *name)
{
  const json_t *column = json_object_get(json_object_get(facts, "series"), name);
  double sum = 0;
  int n = 0;
  for (size_t k = 1; k < json_array_size(column); k++) {
    const json_t *value = json_array_get(column, k);
    if (!json_is_number(value)) continue;
    sum += json_number_value(value);
    n++;
  }
  return n ? sum / n : (double)NAN;
}

static double metric_of(const json_t *facts, const char *name)
{
  const struct path keys = path_of("metrics.%s.value", name);
  return fact_number(facts, keys.text);
}

/* A reference that hit its cap is none. */
static char *check_reference(const struct precision *p, const struct point *point, json_t **facts)
{
  char *failure = study_failure(&p->queue, point->reference, facts);
  if (failure) {
    char *reason = text_make("what it is compared with %s", failure);
    free(failure);
    return reason;
  }
  const double most = fact_number(*facts, "iterations.max");
  const double cap = fact_number(*facts, "parameters.max_iterations");
  if (p->kind == KIND_ALGEBRAIC && most >= cap)
    return text_make("what it is compared with did not converge in %g iterations (%.2g left)", cap,
                     fact_number(*facts, "residual.last"));
  return NULL;
}

static status read_distance(struct precision *p, struct point *point)
{
  return study_distance(&p->queue, point->run, point->reference, study_array(&p->study),
                        &point->error);
}

/* Spatial only if half the time step hardly changes it; else it is what it is, the total. */
static void judge_spatial(struct precision *p, struct point *point, const json_t *reference)
{
  const double most = 0.1;
  const double change = fabs(point->error - metric_of(reference, p->study.error)) / point->error;
  if (change < most) return;
  point->kind = KIND_TOTAL;
  point->note =
    text_make("half the time step changes the error by %.2g of it: not spatial alone", change);
}

static status read_error(struct precision *p, struct point *point)
{
  json_t *reference = NULL;
  status result = OK;
  if (p->kind == KIND_TOTAL || p->kind == KIND_SPATIAL)
    point->error = metric_of(point->facts, p->study.error);
  if (point->reference >= 0) point->reason = check_reference(p, point, &reference);
  if (point->reference >= 0 && !point->reason) {
    if (p->kind == KIND_SPATIAL)
      judge_spatial(p, point, reference);
    else
      result = read_distance(p, point);
  }
  json_decref(reference);
  if (result == OK && !point->reason && !isfinite(point->error))
    point->reason = text_make("its %s is not a number", p->study.error);
  return result;
}

/* Time of the run without what only looks at it [s]. */
static double work_time(const json_t *facts)
{
  return fact_number(facts, "timing.total") - fact_number(facts, "timing.metrics") -
         fact_number(facts, "timing.output");
}

static status read_point(struct precision *p, struct point *point)
{
  point->reason = study_failure(&p->queue, point->run, &point->facts);
  point->density_error = series_mean(point->facts, "density_error_mean");
  json_object_del(point->facts, "series"); /* large, and not needed any more */
  if (point->reason) return OK;
  point->visits = fact_number(point->facts, "pairs.visited");
  point->rough = work_time(point->facts);
  return read_error(p, point);
}

status points_read(struct precision *p)
{
  for (int k = 0; k < p->n; k++) {
    TRY(read_point(p, &p->point[k]));
    if (p->point[k].reason) p->point[k].error = (double)NAN;
  }
  return OK;
}
