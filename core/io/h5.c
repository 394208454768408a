#include "h5.h"

#include <stdlib.h>
#include <string.h>

enum { DEFLATE_LEVEL = 1, WORTH_COMPRESSING = 256, MOST_CHUNK = 16384 /* rows */ };

void h5_start(void)
{
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

/* HDF5 tells the system's error number only inside a message. */
static herr_t find_error_number(unsigned depth, const H5E_error2_t *entry, void *found)
{
  (void)depth;
  const char *text = entry->desc ? strstr(entry->desc, "errno = ") : NULL;
  if (text) *(int *)found = atoi(text + strlen("errno = "));
  return 0;
}

hid_t h5_check(struct h5 *h, hid_t result)
{
  if (result >= 0 || h->error) return result;
  h->error = H5_UNKNOWN;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, find_error_number, &h->error);
  return result;
}

/* Objects must not remember when they were written: files of identical runs are identical. */
static hid_t without_times(hid_t class)
{
  const hid_t properties = H5Pcreate(class);
  H5Pset_obj_track_times(properties, 0);
  return properties;
}

hid_t h5_group(struct h5 *h, hid_t parent, const char *name)
{
  if (h->error) return -1;
  const hid_t properties = without_times(H5P_GROUP_CREATE);
  const hid_t group = h5_check(h, H5Gcreate2(parent, name, H5P_DEFAULT, properties, H5P_DEFAULT));
  H5Pclose(properties);
  return group;
}

static hid_t text_type(void)
{
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

void h5_attribute_text(struct h5 *h, hid_t object, const char *name, const char *text)
{
  if (h->error || !text) return;
  if (H5Aexists(object, name) > 0) h5_check(h, H5Adelete(object, name));
  const hid_t type = text_type(), space = H5Screate(H5S_SCALAR);
  const hid_t attribute =
    h5_check(h, H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT));
  if (attribute >= 0) {
    h5_check(h, H5Awrite(attribute, type, &text));
    h5_check(h, H5Aclose(attribute));
  }
  H5Sclose(space);
  H5Tclose(type);
}

hid_t h5_attribute_integers(struct h5 *h, hid_t object, const char *name, int count,
                            const long long *values)
{
  if (h->error) return -1;
  const hsize_t length = (hsize_t)count;
  const hid_t space = count ? H5Screate_simple(1, &length, NULL) : H5Screate(H5S_SCALAR);
  const hid_t attribute =
    h5_check(h, H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT));
  if (attribute >= 0) h5_check(h, H5Awrite(attribute, H5T_NATIVE_LLONG, values));
  H5Sclose(space);
  return attribute;
}

static hid_t create(struct h5 *h, hid_t parent, struct h5_label label, hid_t type, hid_t space,
                    hid_t properties)
{
  const hid_t data =
    h5_check(h, H5Dcreate2(parent, label.name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT));
  if (data < 0) return data;
  h5_attribute_text(h, data, "unit", label.unit);
  h5_attribute_text(h, data, "description", label.about);
  return data;
}

static void compress(hid_t properties)
{
  H5Pset_shuffle(properties);
  H5Pset_deflate(properties, DEFLATE_LEVEL);
}

void h5_put(struct h5 *h, hid_t parent, struct h5_label label, struct h5_array array)
{
  if (h->error) return;
  const hid_t space =
    array.rank ? H5Screate_simple(array.rank, array.dims, NULL) : H5Screate(H5S_SCALAR);
  const hid_t properties = without_times(H5P_DATASET_CREATE);
  if (array.rank && array.dims[0] >= WORTH_COMPRESSING) {
    const hsize_t rows = array.dims[0] < MOST_CHUNK ? array.dims[0] : MOST_CHUNK;
    H5Pset_chunk(properties, array.rank, (const hsize_t[]){rows, array.dims[1]});
    compress(properties);
  }
  const hid_t data = create(h, parent, label, array.type, space, properties);
  if (data >= 0) {
    h5_check(h, H5Dwrite(data, array.memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.data));
    h5_check(h, H5Dclose(data));
  }
  H5Pclose(properties);
  H5Sclose(space);
}

void h5_put_number(struct h5 *h, hid_t parent, struct h5_label label, double value)
{
  h5_put(h, parent, label,
         (struct h5_array){.type = H5T_IEEE_F64LE, .memory = H5T_NATIVE_DOUBLE, .data = &value});
}

void h5_put_integer(struct h5 *h, hid_t parent, struct h5_label label, long long value)
{
  h5_put(h, parent, label,
         (struct h5_array){.type = H5T_STD_I64LE, .memory = H5T_NATIVE_LLONG, .data = &value});
}

void h5_put_texts(struct h5 *h, hid_t parent, struct h5_label label, int count,
                  const char *const *texts)
{
  const hid_t type = text_type();
  h5_put(
    h, parent, label,
    (struct h5_array){
      .type = type, .memory = type, .rank = count > 0, .dims = {(hsize_t)count}, .data = texts});
  H5Tclose(type);
}

hid_t h5_column(struct h5 *h, hid_t parent, struct h5_label label, hid_t type, int width,
                long chunk, int whole)
{
  if (h->error) return -1;
  const int rank = width ? 2 : 1;
  const hsize_t empty[2] = {0, (hsize_t)width}, most[2] = {H5S_UNLIMITED, (hsize_t)width};
  const hsize_t together[2] = {(hsize_t)chunk, (hsize_t)width};
  const hid_t space = H5Screate_simple(rank, empty, most);
  const hid_t properties = without_times(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, rank, together);
  if (whole) compress(properties);
  const hid_t data = create(h, parent, label, type, space, properties);
  H5Pclose(properties);
  H5Sclose(space);
  return data;
}

void h5_append(struct h5 *h, hid_t column, long long first, long long rows, hid_t memory,
               const void *data)
{
  if (h->error || rows <= 0) return;
  hid_t space = h5_check(h, H5Dget_space(column));
  hsize_t size[2] = {0, 0}, start[2] = {(hsize_t)first, 0};
  const int rank = H5Sget_simple_extent_dims(space, size, NULL);
  H5Sclose(space);
  size[0] = (hsize_t)(first + rows);
  h5_check(h, H5Dset_extent(column, size));
  size[0] = (hsize_t)rows;
  space = h5_check(h, H5Dget_space(column));
  const hid_t block = H5Screate_simple(rank, size, NULL);
  h5_check(h, H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL));
  h5_check(h, H5Dwrite(column, memory, block, space, H5P_DEFAULT, data));
  H5Sclose(block);
  H5Sclose(space);
}

void h5_link(struct h5 *h, const char *path, hid_t to, const char *name)
{
  if (h->error) return;
  h5_check(h, H5Lcreate_hard(h->file, path, to, name, H5P_DEFAULT, H5P_DEFAULT));
}
