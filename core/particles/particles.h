/* particles.h - the particle store as solvers see it: a view, copied by value into kernels.
 * Indices 0 .. n-1 are fluid particles, n .. n_all-1 wall particles; a scene without walls has
 * n_all = n. Every array has a spare element at its end. A field that nobody asked for is NULL. */
#ifndef PARTICLES_H
#define PARTICLES_H
#include "../sph/sph.h"

struct particles {
  int n, n_all;
#define FIELD(type, name, where, life, unit, meaning) type *name;
#include "fields.def"
#undef FIELD
};

enum field_number {
#define FIELD(type, name, where, life, unit, meaning) FIELD_##name,
#include "fields.def"
#undef FIELD
  NUM_FIELDS
};
#define HAS(name) (1u << FIELD_##name)

/* Where a field lives and how long (see fields.def); VIRTUAL: a solver's own second set of
 * particles, sized by the solver. */
enum field_where { FLUID, ALL, WALL, VIRTUAL, NUM_WHERE };
enum field_life { KEPT, STEP };

/* One row of a table of fields, public or a solver's private ones. */
struct field {
  const char *name, *unit, *meaning;
  int where, life;
  int components; /* reals per particle; 0: one int */
  size_t bytes, offset;
};
#endif
