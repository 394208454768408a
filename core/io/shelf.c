#include "shelf.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

status shelf_refuse(struct shelf *s, const char *format, ...)
{
  char why[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(why, sizeof why, format, arguments);
  va_end(arguments);
  if (s->failed == OK) s->failed = user_error("'%s': %s", s->path, why);
  return s->failed;
}

/* May the walk go on? Takes note of what HDF5 found while writing. */
static int is_well(struct shelf *s)
{
  if (s->failed != OK || !s->h5.error) return s->failed == OK;
  if (s->saving)
    s->failed = out_path_failed(&s->out, s->h5.error == H5_UNKNOWN ? 0 : s->h5.error);
  else
    shelf_refuse(s, "it cannot be read to its end");
  return 0;
}

static hid_t open_file(struct shelf *s)
{
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS), creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
  H5Pset_file_locking(access, s->saving, 1); /* where the file system can */
  H5Pset_obj_track_times(creation, 0);
  const hid_t file = s->saving ? H5Fcreate(s->out.temp, H5F_ACC_TRUNC, creation, access)
                               : H5Fopen(s->path, H5F_ACC_RDONLY, access);
  H5Pclose(creation);
  H5Pclose(access);
  return file;
}

status shelf_open(struct shelf *s, const char *path, int saving)
{
  *s = (struct shelf){.path = path, .saving = saving, .h5 = {.file = -1}};
  h5_start();
  if (saving) TRY(out_path_begin(&s->out, path, 0));
  s->h5.file = h5_check(&s->h5, open_file(s));
  if (s->h5.file >= 0) return OK;
  if (saving)
    is_well(s);
  else
    shelf_refuse(s, "there is no file of this name that can be read");
  return shelf_close(s);
}

static hid_t in_memory(enum shelf_type type)
{
  switch (type) {
  case SHELF_FLOAT: return H5T_NATIVE_FLOAT;
  case SHELF_DOUBLE: return H5T_NATIVE_DOUBLE;
  case SHELF_INT: return H5T_NATIVE_INT;
  case SHELF_LONG: return H5T_NATIVE_LONG;
  }
  return H5T_NATIVE_DOUBLE;
}

static hid_t in_file(enum shelf_type type)
{
  switch (type) {
  case SHELF_FLOAT: return H5T_IEEE_F32LE;
  case SHELF_DOUBLE: return H5T_IEEE_F64LE;
  case SHELF_INT: return H5T_STD_I32LE;
  case SHELF_LONG: return H5T_STD_I64LE;
  }
  return H5T_IEEE_F64LE;
}

/* Is the open dataset of this type and size? */
static int agrees(hid_t data, hid_t wanted, int rank, const hsize_t *dims)
{
  hsize_t found[2] = {0, 0};
  const hid_t type = H5Dget_type(data), space = H5Dget_space(data);
  int same = type >= 0 && space >= 0 && H5Tequal(type, wanted) > 0 &&
             H5Sget_simple_extent_ndims(space) == rank &&
             H5Sget_simple_extent_dims(space, found, NULL) >= 0;
  for (int d = 0; same && d < rank; d++) same = found[d] == dims[d];
  if (type >= 0) H5Tclose(type);
  if (space >= 0) H5Sclose(space);
  return same;
}

static void load(struct shelf *s, const char *name, hid_t type, const struct h5_array *array)
{
  if (H5Lexists(s->h5.file, name, H5P_DEFAULT) <= 0) {
    shelf_refuse(s, "it has no '%s'", name);
    return;
  }
  const hid_t data = H5Dopen2(s->h5.file, name, H5P_DEFAULT);
  if (data < 0 || !agrees(data, type, array->rank, array->dims))
    shelf_refuse(s, "its '%s' is not of the type and size that this run needs", name);
  else
    h5_check(&s->h5, H5Dread(data, array->memory, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                             (void *)array->data)); /* the walk's own, which it gave to be filled */
  if (data >= 0) H5Dclose(data);
  is_well(s);
}

void shelf_array(struct shelf *s, struct h5_label label, struct shelf_array a)
{
  const struct h5_array array = {.type = in_file(a.type),
                                 .memory = in_memory(a.type),
                                 .rank = a.width ? 2 : 1,
                                 .dims = {(hsize_t)a.rows, (hsize_t)a.width},
                                 .data = a.data};
  if (!is_well(s) || a.rows == 0) return;
  if (s->saving)
    h5_put(&s->h5, s->h5.file, label, array);
  else
    load(s, label.name, array.type, &array);
}

long shelf_rows(const struct shelf *s, const char *name)
{
  const long most_inflation = 1100; /* deflate makes at most 1/1032 of what it is given */
  hsize_t dims[H5S_MAX_RANK] = {0}, bytes = 0;
  if (s->failed != OK || H5Lexists(s->h5.file, name, H5P_DEFAULT) <= 0) return -1;
  const hid_t data = H5Dopen2(s->h5.file, name, H5P_DEFAULT);
  if (data < 0) return -1;
  const hid_t space = H5Dget_space(data);
  const int rank = H5Sget_simple_extent_dims(space, dims, NULL);
  H5Sclose(space);
  H5Dclose(data);
  const int known = rank > 0 && H5Fget_filesize(s->h5.file, &bytes) >= 0;
  return known && dims[0] / (hsize_t)most_inflation <= bytes ? (long)dims[0] : -1;
}

void shelf_number(struct shelf *s, struct h5_label label, double *value)
{
  shelf_array(s, label, (struct shelf_array){SHELF_DOUBLE, 1, 0, value});
}

void shelf_whole(struct shelf *s, struct h5_label label, long *value)
{
  shelf_array(s, label, (struct shelf_array){SHELF_LONG, 1, 0, value});
}

void shelf_text(struct shelf *s, struct h5_label label, char *text, int size)
{
  if (!is_well(s)) return;
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, (size_t)size);
  const struct h5_array array = {.type = type, .memory = type, .data = text};
  if (s->saving) {
    memset(text + strlen(text), 0, (size_t)size - strlen(text));
    h5_put(&s->h5, s->h5.file, label, array);
  } else {
    load(s, label.name, type, &array);
    text[size - 1] = '\0';
  }
  H5Tclose(type);
}

void shelf_group(struct shelf *s, const char *name)
{
  if (!is_well(s) || !s->saving) return;
  const hid_t group = h5_group(&s->h5, s->h5.file, name);
  if (group >= 0) H5Gclose(group);
}

status shelf_close(struct shelf *s)
{
  is_well(s);
  if (s->h5.file >= 0) h5_check(&s->h5, H5Fclose(s->h5.file));
  s->h5.file = -1;
  is_well(s);
  if (s->saving && s->failed == OK) s->failed = out_path_commit(&s->out);
  out_path_discard(&s->out);
  return s->failed;
}
