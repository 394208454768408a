#include "../truth_flows.h"

#include <math.h>

#ifdef SPHBENCH_HAVE_REFERENCE
#include "../reference/reference.h"

struct truth_flow truth_taylor_green(const struct truth_vortices *f, double x, double y, double t)
{
  const struct reference_taylor_green vortices = {f->U, f->L, f->nu, 1};
  const struct reference_vec at = {x, y};
  const struct reference_flow flow = reference_taylor_green(&vortices, at, t);
  return (struct truth_flow){flow.u, flow.v, flow.p};
}

struct truth_flow truth_gresho(double U, double R, double x, double y)
{
  const double scale = 0.4 / R, r = scale * sqrt(x * x + y * y);
  const double turn = r > 0 ? U * reference_gresho_velocity(r) * scale / r : 0;
  return (struct truth_flow){-turn * y, turn * x, U * U * reference_gresho_pressure(r, 0)};
}

double truth_wave_frequency(double depth, double g, double k)
{
  const struct reference_pool pool = {depth, g};
  return reference_wave_frequency(pool, k);
}

double truth_poiseuille(const struct truth_channel *c, double y, double t)
{
  const struct reference_channel channel = {c->gap, c->nu, c->drive};
  return reference_poiseuille(&channel, y, t);
}

double truth_couette(const struct truth_channel *c, double y, double t)
{
  const struct reference_channel channel = {c->gap, c->nu, c->drive};
  return reference_couette(&channel, y, t);
}

#else

static const struct truth_flow no_flow = {(double)NAN, (double)NAN, (double)NAN};

struct truth_flow truth_taylor_green(const struct truth_vortices *f, double x, double y, double t)
{
  return (void)f, (void)x, (void)y, (void)t, no_flow;
}
struct truth_flow truth_gresho(double U, double R, double x, double y)
{
  return (void)U, (void)R, (void)x, (void)y, no_flow;
}
double truth_wave_frequency(double depth, double g, double k)
{
  return (void)depth, (void)g, (void)k, (double)NAN;
}
double truth_poiseuille(const struct truth_channel *c, double y, double t)
{
  return (void)c, (void)y, (void)t, (double)NAN;
}
double truth_couette(const struct truth_channel *c, double y, double t)
{
  return (void)c, (void)y, (void)t, (double)NAN;
}
#endif
