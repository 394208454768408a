/* One projection of a velocity whose divergence-free part is known: v* = v + grad q on a square or
 * cube about the origin, with q = U L/pi cos(pi x/L) cos(pi y/L) (cos(pi z/L)) and q = 0 on the
 * sides, as p is there. An exact projection leaves v and finds p = rho0 q/dt.
 *
 * Manufactured for this project (the Helmholtz-Hodge decomposition with p = 0 on the boundary:
 * Chorin 1968, Math. Comput. 22, 745). A lattice flatters a method: compare with jitter=0.1 to 0.3
 * and several seeds. */
#include "errors.h"

enum { ROTATION, VORTICES };

#define PARAMS(P)                                                              \
  P(side, 1, 1e-6, 1e6, "m", "side L, to whole particles")                     \
  P(peak_speed, 1, 1e-9, 1e6, "m/s", "U, scale of both parts of the velocity") \
  P(kept, ROTATION, 0, 1, "rotation|vortices", "the part v that a projection must keep")

typedef struct {
  PARAMS(PARAM_MEMBER)
  double length, impulse; /* the side as filled [m]; rho0/dt [kg/(m^3 s)] */
} state;

static const double pi = 3.14159265358979323846;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.02 : 0.05;
  common->gravity = 0;
  common->t_end = 0;
}

static void kept_velocity(const state *s, const double *x, double *v)
{
  const double U = (double)s->peak_speed, k = 2 * pi / s->length;
  for (int d = 0; d < DIM; d++) v[d] = 0;
  if (s->kept == (real)ROTATION) {
    v[0] = 2 * U / s->length * x[1];
    v[1] = -2 * U / s->length * x[0];
  } else {
    v[0] = -U * cos(k * x[0]) * sin(k * x[1]);
    v[1] = U * sin(k * x[0]) * cos(k * x[1]);
  }
}

/* q and its gradient. */
static double potential(const state *s, const double *x, double *gradient)
{
  const double U = (double)s->peak_speed, k = pi / s->length;
  double q = U / k;
  for (int d = 0; d < DIM; d++) q *= cos(k * x[d]);
  for (int d = 0; d < DIM; d++) {
    gradient[d] = -U * sin(k * x[d]);
    for (int e = 0; e < DIM; e++) gradient[d] *= e == d ? 1 : cos(k * x[e]);
  }
  return q;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double dx = scene->common.spacing;
  s->length = round((double)s->side / dx) * dx;
  s->impulse = scene->common.rho0 / scene->common.dt;
  const double half = s->length / 2;
  TRY(
    scene_fill_box(scene, scene_at(-half, -half, -half), scene_at(half, half, half), zero(), NULL));
  scene_apply_jitter(scene);
  for (int i = 0; i < scene->n; i++) {
    double x[DIM], v[DIM], gradient[DIM];
    for (int d = 0; d < DIM; d++) x[d] = component(scene->x, i, d);
    kept_velocity(s, x, v);
    potential(s, x, gradient);
    for (int d = 0; d < DIM; d++) scene->v[i].c[d] = (real)(v[d] + gradient[d]);
  }
  scene_domain_around(scene, s->length);
  return OK;
}

static double pressure_at(const void *truth, const double *x)
{
  const state *s = (const state *)truth;
  double unused[DIM];
  return s->impulse * potential(s, x, unused);
}

/* Sums over the particles of the change of velocity against - grad q, and of u-.u-, u+.u+, u+.u-.
 */
struct change {
  struct squares error;
  double before, after, mixed;
};

static struct change velocity_change(const state *s, const struct snapshot *now)
{
  struct change c = {{0, 0}, 0, 0, 0};
  for (int i = 0; i < now->n; i++) {
    double x[DIM], gradient[DIM];
    place(now, i, x);
    potential(s, x, gradient);
    for (int d = 0; d < DIM; d++) {
      const double old = component(now->v_start, now->id[i], d), v = component(now->v, i, d);
      squares_add(&c.error, v - old, -gradient[d], 1);
      c.before += old * old;
      c.after += v * v;
      c.mixed += old * v;
    }
  }
  return c;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  const state *s = (const state *)self;
  if (now->step < 1) return;
  const struct change c = velocity_change(s, now);
  measure_pressure(now, pressure_at, s, 0, out);
  MEASURE(out, velocity_error, squares_ratio(&c.error));
  MEASURE(out, orthogonality_defect, 2 * (c.mixed - c.after) / c.before);
}

#define METRICS(M, word) \
  PRESSURE_ERRORS(M, word) | M(word, velocity_error) | M(word, orthogonality_defect)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_manufactured_projection = {
  .name = "manufactured-projection",
  .about = "one projection of a field whose divergence-free part and pressure are known",
  .source = "manufactured; decomposition as in Chorin 1968, Math. Comput. 22, 745",
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
