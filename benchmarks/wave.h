/* wave.h - what standing-wave and sloshing share: one linear mode of the water in a tank, eta =
 * a(t) cos(k x). */
#ifndef WAVE_H
#define WAVE_H
#include "../analysis/truth_flows.h"
#include "box.h"
#include "errors.h"

struct wave {
  double length, depth, k; /* of the tank and the water as filled [m], wavenumber [1/m] */
  double amplitude;        /* largest height of the surface [m] */
  double omega, damping;   /* truth: angular frequency and decay of a [1/s] */
  double time;             /* of the last sample [s] */
  struct squares error;
  struct crossings swings;
};

/* sqrt(g k tanh k H) without the library, for the start. */
static inline double wave_start_frequency(const struct wave *w, double g)
{
  return sqrt(g * w->k * tanh(w->k * w->depth));
}

/* Fill a tank with water at rest; half_waves of the mode fit into it. Viscous damping: 2 nu k^2 in
 * a(t), Lighthill 1978, Waves in Fluids, sec. 3.5; no boundary layers. */
static inline status wave_fill(struct scene *scene, struct wave *w, double length, double depth,
                               int half_waves)
{
  const struct scene_params *c = &scene->common;
  struct box box = {length, length, 1.5 * depth, length, depth};
  TRY(box_fill(scene, &box));
  scene_apply_jitter(scene);
  w->length = box.length;
  w->depth = box.water_height;
  w->k = half_waves * 3.14159265358979323846 / w->length;
  w->omega = truth_wave_frequency(w->depth, c->gravity, w->k);
  w->damping = 2 * c->viscosity / c->rho0 * w->k * w->k;
  w->time = 0;
  w->error = (struct squares){0, 0};
  w->swings = (struct crossings){0, 0, 0, 0, 0, 0};
  return OK;
}

/* a = 2/L int int cos(k x) dy dx over the fluid: exact for any amplitude. */
static inline double wave_amplitude(const struct wave *w, const struct snapshot *now)
{
  double sum = 0;
  for (int i = 0; i < now->n; i++) sum += cos(w->k * component(now->x, i, 0));
  return 2 / w->length * sum * now->dx * now->dx;
}

/* `truth` is the exact a(t) of an inviscid wave; `from_rest`: it starts at its largest height. */
static inline void wave_measure(struct wave *w, const struct snapshot *now, double truth,
                                int from_rest, struct measures *out)
{
  const double interval = now->time - w->time, a = wave_amplitude(w, now);
  const double decayed = truth * exp(-w->damping * now->time);
  w->time = now->time;
  MEASURE(out, mode_amplitude, a);
  MEASURE(out, mode_error, squares_over_time(&w->error, a, decayed, interval));
  const double signal = now->step < 1 && !from_rest ? 0 : a;
  const double period = crossings_period(&w->swings, now->time, signal);
  MEASURE(out, period_error, fabs(period * w->omega / 6.283185307179586 - 1));
}

#define WAVE_METRICS(M, word) M(word, mode_amplitude) | M(word, mode_error) | M(word, period_error)
#endif
