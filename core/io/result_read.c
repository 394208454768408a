#include "result_read.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "h5.h"

struct result_read {
  hid_t file;
  char *path;
  long long bytes; /* size of the file */
  long frames;
  double *time;          /* [frames] s */
  double *first, *count; /* [frames] rows of each frame; whole numbers */
};

/* A dataset of numbers, opened. */
struct source {
  hid_t data, space;
  int rank;        /* 0, 1 or 2 */
  hsize_t size[2]; /* 1 where there is no such dimension */
};

/* Deflate makes at most 1/1032 of what it is given; a file that claims more is damaged. */
enum { MOST_INFLATION = 1100 };

static status failed(const struct result_read *r, const char *format, ...)
{
  char why[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(why, sizeof why, format, arguments);
  va_end(arguments);
  return status_set(ERR_IO, "cannot read '%s': %s", r->path, why);
}

/* --- datasets --- */

static void close_source(struct source *s)
{
  if (s->space >= 0) H5Sclose(s->space);
  if (s->data >= 0) H5Dclose(s->data);
}

/* Every step of the path must exist: H5Lexists on a deeper one fails where an upper one is missing
 * or no group. */
static int exists(hid_t file, const char *path)
{
  char part[512];
  if (strlen(path) >= sizeof part) return 0;
  for (const char *end = path; *end;) {
    end += 1 + strcspn(end + 1, "/");
    snprintf(part, sizeof part, "%.*s", (int)(end - path), path);
    if (H5Lexists(file, part, H5P_DEFAULT) <= 0) return 0;
    if (H5Oexists_by_name(file, part, H5P_DEFAULT) <= 0) return 0;
  }
  return *path != 0;
}

int result_read_has(const struct result_read *r, const char *path) { return exists(r->file, path); }

static int is_number(hid_t data)
{
  const hid_t type = H5Dget_type(data);
  const H5T_class_t class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
  if (type >= 0) H5Tclose(type);
  return class == H5T_INTEGER || class == H5T_FLOAT;
}

static status open_source(const struct result_read *r, const char *path, struct source *s)
{
  *s = (struct source){.data = -1, .space = -1, .size = {1, 1}};
  if (!exists(r->file, path)) return failed(r, "it has no '%s'", path);
  s->data = H5Dopen2(r->file, path, H5P_DEFAULT);
  if (s->data < 0) return failed(r, "'%s' is no dataset", path);
  s->space = H5Dget_space(s->data);
  s->rank = H5Sget_simple_extent_ndims(s->space);
  if (!is_number(s->data) || s->rank < 0 || s->rank > 2) {
    close_source(s);
    return failed(r, "'%s' is no list of numbers", path);
  }
  H5Sget_simple_extent_dims(s->space, s->size, NULL);
  return OK;
}

/* Rows first .. first+rows-1 of an open source. */
static status read_rows(const struct result_read *r, const char *path, struct source *s,
                        hsize_t first, hsize_t rows, struct result_numbers *out)
{
  const hsize_t width = s->size[1], most = (hsize_t)(r->bytes * MOST_INFLATION);
  if (first > s->size[0] || rows > s->size[0] - first)
    return failed(r, "'%s' ends before row %llu", path, (unsigned long long)(first + rows));
  if (width > most || (width && rows > most / width))
    return failed(r, "'%s' claims more numbers than the file can hold", path);
  *out = (struct result_numbers){.rows = (long)rows, .components = (int)width};
  out->values = calloc(rows * width + 1, sizeof *out->values);
  if (!out->values) return status_set(ERR_MEMORY, "out of memory for '%s' of '%s'", path, r->path);
  if (rows * width == 0) return OK;
  const hsize_t start[2] = {first, 0}, size[2] = {rows, width};
  const hid_t block = H5Screate_simple(s->rank, size, NULL);
  if (s->rank) H5Sselect_hyperslab(s->space, H5S_SELECT_SET, start, NULL, size, NULL);
  const herr_t read =
    H5Dread(s->data, H5T_NATIVE_DOUBLE, block, s->space, H5P_DEFAULT, out->values);
  H5Sclose(block);
  if (read >= 0) return OK;
  free(out->values);
  *out = (struct result_numbers){0};
  return failed(r, "'%s' is damaged", path);
}

status result_read_series(struct result_read *r, const char *path, struct result_numbers *out)
{
  struct source s;
  *out = (struct result_numbers){0};
  TRY(open_source(r, path, &s));
  const status result = read_rows(r, path, &s, 0, s.size[0], out);
  close_source(&s);
  return result;
}

status result_read_number(struct result_read *r, const char *path, double *value)
{
  struct result_numbers numbers;
  TRY(result_read_series(r, path, &numbers));
  const int single = numbers.rows == 1 && numbers.components == 1;
  if (single) *value = numbers.values[0];
  free(numbers.values);
  return single ? OK : failed(r, "'%s' is not a single number", path);
}

/* --- texts and names --- */

static hid_t variable_text(void)
{
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

/* Only a scalar of a text of variable length is taken: anything else could overrun what is read
 * into. */
static int is_text(hid_t type, hid_t space)
{
  return type >= 0 && H5Tis_variable_str(type) > 0 && H5Sget_simple_extent_npoints(space) == 1;
}

static int take_text(hid_t object, int is_attribute, char *text, size_t size)
{
  char *found = NULL;
  const hid_t type = is_attribute ? H5Aget_type(object) : H5Dget_type(object);
  const hid_t space = is_attribute ? H5Aget_space(object) : H5Dget_space(object);
  const hid_t wanted = variable_text();
  if (is_text(type, space)) {
    const herr_t read = is_attribute
                          ? H5Aread(object, wanted, &found)
                          : H5Dread(object, wanted, H5S_ALL, H5S_ALL, H5P_DEFAULT, &found);
    if (read < 0) found = NULL;
  }
  if (found) snprintf(text, size, "%s", found);
  H5Tclose(wanted);
  H5Sclose(space);
  H5Tclose(type);
  if (!found) return -1;
  H5free_memory(found);
  return 0;
}

status result_read_text(struct result_read *r, const char *path, char *text, size_t size)
{
  int taken = -1;
  if (exists(r->file, path)) {
    const hid_t data = H5Dopen2(r->file, path, H5P_DEFAULT);
    if (data >= 0) {
      taken = take_text(data, 0, text, size);
      H5Dclose(data);
    }
  } else if (exists(r->file, "run") && H5Aexists_by_name(r->file, "run", path, H5P_DEFAULT) > 0) {
    const hid_t attribute = H5Aopen_by_name(r->file, "run", path, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute >= 0) {
      taken = take_text(attribute, 1, text, size);
      H5Aclose(attribute);
    }
  }
  return taken ? failed(r, "it has no text '%s'", path) : OK;
}

struct visitor {
  void (*use)(const char *name, void *self);
  void *self;
};

static herr_t visit(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
  (void)group;
  (void)info;
  const struct visitor *visitor = context;
  visitor->use(name, visitor->self);
  return 0;
}

status result_read_names(struct result_read *r, const char *group,
                         void (*use)(const char *name, void *self), void *self)
{
  struct visitor visitor = {use, self};
  if (!exists(r->file, group)) return failed(r, "it has no '%s'", group);
  if (H5Literate_by_name(r->file, group, H5_INDEX_NAME, H5_ITER_INC, NULL, visit, &visitor,
                         H5P_DEFAULT) < 0)
    return failed(r, "'%s' is no group", group);
  return OK;
}

/* --- opening --- */

static status check_readable(const struct result_read *r, long long *bytes)
{
  struct stat found;
  if (stat(r->path, &found)) return failed(r, "%s", strerror(errno));
  if (S_ISDIR(found.st_mode)) return failed(r, "it is a folder");
  if (!S_ISREG(found.st_mode)) return failed(r, "it is not a regular file");
  if (access(r->path, R_OK)) return failed(r, "%s", strerror(errno));
  if (found.st_size == 0) return failed(r, "it is empty");
  *bytes = found.st_size;
  return OK;
}

/* Why a readable file does not open. */
static status explain(const struct result_read *r)
{
  if (H5Fis_hdf5(r->path) == 0) return failed(r, "it is not an HDF5 file");
  return failed(r, "it is cut off, damaged, or still being written");
}

static status open_file(struct result_read *r)
{
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  H5Pset_file_locking(access, 1, 1);
  r->file = H5Fopen(r->path, H5F_ACC_RDONLY, access);
  H5Pclose(access);
  return r->file < 0 ? explain(r) : OK;
}

/* One number per frame, e.g. where its particles begin. */
static status read_per_frame(struct result_read *r, const char *path, double **values)
{
  struct source s;
  struct result_numbers numbers = {0};
  TRY(open_source(r, path, &s));
  const status result = read_rows(r, path, &s, 0, (hsize_t)r->frames, &numbers);
  close_source(&s);
  *values = numbers.values;
  if (result == OK && numbers.components != 1) return failed(r, "'%s' is damaged", path);
  return result;
}

/* The number of finished frames is an attribute, written after their data. */
static status count_frames(struct result_read *r)
{
  long long frames = 0;
  const hid_t attribute =
    H5Aopen_by_name(r->file, "VTKHDF/Steps", "NSteps", H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0) return failed(r, "its number of frames is missing");
  const hid_t space = H5Aget_space(attribute);
  const herr_t read =
    H5Sget_simple_extent_npoints(space) == 1 ? H5Aread(attribute, H5T_NATIVE_LLONG, &frames) : -1;
  H5Sclose(space);
  H5Aclose(attribute);
  if (read < 0 || frames < 0 || frames > r->bytes)
    return failed(r, "its number of frames is damaged");
  r->frames = (long)frames;
  return OK;
}

static status read_frames(struct result_read *r)
{
  if (!exists(r->file, "run")) return failed(r, "it is not a result file (no group 'run')");
  if (!exists(r->file, "VTKHDF")) return OK;
  TRY(count_frames(r));
  TRY(read_per_frame(r, "VTKHDF/Steps/Values", &r->time));
  TRY(read_per_frame(r, "VTKHDF/Steps/PointOffsets", &r->first));
  TRY(read_per_frame(r, "VTKHDF/NumberOfPoints", &r->count));
  for (long k = 0; k < r->frames; k++)
    if (!(r->first[k] >= 0 && r->first[k] < 1e15 && r->count[k] >= 0 && r->count[k] < 1e15))
      return failed(r, "frame %ld is damaged", k);
  return OK;
}

status result_read_open(struct result_read **file, const char *path)
{
  h5_start();
  *file = NULL;
  struct result_read *r = calloc(1, sizeof *r);
  if (!r || !(r->path = strdup(path))) {
    free(r);
    return status_set(ERR_MEMORY, "out of memory");
  }
  r->file = -1;
  status result = check_readable(r, &r->bytes);
  if (result == OK) result = open_file(r);
  if (result == OK) result = read_frames(r);
  if (result == OK)
    *file = r;
  else
    result_read_close(r);
  return result;
}

void result_read_close(struct result_read *r)
{
  if (!r) return;
  if (r->file >= 0) H5Fclose(r->file);
  free(r->time);
  free(r->first);
  free(r->count);
  free(r->path);
  free(r);
}

/* --- frames --- */

long result_read_frames(const struct result_read *r) { return r->frames; }
double result_read_time(const struct result_read *r, long k)
{
  return k >= 0 && k < r->frames ? r->time[k] : (double)NAN;
}

static void list_name(const char *name, void *self)
{
  char *list = self;
  const size_t length = strlen(list);
  snprintf(list + length, 256 - length, "%s%s", length ? ", " : "", name);
}

status result_read_array(struct result_read *r, long k, const char *name,
                         struct result_numbers *out)
{
  char path[256], names[256] = "position";
  struct source s;
  *out = (struct result_numbers){0};
  if (k < 0 || k >= r->frames) return failed(r, "it has no frame %ld, only %ld", k, r->frames);
  const int position = strcmp(name, "position") == 0;
  snprintf(path, sizeof path, position ? "VTKHDF/Points" : "VTKHDF/PointData/%s", name);
  if (!exists(r->file, path)) {
    result_read_names(r, "VTKHDF/PointData", list_name, names);
    return failed(r, "it has no '%s', only %s", name, names);
  }
  TRY(open_source(r, path, &s));
  const hsize_t columns = s.size[1];
  const status result =
    position && columns < 2
      ? failed(r, "'%s' has %d columns, positions have at least 2", path, (int)columns)
      : read_rows(r, path, &s, (hsize_t)r->first[k], (hsize_t)r->count[k], out);
  close_source(&s);
  return result;
}
