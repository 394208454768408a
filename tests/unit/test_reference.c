/* The reference solutions against the tables of check values in tests/data. */
#include "sisph_objective.h"

#define DATA SPHBENCH_SOURCE_DIR "/tests/data/"
#define OWN_DATA SPHBENCH_SOURCE_DIR "/analysis/reference/data/"

/* ---- check_values.csv ---- */

static const struct reference_field_drop unit_drop = {1, 1};
static const struct reference_spinning_ellipse unit_spin = {1.41421356237309504880,
                                                            0.70710678118654752440, 1};
static const struct reference_wet_bed wet = {1, 0.1, 9.81};

static double ed(double t, char what)
{
  const struct reference_ellipse e = reference_elliptical_drop(100, t);
  return what == 'b' ? e.b : what == 'A' ? e.bdot / e.b : e.pc_over_rho;
}
static double ed1(void) { return ed(0.0038, 'b'); }
static double ed2(void) { return ed(0.0076, 'b'); }
static double ed3(void) { return ed(0.0076, 'A'); }
static double ed4(void) { return ed(0.0076, 'p'); }
static double ed5(void) { return ed(0, 'p'); }
static double od1(void) { return reference_oscillating_drop_period(unit_drop); }
static double od2(void) { return reference_oscillating_drop_largest(unit_drop); }
static double od3(void)
{
  return reference_oscillating_drop_period((struct reference_field_drop){0.5, 1});
}
static double od4(void) { return reference_oscillating_drop(unit_drop, 1).a; }
static double od5(void) { return reference_oscillating_drop(unit_drop, 1).pc_over_rho; }

static double el1(void)
{
  const struct reference_axes start = {.dim = 3, .a = {1, 1, 1}, .adot = {-50, -50, 100}};
  struct reference_axes end;
  return reference_axes_flow(&start, 0.0076, &end) ? NAN : end.a[2];
}

static double re1(void) { return reference_rotating_ellipse(&unit_spin, 0).pc_over_rho; }
static double re2(void) { return reference_rotating_ellipse(&unit_spin, 1).a; }
static double re3(void) { return reference_rotating_ellipse(&unit_spin, 1).pc_over_rho; }

static double patch(double x, double y)
{
  return reference_square_patch_pressure((struct reference_vec){x, y});
}
static double sq1(void) { return patch(0, 0); }
static double sq2(void) { return reference_square_patch_edge_slope(); }
static double sq3(void) { return reference_square_patch_mean_pressure(); }
static double sq4(void) { return patch(0.25, 0); }
static double sq5(void) { return patch(0.25, 0.25); }
/* by SUNDIALS, not from the table */
static double patch_centre(double t_omega)
{
  struct reference_patch_instant now = {0};
  return reference_square_patch_evolution(128, &t_omega, 1, &now) ? NAN : now.p_centre.value;
}
static double sq6(void) { return patch_centre(0.5); }
static double sq7(void) { return patch_centre(1); }
static double sq9(void) { return reference_square_patch_state(2).p_centre.value; }
static double sq10(void) { return reference_square_patch_state(2).r_tip; }
static double sq11(void) { return reference_square_patch_invariants().kinetic_energy; }
static double im1(void) { return reference_impact_energy_loss(0.5); }
static double im2(void) { return reference_impact_energy_loss(1); }

static double foot_pressure(double aspect)
{
  return reference_dambreak_pressure((struct reference_column){aspect, 1},
                                     (struct reference_vec){0, 0});
}
static double db1(void) { return foot_pressure(0.5); }
static double db2(void) { return foot_pressure(1); }
static double st1(void) { return reference_stoker_states(&wet).hm; }
static double st2(void) { return reference_stoker_states(&wet).bore; }

static double tg1(void)
{
  const struct reference_taylor_green f = {1, 1, 0.01, 1};
  return reference_taylor_green_decay(&f, 1);
}

/* Morris, Fox & Zhu 1997: gap 1 mm, nu = 1e-6 m2/s, F = 1e-4 m/s2, V0 = 1.25e-5 m/s. */
static const struct reference_channel driven = {1e-3, 1e-6, 1e-4}, dragged = {1e-3, 1e-6, 1.25e-5};
static double po1(void) { return reference_poiseuille(&driven, 5e-4, 0.0225); }
static double co1(void) { return reference_couette(&dragged, 5e-4, 0.0225); }
static double gr1(void) { return reference_gresho_pressure(0.3, 5); }
static double gr2(void) { return reference_gresho_pressure(0.4, 5); }

static double di2(void)
{
  const struct reference_lattice l = {1, 1, 1.3, 2.6, 10, 1, reference_cubic_spline_1d};
  return reference_lattice_omega2(&l, PI / 2);
}

/* by KINSOL from x* */
static double ss1(void)
{
  static struct block b;
  double x[BLOCK_NUMBERS];
  block_read(&b, "B0", SISPH_B0, 2);
  block_newton(&b, 100, x);
  return block_psi(&b, x);
}
static double ss2(void)
{
  static struct block b;
  block_read(&b, "B0", SISPH_B0, 2);
  return block_psi(&b, b.start);
}

#define CHECK(id) \
  {               \
#id, id       \
  }
static const struct check {
  const char *id;
  double (*value)(void);
} checks[] = {
  CHECK(ed1), CHECK(ed2), CHECK(ed3), CHECK(ed4), CHECK(ed5), CHECK(od1), CHECK(od2),  CHECK(od3),
  CHECK(od4), CHECK(od5), CHECK(el1), CHECK(re1), CHECK(re2), CHECK(re3), CHECK(sq1),  CHECK(sq2),
  CHECK(sq3), CHECK(sq4), CHECK(sq5), CHECK(sq6), CHECK(sq7), CHECK(sq9), CHECK(sq10), CHECK(sq11),
  CHECK(im1), CHECK(im2), CHECK(db1), CHECK(db2), CHECK(st1), CHECK(st2), CHECK(tg1),  CHECK(po1),
  CHECK(co1), CHECK(gr1), CHECK(gr2), CHECK(di2), CHECK(ss1), CHECK(ss2),
};

/* "id,quantity,value,tolerance": the quantity may hold commas. Returns false for other lines. */
struct line {
  char id[16], value[64], tolerance[32];
};

static bool split(char *text, struct line *out)
{
  text[strcspn(text, "\r\n")] = 0;
  const char *first = strchr(text, ',');
  char *last = strrchr(text, ',');
  if (*text == '#' || !first || last == first || !strncmp(text, "id,", 3)) return false;
  snprintf(out->tolerance, sizeof out->tolerance, "%s", last + 1);
  *last = 0;
  last = strrchr(text, ',');
  snprintf(out->value, sizeof out->value, "%s", last + 1);
  snprintf(out->id, sizeof out->id, "%.*s", (int)(first - text), text);
  return true;
}

/* The one line whose value is a formula in the mode m, not a number */
static void check_growth(const struct line *line)
{
  assert_string_equal(line->value, "sqrt(m-1)");
  for (int m = 1; m <= 16; m++) close_to(line->id, reference_disc_growth_rate(m), sqrt(m - 1.0), 0);
}

static void check_line(const struct line *line)
{
  if (!strcmp(line->id, "sq12")) {
    check_growth(line);
    return;
  }
  for (int k = 0; k < COUNT(checks); k++)
    if (!strcmp(checks[k].id, line->id)) {
      char *end;
      const double value = strtod(line->value, &end), tolerance = strtod(line->tolerance, NULL);
      if (end == line->value || *end) fail_msg("%s: '%s' is no number", line->id, line->value);
      close_to(line->id, checks[k].value(), value, tolerance);
      return;
    }
  fail_msg("check_values.csv has the line %s, for which this test has no function", line->id);
}

static void test_check_values(void **state)
{
  (void)state;
  FILE *file = fopen(DATA "check_values.csv", "r");
  assert_non_null(file);
  char text[1024];
  struct line line;
  int lines = 0;
  while (fgets(text, sizeof text, file))
    if (split(text, &line)) {
      check_line(&line);
      lines++;
    }
  fclose(file);
  /* every name above stands in the file, once */
  assert_int_equal(lines, COUNT(checks) + 1);
}

/* ---- whole tables: a function predicts every column of a row from the row's first ones ---- */

struct prediction {
  const char *file;
  int columns;
  void (*predict)(const double *row, double *out);
  double absolute, relative;
};

/* p = 0 on the sides, so is its derivative along them; the table has up to 5.1e-7 there, where the
 * truncated series that it came from converges as 1/n^2. */
static void predict_patch(const double *row, double *out)
{
  const struct reference_vec x = {row[0], row[1]}, g = reference_square_patch_gradient(x);
  out[2] = reference_square_patch_pressure(x);
  if (fabs(x.y) < 0.5)
    out[3] = g.x;
  else
    close_to("along a side", g.x, 0, 1e-15);
  if (fabs(x.x) < 0.5)
    out[4] = g.y;
  else
    close_to("along a side", g.y, 0, 1e-15);
}

static void predict_dambreak(const double *row, double *out)
{
  /* 0.571428571429 stands for 4/7 */
  const double width = fabs(row[0] - 4.0 / 7) < 1e-9 ? 4.0 / 7 : row[0];
  out[3] = reference_dambreak_pressure((struct reference_column){width, 1},
                                       (struct reference_vec){row[1] * width, row[2]});
}

static void predict_elliptical(const double *row, double *out)
{
  const struct reference_ellipse e = reference_elliptical_drop(100, row[0]);
  const double values[] = {100 * row[0], -e.adot / e.a, e.a,
                           e.b,          e.pc_over_rho, (sq(e.adot) + sq(e.bdot)) / 2e4};
  memcpy(out + 1, values, sizeof values);
}

static void predict_oscillating(const double *row, double *out)
{
  const struct reference_ellipse e = reference_oscillating_drop(unit_drop, row[0]);
  const double values[] = {e.a,
                           e.b,
                           e.adot,
                           e.bdot,
                           e.pc_over_rho,
                           (sq(e.adot) + sq(e.bdot)) / 2,
                           (sq(e.a) + sq(e.b)) / 2};
  /* t/T is printed with ten digits */
  close_to("t/T", row[0] / reference_oscillating_drop_period(unit_drop), row[1], 5e-11);
  memcpy(out + 2, values, sizeof values);
}

static void predict_rotating(const double *row, double *out)
{
  const struct reference_rotated_ellipse r = reference_rotating_ellipse(&unit_spin, row[0]);
  double energy = 0, spin = 0;
  for (int j = 0; j < 2; j++) {
    energy += sq(r.Fdot[0][j]) + sq(r.Fdot[1][j]);
    spin += r.F[1][j] * r.Fdot[0][j] - r.F[0][j] * r.Fdot[1][j];
  }
  const double values[] = {r.F[0][0], r.F[0][1], r.F[1][0],     r.F[1][1],    r.a,
                           r.b,       r.alpha,   r.pc_over_rho, energy / 2.5, spin / 2.5};
  memcpy(out + 1, values, sizeof values);
}

static void predict_stoker(const double *row, double *out)
{
  const struct reference_wet_bed w = {row[0], row[1], 9.81};
  const struct reference_stoker_states s = reference_stoker_states(&w);
  memcpy(out + 2, (double[]){s.hm, s.um, s.bore, s.tail}, 4 * sizeof *out);
}

static void predict_channel(const double *row, double *out)
{
  out[2] = reference_poiseuille(&driven, row[1], row[0]);
  out[3] = reference_couette(&dragged, row[1], row[0]);
}

static void predict_impact(const double *row, double *out)
{
  /* 0.333333333333 and 0.666666666667 stand for thirds */
  const double thirds = round(3 * row[0]) / 3;
  out[1] = reference_impact_energy_loss(fabs(row[0] - thirds) < 1e-11 ? thirds : row[0]);
  out[2] = 1 - out[1];
}

static const struct prediction predictions[] = {
  {"square_patch_p0.csv", 5, predict_patch, 2e-15, 0},
  {"dambreak_p0_t0.csv", 4, predict_dambreak, 1e-12, 0},
  {"elliptical_drop.csv", 7, predict_elliptical, 0, 2e-15},
  {"oscillating_drop_A0eqB.csv", 9, predict_oscillating, 2e-15, 2e-15},
  {"rotating_ellipse_patch.csv", 11, predict_rotating, 4e-15, 2e-15},
  {"stoker_states.csv", 6, predict_stoker, 0, 5e-12},
  {"poiseuille_couette_transient.csv", 4, predict_channel, 1e-16, 0},
  {"normal_impact_ke_loss.csv", 3, predict_impact, 1e-12, 0},
};

static void test_tables(void **state)
{
  (void)state;
  for (int k = 0; k < COUNT(predictions); k++) {
    const struct prediction *p = &predictions[k];
    struct reference_table table;
    char path[1024];
    snprintf(path, sizeof path, "%s%s", DATA, p->file);
    if (reference_table_read(path, &table)) fail_msg("%s", reference_error());
    assert_int_equal(table.columns, p->columns);
    for (int i = 0; i < table.rows; i++) {
      const double *row = table.values + i * table.columns;
      double out[16];
      memcpy(out, row, table.columns * sizeof *row);
      p->predict(row, out);
      for (int c = 0; c < table.columns; c++) {
        char what[128];
        snprintf(what, sizeof what, "%s row %d %s", p->file, i + 1, table.names[c]);
        close_to(what, out[c], row[c], p->absolute + p->relative * fabs(row[c]));
      }
    }
    reference_table_free(&table);
  }
}

/* The first column is a letter: A stretches along an axis, B strains in a plane. */
static void test_ellipsoid_table(void **state)
{
  (void)state;
  FILE *file = fopen(DATA "ellipsoid_drop_3d.csv", "r");
  assert_non_null(file);
  char text[1024], drop;
  double t, v[7];
  int rows = 0;
  while (fgets(text, sizeof text, file)) {
    if (sscanf(text, "%c,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &drop, &t, v, v + 1, v + 2, v + 3, v + 4,
               v + 5, v + 6) != 9)
      continue;
    struct reference_axes end, start = {.dim = 3, .a = {1, 1, 1}, .adot = {-50, -50, 100}};
    if (drop == 'B') memcpy(start.adot, (double[]){-100, 100, 0}, sizeof start.adot);
    if (reference_axes_flow(&start, t, &end)) fail_msg("%s", reference_error());
    const double bound = end.error + 4e-15; /* in a; the stated error must cover the true one */
    for (int i = 0; i < 3; i++) {
      close_to(text, end.a[i], v[i], fmin(bound * fmax(end.a[1], end.a[2]), 1e-12));
      close_to(text, end.adot[i], v[3 + i], 1e-10);
    }
    close_to(text, end.pc_over_rho, v[6], 3e-12 * 3400);
    assert_true(end.defect < 1e-12);
    rows++;
  }
  fclose(file);
  assert_int_equal(rows, 18);
}

/* ---- readers and interpolation ---- */

static void test_series_in_the_library_equal_the_file(void **state)
{
  (void)state;
  struct reference_table table;
  if (reference_table_read(OWN_DATA "square_patch_evolution.csv", &table))
    fail_msg("%s", reference_error());
  const struct reference_series *series[] = {reference_square_patch_p_centre(),
                                             reference_square_patch_r_min()};
  const char *names[] = {"p_centre", "r_min"}, *errors[] = {"p_centre_err", "r_min_err"};
  const int tip = reference_table_column(&table, "r_tip_exact");
  const int angle = reference_table_column(&table, "theta_tip_exact");
  for (int k = 0; k < 2; k++) {
    const int y = reference_table_column(&table, names[k]);
    const int error = reference_table_column(&table, errors[k]);
    assert_true(y > 0 && error > 0 && tip > 0 && angle > 0);
    assert_int_equal(series[k]->count, table.rows);
    for (int i = 0; i < table.rows; i++) {
      const double *row = table.values + i * table.columns;
      assert_true(series[k]->x[i] == row[0] && series[k]->y[i] == row[y]);
      assert_true(series[k]->error[i] == row[error]);
      const struct reference_patch_state s = reference_square_patch_state(row[0]);
      close_to("r_tip", s.r_tip, row[tip], 1e-12);
      close_to("theta_tip", s.theta_tip, row[angle], 1e-12);
      const struct reference_value v = reference_series_smooth(series[k], row[0]);
      assert_true(v.value == row[y] && v.error == row[error]);
    }
  }
  reference_table_free(&table);
}

/* Every other point left out and predicted from the rest: the stated error must cover the miss. */
static void test_smooth_interpolation_states_its_error(void **state)
{
  (void)state;
  const struct reference_series *series[] = {reference_square_patch_p_centre(),
                                             reference_square_patch_r_min()};
  for (int k = 0; k < 2; k++) {
    double x[64], y[64], error[64];
    int n = 0;
    for (int i = 0; i < series[k]->count; i += 2, n++) {
      x[n] = series[k]->x[i];
      y[n] = series[k]->y[i];
      error[n] = series[k]->error[i];
    }
    const struct reference_series coarse = {
      .count = n, .x = x, .y = y, .error = error, .even = true};
    for (int i = 1; i < series[k]->count && series[k]->x[i] < x[n - 1]; i += 2) {
      const struct reference_value v = reference_series_smooth(&coarse, series[k]->x[i]);
      close_to("left out", v.value, series[k]->y[i], v.error + series[k]->error[i]);
      if (series[k]->x[i] < 1.2) assert_true(v.error < 1e-5);
    }
  }
}

static void test_martin_moyce(void **state)
{
  (void)state;
  const struct reference_series *front = reference_martin_moyce_front();
  const struct reference_series *height = reference_martin_moyce_height();
  assert_int_equal(front->count, 15);
  assert_int_equal(height->count, 17);
  for (int i = 1; i < front->count; i++)
    assert_true(front->x[i] > front->x[i - 1] && front->y[i] > front->y[i - 1]);
  for (int i = 1; i < height->count; i++)
    assert_true(height->x[i] > height->x[i - 1] && height->y[i] < height->y[i - 1]);
  close_to("front", reference_series_linear(front, 3.33), 4.11, 0);
  close_to("front between", reference_series_linear(front, (0.41 + 0.84) / 2), 1.165, 1e-15);
  close_to("height", reference_series_linear(height, 0.56), 0.94, 0);
  assert_true(isnan(reference_series_linear(front, 0.4)));
  assert_true(isnan(reference_series_linear(front, 3.34)));
  assert_true(isnan(reference_series_linear(front, NAN)));
}

static void write_file(const char *path, const char *text)
{
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static void test_table_reader(void **state)
{
  (void)state;
  const char *path = "test_reference_table.tmp";
  struct reference_table table;
  assert_int_equal(reference_table_read("no such file.csv", &table), REFERENCE_NO_FILE);
  assert_non_null(strstr(reference_error(), "no such file.csv"));
  static const struct {
    const char *text, *sentence;
  } bad[] = {
    {"", "no row"},           {"# only\n", "no row"},         {"x,y\n", "no row"},
    {"x,y\n1,2\n3\n", ":3:"}, {"x,y\n1,2,3\n", ":2:"},        {"x,y\n# no\n1,b\n", ":3:"},
    {"x,y\n1,nan\n", ":2:"},  {"x,y\n1,2\n\n4,inf\n", ":4:"},
  };
  for (int k = 0; k < COUNT(bad); k++) {
    write_file(path, bad[k].text);
    assert_int_equal(reference_table_read(path, &table), REFERENCE_BAD_FILE);
    if (!strstr(reference_error(), bad[k].sentence) || !strstr(reference_error(), path))
      fail_msg("'%s' lacks '%s'", reference_error(), bad[k].sentence);
    assert_null(table.values);
  }
  write_file(path, "# note\r\n\r\nx,y\r\n0, 1\r\n2,5 \r\n4,1");
  if (reference_table_read(path, &table)) fail_msg("%s", reference_error());
  assert_int_equal(table.rows, 3);
  const struct reference_columns xy = {reference_table_column(&table, "x"),
                                       reference_table_column(&table, "y")};
  assert_int_equal(reference_table_column(&table, "z"), -1);
  close_to("table", reference_table_at(&table, xy, 1), 3, 0);
  close_to("table", reference_table_at(&table, xy, 4), 1, 0);
  assert_true(isnan(reference_table_at(&table, xy, 4.001)));
  assert_true(isnan(reference_table_at(&table, (struct reference_columns){0, -1}, 1)));
  reference_table_free(&table);
  reference_table_free(&table);
  remove(path);
}

static void test_outlines(void **state)
{
  (void)state;
  const char *names[] = {"0p5", "1p0", "1p5", "2p0"};
  const struct reference_vec centre = {0, 0};
  for (int k = 0; k < COUNT(names); k++) {
    char path[1024];
    struct reference_outline o;
    snprintf(path, sizeof path, OWN_DATA "square_patch_outline_tw%s.csv", names[k]);
    if (reference_outline_read(path, &o)) fail_msg("%s", reference_error());
    const struct reference_patch_state s = reference_square_patch_state(0.5 * (k + 1));
    /* the polygon cuts corners of the curve: chords, not the computation, set these bounds */
    close_to("area", reference_outline_area(&o), 1, 1e-3);
    close_to("r_min", reference_outline_distance(&o, centre), s.r_min.value, 5e-4);
    close_to("r_tip", hypot(o.points[0].x, o.points[0].y), s.r_tip, 1e-8);
    close_to("theta_tip", atan2(o.points[0].y, o.points[0].x), s.theta_tip, 1e-8);
    for (int i = 0; i < 16; i++) {
      const double angle = 2 * PI * i / 16, r = s.r_min.value;
      const struct reference_vec u = {cos(angle), sin(angle)};
      const struct reference_vec in = {0.99 * r * u.x, 0.99 * r * u.y};
      const struct reference_vec out = {1.01 * s.r_tip * u.x, 1.01 * s.r_tip * u.y};
      assert_true(reference_outline_contains(&o, in));
      assert_false(reference_outline_contains(&o, out));
    }
    reference_outline_free(&o);
    reference_outline_free(&o);
  }
  struct reference_outline none;
  assert_int_equal(reference_outline_read(OWN_DATA "square_patch_evolution.csv", &none),
                   REFERENCE_BAD_FILE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_check_values),
    cmocka_unit_test(test_tables),
    cmocka_unit_test(test_ellipsoid_table),
    cmocka_unit_test(test_series_in_the_library_equal_the_file),
    cmocka_unit_test(test_smooth_interpolation_states_its_error),
    cmocka_unit_test(test_martin_moyce),
    cmocka_unit_test(test_table_reader),
    cmocka_unit_test(test_outlines),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
