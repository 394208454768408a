/* How far a column of SISPH's fluid sinks under its weight, beside theory. A fluid with p = K (rho/
 * rho0 - 1) sinks by 1 - 2 (s - log(1 + s))/s^2 of its height (twice that of its centre of mass),
 * s = rho0 g H/K (benchmarks/column.c). On a lattice mu B_0 has the modulus
 *
 *   K_eff = K G^2,   G = sum_j |W'(r_j)| r_j / (d sum_j W(r_j)),
 *
 * and N iterations of Eq. (14) show K_eff phi of it, phi = 1 - (S/(1 + S))^N. theory.dat has the
 * sinking over K with K, K_eff and K_eff phi of the first run; CURVE-measured.dat that of the runs,
 * and how many particles went through the walls, which then count with where they are.
 * Values: sinking and theory (K_eff phi) of each run, G^2. */
#include "lambda.h"

enum { POINTS = 60 };

/* G of a kernel on a lattice: d lambda / (-dV/V) */
static double stiffness(const struct figure_run *run)
{
  const struct kernel k = lambda_kernel(run);
  const int dim = (int)program_fact(run, "dim");
  const double dx = program_fact(run, "parameters.spacing");
  const int reach = (int)ceil(k.R / dx), deep = dim == 3 ? reach : 0;
  double sum = 0;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++)
      for (int c = -deep; c <= deep; c++) {
        const double r = dx * sqrt((double)(a * a + b * b + c * c));
        sum -= kernel_dW(&k, r, dim) * r;
      }
  return sum / dim / lambda_lattice(&k, dim, dx);
}

static double sinking(double s)
{
  return s < 1e-4 ? s * (2. / 3 - s / 2) : 1 - 2 * (s - log1p(s)) / (s * s);
}

static double sinking_of(const struct figure_run *run, double K)
{
  const double weight = program_fact(run, "parameters.rho0") *
                        program_fact(run, "parameters.gravity") *
                        program_fact(run, "parameters.height");
  return sinking(weight / K);
}

/* phi at modulus K, whose S grows with K. */
static double apparent(const struct figure_run *run, double K)
{
  const double N = program_fact(run, "parameters.fixed_iterations");
  const double S = program_fact(run, "parameters.S") * K / program_fact(run, "parameters.K");
  return 1 - pow(S / (1 + S), N > 0 ? N : 10);
}

static status write_theory(struct program *p)
{
  const struct figure_run *run = &p->run[0];
  const double G = stiffness(run);
  FILE *out = program_data(p, "theory", "", "K [Pa] | with K [1] | K G^2 [1] | K G^2 phi [1]");
  if (!out) return ERR_IO;
  for (int k = 0; k <= POINTS; k++) {
    const double K = pow(10, 1.5 + 6.5 * k / POINTS);
    fprintf(out, "%.6g %.6g %.6g %.6g\n", K, sinking_of(run, K), sinking_of(run, K * G * G),
            sinking_of(run, K * G * G * apparent(run, K)));
  }
  fclose(out);
  program_value(p, "G2", G * G);
  return OK;
}

/* The runs of one curve, whose label up to the comma is `name`. */
static status write_measured(struct program *p, const char *name)
{
  FILE *out =
    program_data(p, name, "-measured", "K [Pa] | mu [J] | sinking [1] | K G^2 phi [1] | lost [1]");
  if (!out) return ERR_IO;
  for (int k = 0; k < p->n; k++) {
    const struct figure_run *run = &p->run[k];
    const double K = program_fact(run, "parameters.K"), G = stiffness(run);
    const double theory = sinking_of(run, K * G * G * apparent(run, K));
    const double measured = program_fact(run, "metrics.settlement.value");
    if (strcspn(run->label, ",") != strlen(name) || strncmp(run->label, name, strlen(name)) != 0)
      continue;
    fprintf(out, "%.6g %.6g %.6g %.6g %g\n", K, program_fact(run, "parameters.mu"), measured,
            theory, program_fact(run, "metrics.particles_lost.value"));
    program_run_value(p, "sinking", run->label, measured);
    program_run_value(p, "theory", run->label, theory);
  }
  fclose(out);
  return OK;
}

static status write_all(struct program *p)
{
  char name[128], last[128] = "";
  TRY(write_theory(p));
  for (int k = 0; k < p->n; k++) {
    snprintf(name, sizeof name, "%.*s", (int)strcspn(p->run[k].label, ","), p->run[k].label);
    if (strcmp(name, last) != 0) TRY(write_measured(p, name));
    memcpy(last, name, sizeof last);
  }
  return OK;
}

int main(int argc, char **argv)
{
  struct program p;
  status result = program_begin(&p, argc, argv);
  if (result == OK && p.n == 0) result = user_error("runs of the scene 'column' are needed");
  if (result == OK) result = write_all(&p);
  return program_end(&p, result);
}
