/* truth_drops.h - exact motions of drops that stay ellipsoids, for scenes and metrics. As truth.h:
 * without the library analysis/reference, and outside a solution's domain, everything is NaN. */
#ifndef TRUTH_DROPS_H
#define TRUTH_DROPS_H
#ifdef __cplusplus
extern "C" {
#endif

/* An affine motion at one time: a particle that started at X is at x = map X and moves with the
 * velocity v = rate x; p/rho = peak - x . bowl x. In 2-D the third rows and columns are 0. */
struct truth_affine {
  double map[3][3];  /* 1 */
  double rate[3][3]; /* 1/s */
  double peak;       /* m^2/s^2 */
  double bowl[3][3]; /* 1/s^2 */
};

/* A disc (dim = 2) or ball (3) about the origin with v = diag(strain) x at t = 0, strains of sum 0,
 * in the central force field -pull x (pull = 0: none; may be used in 3-D and, for strain[0] of
 * either sign, in 2-D). Exact in 2-D; in 3-D integrated to about 1e-13. Monaghan 1994, J. Comput.
 * Phys. 110, 399; Monaghan & Rafiee 2013, Int. J. Numer. Meth. Fluids 71, 537. */
struct truth_drop {
  int dim;
  double radius;    /* m */
  double strain[3]; /* 1/s */
  double pull;      /* 1/s^2 */
};
void truth_drop_at(const struct truth_drop *drop, double t, struct truth_affine *now);

/* Period of that drop in 2-D, pull > 0 [s]. Exact. */
double truth_drop_period(const struct truth_drop *drop);

/* An ellipse with semi-axes a along x and b along y in rotation, v = omega (y, -x) at t = 0: no
 * force, in tension. Exact; Dirichlet motion. */
void truth_spinning_ellipse_at(double a, double b, double omega, double t,
                               struct truth_affine *now);

/* A disc of that radius in rigid rotation, v = omega (y, -x). Exact, and without the library. */
void truth_spinning_disc_at(double radius, double omega, double t, struct truth_affine *now);

/* A small wave r = R + e cos(m theta), m >= 2, that starts at rest relative to such a disc: its
 * height at t over that at the start. Exact in linear theory: sqrt(cosh^2 s + sinh^2 s/(m - 1)), s
 * = sqrt(m - 1) |omega t| (from c'' - 2 i omega c' - m omega^2 c = 0 for the potential c z^m). */
double truth_spinning_disc_wave(int m, double omega, double t);

#ifdef __cplusplus
}
#endif
#endif
