/* Start of the flow between two plates, the upper of which moves along itself.
 *
 * Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214: plates 1 mm apart, nu = 1e-6 m^2/s, plate at
 * 1.25e-5 m/s. Every number is a case of the viscosity and the walls; there is no pressure. */
#include "channel.h"

#define PARAMS(P)                                        \
  P(gap, 1e-3, 1e-9, 1e6, "m", "distance of the plates") \
  P(plate_speed, 1.25e-5, -1e6, 1e6, "m/s", "speed of the upper plate")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct channel channel;
} state;

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  s->channel = (struct channel){{0, 0, (double)s->plate_speed}, truth_couette, 0};
  return channel_fill(scene, &s->channel, (double)s->gap, (double)s->plate_speed);
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  channel_measure(&((state *)self)->channel, now, out);
}

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_couette = {
  .name = "couette",
  .about = "start of the viscous flow between plates, one of which moves",
  .source = "Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214",
  .asks = CHANNEL_ASKS,
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
