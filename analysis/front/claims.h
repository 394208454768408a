/* claims.h - statements of the papers, each decided by a rule from the runs of a figure:
 * paper-figures/claims.yaml (docs/figures.md). */
#ifndef CLAIMS_H
#define CLAIMS_H
#include <jansson.h>

#include "files.h"

/* What the runs of a drawn figure say: FIGURES/NAME/figure.json, values.json and its runs' facts.
 */
struct evidence {
  struct path results, figures;
  const char *name;                /* of the figure */
  json_t *figure, *values, *facts; /* as read; facts by the run's id */
};

/* Read a figure's evidence; what is there is released. ERR_USER: it was not drawn. */
status evidence_read(struct evidence *evidence, const char *name);
void evidence_free(struct evidence *evidence);

/* The value of an expression: numbers, + - * / ( ), abs min max log, value.NAME of values.json, and
 * facts of a run, PATH[solver=A, label=TEXT, KEY=VALUE] with PATH as fact_value takes it; the
 * selectors (labels and parameters) must leave exactly one run. ERR_USER: a mistake, no such run,
 * nothing finite. */
status claim_value(struct evidence *evidence, const char *expression, double *value);

/* Does "value <= 1.2" (or < >= >) hold of it? ERR_USER: no such rule. */
status claim_holds(const char *rule, double value, int *holds);

#endif
