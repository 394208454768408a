/* bodies.h - rigid bodies made of wall particles: prescribed or free motion. */
#ifndef BODIES_H
#define BODIES_H
#include "../io/run_facts.h"
#include "../scene/scene.h"
#include "../solver.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Where a body is and how it moves; turn[] are the columns of the rotation R. */
struct pose {
  vec centre, velocity; /* m, m/s */
  vec turn[DIM];        /* 1 */
  real spin[3];         /* rad/s; in 2-D only the last */
};

/* What the stages of bodies see. */
struct carrying {
  VIEW;
  struct pose pose[MOST_BODIES];
  int which, axis; /* body from 1; component */
  real mirrored;   /* 1: p_b = p_i pushes, too; 0: not */
};

/* V + omega x (x - c) */
STAGE vec body_velocity(const struct pose *pose, vec x)
{
  const vec r = sub(x, pose->centre);
  vec v = pose->velocity;
  v.c[0] -= pose->spin[2] * r.c[1];
  v.c[1] += pose->spin[2] * r.c[0];
  if (DIM == 3) {
    v.c[0] += pose->spin[1] * r.c[DIM - 1];
    v.c[1] -= pose->spin[0] * r.c[DIM - 1];
    v.c[DIM - 1] += pose->spin[0] * r.c[1] - pose->spin[1] * r.c[0];
  }
  return v;
}

/* c + R arm */
STAGE vec body_point(const struct pose *pose, vec arm)
{
  vec x = pose->centre;
  for (int d = 0; d < DIM; d++) x = madd(x, arm.c[d], pose->turn[d]);
  return x;
}

/* A body during a run; centre, velocity, turn and spin in double. */
struct body {
  struct scene_body as_built;
  double mass, inertia[3][3]; /* kg; about the centre in the body's own axes [kg m^2] */
  double centre[3], velocity[3], turn[3][3], spin[3], angular[3]; /* angular momentum [kg m^2/s] */
  int num_arms;
  vec *arm; /* of its particles [num_arms] */
};

struct run;

/* Make the run's bodies from its scene; sets p.body and p.arm. Errors: ERR_MEMORY. */
status bodies_start(struct run *run);
/* Velocities of prescribed bodies at `time`, and those of all their particles. */
void bodies_drive(struct run *run, double time);
/* Bodies and their particles move on by dt. */
void bodies_move(struct run *run, double dt);
/* Free bodies: what the fluid's pressure and gravity do to them in dt; those that would leave the
 * domain stop at its border. */
void bodies_push(struct run *run, double dt);
void bodies_free(struct run *run);

/* Where each body is now, as facts: centre [m], axis times angle of its rotation [rad], with names
 * body1_x, .., body1_turn_z. Returns their number, at most MOST_BODIES * BODY_NUMBERS. */
enum { BODY_NUMBERS = 6 };
int bodies_report(const struct run *run, struct fact *facts);

/* physics.c: the particles of bodies get their velocities, their places; the pressure force [N] and
 * torque [N m] of the fluid on body `which`. */
void physics_carry(const struct view *view, struct carrying *s);
void physics_place(const struct view *view, struct carrying *s);
void physics_push(const struct view *view, struct carrying *s, double force[3], double torque[3]);

#ifdef __cplusplus
}
#endif
#endif
