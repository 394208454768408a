/* Values and curves against a baseline. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "baseline.h"

static struct comparison *add(struct comparisons *all, const char *run, const char *name)
{
  if (all->n == all->room) {
    const int room = all->room ? 2 * all->room : 256;
    struct comparison *more = realloc(all->row, (size_t)room * sizeof *more);
    if (!more) return NULL;
    all->row = more;
    all->room = room;
  }
  struct comparison *row = &all->row[all->n++];
  *row = (struct comparison){
    .run = run, .name = name, .value = NAN, .baseline = NAN, .tolerance = NAN, .excess = HUGE_VAL};
  return row;
}

static double part(const json_t *rule, const char *key)
{
  return json_number_value(json_object_get(rule, key));
}

/* Nothing passes here unless it is shown to: NaN compares as false. */
static void settle(struct comparisons *all, struct comparison *row, double difference,
                   double tolerance)
{
  row->tolerance = tolerance;
  row->pass = difference <= tolerance;
  row->excess = tolerance > 0 && !isnan(difference) ? difference / tolerance
                : row->pass                         ? 0
                                                    : HUGE_VAL;
  all->failed += !row->pass;
}

static void judge(struct comparisons *all, struct comparison *row, const json_t *rule)
{
  const char *side = json_string_value(json_object_get(rule, "side"));
  const double difference = row->value - row->baseline;
  row->side = !side || strcmp(side, "both") == 0 ? 0 : strcmp(side, "above") == 0 ? 1 : -1;
  settle(all, row, row->side ? row->side * difference : fabs(difference),
         part(rule, "abs") + part(rule, "rel") * fabs(row->baseline));
}

static status miss(struct comparisons *all, const char *run, const char *name, double baseline,
                   const char *note)
{
  struct comparison *row = add(all, run, name);
  if (!row) return status_set(ERR_MEMORY, "out of memory");
  row->baseline = baseline;
  snprintf(row->note, sizeof row->note, "%s", note);
  all->failed++;
  return OK;
}

/* --- values */

static status compare_values(struct comparisons *all, const char *key, const json_t *now,
                             const json_t *before, const json_t *rules)
{
  const char *name;
  json_t *value;
  json_object_foreach((json_t *)before, name, value)
  {
    const json_t *found = json_object_get(now, name), *rule = baseline_rule(rules, name);
    const double expected = json_number_value(value);
    if (!found) {
      TRY(miss(all, key, name, expected, "missing, or not a number"));
      continue;
    }
    struct comparison *row = add(all, key, name);
    if (!row) return status_set(ERR_MEMORY, "out of memory");
    row->value = json_number_value(found);
    row->baseline = expected;
    judge(all, row, rule);
  }
  json_object_foreach((json_t *)now, name, value) all->extra +=
    json_object_get(before, name) == NULL;
  return OK;
}

/* --- curves */

static double at(const json_t *array, size_t k)
{
  const json_t *number = json_array_get(array, k);
  return json_is_number(number) ? json_number_value(number) : NAN;
}

/* A curve at time t by straight lines; NaN outside. */
static double curve_at(const json_t *time, const json_t *curve, double t)
{
  const size_t n = json_array_size(time);
  const double close = 1e-9 * fabs(at(time, n ? n - 1 : 0));
  for (size_t k = 0; k < n; k++) {
    const double t1 = at(time, k);
    if (fabs(t1 - t) <= close) return at(curve, k);
    if (t1 > t && k > 0) {
      const double t0 = at(time, k - 1), part_ = (t - t0) / (t1 - t0);
      return (1 - part_) * at(curve, k - 1) + part_ * at(curve, k);
    }
  }
  return NAN;
}

/* The largest difference where the baseline has a number, and the curve's largest value. A point
 * that is no number now, but was one, is an infinite difference. */
static double farthest(const json_t *now, const json_t *before, const char *name, double *largest)
{
  const json_t *time = json_object_get(before, "time"), *old = json_object_get(before, name);
  const json_t *time_now = json_object_get(now, "time"), *fresh = json_object_get(now, name);
  double most = 0;
  *largest = 0;
  for (size_t k = 0; k < json_array_size(time); k++) {
    const double expected = at(old, k);
    if (isnan(expected)) continue;
    const double apart = fabs(curve_at(time_now, fresh, at(time, k)) - expected);
    most = isnan(apart) ? HUGE_VAL : fmax(most, apart);
    *largest = fmax(*largest, fabs(expected));
  }
  return most;
}

static status compare_curves(struct comparisons *all, const char *key, const json_t *now,
                             const json_t *before, const json_t *curves)
{
  const char *name;
  json_t *curve;
  json_object_foreach((json_t *)before, name, curve)
  {
    const json_t *rule = json_object_get(curves, name);
    if (strcmp(name, "time") == 0 || !rule) continue;
    if (!json_object_get(now, name)) {
      TRY(miss(all, key, name, NAN, "the curve is missing"));
      continue;
    }
    struct comparison *row = add(all, key, name);
    if (!row) return status_set(ERR_MEMORY, "out of memory");
    double largest;
    row->value = farthest(now, before, name, &largest);
    row->baseline = 0;
    settle(all, row, row->value, part(rule, "abs") + part(rule, "rel") * largest);
    snprintf(row->note, sizeof row->note, "largest difference of the curve");
  }
  return OK;
}

/* --- all */

static int worst_first(const void *a, const void *b)
{
  const struct comparison *x = a, *y = b;
  if (x->pass != y->pass) return x->pass - y->pass;
  if (x->excess != y->excess) return x->excess < y->excess ? 1 : -1;
  const int by_run = strcmp(x->run, y->run);
  return by_run ? by_run : strcmp(x->name, y->name);
}

static status compare_run(struct comparisons *all, const char *key, const json_t *now,
                          const json_t *before, const json_t *baseline)
{
  const char *was = json_string_value(json_object_get(before, "status"));
  const char *is = json_string_value(json_object_get(now, "status"));
  if (!is || strcmp(was, is) != 0) {
    char note[128];
    snprintf(note, sizeof note, "was '%s', is '%s'", was, is ? is : "nothing");
    return miss(all, key, "status", NAN, note);
  }
  all->runs++;
  TRY(compare_values(all, key, json_object_get(now, "values"), json_object_get(before, "values"),
                     json_object_get(baseline, "rules")));
  return compare_curves(all, key, json_object_get(now, "series"), json_object_get(before, "series"),
                        json_object_get(baseline, "curves"));
}

status baseline_compare(const json_t *runs, const json_t *baseline, struct comparisons *out)
{
  const json_t *known = json_object_get(baseline, "runs");
  const char *key;
  json_t *run;
  *out = (struct comparisons){.n = 0};
  json_object_foreach((json_t *)known, key, run)
  {
    const json_t *now = json_object_get(runs, key);
    if (now)
      TRY(compare_run(out, key, now, run, baseline));
    else
      TRY(miss(out, key, "run", NAN, "the run is missing"));
  }
  json_object_foreach((json_t *)runs, key, run) out->extra += json_object_get(known, key) == NULL;
  if (out->n > 0) qsort(out->row, (size_t)out->n, sizeof *out->row, worst_first);
  return OK;
}
