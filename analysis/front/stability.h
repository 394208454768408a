/* stability.h - the parts of `sphbench stability`: at which time steps a solver still works on a
 * scene, and what ends it beyond. */
#ifndef STABILITY_H
#define STABILITY_H
#include "runs.h"
#include "study.h"

/* What became of a run, the worst first: the criteria of core/run/criteria.def between what has no
 * facts at all and what is stable. */
enum verdict {
  VERDICT_CRASHED,
#define CRITERION(name, word, unit, limit, blow_up, meaning) VERDICT_##name,
#include "../../core/run/criteria.def"
#undef CRITERION
  VERDICT_STABLE,
  VERDICT_TIMEOUT, /* took too long: nothing is known */
  VERDICT_UNABLE,  /* was refused */
  NUM_VERDICTS
};
extern const char *const verdict_words[NUM_VERDICTS];
enum verdict verdict_named(const char *word);

/* One run: a solver at a time step. */
struct trial {
  int method, run; /* run: in the queue */
  int row;         /* of the map; -1: of a limit */
  double dt;       /* [s] */
  long seed;
  enum verdict verdict; /* the worst that is not ignored; a leak is told apart */
  enum verdict first;   /* in time */
  double time;          /* when that held [s]; NaN: never */
  double speed_max;     /* [m/s] */
  int leaks;
};

/* The time steps that theory allows; NaN where it says nothing. docs/stability.md. */
struct prediction {
  double cfl, sound, viscous; /* [s] */
  double least;               /* [s] */
  const char *by;             /* of these */
};

/* A solver on the scene: what a dry run tells, and the search for its largest stable step. */
struct candidate_solver {
  char *name, *refusal; /* refusal: why it cannot run the scene; NULL: it can */
  int colour;
  double dt, t_end, spacing, support, rho0, viscosity; /* of the scene [SI; support in dx] */
  double sound;                                        /* explicit speed of sound; 0: none [m/s] */
  int implicit_viscosity;

  double at;             /* time step that is being looked at */
  double stable, failed; /* largest stable, smallest failed; 0, HUGE_VAL: none yet */
  long seeds;            /* of `at` that were stable so far */
  int settled;
  enum verdict reason; /* at `failed` */
  int run;             /* there */
  int leaks;           /* largest number at `stable` */
  double speed_max;    /* at `stable` */
  struct prediction predicted;
};

/* A map: time step by one parameter more. */
struct map {
  char *key;    /* NULL: none is asked for */
  char **value; /* as typed [rows] */
  int rows;
  struct values dts; /* [s] */
};

struct stability {
  const char *scene, *results, *dim, *precision, *backend, *spacing, *t_end, *dt;
  char *set[MOST_SETS + 2];
  int num_sets;
  double jitter; /* of the starts [dx] */
  long num_seeds;
  int quick, quiet, fresh;
  unsigned ignored; /* bits of verdicts that are no failure */
  struct map map;
  struct queue queue;
  struct path folder; /* results/stability/SCENE */
  struct candidate_solver solver[MOST_METHODS];
  int num_solvers;
  struct trial *trial;
  int n, room;
};

/* stability_runs.c: what the solvers tell of the scene; trials and what became of them. */
status stability_learn(struct stability *s, const char *solvers);
status trial_add(struct stability *s, int method, double dt, long seed, int row);
void trial_read(struct stability *s, struct trial *trial);
/* The worst criterion that a run's facts tell, the first in time, the number of leaks. */
void facts_judge(const json_t *facts, unsigned ignored, struct trial *trial);

/* stability_limits.c: bisection, all solvers side by side. */
status limits_find(struct stability *s);
status map_run(struct stability *s);

/* stability_theory.c */
struct prediction predict(const struct candidate_solver *solver, double spacing, double support,
                          double viscosity, double speed);
/* Of a row of the map, whose parameter may be one of those. */
struct prediction predict_row(const struct stability *s, int method, int row);

/* stability_json.c: stability.json in s->folder and, unless NULL, `also`; what a person reads. */
status stability_write(const struct stability *s, const char *also);
void stability_say(const struct stability *s);

/* stability_draw.c: data files and pictures. */
status stability_draw(const struct stability *s);

/* stability_extreme.c: the plan `extreme`, and its table. */
struct extreme_request {
  const char *solvers, *results, *json, *plan;
  double limit; /* [s] for a run */
  int jobs, quiet, fresh;
};
status extreme_run(const struct extreme_request *request);

#endif
