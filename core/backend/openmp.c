/* The backend that keeps particles in the host's memory. */
#include "../neighbours/neighbours.h"
#include "backend.h"

status backend_check(void) { return OK; }

const struct search particle_search = {
    .positions_bounds = positions_bounds,
    .cell_sort = cell_sort,
    .permute = permute,
    .pairs_build = pairs_build,
    .keys_unique = keys_unique,
    .pair_list_free = pair_list_free,
    .cell_set_free = cell_set_free,
};
