/* channel.h - what poiseuille and couette share: viscous fluid between two plates, periodic along
 * them. */
#ifndef CHANNEL_H
#define CHANNEL_H
#include "../analysis/truth_flows.h"
#include "errors.h"

struct channel {
  struct truth_channel truth;
  double (*velocity)(const struct truth_channel *, double y, double t);
  double time; /* of the sample [s] */
};

/* Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214: plates 1 mm apart, nu = 1e-6 m^2/s. */
static inline void channel_defaults(struct scene_params *common)
{
  common->spacing = 2.5e-5;
  common->dt = 2e-3;
  common->t_end = 0.3;
  common->gravity = 0;
  common->viscosity = 1e-3;
}

/* Layers of a plate that moves along itself, at y and further away along `outwards`. A plate is the
 * same everywhere, so that only its velocity is told and its particles stay. */
static inline status channel_plate(struct scene *scene, double length, double y, int outwards,
                                   double speed)
{
  const double dx = scene->common.spacing;
  const int layers = scene_wall_layers(scene), along = (int)lround(length / dx);
  TRY(scene_reserve(scene, 0, (double)layers * along));
  for (int k = 0; k < layers; k++)
    for (int i = 0; i < along; i++) {
      const int n = scene->n_wall++;
      scene->wall_x[n] = scene_at((i + 0.5) * dx, 0, y + outwards * (k + 0.5) * dx);
      scene->wall_v[n] = scene_at(speed, 0, 0);
      scene->wall_n[n] = scene_at(0, 0, -outwards);
    }
  return OK;
}

/* Fluid at rest and the two plates; the upper one moves. */
static inline status channel_fill(struct scene *scene, struct channel *c, double gap, double speed)
{
  const double dx = scene->common.spacing, length = ceil(4 * scene->common.support) * dx;
  const double whole = round(gap / dx) * dx;
  if (!(scene->common.viscosity > 0))
    return user_error("viscosity: 0 found, the flow between plates needs some");
  c->truth.gap = whole;
  c->truth.nu = scene->common.viscosity / scene->common.rho0;
  TRY(scene_fill_box(scene, zero(), scene_at(length, 0, whole), zero(), NULL));
  TRY(channel_plate(scene, length, 0, -1, 0));
  TRY(channel_plate(scene, length, whole, 1, speed));
  scene_apply_jitter(scene);
  scene_domain_around(scene, 2 * dx);
  scene->low.c[0] = 0;
  scene->high.c[0] = scene->period.c[0] = (real)length;
  return OK;
}

static inline void channel_velocity_at(const void *truth, const double *x, double *v)
{
  const struct channel *c = (const struct channel *)truth;
  const double y = x[DIM - 1], gap = c->truth.gap;
  for (int d = 0; d < DIM; d++) v[d] = 0;
  v[0] = c->velocity(&c->truth, y < 0 ? 0 : y > gap ? gap : y, c->time);
}

static inline void channel_measure(struct channel *c, const struct snapshot *now,
                                   struct measures *out)
{
  c->time = now->time;
  if (now->step < 1) return;
  measure_velocity(now, channel_velocity_at, c, out);
}

#define CHANNEL_METRICS(M, word) VELOCITY_ERRORS(M, word)
#define CHANNEL_ASKS (CAN(PERIODIC) | CAN(WALLS) | CAN(VISCOSITY))
#endif
