/* scene.h - building a scene: parameters common to all scenes, and shapes filled with particles. */
#ifndef SCENE_H
#define SCENE_H
#include "../base/param.h"
#include "../base/status.h"
#include "../sph/kernels.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Parameters that every scene has. P(name, default, low, high, unit, meaning); a scene sets its own
 * defaults. */
#define SCENE_PARAMS(P)                                                                         \
  P(spacing, 0.01, 1e-9, 1e6, "m", "particle spacing dx at the start")                          \
  P(dt, 1e-3, 1e-12, 1e6, "s", "time step")                                                     \
  P(t_end, 1, 0, 1e9, "s", "end of the simulated time")                                         \
  P(support, 2.5, 1.05, 10, "dx", "support radius R of the kernel, in particle spacings")       \
  P(kernel, 0, 0, 3, KERNEL_CHOICES, "smoothing kernel")                                        \
  P(rho0, 1000, 1e-6, 1e9, "kg/m^3", "rest density")                                            \
  P(gravity, 9.81, 0, 1e6, "m/s^2", "gravity, along -y in 2-D and -z in 3-D")                   \
  P(walls, 0, 0, 1, "lattice|akinci",                                                           \
    "weight of walls: as in a full lattice, or one layer by Akinci et al. 2012 (support 2 dx)") \
  P(xsph, 0, 0, 1, "1", "XSPH coefficient per step (dissipation grows as 1/dt)")                \
  P(xsph_rate, 0, 0, 1e6, "m/s", "XSPH as a rate: adds xsph_rate dt/(R/2) to xsph")             \
  P(viscosity, 0, 0, 1e9, "Pa s", "dynamic viscosity; explicit: dt < 0.1 rho0 dx^2/it")         \
  P(viscosity_form, 1, 0, 1, "explicit|implicit", "forces of old or of new velocities")         \
  P(viscosity_pairs, 0, 0, 1, "central|full", "pairs pull along their line, or on all of v")    \
  P(viscosity_tolerance, 1e-6, 0, 1, "1", "implicit: largest relative error of velocity")       \
  P(wall_slip, 0, 0, 1, "none|free", "do walls hold a viscous fluid, or let it slip?")          \
  P(tension, 0, 0, 1e9, "N/m", "surface tension")                                               \
  P(tension_form, 0, 0, 1, "akinci|he", "cohesion and normals, or energy of the surface")       \
  P(jitter, 0, 0, 1, "dx", "largest random displacement at the start, per axis")                \
  P(samples, 200, 1, 1e6, WHOLE, "samples of the metrics over the run, at most one per step")

enum { WALLS_LATTICE, WALLS_AKINCI };

struct scene_params {
#define P(name, initial, low, high, unit, meaning) double name;
  SCENE_PARAMS(P)
#undef P
};
/* Offsets are into struct scene_params, whose members are double (not real as in a solver's or
 * scene's own state). */
extern const struct param scene_param_rows[];
extern const int num_scene_params;

enum { MOST_FLUIDS = 8, MOST_BODIES = 8, MOST_EMITTERS = 8 };

/* A fluid of its own. */
struct scene_fluid {
  double rho0, viscosity; /* rest density [kg/m^3], dynamic viscosity [Pa s] */
};

/* A rigid body made of wall particles. */
struct scene_body {
  vec centre;     /* centre of mass, or the point that a prescribed motion turns about [m] */
  vec velocity;   /* at the start, or prescribed [m/s] */
  double spin[3]; /* angular velocity likewise; in 2-D only the last [rad/s] */
  double density; /* > 0: it moves freely; 0: its motion is prescribed [kg/m^3] */
  double period;  /* prescribed: velocity and spin times cos(2 pi t/period); 0: steady [s] */
};

/* Fluid that flows in through a slit (2-D), a rectangle or a disc (3-D): layers of particles on a
 * lattice of spacing dx across, one every dx/speed. */
struct scene_emitter {
  vec centre, direction; /* of the opening [m]; where the fluid goes, of length 1 */
  double width, depth;   /* of the opening; depth along the other axis of a rectangle in 3-D [m] */
  int round;             /* a disc of diameter `width` */
  double speed;          /* [m/s] */
  double begin, end;     /* [s] */
  int fluid;             /* number of the fluid */
};

/* A scene while it is built. Arrays grow as shapes are added; owned by the scene. */
struct scene {
  struct scene_params common;
  unsigned long long seed;
  int n, n_wall, capacity, wall_capacity;
  vec *x, *v; /* fluid [n] */
  /* walls [n_wall]: position, velocity, unit normal into the fluid */
  vec *wall_x, *wall_v, *wall_n;
  /* Several fluids; with num_fluids = 0 there is one, of common.rho0 and common.viscosity.
   * Particles from num_fluid_of on belong to fluid 0. */
  struct scene_fluid fluid[MOST_FLUIDS];
  int num_fluids, *fluid_of, num_fluid_of;
  /* Moving bodies; body_of: of a wall particle, from 1, 0 for what rests, as also from num_body_of
   * on. */
  struct scene_body body[MOST_BODIES];
  int num_bodies, *body_of, num_body_of;
  struct scene_emitter emitter[MOST_EMITTERS];
  int num_emitters;
  vec low, high; /* domain; a particle outside is lost. build sets it */
  vec period;    /* side of the periodic domain, 0 where open */
  vec gravity;   /* set from common.gravity before build; a scene may change it */
  real pull;     /* a force -pull x on the fluid, beside gravity [1/s^2] */
  int jittered;  /* scene_apply_jitter was called */
};

/* The point (x, depth, height); 2-D has no depth. Gravity points along -height. */
STAGE vec scene_at(double x, double depth, double height)
{
  vec at = zero();
  at.c[1] = (real)depth;
  at.c[DIM - 1] = (real)height;
  at.c[0] = (real)x;
  return at;
}

/* All shapes: particles sit at cell centres, origin + (k + 1/2) dx, for every cell whose centre
 * lies in the shape. Errors: ERR_MEMORY; ERR_USER past 1e9 particles or for a shape that is not
 * finite, empty or inside out. */

/* Room for so many more particles. */
status scene_reserve(struct scene *scene, double fluid, double walls);

/* Fill the box [low, high) with fluid that moves with `velocity`; returns through *first the index
 * of its first particle (NULL: not wanted). */
status scene_fill_box(struct scene *scene, vec low, vec high, vec velocity, int *first);

/* Fill where inside(self, x) holds, on the lattice through the corner `low` of the box. */
status scene_fill_where(struct scene *scene, vec low, vec high,
                        int (*inside)(const void *self, vec x), const void *self, vec velocity);
/* Fill a disc (2-D) or ball (3-D) on the lattice through its centre. */
status scene_fill_disc(struct scene *scene, vec centre, double radius, vec velocity);
/* Fill a polygon (even-odd rule) on the lattice through the low corner of its bounding box; x y
 * pairs [num_corners][2]; in 3-D extruded over z in [z_low, z_high). Polygons that share an edge
 * share no particle. */
status scene_fill_polygon(struct scene *scene, const double (*corner)[2], int num_corners,
                          double z_low, double z_high, vec velocity);
/* One particle. */
status scene_add(struct scene *scene, vec x, vec velocity);

/* A box of wall particles around [low, high): `layers` outside each face; open_top leaves the
 * highest face of the last axis open. Layer k of a face sits (k + 1/2) dx outside it; along a face
 * the spacing is side / round(side/dx). Normals point inwards (diagonal in edges and corners). */
status scene_wall_box(struct scene *scene, vec low, vec high, int layers, int open_top);

/* The number of the fluid with that rest density and viscosity, a new one if need be. Errors:
 * ERR_USER past MOST_FLUIDS. */
status scene_find_fluid(struct scene *scene, double rho0, double viscosity, int *number);

/* The fluid particles from `first` on belong to that fluid. Errors: ERR_MEMORY. */
status scene_set_fluid(struct scene *scene, int first, int fluid);

/* The fluid particles from `first` on become wall particles of a rigid body (their normals, away
 * from it, are found when a run starts). A free body's centre is set to theirs. Errors: ERR_USER
 * past MOST_BODIES or without a particle; ERR_MEMORY. */
status scene_make_body(struct scene *scene, int first, const struct scene_body *body);

/* The wall particles from `first` on move as prescribed. Errors as above. */
status scene_move_walls(struct scene *scene, int first, const struct scene_body *motion);

/* Errors: ERR_USER past MOST_EMITTERS, for an opening of no width, a speed that is not above 0. */
status scene_add_emitter(struct scene *scene, const struct scene_emitter *emitter);

/* Number of layers of wall particles that fill a support: ceil(R/dx) + 1; 1 where each wall
 * particle is weighted by the room it fills (walls = akinci). */
int scene_wall_layers(const struct scene *scene);

/* Displace the fluid by up to common.jitter dx per axis (uniform, Random123 stream of the seed and
 * the particle's number). Only the first call does: a scene whose velocities depend on the place
 * calls it before it sets them, all others are displaced after build. */
void scene_apply_jitter(struct scene *scene);

/* Set the domain to the bounding box of all particles, `margin` [m] wider on every side. */
void scene_domain_around(struct scene *scene, double margin);

/* Errors that a user can make with a scene: no particle, two particles at one place (named), a
 * place or velocity that is not finite, a fluid particle outside the domain. Two particles are at
 * one place when nearer than 1e-6 dx, or than the rounding of their coordinates, but no more than
 * dx. ERR_USER with a sentence; ERR_MEMORY. Time and memory O(particles). */
status scene_check(const struct scene *scene);

void scene_free(struct scene *scene);

#ifdef __cplusplus
}
#endif
#endif
