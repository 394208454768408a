/* Two equal blocks of fluid meet face to face: one projection, whose loss of kinetic energy is
 * known exactly.
 *
 * Pressure-impulse theory, cf. Marrone et al. 2015, J. Fluids Struct. 54, 802. Blocks width wide
 * along the contact and height high normal to it, at +-speed; in 3-D depth deep along it (truth.h).
 * The loss is exactly 0.5 for height = width/2 in 2-D, whatever dt and speed are. */
#include "../analysis/truth.h"
#include "../core/benchmark.h"

#define PARAMS(P)                                                            \
  P(width, 1, 1e-6, 1e6, "m", "width of a block along the contact")          \
  P(height, 0.5, 1e-6, 1e6, "m", "height of a block, normal to the contact") \
  P(depth, 1, 1e-6, 1e6, "m", "depth of a block along the contact, in 3-D")  \
  P(speed, 1, 1e-6, 1e6, "m/s", "speed of a block")

typedef struct {
  PARAMS(PARAM_MEMBER)
  double loss; /* exact */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.02 : 0.05;
  common->gravity = 0;
  common->t_end = 0;
}

static double whole(real side, double dx) { return round((double)side / dx) * dx; }

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double dx = scene->common.spacing, speed = (double)s->speed;
  const double L = whole(s->width, dx), H = whole(s->height, dx), D = whole(s->depth, dx);
  TRY(scene_fill_box(scene, scene_at(-L / 2, -D / 2, 0), scene_at(L / 2, D / 2, H),
                     scene_at(0, 0, -speed), NULL));
  TRY(scene_fill_box(scene, scene_at(-L / 2, -D / 2, -H), scene_at(L / 2, D / 2, 0),
                     scene_at(0, 0, speed), NULL));
  s->loss = truth_impact_loss(L, H, DIM == 3 ? D : 0);
  scene_domain_around(scene, L);
  return OK;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  const state *s = (const state *)self;
  double before = 0, after = 0, mixed = 0; /* sums of u- . u-, u+ . u+, u+ . u- */
  if (now->step < 1) return;
  for (int i = 0; i < now->n; i++)
    for (int d = 0; d < DIM; d++) {
      const double u0 = (double)now->v_start[now->id[i]].c[d], u1 = (double)now->v[i].c[d];
      before += u0 * u0;
      after += u1 * u1;
      mixed += u0 * u1;
    }
  const double loss = 1 - after / before;
  MEASURE(out, energy_loss, loss);
  MEASURE(out, energy_loss_error, fabs(loss - s->loss));
  MEASURE(out, orthogonality_defect, 2 * (mixed - after) / before);
}

#define METRICS(M, word) \
  M(word, energy_loss) | M(word, energy_loss_error) | M(word, orthogonality_defect)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_normal_impact = {
  .name = "normal-impact",
  .about = "two blocks meet face to face: one projection, exact loss of energy",
  .source = "pressure-impulse theory, cf. Marrone et al. 2015, J. Fluids Struct. 54, 802",
  .asks = CAN(FREE_SURFACE) | CAN(PROJECT),
  .dims = CAN(2D) | CAN(3D),
  .measures = MEASURES_OF(METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 1,
};
