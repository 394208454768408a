/* forces.h - viscosity and surface tension as stages that every method shares (viscosity.c,
 * tension.c); compiled for the variant's machine. */
#ifndef FORCES_H
#define FORCES_H
#include "../linear/cg.h"
#include "../solver.h"
#ifdef __cplusplus
extern "C" {
#endif

enum viscosity_form { VISCOSITY_EXPLICIT, VISCOSITY_IMPLICIT };
enum viscosity_pairs { VISCOSITY_CENTRAL, VISCOSITY_FULL };
enum wall_slip { WALL_SLIP_NONE, WALL_SLIP_FREE };

struct viscosity {
  real mu;   /* dynamic viscosity of the one fluid; several have p.mu [Pa s] */
  int pairs; /* enum viscosity_pairs */
  int slip;  /* enum wall_slip */
};

/* v += dt F/m with the viscous forces F of the velocities now: stable on a lattice for mu dt/(rho
 * dx^2) below 0.14, 0.19, 0.25 at R = 2, 2.5, 3 dx; full: below 0.32, 0.47, 0.65. Needs p.m, V, dv.
 */
void viscosity_explicit(const struct view *view, struct viscosity viscosity);

/* v += dt F/m with those of the velocities at the end. Needs besides p.mu_dir, mu_op, mu_diag, and
 * `coef` with room for the slots of view->nb. */
struct cg_result viscosity_implicit(const struct view *view, struct viscosity viscosity, real *coef,
                                    double tolerance, int max_iterations);

enum tension_form { TENSION_AKINCI, TENSION_HE };

/* How strong the forces of a form must be for a tension. */
struct tension {
  int form;      /* enum tension_form */
  real cohesion; /* Akinci: on the spline [m/s^2 per kg of neighbour] */
  real normals;  /* Akinci: on differences of normals [m/s^2] */
  real energy;   /* He: kappa of the energy kappa/2 |grad c|^2 [N] */
};

/* Strengths for a surface tension sigma [N/m] of particles of mass m on a lattice of spacing dx. */
struct tension tension_make(int form, double sigma, const struct kernel *kernel, double dx,
                            double mass);

/* v += dt F/m. Needs p.m, V, dv, slant; He: and colour. */
void tension_apply(const struct view *view, struct tension tension);

#ifdef __cplusplus
}
#endif
#endif
