/* Reference fields against the equations that they solve: residuals by finite differences,
 * integrals, and other ways to the same number. */
#include "reference_checks.h"

/* A scalar of the plane and its derivatives by fourth-order central differences of step h. */
typedef double field(struct reference_vec x);

static double shifted(field *f, struct reference_vec x, double dx, double dy)
{
  return f((struct reference_vec){x.x + dx, x.y + dy});
}

static struct reference_vec slope(field *f, struct reference_vec x, double h)
{
  return (struct reference_vec){(8 * (shifted(f, x, h, 0) - shifted(f, x, -h, 0)) -
                                 shifted(f, x, 2 * h, 0) + shifted(f, x, -2 * h, 0)) /
                                  (12 * h),
                                (8 * (shifted(f, x, 0, h) - shifted(f, x, 0, -h)) -
                                 shifted(f, x, 0, 2 * h) + shifted(f, x, 0, -2 * h)) /
                                  (12 * h)};
}

static double laplacian(field *f, struct reference_vec x, double h)
{
  double sum = -60 * f(x);
  for (int side = -1; side <= 1; side += 2)
    sum += 16 * (shifted(f, x, side * h, 0) + shifted(f, x, 0, side * h)) -
           shifted(f, x, 2 * side * h, 0) - shifted(f, x, 0, 2 * side * h);
  return sum / (12 * h * h);
}

static bool near_point(struct reference_vec a, struct reference_vec b, double tolerance)
{
  return fabs(a.x - b.x) <= tolerance && fabs(a.y - b.y) <= tolerance;
}

/* ---- square patch ---- */

/* Colagrossi's double sine series, odd m, n below `most`. */
static double double_series(struct reference_vec x, int most)
{
  double sum = 0;
  for (int m = 1; m < most; m += 2)
    for (int n = 1; n < most; n += 2)
      sum -= 32 / (m * n * sq(PI) * (sq(n * PI) + sq(m * PI))) * sin(m * PI * (x.x + 0.5)) *
             sin(n * PI * (x.y + 0.5));
  return sum;
}

static void test_square_patch(void **state)
{
  (void)state;
  for (int i = 0; i <= 20; i++)
    for (int j = 0; j <= 20; j++) {
      const struct reference_vec x = {0.0237 * (i - 10) * 0.999, 0.0237 * (j - 10) + 0.001};
      const struct reference_vec g = reference_square_patch_gradient(x);
      const struct reference_vec mirror = {-x.y, x.x};
      close_to("laplacian", laplacian(reference_square_patch_pressure, x, 2e-3), 2, 1e-7);
      assert_true(near_point(slope(reference_square_patch_pressure, x, 1e-3), g, 1e-9));
      close_to("symmetry", reference_square_patch_pressure(mirror),
               reference_square_patch_pressure(x), 2e-16);
    }
  for (int i = 0; i <= 100; i++) {
    const double s = (i - 50) / 100.0;
    close_to("side", reference_square_patch_pressure((struct reference_vec){s, 0.5}), 0, 2e-16);
    close_to("side", reference_square_patch_pressure((struct reference_vec){-0.5, s}), 0, 2e-16);
  }
  const struct reference_vec at = {0.4, 0.3}, edge = {0, 0.5};
  close_to("double series", double_series(at, 100), reference_square_patch_pressure(at), 1e-6);
  close_to("double series, more terms", double_series(at, 1000),
           reference_square_patch_pressure(at), 1e-9);
  close_to("edge slope", reference_square_patch_gradient(edge).y,
           reference_square_patch_edge_slope(), 1e-15);
  /* next to the corner p -> (4/pi) x y log r */
  const double d = 1e-7;
  const struct reference_vec corner = {0.5 - d, d - 0.5};
  const double leading = 4 / PI * d * d * log(d);
  close_to("corner", reference_square_patch_pressure(corner), leading, 0.5 * d * d);
  assert_true(isnan(reference_square_patch_pressure((struct reference_vec){0.5001, 0})));
}

/* int p = -int (x . grad p)/2 over the patch (div of x p), by the midpoint rule */
static void test_square_patch_mean(void **state)
{
  (void)state;
  const int n = 400;
  double mean = 0, virial = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const struct reference_vec x = {(i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5};
      const struct reference_vec g = reference_square_patch_gradient(x);
      mean += reference_square_patch_pressure(x) / (n * n);
      virial -= (x.x * g.x + x.y * g.y) / (2 * n * n);
    }
  close_to("mean", mean, reference_square_patch_mean_pressure(), 1e-6);
  close_to("virial", virial, reference_square_patch_mean_pressure(), 1e-6);
}

/* Of any near-circular ellipse the mode m = 2 grows as exp(omega t). */
static void test_disc_growth(void **state)
{
  (void)state;
  for (int m = 1; m <= 8; m++) close_to("growth", sq(reference_disc_growth_rate(m)), m - 1, 1e-14);
  const struct reference_spinning_ellipse e = {1 + 1e-8, 1 / (1 + 1e-8), 1};
  const struct reference_rotated_ellipse early = reference_rotating_ellipse(&e, 5);
  const struct reference_rotated_ellipse late = reference_rotating_ellipse(&e, 6);
  close_to("mode 2", log(log(late.a / late.b) / log(early.a / early.b)),
           reference_disc_growth_rate(2), 1e-4);
  assert_true(isnan(reference_disc_growth_rate(0)));
}

/* ---- impulsive pressures ---- */

static struct reference_column column;

static double column_pressure(struct reference_vec x)
{
  return column.height * reference_dambreak_pressure(column, x);
}

static void test_dambreak(void **state)
{
  (void)state;
  const double widths[] = {0.1, 0.5, 1, 4};
  for (int k = 0; k < COUNT(widths); k++) {
    column = (struct reference_column){widths[k] * 2, 2};
    for (int i = 1; i < 20; i++) {
      const double sx = column.width * i / 20, sy = column.height * i / 20, h = 2e-3 * widths[k];
      const struct reference_vec x = {sx, 0.3 * sy + 0.1}, wall = {0, sy}, bed = {sx, 0};
      const struct reference_vec g = reference_dambreak_gradient(column, x);
      close_to("laplacian", laplacian(column_pressure, x, h), 0, 1e-7 / sq(widths[k]));
      assert_true(near_point(slope(column_pressure, x, h), g, 1e-6));
      close_to("wall", reference_dambreak_gradient(column, wall).x, 0, 1e-14);
      close_to("bed", reference_dambreak_gradient(column, bed).y, -1, 1e-14);
      const struct reference_vec top = {sx, column.height}, side = {column.width, sy};
      close_to("top", reference_dambreak_pressure(column, top), 0, 1e-15);
      close_to("side", reference_dambreak_pressure(column, side), 0, 1e-15);
    }
  }
  /* a column far wider than high is hydrostatic at its wall, a thin one falls freely */
  close_to(
    "wide",
    reference_dambreak_pressure((struct reference_column){40, 1}, (struct reference_vec){0, 0.25}),
    0.75, 1e-15);
  close_to("thin",
           reference_dambreak_gradient((struct reference_column){0.01, 1},
                                       (struct reference_vec){0.005, 0.5})
             .y,
           0, 1e-15);
  assert_true(isnan(reference_dambreak_pressure(column, (struct reference_vec){-0.1, 0.1})));
}

static double block_impulse(struct reference_vec x)
{
  return column.width * reference_impact_impulse(column, x);
}

static double contact_impulse(double x)
{
  return reference_impact_impulse(column, (struct reference_vec){x, 0}) / column.height;
}

/* sum |u+|^2/|u-|^2 over the block by the midpoint rule */
static double energy_left(int n)
{
  double sum = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const struct reference_vec x = {column.width * ((i + 0.5) / n - 0.5),
                                      column.height * (j + 0.5) / n};
      const struct reference_vec g = reference_impact_gradient(column, x);
      sum += sq(g.x) + sq(1 + g.y);
    }
  return sum / n / n;
}

static void test_impact(void **state)
{
  (void)state;
  const double heights[] = {0.25, 0.5, 1.5};
  for (int k = 0; k < COUNT(heights); k++) {
    const double H = heights[k];
    column = (struct reference_column){1, H};
    for (int i = 1; i < 20; i++) {
      const struct reference_vec x = {i / 41.0, H * i / 23}, contact = {i / 41.0, 0};
      const struct reference_vec g = reference_impact_gradient(column, x);
      close_to("laplacian", laplacian(block_impulse, x, 1e-3), 0, 1e-7);
      assert_true(near_point(slope(block_impulse, x, 1e-3), g, 1e-8));
      close_to("stopped", reference_impact_gradient(column, contact).y, -1, 1e-14);
      const struct reference_vec side = {0.5, x.y}, top = {x.x, H};
      close_to("side", reference_impact_impulse(column, side), 0, 1e-15);
      close_to("top", reference_impact_impulse(column, top), 0, 1e-15);
    }
    const double loss = reference_impact_energy_loss(H);
    close_to("work", midpoint(contact_impulse, -0.5, 0.5, 20000), loss, 1e-8);
    close_to("energy", energy_left(400), 1 - loss, 1e-4);
  }
  for (double h = 0.01; h < 5; h *= 1.3) {
    double plain = 0; /* the series as it stands; its tail after n is 2/(pi^3 n^2) */
    for (int n = 1; n < 20000; n += 2) plain += 8 / pow(PI * n, 3) * tanh(n * PI * h) / h;
    close_to("loss", reference_impact_energy_loss(h), plain, 1e-9 / h);
  }
  assert_true(isnan(reference_impact_energy_loss(0)));
}

/* ---- periodic, walled and wave flows ---- */

static const struct reference_taylor_green vortices = {1.3, 2, 0.05, 900};
static struct reference_flow tg(struct reference_vec x)
{
  return reference_taylor_green(&vortices, x, 0.7);
}
static double tg_u(struct reference_vec x) { return tg(x).u; }
static double tg_v(struct reference_vec x) { return tg(x).v; }
static double tg_p(struct reference_vec x) { return tg(x).p; }

static void test_taylor_green(void **state)
{
  (void)state;
  const double rate = -8 * sq(PI / 2) * 0.05; /* d log u/dt */
  for (int i = 0; i < 30; i++) {
    const struct reference_vec x = {0.067 * i, 0.031 * i * i};
    const struct reference_flow f = tg(x);
    const struct reference_vec du = slope(tg_u, x, 2e-3), dv = slope(tg_v, x, 2e-3);
    const struct reference_vec dp = slope(tg_p, x, 2e-3);
    close_to("div", du.x + dv.y, 0, 1e-10);
    close_to("x", rate * f.u + f.u * du.x + f.v * du.y + dp.x / 900,
             0.05 * laplacian(tg_u, x, 2e-3), 1e-8);
    close_to("y", rate * f.v + f.u * dv.x + f.v * dv.y + dp.y / 900,
             0.05 * laplacian(tg_v, x, 2e-3), 1e-8);
  }
  const struct reference_taylor_green thin = {1, 1, 0.001, 1};
  close_to("decay", reference_taylor_green_decay(&thin, 2), 0.8539234976, 1e-10);
}

static void test_channels(void **state)
{
  (void)state;
  const struct reference_channel body = {1e-3, 1e-6, 1e-4}, plate = {1e-3, 1e-6, 1.25e-5};
  const double times[] = {0.0225, 0.045, 0.1125, 0.225, 1};
  const double P[] = {2.232737507022e-6, 4.234570557410e-6, 8.249913844794e-6, 1.109980165918e-5,
                      1.249933273915e-5};
  const double C[] = {2.302765681570e-7, 1.194751640531e-6, 3.628440987073e-6, 5.386287273244e-6,
                      6.249588399962e-6};
  for (int i = 0; i < COUNT(times); i++) {
    close_to("P", reference_poiseuille(&body, 5e-4, times[i]), P[i], 1e-17);
    close_to("C", reference_couette(&plate, 5e-4, times[i]), C[i], 1e-18);
  }
  /* u_t = u_yy + F in units of L and L^2/nu; 0.1 is where Couette changes its series */
  const struct reference_channel one = {1, 1, 1};
  double (*const flows[])(const struct reference_channel *, double, double) = {reference_poiseuille,
                                                                               reference_couette};
  for (int k = 0; k < 2; k++)
    for (double t = 0.02; t < 0.4; t += 0.08)
      for (double y = 0.1; y < 0.95; y += 0.1) {
        const double h = 1e-3, u = flows[k](&one, y, t);
        const double ut =
          (flows[k](&one, y, t + h * h) - flows[k](&one, y, t - h * h)) / (2 * h * h);
        const double uyy = (flows[k](&one, y + h, t) - 2 * u + flows[k](&one, y - h, t)) / (h * h);
        close_to("residual", ut, uyy + (k == 0), 2e-4);
      }
  close_to("switch", reference_couette(&one, 0.5, 0.1 - 1e-12),
           reference_couette(&one, 0.5, 0.1 + 1e-12), 1e-11);
  close_to("early", reference_poiseuille(&one, 0.5, 1e-6), 1e-6, 1e-15);
  close_to("plate", reference_couette(&one, 1, 1e-3), 1, 0);
  assert_true(isnan(reference_poiseuille(&one, 1.1, 1)));
}

static double gresho_energy(double r) { return PI * sq(reference_gresho_velocity(r)) * r; }
static double gresho_spin(double r) { return 2 * PI * reference_gresho_velocity(r) * r * r; }

static void test_gresho(void **state)
{
  (void)state;
  close_to("energy", midpoint(gresho_energy, 0, 0.4, 40000), reference_gresho_kinetic_energy(),
           1e-9);
  close_to("spin", midpoint(gresho_spin, 0, 0.4, 40000), reference_gresho_angular_momentum(), 1e-9);
  const double h = 1e-5;
  for (double r = 0.03; r < 0.5; r += 0.04) {
    const double dp = reference_gresho_pressure(r + h, 5) - reference_gresho_pressure(r - h, 5);
    close_to("p' = v^2/r", dp / (2 * h), sq(reference_gresho_velocity(r)) / r, 1e-7);
  }
  close_to("join", reference_gresho_pressure(0.2 - 1e-15, 5), 5.5, 1e-14);
  close_to("join", reference_gresho_pressure(0.4 - 1e-15, 5), reference_gresho_pressure(0.4, 5),
           1e-14);
}

static void test_waves_and_falls(void **state)
{
  (void)state;
  const struct reference_pool unit = {1, 1}, tank = {0.6, 9.81}, shallow = {0.093, 9.81};
  close_to("omega", reference_wave_frequency(unit, PI), 1.769146979658, 1e-12);
  close_to("standing", reference_standing_wave_period(unit, 2), 3.551533806646, 1e-12);
  const double T[] = {1.667786050, 1.066198161, 0.860719829};
  for (int n = 1; n <= 3; n++)
    close_to("sloshing", reference_sloshing_period(tank, 1.73, n), T[n - 1], 1e-9);
  close_to("sloshing", reference_sloshing_period(shallow, 0.9, 1), 1.917089509, 1e-9);

  const struct reference_liquid water = {1000, 9.81};
  close_to("hydrostatic", reference_hydrostatic(water, 2, 0.5), 14715, 1e-11);
  close_to("above", reference_hydrostatic(water, 2, 2.5), 0, 0);

  const struct reference_fall fall = {3, -2, -9.81};
  double x = 3, v = -2;
  for (int n = 1; n <= 100; n++) {
    v += -9.81 * 0.01;
    x += v * 0.01;
    close_to("symplectic", reference_free_fall_steps(&fall, 0.01, n), x, 1e-14);
  }
  close_to("fall", reference_free_fall(&fall, 1), 3 - 2 - 9.81 / 2, 1e-15);
  close_to("limit", reference_free_fall_steps(&fall, 1e-7, 10000000), 3 - 2 - 9.81 / 2, 1e-6);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_square_patch),    cmocka_unit_test(test_square_patch_mean),
    cmocka_unit_test(test_disc_growth),     cmocka_unit_test(test_dambreak),
    cmocka_unit_test(test_impact),          cmocka_unit_test(test_taylor_green),
    cmocka_unit_test(test_channels),        cmocka_unit_test(test_gresho),
    cmocka_unit_test(test_waves_and_falls),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
