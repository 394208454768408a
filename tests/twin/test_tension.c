/* Surface tension against its formulas by double loops (Akinci et al. 2013; He et al. 2014), the
 * tension of a flat surface, conservation laws, and drops. */
#include "twin_forces.h"

enum { SIDE = DIM == 3 ? 6 : 13 };
enum { AKINCI, HE };

/* (1-q)^3 q^3, below 1/2: 2 (1-q)^3 q^3 - 1/64 */
static double spline(double q)
{
  const double a = pow((1 - q) * q, 3);
  return q >= 1 ? 0 : q > 0.5 ? a : 2 * a - 1.0 / 64;
}

/* --- the tension of a slab of the lattice, surfaces at both ends */

struct slab {
  const struct cloud *c; /* its kernel, dx and mass */
  int form, layers, wide;
  double rho[64], colour[64], slant[64];
};

/* The neighbour of particle (0, .., i) that lies `a`, `b` columns beside it in layer j. */
static double slab_distance(const struct slab *s, int i, int j, int a, int b)
{
  return s->c->dx * sqrt((double)(a * a + b * b + (i - j) * (i - j)));
}
#define FOR_SLAB(s, j, a, b)                      \
  for (int j = 0; j < (s)->layers; j++)           \
    for (int a = -(s)->wide; a <= (s)->wide; a++) \
      for (int b = DIM == 3 ? -(s)->wide : 0; b <= (DIM == 3 ? (s)->wide : 0); b++)

static void slab_make(struct slab *s, const struct cloud *c, int form)
{
  memset(s, 0, sizeof *s);
  s->c = c, s->form = form;
  s->wide = (int)ceil((double)c->kernel.R / c->dx);
  s->layers = 12 * s->wide;
  for (int i = 0; i < s->layers; i++) FOR_SLAB(s, j, a, b)
  s->rho[i] += c->mass * (double)kernel_W(&c->kernel, (real)slab_distance(s, i, j, a, b), DIM);
  for (int i = 0; i < s->layers; i++) FOR_SLAB(s, j, a, b)
  s->colour[i] +=
    c->mass / s->rho[j] * (double)kernel_W(&c->kernel, (real)slab_distance(s, i, j, a, b), DIM);
  for (int i = 0; i < s->layers; i++) {
    FOR_SLAB(s, j, a, b)
    {
      const double r = slab_distance(s, i, j, a, b), z = (i - j) * c->dx;
      if (r > 0)
        s->slant[i] += c->mass / s->rho[j] * (form == HE ? s->colour[j] / s->colour[i] : 1) *
                       (double)kernel_dW(&c->kernel, (real)r, DIM) * z / r;
    }
  }
}

enum { COHESION, NORMALS, ENERGY };

/* Force on a particle of layer i from one of layer j at strength 1: its components along the
 * surface (away from x_j) and out of it. */
static void slab_force(const struct slab *s, int what, int i, int j, double r, const double x[2],
                       double F[2])
{
  const struct cloud *c = s->c;
  const double K = 2 * c->rho0 / (s->rho[i] + s->rho[j]), R = (double)c->kernel.R;
  const double gi = s->slant[i], gj = s->slant[j];
  for (int d = 0; d < 2; d++)
    if (what == COHESION)
      F[d] = -K * c->mass * c->mass * spline(r / R) * x[d] / r;
    else if (what == NORMALS)
      F[d] = d == 1 ? -K * c->mass * R * (gi - gj) : 0;
    else
      F[d] = c->mass / s->rho[i] * c->mass / s->rho[j] * (gi * gi + gj * gj) / 4 *
             (double)kernel_dW(&c->kernel, (real)r, DIM) * x[d] / r;
}

/* The excess of normal over tangential pressure, of one of the two surfaces. */
static double slab_tension(const struct slab *s, int what)
{
  const double R = (double)s->c->kernel.R, dx = s->c->dx;
  double total = 0;
  for (int i = 0; i < s->layers; i++) FOR_SLAB(s, j, a, b)
    {
      const double r = slab_distance(s, i, j, a, b), x[2] = {a * dx, (i - j) * dx};
      double F[2];
      if (r == 0 || r >= R) continue;
      slab_force(s, what, i, j, r, x, F);
      total += (F[1] * x[1] - F[0] * x[0]) / 2;
    }
  return total / 2 / pow(dx, DIM - 1);
}

struct strengths {
  double cohesion, normals, energy;
};

/* Cohesion carries two thirds of the tension. */
static struct strengths twin_strengths(const struct cloud *c, int form, double sigma)
{
  static struct slab s;
  slab_make(&s, c, form);
  const struct strengths t = {2 * sigma / 3 / slab_tension(&s, COHESION),
                              sigma / 3 / slab_tension(&s, NORMALS),
                              sigma / slab_tension(&s, ENERGY)};
  return t;
}

static void test_strengths(void **unused)
{
  (void)unused;
  static struct cloud c;
  const double most = sizeof(real) == 4 ? 1e-5 : 1e-10;
  cloud_make(&c, 3, 0, KERNEL_CUBIC, 1);
  const struct strengths akinci = twin_strengths(&c, AKINCI, 0.07),
                         he = twin_strengths(&c, HE, 0.07);
  const struct tension a = tension_make(AKINCI, 0.07, &c.kernel, c.dx, c.mass);
  const struct tension h = tension_make(HE, 0.07, &c.kernel, c.dx, c.mass);
  assert_true(akinci.cohesion > 0 && akinci.normals > 0 && he.energy > 0);
  assert_true(fabs((double)a.cohesion / akinci.cohesion - 1) < most);
  assert_true(fabs((double)a.normals / akinci.normals - 1) < most);
  assert_true(fabs((double)h.energy / he.energy - 1) < most);
}

/* --- twins */

static double slant[TWIN_MOST][DIM];

static double volume(const struct cloud *c, int j) { return c->mass / c->rho[j]; }

/* n_i/R = sum_j V_j grad W_ij;  He: 1/c_i sum_j V_j c_j grad W_ij, c_i = sum_j V_j W_ij */
static void twin_slant(const struct cloud *c, int form)
{
  static double colour[TWIN_MOST];
  memset(slant, 0, sizeof slant);
  for (int i = 0; i < c->n; i++) {
    colour[i] = form == HE ? 0 : 1;
    for (int j = 0; j < c->n && form == HE; j++) colour[i] += volume(c, j) * twin_W(c, i, j);
  }
  for (int i = 0; i < c->n; i++)
    for (int j = 0; j < c->n; j++)
      for (int d = 0; d < DIM; d++)
        slant[i][d] += volume(c, j) * colour[j] / colour[i] * twin_grad(c, i, j, d);
}

/* -K_ij (cohesion m_j s(q) x_ij/r + normals (n_i - n_j)) */
static double akinci_pull(const struct cloud *c, const struct strengths *t, int i, int j, int d)
{
  const double r = twin_distance(c, i, j), R = (double)c->kernel.R;
  const double K = 2 * c->rho0 / (c->rho[i] + c->rho[j]);
  if (r == 0 || r >= R) return 0;
  return -K * (t->cohesion * c->mass * spline(r / R) * (c->x[i][d] - c->x[j][d]) / r +
               t->normals * R * (slant[i][d] - slant[j][d]));
}
/* 1/rho_i V_j kappa/4 (|grad c_i|^2 + |grad c_j|^2) grad W_ij */
static double he_pull(const struct cloud *c, const struct strengths *t, int i, int j, int d)
{
  double g2 = 0;
  for (int e = 0; e < DIM; e++) g2 += slant[i][e] * slant[i][e] + slant[j][e] * slant[j][e];
  return t->energy / 4 * g2 / c->rho[i] * volume(c, j) * twin_grad(c, i, j, d);
}

static void compare(int form, int walls, int kernel, int fluids)
{
  static struct cloud run, twin, before;
  struct scene_params p;
  memset(&p, 0, sizeof p);
  p.tension = 70, p.tension_form = form;
  cloud_make(&run, SIDE, walls, kernel, 41 + (unsigned long long)walls);
  memset(run.gravity, 0, sizeof run.gravity);
  before = twin = run;
  still_run(&run, fluids == 2 ? &solver_still_two : &solver_still, &p);
  twin_density(&twin);
  twin_slant(&twin, form);
  const struct strengths t = twin_strengths(&twin, form, p.tension);
  for (int i = 0; i < twin.n; i++)
    for (int j = 0; j < twin.n; j++)
      for (int d = 0; d < DIM; d++)
        twin.v[i][d] += twin.dt * (fluids == 2 ? light_of_label(i) : 1) *
                        (form == HE ? he_pull : akinci_pull)(&twin, &t, i, j, d);
  assert_same_change(&run, &twin, &before);
}

static void test_akinci(void **unused)
{
  (void)unused;
  compare(AKINCI, 0, KERNEL_CUBIC, 1);
  compare(AKINCI, 1, KERNEL_WENDLAND2, 1);
  compare(AKINCI, 1, KERNEL_SPIKY, 2);
}
static void test_he(void **unused)
{
  (void)unused;
  compare(HE, 0, KERNEL_CUBIC, 1);
  compare(HE, 1, KERNEL_WENDLAND2, 1);
  compare(HE, 1, KERNEL_WENDLAND4, 2);
}

/* Momentum stays, with two fluids that of true masses; He's force is central and keeps the angular
 * momentum, too. */
static void test_conservation(void **unused)
{
  (void)unused;
  const double rounding = sizeof(real) == 4 ? 1e-5 : 1e-13;
  for (int form = AKINCI; form <= HE; form++) {
    static struct cloud c, before;
    double lost[DIM] = {0}, spin = 0, exchanged = 0;
    struct scene_params p;
    memset(&p, 0, sizeof p);
    p.tension = 70, p.tension_form = form;
    cloud_make(&c, SIDE, 0, KERNEL_CUBIC, 43);
    memset(c.gravity, 0, sizeof c.gravity);
    before = c;
    still_run(&c, &solver_still_two, &p);
    for (int i = 0; i < c.n; i++) {
      double change[DIM];
      for (int d = 0; d < DIM; d++) {
        change[d] = (c.v[i][d] - before.v[i][d]) / light_of_label(i);
        lost[d] += change[d];
        exchanged += fabs(change[d]);
      }
      spin += c.x[i][0] * change[1] - c.x[i][1] * change[0];
    }
    for (int d = 0; d < DIM; d++) assert_true(fabs(lost[d]) < rounding * (exchanged + c.n));
    if (form == HE) assert_true(fabs(spin) < rounding * SIDE * c.dx * (exchanged + c.n));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_strengths),
    cmocka_unit_test(test_akinci),
    cmocka_unit_test(test_he),
    cmocka_unit_test(test_conservation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
