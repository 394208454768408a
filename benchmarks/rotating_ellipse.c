/* An elliptical patch in rotation, without gravity: in tension at all times like the rotating
 * square, but with a smooth outline and an exact answer, so that what tension does is seen apart
 * from what corners do.
 *
 * Dirichlet's affine motion: x = F X, with F'' = 2 P F^-T. Kinetic energy and angular momentum are
 * kept; the pressure at the centre is -0.4 rho omega^2 m^2 at the start, and negative for good. */
#include "drop.h"

#define PARAMS(P)                                                                   \
  P(semi_major, 1.4142135623730951, 1e-6, 1e6, "m", "semi-axis along x, sqrt 2")    \
  P(semi_minor, 0.70710678118654752, 1e-6, 1e6, "m", "semi-axis along y, 1/sqrt 2") \
  P(omega, 1, 1e-6, 1e6, "rad/s", "angular velocity, clockwise")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct drop drop;
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.04;
  common->dt = 4e-3;
  common->t_end = 2;
  common->gravity = 0;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double a = (double)s->semi_major, b = (double)s->semi_minor, omega = (double)s->omega;
  const struct ellipsoid ellipse = {{a, b}};
  const double gradient[DIM][DIM] = {{0, omega}, {-omega, 0}};
  const double longest = a > b ? a : b, turned = omega * scene->common.t_end;
  s->drop = (struct drop){{0, 0}, 0, 0};
  TRY(drop_fill(scene, &ellipse));
  drop_set_velocities(scene, gradient);
  /* nothing flies farther than a tip that no pressure holds */
  scene_domain_around(scene, longest * (0.5 + sqrt(1 + turned * turned)));
  return OK;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  struct truth_affine motion;
  truth_spinning_ellipse_at((double)s->semi_major, (double)s->semi_minor, (double)s->omega,
                            now->time, &motion);
  drop_measure(&s->drop, now, &motion, 0, out);
}

#define METRICS(M, word) DROP_METRICS(M, word) | M(word, spin_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_rotating_ellipse = {
  .name = "rotating-ellipse",
  .about = "elliptical patch of fluid in rotation: tension with an exact answer",
  .source = "Dirichlet 1860, Abh. Koenigl. Ges. Wiss. Goettingen 8, 3 (motion of fluid ellipsoids)",
  .asks = CAN(FREE_SURFACE),
  .dims = CAN(2D),
  .measures = MEASURES_OF(METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = NULL,
  .measure = measure,
  .projection = 0,
};
