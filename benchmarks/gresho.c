/* Gresho's vortex: a steady vortex with a triangular profile of speed, in a square.
 *
 * Gresho & Chan 1990, Int. J. Numer. Meth. Fluids 11, 621: radius 0.4 m, largest speed 1 m/s at r =
 * 0.2 m, in a square of 1 m, inviscid. Nothing moves near the sides and the pressure is even there,
 * so that free, periodic and walled sides have the same answer. With free sides the vortex is in
 * tension; a periodic square is jammed without slack, as in taylor-green; a closed box leaves the
 * pressure open by a constant, which a method must be able to stand. */
#include "../analysis/truth_flows.h"
#include "errors.h"

enum { FREE, PERIODIC, WALLS };

#define PARAMS(P)                                                      \
  P(side, 1, 1e-6, 1e6, "m", "side of the square, to whole particles") \
  P(vortex_radius, 0.4, 1e-6, 1e6, "m", "radius of the vortex")        \
  P(peak_speed, 1, 1e-9, 1e6, "m/s", "largest speed, at half of that") \
  P(edge, FREE, 0, 2, "free|periodic|walls", "what is at the sides")   \
  P(slack, 0, 0, 0.2, "1", "the lattice and the square are so much wider than dx says")

typedef struct {
  PARAMS(PARAM_MEMBER)
  double rho0; /* [kg/m^3] */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.02;
  common->dt = 2e-3;
  common->t_end = 1;
  common->gravity = 0;
}

/* Speed over r [1/s]. */
static double turning(const state *s, double r)
{
  const double U = (double)s->peak_speed, half = (double)s->vortex_radius / 2;
  return r < half ? U / half : r < 2 * half ? U * (2 / r - 1 / half) : 0;
}

static status set_sides(struct scene *scene, const state *s, double half)
{
  const vec low = scene_at(-half, -half, -half), high = scene_at(half, half, half);
  if (s->edge == (real)PERIODIC) {
    scene->low = low;
    scene->high = high;
    scene->period = sub(high, low);
    return OK;
  }
  if (s->edge == (real)WALLS) TRY(scene_wall_box(scene, low, high, scene_wall_layers(scene), 0));
  scene_domain_around(scene, half);
  return OK;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double dx = scene->common.spacing, half = round((double)s->side / dx) * dx / 2;
  const double room = 1 + (double)s->slack;
  if ((double)s->vortex_radius > half)
    return user_error("vortex_radius is %g m, allowed is at most half of the side, %g m",
                      (double)s->vortex_radius, half);
  s->rho0 = scene->common.rho0;
  TRY(
    scene_fill_box(scene, scene_at(-half, -half, -half), scene_at(half, half, half), zero(), NULL));
  for (int i = 0; i < scene->n; i++) scene->x[i] = times((real)room, scene->x[i]);
  scene_apply_jitter(scene);
  for (int i = 0; i < scene->n; i++) {
    const double x = component(scene->x, i, 0), y = component(scene->x, i, 1);
    const double turn = turning(s, sqrt(x * x + y * y));
    scene->v[i].c[0] = (real)(-turn * y);
    scene->v[i].c[1] = (real)(turn * x);
  }
  return set_sides(scene, s, room * half);
}

static struct truth_flow flow_at(const state *s, const double *x)
{
  return truth_gresho((double)s->peak_speed, (double)s->vortex_radius, x[0], x[1]);
}
static void velocity_at(const void *truth, const double *x, double *v)
{
  const struct truth_flow flow = flow_at((const state *)truth, x);
  v[0] = flow.u;
  v[1] = flow.v;
}
static double pressure_at(const void *truth, const double *x)
{
  const state *s = (const state *)truth;
  return s->rho0 * flow_at(s, x).p;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  const state *s = (const state *)self;
  if (now->step < 1) return;
  measure_velocity(now, velocity_at, s, out);
  measure_pressure(now, pressure_at, s, 1, out);
  MEASURE(out, energy_error, kinetic_error(now, 1));
  MEASURE(out, spin_error,
          fabs(spin(now, now->x, now->v) / spin(now, now->x_start, now->v_start) - 1));
}

#define METRICS(M, word) \
  VELOCITY_ERRORS(M, word) | PRESSURE_ERRORS(M, word) | M(word, energy_error) | M(word, spin_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_gresho = {
  .name = "gresho",
  .about = "steady vortex with a triangular profile in a square: nothing should change",
  .source = "Gresho & Chan 1990, Int. J. Numer. Meth. Fluids 11, 621",
  .asks = 0,
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
