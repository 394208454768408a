/* visits.h - how many neighbour pairs the sums of a run visit: a cost that does not depend on the
 * machine. Each walk along a row of a pair list counts the row's pairs, whether it evaluates the
 * kernel or reads kept coefficients; a pair is counted from both its sides. Building lists is not
 * counted, nor is work that walks no list; of a grid's equations each row counts the cells beside.
 */
#ifndef VISITS_H
#define VISITS_H
#include "../neighbours/neighbours.h"
#ifdef __cplusplus
extern "C" {
#endif

struct run;
struct pair_visits;

extern int visits_wanted; /* set before a run is created; a run that does not count pays nothing */

/* To be called when a list of the run was built anew: what its rows have counted is added up, and
 * they count from 0 again. Errors: ERR_MEMORY. */
status visits_renew(struct run *run, struct pair_list *list);

/* Pairs visited so far; 0 where they are not counted. */
double visits_total(const struct run *run);

/* Count on from a total of before, if pairs are counted. */
void visits_resume(struct run *run, double total);

void visits_free(struct run *run);

#ifdef __cplusplus
}
#endif
#endif
