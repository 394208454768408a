#include "bodies.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../base/memory.h"
#include "run.h"

/* --- small matrices [3][3], row by row */

static void matrix_times(double to[3], double a[3][3], const double b[3])
{
  for (int i = 0; i < 3; i++) to[i] = a[i][0] * b[0] + a[i][1] * b[1] + a[i][2] * b[2];
}
/* a x = b for a symmetric positive definite a, by Cramer's rule */
static void solve(double x[3], double a[3][3], const double b[3])
{
  double minor[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const int k = (i + 1) % 3, l = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
      minor[i][j] = a[k][p] * a[l][q] - a[k][q] * a[l][p];
    }
  const double det = a[0][0] * minor[0][0] + a[0][1] * minor[0][1] + a[0][2] * minor[0][2];
  matrix_times(x, minor, b);
  for (int i = 0; i < 3; i++) x[i] /= det;
}

/* R = exp(angle x) R, Rodrigues' formula */
static void rotate(double R[3][3], const double angle[3])
{
  const double a = sqrt(angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2]);
  if (!(a > 0)) return;
  const double n[3] = {angle[0] / a, angle[1] / a, angle[2] / a}, c = cos(a), s = sin(a);
  for (int j = 0; j < 3; j++) {
    const double r[3] = {R[0][j], R[1][j], R[2][j]};
    const double along = n[0] * r[0] + n[1] * r[1] + n[2] * r[2];
    for (int i = 0; i < 3; i++) {
      const int k = (i + 1) % 3, l = (i + 2) % 3;
      R[i][j] = c * r[i] + s * (n[k] * r[l] - n[l] * r[k]) + (1 - c) * along * n[i];
    }
  }
}

/* --- start */

/* Every particle is a cube of side dx: a line or a point has inertia about every axis too. */
static void measure_inertia(struct body *b, double particle_mass, double dx)
{
  for (int k = 0; k < b->num_arms; k++) {
    double r[3] = {0, 0, 0}, r2 = 0;
    for (int d = 0; d < DIM; d++) r[d] = (double)b->arm[k].c[d];
    for (int d = 0; d < 3; d++) r2 += r[d] * r[d];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        b->inertia[i][j] += particle_mass * ((i == j ? r2 + dx * dx / 6 : 0) - r[i] * r[j]);
  }
}

/* I = R I_0 R^T;   angular momentum = I spin, or spin from it */
static void inertia_now(const struct body *b, double I[3][3])
{
  double half[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      half[i][j] = 0;
      for (int k = 0; k < 3; k++) half[i][j] += b->turn[i][k] * b->inertia[k][j];
    }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      I[i][j] = 0;
      for (int k = 0; k < 3; k++) I[i][j] += half[i][k] * b->turn[j][k];
    }
}

static status start_body(struct run *run, int number, real *body, vec *arm)
{
  const struct scene *s = &run->scene;
  struct body *b = &run->body[number];
  b->as_built = s->body[number];
  for (int d = 0; d < DIM; d++) b->centre[d] = (double)b->as_built.centre.c[d];
  for (int d = 0; d < DIM; d++) b->velocity[d] = (double)b->as_built.velocity.c[d];
  for (int d = 0; d < 3; d++) b->turn[d][d] = 1;
  memcpy(b->spin, b->as_built.spin, sizeof b->spin);
  if (DIM == 2) b->spin[0] = b->spin[1] = 0;
  b->arm = malloc(sizeof(vec) * ((size_t)s->num_body_of + 1));
  if (!b->arm) return status_set(ERR_MEMORY, "no memory for a body");
  for (int k = 0; k < s->num_body_of; k++)
    if (s->body_of[k] == number + 1) {
      arm[s->n + k] = b->arm[b->num_arms++] = sub(s->wall_x[k], b->as_built.centre);
      body[s->n + k] = (real)(number + 1);
    }
  const double each = b->as_built.density * pow(s->common.spacing, DIM);
  b->mass = each * b->num_arms;
  measure_inertia(b, each, s->common.spacing);
  matrix_times(b->angular, b->inertia, b->spin);
  return OK;
}

status bodies_start(struct run *run)
{
  const int n = run->scene.num_bodies, all = run->view->p.n_all;
  if (n == 0) return OK;
  run->body = calloc((size_t)n, sizeof *run->body);
  real *body = calloc((size_t)all + 1, sizeof *body);
  vec *arm = calloc((size_t)all + 1, sizeof *arm);
  status result = run->body && body && arm ? OK : status_set(ERR_MEMORY, "no memory for bodies");
  for (int k = 0; k < n && result == OK; k++) result = start_body(run, k, body, arm);
  if (result == OK) {
    memory_from_host(run->view->p.body, body, sizeof *body * (size_t)all);
    memory_from_host(run->view->p.arm, arm, sizeof *arm * (size_t)all);
    bodies_drive(run, 0);
  }
  free(body);
  free(arm);
  return result;
}

void bodies_free(struct run *run)
{
  for (int k = 0; run->body && k < run->scene.num_bodies; k++) free(run->body[k].arm);
  free(run->body);
  run->body = NULL;
}

/* --- motion */

static struct pose pose_of(const struct body *b)
{
  struct pose pose;
  for (int d = 0; d < DIM; d++) {
    pose.centre.c[d] = (real)b->centre[d];
    pose.velocity.c[d] = (real)b->velocity[d];
    for (int e = 0; e < DIM; e++) pose.turn[d].c[e] = (real)b->turn[e][d];
  }
  for (int d = 0; d < 3; d++) pose.spin[d] = (real)b->spin[d];
  return pose;
}

static struct carrying carrying(const struct run *run)
{
  struct carrying s;
  memset(&s, 0, sizeof s);
  for (int k = 0; k < run->scene.num_bodies; k++) s.pose[k] = pose_of(&run->body[k]);
  return s;
}

void bodies_drive(struct run *run, double time)
{
  if (!run->body) return;
  for (int k = 0; k < run->scene.num_bodies; k++) {
    struct body *b = &run->body[k];
    const struct scene_body *as = &b->as_built;
    if (as->density > 0) continue;
    const double now = as->period > 0 ? cos(2 * M_PI * time / as->period) : 1;
    for (int d = 0; d < DIM; d++) b->velocity[d] = now * (double)as->velocity.c[d];
    for (int d = DIM == 2 ? 2 : 0; d < 3; d++) b->spin[d] = now * as->spin[d];
  }
  struct carrying s = carrying(run);
  physics_carry(run->view, &s);
}

void bodies_move(struct run *run, double dt)
{
  if (!run->body) return;
  for (int k = 0; k < run->scene.num_bodies; k++) {
    struct body *b = &run->body[k];
    const double angle[3] = {dt * b->spin[0], dt * b->spin[1], dt * b->spin[2]};
    for (int d = 0; d < DIM; d++) b->centre[d] += dt * b->velocity[d];
    rotate(b->turn, angle);
  }
  struct carrying s = carrying(run);
  physics_place(run->view, &s);
}

/* A body that sticks out of the domain is put back and stops there; without bounce or friction. */
static void keep_inside(const struct scene *s, struct body *b)
{
  const struct pose pose = pose_of(b);
  const double half = s->common.spacing / 2;
  for (int d = 0; d < DIM; d++) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    if (s->period.c[d] > 0) continue;
    for (int k = 0; k < b->num_arms; k++) {
      const double at = (double)body_point(&pose, b->arm[k]).c[d];
      low = fmin(low, at - half);
      high = fmax(high, at + half);
    }
    const double below = (double)s->low.c[d] - low, above = high - (double)s->high.c[d];
    if (below > 0) b->centre[d] += below, b->velocity[d] = fmax(b->velocity[d], 0);
    if (above > 0) b->centre[d] -= above, b->velocity[d] = fmin(b->velocity[d], 0);
  }
}

static void push_body(struct run *run, int number, struct carrying *s, double dt)
{
  struct body *b = &run->body[number];
  double force[3], torque[3], I[3][3];
  s->which = number + 1;
  s->mirrored = run->solver->mirrors && run->solver->mirrors(run->state);
  physics_push(run->view, s, force, torque);
  for (int d = 0; d < DIM; d++)
    b->velocity[d] += dt * (force[d] / b->mass + (double)run->view->gravity.c[d]);
  for (int d = 0; d < 3; d++) b->angular[d] += dt * torque[d];
  inertia_now(b, I);
  solve(b->spin, I, b->angular);
  keep_inside(&run->scene, b);
}

void bodies_push(struct run *run, double dt)
{
  int free_ones = 0;
  struct carrying s = run->body ? carrying(run) : (struct carrying){0};
  for (int k = 0; run->body && k < run->scene.num_bodies; k++)
    if (run->body[k].as_built.density > 0) {
      push_body(run, k, &s, dt);
      free_ones++;
    }
  if (!free_ones) return;
  s = carrying(run);
  physics_place(run->view, &s);
  physics_carry(run->view, &s);
}

/* Axis times angle of R, from its trace and its skew part; angles in [0, pi). */
static void turn_of(const struct body *b, double turn[3])
{
  const double trace = b->turn[0][0] + b->turn[1][1] + b->turn[2][2];
  const double angle = acos(fmax(-1, fmin(1, (trace - 1) / 2)));
  const double per_skew = angle > 1e-9 ? angle / (2 * sin(angle)) : 0.5;
  for (int d = 0; d < 3; d++) {
    const int k = (d + 1) % 3, l = (d + 2) % 3;
    turn[d] = per_skew * (b->turn[l][k] - b->turn[k][l]);
  }
}

int bodies_report(const struct run *run, struct fact *facts)
{
  static char names[MOST_BODIES][2][3][32];
  int n = 0;
  for (int k = 0; run->body && k < run->scene.num_bodies; k++) {
    double turn[3];
    turn_of(&run->body[k], turn);
    for (int d = 0; d < 3; d++) {
      char(*name)[3][32] = names[k];
      snprintf(name[0][d], sizeof name[0][d], "body%d_%c", k + 1, "xyz"[d]);
      snprintf(name[1][d], sizeof name[1][d], "body%d_turn_%c", k + 1, "xyz"[d]);
      if (d < DIM)
        facts[n++] =
          (struct fact){name[0][d], "m", "centre of the body", run->body[k].centre[d], NULL};
      if (DIM == 3 || d == 2)
        facts[n++] =
          (struct fact){name[1][d], "rad", "its rotation: axis times angle", turn[d], NULL};
    }
  }
  return n;
}
