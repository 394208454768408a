/* hybrid_grid.h - the staggered grid of the hybrid particle-grid methods (hybrid.c): its cells
 * around the particles, what the particles bring to it, and its projection. Equation numbers are
 * those of Liu et al. 2024 as in hybrid.c. Capital indices are cells; X_I is the centre of cell I,
 * whose pressure is there; component d of its velocity is on its low face, at X_I - h/2 e_d (the
 * grid of Harlow & Welch 1965). */
#ifndef HYBRID_GRID_H
#define HYBRID_GRID_H
#include "../core/base/memory.h"
#include "../core/linear/cg.h"
#include "../core/neighbours/node_keys.h"
#include "../core/solver.h"
#include <string.h>

enum { SURFACE_FILLED, SURFACE_OCCUPIED, SURFACE_FRACTION };
enum { DENSITY_VIRTUAL, DENSITY_REAL };
enum { AIR, WATER, SOLID };                   /* kinds of cells */
enum { LIST_AT_CELLS, LIST_AT_REAL, MATRIX }; /* the run's pair lists and coefficients */
enum { SIDES = 2 * DIM, STENCIL = DIM == 2 ? 9 : 27, LAYERS = DIM };
enum { ROW = (SIDES + LANES - 1) / LANES * LANES }; /* slots of a matrix row */
#define FILLED ((real)0.4)   /* share of the volume from which a cell holds fluid */
#define TOUCHED ((real)0.01) /* part of a particle that reaches a face at least */

#define PARAMS(P)                                                                               \
  P(virtual_spacing, 1, 0.5, 4, "dx", "side of a cell")                                         \
  P(surface, SURFACE_FRACTION, 0, 2, "filled|occupied|fraction",                                \
    "which cells are fluid, and where p is 0")                                                  \
  P(kappa, -1, -1, 100, "1", "density compensation, Eq. (13); -1: 0.1 with gravity, 0 without") \
  P(density, DENSITY_REAL, 0, 1, "virtual|real", "where the density of Eq. (13) is taken")      \
  P(tolerance, 1e-4, 0, 1, "1", "relative residual at which CG stops")                          \
  P(max_iterations, 1000, 1, 1e6, WHOLE, "largest number of CG iterations")                     \
  P(fixed_iterations, 0, 0, 1e6, WHOLE, "exactly so many CG iterations; 0: by tolerance")

#define PARAMS_FLIP(P) \
  PARAMS(P)            \
  P(blend, 0.9, 0, 1, "1", "share alpha of the particle's own velocity that is kept, Eq. (21)")

#define FIELDS(F)                                                                            \
  F(vec, X, VIRTUAL, KEPT, "m", "centre of a cell")                                          \
  F(int, rank, VIRTUAL, KEPT, "1", "place of a cell among the sorted keys")                  \
  F(int, ranked, VIRTUAL, STEP, "1", "the cell at that place")                               \
  F(int, first, VIRTUAL, STEP, "1", "first slot of a matrix row")                            \
  F(int, last, VIRTUAL, STEP, "1", "end of a matrix row")                                    \
  F(int, kind, VIRTUAL, STEP, "1", "0 air, 1 fluid, 2 wall")                                 \
  F(int, known, VIRTUAL, STEP, "1", "bit d: face d has been given its velocity")             \
  F(int, reached, VIRTUAL, STEP, "1", "known, with the layer that is being added")           \
  F(real, fill, VIRTUAL, STEP, "1", "volume of fluid in a cell over its own")                \
  F(vec, load, VIRTUAL, STEP, "kg", "mass at the low faces")                                 \
  F(vec, old, VIRTUAL, STEP, "m/s", "velocity at the low faces, from the particles")         \
  F(vec, u, VIRTUAL, STEP, "m/s", "velocity at the low faces: of the walls, then projected") \
  F(real, source, VIRTUAL, STEP, "1/s^2", "right-hand side of the pressure equation")        \
  F(real, diag, VIRTUAL, STEP, "m^3/kg/m^2", "diagonal of the matrix")                       \
  F(real, pI, VIRTUAL, STEP, "Pa", "pressure of a cell")                                     \
  F(real, open, VIRTUAL, STEP, "1", "0 for a wall cell, else 1")                             \
  F(real, weight, VIRTUAL, STEP, "1", "of a cell in CG's inner product: 1")                  \
  F(real, r, VIRTUAL, STEP, "1/s^2", "residual of CG")                                       \
  F(real, d, VIRTUAL, STEP, "Pa", "direction of CG")                                         \
  F(real, q, VIRTUAL, STEP, "1/s^2", "matrix times direction of CG")

#define FIELDS_APIC(F)                                                          \
  FIELDS(F)                                                                     \
  F(vec, cx, ALL, KEPT, "1/s", "gradient of v_x around a particle; 0 on walls") \
  F(vec, cy, ALL, KEPT, "1/s", "gradient of v_y around a particle; 0 on walls") \
  F(vec, cz, ALL, KEPT, "1/s", "gradient of v_z around a particle; 0 on walls")

#define FIELDS_FLIP(F) \
  FIELDS(F)            \
  F(vec, slip, FLUID, KEPT, "m/s", "velocity of the grid at a particle less its own")

#define FIELDS_NFLIP(F)           \
  FIELDS(F)                       \
  F(vec, hold, WALL, STEP, "m/s", \
    "change of velocity that holds a particle off the walls, Eq. (17)")

#define FIELDS_ALL(F)                                                                 \
  FIELDS_APIC(F)                                                                      \
  F(vec, slip, FLUID, KEPT, "m/s", "velocity of the grid at a particle less its own") \
  F(vec, hold, WALL, STEP, "m/s",                                                     \
    "change of velocity that holds a particle off the walls, Eq. (17)")

/* One state for the four; a method's tables name the members that it uses. */
typedef struct {
  VIEW;
  PARAMS_FLIP(PARAM_MEMBER)
  FIELDS_ALL(FIELD_MEMBER)
  struct pairs at_cells, at_real; /* I -> j, i -> I */
  unsigned long long *keys;       /* occupied cells, then all cells, both sorted */
  int num_occupied, num_cells;
  int *beside; /* the cells at the faces of each: low and high side of every axis; itself: none */
  size_t beside_bytes;
  real *alpha;             /* off-diagonal coefficients */
  real h, inv_h, V0, unit; /* side of a cell, its inverse; m/rho0; 1/(rho0 h^2) */
} state;

/* --- the cells: those around the particles */

/* k = floor(x_i / h), the cell of a particle */
STAGE void occupied(const state *s, int i)
{
  long long k[DIM];
  for (int d = 0; d < DIM; d++) k[d] = node_whole(floor(s->p.x[i].c[d] * s->inv_h));
  s->keys[i] = key_of(k);
}
/* k_out = k + s, s in {-1, 0, 1}^d: all cells whose faces the particles of cell k touch, and all
 * that share a face with a cell whose faces are touched */
STAGE void around(const state *s, int i)
{
  long long k[DIM], other[DIM];
  unsigned long long *out = s->keys + s->num_occupied + (long long)STENCIL * i;
  node_of(s->keys[i], k);
  for (int n = 0; n < STENCIL; n++) {
    for (int d = 0, rest = n; d < DIM; d++, rest /= 3) other[d] = k[d] + rest % 3 - 1;
    out[n] = key_of(other);
  }
}
/* X_I = (k + 1/2) h */
STAGE void place(const state *s, int I)
{
  long long k[DIM];
  node_of(s->keys[s->num_occupied + I], k);
  for (int d = 0; d < DIM; d++) s->X[I].c[d] = s->h * ((real)k[d] + (real)0.5);
  s->rank[I] = I;
}
STAGE void rank_cells(const state *s, int I) { s->ranked[s->rank[I]] = I; }
STAGE void join(const state *s, int I)
{
  const unsigned long long *cells = s->keys + s->num_occupied;
  long long k[DIM];
  node_of(cells[s->rank[I]], k);
  for (int n = 0; n < ROW; n++) {
    const int d = n / 2, step = n % 2 ? 1 : -1;
    int rank = -1;
    if (n < SIDES) {
      k[d] += step;
      rank = key_find(cells, s->num_cells, key_of(k));
      k[d] -= step;
    }
    s->beside[ROW * I + n] = rank < 0 ? I : s->ranked[rank];
  }
  s->first[I] = ROW * I;
  s->last[I] = ROW * I + SIDES;
}

static status make_cells(struct run *run, state *s)
{
  const int most = 2147483647 / (STENCIL + 1);
  if (s->p.n > most) return status_set(ERR_MEMORY, "more than %d particles are too many", most);
  s->keys = run_keys(run, s->p.n * (STENCIL + 1));
  if (!s->keys) return status_set(ERR_MEMORY, "no memory for the cells");
  sweep(occupied, s);
  s->num_occupied = run_unique_keys(run, s->keys, s->p.n);
  if (s->num_occupied < 0) return status_set(ERR_MEMORY, "no memory for the cells");
  sweep_over(around, s, s->num_occupied);
  s->num_cells = run_unique_keys(run, s->keys + s->num_occupied, s->num_occupied * STENCIL);
  if (s->num_cells < 0) return status_set(ERR_MEMORY, "no memory for the cells");
  TRY(run_virtual(run, s->num_cells));
  sweep_over(place, s, s->num_cells);
  return OK;
}

static status join_cells(struct run *run, state *s)
{
  const size_t wanted = sizeof(int) * ROW * (size_t)s->num_cells;
  TRY(run_sort_virtual(run));
  TRY(run_pairs(run, LIST_AT_CELLS, SET_VIRTUAL, SET_ALL, &s->at_cells));
  TRY(run_pairs(run, LIST_AT_REAL, SET_FLUID, SET_VIRTUAL, &s->at_real));
  if (wanted > s->beside_bytes) {
    memory_give(s->beside, s->beside_bytes);
    s->beside_bytes = wanted + wanted / 4;
    s->beside = (int *)memory_take(s->beside_bytes);
    if (!s->beside) s->beside_bytes = 0;
  }
  s->alpha = run_coefficients(run, MATRIX, ROW * s->num_cells);
  if (!s->beside || !s->alpha) return status_set(ERR_MEMORY, "no memory for the matrix");
  sweep_over(rank_cells, s, s->num_cells);
  sweep_over(join, s, s->num_cells);
  return OK;
}

STAGE int low_of(const state *s, int I, int d) { return s->beside[ROW * I + 2 * d]; }
STAGE int high_of(const state *s, int I, int d) { return s->beside[ROW * I + 2 * d + 1]; }

/* --- particles to grid */

/* N(r) = max(0, 1 - |r|) */
STAGE lanes hat(lanes r) { return at_least(1 - at_least(r, 0) - at_least(-r, 0), 0); }

/* w of a cell's centre and of its low faces for a particle from which x, in cells, leads to the
 * centre: products of N over the axes */
struct weights {
  lanes centre;
  vecs face;
};
STAGE struct weights weights_at(vecs x)
{
  struct weights w;
  w.centre = hat(x.c[0]);
  for (int d = 1; d < DIM; d++) w.centre *= hat(x.c[d]);
  for (int d = 0; d < DIM; d++) {
    w.face.c[d] = hat(x.c[d] - (real)0.5);
    for (int e = 0; e < DIM; e++)
      if (e != d) w.face.c[d] *= hat(x.c[e]);
  }
  return w;
}

/* row d of the matrix C_i of APIC */
STAGE const vec *affine(const state *s, int d) { return d == 0 ? s->cx : d == 1 ? s->cy : s->cz; }

/* m_g = sum_p w_gp m_p,   m_g v_g = sum_p w_gp m_p v_p  (P2G, Sec. 6.3)
 * Jiang et al. Eqs. (12), (13)   m_g v_g,d = sum_p w_gp m_p (v_p,d + c_p,d . (x_g - x_p)) */
STAGE void to_faces(const state *s, int I)
{
  vecs mass = NO_VECS, momentum = NO_VECS;
  for_pairs (&s->at_cells, I, Ij) {
    const struct weights w = weights_at(scale(s->inv_h + NO_LANES, Ij.x));
    const lanes m = only_below(Ij, s->p.n, only(Ij, of(s->p.m, Ij)));
    const vecs v = of(s->p.v, Ij);
    for (int d = 0; d < DIM; d++) {
      lanes vd = v.c[d];
      if (s->cx) {
        vecs from_particle = Ij.x;
        from_particle.c[d] -= s->h / 2;
        vd += dot(of(affine(s, d), Ij), from_particle);
      }
      mass.c[d] += m * w.face.c[d];
      momentum.c[d] += positive(m, m * w.face.c[d] * vd);
    }
  }
  s->load[I] = sum(mass);
  s->old[I] = sum(momentum);
  for (int d = 0; d < DIM; d++)
    s->old[I].c[d] = s->load[I].c[d] > 0 ? s->old[I].c[d] / s->load[I].c[d] : 0;
}

STAGE int is_occupied(const state *s, int I)
{
  return key_find(s->keys, s->num_occupied, s->keys[s->num_occupied + s->rank[I]]) >= 0;
}
/* Do particles reach all faces of cell I, so that its divergence is known? */
STAGE int touched(const state *s, int I)
{
  int all = 1;
  for (int d = 0; d < DIM; d++) {
    const int H = high_of(s, I, d);
    all &= H != I && s->load[I].c[d] > TOUCHED * s->mass && s->load[H].c[d] > TOUCHED * s->mass;
  }
  return all;
}

/* The filling of cell I, sum_j w_Ij dx^d / h^d over the fluid, and what is asked for its density
 * Eq. (13)  kappa max(rho_I - rho0, 0) / (rho0 dt^2),
 *           rho_I/rho0 that filling, or sum_j V_j rho_j/rho0 w_Ij / sum_j V_j w_Ij */
STAGE void to_centres(const state *s, int I)
{
  lanes fluid = NO_LANES, all = NO_LANES, volume = NO_LANES, crowd = NO_LANES;
  real unit = 1;
  for_pairs (&s->at_cells, I, Ij) {
    const lanes w = only(Ij, weights_at(scale(s->inv_h + NO_LANES, Ij.x)).centre);
    const lanes fluid_w = only_below(Ij, s->p.n, w), V = of(s->p.V, Ij);
    all += w;
    fluid += fluid_w;
    volume += positive(fluid_w, fluid_w * V);
    crowd += positive(fluid_w, fluid_w * (s->V0 - V));
  }
  for (int d = 0; d < DIM; d++) unit *= s->dx * s->inv_h;
  const real fill = unit * sum(fluid), solid = unit * sum(all) - fill, V = sum(volume);
  const real real_excess = V > 0 ? sum(crowd) / V : 0;
  const real excess = larger(s->density == DENSITY_REAL ? real_excess : fill - 1, 0);
  const int filled = s->surface == SURFACE_FRACTION ? fill > (real)0.5 : fill >= FILLED;
  const int is_fluid = s->surface == SURFACE_OCCUPIED
                         ? is_occupied(s, I)
                         : filled && (touched(s, I) || is_occupied(s, I));
  s->fill[I] = fill;
  s->kind[I] = solid > (real)0.5 ? SOLID : is_fluid ? WATER : AIR;
  s->source[I] = s->kappa * excess / sq(s->dt);
}

/* The walls' velocity at the faces near them, in u until the projection:
 * v_g = sum_s w_gs v_s / sum_s w_gs */
STAGE void walls_to_faces(const state *s, int I)
{
  vecs number = NO_VECS, flow = NO_VECS;
  for_pairs (&s->at_cells, I, Ij) {
    const struct weights w = weights_at(scale(s->inv_h + NO_LANES, Ij.x));
    const lanes one = only(Ij, 1 + NO_LANES), is_wall = one - only_below(Ij, s->p.n, one);
    const vecs v = of(s->p.v, Ij);
    for (int d = 0; d < DIM; d++) {
      number.c[d] += is_wall * w.face.c[d];
      flow.c[d] += is_wall * w.face.c[d] * v.c[d];
    }
  }
  const vec n = sum(number);
  s->u[I] = sum(flow);
  for (int d = 0; d < DIM; d++) s->u[I].c[d] = n.c[d] > 0 ? s->u[I].c[d] / n.c[d] : 0;
}

/* --- projection on the grid */

/* Velocity of the face between cell J and cell I above it on axis d, before the projection: that of
 * the wall between wall and fluid; between wall and air it may leave the wall. */
STAGE real held(const state *s, int J, int I, int d)
{
  const real u = s->old[I].c[d];
  const int low = s->kind[J] == SOLID, high = s->kind[I] == SOLID;
  if (low == high) return u;
  const real wall = s->u[I].c[d];
  if (s->kind[low ? I : J] == WATER) return wall;
  return low ? larger(u, wall) : smaller(u, wall);
}

/* Part of the way from the centre of fluid cell I to that of air cell J at which p is 0:
 * (fill_I - 1/2) / (fill_I - fill_J) */
STAGE real way_to_surface(const state *s, int I, int J)
{
  if (s->surface != SURFACE_FRACTION || s->fill[J] >= (real)0.5) return 1;
  return larger((s->fill[I] - (real)0.5) / (s->fill[I] - s->fill[J]), (real)0.01);
}

/* alpha_IJ = 1/(rho0 h^2) to fluid, alpha_II = sum of those to fluid and air,
 * b_I = -(1/dt) sum_d (u_I+d,d - u_I,d)/h + Eq. (13), without axes on one side of which no particle
 * reaches the face: those of a film exactly between two cells */
STAGE void equation(const state *s, int I)
{
  real *row = s->alpha + ROW * I;
  real diag = 0, div = 0;
  const int is_fluid = s->kind[I] == WATER;
  for (int n = 0; n < ROW; n++) {
    const int J = s->beside[ROW * I + n], kind = is_fluid && n < SIDES ? s->kind[J] : SOLID;
    row[n] = kind == WATER ? s->unit : 0;
    if (kind == AIR) diag += s->unit / way_to_surface(s, I, J);
    diag += row[n];
  }
  for (int d = 0; d < DIM && is_fluid; d++) {
    const int H = high_of(s, I, d), L = low_of(s, I, d);
    if (s->load[I].c[d] > 0 && s->load[H].c[d] > 0)
      div += (held(s, I, H, d) - held(s, L, I, d)) * s->inv_h;
  }
  s->source[I] = is_fluid ? s->source[I] - div / s->dt : 0;
  s->diag[I] = is_fluid ? larger(diag, (real)1e-6 * s->unit) : 1;
  s->open[I] = s->kind[I] != SOLID;
  s->weight[I] = 1;
  s->pI[I] = 0;
}

/* u_I,d -= dt/rho0 (p_I - p_J)/h, J below I; p = 0 in air */
STAGE void correct(const state *s, int I)
{
  int known = 0;
  for (int d = 0; d < DIM; d++) {
    const int J = low_of(s, I, d), above = s->kind[I], below = s->kind[J];
    real gradient = 0;
    if (above == WATER && below == WATER)
      gradient = s->pI[I] - s->pI[J];
    else if (above == WATER && below == AIR)
      gradient = s->pI[I] / way_to_surface(s, I, J);
    else if (above == AIR && below == WATER)
      gradient = -s->pI[J] / way_to_surface(s, J, I);
    s->u[I].c[d] = held(s, J, I, d) - s->dt / s->rho0 * gradient * s->inv_h;
    if (above == WATER || below == WATER || (above == SOLID) != (below == SOLID)) known |= 1 << d;
  }
  s->known[I] = known;
}

/* One layer further: a face inside a wall takes the mean velocity of those beside it that are
 * known, one in air their mean change of velocity. */
STAGE void spread(const state *s, int I)
{
  int reached = s->known[I];
  for (int d = 0; d < DIM; d++) {
    if (s->known[I] >> d & 1) continue;
    const int in_wall = s->kind[I] == SOLID;
    real total = 0;
    int num = 0;
    for (int n = 0; n < SIDES; n++) {
      const int K = s->beside[ROW * I + n];
      if (K == I || !(s->known[K] >> d & 1)) continue;
      total += s->u[K].c[d] - (in_wall ? 0 : s->old[K].c[d]);
      num++;
    }
    if (!num) continue;
    s->u[I].c[d] = (in_wall ? 0 : s->old[I].c[d]) + total / (real)num;
    reached |= 1 << d;
  }
  s->reached[I] = reached;
}
STAGE void add_layer(const state *s, int I) { s->known[I] = s->reached[I]; }

static status solve(struct run *run, state *s)
{
  struct cg cg;
  sweep_over(equation, s, s->num_cells);
  memset(&cg, 0, sizeof cg);
  cg.n = cg.rows.rows = s->num_cells;
  cg.rows.slots = ROW * s->num_cells;
  cg.rows.first = s->first;
  cg.rows.last = s->last;
  cg.rows.list = s->beside;
  cg.rows.visits = s->at_cells.visits; /* a row's neighbours count as pairs do */
  cg.coef = s->alpha;
  cg.diag = s->diag;
  cg.weight = s->weight;
  cg.b = s->source;
  cg.x = s->pI;
  cg.r = s->r;
  cg.d = s->d;
  cg.q = s->q;
  const int fixed = (int)s->fixed_iterations;
  const struct cg_result result =
    cg_solve(&cg, fixed ? 0 : (double)s->tolerance, fixed ? fixed : (int)s->max_iterations);
  run_iterations(run, "pressure", result.iterations, result.residual, fixed || result.converged);
  return OK;
}
#endif
