/* plugins.h - solvers from shared objects (plugin.h), beside those that are built in. */
#ifndef PLUGINS_H
#define PLUGINS_H
#include "../io/run_facts.h"
#include "../solver.h"

/* Load the plug-ins of a comma-separated list of paths and add their solvers to the registry; each
 * path is an object, or the folder or beginning of the names of objects, of which those of this
 * variant are taken. Errors: ERR_USER with one sentence: there is none, it is no plug-in, it was
 * compiled for something else, a slot of its table is missing, its name is taken. */
status plugins_load(const char *paths);

/* The file that a solver came from; NULL: it is built in. */
const char *plugin_file(const struct solver *solver);

/* Add the file and a hash of its content to what a run tells of its origin. */
void plugin_report(const struct solver *solver, struct provenance *provenance);

#endif
