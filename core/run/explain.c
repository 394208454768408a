/* `run --explain`: what the scene needed, and what was left out. */
#include <stdio.h>

#include "driver.h"

static void explain_fields(const struct run *run)
{
  const double n = run->view->p.n > 0 ? run->view->p.n : 1;
  printf("fields allocated (bytes per fluid particle):\n");
  for (int k = 0; k < run->store.num_fields; k++) {
    const struct store_field *f = &run->store.field[k];
    printf("  %-10s %7.1f  %s [%s]%s\n", f->row.name, (double)f->capacity / n, f->row.meaning,
           f->row.unit, f->row.life == KEPT ? ", sorted" : "");
  }
  printf("fields left out:");
  int left = 0;
#define FIELD(type, name, where, life, unit, meaning) \
  if (!run->view->p.name) left += printf(" " #name);
#include "../particles/fields.def"
#undef FIELD
  for (int k = 0; k < run->solver->num_fields; k++) {
    const struct field *row = &run->solver->fields[k];
    if (!*(void **)((char *)run->state + row->offset)) left += printf(" %s", row->name);
  }
  printf("%s\n", left ? "" : " none");
}

static void explain_memory(const struct run *run)
{
  const double n = run->view->p.n > 0 ? run->view->p.n : 1;
  const struct pair_list *nb = &run->neighbours;
  printf("bytes per particle: %.1f in all, %.1f of them fields and the room to sort them, %.1f the "
         "pair list",
         run_bytes_per_particle(run), (double)store_bytes(&run->store) / n,
         sizeof(int) * (2.0 * nb->row_capacity + nb->slot_capacity) / n);
  if (run->view->p.n > 0 && nb->pairs.slots > 0)
    printf(" (%.1f slots per particle)", (double)nb->pairs.slots / n);
  printf("\n");
}

static void explain_features(const struct run *run)
{
#define A(name, text) {CAN(name), #name},
  static const struct {
    unsigned bit;
    const char *name;
  } abilities[] = {ABILITY_LIST(A)};
#undef A
  const unsigned asked = scene_asks(&run->scene),
                 features = CAN(WALLS) | CAN(GRAVITY) | CAN(XSPH) | CAN(PERIODIC) | CAN(VISCOSITY) |
                            CAN(TENSION) | CAN(FLUIDS) | CAN(MOVING_WALLS) | CAN(BODIES) |
                            CAN(EMITTERS);
  printf("features absent:");
  int absent = 0;
  for (int k = 0; k < NUM_ABILITIES; k++)
    if (features & ~asked & abilities[k].bit) absent += printf(" %s", abilities[k].name);
  printf("%s\n", absent ? "" : " none");
}

void explain(const struct run *run)
{
  explain_fields(run);
  explain_memory(run);
  explain_features(run);
  printf("stages run (calls, us per call, ns per particle):\n");
  for (const struct stage_clock *s = stage_list(); s; s = s->next)
    if (s->calls > 0)
      printf("  %-16s %8ld %10.2f %8.2f\n", s->name, s->calls, 1e6 * s->seconds / (double)s->calls,
             s->items > 0 ? 1e9 * s->seconds / (double)s->items : 0);
}
