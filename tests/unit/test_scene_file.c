/* Scene files: what they build, and one sentence with the place for each mistake. */
#include <sys/stat.h>
#include <unistd.h>

#include "../../core/scene/scene_file.h"
#include "cloud.h"

#define DATA SPHBENCH_SOURCE_DIR "/benchmarks/"

static char path[64];

static void write_file(const char *text, size_t length)
{
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, length, file), length);
  fclose(file);
}

static status load(const char *text, struct scene_file **file)
{
  write_file(text, strlen(text));
  return scene_file_load(path, file);
}

/* Refused at line:column with these words. */
#define bad(text, place, words) check_bad(text, place, words, __LINE__)
static void check_bad(const char *text, const char *place, const char *words, int line)
{
  struct scene_file *file;
  char start[128];
  const status result = load(text, &file);
  snprintf(start, sizeof start, "%s%s", path, place);
  const char *said = status_sentence();
  if (result == ERR_USER && !file && !strncmp(said, start, strlen(start)) && strstr(said, words) &&
      !strchr(said, '\n'))
    return;
  print_error("line %d: status %d, '%s'\n  is not '%s .. %s'\n", line, (int)result, said, start,
              words);
  scene_file_free(file);
  fail();
}

/* --- good files --- */

static struct scene common_of(const struct scene_file *file)
{
  struct scene s = new_scene(0.01);
  scene_file_defaults(file, &s.common);
  s.gravity.c[DIM - 1] = (real)-s.common.gravity;
  return s;
}

static void test_example(void **state)
{
  struct scene_file *file;
  (void)state;
  must(scene_file_load(DATA "two-drops.yaml", &file));
  assert_string_equal(scene_file_name(file), "two-drops");
  assert_int_equal(scene_file_dim(file), 2);
  assert_true(strlen(scene_file_about(file)) > 0 && strlen(scene_file_source(file)) > 0);
  struct scene s = common_of(file);
  near_to(s.common.spacing, 0.01, 0, 0);
  near_to(s.common.xsph, 0.02, 0, 0);
  near_to(s.common.gravity, 9.81, 1e-15, 1e-15);
  near_to(s.common.support, 2.5, 0, 0); /* not in the file: as before */
  if (DIM == 3) {
    refused(scene_file_build(file, &s), "two-drops.yaml:6:6: dim is 2");
  } else {
    must(scene_file_build(file, &s));
    must(scene_check(&s));
    assert_in_range(s.n, 3200 + 2 * 305, 3200 + 2 * 325);
    assert_int_equal(s.n_wall, (160 + 8) * (100 + 4) - 160 * 100);
    near_to(s.v[0].c[0], 1, 0, 0);
    near_to(s.gravity.c[1], -9.81, 1e-14, 1e-6);
    near_to(s.low.c[0], -0.9, 1e-15, 1e-7);
  }
  scene_free(&s);
  scene_file_free(file);
}

#define ALL_2D                                                      \
  "dim: 2\nparams: {spacing: 0.1, kernel: wendland2, gravity: 3}\n" \
  "domain: {low: [0, 0], high: [4, 4], period: [4, 0]}\n"           \
  "fluid:\n"                                                        \
  "  - box: {low: [0, 0], high: [1, 1]}\n"                          \
  "    rotation: {centre: [0.5, 0.5], omega: 2}\n"                  \
  "    velocity: [0, 5]\n"                                          \
  "  - polygon: {corners: [[2, 2], [3, 2], [3, 3], [2, 3]]}\n"      \
  "walls:\n"                                                        \
  "  - box: {low: [1.5, 1.5], high: [3.5, 3.5], layers: 2}\n"

#define ALL_3D                                            \
  "dim: 3\nparams: {spacing: 0.1}\ngravity: [3, 0, -4]\n" \
  "fluid:\n"                                              \
  "  - ball: {centre: [0.5, 0.5, 0.5], radius: 0.5}\n"    \
  "    rotation: {centre: [0.5, 0.5, 0.5], omega: 2}\n"   \
  "  - polygon: {corners: [[2, 2], [3, 2], [3, 3], [2, 3]], z: [0, 0.2]}\n"

static void test_all_shapes_2d(void **state)
{
  struct scene_file *file;
  (void)state;
  if (DIM == 3) skip();
  must(load(ALL_2D, &file));
  struct scene s = common_of(file);
  near_to(s.common.kernel, KERNEL_WENDLAND2, 0, 0);
  must(scene_file_build(file, &s));
  must(scene_check(&s));
  assert_int_equal(s.n, 200);
  assert_int_equal(s.n_wall, 24 * 24 - 400);
  near_to(s.v[0].c[0], -2 * (0.05 - 0.5), 1e-14, 1e-6);
  near_to(s.v[0].c[1], 2 * (0.05 - 0.5) + 5, 1e-14, 1e-6);
  near_to(s.v[150].c[1], 0, 0, 0);
  near_to(s.gravity.c[1], -3, 1e-15, 1e-6);
  near_to(s.period.c[0], 4, 0, 0);
  near_to(s.period.c[1], 0, 0, 0);
  scene_free(&s);
  scene_file_free(file);
}

static void test_all_shapes_3d(void **state)
{
  struct scene_file *file;
  (void)state;
  must(load(ALL_3D, &file));
  assert_string_equal(scene_file_name(file), path);
  assert_string_equal(scene_file_about(file), "");
  if (DIM == 3) {
    struct scene s = common_of(file);
    near_to(s.common.gravity, 5, 1e-15, 1e-15);
    s.common.gravity = 10; /* the user's own strength along the file's direction */
    must(scene_file_build(file, &s));
    must(scene_check(&s));
    near_to(s.gravity.c[0], 6, 1e-14, 1e-6);
    near_to(s.gravity.c[DIM - 1], -8, 1e-14, 1e-6);
    near_to(s.n, 524 + 200, 40, 40);
    near_to(s.v[0].c[1], 2 * ((double)s.x[0].c[0] - 0.5), 1e-14, 1e-6);
    near_to(s.v[0].c[DIM - 1], 0, 0, 0);
    assert_true(s.low.c[0] <= (real)-2.8 && s.high.c[DIM - 1] >= (real)3.7); /* by default: wide */
    scene_free(&s);
  }
  scene_file_free(file);
}

/* --- files that are none --- */

static void test_no_file(void **state)
{
  struct scene_file *file;
  char folder[80];
  (void)state;
  unlink(path);
  refused(scene_file_load(path, &file), "No such file");
  assert_null(file);
  snprintf(folder, sizeof folder, "%s.d", path);
  assert_int_equal(mkdir(folder, 0700), 0);
  refused(scene_file_load(folder, &file), "is a directory");
  rmdir(folder);
  refused(scene_file_load("", &file), "No such file");
  refused(scene_file_load("/dev/zero", &file), "longer than 1 MiB");
  refused(scene_file_load("/dev/null", &file), "is empty");
}

static void test_empty_or_no_yaml(void **state)
{
  (void)state;
  bad("", " is empty", "");
  bad("\n\n  \n", " is empty", "");
  bad("# only a comment\n", " is empty", "");
  bad("---\n", ":", "nothing, allowed is a mapping");
  bad("hello\n", ":1:1:", "'hello', allowed is a mapping");
  bad("[1, 2]\n", ":1:1:", "a list, allowed is a mapping");
  bad("dim: 2\n\tfluid: 3\n", ":2:1:", "not YAML");
  bad("dim: [2\n", ":2:1:", "not YAML");
  bad("dim: \"2\n", ":", "not YAML");
  bad("dim: 2\n...\n---\ndim: 3\n", ":3:1:", "second document");
  bad("dim: &a 2\nfluid: *a\n", ":2:8:", "alias '*a'");
  bad("dim: 2\nname: \xff\xfe\n", ":2:7:", "not YAML");
  bad("{[1, 2]: 3, dim: 2}\n", ":1:2:", "a key is a list or mapping");
}

static void test_size_and_depth(void **state)
{
  const size_t n = (1 << 20) + 10;
  char *text = malloc(n);
  struct scene_file *file;
  (void)state;
  assert_non_null(text);
  memset(text, '[', n);
  write_file(text, 1 << 20);
  refused(scene_file_load(path, &file), "nested deeper");
  memset(text, ' ', n);
  write_file(text, n);
  refused(scene_file_load(path, &file), "longer than 1 MiB");
  memset(text, 0, n);
  write_file(text, 1000);
  refused(scene_file_load(path, &file), "not YAML");
  for (size_t k = 0; k < n; k++) text[k] = k % 2 ? ' ' : '-';
  write_file(text, 1 << 20);
  refused(scene_file_load(path, &file), "nested deeper");
  free(text);
}

/* --- mistakes --- */

static void test_unknown_keys(void **state)
{
  (void)state;
  bad("dim: 2\nflluid:\n  - box: {}\n", ":2:1:", "did you mean 'fluid'?");
  bad("dim: 2\nflluid:\n  - box: {}\n",
      ":2:1:", "unknown key 'flluid', allowed are name, about, source, dim, params");
  bad("dim: 2\nfluid:\n  - box:\n      low: [0, 0]\n      hih: [1, 1]\n",
      ":5:7:", "unknown key 'hih' in fluid[1].box, allowed are low, high; did you mean 'high'?");
  bad("dim: 2\nparams:\n  spacing: 1\n  dtt: 2\n",
      ":4:3:", "unknown key 'dtt' in params, allowed are spacing, dt, t_end");
  bad("dim: 2\nfluid:\n  - box: {low: [0, 0], high: [1, 1]}\n  - sphere: {}\n",
      ":4:5:", "unknown key 'sphere' in fluid[2]");
  bad("dim: 2\ndim: 3\n", ":2:1:", "'dim' is given twice");
  bad("dim: 2\n", ":1:1:", "the document has no key 'fluid'");
  bad("dim: 2\nfluid:\n  - box: {low: [0, 0]}\n", ":3:10:", "fluid[1].box has no key 'high'");
  bad("fluid:\n  - box: {low: [0, 0], high: [1, 1]}\n", ":1:1:", "no key 'dim'");
  bad("dim: 2\n\"fl\\0uid\": 3\n", ":2:1:", "unknown key");
}

#define ONE_DISC "dim: 2\nfluid:\n  - disc: {centre: [0, 0], radius: 1}\n"
#define ONE_BALL "dim: 3\nfluid:\n  - ball: {centre: [0, 0, 0], radius: 1}\n"

static void test_wrong_kinds(void **state)
{
  (void)state;
  bad("dim: two\n", ":1:6:", "dim is 'two', allowed is a whole number");
  bad("dim: 2.5\n", ":1:6:", "dim is '2.5', allowed is a whole number");
  bad("dim:\n", ":1:5:", "dim is nothing, allowed is a whole number");
  bad("dim: 99999999999\n", ":1:6:", "allowed is a whole number");
  bad("dim: 010\n", ":1:6:", "allowed is a whole number");
  bad("dim: 4\nfluid:\n  - disc: {centre: [0, 0], radius: 1}\n",
      ":1:6:", "dim is 4, allowed is 2 or 3");
  bad("dim: 2\nfluid: 3\n", ":2:8:", "fluid is '3', allowed is a list");
  bad("dim: 2\nfluid: []\n", ":2:8:", "fluid has 0 entries");
  bad("dim: 2\nfluid:\n  - box\n", ":3:5:", "fluid[1] is 'box', allowed is a mapping");
  bad("dim: 2\nfluid:\n  - box: [1, 2]\n",
      ":3:10:", "fluid[1].box is a list, allowed is a mapping");
  bad("dim: 2\nfluid:\n  - box: {low: 3, high: [1, 1]}\n",
      ":3:16:", "fluid[1].box.low is '3', allowed is a list");
  bad("dim: 2\nfluid:\n  - box: {low: [0, x], high: [1, 1]}\n",
      ":3:20:", "fluid[1].box.low[2] is 'x', allowed is a number");
  bad("dim: 2\nfluid:\n  - box: {low: [0, .nan], high: [1, 1]}\n", ":3:20:", "allowed is a number");
  bad("dim: 2\nfluid:\n  - box: {low: [0, nan], high: [1, 1]}\n", ":3:20:", "allowed is a number");
  bad("dim: 2\nfluid:\n  - box: {low: [0, 1e999], high: [1, 1]}\n",
      ":3:20:", "allowed is a number");
  bad("dim: 2\nfluid:\n  - box: {low: [0, ], high: [1, 1]}\n",
      ":3:16:", "has 1 entries, allowed are 2 to 3");
  bad("dim: 2\nfluid:\n  - box: {low: [0, ''], high: [1, 1]}\n",
      ":3:20:", "is nothing, allowed is a number");
  bad("dim: 2\nfluid:\n  - polygon: {corners: [[0, 0], [1, 1]]}\n", ":3:24:", "has 2 entries");
  bad("dim: 2\nfluid:\n  - polygon: {corners: [[0, 0], [1, 1], [1, 2, 3]]}\n",
      ":3:41:", "corners[3] has 3 entries, allowed are 2");
  bad("dim: 2\nname: [a]\n", ":2:7:", "name is a list, allowed is text");
  bad("dim: 2\nname: ''\n", ":2:7:", "name has 0 letters");
  bad(ONE_DISC "walls:\n  - box: {low: [0, 0], high: [1, 1], open_top: maybe}\n",
      ":5:48:", "open_top is 'maybe', allowed is true or false");
}

static void test_wrong_values(void **state)
{
  (void)state;
  bad("dim: 3\nfluid:\n  - box: {low: [0, 0], high: [1, 1, 1]}\n",
      ":3:16:", "fluid[1].box.low has 2 entries, allowed are 3 as dim is 3");
  bad("dim: 2\nfluid:\n  - box: {low: [0, 2], high: [1, 1]}\n",
      ":3:10:", "high is 1 on axis 2, allowed is more than low, 2");
  bad("dim: 2\nfluid:\n  - disc: {centre: [0, 0], radius: -1}\n", ":3:11:", "radius is -1");
  bad("dim: 2\nfluid:\n  - velocity: [0, 0]\n", ":3:5:", "fluid[1] has 0 shapes");
  bad(
    "dim: 2\nfluid:\n  - disc: {centre: [0, 0], radius: 1}\n    box: {low: [0, 0], high: [1, 1]}\n",
    ":3:5:", "2 shapes");
  bad("dim: 2\nfluid:\n  - ball: {centre: [0, 0], radius: 1}\n",
      ":3:11:", "allowed in 2-D is disc");
  bad("dim: 3\nfluid:\n  - disc: {centre: [0, 0, 0], radius: 1}\n",
      ":3:11:", "allowed in 3-D is ball");
  bad("dim: 3\nfluid:\n  - polygon: {corners: [[0, 0], [1, 0], [1, 1]]}\n", ":3:14:", "no key 'z'");
  bad("dim: 2\nfluid:\n  - polygon: {corners: [[0, 0], [1, 0], [1, 1]], z: [0, 1]}\n",
      ":3:14:", "allowed only where dim is 3");
  bad(ONE_DISC "    velocity: [1, 2, 3]\n", ":4:15:", "fluid[1].velocity has 3 entries");
  bad(ONE_BALL "    rotation: {centre: [1, 2], omega: 1}\n",
      ":4:24:", "rotation.centre has 2 entries");
  bad(ONE_DISC "gravity: [0, 0, -9]\n", ":4:10:", "gravity has 3 entries");
  bad(ONE_DISC "gravity: [0, -9]\nparams: {gravity: 9}\n", ":4:10:", "given here and in params");
  bad(ONE_DISC "gravity: [0, -1e9]\n", ":4:10:", "at most");
  bad(ONE_DISC "params: {dt: -1}\n", ":4:14:", "dt is -1");
  bad(ONE_DISC "params: {dt: fast}\n", ":4:14:", "dt is 'fast'");
  bad(ONE_DISC "params:\n  kernel: cubik\n",
      ":5:11:", "kernel is 'cubik', allowed is one of cubic|spiky");
  bad(ONE_DISC "params: {spacing: nan}\n", ":4:19:", "spacing");
  bad(ONE_DISC "domain: {low: [0, 0], high: [0, 1]}\n", ":4:9:", "domain.high is 0 on axis 1");
  bad(ONE_DISC "domain: {low: [0, 0], high: [1, 1], period: [2, 0]}\n",
      ":4:45:", "allowed is 0 (open) or the side, 1");
  bad(ONE_DISC "walls:\n  - box: {low: [0, 0], high: [1, 1], layers: 0}\n",
      ":5:46:", "layers is 0, allowed are 1 to 100");
  bad(ONE_DISC "walls:\n  - box: {low: [0, 0], high: [-1, 1]}\n",
      ":5:10:", "walls[1].box.high is -1");
}

static void test_errors_while_filling(void **state)
{
  struct scene_file *file;
  (void)state;
  must(load(DIM == 2 ? ONE_DISC "  - box: {low: [0, 0], high: [1e5, 1e5]}\n"
                     : ONE_BALL "  - box: {low: [0, 0, 0], high: [1e5, 1e5, 1]}\n",
            &file));
  struct scene s = common_of(file);
  s.common.spacing = 0.1;
  refused(scene_file_build(file, &s), ":4:5: fluid[2]: the box would hold 1e+1");
  scene_free(&s);
  scene_file_free(file);
}

static void test_letters_beyond_ascii(void **state)
{
  (void)state;
  bad(ONE_DISC "# caf\xc3\xa9 \xe2\x82\xac\nname: 'caf\xc3\xa9'\nx: 1\n",
      ":6:1:", "unknown key 'x'");
}

static int open_folder(void **state)
{
  (void)state;
  snprintf(path, sizeof path, "scene_file_XXXXXX");
  const int descriptor = mkstemp(path);
  if (descriptor < 0) return -1;
  close(descriptor);
  return 0;
}

static int close_folder(void **state)
{
  (void)state;
  unlink(path);
  return 0;
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_example),
    cmocka_unit_test(test_all_shapes_2d),
    cmocka_unit_test(test_all_shapes_3d),
    cmocka_unit_test(test_no_file),
    cmocka_unit_test(test_empty_or_no_yaml),
    cmocka_unit_test(test_size_and_depth),
    cmocka_unit_test(test_unknown_keys),
    cmocka_unit_test(test_wrong_kinds),
    cmocka_unit_test(test_wrong_values),
    cmocka_unit_test(test_errors_while_filling),
    cmocka_unit_test(test_letters_beyond_ascii),
  };
  return cmocka_run_group_tests(tests, open_folder, close_folder);
}
