/* truth.h - what scenes and metrics compare with. A thin layer over analysis/reference (GSL,
 * SUNDIALS), which a build may lack: then, and outside a solution's domain, every function returns
 * NaN and truth_front_points none. */
#ifndef TRUTH_H
#define TRUTH_H
#ifdef __cplusplus
extern "C" {
#endif

/* Rotating square patch of side L about the origin, u = omega y, v = -omega x; lengths in L,
 * pressures in rho omega^2 L^2. Colagrossi 2005; Le Touze et al. 2013. */

/* Initial pressure at (x, y) and its gradient. Exact. */
double truth_patch_pressure(double x, double y);
void truth_patch_gradient(double x, double y, double gradient[2]);

/* At t omega up to 2.4: pressure at the centre; smallest distance of the surface from the centre.
 * Computed. */
double truth_patch_centre(double t_omega);
double truth_patch_mid_edge(double t_omega);

/* At t omega up to 2: the distance from the centre beyond which lies 0.1 % of the fluid. From the
 * exact path of the corner, (1/sqrt 2) sqrt(1 + (t omega)^2), times the ratio of the two in the
 * computed outlines at t omega = 0, 0.5, 1, 1.5, 2; their arms are cut where thinner than 0.015,
 * which leaves an error of about 0.01. Does not need the library. */
double truth_patch_tip(double t_omega);

/* Pressure over rho g H, at t = 0+, of a column of water with one wall at x = 0 and the bed at y =
 * 0 [m]. Exact. */
double truth_column_pressure(double width, double height, double x, double y);

/* Fraction of the kinetic energy that two equal blocks lose in a normal impact: width along the
 * contact, height normal to it, depth along it in 3-D (0: 2-D) [m]. Exact; the 3-D double series is
 * summed here to about 1e-6. */
double truth_impact_loss(double width, double height, double depth);

/* Front of a column a wide and 2a high: Z = z/a against T = t sqrt(2 g/a), rising. Returns the
 * number of points. Martin & Moyce 1952, Table 2. */
int truth_front_points(const double **T, const double **Z);

#ifdef __cplusplus
}
#endif
#endif
