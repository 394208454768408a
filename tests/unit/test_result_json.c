/* The --json object: its keys, its nulls, and how it is written; and where its provenance comes
 * from. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "../../core/io/result_json.h"
#include "result_sample.h"

static char folder[] = "result-json-XXXXXX";

static const char *in_folder(const char *name)
{
  static char path[2][256];
  static int turn;
  char *next = path[turn++ % 2];
  snprintf(next, sizeof path[0], "%s/%s", folder, name);
  return next;
}

static int set_up(void **state)
{
  (void)state;
  strcpy(folder, "result-json-XXXXXX");
  return mkdtemp(folder) ? 0 : -1;
}
static int tear_down(void **state)
{
  (void)state;
  char command[300];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return system(command);
}

static json_t *written(enum run_status end)
{
  const struct run_facts facts = sample_facts(end);
  json_error_t error;
  assert_int_equal(result_json_write(in_folder("run.json"), &facts), OK);
  json_t *object = json_load_file(in_folder("run.json"), 0, &error);
  if (!object) fail_msg("line %d: %s", error.line, error.text);
  return object;
}

/* The value at a path like "iterations.mean". */
static json_t *at(json_t *object, const char *path)
{
  char copy[128], *rest = copy;
  snprintf(copy, sizeof copy, "%s", path);
  for (char *key; (key = strsep(&rest, "."));) {
    object = json_object_get(object, key);
    if (!object) fail_msg("there is no '%s'", path);
  }
  return object;
}

/* The command line's contract, key by key. */
static void all_keys_are_there(void **state)
{
  (void)state;
  static const char *const keys[] = {"scene",
                                     "solver",
                                     "variant",
                                     "parameters",
                                     "status",
                                     "reason",
                                     "steps",
                                     "time_end",
                                     "particles",
                                     "iterations.mean",
                                     "iterations.max",
                                     "iterations.total",
                                     "residual.last",
                                     "metrics",
                                     "series.time",
                                     "series.iterations",
                                     "timing.total",
                                     "timing.neighbours",
                                     "timing.solver",
                                     "timing.integrate",
                                     "timing.other",
                                     "timing.per_step",
                                     "timing.per_iteration",
                                     "memory.bytes_per_particle",
                                     "memory.peak_rss_bytes",
                                     "memory.fields",
                                     "provenance.commit",
                                     "provenance.dirty",
                                     "provenance.compiler",
                                     "provenance.flags",
                                     "provenance.cpu",
                                     "provenance.threads",
                                     "provenance.libraries",
                                     "provenance.date",
                                     "provenance.argv"};
  json_t *object = written(RUN_DONE);
  for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) assert_non_null(at(object, keys[i]));
  json_decref(object);
}

static void is_text(json_t *object, const char *path, const char *wanted)
{
  assert_true(json_is_string(at(object, path)));
  assert_string_equal(json_string_value(at(object, path)), wanted);
}

static void is_number(json_t *object, const char *path, double wanted)
{
  assert_true(json_is_number(at(object, path)));
  assert_true(json_number_value(at(object, path)) == wanted);
}

static void values_are_the_facts(void **state)
{
  (void)state;
  json_t *object = written(RUN_DONE);
  is_text(object, "scene", "sample-scene");
  is_text(object, "status", "ok");
  assert_true(json_is_null(at(object, "reason")));
  is_number(object, "parameters.dt", 0.001);
  is_text(object, "parameters.kernel", "cubic");
  is_text(object, "parameter_units.dt", "s");
  is_number(object, "metrics.gamma_mean.value", 0.25);
  is_text(object, "metrics.gamma_mean.unit", "1");
  is_number(object, "iterations.total", 40);
  is_number(object, "timing.solver", 1.5);
  is_number(object, "memory.peak_rss_bytes", 1 << 20);
  is_text(json_array_get(at(object, "memory.fields"), 1), "name", "v");
  is_number(json_array_get(at(object, "memory.fields"), 1), "bytes_per_particle", 8);
  json_t *series = at(object, "series.gamma_mean");
  assert_int_equal(json_array_size(series), SAMPLE_STEPS);
  for (size_t i = 0; i < SAMPLE_STEPS; i++)
    if (i != 7) assert_true(json_number_value(json_array_get(series, i)) == 1.0 / (1 + (double)i));
  json_decref(object);
}

static void what_is_no_number_is_null(void **state)
{
  (void)state;
  json_t *object = written(RUN_DIVERGED);
  assert_true(json_is_null(at(object, "metrics.pressure_error.value")));
  assert_true(json_is_null(at(object, "timing.per_iteration")));
  assert_true(json_is_null(json_array_get(at(object, "series.gamma_mean"), 7)));
  is_text(object, "status", "diverged");
  is_text(object, "reason", "because it was asked to");
  json_decref(object);
}

static void an_argument_of_no_encoding_is_shown(void **state)
{
  (void)state;
  json_t *object = written(RUN_DONE);
  json_t *argv = at(object, "provenance.argv");
  assert_int_equal(json_array_size(argv), 3);
  assert_string_equal(json_string_value(json_array_get(argv, 2)), "sample ?");
  json_decref(object);
}

static void provenance_is_filled(void **state)
{
  (void)state;
  int day;
  json_t *object = written(RUN_DONE);
  assert_true(strlen(json_string_value(at(object, "provenance.commit"))) >= 7);
  assert_true(json_is_boolean(at(object, "provenance.dirty")));
  assert_true(strlen(json_string_value(at(object, "provenance.compiler"))) > 3);
  assert_true(strlen(json_string_value(at(object, "provenance.cpu"))) > 3);
  is_number(object, "provenance.threads", 2);
  is_text(object, "provenance.libraries.jansson", JANSSON_VERSION);
  assert_non_null(at(object, "provenance.libraries.hdf5"));
  assert_int_equal(
    sscanf(json_string_value(at(object, "provenance.date")), "20%*2d-%*2d-%2dT", &day), 1);
  assert_true(provenance_peak_rss() > 1 << 20);
  json_decref(object);
}

static void refuses(const char *path, const char *why)
{
  const struct run_facts facts = sample_facts(RUN_DONE);
  assert_int_equal(result_json_write(path, &facts), ERR_IO);
  if (!strstr(status_sentence(), why) || !strstr(status_sentence(), path))
    fail_msg("'%s' does not say '%s'", status_sentence(), why);
}

static void what_cannot_be_written_is_one_sentence(void **state)
{
  (void)state;
  mkdir(in_folder("dir"), 0777);
  refuses("/dev/full", "No space left on device");
  refuses(in_folder("dir"), "it is a folder");
  refuses(in_folder("missing/run.json"), "there is no folder");
  assert_int_equal(symlink("/dev/full", in_folder("run.json.tmp")), 0);
  refuses(in_folder("run.json"), "symbolic link");
  assert_int_equal(access(in_folder("run.json"), F_OK), -1);
}

static void devices_are_written_to_directly(void **state)
{
  (void)state;
  const struct run_facts facts = sample_facts(RUN_DONE);
  struct stat found;
  assert_int_equal(result_json_write("/dev/null", &facts), OK);
  assert_int_equal(stat("/dev/null", &found), 0);
  assert_true(S_ISCHR(found.st_mode));
  assert_int_equal(access("/dev/null.tmp", F_OK), -1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    TEST(all_keys_are_there),
    TEST(values_are_the_facts),
    TEST(what_is_no_number_is_null),
    TEST(an_argument_of_no_encoding_is_shown),
    TEST(provenance_is_filled),
    TEST(what_cannot_be_written_is_one_sentence),
    TEST(devices_are_written_to_directly),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
