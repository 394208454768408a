/* shelf.h - numbers and texts under names, in a file that one and the same walk writes or reads
 * back, bit for bit. The first failure sticks: the calls after it do nothing, and shelf_close
 * returns it. */
#ifndef SHELF_H
#define SHELF_H
#include "h5.h"
#include "out_path.h"

enum shelf_type { SHELF_FLOAT, SHELF_DOUBLE, SHELF_INT, SHELF_LONG };

struct shelf {
  struct h5 h5;
  struct out_path out; /* when saving */
  const char *path;
  int saving;    /* 1: the walk writes; 0: it reads */
  status failed; /* the first failure; its sentence has been recorded */
};

/* `path` must outlive the shelf. When saving, the file appears under its name only when it is
 * whole. Errors: ERR_IO, ERR_USER: it is no such file. */
status shelf_open(struct shelf *shelf, const char *path, int saving);

/* Rows x width numbers (width 0: a list) to or from `data`. A file that holds another number of
 * them, or another type, is refused. */
struct shelf_array {
  enum shelf_type type;
  long rows;
  int width;
  void *data;
};
void shelf_array(struct shelf *shelf, struct h5_label label, struct shelf_array array);
void shelf_number(struct shelf *shelf, struct h5_label label, double *value);
void shelf_whole(struct shelf *shelf, struct h5_label label, long *value);
/* The rows that the array of this name has in a file that is read; -1: it has none of this name, or
 * claims more than the file can hold. Before room is made for what the file says there is. */
long shelf_rows(const struct shelf *shelf, const char *name);
/* At most `size` bytes with the 0 at the end; longer ones are cut when saved. */
void shelf_text(struct shelf *shelf, struct h5_label label, char *text, int size);

/* A folder for names "NAME/..." of the calls that follow. */
void shelf_group(struct shelf *shelf, const char *name);

/* The user's mistake, found by the walk; NULL format is not allowed. Returns ERR_USER. */
status shelf_refuse(struct shelf *shelf, const char *format, ...);

/* Give a saved file its name if all went well; in any case release what is open. Returns the first
 * failure. */
status shelf_close(struct shelf *shelf);

#endif
