/* recipe.h - what a figure shows: paper-figures/<name>/recipe.yaml (docs/figures.md). */
#ifndef RECIPE_H
#define RECIPE_H
#include <stdbool.h>
#include "../../core/base/yaml_source.h"
#include "files.h"

/* Runs of one scene: every solver with every value of the varied parameter. */
struct recipe_runs {
  char *scene;
  char *label;    /* what tells these runs from others of the same solver; NULL: nothing */
  char **solvers; /* none: all that there are */
  unsigned num_solvers;
  char *dim, *precision, *dt, *t_end, *spacing, *frames; /* NULL: the default */
  char **set;                                            /* KEY=VALUE */
  unsigned num_set;
  struct recipe_vary {
    char *name, **values;
    unsigned num_values;
  } * vary; /* NULL: nothing is varied */
  struct recipe_size {
    char *dt, *t_end, *spacing, *frames;
    char **set;
    unsigned num_set;
    struct recipe_vary *vary;
  } * at_paper_size; /* what is otherwise at --size paper; NULL: nothing */
};

/* Data that is drawn over the runs' own: columns 1 and 2 of a CSV file. */
struct recipe_overlay {
  char *file;              /* relative to the recipe's folder */
  char *title;             /* NULL: none */
  char *about;             /* where it is from */
  double scale_x, scale_y; /* factors on the columns; 0: 1 */
  double time;             /* frames: of the frame that it belongs to [s] */
};

enum extract_kind {
  EXTRACT_FRAMES,
  EXTRACT_SERIES,
  EXTRACT_METRIC,
  EXTRACT_TABLE,
  EXTRACT_PROGRAM
};

struct recipe {
  struct yaml_source *source; /* the file, for places in it */
  char *name, *about, *statement;
  int order;     /* of the figures in a report */
  bool standard; /* belongs to --standard */
  char *paper;   /* whose figure it is, its `place` in there, and what differs; NULL: our own */
  char *place, *departures;
  char *runs_of; /* another recipe whose runs these are; NULL: none */
  struct recipe_runs *runs;
  unsigned num_runs;
  struct recipe_extract {
    enum extract_kind kind;
    double *times; /* frames [s] */
    unsigned num_times;
    char *colour;   /* frames: quantity, "speed" or an array of the result file */
    char **columns; /* series, metric, table: names of metrics; table: also keys with dots */
    unsigned num_columns;
    struct recipe_beside {
      char *file, *about;
    } * beside;       /* table: a CSV file whose first column is a run's label; NULL: none */
    char *program;    /* program: sphbench-analysis-NAME */
    char **arguments; /* its first ones */
    unsigned num_arguments;
    double scale_x; /* series: factor on the time; 0: 1 */
    bool fit;       /* metric: the order, by least squares in logarithms */
  } extract;
  struct recipe_labels {
    char *x, *y, *colour;
  } labels;
  double *windows; /* frames: x0, x1, y0, y1 of each time [m], or of all */
  unsigned num_windows;
  double *colours; /* frames: lowest and highest value of the colour scale */
  unsigned num_colours;
  struct recipe_overlay *overlays;
  unsigned num_overlays;
};

/* The folder paper-figures/<name>, or `name` itself where it holds a '/'. */
struct path recipe_folder(const char *name);

/* Read and check FOLDER/recipe.yaml; to be released by recipe_free. ERR_USER with file, line and
 * column; an unknown name is answered with the nearest. */
status recipe_read(const char *name, struct recipe **recipe);

/* Let at_paper_size hold in all runs: what is given there replaces what stands in the run, of `set`
 * entry by entry. */
status recipe_at_paper_size(struct recipe *recipe);

/* Is it drawn at the paper's size, where `paper_size` is what was asked for? A recipe that has only
 * one size has that of the paper. */
bool recipe_is_paper_size(const struct recipe *recipe, bool paper_size);

void recipe_free(struct recipe *recipe);

/* Names of all recipes in paper-figures. */
struct names recipe_names(void);

#endif
