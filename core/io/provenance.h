/* provenance.h - what was built, on what it runs, and what was typed: filled into run_facts. */
#ifndef PROVENANCE_H
#define PROVENANCE_H
#include "run_facts.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Fill all of p but gpu (""). The build gives commit, dirty, compiler and flags
 * (cmake/provenance.cmake); `threads` are those of the run; argv must outlive p. Never fails: what
 * is not known is "unknown". */
void provenance_fill(struct provenance *p, int threads, int argc, const char *const *argv);

/* Add a library that the program uses ("gsl", "2.7"; "cuda", "13.0"); dropped without room. */
void provenance_add_library(struct provenance *p, const char *name, const char *version);

/* The most memory that this process has held [bytes]. */
long provenance_peak_rss(void);

#ifdef __cplusplus
}
#endif
#endif
