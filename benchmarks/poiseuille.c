/* Start of the flow between two plates at rest under a body force.
 *
 * Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214: plates 1 mm apart, nu = 1e-6 m^2/s, force 1e-4
 * m/s^2: 1.25e-5 m/s in the middle in the end. Every number is a case of the viscosity and the
 * walls; there is no pressure. */
#include "channel.h"

#define PARAMS(P)                                        \
  P(gap, 1e-3, 1e-9, 1e6, "m", "distance of the plates") \
  P(body_force, 1e-4, 1e-12, 1e6, "m/s^2", "body force along the plates")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct channel channel;
} state;

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  s->channel = (struct channel){{0, 0, (double)s->body_force}, truth_poiseuille, 0};
  scene->gravity.c[0] = s->body_force;
  return channel_fill(scene, &s->channel, (double)s->gap, 0);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  channel_measure(&((state *)self)->channel, now, out);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_poiseuille = {
  .name = "poiseuille",
  .about = "start of the viscous flow between plates under a body force",
  .source = "Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214",
  .asks = CHANNEL_ASKS | CAN(GRAVITY),
  .dims = CAN(2D),
  .measures = MEASURES_OF(CHANNEL_METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = channel_defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 0,
};
