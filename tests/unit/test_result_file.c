/* The result file: what is written is read back, whatever happens to the disk or to the writer.
 *
 *   test_result_file FILE [elsewhere]    write the sample, for check_vtkhdf.py and check_h5same.py;
 *                                        elsewhere: the same run on another day and machine */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "../../core/io/result_read.h"
#include "result_sample.h"

static char folder[] = "result-file-XXXXXX";

static const char *in_folder(const char *name)
{
  static char path[4][256];
  static int turn;
  char *next = path[turn++ % 4];
  snprintf(next, sizeof path[0], "%s/%s", folder, name);
  return next;
}

static int exists(const char *path) { return access(path, F_OK) == 0; }

/* fork() into a child that ends by itself, whatever happens: cmocka's signal handlers would go on
 * with the next test in it. */
static pid_t fork_child(void)
{
  const pid_t child = fork();
  if (child) return child;
  for (int number = 1; number < 32; number++) signal(number, SIG_DFL);
  alarm(60);
  return 0;
}

static void write_text(const char *path, const char *text)
{
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

static void remove_all(void)
{
  char command[300];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  assert_int_equal(system(command), 0);
}

static int set_up(void **state)
{
  (void)state;
  strcpy(folder, "result-file-XXXXXX");
  return mkdtemp(folder) ? 0 : -1;
}
static int tear_down(void **state)
{
  (void)state;
  remove_all();
  return 0;
}

/* --- round trips --- */

static void check_array(struct result_read *read, int k, const char *name, int components)
{
  struct result_numbers numbers;
  assert_int_equal(result_read_array(read, k, name, &numbers), OK);
  assert_int_equal(numbers.rows, sample_count[k]);
  assert_int_equal(numbers.components, components);
  const int exact = strcmp(name, "position") == 0 || strcmp(name, "id") == 0;
  for (int i = 0; i < numbers.rows * components; i++) {
    const double wanted = sample_value(name, k, i / components, i % components);
    assert_true(numbers.values[i] == (exact ? wanted : (double)(float)wanted));
  }
  free(numbers.values);
}

static void check_frames(struct result_read *read, int frames)
{
  assert_int_equal(result_read_frames(read), frames);
  for (int k = 0; k < frames; k++) {
    assert_true(result_read_time(read, k) == 0.5 * k);
    check_array(read, k, "position", 3);
    check_array(read, k, "velocity", 3);
    check_array(read, k, "pressure", 1);
    check_array(read, k, "id", 1);
  }
}

static void check_text(struct result_read *read, const char *path, const char *wanted)
{
  char text[128];
  assert_int_equal(result_read_text(read, path, text, sizeof text), OK);
  assert_string_equal(text, wanted);
}

static void check_number(struct result_read *read, const char *path, double wanted)
{
  double value;
  assert_int_equal(result_read_number(read, path, &value), OK);
  assert_true(value == wanted);
}

static void check_series(struct result_read *read, const char *path, int rows)
{
  const struct run_facts facts = sample_facts(RUN_DONE);
  struct result_numbers numbers;
  assert_int_equal(result_read_series(read, path, &numbers), OK);
  assert_int_equal(numbers.rows, rows);
  for (int i = 0; i < rows; i++)
    assert_true(numbers.values[i] == facts.series.columns[1].values[i]);
  free(numbers.values);
}

static void what_is_written_is_read(void **state)
{
  (void)state;
  struct result_read *read;
  struct result_numbers walls;
  const char *path = in_folder("run.vtkhdf");
  assert_int_equal(sample_write(path, RUN_DONE), OK);
  assert_false(exists(in_folder("run.vtkhdf.tmp")));
  assert_int_equal(result_read_open(&read, path), OK);
  check_frames(read, SAMPLE_FRAMES);
  check_series(read, "metrics/gamma_mean", SAMPLE_STEPS);
  check_series(read, "metrics/steps/residual", SAMPLE_STEPS);
  check_text(read, "status", "complete");
  check_text(read, "solver", "sample-solver");
  check_text(read, "run/parameters/kernel", "cubic");
  check_number(read, "run/parameters/dt", 0.001);
  check_number(read, "metrics/final/gamma_mean", 0.25);
  check_number(read, "run/iterations_total", 40);
  check_number(read, "run/volatile/timing/solver", 1.5);
  check_number(read, "run/memory/fields/v", 8);
  assert_int_equal(result_read_series(read, "walls/position", &walls), OK);
  assert_true(walls.rows == 2 && walls.components == 3 && walls.values[4] == -2);
  free(walls.values);
  assert_true(result_read_has(read, "virtual/2/position"));
  assert_false(result_read_has(read, "virtual/1"));
  result_read_close(read);
}

static void every_end_has_its_word(void **state)
{
  (void)state;
  const char *words[NUM_RUN_STATUS] = {
    [RUN_DIVERGED] = "diverged", [RUN_TIMEOUT] = "timeout", [RUN_INTERRUPTED] = "interrupted"};
  for (int end = 0; end < NUM_RUN_STATUS; end++) {
    struct result_read *read;
    if (!words[end]) continue;
    assert_int_equal(sample_write(in_folder("run.vtkhdf"), (enum run_status)end), OK);
    assert_int_equal(result_read_open(&read, in_folder("run.vtkhdf")), OK);
    check_text(read, "status", words[end]);
    check_text(read, "reason", "because it was asked to");
    result_read_close(read);
  }
}

/* Frames larger than a chunk, empty frames, and single precision in three dimensions. */
static void frames_of_any_size(void **state)
{
  (void)state;
  enum { MOST = 40000 };
  static const int counts[] = {0, 300, MOST, 17000, 0, 1};
  static float x[MOST][3];
  const struct run_facts facts = sample_facts(RUN_DONE);
  const struct result_array position = {"position", "m", "position", 3, RESULT_FLOAT, x};
  struct result_file *file;
  struct result_read *read;
  for (int i = 0; i < MOST; i++) x[i][0] = x[i][1] = x[i][2] = (float)i;
  assert_int_equal(result_file_open(&file, in_folder("run.vtkhdf"), &facts), OK);
  for (int k = 0; k < 6; k++)
    assert_int_equal(
      result_file_add_frame(file, k, &(struct result_set){counts[k], NULL, 1, &position}, 0, NULL),
      OK);
  assert_int_equal(result_file_finish(file, &facts), OK);
  assert_int_equal(result_read_open(&read, in_folder("run.vtkhdf")), OK);
  for (int k = 0; k < 6; k++) {
    struct result_numbers numbers;
    assert_int_equal(result_read_array(read, k, "position", &numbers), OK);
    assert_int_equal(numbers.rows, counts[k]);
    for (int i = 0; i < 3 * counts[k]; i++) assert_true(numbers.values[i] == i / 3);
    free(numbers.values);
  }
  result_read_close(read);
}

static void a_run_without_frames_is_a_result(void **state)
{
  (void)state;
  const struct run_facts facts = sample_facts(RUN_DIVERGED);
  struct result_file *file;
  struct result_read *read;
  assert_int_equal(result_file_open(&file, in_folder("run.vtkhdf"), &facts), OK);
  assert_int_equal(result_file_finish(file, &facts), OK);
  assert_int_equal(result_read_open(&read, in_folder("run.vtkhdf")), OK);
  assert_int_equal(result_read_frames(read), 0);
  assert_false(result_read_has(read, "VTKHDF"));
  check_text(read, "status", "diverged");
  result_read_close(read);
}

static char *contents(const char *path, long *size)
{
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = ftell(file);
  char *bytes = malloc((size_t)*size);
  rewind(file);
  assert_int_equal(fread(bytes, 1, (size_t)*size, file), *size);
  fclose(file);
  return bytes;
}

/* HDF5 would note the second in which an object was made; the dates of the sample have one length.
 */
static void equal_runs_give_equal_files(void **state)
{
  (void)state;
  long size[2];
  assert_int_equal(sample_write(in_folder("a.vtkhdf"), RUN_DONE), OK);
  const struct run_facts facts = sample_facts(RUN_DONE);
  char date[32];
  strcpy(date, facts.provenance->date);
  while (strcmp(date, sample_facts(RUN_DONE).provenance->date) == 0) usleep(20000);
  assert_int_equal(sample_write(in_folder("b.vtkhdf"), RUN_DONE), OK);
  char *a = contents(in_folder("a.vtkhdf"), &size[0]),
       *b = contents(in_folder("b.vtkhdf"), &size[1]);
  assert_int_equal(size[0], size[1]);
  int different = 0;
  for (long i = 0; i < size[0]; i++) different += a[i] != b[i];
  assert_in_range(different, 1, 6); /* digits of the date */
  free(a);
  free(b);
}

/* --- what goes wrong --- */

static void a_killed_writer_leaves_its_frames(void **state)
{
  (void)state;
  struct result_read *read;
  int how;
  const pid_t child = fork_child();
  if (child == 0) {
    struct run_facts facts = sample_facts(RUN_DONE);
    struct result_file *file;
    facts.series.rows = facts.per_step.rows = 5;
    result_file_open(&file, in_folder("run.vtkhdf"), &facts);
    sample_add_frame(file, 0);
    result_file_add_series(file, &facts);
    sample_add_frame(file, 1);
    raise(SIGKILL);
  }
  waitpid(child, &how, 0);
  assert_true(WIFSIGNALED(how));
  assert_false(exists(in_folder("run.vtkhdf")));
  assert_int_equal(result_read_open(&read, in_folder("run.vtkhdf.tmp")), OK);
  check_frames(read, 2);
  check_series(read, "metrics/gamma_mean", 5);
  check_text(read, "status", "running");
  check_text(read, "run/parameters/kernel", "cubic");
  result_read_close(read);
  assert_int_equal(sample_write(in_folder("run.vtkhdf"), RUN_DONE), OK);
  assert_false(exists(in_folder("run.vtkhdf.tmp")));
}

/* Is the path refused with one sentence that names it and says why? Also in a child, so no asserts.
 */
static int refused(const char *path, const char *why)
{
  const struct run_facts facts = sample_facts(RUN_DONE);
  struct result_file *file = NULL;
  const status result = result_file_open(&file, path, &facts);
  if (result == ERR_IO && !file && strstr(status_sentence(), why) &&
      strstr(status_sentence(), path))
    return 1;
  result_file_discard(file);
  print_error("%s: status %d, '%s' does not say '%s'\n", path, result, status_sentence(), why);
  return 0;
}

static void refuses(const char *path, const char *why) { assert_true(refused(path, why)); }

static void a_bad_path_is_one_sentence(void **state)
{
  (void)state;
  write_text(in_folder("file"), "text");
  mkdir(in_folder("dir"), 0777);
  mkdir(in_folder("taken.vtkhdf.tmp"), 0777);
  refuses(in_folder("missing/run.vtkhdf"), "there is no folder 'result-file-");
  refuses(in_folder("file/run.vtkhdf"), "Not a directory");
  refuses(in_folder("dir"), "it is a folder");
  refuses(in_folder("new/"), "it names a folder");
  refuses(in_folder("taken.vtkhdf"), "Is a directory");
  refuses("/dev/full", "it is not a regular file");
  refuses("/dev/null", "it is not a regular file");
  assert_false(exists("/dev/full.tmp"));
  assert_false(exists(in_folder("dir.tmp")));
  assert_int_equal(result_file_open(&(struct result_file *){NULL}, "", &(struct run_facts){0}),
                   ERR_USER);
}

/* Root may write everywhere, so another user tries. */
static void a_protected_folder_is_one_sentence(void **state)
{
  (void)state;
  int how;
  write_text(in_folder("old.vtkhdf"), "old");
  chmod(in_folder("old.vtkhdf"), 0444);
  mkdir(in_folder("dir"), 0555);
  chmod(folder, 0755);
  const pid_t child = fork_child();
  if (child == 0) {
    if (geteuid() == 0 && setuid(65534)) _exit(1);
    _exit(!refused(in_folder("dir/run.vtkhdf"), "Permission denied") ||
          !refused(in_folder("old.vtkhdf"), "Permission denied"));
  }
  waitpid(child, &how, 0);
  assert_int_equal(how, 0);
}

static void an_unfinished_file_replaces_nothing(void **state)
{
  (void)state;
  const struct run_facts facts = sample_facts(RUN_DONE);
  struct result_file *file;
  long size;
  write_text(in_folder("run.vtkhdf"), "old");
  assert_int_equal(result_file_open(&file, in_folder("run.vtkhdf"), &facts), OK);
  refuses(in_folder("run.vtkhdf"), "another run is writing it");
  assert_int_equal(sample_add_frame(file, 0), OK);
  result_file_discard(file);
  assert_false(exists(in_folder("run.vtkhdf.tmp")));
  char *old = contents(in_folder("run.vtkhdf"), &size);
  assert_memory_equal(old, "old", 3);
  free(old);
}

/* What is seen of a disk that is full after `limit` bytes; the limit on the size of files fails at
 * the same calls. FULL_RIGHT: one sentence, nothing left, and the next file can be written. */
enum { FULL_RIGHT, FULL_SENTENCE, FULL_LEFT, FULL_STATUS, FULL_NEXT, NOT_FULL };
static int fill_disk(rlim_t limit)
{
  struct rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, before.rlim_max});
  const struct run_facts facts = sample_facts(RUN_DONE);
  struct result_file *file;
  status result = result_file_open(&file, in_folder("run.vtkhdf"), &facts);
  for (int k = 0; k < SAMPLE_FRAMES && result == OK; k++) result = sample_add_frame(file, k);
  if (result == OK) result = result_file_add_series(file, &facts);
  const int opened = file != NULL;
  const int left = result != OK && exists(in_folder("run.vtkhdf.tmp"));
  if (opened && result_file_finish(file, &facts) == OK)
    return result == OK ? NOT_FULL : FULL_STATUS;
  setrlimit(RLIMIT_FSIZE, &before);
  if (!strstr(status_sentence(), strerror(EFBIG))) return FULL_SENTENCE;
  if (left || exists(in_folder("run.vtkhdf.tmp")) || exists(in_folder("run.vtkhdf")))
    return FULL_LEFT;
  return sample_write(in_folder("next.vtkhdf"), RUN_DONE) == OK ? FULL_RIGHT : FULL_NEXT;
}

static void a_full_disk_is_one_sentence(void **state)
{
  (void)state;
  int failures = 0;
  for (rlim_t limit = 0;; limit += 1500) {
    int how;
    const pid_t child = fork_child();
    if (child == 0) exit(fill_disk(limit)); /* not _exit: HDF5 must not crash at exit either */
    waitpid(child, &how, 0);
    if (WIFEXITED(how) && WEXITSTATUS(how) == NOT_FULL) break;
    if (how) fail_msg("with %ld bytes the writer ended with %d", (long)limit, how);
    failures++;
  }
  assert_in_range(failures, 10, 1000);
}

/* --- files that are no results --- */

static void cannot_read(const char *path, const char *why)
{
  struct result_read *read;
  assert_int_equal(result_read_open(&read, path), ERR_IO);
  assert_null(read);
  if (!strstr(status_sentence(), why) || !strstr(status_sentence(), path))
    fail_msg("'%s' does not say '%s'", status_sentence(), why);
}

static void what_is_no_result_is_one_sentence(void **state)
{
  (void)state;
  write_text(in_folder("empty"), "");
  write_text(in_folder("text"), "not a result\n");
  cannot_read(in_folder("missing"), "No such file");
  cannot_read(folder, "it is a folder");
  cannot_read("/dev/null", "it is not a regular file");
  cannot_read(in_folder("empty"), "it is empty");
  cannot_read(in_folder("text"), "it is not an HDF5 file");
}

static void a_file_that_is_being_written_is_one_sentence(void **state)
{
  (void)state;
  int ready[2];
  char byte;
  assert_int_equal(pipe(ready), 0);
  const pid_t child = fork_child();
  if (child == 0) {
    const struct run_facts facts = sample_facts(RUN_DONE);
    struct result_file *file;
    result_file_open(&file, in_folder("run.vtkhdf"), &facts);
    if (write(ready[1], "", 1) == 1) pause();
    _exit(1);
  }
  assert_int_equal(read(ready[0], &byte, 1), 1);
  cannot_read(in_folder("run.vtkhdf.tmp"), "still being written");
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
  close(ready[0]);
  close(ready[1]);
}

static void what_is_not_there_is_one_sentence(void **state)
{
  (void)state;
  struct result_read *read;
  struct result_numbers numbers;
  double value;
  char text[16];
  assert_int_equal(sample_write(in_folder("run.vtkhdf"), RUN_DONE), OK);
  assert_int_equal(result_read_open(&read, in_folder("run.vtkhdf")), OK);
  assert_int_equal(result_read_array(read, 3, "position", &numbers), ERR_IO);
  assert_non_null(strstr(status_sentence(), "no frame 3"));
  assert_int_equal(result_read_array(read, 0, "presure", &numbers), ERR_IO);
  assert_non_null(strstr(status_sentence(), "no 'presure', only position, id, pressure, velocity"));
  assert_int_equal(result_read_series(read, "metrics/none/at/all", &numbers), ERR_IO);
  assert_int_equal(result_read_series(read, "metrics", &numbers), ERR_IO);
  assert_int_equal(result_read_series(read, "run/parameters/kernel", &numbers), ERR_IO);
  assert_int_equal(result_read_series(read, "", &numbers), ERR_IO);
  assert_int_equal(result_read_number(read, "metrics/gamma_mean", &value), ERR_IO);
  assert_int_equal(result_read_text(read, "nobody", text, sizeof text), ERR_IO);
  assert_int_equal(result_read_text(read, "run/parameters/dt", text, sizeof text), ERR_IO);
  assert_int_equal(result_read_text(read, "solver", text, 4), OK);
  assert_string_equal(text, "sam");
  result_read_close(read);
}

static void try_to_read(const char *path)
{
  struct result_read *read;
  struct result_numbers numbers;
  if (result_read_open(&read, path) != OK) return;
  for (long k = 0; k < result_read_frames(read); k++)
    if (result_read_array(read, k, "position", &numbers) == OK) free(numbers.values);
  if (result_read_series(read, "metrics/gamma_mean", &numbers) == OK) free(numbers.values);
  result_read_close(read);
}

static void a_file_that_is_cut_off_does_no_harm(void **state)
{
  (void)state;
  long size;
  assert_int_equal(sample_write(in_folder("run.vtkhdf"), RUN_DONE), OK);
  char *bytes = contents(in_folder("run.vtkhdf"), &size);
  for (long cut = 1; cut < size; cut += size / 100) {
    FILE *file = fopen(in_folder("cut"), "wb");
    assert_int_equal(fwrite(bytes, 1, (size_t)cut, file), cut);
    fclose(file);
    cannot_read(in_folder("cut"), "it is ");
    try_to_read(in_folder("cut"));
  }
  free(bytes);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    TEST(what_is_written_is_read),
    TEST(every_end_has_its_word),
    TEST(frames_of_any_size),
    TEST(a_run_without_frames_is_a_result),
    TEST(equal_runs_give_equal_files),
    TEST(a_killed_writer_leaves_its_frames),
    TEST(a_bad_path_is_one_sentence),
    TEST(a_protected_folder_is_one_sentence),
    TEST(an_unfinished_file_replaces_nothing),
    TEST(a_full_disk_is_one_sentence),
    TEST(what_is_no_result_is_one_sentence),
    TEST(a_file_that_is_being_written_is_one_sentence),
    TEST(what_is_not_there_is_one_sentence),
    TEST(a_file_that_is_cut_off_does_no_harm),
  };
  sample_elsewhere = argc > 2;
  if (argc > 1) return sample_write(argv[1], RUN_DONE) == OK ? 0 : 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
