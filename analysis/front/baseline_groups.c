/* Runs that belong together: several seeds of one case, several spacings of one case. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "baseline.h"
#include "statistics.h"

enum { LEAST_SEEDS = 3, LEAST_LEVELS = 3 };

/* The key with `*` for the value behind a flag, to be released by free(), and that value; NULL: it
 * does not have the flag. */
static char *without(const char *key, const char *flag, double *value)
{
  const char *found = strstr(key, flag);
  if (!found) return NULL;
  const char *number = found + strlen(flag);
  char *end;
  *value = strtod(number, &end);
  return text_make("%.*s*%s", (int)(number - key), key, end);
}

struct members {
  json_t **run;
  const char **key;
  double *value; /* behind the flag */
  int n;
};

static void members_free(struct members *all)
{
  free(all->run);
  free(all->key);
  free(all->value);
}

static status members_find(const json_t *runs, const char *group, const char *flag,
                           struct members *all)
{
  const size_t most = json_object_size(runs) + 1;
  *all = (struct members){calloc(most, sizeof *all->run), calloc(most, sizeof *all->key),
                          calloc(most, sizeof *all->value), 0};
  const char *key;
  json_t *run;
  if (!all->run || !all->key || !all->value) {
    members_free(all);
    return status_set(ERR_MEMORY, "out of memory");
  }
  json_object_foreach((json_t *)runs, key, run)
  {
    double value;
    char *own = without(key, flag, &value);
    if (own && strcmp(own, group) == 0 && !json_object_get(run, "seeds")) {
      all->run[all->n] = run;
      all->key[all->n] = key;
      all->value[all->n++] = value;
    }
    free(own);
  }
  return OK;
}

static const json_t *value_of(const json_t *run, const char *metric)
{
  return json_object_get(json_object_get(run, "values"), metric);
}

static const char *text_of(const json_t *run, const char *key)
{
  const char *text = json_string_value(json_object_get(run, key));
  return text ? text : "";
}

/* "ok" where all are; else how many are not, and how the first of them ended. */
static json_t *status_of(const struct members *all)
{
  const char *other = NULL;
  int num = 0;
  for (int k = 0; k < all->n; k++)
    if (strcmp(text_of(all->run[k], "status"), "ok") != 0) {
      if (!other) other = text_of(all->run[k], "status");
      num++;
    }
  return other ? json_sprintf("%d of %d %s", num, all->n, other) : json_string("ok");
}

static json_t *bits_of(const struct members *all)
{
  unsigned long long sum = 0; /* in any order */
  for (int k = 0; k < all->n; k++) sum += strtoull(text_of(all->run[k], "bits"), NULL, 16);
  return json_sprintf("%08x%08x", (unsigned)(sum >> 32), (unsigned)sum);
}

/* Median and median absolute deviation of a metric that all of them have. */
static void take_median(const struct members *all, const char *metric, json_t *values, json_t *mad)
{
  double *number = calloc((size_t)all->n, sizeof *number);
  int n = 0;
  for (int k = 0; number && k < all->n; k++) {
    const json_t *value = value_of(all->run[k], metric);
    if (value) number[n++] = json_number_value(value);
  }
  if (number && n == all->n) {
    const double median = interval_of_median(number, n).median;
    for (int k = 0; k < n; k++) number[k] = fabs(number[k] - median);
    json_object_set_new(values, metric, json_real(median));
    json_object_set_new(mad, metric, json_real(interval_of_median(number, n).median));
  }
  free(number);
}

static json_t *seeds_entry(const struct members *all)
{
  json_t *values = json_object(), *mad = json_object(), *value;
  const char *metric;
  json_object_foreach(json_object_get(all->run[0], "values"), metric, value)
    take_median(all, metric, values, mad);
  return json_pack("{s:s, s:o, s:o, s:i, s:o, s:o}", "build", text_of(all->run[0], "build"),
                   "status", status_of(all), "bits", bits_of(all), "seeds", all->n, "values",
                   values, "mad", mad);
}

/* The slope of log error over log spacing; none where an error is missing or zero. */
static void take_order(const struct members *all, const char *metric, json_t *values)
{
  double *x = calloc((size_t)all->n, sizeof *x), *y = calloc((size_t)all->n, sizeof *y);
  int n = 0;
  for (int k = 0; x && y && k < all->n; k++) {
    const double error = json_number_value(value_of(all->run[k], metric));
    if (!(error > 0) || !(all->value[k] > 0)) continue;
    x[n] = log(all->value[k]);
    y[n++] = log(error);
  }
  const double order = n == all->n ? slope_of(x, y, n) : NAN;
  char name[64];
  snprintf(name, sizeof name, "%.55s.order", metric);
  if (isfinite(order)) json_object_set_new(values, name, json_real(order));
  free(x);
  free(y);
}

static int is_error(const char *metric)
{
  const size_t n = strlen(metric);
  return n > 6 && strcmp(metric + n - 6, "_error") == 0;
}

static json_t *orders_entry(const struct members *all)
{
  json_t *values = json_object(), *value;
  const char *metric;
  json_object_foreach(json_object_get(all->run[0], "values"), metric, value) if (is_error(metric))
    take_order(all, metric, values);
  return json_pack("{s:s, s:o, s:o}", "build", text_of(all->run[0], "build"), "status",
                   status_of(all), "values", values);
}

/* The group that this key is of, once it is complete: with the first of its keys. */
static status group_one(json_t *runs, json_t *groups, const char *key, const char *flag,
                        int is_seeds)
{
  double unused;
  char *group = without(key, flag, &unused);
  struct members all;
  status result = OK;
  if (!group || json_object_get(groups, group)) goto done;
  result = members_find(runs, group, flag, &all);
  if (result != OK) goto done;
  if (all.n >= (is_seeds ? LEAST_SEEDS : LEAST_LEVELS)) {
    json_t *entry = is_seeds ? seeds_entry(&all) : orders_entry(&all);
    if (is_seeds || json_object_size(json_object_get(entry, "values")))
      json_object_set(groups, group, entry);
    json_decref(entry);
  }
  members_free(&all);
done:
  free(group);
  return result;
}

/* Replace the members of groups of seeds. */
static void drop_members(json_t *runs, const json_t *groups, const char *flag)
{
  const char *key;
  json_t *run;
  void *next;
  json_object_foreach_safe(runs, next, key, run)
  {
    double unused;
    char *group = without(key, flag, &unused);
    if (group && json_object_get(groups, group)) json_object_del(runs, key);
    free(group);
  }
}

static status group_by(json_t *runs, const char *flag, int is_seeds)
{
  json_t *groups = json_object(), *run;
  const char *key;
  status result = OK;
  json_object_foreach(runs, key, run) if (result == OK) result =
    group_one(runs, groups, key, flag, is_seeds);
  if (result == OK && is_seeds) drop_members(runs, groups, flag);
  if (result == OK) json_object_update(runs, groups);
  json_decref(groups);
  return result;
}

status baseline_group(json_t *runs)
{
  TRY(group_by(runs, " --spacing ", 0));
  return group_by(runs, " --seed ", 1);
}
