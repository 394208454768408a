/* The largest stable time step of each solver, and the map. */
#include <math.h>

#include "stability.h"

/* A step is stable where every seed is; the search doubles or halves it until it has a stable and a
 * failing one, and then halves what is between them in log dt. */
static const double close_enough = 1.05;
enum { LEAST_STEPS = 4, MOST_HALVINGS = 6 };

static double largest_dt(const struct candidate_solver *c) { return c->t_end / LEAST_STEPS; }

static int is_failure(enum verdict v) { return v != VERDICT_STABLE; }

static void settle_at(struct candidate_solver *c, double next)
{
  c->at = next;
  c->seeds = 0;
}

/* Where to look next; settled where there is nothing more to learn. */
static void advance(struct candidate_solver *c)
{
  const double cap = largest_dt(c), floor = c->dt / (1 << MOST_HALVINGS);
  if (c->stable > 0 && c->failed < HUGE_VAL) {
    c->settled = c->failed / c->stable <= close_enough;
    settle_at(c, sqrt(c->failed * c->stable));
  } else if (c->stable > 0) {
    c->settled = c->stable >= cap;
    settle_at(c, fmin(2 * c->stable, cap));
  } else {
    c->settled = c->failed / 2 < floor;
    settle_at(c, c->failed / 2);
  }
}

static void take_failure(struct candidate_solver *c, const struct trial *t)
{
  if (t->dt < c->failed) {
    c->failed = t->dt;
    c->reason = t->first;
    c->run = t->run;
  }
  advance(c);
  /* a smaller step takes longer still */
  if (t->verdict == VERDICT_TIMEOUT && !(c->stable > 0)) c->settled = 1;
  if (t->verdict == VERDICT_UNABLE) c->settled = 1;
}

static void take_stable(struct candidate_solver *c, const struct stability *s)
{
  c->stable = c->at;
  c->speed_max = 0;
  c->leaks = 0;
  for (int k = 0; k < s->n; k++) {
    const struct trial *t = &s->trial[k];
    if (&s->solver[t->method] != c || t->row >= 0 || t->dt != c->at) continue;
    c->speed_max = fmax(c->speed_max, t->speed_max);
    c->leaks = t->leaks > c->leaks ? t->leaks : c->leaks;
  }
  advance(c);
}

/* One seed first, which mostly tells; then all others. */
static status add_round(struct stability *s, int first_solver, int last_solver)
{
  for (int k = first_solver; k < last_solver; k++) {
    struct candidate_solver *c = &s->solver[k];
    if (c->refusal || c->settled) continue;
    const long last = c->seeds == 0 && s->num_solvers > 1 ? 1 : s->num_seeds;
    for (long seed = c->seeds + 1; seed <= last; seed++) TRY(trial_add(s, k, c->at, seed, -1));
  }
  return OK;
}

static void read_round(struct stability *s, int first)
{
  for (int m = 0; m < s->num_solvers; m++) {
    struct candidate_solver *c = &s->solver[m];
    const struct trial *failure = NULL;
    int some = 0;
    for (int k = first; k < s->n; k++) {
      struct trial *t = &s->trial[k];
      if (t->method != m) continue;
      trial_read(s, t);
      some = 1;
      if (is_failure(t->verdict))
        failure = failure ? failure : t;
      else
        c->seeds++;
    }
    if (failure)
      take_failure(c, failure);
    else if (some && c->seeds >= s->num_seeds)
      take_stable(c, s);
  }
}

status limits_find(struct stability *s)
{
  for (int k = 0; k < s->num_solvers; k++) settle_at(&s->solver[k], s->solver[k].dt);
  for (;;) {
    const int first = s->n;
    TRY(add_round(s, 0, s->num_solvers));
    if (s->n == first) break;
    TRY(queue_work(&s->queue));
    read_round(s, first);
  }
  for (int k = 0; k < s->num_solvers; k++) {
    struct candidate_solver *c = &s->solver[k];
    c->predicted = predict(c, c->spacing, c->support, c->viscosity, c->speed_max);
  }
  return OK;
}

/* --- the map --- */

/* Time steps around the scene's own, unless they were given. */
static void choose_dts(struct stability *s)
{
  const double ratio = s->quick ? 2 : sqrt(2), lowest = 0.5, highest = 33;
  const struct candidate_solver *c = &s->solver[0];
  for (int k = 0; k < s->num_solvers && c->refusal; k++) c = &s->solver[k];
  if (s->map.dts.n > 0) return;
  for (double f = lowest; f < highest && s->map.dts.n < MOST_VALUES; f *= ratio)
    if (f * c->dt <= largest_dt(c)) s->map.dts.value[s->map.dts.n++] = f * c->dt;
}

status map_run(struct stability *s)
{
  const int first = s->n;
  if (!s->map.key) return OK;
  choose_dts(s);
  for (int m = 0; m < s->num_solvers; m++)
    for (int row = 0; row < s->map.rows && !s->solver[m].refusal; row++)
      for (int k = 0; k < s->map.dts.n; k++) TRY(trial_add(s, m, s->map.dts.value[k], 1, row));
  TRY(queue_work(&s->queue));
  for (int k = first; k < s->n; k++) trial_read(s, &s->trial[k]);
  return OK;
}
