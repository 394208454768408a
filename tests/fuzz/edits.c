#include "edits.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMES = 256, NAME_ROOM = 96, MOST_EDITS = 16, MOST_ROWS = 64, MOST_BYTES = 1 << 20 };

struct input {
  const uint8_t *data;
  size_t left;
};

static unsigned take(struct input *in)
{
  if (in->left == 0) return 0;
  in->left--;
  return *in->data++;
}

/* As many bytes as are there, zeros behind. */
static void take_bytes(struct input *in, void *to, size_t size)
{
  const size_t n = size < in->left ? size : in->left;
  memset(to, 0, size);
  memcpy(to, in->data, n);
  in->data += n;
  in->left -= n;
}

/* --- the objects of the file, sorted --- */

struct names {
  char name[MOST_NAMES][NAME_ROOM];
  int n;
};

static herr_t add_name(hid_t file, const char *name, const H5L_info_t *info, void *self)
{
  struct names *names = self;
  (void)file;
  (void)info;
  if (names->n < MOST_NAMES && strlen(name) < NAME_ROOM) strcpy(names->name[names->n++], name);
  return 0;
}

/* --- edits --- */

/* Some bytes of a dataset, or all its elements where it is small. */
static void patch(hid_t file, const char *name, struct input *in)
{
  const hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
  if (data < 0) return;
  const hid_t type = H5Dget_type(data), space = H5Dget_space(data);
  const size_t size = H5Tget_size(type) * (size_t)H5Sget_simple_extent_npoints(space);
  const int plain = H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) <= 0;
  uint8_t *bytes = plain && size > 0 && size < MOST_BYTES ? calloc(1, size) : NULL;
  if (bytes && H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) >= 0) {
    const size_t at = (take(in) | take(in) << 8) % size, n = 1 + take(in) % 8;
    take_bytes(in, bytes + at, n < size - at ? n : size - at);
    H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
  }
  free(bytes);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(data);
}

static hid_t some_type(struct input *in)
{
  const unsigned choice = take(in) % 8, length = 1 + take(in) % 80;
  const hid_t numbers[] = {H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I64LE,
                           H5T_STD_I32LE,  H5T_STD_U8LE,   H5T_STD_U64BE};
  hid_t type = H5Tcopy(choice < 6 ? numbers[choice] : H5T_C_S1);
  if (choice == 6) H5Tset_size(type, length);
  if (choice == 7) H5Tset_size(type, H5T_VARIABLE);
  return type;
}

static hid_t some_space(struct input *in)
{
  const int rank = (int)(take(in) % 5);
  hsize_t dims[3];
  if (rank == 4) return H5Screate(H5S_NULL);
  for (int d = 0; d < rank; d++) dims[d] = take(in) % MOST_ROWS;
  return rank ? H5Screate_simple(rank, dims, NULL) : H5Screate(H5S_SCALAR);
}

/* What is written into a new dataset or attribute; texts of variable length stay empty. */
static uint8_t *some_data(struct input *in, hid_t type, hid_t space)
{
  const hssize_t points = H5Sget_simple_extent_npoints(space);
  const size_t size = H5Tget_size(type) * (size_t)(points > 0 ? points : 0);
  uint8_t pattern[16];
  take_bytes(in, pattern, 1 + take(in) % sizeof pattern);
  uint8_t *bytes = H5Tis_variable_str(type) > 0 || size > MOST_BYTES ? NULL : malloc(size + 1);
  for (size_t k = 0; bytes && k < size; k++) bytes[k] = pattern[k % sizeof pattern];
  return bytes;
}

static void replace(hid_t file, const char *name, struct input *in)
{
  const hid_t type = some_type(in), space = some_space(in);
  H5Ldelete(file, name, H5P_DEFAULT);
  const hid_t data = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  uint8_t *bytes = data < 0 ? NULL : some_data(in, type, space);
  if (bytes) H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
  free(bytes);
  if (data >= 0) H5Dclose(data);
  H5Sclose(space);
  H5Tclose(type);
}

static void set_attribute(hid_t file, const char *name, struct input *in)
{
  static const char *const known[] = {"NSteps", "scene", "solver", "status", "unit", "Type"};
  const char *attribute = known[take(in) % (sizeof known / sizeof *known)];
  const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
  if (object < 0) return;
  const hid_t type = some_type(in), space = some_space(in);
  H5Adelete(object, attribute);
  const hid_t made = H5Acreate2(object, attribute, type, space, H5P_DEFAULT, H5P_DEFAULT);
  uint8_t *bytes = made < 0 ? NULL : some_data(in, type, space);
  if (bytes) H5Awrite(made, type, bytes);
  free(bytes);
  if (made >= 0) H5Aclose(made);
  H5Sclose(space);
  H5Tclose(type);
  H5Oclose(object);
}

/* A group, a link to nowhere or another object in its place. */
static void relink(hid_t file, const char *name, const struct names *names, struct input *in)
{
  const char *other = names->name[take(in) % (unsigned)names->n];
  const unsigned how = take(in) % 4;
  H5Ldelete(file, name, H5P_DEFAULT);
  if (how == 0) H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  if (how == 1) H5Lcreate_soft("/nowhere", file, name, H5P_DEFAULT, H5P_DEFAULT);
  if (how == 2) H5Lcreate_soft(other, file, name, H5P_DEFAULT, H5P_DEFAULT);
  if (how == 3) H5Lcreate_hard(file, other, file, name, H5P_DEFAULT, H5P_DEFAULT);
}

static void edit(hid_t file, const struct names *names, struct input *in)
{
  const unsigned what = take(in) % 8;
  const char *name = names->name[take(in) % (unsigned)names->n];
  switch (what) {
  case 0: H5Ldelete(file, name, H5P_DEFAULT); break;
  case 1: replace(file, name, in); break;
  case 2: set_attribute(file, name, in); break;
  case 3: relink(file, name, names, in); break;
  default: patch(file, name, in);
  }
}

void edits_apply(const char *path, const uint8_t *data, size_t size)
{
  static struct names names;
  struct input in = {data, size};
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
  const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
  if (file < 0) abort(); /* it was just written */
  names.n = 0;
  H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, add_name, &names);
  for (int k = 0; k < MOST_EDITS && in.left > 0 && names.n > 0; k++) edit(file, &names, &in);
  H5Fclose(file);
}
