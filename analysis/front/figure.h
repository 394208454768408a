/* figure.h - from a recipe to runs, data files and pictures. */
#ifndef FIGURE_H
#define FIGURE_H
#include <jansson.h>
#include "recipe.h"
#include "runs.h"

/* The solvers that the variants know; the number of one in this list is its colour and mark in
 * every figure. ERR_USER: no variant is built; ERR_IO. */
status solver_names(struct names *names);

/* The number, from 1, of a solver that --solvers names. ERR_USER, with the nearest known name. */
status solver_number(const struct names *all, const char *name, int *number);

/* Line types of style.gp: a solver has that of its number, its other forms those beyond. */
enum { MOST_COLOURS = 20 };

/* One curve or one row of frames: a run, or with a varied parameter one point of a curve. */
struct figure_case {
  int run;     /* in the queue */
  int colour;  /* number of the solver, from 1; MOST_COLOURS more for each label of its runs */
  int group;   /* cases of one curve have the same */
  char *curve; /* the solver, and what the recipe adds to tell it from itself */
  char *label; /* the same with the value of the varied parameter: "name, spacing 0.01" */
  const char *solver, *value; /* value of the varied parameter, NULL: none */
  const char *name;           /* what its recipe calls these runs, NULL: nothing */
};

struct figure {
  struct recipe *recipe;
  struct path folder, data; /* of the recipe; where its data files go */
  struct path out;          /* where pictures and tables go */
  struct figure_case *cases;
  int n, num_groups;
  const struct names *solvers; /* all that there are */
  bool paper_size;             /* as asked for; otherwise what a desk computer does in minutes */
  struct path size;            /* in words, once extracted; "": it has no runs */
  json_t *files;               /* what was written: [{file, series, columns: [...]}] */
  json_t *values;              /* numbers that its program found: {name: number}; NULL: none */
};

/* Read a recipe and add its runs to the queue. ERR_USER, ERR_MEMORY, ERR_IO. */
struct figure_request {
  const char *name;
  bool paper_size;
  const struct names *solvers; /* stay the caller's */
};
status figure_prepare(struct figure *figure, const struct figure_request *request,
                      struct queue *queue);
void figure_free(struct figure *figure);

/* Write the data files and contents.gp into figure->data (extract.c). A run without the data that
 * is asked for leaves a gap. ERR_IO, ERR_USER: nothing at all can be drawn. */
status figure_extract(struct figure *figure, const struct queue *queue);

/* The parts of the latter for each kind of figure (extract_frames.c, extract_curves.c,
 * extract_table.c, extract_program.c); `contents` is contents.gp. */
status extract_frames(struct figure *figure, const struct queue *queue, FILE *contents);
status extract_series(struct figure *figure, const struct queue *queue, FILE *contents);
status extract_metric(struct figure *figure, const struct queue *queue, FILE *contents);
status extract_table(struct figure *figure, const struct queue *queue, FILE *contents);
status extract_program(struct figure *figure, const struct queue *queue, FILE *contents);

/* What they share: a data file, listed in figure->files under `series`; columns are separated by
 * '|'. The name that is used for a label in file names. Text in contents.gp. */
status data_begin(struct figure *figure, struct new_file *file, const char *name,
                  const char *series, const char *columns);
struct path data_name(const char *label, const char *suffix);
void put_text(FILE *contents, const char *name, int number, const char *text);

/* Lists of `n` curves in contents.gp, and one of them. */
void put_lists(FILE *contents, int n);
void put_curve(FILE *contents, int number, const char *file, const char *title, int colour);

/* A number of a run's facts: keys with dots ("iterations.max"), the name of a metric (its final
 * value), "iterations" (mean per step), a time of `timing` ("per_step"), "ok" (1, or 0), or
 * largest, smallest, first or last of a series ("largest.kinetic_energy"). NaN: there is none. */
double fact_value(const json_t *facts, const char *name);
/* Its unit, where it is known. */
const char *fact_unit(const json_t *facts, const char *name);

/* The facts of a run that has some (its --json file), NULL otherwise; to be released. */
json_t *run_facts_json(const struct queue *queue, int run);

/* Draw the data in a folder, with contents.gp, by a script: OUT/<name>.svg and .png. Not drawn
 * again where they are newer than data and scripts. ERR_USER: gnuplot is missing or the script
 * fails. */
struct drawing {
  const char *name, *out;
  struct path script, data;
};
status drawing_make(const struct drawing *drawing);

/* Draw figure->data with gnuplot; OUT/<name>.svg and .png. ERR_USER: gnuplot is missing or its
 * script fails. */
status figure_draw(struct figure *figure, const char *out);
status gnuplot_check(void);

#endif
