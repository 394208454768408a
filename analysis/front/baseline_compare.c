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
    .run = run, .value = NAN, .baseline = NAN, .tolerance = NAN, .excess = HUGE_VAL};
  snprintf(row->name, sizeof row->name, "%s", name);
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

/* A row with numbers, not yet judged. */
static struct comparison *add_pair(struct comparisons *all, const char *run, const char *name,
                                   const double pair[2])
{
  struct comparison *row = add(all, run, name);
  if (!row) return NULL;
  row->value = pair[0];
  row->baseline = pair[1];
  return row;
}

/* --- values */

/* The standard deviation of a median of n normal numbers, from their median absolute deviation:
 * sigma = 1.4826 MAD, and sqrt(pi / 2) sigma / sqrt(n); here of the difference of two medians. */
static double scatter_of(double mad, double n_now, double n_before)
{
  return 1.4826 * 1.2533 * mad * sqrt(1 / n_now + 1 / n_before);
}

/* Medians over seeds may differ by what the scatter between seeds makes likely; the scatter itself
 * may not grow to a multiple. */
static status judge_seeds(struct comparisons *all, struct comparison *row, const json_t *now,
                          const json_t *before, const json_t *baseline)
{
  enum { MOST_GROWTH = 4 }; /* of the deviation: that of 5 seeds is known to a factor of 2 or so */
  char name[64];
  const char *metric = row->name;
  const double sigmas = part(json_object_get(baseline, "seeds"), "sigmas");
  const double mad[] = {part(json_object_get(now, "mad"), metric),
                        part(json_object_get(before, "mad"), metric)};
  const json_t *rule = baseline_rule(json_object_get(baseline, "rules"), row->run, metric);
  const double rounding = part(rule, "abs") + part(rule, "rel") * fabs(row->baseline);
  const double n[] = {part(now, "seeds"), part(before, "seeds")};
  settle(all, row, fabs(row->value - row->baseline),
         rounding + sigmas * scatter_of(mad[1], n[0], n[1]));
  snprintf(row->note, sizeof row->note, "median of %g seeds", n[0]);
  snprintf(name, sizeof name, "%.55s.spread", metric);
  struct comparison *spread = add_pair(all, row->run, name, mad);
  if (!spread) return status_set(ERR_MEMORY, "out of memory");
  spread->side = 1;
  settle(all, spread, mad[0] - mad[1], rounding + (MOST_GROWTH - 1) * mad[1]);
  snprintf(spread->note, sizeof spread->note, "median absolute deviation of %g seeds", n[0]);
  return OK;
}

static status compare_values(struct comparisons *all, const char *key, const json_t *now,
                             const json_t *before, const json_t *baseline)
{
  const json_t *rules = json_object_get(baseline, "rules"),
               *known = json_object_get(before, "values");
  const json_t *fresh = json_object_get(now, "values");
  const int has_seeds = json_object_get(before, "mad") && json_object_get(now, "mad");
  const char *name;
  json_t *value;
  json_object_foreach((json_t *)known, name, value)
  {
    const json_t *found = json_object_get(fresh, name);
    const double pair[] = {json_number_value(found), json_number_value(value)};
    if (!found) {
      TRY(miss(all, key, name, pair[1], "missing, or not a number"));
      continue;
    }
    struct comparison *row = add_pair(all, key, name, pair);
    if (!row) return status_set(ERR_MEMORY, "out of memory");
    if (has_seeds)
      TRY(judge_seeds(all, row, now, before, baseline));
    else
      judge(all, row, baseline_rule(rules, key, name));
  }
  json_object_foreach((json_t *)fresh, name, value) all->extra +=
    json_object_get(known, name) == NULL;
  return OK;
}

/* --- curves */

static status add_part(struct comparisons *all, const char *run, const char *name,
                       const double pair[2], double tolerance)
{
  struct comparison *row = add_pair(all, run, name, pair);
  if (!row) return status_set(ERR_MEMORY, "out of memory");
  settle(all, row, fabs(pair[0] - pair[1]), tolerance);
  return OK;
}

/* Norm of the difference and rate. What the baseline has no number for is not judged.
 */
static status compare_curve(struct comparisons *all, const char *key, const char *curve,
                            const struct curve_parts *parts, const json_t *rule)
{
  const double a = part(rule, "abs"), r = part(rule, "rel"), apart[] = {parts->apart, 0};
  char name[64];
  snprintf(name, sizeof name, "%.50s.curve", curve);
  TRY(add_part(all, key, name, apart, a + r * parts->size));
  snprintf(name, sizeof name, "%.50s.rate", curve);
  if (!isnan(parts->rate[1])) TRY(add_part(all, key, name, parts->rate, a + r * parts->largest));
  return OK;
}

static int same_span(const json_t *now, const json_t *before)
{
  const json_t *a = json_object_get(now, "span"), *b = json_object_get(before, "span");
  const double long_ = fabs(json_number_value(json_array_get(b, 1)));
  for (size_t k = 0; k < 2; k++)
    if (!(fabs(json_number_value(json_array_get(a, k)) - json_number_value(json_array_get(b, k))) <=
          1e-6 * long_))
      return 0;
  return 1;
}

static status compare_curves(struct comparisons *all, const char *key, const json_t *now,
                             const json_t *before, const json_t *rules)
{
  const json_t *fresh = json_object_get(now, "curves");
  const char *name;
  json_t *curve;
  json_object_foreach(json_object_get(before, "curves"), name, curve)
  {
    const json_t *rule = baseline_rule(rules, key, name), *found = json_object_get(fresh, name);
    if (!rule) continue;
    if (!found || !same_span(now, before)) {
      TRY(miss(all, key, name, NAN, found ? "is over another time" : "the curve is missing"));
      continue;
    }
    const struct curve_parts parts = curve_compare(found, curve);
    TRY(compare_curve(all, key, name, &parts, rule));
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

static int same_text(const json_t *now, const json_t *before, const char *key)
{
  const char *a = json_string_value(json_object_get(now, key));
  const char *b = json_string_value(json_object_get(before, key));
  return a && b && strcmp(a, b) == 0;
}

static status compare_bits(struct comparisons *all, const char *key, const json_t *now,
                           const json_t *before)
{
  const int same_build = same_text(now, before, "build"), same = same_text(now, before, "bits");
  if (!json_object_get(before, "bits")) return OK;
  all->identical += same;
  all->same_build += same_build;
  if (!all->bitwise) return OK;
  if (!same)
    return miss(all, key, "bits", NAN,
                same_build ? "not the same bits" : "of another compiler, or with other flags");
  struct comparison *row = add(all, key, "bits");
  if (!row) return status_set(ERR_MEMORY, "out of memory");
  settle(all, row, 0, 0);
  return OK;
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
  TRY(compare_bits(all, key, now, before));
  TRY(compare_values(all, key, now, before, baseline));
  return compare_curves(all, key, now, before, json_object_get(baseline, "curves"));
}

/* The run itself, or where there is none the same one on a GPU. */
static const json_t *find(const json_t *runs, const char *key)
{
  static const char here[] = "(openmp-", there[] = "(cuda-";
  const json_t *found = json_object_get(runs, key);
  const char *place = strstr(key, here);
  if (found || !place) return found;
  char *other = text_make("%.*s%s%s", (int)(place - key), key, there, place + strlen(here));
  found = json_object_get(runs, other ? other : "");
  free(other);
  return found;
}

status baseline_compare(const json_t *runs, const json_t *baseline, struct comparisons *out)
{
  const json_t *known = json_object_get(baseline, "runs");
  const char *key;
  json_t *run;
  int matched = 0;
  *out = (struct comparisons){.bitwise = out->bitwise};
  json_object_foreach((json_t *)known, key, run)
  {
    const json_t *now = find(runs, key);
    matched += now != NULL;
    if (now)
      TRY(compare_run(out, key, now, run, baseline));
    else
      TRY(miss(out, key, "run", NAN, "the run is missing"));
  }
  out->extra += (int)json_object_size(runs) - matched;
  if (out->n > 0) qsort(out->row, (size_t)out->n, sizeof *out->row, worst_first);
  return OK;
}
