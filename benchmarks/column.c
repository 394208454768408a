/* A column of water sinks under its own weight: how incompressible is a method with its tolerance,
 * iterations and step?
 *
 * A fluid with p = K (rho/rho0 - 1) under dp/dy = -rho g stands with rho = rho0 exp(rho0 g (h -
 * y)/K) below its surface h = K/(rho0 g) log(1 + s), s = rho0 g H/K, and its centre of mass has
 * sunk from H/2 to H (s - log(1 + s))/s^2; with `modulus` the sinking is compared with that K. A
 * settling lattice rearranges and sinks by about half a spacing however stiff the method is, so
 * that the K that the method has in effect is found from density against weight, inside the column.
 * The load comes slowly: gravity is taken up over the time `ramp`, and velocities are damped until
 * all rests. */
#include "box.h"
#include "errors.h"

#define PARAMS(P)                                                                   \
  P(height, 0.4, 1e-6, 1e6, "m", "height H of the column")                          \
  P(width, 0.2, 1e-6, 1e6, "m", "width of the tank; in 3-D also its depth")         \
  P(modulus, 0, 0, 1e15, "Pa", "bulk modulus K to compare with; 0: incompressible") \
  P(ramp, 0.3, 0, 1e6, "s", "time over which gravity is taken up")                  \
  P(damping, 20, 0, 1e6, "1/s", "velocities decay at this rate")

typedef struct {
  PARAMS(PARAM_MEMBER)
  struct box box; /* as filled */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = DIM == 2 ? 0.01 : 0.025;
  common->t_end = 1;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  const double width = (double)s->width, height = (double)s->height;
  const struct box box = {width, width, height + 4 * scene->common.spacing, width, height};
  s->box = box;
  if (!(scene->common.gravity > 0)) return user_error("gravity: 0 found, the load needs some");
  return box_fill(scene, &s->box);
}

/* Carry the part of the weight that is not yet taken up, and damp. */
static void drive(struct scene *scene, const void *self, struct particles p, double time)
{
  const state *s = (const state *)self;
  const double dt = scene->common.dt, ramp = (double)s->ramp;
  const real carried = (real)(time < ramp ? dt * (1 - time / ramp) : 0);
  const real kept = (real)exp(-(double)s->damping * dt);
  for (int i = 0; i < p.n; i++) p.v[i] = times(kept, madd(p.v[i], -carried, scene->gravity));
}

/* How far the centre of mass of a column with the load s sinks: 1 - 2 (s - log(1 + s))/s^2. */
static double settlement(double s)
{
  return s < 1e-4 ? s * (2. / 3 - s / 2) : 1 - 2 * (s - log1p(s)) / (s * s);
}

/* sum_j W_ij of a full lattice. */
static double full_lattice(const struct kernel *kernel, double dx)
{
  const int reach = (int)ceil((double)kernel->R / dx), deep = DIM == 3 ? reach : 0;
  double sum = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++)
        sum += (double)kernel_W(kernel, (real)(dx * sqrt((double)(a * a + b * b + c * c))), DIM);
  return sum;
}

static double density(const struct pairs *nb, int i) /* sum_j W_ij */
{
  double sum = 0;
  for (int k = nb->first[i]; k < nb->last[i]; k++) {
    const vec r = sub(nb->xi[i], nb->xj[nb->list[k]]);
    sum += (double)kernel_W(&nb->kernel, sqrt(inner(r, r)), DIM);
  }
  return sum;
}

/* Did the particle lie at 0.2 .. 0.8 of the height and out of reach of the side walls, which are
 * not compressed? */
static int lay_inside(const struct snapshot *now, const struct box *box, int label)
{
  const double part = component(now->x_start, label, DIM - 1) / box->water_height;
  int inside = part > 0.2 && part < 0.8;
  for (int d = 0; d < DIM - 1; d++) {
    const double x = component(now->x_start, label, d), side = d == 0 ? box->length : box->depth;
    inside = inside && x > now->support && x < side - now->support;
  }
  return inside;
}

/* K of the line p = K (rho/rho0 - 1) through 0 that fits those particles, with p the weight above
 * each: by least squares. NaN if they are not compressed. */
static double bulk_modulus(const struct snapshot *now, const struct box *box, double g)
{
  const struct pairs *nb = now->pairs(now);
  double pressed = 0, all = 0;
  if (!nb) return (double)NAN;
  const double full = full_lattice(&nb->kernel, now->dx);
  for (int i = 0; i < now->n; i++) {
    const double above = box->water_height - component(now->x_start, now->id[i], DIM - 1);
    const double p = now->rho0 * g * above;
    if (!lay_inside(now, box, now->id[i])) continue;
    pressed += p * (density(nb, i) / full - 1);
    all += p * p;
  }
  return pressed > 0 ? all / pressed : (double)NAN;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  const state *s = (const state *)self;
  const double g = -(double)now->gravity.c[DIM - 1], H = s->box.water_height;
  const double weight = now->rho0 * g * H, K = (double)s->modulus;
  double height = 0, start = 0, v2 = 0;
  for (int i = 0; i < now->n; i++) {
    height += component(now->x, i, DIM - 1);
    start += component(now->x_start, i, DIM - 1);
    v2 += (double)inner(now->v[i], now->v[i]);
  }
  const double sunk = 1 - height / start;
  MEASURE(out, residual_speed, sqrt(v2 / now->n / (g * H)));
  MEASURE(out, settlement, sunk);
  MEASURE(out, settlement_error, fabs(sunk - (K > 0 ? settlement(weight / K) : 0)));
  MEASURE(out, bulk_modulus, bulk_modulus(now, &s->box, g));
}

#define METRICS(M, word) \
  M(word, residual_speed) | M(word, settlement) | M(word, settlement_error) | M(word, bulk_modulus)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_column = {
  .name = "column",
  .about = "a slowly loaded column sinks as far as the method is compressible",
  .source =
    "Batchelor 1967, An Introduction to Fluid Dynamics, sec. 1.4, with p = K (rho/rho0 - 1)",
  .asks = CAN(FREE_SURFACE),
  .dims = CAN(2D) | CAN(3D),
  .measures = MEASURES_OF(METRICS),
  .params = params,
  .num_params = COUNT(params),
  .state_size = sizeof(state),
  .defaults = defaults,
  .build = build,
  .drive = drive,
  .measure = measure,
  .projection = 0,
};
