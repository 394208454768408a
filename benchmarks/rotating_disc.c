/* A disc of fluid in rigid rotation, without gravity: p = rho omega^2 (r^2 - R^2)/2, and nothing
 * moves in the rotating frame.
 *
 * The pressure rises towards the surface, so that the surface is unstable (Rayleigh-Taylor): a wave
 * of m crests grows as exp(sqrt(m - 1) omega t). The shorter, the faster: a method keeps the disc
 * only as long as its noise is small. With crests = m >= 2 the disc starts with such a wave, at
 * rest in the rotating frame, and its growth is compared with linear theory (truth_drops.h)
 * instead of the rigid rotation. m = 4, 8, ... are disturbed by the lattice of the start. */
#include "drop.h"

#define PARAMS(P)                                                          \
  P(radius, 1, 1e-6, 1e6, "m", "radius")                                   \
  P(omega, 1, 1e-6, 1e6, "rad/s", "angular velocity, clockwise")           \
  P(crests, 0, 0, 16, WHOLE, "crests of the wave on the outline; 0: none") \
  P(wave_height, 0.02, 1e-6, 0.2, "1", "height of the wave at the start, in radii")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct drop drop;
  struct squares wave;
  double time; /* of the last sample [s] */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.04;
  common->dt = 4e-3;
  common->t_end = 2;
  common->gravity = 0;
}

/* (x + i y)^n */
struct power {
  double re, im;
};
static struct power power(double x, double y, int n)
{
  struct power z = {1, 0};
  for (int k = 0; k < n; k++) z = (struct power){z.re * x - z.im * y, z.re * y + z.im * x};
  return z;
}

/* Displace by e R grad Re((z/R)^m)/m, which changes no density to first order and lifts the outline
 * by e R cos(m theta). */
static void raise_wave(struct scene *scene, const state *s)
{
  const int m = (int)s->crests;
  const double R = (double)s->radius, height = (double)s->wave_height * R;
  for (int i = 0; i < scene->n; i++) {
    const struct power z =
      power(component(scene->x, i, 0) / R, component(scene->x, i, 1) / R, m - 1);
    scene->x[i].c[0] += (real)(height * z.re);
    scene->x[i].c[1] -= (real)(height * z.im);
  }
}

/* The m-th moment of the fluid is pi R^(m + 2) times the height of the wave over R. */
static double wave_height(const state *s, const struct snapshot *now)
{
  const int m = (int)s->crests;
  const double R = (double)s->radius, cell = now->dx * now->dx;
  struct power sum = {0, 0};
  for (int i = 0; i < now->n; i++) {
    const struct power z = power(component(now->x, i, 0) / R, component(now->x, i, 1) / R, m);
    sum.re += z.re;
    sum.im += z.im;
  }
  return sqrt(sum.re * sum.re + sum.im * sum.im) * cell / (3.14159265358979323846 * R);
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double R = (double)s->radius, omega = (double)s->omega;
  const struct ellipsoid disc = {{R, R}};
  const double gradient[DIM][DIM] = {{0, omega}, {-omega, 0}};
  s->drop = (struct drop){{0, 0}, 0, 0};
  s->wave = (struct squares){0, 0};
  s->time = 0;
  if (s->crests != floor(s->crests) || s->crests == 1)
    return user_error("crests: %g found, allowed are 0 and whole numbers from 2",
                      (double)s->crests);
  TRY(drop_fill(scene, &disc));
  if (s->crests > 0) raise_wave(scene, s);
  drop_set_velocities(scene, gradient);
  scene_domain_around(scene, R * (0.5 + omega * scene->common.t_end));
  return OK;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  struct truth_affine motion;
  const double omega = (double)s->omega, interval = now->time - s->time;
  s->time = now->time;
  if (s->crests > 0) {
    const double height = wave_height(s, now), start = (double)(s->wave_height * s->radius);
    const double truth = start * truth_spinning_disc_wave((int)s->crests, omega, now->time);
    MEASURE(out, mode_amplitude, height);
    MEASURE(out, mode_error, squares_over_time(&s->wave, height, truth, interval));
    return;
  }
  truth_spinning_disc_at((double)s->radius, omega, now->time, &motion);
  drop_measure(&s->drop, now, &motion, 0, out);
}

#define METRICS(M, word) \
  DROP_METRICS(M, word) | M(word, spin_error) | M(word, mode_amplitude) | M(word, mode_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_rotating_disc = {
  .name = "rotating-disc",
  .about = "disc of fluid in rigid rotation, or a wave on it that grows (crests=2): tension, and "
           "an unstable surface",
  .source =
    "rigid rotation: Batchelor 1967, An Introduction to Fluid Dynamics, sec. 4.1; growth of "
    "waves derived in analysis/truth_drops.h",
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
