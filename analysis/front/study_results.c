/* What came of the runs of a study. */
#include <stdlib.h>
#include <string.h>

#include "../../core/io/result_read.h"
#include "figure.h"
#include "study.h"

double fact_number(const json_t *facts, const char *keys)
{
  char name[64];
  for (const char *key = keys; facts && *key;) {
    const size_t length = strcspn(key, ".");
    snprintf(name, sizeof name, "%.*s", (int)length, key);
    facts = json_object_get(facts, name);
    key += length + (key[length] == '.');
  }
  return json_is_number(facts) ? json_number_value(facts) : (double)NAN;
}

char *study_failure(const struct queue *queue, int run, json_t **facts)
{
  const struct run *r = &queue->run[run];
  *facts = NULL;
  if (!r->finished) return strdup("was not run");
  *facts = run_facts_json(queue, run);
  if (r->outcome != OUTCOME_OK)
    return text_make("%s: %s", outcome_words[r->outcome],
                     r->reason && *r->reason ? r->reason : "without a reason");
  if (!*facts) return strdup("its facts cannot be read");
  const double lost = fact_number(*facts, "metrics.particles_lost.value");
  return lost > 0 ? text_make("%g particles were lost", lost) : NULL;
}

static status read_frame(struct result_read *file, long frame, const char *name,
                         struct result_numbers *numbers)
{
  *numbers = (struct result_numbers){0, 0, NULL};
  return result_read_array(file, frame, name, numbers);
}

/* The first and last frame of a run. */
struct ends {
  struct result_numbers first, last;
  double time;
};

static status read_ends(const struct queue *queue, int run, const char *name, struct ends *ends)
{
  const struct path path = run_file(queue->results, queue->run[run].id, "vtkhdf");
  struct result_read *file;
  *ends = (struct ends){.time = 0};
  TRY(result_read_open(&file, path.text));
  const long frames = result_read_frames(file);
  status result = frames > 1 ? OK : status_set(ERR_IO, "'%s' has no frame of its end", path.text);
  if (result == OK) result = read_frame(file, 0, name, &ends->first);
  if (result == OK) result = read_frame(file, frames - 1, name, &ends->last);
  if (result == OK) ends->time = result_read_time(file, frames - 1);
  result_read_close(file);
  return result;
}

static void ends_free(struct ends *ends)
{
  free(ends->first.values);
  free(ends->last.values);
}

static double nearest_image(double x, double period)
{
  return period > 0 ? x - period * round(x / period) : x;
}

static status compare(const struct ends *a, const struct ends *b, const double period[3],
                      double *distance)
{
  const long n = a->last.rows * a->last.components;
  const double late = fabs(a->time - b->time);
  double error = 0, size = 0;
  if (n != b->last.rows * b->last.components || n != b->first.rows * b->first.components)
    return status_set(ERR_IO, "two runs that are to be compared have not the same particles");
  if (late > 1e-6 * fabs(b->time))
    return status_set(ERR_IO, "two runs that are to be compared end at %g s and %g s", a->time,
                      b->time);
  for (long k = 0; k < n; k++) {
    const double side = period[k % b->last.components];
    const double e = nearest_image(a->last.values[k] - b->last.values[k], side);
    const double moved = nearest_image(b->last.values[k] - b->first.values[k], side);
    error += e * e;
    size += moved * moved;
  }
  *distance = size > 0 ? sqrt(error / size) : (double)NAN;
  return OK;
}

static void read_period(const struct queue *queue, int run, double period[3])
{
  json_t *facts = run_facts_json(queue, run);
  const json_t *sides = json_object_get(facts, "period");
  for (size_t d = 0; d < 3; d++) period[d] = json_number_value(json_array_get(sides, d));
  json_decref(facts);
}

const char *study_array(const struct study *study)
{
  return study->is_projection ? "velocity" : "position";
}

status study_distance(const struct queue *queue, int run, int other, const char *array,
                      double *distance)
{
  struct ends a, b = {.time = 0};
  double period[3] = {0, 0, 0};
  if (strcmp(array, "position") == 0) read_period(queue, other, period);
  *distance = (double)NAN;
  status result = read_ends(queue, run, array, &a);
  if (result == OK) result = read_ends(queue, other, array, &b);
  if (result == OK) result = compare(&a, &b, period, distance);
  ends_free(&a);
  ends_free(&b);
  return result;
}
