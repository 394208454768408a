/* index.h - one page over all figures that were drawn, with the verdicts of the claims. */
#ifndef INDEX_H
#define INDEX_H
#include "../../core/base/status.h"

/* Write FOLDER/index.html of the figures in there, with RESULTS/claims.json where that is; nothing
 * where there is no figure. ERR_IO, ERR_MEMORY. */
status index_write(const char *results, const char *folder);

#endif
