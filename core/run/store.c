#include "store.h"

#include <stdlib.h>
#include <string.h>

#include "../base/memory.h"

static const struct field public_rows[] = {
#define FIELD(type, name, where, life, unit, meaning) \
  {#name,        unit,                                \
   meaning,      where,                               \
   life,         FIELD_COMPONENTS(type),              \
   sizeof(type), offsetof(struct view, p) + offsetof(struct particles, name)},
#include "../particles/fields.def"
#undef FIELD
};

static void publish(struct store *store, const struct store_field *f)
{
  *(void **)((char *)store->state + f->row.offset) = f->data;
}

static size_t bytes_of(const struct store *store, const struct field *row)
{
  return row->bytes * (size_t)(store->count[row->where] + 1); /* a spare element at the end */
}

static status add_field(struct store *store, const struct field *row, int is_public)
{
  if (store->num_fields == MAX_FIELDS)
    return status_set(ERR_MEMORY, "more than %d fields", MAX_FIELDS);
  struct store_field *f = &store->field[store->num_fields];
  f->row = *row;
  f->is_public = is_public;
  f->capacity = bytes_of(store, row);
  f->data = memory_take(f->capacity);
  if (!f->data)
    return status_set(ERR_MEMORY, "no memory for field '%s' (%zu bytes)", row->name, f->capacity);
  store->num_fields++;
  publish(store, f);
  return OK;
}

status store_open(struct store *store, const struct solver *solver, unsigned needs, int n,
                  int n_wall, void *state)
{
  memset(store, 0, sizeof *store);
  store->state = state;
  store->count[FLUID] = n;
  store->count[ALL] = n + n_wall;
  store->count[WALL] = n + n_wall;
  for (int k = 0; k < NUM_FIELDS; k++)
    if (needs & (1u << k) && !(public_rows[k].where == WALL && n_wall == 0))
      TRY(add_field(store, &public_rows[k], 1));
  for (int k = 0; k < solver->num_fields; k++) {
    if (solver->fields[k].where == WALL && n_wall == 0) continue;
    if (solver->uses && !solver->uses(state, solver->fields[k].name)) continue;
    TRY(add_field(store, &solver->fields[k], 0));
  }
  return OK;
}

/* The spare block of `bytes`: the one that the last permuted field of this size left behind. */
static int find_spare(struct store *store, size_t bytes)
{
  int empty = -1;
  for (int k = 0; k < MAX_SPARES; k++) {
    if (store->spare[k].data && store->spare[k].capacity == bytes) return k;
    if (!store->spare[k].data && empty < 0) empty = k;
  }
  if (empty < 0) return -1;
  store->spare[empty].data = memory_take(bytes);
  store->spare[empty].capacity = bytes;
  return store->spare[empty].data ? empty : -1;
}

static void drop_spare(struct store *store, size_t bytes)
{
  for (int k = 0; k < MAX_SPARES; k++)
    if (store->spare[k].data && store->spare[k].capacity == bytes) {
      memory_give(store->spare[k].data, bytes);
      store->spare[k].data = NULL;
      store->spare[k].capacity = 0;
    }
}

status store_resize_virtual(struct store *store, int n)
{
  store->count[VIRTUAL] = n;
  for (int k = 0; k < store->num_fields; k++) {
    struct store_field *f = &store->field[k];
    const size_t wanted = bytes_of(store, &f->row);
    if (f->row.where != VIRTUAL || wanted <= f->capacity) continue;
    const size_t room = wanted + wanted / 4;
    void *grown = memory_take(room);
    if (!grown)
      return status_set(ERR_MEMORY, "no memory for field '%s' (%zu bytes)", f->row.name, room);
    if (f->row.life == KEPT) memory_copy(grown, f->data, f->capacity);
    memory_give(f->data, f->capacity);
    drop_spare(store, f->capacity);
    f->data = grown;
    f->capacity = room;
    publish(store, f);
  }
  return OK;
}

/* The field in a block for `n` fluid particles more, with room for growth. */
static status insert_into(struct store *store, struct store_field *f, int n)
{
  const size_t size = f->row.bytes, old = size * (size_t)store->count[f->row.where];
  const size_t before = size * (size_t)store->count[FLUID], more = size * (size_t)n;
  const size_t wanted = old + more + size, capacity = f->capacity;
  const size_t room = wanted <= capacity ? capacity : wanted + wanted / 4;
  char *to = memory_take(room), *from = f->data;
  void *nothing = calloc(1, more);
  if (to && nothing) {
    memory_copy(to, from, before);
    memory_from_host(to + before, nothing, more);
    if (old > before) memory_copy(to + before + more, from + before, old - before);
    memory_give(from, capacity);
    drop_spare(store, capacity);
    f->data = to;
    f->capacity = room;
    publish(store, f);
  }
  const int done = to && nothing;
  if (!done) memory_give(to, room);
  free(nothing);
  return done ? OK : status_set(ERR_MEMORY, "no memory for field '%s'", f->row.name);
}

status store_insert_fluid(struct store *store, int n)
{
  for (int k = 0; k < store->num_fields; k++)
    if (store->field[k].row.where != VIRTUAL) TRY(insert_into(store, &store->field[k], n));
  store->count[FLUID] += n;
  store->count[ALL] += n;
  store->count[WALL] += n;
  return OK;
}

static status permute_field(struct store *store, struct store_field *f, const int *order, int begin,
                            int n)
{
  const size_t size = f->row.bytes, before = size * (size_t)begin, sorted = size * (size_t)n;
  const size_t total = size * (size_t)store->count[f->row.where];
  const int which = find_spare(store, f->capacity);
  if (which < 0) return status_set(ERR_MEMORY, "no memory to sort field '%s'", f->row.name);
  char *to = store->spare[which].data, *from = f->data;
  particle_search.permute(to + before, from + before, order, n, size);
  if (before) memory_copy(to, from, before);
  if (total > before + sorted)
    memory_copy(to + before + sorted, from + before + sorted, total - before - sorted);
  f->data = to;
  store->spare[which].data = from;
  publish(store, f);
  return OK;
}

status store_permute(struct store *store, unsigned where_mask, const int *order, int begin, int n)
{
  if (n == 0) return OK;
  for (int k = 0; k < store->num_fields; k++) {
    struct store_field *f = &store->field[k];
    if (!(where_mask & (1u << f->row.where)) || f->row.life != KEPT) continue;
    TRY(permute_field(store, f, order, begin, n));
  }
  return OK;
}

void store_poison(struct store *store)
{
  for (int k = 0; k < store->num_fields; k++) {
    struct store_field *f = &store->field[k];
    if (f->row.life != STEP) continue;
    size_t size = f->row.bytes * (size_t)store->count[f->row.where];
    if (f->row.where == ALL) size = f->row.bytes * (size_t)store->count[FLUID];
    memory_poison(f->data, size);
  }
}

struct store_field *store_find(struct store *store, const char *name)
{
  for (int k = 0; k < store->num_fields; k++)
    if (strcmp(store->field[k].row.name, name) == 0) return &store->field[k];
  return NULL;
}

struct store_field *store_public(struct store *store, const char *name)
{
  for (int k = 0; k < store->num_fields; k++)
    if (store->field[k].is_public && strcmp(store->field[k].row.name, name) == 0)
      return &store->field[k];
  return NULL;
}

size_t store_bytes(const struct store *store)
{
  size_t total = 0;
  for (int k = 0; k < MAX_SPARES; k++) total += store->spare[k].capacity;
  for (int k = 0; k < store->num_fields; k++) total += store->field[k].capacity;
  return total;
}

void store_close(struct store *store)
{
  for (int k = 0; k < store->num_fields; k++)
    memory_give(store->field[k].data, store->field[k].capacity);
  for (int k = 0; k < MAX_SPARES; k++) memory_give(store->spare[k].data, store->spare[k].capacity);
  memset(store, 0, sizeof *store);
}
