/* Shapes are filled cell by cell on a lattice of spacing dx; positions are computed in double and
 * rounded once. */
#include <float.h>
#include <stdlib.h>

#include "scene.h"

struct lattice {
  double origin[DIM], dx; /* m */
  double count[DIM];      /* whole numbers */
};

static double lattice_size(const struct lattice *l)
{
  double cells = 1;
  for (int d = 0; d < DIM; d++) cells *= l->count[d];
  return cells;
}

/* Centre of the k-th cell, the last axis fastest. */
static vec lattice_point(const struct lattice *l, long k)
{
  vec x = zero();
  for (int d = DIM - 1; d >= 0; d--) {
    const long n = (long)l->count[d];
    x.c[d] = (real)(l->origin[d] + ((double)(k % n) + 0.5) * l->dx);
    k /= n;
  }
  return x;
}

/* Number of cells whose centres lie in [0, side): side/dx to the nearest whole number. */
static double cells_along(double side, double dx) { return ceil(side / dx - 0.5 - 1e-6); }

static status lattice_make(struct lattice *l, vec low, vec high, double dx, const char *shape)
{
  for (int d = 0; d < DIM; d++) {
    const double a = (double)low.c[d], b = (double)high.c[d];
    if (!isfinite(a) || !isfinite(b) || b <= a)
      return user_error("%s from %g to %g m on axis %d, allowed is a finite side above 0", shape, a,
                        b, d + 1);
    l->origin[d] = a;
    l->count[d] = cells_along(b - a, dx);
    if (l->count[d] < 1)
      return user_error(
        "%s has a side of %g m on axis %d, allowed is half the spacing (%g m) or more", shape,
        b - a, d + 1, dx);
  }
  l->dx = dx;
  if (!(lattice_size(l) <= 1e9))
    return user_error("%s would hold %.3g particles, allowed are at most 1e9", shape,
                      lattice_size(l));
  return OK;
}

static status fill(struct scene *scene, const struct lattice *l,
                   int (*inside)(const void *self, vec x), const void *self, vec velocity)
{
  const long cells = (long)lattice_size(l);
  TRY(scene_reserve(scene, inside ? 0 : (double)cells, 0));
  for (long k = 0; k < cells; k++) {
    const vec x = lattice_point(l, k);
    if (!inside || inside(self, x)) TRY(scene_add(scene, x, velocity));
  }
  return OK;
}

status scene_fill_box(struct scene *scene, vec low, vec high, vec velocity, int *first)
{
  struct lattice l;
  TRY(lattice_make(&l, low, high, scene->common.spacing, "the box"));
  if (first) *first = scene->n;
  return fill(scene, &l, NULL, NULL, velocity);
}

status scene_fill_where(struct scene *scene, vec low, vec high,
                        int (*inside)(const void *self, vec x), const void *self, vec velocity)
{
  struct lattice l;
  TRY(lattice_make(&l, low, high, scene->common.spacing, "the shape"));
  return fill(scene, &l, inside, self, velocity);
}

struct ball {
  vec centre;
  double radius;
};

static int in_ball(const void *self, vec x)
{
  const struct ball *ball = (const struct ball *)self;
  double r2 = 0;
  for (int d = 0; d < DIM; d++) {
    const double e = (double)x.c[d] - (double)ball->centre.c[d];
    r2 += e * e;
  }
  return r2 < ball->radius * ball->radius;
}

status scene_fill_disc(struct scene *scene, vec centre, double radius, vec velocity)
{
  const double dx = scene->common.spacing, cells = ceil(radius / dx);
  const struct ball ball = {centre, radius};
  if (!(radius > 0) || !isfinite(radius))
    return user_error("the %s has a radius of %g m, allowed is a finite one above 0",
                      DIM == 2 ? "disc" : "ball", radius);
  struct lattice l = {{0}, dx, {0}};
  for (int d = 0; d < DIM; d++) {
    if (!isfinite(centre.c[d]))
      return user_error("the centre of the %s is not finite", DIM == 2 ? "disc" : "ball");
    l.origin[d] = (double)centre.c[d] - cells * dx;
    l.count[d] = 2 * cells;
  }
  if (!(lattice_size(&l) <= 2e9))
    return user_error("a radius of %g m would hold more than 1e9 particles at spacing %g m", radius,
                      dx);
  return fill(scene, &l, in_ball, &ball, velocity);
}

struct polygon {
  const double (*corner)[2];
  int n;
};

/* Even-odd rule; an edge belongs to the side of larger x, so that neighbours share no particle. */
static int in_polygon(const void *self, vec x)
{
  const struct polygon *p = (const struct polygon *)self;
  const double X = (double)x.c[0], Y = (double)x.c[1];
  int inside = 0;
  for (int i = 0, j = p->n - 1; i < p->n; j = i++) {
    const double xi = p->corner[i][0], yi = p->corner[i][1];
    const double xj = p->corner[j][0], yj = p->corner[j][1];
    if ((yi > Y) == (yj > Y)) continue;
    /* the lower end first: the same bits for both polygons at an edge */
    const double cross =
      yi < yj ? xi + (Y - yi) / (yj - yi) * (xj - xi) : xj + (Y - yj) / (yi - yj) * (xi - xj);
    if (X < cross) inside = !inside;
  }
  return inside;
}

status scene_fill_polygon(struct scene *scene, const double (*corner)[2], int num_corners,
                          double z_low, double z_high, vec velocity)
{
  double low[2] = {DBL_MAX, DBL_MAX}, high[2] = {-DBL_MAX, -DBL_MAX};
  if (num_corners < 3)
    return user_error("a polygon has %d corners, allowed are 3 or more", num_corners);
  for (int i = 0; i < num_corners; i++)
    for (int d = 0; d < 2; d++) {
      if (!isfinite(corner[i][d])) return user_error("corner %d of a polygon is not finite", i + 1);
      low[d] = corner[i][d] < low[d] ? corner[i][d] : low[d];
      high[d] = corner[i][d] > high[d] ? corner[i][d] : high[d];
    }
  vec from = zero(), to = zero();
  from.c[DIM - 1] = (real)z_low;
  to.c[DIM - 1] = (real)z_high;
  for (int d = 0; d < 2; d++) {
    from.c[d] = (real)low[d];
    to.c[d] = (real)high[d];
  }
  struct lattice l;
  TRY(lattice_make(&l, from, to, scene->common.spacing, "the polygon"));
  const struct polygon polygon = {corner, num_corners};
  return fill(scene, &l, in_polygon, &polygon, velocity);
}

/* One axis of a box of walls: cells outside its low face, along it, outside its high face. */
struct wall_axis {
  double low, high, spacing, dx; /* spacing: along the face */
  long layers, inner, cells;
};

static double wall_coordinate(const struct wall_axis *a, long k)
{
  if (k < a->layers) return a->low - ((double)(a->layers - k) - 0.5) * a->dx;
  if (k < a->layers + a->inner) return a->low + ((double)(k - a->layers) + 0.5) * a->spacing;
  return a->high + ((double)(k - a->layers - a->inner) + 0.5) * a->dx;
}

static int wall_side(const struct wall_axis *a, long k) /* 1 below the box, -1 above, 0 along it */
{
  return k < a->layers ? 1 : k < a->layers + a->inner ? 0 : -1;
}

static void add_wall(struct scene *scene, vec x, vec normal)
{
  const int i = scene->n_wall++;
  scene->wall_x[i] = x;
  scene->wall_v[i] = zero();
  scene->wall_n[i] = times(1 / sqrt(inner(normal, normal)), normal);
}

static status wall_axes(struct scene *scene, struct wall_axis axis[DIM], vec low, vec high,
                        int layers, int open_top)
{
  struct lattice l;
  const double dx = scene->common.spacing;
  if (layers < 1) return user_error("a wall has %d layers, allowed are 1 or more", layers);
  TRY(lattice_make(&l, low, high, dx, "the box of walls"));
  double all = 1, hollow = 1;
  for (int d = 0; d < DIM; d++) {
    const double side = (double)high.c[d] - (double)low.c[d];
    const long count = (long)l.count[d], open = open_top && d == DIM - 1;
    axis[d] = (struct wall_axis){
      (double)low.c[d], (double)high.c[d], side / (double)count, dx, layers, count, 0};
    axis[d].cells = count + (open ? 1L : 2L) * layers;
    all *= (double)axis[d].cells;
    hollow *= (double)count;
  }
  return scene_reserve(scene, 0, all - hollow);
}

status scene_wall_box(struct scene *scene, vec low, vec high, int layers, int open_top)
{
  struct wall_axis axis[DIM];
  TRY(wall_axes(scene, axis, low, high, layers, open_top));
  long k[DIM] = {0};
  for (int d = 0; d >= 0;) {
    vec x = zero(), normal = zero();
    int outside = 0;
    for (int e = 0; e < DIM; e++) {
      const int side = wall_side(&axis[e], k[e]);
      x.c[e] = (real)wall_coordinate(&axis[e], k[e]);
      normal.c[e] = (real)side;
      outside |= side != 0;
    }
    if (outside) add_wall(scene, x, normal);
    for (d = DIM - 1; d >= 0 && ++k[d] >= axis[d].cells; d--) k[d] = 0;
  }
  return OK;
}
