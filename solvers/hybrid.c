/* Hybrid particle-grid methods: particles carry mass and velocity, a staggered grid projects it.
 * F. H. Harlow & J. E. Welch, Phys. Fluids 8, 2182-2189 (1965), doi:10.1063/1.1761178: the
 * staggered grid, and the particle-in-cell method of Harlow 1962, doi:10.2172/4769185
 *   pic    Harlow 1962
 *   apic   C. Jiang, C. Schroeder, A. Selle, J. Teran & A. Stomakhin, ACM Trans. Graph. 34(4), 51
 *          (2015), doi:10.1145/2766996
 *   flip   J. U. Brackbill & H. M. Ruppel, J. Comput. Phys. 65, 314-343 (1986),
 *          doi:10.1016/0021-9991(86)90211-1; for liquids Y. Zhu & R. Bridson, ACM Trans. Graph.
 *          24(3), 965-972 (2005), doi:10.1145/1073204.1073298
 *   nflip  Y. Fei, Q. Guo, R. Wu, L. Huang & M. Gao, ACM Trans. Graph. 40(4), 109 (2021),
 *          doi:10.1145/3450626.3459678
 * as they are compared in Sec. 6.3 of S. Liu, X. He, Y. Guo, Y. Chang & W. Wang, ACM Trans. Graph.
 * 43(3), 28 (2024), doi:10.1145/3649888. Equation numbers are that paper's; its equations of
 * Sec. 6.3 have no numbers but for (21). The grid is in hybrid_grid.h.
 *
 * Momentum: the transfers keep the linear one exactly, APIC's also the angular one, that of C_p
 * included, at fixed positions. The pressure keeps it only to first order in dx, since the mass m_g
 * at a face is not rho0 h^d: four steps of a turning square with a jitter of 0.15 dx lose 2, 0.7,
 * 0.2 % of what flip exchanges at 12, 24, 48 particles a side.
 *
 * Differences from the papers: see DIFFERENCES below. */
#include "hybrid_grid.h"

#define DIFFERENCES                                                                                \
  "forces and XSPH act on the particles before their velocity goes to the grid: the same as on "   \
  "the grid for gravity\n"                                                                         \
  "the step begins with the move, by the velocity that the last step has projected\n"              \
  "only cells near particles exist; the weights are multilinear\n"                                 \
  "surface = fraction (default): a cell holds fluid if the particles fill it, by the weights at "  \
  "its centre, to more than 1/2, and p = 0 where the filling falls to 1/2 (Gibou et al. 2002, "    \
  "J. Comput. Phys. 176, 205-227): the pressure is then second order in dx, at the centres of "    \
  "the air's cells first. filled: cells filled to 0.4 or more, p = 0 at those centres. occupied: " \
  "the same with cells that hold a particle, the classical rule: at one particle per cell many "   \
  "cells inside a fluid hold none, and it swells by half\n"                                        \
  "an empty cell is air if no particle reaches some face of it\n"                                  \
  "walls are whole cells: those with more than half of their volume in wall particles\n"           \
  "faces that touch no fluid take the mean change of those beside them that do, inside walls "     \
  "their mean velocity, in d layers: spray keeps its own velocity that way\n"                      \
  "density compensation is Eq. (13) of Liu et al. 2024 as dual-sc takes it: kappa is a number, "   \
  "the density that of the particles (density = real) or of the cell (virtual)\n"                  \
  "a particle exactly between two cells takes the affine field of the upper one\n"                 \
  "nflip: near walls the approach of a particle to them is taken out, Eq. (17) of Liu et al. "     \
  "2024 times 2, since its particles are not moved by the velocity that keeps them out"

/* --- grid to particles */

/* v_p = sum_g w_gp v_g^(n+1) + alpha (v_p - sum_g w_gp v_g^n)  (G2P of PIC, FLIP; Eq. (21)), and
 * the pressure for the record: p_p = sum_I w_Ip p_I / sum_I w_Ip over cells that are no wall */
STAGE void to_particles(const state *s, int i)
{
  vecs now = NO_VECS, before = NO_VECS;
  lanes pressure = NO_LANES, open = NO_LANES;
  for_pairs (&s->at_real, i, iI) {
    const struct weights w = weights_at(scale(-s->inv_h + NO_LANES, iI.x));
    const vecs u = of(s->u, iI), old = of(s->old, iI);
    for (int d = 0; d < DIM; d++) {
      const lanes wd = only(iI, w.face.c[d]);
      now.c[d] += wd * u.c[d];
      before.c[d] += wd * old.c[d];
    }
    const lanes not_wall = only(iI, w.centre) * of(s->open, iI);
    pressure += not_wall * of(s->pI, iI);
    open += not_wall;
  }
  const vec grid = sum(now), own = sub(s->p.v[i], sum(before));
  const real total = sum(open);
  s->p.v[i] = madd(grid, s->blend, own);
  s->p.p[i] = total > 0 ? sum(pressure) / total : 0;
  if (s->slip) s->slip[i] = sub(grid, s->p.v[i]);
}

/* Jiang et al. Sec. 5.3   c_p,d = sum_g grad w_gp v_g,d, the same with v_g - v_p since sum_g grad
 * w_gp = 0: so a face that no particle reaches, beside a particle on the edge of its own, is left
 * out. Per axis the particle is the part t of the way from the face plane below it to that above
 * it, N is 1 - t or t there, dN/dx -1/h or 1/h. */
STAGE void to_affine(const state *s, int i)
{
  for (int d = 0; d < DIM; d++) {
    vecs slope = NO_VECS;
    vec t;
    for (int e = 0; e < DIM; e++) {
      const real at = s->p.x[i].c[e] * s->inv_h - (e == d ? 0 : (real)0.5);
      t.c[e] = at - floor(at);
    }
    for_pairs (&s->at_real, i, iI) {
      vecs N, dN;
      for (int e = 0; e < DIM; e++) {
        const lanes step = t.c[e] - iI.x.c[e] * s->inv_h - (e == d ? (real)0.5 : 0);
        const lanes below = hat(step), above = hat(step - 1);
        N.c[e] = (1 - t.c[e]) * below + t.c[e] * above;
        dN.c[e] = s->inv_h * (above - below);
      }
      const lanes load = only(iI, of(s->load, iI).c[d]);
      const lanes u = positive(load, of(s->u, iI).c[d] - s->p.v[i].c[d]);
      for (int e = 0; e < DIM; e++) {
        lanes w = dN.c[e];
        for (int f = 0; f < DIM; f++)
          if (f != e) w *= N.c[f];
        slope.c[e] += w * u;
      }
    }
    (d == 0 ? s->cx : d == 1 ? s->cy : s->cz)[i] = sum(slope);
  }
}

/* Eq. (17)  v_i -= 2 sum_s V_s W_is [(v_i - v_s) . n_s]^- n_s: at a wall, where sum_s V_s W_is is
 * 1/2, all of the approach */
STAGE void hold_off_walls(const state *s, int i)
{
  vecs dv = NO_VECS;
  lanes total = NO_LANES;
  for_neighbours (s, i, ij) {
    const vecs n = of(s->p.normal, ij);
    const lanes w = W(&s->nb, ij), wall_w = 2 * s->V0 * (w - only_below(ij, s->p.n, w));
    dv = add(dv, scale(-wall_w * at_most(dot(diff(s->p.v, ij), n), 0), n));
    total += wall_w;
  }
  s->hold[i] = times(1 / larger(sum(total), 1), sum(dv));
}
STAGE void add_hold(const state *s, int i) { s->p.v[i] = plus(s->p.v[i], s->hold[i]); }

/* --- the step */

static status project(struct run *run, void *self)
{
  state *s = (state *)self;
  const int walls = s->p.n_all > s->p.n;
  TRY(run_density(run));
  TRY(make_cells(run, s));
  TRY(join_cells(run, s));
  sweep_over(to_faces, s, s->num_cells);
  sweep_over(to_centres, s, s->num_cells);
  if (walls) sweep_over(walls_to_faces, s, s->num_cells);
  TRY(solve(run, s));
  sweep_over(correct, s, s->num_cells);
  for (int k = 0; k < LAYERS; k++) {
    sweep_over(spread, s, s->num_cells);
    sweep_over(add_layer, s, s->num_cells);
  }
  sweep(to_particles, s);
  if (s->cx) sweep(to_affine, s);
  if (s->hold) {
    sweep(hold_off_walls, s);
    sweep(add_hold, s);
  }
  return OK;
}

/* x_p += dt (sum_g w_gp v_g - v_p): FLIP moves with the velocity of the grid */
STAGE void move_with_grid(const state *s, int i) { s->p.x[i] = madd(s->p.x[i], s->dt, s->slip[i]); }

static status step(struct run *run, void *self)
{
  state *s = (state *)self;
  if (s->slip) sweep(move_with_grid, s);
  TRY(run_move(run));
  TRY(run_neighbours(run));
  TRY(run_forces(run)); /* v* = v + dt g, then viscosity */
  return project(run, s);
}

/* C_i = 0, and the grid moves as the particle does: grid - v = 0 */
STAGE void clear_kept(const state *s, int i)
{
  for (int d = 0; d < DIM && s->cx; d++) (d == 0 ? s->cx : d == 1 ? s->cy : s->cz)[i] = zero();
  if (s->slip && i < s->p.n) s->slip[i] = zero();
}

static status start(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  /* the far corner of what a cell's faces reach: 3/2 h along the face's axis, h along the others */
  const real reach = s->virtual_spacing * sqrt((real)1.25 + (real)DIM), R = s->nb.kernel.R / s->dx;
  if (R < reach)
    return user_error("cells of %g dx need a support of at least %.4g dx, it is %g dx",
                      (double)s->virtual_spacing, (double)reach, (double)R);
  s->h = s->virtual_spacing * s->dx;
  s->inv_h = 1 / s->h;
  s->V0 = s->mass / s->rho0;
  s->unit = sq(s->inv_h) / s->rho0;
  if (s->kappa < 0) s->kappa = inner(s->gravity, s->gravity) > 0 ? (real)0.1 : 0;
  sweep_over(clear_kept, s, s->p.n_all);
  return OK;
}

static void stop(struct run *run, void *self)
{
  state *s = (state *)self;
  (void)run;
  memory_give(s->beside, s->beside_bytes);
}

static void warn(const void *self, double speed, char *text, size_t size)
{
  (void)speed;
  warn_of_kappa((double)((const state *)self)->kappa, text, size);
}

static int uses(const void *self, const char *field)
{
  (void)self;
  return DIM == 3 || strcmp(field, "cz") != 0;
}

static const struct param params[] = PARAM_TABLE(PARAMS), params_flip[] = PARAM_TABLE(PARAMS_FLIP);
static const struct field fields[] = FIELD_TABLE(FIELDS), fields_apic[] = FIELD_TABLE(FIELDS_APIC),
                          fields_flip[] = FIELD_TABLE(FIELDS_FLIP),
                          fields_nflip[] = FIELD_TABLE(FIELDS_NFLIP);

#define NEEDS (HAS(x) | HAS(v) | HAS(m) | HAS(rho) | HAS(V) | HAS(p))
#define DOES                                                                                      \
  (CAN(2D) | CAN(3D) | CAN(WALLS) | CAN(FREE_SURFACE) | CAN(GRAVITY) | CAN(XSPH) | CAN(PROJECT) | \
   CAN(VISCOSITY) | CAN(EMITTERS))
/* Not nflip: moved by what the grid does not see, a drop of 12 dx did not grow round under He et
 * al.'s tension. */
#define DOES_TENSION (DOES | CAN(TENSION))

#define METHOD(label, text, cite, link, the_needs, the_can, the_params, the_fields)         \
  {                                                                                         \
    .abi = SOLVER_ABI, .name = label, .about = text, .paper = cite, .doi = link,            \
    .differences = DIFFERENCES, .needs = the_needs, .can = the_can, .params = the_params,   \
    .num_params = COUNT(the_params), .fields = the_fields, .num_fields = COUNT(the_fields), \
    .state_size = sizeof(state), .start = start, .step = step, .changed = NULL,             \
    .project = project, .max_dt = NULL, .uses = uses, .stop = stop, .warn = warn            \
  }

const struct solver solver_pic =
  METHOD("pic", "particle-in-cell on a staggered grid: smooths at every step",
         "Harlow 1962, LAMS-2806; Harlow & Welch 1965, Phys. Fluids 8, 2182", "10.2172/4769185",
         NEEDS, DOES_TENSION, params, fields);
const struct solver solver_apic =
  METHOD("apic", "affine particle-in-cell on a staggered grid",
         "Jiang, Schroeder, Selle, Teran & Stomakhin 2015, ACM Trans. Graph. 34(4), 51",
         "10.1145/2766996", NEEDS, DOES_TENSION, params, fields_apic);
const struct solver solver_flip =
  METHOD("flip", "fluid-implicit particles on a staggered grid, blended with pic",
         "Brackbill & Ruppel 1986, J. Comput. Phys. 65, 314; Zhu & Bridson 2005, ACM Trans. Graph. "
         "24(3), 965",
         "10.1016/0021-9991(86)90211-1", NEEDS, DOES_TENSION, params_flip, fields_flip);
const struct solver solver_nflip =
  METHOD("nflip", "as flip, but particles move with their own velocity, not the grid's",
         "Fei, Guo, Wu, Huang & Gao 2021, ACM Trans. Graph. 40(4), 109", "10.1145/3450626.3459678",
         NEEDS | HAS(normal), DOES, params_flip, fields_nflip);
