/* The stages that every method shares. */
#include "run.h"

struct wrapping {
  VIEW;
  vec low, period;
};
struct pulling {
  VIEW;
  real pull;
};

STAGE void move(const struct view *s, int i) { s->p.x[i] = madd(s->p.x[i], s->dt, s->p.v[i]); }

STAGE void wrap(const struct wrapping *s, int i)
{
  for (int d = 0; d < DIM; d++)
    if (s->period.c[d] > 0)
      s->p.x[i].c[d] -= s->period.c[d] * floor((s->p.x[i].c[d] - s->low.c[d]) / s->period.c[d]);
}

STAGE void fall(const struct view *s, int i) { s->p.v[i] = madd(s->p.v[i], s->dt, s->gravity); }

/* v_i = v_i - dt pull x_i */
STAGE void fall_inwards(const struct pulling *s, int i)
{
  s->p.v[i] = madd(s->p.v[i], -s->dt * s->pull, s->p.x[i]);
}

/* rho_i = sum_j m_j W_ij */
STAGE void density(const struct view *s, int i)
{
  lanes rho = NO_LANES;
  for_neighbours (s, i, ij) rho += of(s->p.m, ij) * W(&s->nb, ij);
  s->p.rho[i] = sum(rho);
}

STAGE void volume(const struct view *s, int i) { s->p.V[i] = s->p.m[i] / s->p.rho[i]; }

/* XSPH, Monaghan 1989, J. Comput. Phys. 82, Eq. (2.6), as a coefficient per step (Schechter &
 * Bridson 2012): dv_i = c sum_j V_ij (v_j - v_i) W_ij,   V_ij = 2 V_i V_j / (V_i + V_j) = 2 m /
 * (rho_i + rho_j): symmetric, so momentum is kept; 0 on walls, so that they are free slip. Between
 * fluids times 2 light_i/(light_i + light_j), for the same reason. */
STAGE void xsph(const struct view *s, int i)
{
  vecs dv = NO_VECS;
  const real Vi = s->p.V[i];
  for_neighbours (s, i, ij) {
    const lanes Vj = of(s->p.V, ij);
    lanes share = 2 * Vi * Vj / (Vi + Vj) * W(&s->nb, ij);
    if (s->p.light) share = share * 2 * light(&s->p, i) / (light(&s->p, i) + light_of(&s->p, ij));
    dv = add(dv, scale(-share, diff(s->p.v, ij)));
  }
  s->p.dv[i] = times(s->xsph, sum(dv));
}
STAGE void add_change(const struct view *s, int i) { s->p.v[i] = plus(s->p.v[i], s->p.dv[i]); }

/* --- rigid bodies */

/* v_b = V + omega x (x_b - c) for the wall particles of bodies */
STAGE void carry(const struct carrying *s, int k)
{
  const int b = s->p.n + k, body = (int)s->p.body[b];
  if (body > 0) s->p.v[b] = body_velocity(&s->pose[body - 1], s->p.x[b]);
}

/* x_b = c + R arm_b */
STAGE void place(const struct carrying *s, int k)
{
  const int b = s->p.n + k, body = (int)s->p.body[b];
  if (body > 0) s->p.x[b] = body_point(&s->pose[body - 1], s->p.arm[b]);
}

/* What fluid particle i does to body `which` in a second, Akinci et al. 2012, Eq. (10):
 * F_i = m_i sum_b m_b (p_i/rho_i^2 + [mirrored] p_i/rho_0^2) grad_i W_ib;   here in p.dv */
STAGE void push(const struct carrying *s, int i)
{
  const struct particles p = s->p;
  vecs F = NO_VECS;
  for_neighbours (s, i, ib) {
    const lanes apart = of(p.body, ib) - (real)s->which;
    const lanes mine = at_least(1 - apart * apart, 0); /* 1 for its particles, 0 for others */
    F = add(F, scale(mine * of(p.m, ib), gradW(&s->nb, ib)));
  }
  const real over = 1 / sq(p.rho[i]) + s->mirrored / sq(s->rho0);
  p.dv[i] = times(p.m[i] * p.p[i] * over, sum(F));
}
STAGE real push_along(const struct carrying *s, int i) { return s->p.dv[i].c[s->axis]; }
/* (x_i - c) x F_i: the same torque as at x_b, since F_ib points along x_ib */
STAGE real turn_about(const struct carrying *s, int i)
{
  const int a = DIM == 2 ? 0 : (s->axis + 1) % DIM, b = DIM == 2 ? 1 : (s->axis + 2) % DIM;
  const vec arm = sub(s->p.x[i], s->pose[s->which - 1].centre), F = s->p.dv[i];
  return arm.c[a] * F.c[b] - arm.c[b] * F.c[a];
}

STAGE real speed2(const struct view *s, int i) { return inner(s->p.v[i], s->p.v[i]); }
STAGE real position_and_velocity(const struct view *s, int i)
{
  real sum = 0; /* no squares: a particle at 1e30 m is somewhere in single precision, too */
  for (int d = 0; d < DIM; d++) sum += fabs(s->p.x[i].c[d]) + fabs(s->p.v[i].c[d]);
  return sum;
}

void physics_move(struct view *s) { sweep(move, s); }

void physics_wrap(struct view *view, vec low, vec period)
{
  struct wrapping s;
  s.p = view->p;
  s.low = low;
  s.period = period;
  sweep(wrap, &s);
}

void physics_gravity(struct view *s) { sweep(fall, s); }

void physics_pull(struct view *view, real pull)
{
  struct pulling s;
  s.p = view->p;
  s.dt = view->dt;
  s.pull = pull;
  sweep(fall_inwards, &s);
}

void physics_density(struct view *s)
{
  sweep(density, s);
  if (s->p.V) sweep(volume, s);
}

void physics_viscosity(struct view *s)
{
  sweep(xsph, s);
  sweep(add_change, s);
}

static void take_view(struct carrying *s, const struct view *view)
{
  s->p = view->p;
  s->nb = view->nb;
  s->rho0 = view->rho0;
}

void physics_carry(const struct view *view, struct carrying *s)
{
  take_view(s, view);
  sweep_over(carry, s, s->p.n_all - s->p.n);
}

void physics_place(const struct view *view, struct carrying *s)
{
  take_view(s, view);
  sweep_over(place, s, s->p.n_all - s->p.n);
}

void physics_push(const struct view *view, struct carrying *s, double force[3], double torque[3])
{
  take_view(s, view);
  for (int d = 0; d < 3; d++) force[d] = torque[d] = 0;
  sweep(push, s);
  for (s->axis = 0; s->axis < DIM; s->axis++) sum_over(push_along, s, s->p.n, &force[s->axis]);
  for (s->axis = DIM == 2 ? 2 : 0; s->axis < 3; s->axis++)
    sum_over(turn_about, s, s->p.n, &torque[s->axis]);
}

void physics_health(struct view *s, double *total, double *fastest)
{
  sum_over(position_and_velocity, s, s->p.n, total);
  largest_over(speed2, s, s->p.n, fastest);
  *fastest = sqrt(*fastest);
}
