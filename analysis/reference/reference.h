/* reference.h - exact and reference solutions, in double precision.
 *
 * Every function states its unit, its error and its source. "Rounding" means a few units in the
 * last place of the largest term, measured below 1e-15 of it unless a number is given. Functions of
 * closed form return NaN for an argument outside their domain; those that integrate or read a file
 * return a status, and reference_error() then holds one sentence. Everything may be called from
 * several threads at once.
 *
 * Marks: EXACT closed form or convergent quadrature; ODE integrated here at two tolerances;
 * COMPUTED a table of this project's own high-accuracy computations; MEASURED from an experiment.
 */
#ifndef REFERENCE_H
#define REFERENCE_H
#include <stdbool.h>
#include <stddef.h>
#ifdef __cplusplus
extern "C" {
#endif

enum reference_status {
  REFERENCE_OK,
  REFERENCE_BAD_ARGUMENT,
  REFERENCE_NO_FILE,
  REFERENCE_BAD_FILE,
  REFERENCE_NO_MEMORY,
  REFERENCE_NOT_CONVERGED
};

/* One sentence on the last failure in this thread; empty if there was none. */
const char *reference_error(void);

struct reference_vec {
  double x, y;
};
struct reference_value {
  double value, error;
};
struct reference_flow {
  double u, v; /* velocity, m/s */
  double p;    /* pressure, Pa  */
};

/* ---- Rotating square patch (square_patch.c) -----------------------------------------------------
 * Side L, centre at the origin, clockwise: u = omega y, v = -omega x, free surface, no gravity.
 * Colagrossi 2005 (PhD thesis); Le Touze et al. 2013, Int. J. Numer. Meth. Fluids 73, 660.
 * Units below: lengths in L, pressures in rho omega^2 L^2, time as t omega. */

/* EXACT. Initial pressure at x = (X, Y) in L, |X|, |Y| <= 1/2. It solves lap p = 2 with p = 0 on
 * the sides. The single-series form of the double sine series, summed in closed form where it
 * converges slowly (near the corners). Error: 2e-16 absolute. */
double reference_square_patch_pressure(struct reference_vec x);

/* EXACT. Its gradient, in rho omega^2 L. Error: 1e-15 absolute. */
struct reference_vec reference_square_patch_gradient(struct reference_vec x);

/* EXACT. Mean of the initial pressure over the patch. Error: rounding. */
double reference_square_patch_mean_pressure(void);

/* EXACT. Outward normal derivative of the initial pressure at the middle of a side, in
 * rho omega^2 L: the centripetal acceleration with which the mid-edge particle starts. */
double reference_square_patch_edge_slope(void);

/* EXACT for all times. Kinetic energy per depth in rho omega^2 L^4, angular momentum about the
 * centre in rho omega L^4 (negative: clockwise), area in L^2. */
struct reference_patch_invariants {
  double kinetic_energy, angular_momentum, area;
};
struct reference_patch_invariants reference_square_patch_invariants(void);

/* State of the patch at t omega.
 *   p_centre  pressure at the centre                         COMPUTED, 0 <= t omega <= 2.4
 *   r_min     smallest distance of the surface from it, L    COMPUTED, 0 <= t omega <= 2.4
 *   r_tip     distance of the corner particle, L             EXACT (grad p = 0 at a right angle, so
 *   theta_tip polar angle of the one that starts at -45 deg  the corner flies straight on)
 * The first two are interpolated (reference_series_smooth) and NaN outside the table; their errors
 * grow from 1e-10 to 2e-4 and from 5e-9 to 1e-3 and are stated per value. */
struct reference_patch_state {
  struct reference_value p_centre, r_min;
  double r_tip, theta_tip;
};
struct reference_patch_state reference_square_patch_state(double t_omega);

/* ODE. The same by computing: the free surface as a boundary integral over `nodes` points per side
 * (16 to 512, a multiple of 4), advanced by CVODE to the rising times t_omega[count] in [0, 1.2];
 * out[count]. Every error is the largest difference so far from a second run with half of the nodes
 * and ten times the tolerance. With 128 nodes p_centre is within 1e-9 and the invariants, which are
 * not enforced, within 3e-9 up to t omega = 1. Cost: about the square of the nodes. Beyond 1.2 the
 * arms are thinner than the nodes' distance. Fails: bad arguments; GMRES's or CVODE's failure; no
 * memory. Longuet-Higgins & Cokelet 1976, Proc. R. Soc. Lond. A 350, 1, for the idea. */
struct reference_patch_instant {
  struct reference_value p_centre, r_min; /* as in struct reference_patch_state */
  double r_tip; /* distance of the node next to the corner, L: goes to that of the corner */
  struct reference_patch_invariants invariants;
  struct reference_vec *side; /* in: room for `nodes` points of the side that began at x = 1/2,
                                 anticlockwise, in L; or NULL */
};
enum reference_status reference_square_patch_evolution(int nodes, const double *t_omega, int count,
                                                       struct reference_patch_instant *out);

/* EXACT. Growth rate, in omega, of the surface mode m >= 1 of a rotating CIRCULAR disc: sqrt(m -
 * 1). From s = +-i +- sqrt(m - 1) (rotating frame) of the linearised potential problem. */
double reference_disc_growth_rate(int m);

/* ---- Impulsive pressures (impulsive.c) --------------------------------------------------------
 */

/* EXACT. Pressure over rho g H at t = 0+ of a water column suddenly released: wall x = 0, bed y =
 * 0, free at x = width and y = height (m). lap p = 0, p_x(0, y) = 0, p_y(x, 0) = -rho g. x inside
 * the column. Error: 1e-15 absolute. Derived from separation of variables. */
struct reference_column {
  double width, height; /* m */
};
double reference_dambreak_pressure(struct reference_column c, struct reference_vec x);

/* EXACT. Its gradient over rho g, -(du/dt) / g - (0, 1) at t = 0+. Infinite at (width, 0), where it
 * is logarithmic. Error: 1e-14 of the larger of 1 and the value. */
struct reference_vec reference_dambreak_gradient(struct reference_column c, struct reference_vec x);

/* EXACT. Normal impact of two equal blocks (or of one on a frictionless wall), each as wide as L
 * along the contact line y = 0, |x| <= L/2, and H high, 0 <= y <= H, with normal velocity -U in
 * y > 0. Pressure-impulse theory, cf. Marrone et al. 2015, J. Fluids Struct. 54, 802.
 * impulse: Pi / (rho U L) at x; gradient: grad Pi / (rho U), so that u+ = u- - U gradient.
 * c.width = L, c.height = H, x in m. Error: 1e-15 absolute. The gradient is infinite at the contact
 * line's ends. */
double reference_impact_impulse(struct reference_column c, struct reference_vec x);
struct reference_vec reference_impact_gradient(struct reference_column c, struct reference_vec x);

/* EXACT. Fraction of the kinetic energy lost in that impact, aspect = H/L > 0. Error: 2e-16.
 * The series (1/h) sum_odd 8/(n pi)^3 tanh(n pi h), with 7 zeta(3)/pi^3 taken out of it and, below
 * h = 1/2, the identity loss(h) + loss(1/(4h)) = 1. */
double reference_impact_energy_loss(double aspect);

/* ---- Drops (drops.c: quadratures; affine.c: ODE) ------------------------------------------------
 */

/* An ellipse with axes along x and y: x = diag(a, b) X, |X| <= 1, pressure
 * pc (1 - x^2/a^2 - y^2/b^2). */
struct reference_ellipse {
  double a, b;        /* semi-axes, m           */
  double adot, bdot;  /* their rates, m/s       */
  double pc_over_rho; /* centre pressure, m2/s2 */
};

/* EXACT. Elliptical drop: unit circle with u = -A0 x, v = A0 y (A0 in 1/s) at t (s), no force.
 * From b = e^s, A0 t = int_0^s sqrt(cosh 2s) ds. Relative error 2e-15. For a circle of radius R
 * multiply lengths by R and pc by R^2. Monaghan 1994, J. Comput. Phys. 110, 399. */
struct reference_ellipse reference_elliptical_drop(double A0, double t);

/* EXACT. Oscillating drop in the central field f = -B^2 r: unit circle with u = A0 x, v = -A0 y
 * (A0 >= 0, B > 0 in 1/s). From a = e^s, sinh s = A0/(sqrt2 B) sin q and
 * sqrt2 B t = int_0^q sqrt((1 + A0^2/B^2 sin^2 q)/(1 + A0^2/(2B^2) sin^2 q)) dq.
 * Relative error 4e-15 in the first periods, then growing as t/T times rounding. Monaghan & Rafiee
 * 2013, Int. J. Numer. Meth. Fluids 71, 537, App. A. period: in s; largest: the largest semi-axis.
 */
struct reference_field_drop {
  double A0, B; /* 1/s */
};
struct reference_ellipse reference_oscillating_drop(struct reference_field_drop d, double t);
double reference_oscillating_drop_period(struct reference_field_drop d);
double reference_oscillating_drop_largest(struct reference_field_drop d);

/* EXACT. Rotating elliptical patch: semi-axes a0, b0 (m) along x, y, u = omega y, v = -omega x,
 * no force; the fluid is in tension (pc < 0) at all times. x = F X, |X| <= 1.
 * F = R(alpha) diag(a, b) R(beta) with both angular momenta integrated; one quadrature in time, two
 * for the angles. Relative error 4e-15 up to t omega = 4. Derived here (Dirichlet motion). */
struct reference_spinning_ellipse {
  double a0, b0; /* m   */
  double omega;  /* 1/s */
};
struct reference_rotated_ellipse {
  double F[2][2], Fdot[2][2]; /* m, m/s                                        */
  double a, b;                /* semi-axes that started along x and y, m       */
  double alpha;               /* angle of axis a from x, anticlockwise, rad    */
  double pc_over_rho;         /* p = pc (1 - |F^-1 x|^2); m2/s2                */
};
struct reference_rotated_ellipse reference_rotating_ellipse(
  const struct reference_spinning_ellipse *e, double t);

/* ODE. Free ellipsoid (dim = 2 or 3) with axes along the coordinates in the central field -B^2 x:
 *   a_i'' = 2 P/a_i - B^2 a_i,  P = pc/rho = (sum (a_i'/a_i)^2 + dim B^2) / (2 sum 1/a_i^2)
 * CVODE Adams at relative tolerances 1e-13 and 1e-15; the tighter run is returned and error is the
 * largest difference of the two in a, relative to the largest a. In every comparison with an exact
 * solution (up to 100 periods) it was above the true error, ten times or more; the true one is near
 * 1e-13 for a few strain times. Derived here.
 * start: dim, B, a (m, > 0), adot (m/s, sum adot_i/a_i = 0) are read; end gets everything.
 * Fails: bad arguments; CVODE's failure. */
struct reference_axes {
  int dim;
  double B;             /* 1/s     */
  double a[3], adot[3]; /* m, m/s  */
  double pc_over_rho;   /* m2/s2   */
  double error;         /* of a, relative: difference of two tolerances          */
  double defect;        /* largest relative change of volume and of energy       */
};
enum reference_status reference_axes_flow(const struct reference_axes *start, double t,
                                          struct reference_axes *end);

/* ODE. The same for any affine motion x = F X, |X| <= 1, rotation included:
 *   F'' = 2 P F^-T - B^2 F,  2 P = (tr((F' F^-1)^2) + dim B^2) / |F^-1|^2,
 *   p = pc (1 - |F^-1 x|^2), pc = rho P, of either sign.
 * start: dim, B, F (det > 0), Fdot with tr(F' F^-1) = 0. Otherwise as reference_axes_flow. */
struct reference_affine {
  int dim;
  double B;                   /* 1/s    */
  double F[3][3], Fdot[3][3]; /* m, m/s */
  double pc_over_rho;         /* m2/s2  */
  double error, defect;
};
enum reference_status reference_affine_flow(const struct reference_affine *start, double t,
                                            struct reference_affine *end);

/* ---- Shallow water (shallow_water.c) ------------------------------------------------------------
 */

struct reference_shallow {
  double h, u; /* depth m, velocity m/s */
};

/* EXACT within shallow-water theory. Dam break on a dry bed: depth h0 (m) in x < 0 at t = 0, t > 0.
 * Ritter 1892. */
struct reference_dry_bed {
  double h0, g; /* m, m/s2 */
};
struct reference_shallow reference_ritter(struct reference_dry_bed d, double x, double t);

/* EXACT within shallow-water theory. Dam break on a wet bed, hl > hr > 0 (m). Stoker 1957.
 * states: the constant state between rarefaction and bore, and the speeds (m/s) of the bore, of
 * the rarefaction's tail and of its head. Relative error 1e-15. */
struct reference_wet_bed {
  double hl, hr, g; /* m, m, m/s2 */
};
struct reference_stoker_states {
  double hm, um, bore, tail, head;
};
struct reference_stoker_states reference_stoker_states(const struct reference_wet_bed *w);
struct reference_shallow reference_stoker(const struct reference_wet_bed *w, double x, double t);

/* ---- Periodic, walled and wave flows (flows.c) --------------------------------------------------
 */

/* EXACT. Taylor-Green vortices in a periodic square of side L, Re = U L/nu:
 * u = -U e^bt cos 2pi x/L sin 2pi y/L, v = U e^bt sin 2pi x/L cos 2pi y/L,
 * p = -(rho U^2/4) e^2bt (cos 4pi x/L + cos 4pi y/L), b = -8 pi^2 nu/L^2. Taylor & Green 1937. */
struct reference_taylor_green {
  double U, L, nu, rho; /* m/s, m, m2/s, kg/m3 */
};
struct reference_flow reference_taylor_green(const struct reference_taylor_green *f,
                                             struct reference_vec x, double t);
double reference_taylor_green_decay(const struct reference_taylor_green *f, double t); /* e^bt */

/* EXACT. Start-up flow between plates y = 0 and y = L from rest: by the body force F (m/s2), and by
 * the upper plate moving at V0 (m/s). Velocity in m/s. Error: 1e-15 of F L^2/(8 nu) and of V0.
 * Morris, Fox & Zhu 1997, J. Comput. Phys. 136, 214. */
struct reference_channel {
  double L, nu; /* m, m2/s */
  double drive; /* F in m/s2 for Poiseuille, V0 in m/s for Couette */
};
double reference_poiseuille(const struct reference_channel *c, double y, double t);
double reference_couette(const struct reference_channel *c, double y, double t);

/* EXACT. Gresho vortex, rho = 1, radius 0.4, peak speed 1 at r = 0.2; steady. r in m.
 * v_phi in m/s; pressure with p0 at the centre; kinetic energy 2 pi/75 and angular momentum per
 * depth. Gresho & Chan 1990, Int. J. Numer. Meth. Fluids 11, 621. */
double reference_gresho_velocity(double r);
double reference_gresho_pressure(double r, double p0);
double reference_gresho_kinetic_energy(void);
double reference_gresho_angular_momentum(void);

/* EXACT. Hydrostatic pressure (Pa) at height y (m) of a column of height H; 0 above it. */
struct reference_liquid {
  double rho, g; /* kg/m3, m/s2 */
};
double reference_hydrostatic(struct reference_liquid l, double H, double y);

/* EXACT, linear waves. Angular frequency (1/s) of a wave of wavenumber k (1/m) on depth H (m), the
 * period of the standing wave, and that of sloshing mode n >= 1 in a tank of length L. */
struct reference_pool {
  double depth, g; /* m, m/s2 */
};
double reference_wave_frequency(struct reference_pool p, double k);
double reference_standing_wave_period(struct reference_pool p, double wavelength);
double reference_sloshing_period(struct reference_pool p, double L, int n);

/* EXACT. Free fall x0 + v0 t + g t^2/2 and what symplectic Euler gives after n steps of size dt:
 * x0 + n dt v0 + g dt^2 n (n + 1)/2. */
struct reference_fall {
  double x0, v0, g; /* m, m/s, m/s2 */
};
double reference_free_fall(const struct reference_fall *f, double t);
double reference_free_fall_steps(const struct reference_fall *f, double dt, int n);

/* ---- Particle systems (lattice.c) ---------------------------------------------------------------
 */

/* W, W' and W'' of a 1-D kernel at r >= 0 with smoothing length h, into w[3]. */
typedef void reference_kernel(double r, double h, double w[3]);

/* The cubic spline in 1-D, support 2h, integral 1. Monaghan & Lattanzio 1985. */
void reference_cubic_spline_1d(double r, double h, double w[3]);

/* EXACT. Linear sound waves on an infinite 1-D lattice of spacing dx and mass m with the
 * variational equation of state p(rho): omega^2 (negative: growth) at wavenumber k, (c2 - 2
 * p0/rho0) S^2/rho0^2 + (2 m p0/rho0^2) sum_j W''(r_j)(1 - cos k r_j), S = m sum_j W'(r_j) sin k
 * r_j,  rho0 = m sum_j W(r_j). c2 = dp/drho and p0 = p at rho0. Error: rounding. Derived here by
 * linearising the equations. */
struct reference_lattice {
  double dx, m, h, support; /* spacing, mass, smoothing length, radius of the support */
  double c2, p0;
  reference_kernel *kernel;
};
double reference_lattice_density(const struct reference_lattice *l);
double reference_lattice_omega2(const struct reference_lattice *l, double k);

/* EXACT. Two particles, m = h = c = 1, 3-D cubic spline (support 2), rho = W(0) + W(r),
 * p = rho - rho0, rho0 the density at r = 1, released at rest at r_start < 1: a bound orbit with
 * r'^2/4 + 2 (ln(rho/rho0) + rho0/rho - 1) = const. From one quadrature, cut at the spline's knot.
 * orbit: rho0, the largest distance and the period (NaN if the pair is not bound); at: r and r' at
 * time t. Error: 1e-14 in the first periods. Derived here. */
struct reference_orbit {
  double r_start, r_max, rho0, period;
};
struct reference_orbit reference_two_particle_orbit(double r_start);
struct reference_motion {
  double r, rdot;
};
struct reference_motion reference_two_particle_motion(const struct reference_orbit *o, double t);

/* ODE. n particles of mass m with the density rho_i = m sum_j W(r_ij), itself included, and
 * p_i = rho0_i c^2/gamma ((rho_i/rho0_i)^gamma - 1) of either sign, free of other forces:
 *   x_i'' = -m sum_j (p_i/rho_i^2 + p_j/rho_j^2) grad_i W_ij
 * x[n][dim] and v[n][dim] at 0 are replaced by those at t; lengths and speeds of order 1. Double
 * loops; CVODE at 1e-12 and 1e-14, whose largest difference in x or v is *error. Conserves the
 * energy sum m (v^2/2 + u(rho)), du/drho = p/rho^2. Fails: bad arguments; CVODE; no memory. */
struct reference_particles {
  int n, dim;
  double m, c, gamma, support;
  const double *rho0;                                /* [n] */
  void (*kernel)(double r, double w[2], void *user); /* W and W' at 0 <= r < support */
  void *user;
};
enum reference_status reference_particle_flow(const struct reference_particles *p, double t,
                                              double *x, double *v, double *error);

/* ---- Referees: systems solved by other people's programs (algebra.c, nonlinear.c) ---------------
 */

/* y = A x for any x[n]; A symmetric and positive definite. */
struct reference_system {
  int n;
  void (*apply)(const double *x, double *y, void *user);
  void *user;
};

/* x[n] = A^-1 b by LAPACK's Cholesky factors of the matrix written out, n <= 5000, with one step of
 * refinement: what an iteration on the same system converges to.
 * asymmetry: largest |A_ij - A_ji| over the largest |A_ij|; residual: |b - A x|/|b|.
 * Fails: n out of range, asymmetry >= 1e-6; not positive definite; no memory. */
struct reference_dense {
  double asymmetry, residual;
};
enum reference_status reference_dense_solve(const struct reference_system *s, const double *b,
                                            double *x, struct reference_dense *quality);

/* The same by SUNDIALS' SUNLinSol_PCG from x as it is, with Jacobi's preconditioner, until |r| <=
 * tolerance |b|. Fails: not converged (x and iterations are what was reached); no memory. */
struct reference_pcg {
  const double *diagonal; /* [n] */
  double tolerance;
  int max_iterations, iterations; /* iterations: those used */
};
enum reference_status reference_pcg_solve(const struct reference_system *s, const double *b,
                                          double *x, struct reference_pcg *how);

/* By SUNDIALS' KINSOL from x[n] as it is, in units in which x and f are of order 1:
 * x = f(x) by iteration with Anderson's acceleration over `history` steps, until the last change is
 * below tolerance; f(x) = 0 by Newton's method with a line search and GMRES over `history` vectors,
 * until max |f| is. Fails: not converged (x is what was reached). */
struct reference_equations {
  int n;
  void (*function)(const double *x, double *f, void *user);
  void *user;
  double tolerance;
  int max_iterations, history;
};
enum reference_status reference_fixed_point(const struct reference_equations *e, double *x,
                                            int *iterations);
enum reference_status reference_newton_krylov(const struct reference_equations *e, double *x,
                                              int *iterations);

/* ---- Series and tables (series.c, tables.c, table_data.c) ---------------------------------------
 */

/* A function given by points with rising x; error[i] is the absolute error of y[i] (NULL: unknown).
 * even: the function is even and x[0] = 0, so points may be mirrored. */
struct reference_series {
  const char *x_name, *y_name, *source;
  int count;
  const double *x, *y, *error;
  bool even;
};

/* Linear interpolation, for measured points. NaN outside [x[0], x[count - 1]]. */
double reference_series_linear(const struct reference_series *s, double x);

/* Polynomial through the six nearest points (all, if fewer), for smooth computed curves. Its error
 * is that of the points, weighted, plus the difference from the four-point cubic: an over-estimate.
 * NaN outside the points. */
struct reference_value reference_series_smooth(const struct reference_series *s, double x);

/* COMPUTED: square_patch_evolution.csv, against t omega. */
const struct reference_series *reference_square_patch_p_centre(void);
const struct reference_series *reference_square_patch_r_min(void);

/* MEASURED: collapse of a column a wide and 2a high, a = 0.05715 m; error: half of the last digit
 * printed. Martin & Moyce 1952, Phil. Trans. R. Soc. Lond. A 244, 312-324, Tables 2 and 6.
 * front: Z = z/a against T = t sqrt(2 g/a); height: Hn = height/(2a) against tau = t sqrt(g/a). */
const struct reference_series *reference_martin_moyce_front(void);
const struct reference_series *reference_martin_moyce_height(void);

/* A numeric CSV file: lines starting with # and empty lines are skipped, then a line of names, then
 * rows of finite numbers. values is [rows][columns]. Free with reference_table_free, which also
 * accepts a zeroed or already freed table. Fails: no file; a row of another length or with
 * something that is no number; no row; no memory. */
struct reference_table {
  int rows, columns;
  char **names;
  double *values;
  char *text; /* owns the names */
};
enum reference_status reference_table_read(const char *path, struct reference_table *table);
void reference_table_free(struct reference_table *table);

/* Index of the column with this name, or -1. */
int reference_table_column(const struct reference_table *table, const char *name);

/* Linear interpolation of column y at the value x of the rising column x_column. NaN outside. */
struct reference_columns {
  int x, y;
};
double reference_table_at(const struct reference_table *table, struct reference_columns c,
                          double x);

/* A closed polygon, anticlockwise or clockwise, the last point joined to the first; read from the
 * columns x and y of a CSV file (data/square_patch_outline_*.csv). Free as a table. */
struct reference_outline {
  int count;
  struct reference_vec *points;
};
enum reference_status reference_outline_read(const char *path, struct reference_outline *outline);
void reference_outline_free(struct reference_outline *outline);

/* True inside (odd number of crossings); on the polygon itself either answer is possible. */
bool reference_outline_contains(const struct reference_outline *outline, struct reference_vec p);

/* Signed area (anticlockwise positive) and the distance of a point from the polygon. */
double reference_outline_area(const struct reference_outline *outline);
double reference_outline_distance(const struct reference_outline *outline, struct reference_vec p);

#ifdef __cplusplus
}
#endif
#endif
