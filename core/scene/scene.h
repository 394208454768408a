/* scene.h - building a scene: parameters common to all scenes, and shapes filled with particles. */
#ifndef SCENE_H
#define SCENE_H
#include "../base/param.h"
#include "../base/status.h"
#include "../sph/kernels.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Parameters that every scene has. P(name, default, low, high, unit, meaning); a scene sets its own defaults. */
#define SCENE_PARAMS(P)                                                                                     \
  P(spacing, 0.01, 1e-9, 1e6, "m", "particle spacing dx at the start")                                      \
  P(dt, 1e-3, 1e-12, 1e6, "s", "time step")                                                                 \
  P(t_end, 1, 0, 1e9, "s", "end of the simulated time")                                                     \
  P(support, 2.5, 1.05, 10, "dx", "support radius R of the kernel, in particle spacings")                   \
  P(kernel, 0, 0, 3, KERNEL_CHOICES, "smoothing kernel")                                                    \
  P(rho0, 1000, 1e-6, 1e9, "kg/m^3", "rest density")                                                        \
  P(gravity, 9.81, 0, 1e6, "m/s^2", "gravity, along -y in 2-D and -z in 3-D")                               \
  P(xsph, 0, 0, 1, "1", "XSPH coefficient per step (its dissipation grows as 1/dt)")                        \
  P(jitter, 0, 0, 1, "dx", "largest random displacement of the fluid at the start, per axis")               \
  P(samples, 200, 1, 1e6, "1", "number of samples of the metrics over the run, at most one per step")

struct scene_params {
#define P(name, initial, low, high, unit, meaning) double name;
  SCENE_PARAMS(P)
#undef P
};
extern const struct param scene_param_rows[]; /* offsets into scene_params; values are double */
extern const int num_scene_params;

/* A scene while it is built. Arrays grow as shapes are added; owned by the scene. */
struct scene {
  struct scene_params common;
  unsigned long long seed;
  int n, n_wall, capacity, wall_capacity;
  vec *x, *v;            /* fluid [n] */
  vec *wall_x, *wall_v, *wall_n; /* walls [n_wall]: position, velocity, unit normal into the fluid */
  vec low, high;         /* domain; a particle outside is lost. build sets it */
  vec period;            /* side of the periodic domain, 0 where open */
  vec gravity;           /* set from common.gravity before build; a scene may change it */
};

/* All shapes: particles sit at cell centres, origin + (k + 1/2) dx. Errors: ERR_MEMORY, or ERR_USER past 1e9 particles. */

/* Fill the box [low, high) with fluid that moves with `velocity`; returns through *first the index of its first particle
 * (NULL: not wanted). */
status scene_fill_box(struct scene *scene, vec low, vec high, vec velocity, int *first);

/* Fill where inside(self, x) holds, on the lattice through the corner `low` of the box [low, high). */
status scene_fill_where(struct scene *scene, vec low, vec high, int (*inside)(const void *self, vec x), const void *self,
                        vec velocity);
/* Fill a disc (2-D) or ball (3-D) on the lattice through its centre. */
status scene_fill_disc(struct scene *scene, vec centre, double radius, vec velocity);
/* Fill a simple polygon, x y pairs [num_corners][2]; in 3-D extruded over z in [z_low, z_high). */
status scene_fill_polygon(struct scene *scene, const double (*corner)[2], int num_corners, double z_low, double z_high,
                          vec velocity);
/* One particle. */
status scene_add(struct scene *scene, vec x, vec velocity);

/* A box of wall particles around [low, high): `layers` outside each face; open_top leaves the highest face of the last
 * axis open. Layer k of a face sits (k + 1/2) dx outside it. Normals point inwards (diagonal in edges and corners). */
status scene_wall_box(struct scene *scene, vec low, vec high, int layers, int open_top);

/* Number of layers of wall particles that fill a support: ceil(R/dx) + 1. */
int scene_wall_layers(const struct scene *scene);

/* Displace the fluid by up to common.jitter dx per axis (uniform, Random123 stream of the seed and the particle's number). */
void scene_apply_jitter(struct scene *scene);

/* Errors that a user can make with a scene: no particle, two particles at one place (named), a particle that is not finite
 * or outside the domain. ERR_USER with a sentence. */
status scene_check(const struct scene *scene);

void scene_free(struct scene *scene);

#ifdef __cplusplus
}
#endif
#endif
