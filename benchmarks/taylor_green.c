/* Taylor-Green vortices in a periodic square: they decay as exp(-8 pi^2 t/Re) L/U, or stay for good
 * in an inviscid fluid, so that what they lose is the method's own dissipation.
 *
 * Taylor & Green 1937, Proc. R. Soc. Lond. A 158, 499. Re = U L/nu is set by `reynolds`, or by the
 * viscosity that every scene has. A periodic square that is full to rho0 is jammed for methods that
 * keep rho <= rho0, since a lattice cannot shear without compressing somewhere (vortices then
 * bounce back as in an elastic solid): `slack` leaves some room. Compare with jitter=0.1 and
 * several seeds, too, which takes the lattice's stiffness away. */
#include "../analysis/truth_flows.h"
#include "errors.h"

#define PARAMS(P)                                                                     \
  P(side, 1, 1e-6, 1e6, "m", "side L of the periodic square, to whole particles")     \
  P(peak_speed, 1, 1e-9, 1e6, "m/s", "U, largest speed at the start")                 \
  P(reynolds, 0, 0, 1e9, "1", "U L/nu, sets the viscosity; 0: as the viscosity says") \
  P(slack, 0.01, 0, 0.2, "1", "the lattice and the square are so much wider than dx says")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct truth_vortices vortices;
  double rho0, time; /* [kg/m^3], of the sample [s] */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.02;
  common->dt = 2e-3;
  common->t_end = 1;
  common->gravity = 0;
}

static status set_viscosity(struct scene *scene, const state *s)
{
  const double U = (double)s->peak_speed, L = (double)s->side, Re = (double)s->reynolds;
  if (!(Re > 0)) return OK;
  if (scene->common.viscosity > 0)
    return user_error("reynolds is %g and viscosity %g Pa s, allowed is one of them", Re,
                      scene->common.viscosity);
  scene->common.viscosity = scene->common.rho0 * U * L / Re;
  return OK;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double dx = scene->common.spacing, U = (double)s->peak_speed;
  const double room = 1 + (double)s->slack;
  const double filled = round((double)s->side / dx) * dx, L = room * filled;
  const double k = 6.283185307179586 / L;
  TRY(set_viscosity(scene, s));
  s->vortices = (struct truth_vortices){U, L, scene->common.viscosity / scene->common.rho0};
  s->rho0 = scene->common.rho0;
  scene->high = scene->period = scene_at(L, L, L);
  TRY(scene_fill_box(scene, zero(), scene_at(filled, filled, filled), zero(), NULL));
  for (int i = 0; i < scene->n; i++) scene->x[i] = times((real)room, scene->x[i]);
  scene_apply_jitter(scene);
  for (int i = 0; i < scene->n; i++) {
    const double x = k * component(scene->x, i, 0), y = k * component(scene->x, i, 1);
    scene->v[i].c[0] = (real)(-U * cos(x) * sin(y));
    scene->v[i].c[1] = (real)(U * sin(x) * cos(y));
  }
  return OK;
}

static void velocity_at(const void *truth, const double *x, double *v)
{
  const state *s = (const state *)truth;
  const struct truth_flow flow = truth_taylor_green(&s->vortices, x[0], x[1], s->time);
  v[0] = flow.u;
  v[1] = flow.v;
}
static double pressure_at(const void *truth, const double *x)
{
  const state *s = (const state *)truth;
  return s->rho0 * truth_taylor_green(&s->vortices, x[0], x[1], s->time).p;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  const double k = 6.283185307179586 / s->vortices.L;
  s->time = now->time;
  if (now->step < 1) return;
  measure_velocity(now, velocity_at, s, out);
  measure_pressure(now, pressure_at, s, 1, out);
  MEASURE(out, energy_error, kinetic_error(now, exp(-4 * k * k * s->vortices.nu * now->time)));
}

#define METRICS(M, word) VELOCITY_ERRORS(M, word) | PRESSURE_ERRORS(M, word) | M(word, energy_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_taylor_green = {
  .name = "taylor-green",
  .about = "vortices in a periodic square that decay exactly (reynolds=100) or stay (inviscid)",
  .source = "Taylor & Green 1937, Proc. R. Soc. Lond. A 158, 499",
  .asks = CAN(PERIODIC),
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
