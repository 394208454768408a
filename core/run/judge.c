#include "judge.h"

#include <math.h>

#include "run.h"

const struct criterion criteria[NUM_CRITERIA] = {
#define CRITERION(name, word, unit, limit, blow_up, meaning) {word, unit, limit, blow_up, meaning},
#include "criteria.def"
#undef CRITERION
};

static void note(struct run *run, enum criterion_number number, double value, double limit)
{
  struct judge *j = &run->judge;
  if (j->found >> number & 1u) return;
  j->found |= 1u << number;
  j->first[j->n++] =
    (struct judged){criteria[number].word, criteria[number].unit, run->time, value, limit};
}

/* value > limit; also where the value is no number. */
static void judge(struct run *run, enum criterion_number number, double value, double limit)
{
  if (!(value <= limit)) note(run, number, value, limit);
}

/* --- every step --- */

static void count_capped(struct run *run)
{
  struct judge *j = &run->judge;
  const double most = criteria[CRITERION_ITERATIONS].limit;
  long capped = 0;
  for (int k = 0; k < run->num_iterations; k++) capped += run->iterations[k].capped;
  j->capped_steps += capped > j->capped_solves;
  j->capped_solves = capped;
  if (j->planned == 0) return;
  const double steps = (double)(j->planned > run->step ? j->planned : run->step);
  judge(run, CRITERION_ITERATIONS, (double)j->capped_steps / steps, most);
}

void judge_step(struct run *run)
{
  double total, fastest;
  physics_health(run->view, &total, &fastest);
  run->not_finite = !isfinite(total);
  if (fastest > run->judge.fastest) run->judge.fastest = fastest;
  if (run->not_finite) note(run, CRITERION_NOT_FINITE, 1, 0);
  if (run->diverged) note(run, CRITERION_GAVE_UP, 1, 0);
  const double limit = run->speed_limit;
  if (limit > 0 && !run->not_finite) judge(run, CRITERION_SPEED, fastest, limit);
  count_capped(run);
  if (run->diverged) return; /* the solver has said why */
  if (run->not_finite)
    run_diverged(run, "a position or velocity is not finite");
  else if (run->judge.found >> CRITERION_SPEED & 1u)
    run_diverged(run, "a particle moves at %.3g m/s, %d times what the energy allows", fastest,
                 SPEED_MARGIN);
}

/* --- samples --- */

/* Energy that the fluid would win by falling to where the lowest particle, of walls too, is; at
 * least by one spacing, so that a few particles have a scale, too. */
static double stored_energy(const struct snapshot *now)
{
  const double step = now->dx * sqrt((double)inner(now->gravity, now->gravity));
  double lowest = HUGE_VAL, sum = 0, least = 0;
  for (int i = 0; i < now->n_all; i++)
    lowest = fmin(lowest, -(double)inner(now->gravity, now->x[i]));
  for (int i = 0; i < now->n; i++) {
    const double m = now->light ? now->mass / (double)now->light[i] : now->mass;
    sum += m * (-(double)inner(now->gravity, now->x[i]) - lowest);
    least += m * step;
  }
  return fmax(sum, least);
}

static void take_start(struct judge *j, const struct snapshot *now, const struct measures *values)
{
  const double density = 1 + values->value[METRIC_density_error_max];
  j->has_start = 1;
  j->growth = (double)NAN;
  j->kinetic = values->value[METRIC_kinetic_energy];
  j->stored = stored_energy(now);
  j->density = fmax(criteria[CRITERION_DENSITY].limit, density);
}

/* Is all energy that of the fluid, and gravity all that works on it? */
static int is_closed(const struct run *run)
{
  return !run->judge.driven && run->scene.num_emitters == 0 && run->scene.num_bodies == 0;
}

static void judge_energy(struct run *run, const struct measures *values)
{
  struct judge *j = &run->judge;
  const double growth = values->value[METRIC_total_energy] - j->kinetic;
  const double won = fmax(0, -values->value[METRIC_potential_energy]);
  const double scale = j->kinetic + fmax(j->stored, won);
  if (!is_closed(run) || !(scale > 0) || isnan(growth)) return;
  if (!(growth / scale <= j->growth)) j->growth = growth / scale;
  judge(run, CRITERION_ENERGY, growth / scale, criteria[CRITERION_ENERGY].limit);
}

static int is_outside(const struct snapshot *now, vec x)
{
  for (int d = 0; d < DIM; d++) {
    if (now->period.c[d] > 0) continue;
    if ((double)x.c[d] < (double)now->low.c[d] - now->support) return 1;
    if ((double)x.c[d] > (double)now->high.c[d] + now->support) return 1;
  }
  return 0;
}

static void judge_places(struct run *run, const struct snapshot *now)
{
  int outside = 0;
  for (int i = 0; i < now->n; i++) outside += is_outside(now, now->x[i]);
  judge(run, CRITERION_OUTSIDE, (double)outside / now->n, criteria[CRITERION_OUTSIDE].limit);
  judge(run, CRITERION_LEAK, outside, criteria[CRITERION_LEAK].limit);
}

/* What could not be measured (NaN) is not judged here: positions are finite. */
static void judge_density(struct run *run, const struct measures *values)
{
  const double most = 1 + values->value[METRIC_density_error_max];
  if (!isnan(most)) judge(run, CRITERION_DENSITY, most, run->judge.density);
}

static void judge_volume(struct run *run, int n, const struct measures *values)
{
  enum { FEW = 16 }; /* particles that have a shape, but hardly a volume */
  const double change = fabs(values->value[METRIC_volume_change]);
  if (isnan(change) || n < FEW || run->scene.num_emitters > 0) return;
  judge(run, CRITERION_VOLUME, change, criteria[CRITERION_VOLUME].limit);
}

void judge_sample(struct run *run, const struct snapshot *now, const struct measures *values)
{
  if (now->n < 1) return;
  if (!run->judge.has_start) {
    take_start(&run->judge, now, values);
    return;
  }
  judge_places(run, now);
  judge_density(run, values);
  judge_energy(run, values);
  judge_volume(run, now->n, values);
}

/* --- the end --- */

void judge_end(struct run *run)
{
  if (run->step == 0) return;
  judge(run, CRITERION_ITERATIONS, (double)run->judge.capped_steps / (double)run->step,
        criteria[CRITERION_ITERATIONS].limit);
}
