/* store.h - allocates, sorts and hands out the fields of a state from their rows, and from nothing
 * else. */
#ifndef STORE_H
#define STORE_H
#include "../particles/particles.h"
#include "../solver.h"

enum { MAX_FIELDS = 64, MAX_SPARES = 8 };

struct store_field {
  struct field row; /* offset is from the start of the state */
  void *data;       /* particle memory */
  size_t capacity;  /* bytes */
  int is_public;
};

struct store {
  void *state;          /* of the solver: its pointers are kept valid */
  int count[NUM_WHERE]; /* particles per kind of field; WALL counts wall particles */
  int num_fields;
  struct store_field field[MAX_FIELDS];
  struct {
    void *data;
    size_t capacity;
  } spare[MAX_SPARES]; /* blocks that sorting swaps with, one per size */
};

/* Take the fields in `needs` and the private rows of `solver` for n fluid and n_wall wall
 * particles. Errors: ERR_MEMORY. */
status store_open(struct store *store, const struct solver *solver, unsigned needs, int n,
                  int n_wall, void *state);

/* Change the number of virtual particles. Errors: ERR_MEMORY. */
status store_resize_virtual(struct store *store, int n);

/* Make room for n more fluid particles behind the last one: all their entries are 0, wall particles
 * keep theirs. Errors: ERR_MEMORY. */
status store_insert_fluid(struct store *store, int n);

/* Sort the KEPT entries [begin, begin + n) of the fields in `where_mask` (bits 1 << enum
 * field_where). Errors: ERR_MEMORY. */
status store_permute(struct store *store, unsigned where_mask, const int *order, int begin, int n);

/* Fill STEP fields with NaN (tests that look for stale reads). */
void store_poison(struct store *store);

/* The field's data (host code: copy through memory_to_host), NULL if it is not there. */
struct store_field *store_find(struct store *store, const char *name);
/* Of the public fields only: a solver may have one of its own by the same name. */
struct store_field *store_public(struct store *store, const char *name);

/* Bytes per element of all fields of that kind, spare room included. */
size_t store_bytes(const struct store *store);

void store_close(struct store *store);
#endif
