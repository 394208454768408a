/* Periodic, walled and wave flows of closed form. */
#include "internal.h"

double reference_taylor_green_decay(const struct reference_taylor_green *f, double t)
{
  return exp(-8 * sq(PI / f->L) * f->nu * t);
}

struct reference_flow reference_taylor_green(const struct reference_taylor_green *f,
                                             struct reference_vec x, double t)
{
  const double k = 2 * PI / f->L, U = f->U * reference_taylor_green_decay(f, t);
  return (struct reference_flow){
    .u = -U * cos(k * x.x) * sin(k * x.y),
    .v = U * sin(k * x.x) * cos(k * x.y),
    .p = -f->rho * sq(U) / 4 * (cos(2 * k * x.x) + cos(2 * k * x.y)),
  };
}

static bool in_channel(const struct reference_channel *c, double y, double t)
{
  return c->L > 0 && c->nu > 0 && y >= 0 && y <= c->L && t >= 0;
}

/* u = F/(2 nu) y (L - y) - sum_{n odd} 4 F L^2/(nu (n pi)^3) sin(n pi y/L) e^(-nu (n pi/L)^2 t) */
double reference_poiseuille(const struct reference_channel *c, double y, double t)
{
  if (!in_channel(c, y, t)) return NAN;
  if (t == 0) return 0;
  const double s = y / c->L, tau = c->nu * t / sq(c->L);
  double sum = 0;
  /* Stop where the exponential, or else 1/n^3, has sunk below rounding. */
  for (int n = 1; sq(n * PI) * tau < 45 && n < 200001; n += 2)
    sum += 4 / (sq(n * PI) * n * PI) * sin(n * PI * s) * exp(-sq(n * PI) * tau);
  return c->drive * sq(c->L) / c->nu * (s * (1 - s) / 2 - sum);
}

/* u/V0 = y/L + sum_n 2/(n pi) (-1)^n sin(n pi y/L) e^(-nu (n pi/L)^2 t), or for short times the
 * images of a plate in unbounded fluid: sum_k erfc((2k+1 - y/L)/2q) - erfc((2k+1 + y/L)/2q),
 * q = sqrt(nu t)/L. */
double reference_couette(const struct reference_channel *c, double y, double t)
{
  if (!in_channel(c, y, t)) return NAN;
  const double s = y / c->L, tau = c->nu * t / sq(c->L);
  if (t == 0) return y < c->L ? 0 : c->drive;
  double u = 0;
  if (tau < 0.1) {
    const double q = 2 * sqrt(tau);
    for (int k = 1; k <= 5; k += 2) u += erfc((k - s) / q) - erfc((k + s) / q);
    return c->drive * u;
  }
  for (int n = 1; sq(n * PI) * tau < 45; n++)
    u += (n % 2 ? -2 : 2) / (n * PI) * sin(n * PI * s) * exp(-sq(n * PI) * tau);
  return c->drive * (s + u);
}

double reference_gresho_velocity(double r)
{
  if (!(r >= 0)) return NAN;
  return r < 0.2 ? 5 * r : r < 0.4 ? 2 - 5 * r : 0;
}

double reference_gresho_pressure(double r, double p0)
{
  if (!(r >= 0)) return NAN;
  if (r < 0.2) return p0 + 12.5 * sq(r);
  if (r < 0.4) return p0 + 4 + 12.5 * sq(r) - 20 * r + 4 * log(5 * r);
  return p0 - 2 + 4 * log(2.0);
}

double reference_gresho_kinetic_energy(void) { return 2 * PI / 75; }

/* 2 pi int v r^2 dr = 2 pi (0.002 + 0.022/3) */
double reference_gresho_angular_momentum(void) { return 2 * PI * 0.028 / 3; }

double reference_hydrostatic(struct reference_liquid l, double H, double y)
{
  return y < H ? l.rho * l.g * (H - y) : y >= H ? 0 : NAN;
}

double reference_wave_frequency(struct reference_pool p, double k)
{
  return p.depth > 0 && p.g > 0 && k > 0 ? sqrt(p.g * k * tanh(k * p.depth)) : NAN;
}

double reference_standing_wave_period(struct reference_pool p, double wavelength)
{
  return 2 * PI / reference_wave_frequency(p, 2 * PI / wavelength);
}

double reference_sloshing_period(struct reference_pool p, double L, int n)
{
  return 2 * PI / reference_wave_frequency(p, n * PI / L);
}

double reference_free_fall(const struct reference_fall *f, double t)
{
  return f->x0 + f->v0 * t + f->g * t * t / 2;
}

double reference_free_fall_steps(const struct reference_fall *f, double dt, int n)
{
  return f->x0 + n * dt * f->v0 + f->g * dt * dt * ((double)n * (n + 1.0) / 2);
}
