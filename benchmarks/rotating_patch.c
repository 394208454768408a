/* Rotating square patch of fluid in tension.
 *
 * Colagrossi 2005, PhD thesis; Le Touze et al. 2013, Int. J. Numer. Meth. Fluids 73, 660; as in
 * Liu, He, Guo, Chang & Wang 2024, ACM Trans. Graph. 43(3), 28, Fig. 10: side 0.24 m, support
 * 0.0125 m, XSPH 0.03, dt 1 ms, 2 s. Its finer resolution is the default (dx 0.005, R = 2.5 dx, 48
 * x 48); its coarser one keeps the support:
 *   --spacing 0.0075 --set support=1.666667      (32 x 32)
 * Truth: computed evolution, at t omega up to 2.4 (t = 1.15 s); later samples keep the error so
 * far. It is inviscid: compare with --set xsph=0, or say what XSPH costs. */
#include <stdlib.h>

#include "../analysis/truth.h"
#include "../core/scene/places.h"
#include "errors.h"
#include "patch.h"

#define PARAMS(P)                                                         \
  P(side, 0.24, 1e-6, 1e6, "m", "side of the square, to whole particles") \
  P(omega, 2.0943951023931953, 1e-6, 1e6, "rad/s", "angular velocity, 2 pi/3")

typedef struct {
  PARAMS(PARAM_MEMBER)
  double length;                        /* the side as filled [m] */
  double time;                          /* of the last sample [s] */
  struct squares centre, mid_edge, tip; /* of all samples so far */
} state;

static void defaults(struct scene_params *common)
{
  common->spacing = 0.005;
  common->t_end = 2;
  common->gravity = 0;
  common->xsph = 0.03;
}

static status build(struct scene *scene, void *self)
{
  state *s = (state *)self;
  s->length = patch_side((double)s->side, scene->common.spacing);
  s->time = 0;
  s->centre = s->mid_edge = s->tip = (struct squares){0, 0};
  TRY(patch_fill(scene, (double)s->side, (double)s->omega, 0));
  /* nothing of the exact flow is farther from the centre than a corner that flies straight on */
  const double turns = (double)s->omega * scene->common.t_end;
  scene_domain_around(scene, s->length * (0.5 + sqrt(0.5 * (1 + turns * turns))));
  return OK;
}

/* Mean over the support around the centre, weighted by the cubic spline; 0, as outside the fluid,
 * where nothing is. */
static double pressure_at_centre(const struct snapshot *now)
{
  const struct kernel kernel = kernel_make(KERNEL_CUBIC, (real)now->support, 2);
  double sum = 0, weight = 0;
  for (int i = 0; i < now->n; i++) {
    const double w = (double)kernel_W(&kernel, sqrt(inner(now->x[i], now->x[i])), 2);
    sum += w * (double)now->p[i];
    weight += w;
  }
  return weight > 0 ? sum / weight : 0;
}

/* Distance along a ray from the centre to the first point that is farther than dx from every
 * particle, at most `most`. */
static double ray_to_void(const struct places *places, double angle, double dx, double most)
{
  double r = 0;
  while (r < most) {
    double nearest;
    const vec at = scene_at(r * cos(angle), r * sin(angle), r * sin(angle));
    places_nearest(places, at, 1.01 * dx, -1, &nearest);
    if (nearest > dx) break;
    r += dx - nearest > dx / 64 ? dx - nearest : dx / 64;
  }
  return r;
}

/* Smallest distance of the surface from the centre: rays all round, then finer rays near the
 * shortest. On a flat lattice the void begins (sqrt(3)/2) dx above the outermost row, between two
 * of its particles, and the surface dx/2 above it. */
static double mid_edge(const struct snapshot *now)
{
  const int coarse = 64, fine = 32;
  const double step = 6.283185307179586 / coarse;
  struct places places;
  double shortest = HUGE_VAL, towards = 0;
  if (places_make(&places, now->x, now->n, now->dx, now->period) != OK) return (double)NAN;
  for (int k = 0; k < coarse; k++) {
    const double r = ray_to_void(&places, k * step, now->dx, shortest);
    if (r < shortest) towards = k * step;
    shortest = r < shortest ? r : shortest;
  }
  for (int k = -fine; k <= fine; k++) {
    const double r = ray_to_void(&places, towards + step * k / fine, now->dx, shortest);
    shortest = r < shortest ? r : shortest;
  }
  places_free(&places);
  const double surface = shortest - (sqrt(0.75) - 0.5) * now->dx;
  return surface > 0 ? surface : 0;
}

static int descending(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;
  return (x < y) - (x > y);
}

/* The distance from the centre beyond which lies 0.1 % of the fluid. */
static double tip(const struct snapshot *now)
{
  double *r = (double *)malloc((size_t)now->n * sizeof *r);
  if (!r) return (double)NAN;
  for (int i = 0; i < now->n; i++) r[i] = (double)sqrt(inner(now->x[i], now->x[i]));
  qsort(r, (size_t)now->n, sizeof *r, descending);
  const double far = r[now->n / 1000];
  free(r);
  return far;
}

static void measure(void *self, const struct snapshot *now, struct measures *out)
{
  state *s = (state *)self;
  const double L = s->length, omega = (double)s->omega, turned = omega * now->time;
  const double interval = now->time - s->time, pressure = now->rho0 * omega * omega * L * L;
  s->time = now->time;
  if (now->p)
    MEASURE(out, centre_pressure_error,
            squares_over_time(&s->centre, pressure_at_centre(now),
                              pressure * truth_patch_centre(turned), interval));
  MEASURE(
    out, mid_edge_error,
    squares_over_time(&s->mid_edge, mid_edge(now), L * truth_patch_mid_edge(turned), interval));
  MEASURE(out, tip_error,
          squares_over_time(&s->tip, tip(now), L * truth_patch_tip(turned), interval));
}

#define METRICS(M, word) \
  M(word, centre_pressure_error) | M(word, mid_edge_error) | M(word, tip_error)

static const struct param params[] = PARAM_TABLE(PARAMS);
const struct benchmark benchmark_rotating_patch = {
  .name = "rotating-patch",
  .about = "square patch of fluid in rotation: tension everywhere, four arms (paper's coarse one: "
           "--spacing 0.0075 --set support=1.666667)",
  .source =
    "Colagrossi 2005, PhD thesis; Le Touze et al. 2013, Int. J. Numer. Meth. Fluids 73, 660",
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
  .judged_by = METRIC_mid_edge_error,
};
