/* Numbers of a run by their short names. */
#include <math.h>
#include <string.h>

#include "figure.h"
#include "study.h"

/* Of the samples that are numbers. */
static double of_series(const json_t *samples, const char *which)
{
  double found = (double)NAN;
  size_t k;
  json_t *sample;
  json_array_foreach(samples, k, sample)
  {
    if (!json_is_number(sample)) continue;
    const double value = json_number_value(sample);
    const int takes = isnan(found) || strcmp(which, "last") == 0 ||
                      (strcmp(which, "largest") == 0 && value > found) ||
                      (strcmp(which, "smallest") == 0 && value < found);
    if (takes) found = value;
  }
  return found;
}

static double of_known_series(const json_t *facts, const char *name)
{
  static const char *const ways[] = {"largest", "smallest", "first", "last"};
  for (int k = 0; k < 4; k++) {
    const size_t length = strlen(ways[k]);
    if (strncmp(name, ways[k], length) == 0 && name[length] == '.')
      return of_series(json_object_get(json_object_get(facts, "series"), name + length + 1),
                       ways[k]);
  }
  return (double)NAN;
}

double fact_value(const json_t *facts, const char *name)
{
  const struct path metric = path_of("metrics.%s.value", name), time = path_of("timing.%s", name);
  if (!facts) return (double)NAN;
  if (strcmp(name, "ok") == 0) {
    const char *word = json_string_value(json_object_get(facts, "status"));
    return word && strcmp(word, "ok") == 0;
  }
  if (strcmp(name, "iterations") == 0) return fact_number(facts, "iterations.mean");
  const double tried[] = {fact_number(facts, metric.text), fact_number(facts, time.text),
                          fact_number(facts, name), of_known_series(facts, name)};
  for (int k = 0; k < 4; k++)
    if (!isnan(tried[k])) return tried[k];
  return (double)NAN;
}

const char *fact_unit(const json_t *facts, const char *name)
{
  const json_t *metric = json_object_get(json_object_get(facts, "metrics"), name);
  const char *unit = json_string_value(json_object_get(metric, "unit"));
  const int is_time = strncmp(name, "timing.", 7) == 0 ||
                      json_object_get(json_object_get(facts, "timing"), name) ||
                      strcmp(name, "time_end") == 0;
  return unit ? unit : is_time ? "s" : "1";
}
