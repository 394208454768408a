/* truth_flows.h - exact periodic, walled and wave flows, for scenes and metrics. As truth.h: NaN
 * without the library analysis/reference and outside a solution's domain. */
#ifndef TRUTH_FLOWS_H
#define TRUTH_FLOWS_H
#ifdef __cplusplus
extern "C" {
#endif

/* Velocity [m/s] and p/rho [m^2/s^2] at a place. */
struct truth_flow {
  double u, v, p;
};

/* Taylor-Green vortices of peak speed U in a periodic square of side L, kinematic viscosity nu (0:
 * they stay). Exact. Taylor & Green 1937, Proc. R. Soc. Lond. A 158, 499. */
struct truth_vortices {
  double U, L, nu; /* m/s, m, m^2/s */
};
struct truth_flow truth_taylor_green(const struct truth_vortices *f, double x, double y, double t);

/* Gresho's vortex about the origin: peak speed U at half of the radius R. Exact, steady; p is 0 at
 * the centre. Gresho & Chan 1990, Int. J. Numer. Meth. Fluids 11, 621. */
struct truth_flow truth_gresho(double U, double R, double x, double y);

/* Angular frequency [1/s] of a linear wave of wavenumber k [1/m] on water of that depth [m].
 * Exact. Lamb 1932, Hydrodynamics, sec. 228. */
double truth_wave_frequency(double depth, double g, double k);

/* Start from rest of the flow between plates at y = 0 and y = gap, driven by a body force [m/s^2]
 * or by the upper plate [m/s]: the velocity. Exact. Morris, Fox & Zhu 1997, J. Comput. Phys. 136,
 * 214. */
struct truth_channel {
  double gap, nu, drive; /* m, m^2/s, m/s^2 or m/s */
};
double truth_poiseuille(const struct truth_channel *c, double y, double t);
double truth_couette(const struct truth_channel *c, double y, double t);

#ifdef __cplusplus
}
#endif
#endif
