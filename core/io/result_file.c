#include "result_file.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "h5.h"
#include "out_path.h"
#include "result_facts.h"

/* Per-step integers of VTKHDF 2.0: C(name, path, width, description). Where the format wants the
 * same numbers under several names, the others are hard links to these. */
#define STEP_COLUMNS(C)                                                                 \
  C(COUNT, "NumberOfPoints", 0, "particles of each step; one vertex cell each")         \
  C(NO_CELLS, "Lines/Offsets", 0, "zero per step: there are no such cells")             \
  C(STEP, "Steps/PartOffsets", 0, "number of the step, from 0")                         \
  C(PARTS, "Steps/NumberOfParts", 0, "one part per step")                               \
  C(FIRST, "Steps/PointOffsets", 0, "row of the step's first particle")                 \
  C(CELLS, "Steps/CellOffsets", 4, "first vertex, line, polygon and strip of the step") \
  C(IDS, "Steps/ConnectivityIdOffsets", 4, "zero: all steps share one connectivity")
enum step_column {
#define C(name, path, width, about) COLUMN_##name,
  STEP_COLUMNS(C)
#undef C
    NUM_STEP_COLUMNS
};

static const struct {
  const char *path, *about;
  int width;
} step_columns[NUM_STEP_COLUMNS] = {
#define C(name, path, width, about) {path, about, width},
  STEP_COLUMNS(C)
#undef C
};

static const struct {
  const char *target, *name;
} step_links[] = {
  {"/VTKHDF/NumberOfPoints", "Vertices/NumberOfCells"},
  {"/VTKHDF/NumberOfPoints", "Vertices/NumberOfConnectivityIds"},
  {"/VTKHDF/Lines/Offsets", "Lines/NumberOfCells"},
  {"/VTKHDF/Lines/Offsets", "Lines/NumberOfConnectivityIds"},
  {"/VTKHDF/Lines/Offsets", "Polygons/Offsets"},
  {"/VTKHDF/Lines/Offsets", "Polygons/NumberOfCells"},
  {"/VTKHDF/Lines/Offsets", "Polygons/NumberOfConnectivityIds"},
  {"/VTKHDF/Lines/Offsets", "Strips/Offsets"},
  {"/VTKHDF/Lines/Offsets", "Strips/NumberOfCells"},
  {"/VTKHDF/Lines/Offsets", "Strips/NumberOfConnectivityIds"},
  {"/VTKHDF/Lines/Connectivity", "Polygons/Connectivity"},
  {"/VTKHDF/Lines/Connectivity", "Strips/Connectivity"},
};
static const char *const vtk_groups[] = {"PointData",
                                         "FieldData",
                                         "CellData",
                                         "Vertices",
                                         "Lines",
                                         "Polygons",
                                         "Strips",
                                         "Steps",
                                         "Steps/PointDataOffsets",
                                         "Steps/FieldDataOffsets"};

enum { STEP_CHUNK = 64, LEAST_CHUNK = 256, MOST_CHUNK = 1 << 24 /* rows */ };
#define COUNT_OF(a) (sizeof(a) / sizeof *(a))

struct result_file {
  struct h5 h5;
  struct out_path out;
  hid_t vtk, num_steps; /* /VTKHDF and @NSteps; < 0 before the first frame */
  hid_t steps[NUM_STEP_COLUMNS], times, offsets, connectivity;
  hid_t *arrays, *numbers; /* [num_arrays], [num_numbers] */
  int num_arrays, num_numbers;
  long long frames, points, most; /* so far; most: largest n of a frame */
  void *rows;                     /* room for one array of one frame */
  size_t rows_size;
};

/* --- rows of particles --- */

static const struct {
  size_t bytes;
} types[] = {[RESULT_FLOAT] = {4}, [RESULT_DOUBLE] = {8}, [RESULT_INT] = {4}};

/* HDF5's types are variables that exist only once it runs. */
static hid_t type_in_file(enum result_type type)
{
  return type == RESULT_INT     ? H5T_STD_I32LE
         : type == RESULT_FLOAT ? H5T_IEEE_F32LE
                                : H5T_IEEE_F64LE;
}
static hid_t type_in_memory(enum result_type type)
{
  return type == RESULT_INT     ? H5T_NATIVE_INT32
         : type == RESULT_FLOAT ? H5T_NATIVE_FLOAT
                                : H5T_NATIVE_DOUBLE;
}

static int width_in_file(const struct result_array *array)
{
  return array->components == 1 ? 0 : 3;
}

static void *room(struct result_file *f, size_t bytes)
{
  if (bytes > f->rows_size) {
    free(f->rows);
    f->rows = malloc(bytes);
    f->rows_size = f->rows ? bytes : 0;
  }
  return f->rows;
}

/* The rows of one array in the order and width of the file; NULL: out of memory, noted. */
static const void *arrange(struct result_file *f, const struct result_set *set,
                           const struct result_array *array)
{
  const size_t from = types[array->type].bytes * (size_t)array->components;
  const size_t to = array->components == 2 ? 3 * types[array->type].bytes : from;
  if (!set->order && from == to) return array->data;
  char *rows = room(f, to * (size_t)set->n + 1);
  if (!rows) {
    if (!f->h5.error) f->h5.error = ENOMEM;
    return NULL;
  }
  for (long k = 0; k < set->n; k++) {
    const long i = set->order ? set->order[k] : k;
    memcpy(rows + to * (size_t)k, (const char *)array->data + from * (size_t)i, from);
    memset(rows + to * (size_t)k + from, 0, to - from);
  }
  return rows;
}

/* A set that is written once, into a group of its own. */
static void put_set(struct result_file *f, hid_t parent, const char *name,
                    const struct result_set *set)
{
  const hid_t group = h5_group(&f->h5, parent, name);
  for (int a = 0; a < set->num_arrays; a++) {
    const struct result_array *array = &set->arrays[a];
    const int width = width_in_file(array);
    h5_put(&f->h5, group, (struct h5_label){array->name, array->unit, array->about},
           (struct h5_array){.type = type_in_file(array->type),
                             .memory = type_in_memory(array->type),
                             .rank = width ? 2 : 1,
                             .dims = {(hsize_t)set->n, (hsize_t)width},
                             .data = arrange(f, set, array)});
  }
  H5Gclose(group);
}

/* --- opening, failing, closing --- */

/* The outcome of every call. On an error the file is removed but not closed: after a full disk HDF5
 * cannot close it. */
static status settle(struct result_file *f)
{
  if (!f->h5.error) return OK;
  unlink(f->out.temp);
  return out_path_failed(&f->out, f->h5.error > 0 ? f->h5.error : 0);
}

static void release(struct result_file *f)
{
  if (!f) return;
  out_path_discard(&f->out);
  free(f->arrays);
  free(f->numbers);
  free(f->rows);
  free(f);
}

static void create_file(struct result_file *f)
{
  h5_start();
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  H5Pset_file_locking(access, 1, 1); /* where the file system can */
  H5Pset_obj_track_times(creation, 0);
  f->h5.file = h5_check(&f->h5, H5Fcreate(f->out.temp, H5F_ACC_TRUNC, creation, access));
  H5Pclose(creation);
  H5Pclose(access);
}

static void flush(struct result_file *f)
{
  if (!f->h5.error) h5_check(&f->h5, H5Fflush(f->h5.file, H5F_SCOPE_LOCAL));
}

status result_file_open(struct result_file **file, const char *path, const struct run_facts *facts)
{
  struct result_file *f = calloc(1, sizeof *f);
  *file = NULL;
  if (!f) return status_set(ERR_MEMORY, "out of memory for the result file");
  f->vtk = -1;
  status result = out_path_begin(&f->out, path, 0);
  if (result == OK) {
    create_file(f);
    result_facts_start(&f->h5, facts);
    flush(f);
    result = settle(f);
  }
  if (result == OK)
    *file = f;
  else
    release(f);
  return result;
}

void result_file_discard(struct result_file *file)
{
  if (!file) return;
  if (!file->h5.error) H5Fclose(file->h5.file);
  release(file);
}

status result_file_finish(struct result_file *file, const struct run_facts *facts)
{
  result_facts_series(&file->h5, facts);
  result_facts_end(&file->h5, facts);
  flush(file);
  if (!file->h5.error) h5_check(&file->h5, H5Fclose(file->h5.file));
  status result = settle(file);
  if (result == OK) result = out_path_commit(&file->out);
  release(file);
  return result;
}

/* --- frames --- */

static void link_particles(struct result_file *f, const struct result_set *fluid)
{
  struct h5 *h = &f->h5;
  const hid_t particles = h5_group(h, h->file, "particles"),
              group = h5_group(h, particles, "fluid");
  h5_link(h, "/VTKHDF/Points", group, "position");
  h5_link(h, "/VTKHDF/Steps/Values", group, "time");
  h5_link(h, "/VTKHDF/NumberOfPoints", group, "count");
  h5_link(h, "/VTKHDF/Steps/PointOffsets", group, "first");
  for (int a = 1; a < fluid->num_arrays; a++) {
    char path[256];
    snprintf(path, sizeof path, "/VTKHDF/PointData/%s", fluid->arrays[a].name);
    h5_link(h, path, group, fluid->arrays[a].name);
  }
  H5Gclose(group);
  H5Gclose(particles);
}

static void create_steps(struct result_file *f)
{
  struct h5 *h = &f->h5;
  for (int c = 0; c < NUM_STEP_COLUMNS; c++)
    f->steps[c] =
      h5_column(h, f->vtk, (struct h5_label){step_columns[c].path, "1", step_columns[c].about},
                H5T_STD_I64LE, step_columns[c].width, STEP_CHUNK, 0);
  h5_put(h, f->vtk, (struct h5_label){"Lines/Connectivity", "1", "empty: there are no such cells"},
         (struct h5_array){.type = H5T_STD_I64LE, .memory = H5T_NATIVE_LLONG, .rank = 1});
  for (size_t i = 0; i < COUNT_OF(step_links); i++)
    h5_link(h, step_links[i].target, f->vtk, step_links[i].name);
  f->times = h5_column(h, f->vtk, (struct h5_label){"Steps/Values", "s", "time of each step"},
                       H5T_IEEE_F64LE, 0, STEP_CHUNK, 0);
}

/* A chunk per frame of this size, so that appending one does not rewrite another's. */
static long rows_per_chunk(long n)
{
  return n < LEAST_CHUNK ? LEAST_CHUNK : n < MOST_CHUNK ? n : MOST_CHUNK;
}

static void create_arrays(struct result_file *f, const struct result_set *fluid)
{
  struct h5 *h = &f->h5;
  const long chunk = rows_per_chunk(fluid->n);
  const int whole = chunk == fluid->n;
  for (int a = 0; a < f->num_arrays; a++) {
    const struct result_array *array = &fluid->arrays[a];
    char path[256], offsets[256];
    snprintf(path, sizeof path, a ? "PointData/%s" : "Points", array->name);
    f->arrays[a] = h5_column(h, f->vtk, (struct h5_label){path, array->unit, array->about},
                             type_in_file(array->type), width_in_file(array), chunk, whole);
    snprintf(offsets, sizeof offsets, "Steps/PointDataOffsets/%s", array->name);
    if (a) h5_link(h, "/VTKHDF/Steps/PointOffsets", f->vtk, offsets);
  }
  f->connectivity =
    h5_column(h, f->vtk, (struct h5_label){"Vertices/Connectivity", "1", "0, 1, 2, ..."},
              H5T_STD_I64LE, 0, chunk, whole);
  f->offsets =
    h5_column(h, f->vtk, (struct h5_label){"Vertices/Offsets", "1", "0 .. n of each step in turn"},
              H5T_STD_I64LE, 0, chunk + 1, whole);
}

static void create_numbers(struct result_file *f, const struct fact *numbers)
{
  for (int i = 0; i < f->num_numbers; i++) {
    char path[256], offsets[256];
    snprintf(path, sizeof path, "FieldData/%s", numbers[i].name);
    f->numbers[i] =
      h5_column(&f->h5, f->vtk, (struct h5_label){path, numbers[i].unit, numbers[i].about},
                H5T_IEEE_F64LE, 0, STEP_CHUNK, 0);
    snprintf(offsets, sizeof offsets, "Steps/FieldDataOffsets/%s", numbers[i].name);
    h5_link(&f->h5, "/VTKHDF/Steps/PartOffsets", f->vtk, offsets);
  }
}

/* VTK reads the type of the data set only as a text of fixed length in ASCII, padded with zeros. */
static void declare_format(struct result_file *f)
{
  static const char poly_data[] = "PolyData";
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, sizeof poly_data - 1);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const hid_t name =
    h5_check(&f->h5, H5Acreate2(f->vtk, "Type", type, space, H5P_DEFAULT, H5P_DEFAULT));
  if (name >= 0) h5_check(&f->h5, H5Awrite(name, type, poly_data));
  H5Aclose(name);
  H5Sclose(space);
  H5Tclose(type);
  H5Aclose(h5_attribute_integers(&f->h5, f->vtk, "Version", 2, (const long long[]){2, 0}));
}

/* The first frame tells which arrays there are and of what type. */
static void begin_frames(struct result_file *f, const struct result_set *fluid, int num_numbers,
                         const struct fact *numbers)
{
  f->num_arrays = fluid->num_arrays;
  f->num_numbers = num_numbers;
  f->arrays = calloc((size_t)f->num_arrays + 1, sizeof *f->arrays);
  f->numbers = calloc((size_t)f->num_numbers + 1, sizeof *f->numbers);
  if (!f->arrays || !f->numbers) {
    f->h5.error = ENOMEM;
    return;
  }
  f->vtk = h5_group(&f->h5, f->h5.file, "VTKHDF");
  declare_format(f);
  for (size_t g = 0; g < COUNT_OF(vtk_groups); g++)
    H5Gclose(h5_group(&f->h5, f->vtk, vtk_groups[g]));
  create_steps(f);
  create_arrays(f, fluid);
  create_numbers(f, numbers);
  const hid_t steps = H5Gopen2(f->vtk, "Steps", H5P_DEFAULT);
  f->num_steps = h5_attribute_integers(&f->h5, steps, "NSteps", 0, &f->frames);
  H5Gclose(steps);
  link_particles(f, fluid);
}

/* Vertices: the offsets 0 .. n, and the connectivity 0 .. n-1 as far as no earlier frame was as
 * large. */
static void append_vertices(struct result_file *f, long n)
{
  long long *count = room(f, ((size_t)n + 1) * sizeof *count);
  if (!count) {
    f->h5.error = ENOMEM;
    return;
  }
  for (long k = 0; k <= n; k++) count[k] = k;
  h5_append(&f->h5, f->offsets, f->points + f->frames, n + 1, H5T_NATIVE_LLONG, count);
  if (n <= f->most) return;
  h5_append(&f->h5, f->connectivity, f->most, n - f->most, H5T_NATIVE_LLONG, count + f->most);
  f->most = n;
}

static void append_step(struct result_file *f, double time, long n)
{
  const long long row[NUM_STEP_COLUMNS][4] = {[COLUMN_COUNT] = {n},
                                              [COLUMN_STEP] = {f->frames},
                                              [COLUMN_PARTS] = {1},
                                              [COLUMN_FIRST] = {f->points},
                                              [COLUMN_CELLS] = {f->points}};
  for (int c = 0; c < NUM_STEP_COLUMNS; c++)
    h5_append(&f->h5, f->steps[c], f->frames, 1, H5T_NATIVE_LLONG, row[c]);
  h5_append(&f->h5, f->times, f->frames, 1, H5T_NATIVE_DOUBLE, &time);
}

status result_file_add_frame(struct result_file *f, double time, const struct result_set *fluid,
                             int num_numbers, const struct fact *numbers)
{
  if (f->h5.error) return settle(f);
  if (f->vtk < 0) begin_frames(f, fluid, num_numbers, numbers);
  assert(f->h5.error || (fluid->num_arrays == f->num_arrays && num_numbers == f->num_numbers));
  for (int a = 0; a < f->num_arrays && !f->h5.error; a++)
    h5_append(&f->h5, f->arrays[a], f->points, fluid->n, type_in_memory(fluid->arrays[a].type),
              arrange(f, fluid, &fluid->arrays[a]));
  for (int i = 0; i < f->num_numbers; i++)
    h5_append(&f->h5, f->numbers[i], f->frames, 1, H5T_NATIVE_DOUBLE, &numbers[i].value);
  if (!f->h5.error) append_vertices(f, fluid->n);
  append_step(f, time, fluid->n);
  f->frames++;
  f->points += fluid->n;
  if (!f->h5.error) h5_check(&f->h5, H5Awrite(f->num_steps, H5T_NATIVE_LLONG, &f->frames));
  flush(f);
  return settle(f);
}

status result_file_add_walls(struct result_file *f, const struct result_set *walls)
{
  put_set(f, f->h5.file, "walls", walls);
  flush(f);
  return settle(f);
}

status result_file_add_virtual(struct result_file *f, const struct result_set *set)
{
  char name[64];
  assert(f->frames > 0);
  if (!f->h5.error && H5Lexists(f->h5.file, "virtual", H5P_DEFAULT) <= 0)
    H5Gclose(h5_group(&f->h5, f->h5.file, "virtual"));
  snprintf(name, sizeof name, "virtual/%lld", f->frames - 1);
  put_set(f, f->h5.file, name, set);
  flush(f);
  return settle(f);
}

status result_file_add_series(struct result_file *f, const struct run_facts *facts)
{
  result_facts_series(&f->h5, facts);
  flush(f);
  return settle(f);
}
