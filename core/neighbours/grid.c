/* Where the cells of a step lie. */
#include "neighbours.h"

#include <assert.h>
#include <float.h>

#define CELLS_PER_PARTICLE 4
#define SPARE_CELLS 4096
#define MOST_CELLS 1e9
#define MANY 65536 /* particles, below which threads cost more than they save */

#ifdef REAL_IS_FLOAT
#define ROUNDING ((double)FLT_EPSILON)
#else
#define ROUNDING DBL_EPSILON
#endif

static int is_prime(int n)
{
  for (int k = 2; (long long)k * k <= n; k++)
    if (n % k == 0) return 0;
  return n > 1;
}

/* The largest prime up to `most` that no axis has yet. A line of particles along any direction of
 * the lattice then meets as many cells as it can before it meets one again. */
static int new_prime(int most, const int cells[DIM])
{
  for (int n = most; n > 2; n--) {
    int taken = 0;
    for (int d = 0; d < DIM; d++) taken |= cells[d] == n;
    if (!taken && is_prime(n)) return n;
  }
  return 2;
}

/* Axes that want few cells get them; the others share what is left alike. Returns the axes that got
 * less, as bits. */
static int share_cells(const double want[DIM], double budget, int cells[DIM])
{
  int done = 0, cut = 0;
  for (int d = 0; d < DIM; d++) cells[d] = 0;
  for (int left = DIM; left > 0; left--) {
    int least = -1;
    for (int d = 0; d < DIM; d++)
      if (!(done >> d & 1) && (least < 0 || want[d] < want[least])) least = d;
    const double fair = left == 1 ? budget : pow(budget, 1.0 / left);
    done |= 1 << least;
    if (want[least] <= fair) {
      cells[least] = (int)want[least];
    } else {
      cells[least] = new_prime((int)fair, cells);
      cut |= 1 << least;
    }
    budget /= cells[least];
  }
  return cut;
}

/* How many cells of at least this side an axis wants. */
static double cells_wanted(double extent, double side, int periodic)
{
  const double want = floor(extent / side) + !periodic;
  if (!(want >= 1)) return 1;
  return want < 1e18 ? want : 1e18;
}

status grid_fit(struct grid *grid, vec low, vec high, vec period, real support, int n)
{
  assert(support > 0);
  double want[DIM], side[DIM];
  grid->wraps = 0;
  for (int d = 0; d < DIM; d++) {
    const int periodic = period.c[d] > 0;
    const double R = (double)support, P = periodic ? (double)period.c[d] : R;
    if (periodic && P < 2 * R)
      return user_error("the period of %g m along %c is shorter than two support radii of %g m, "
                        "so that a particle would meet two images of another",
                        P, "xyz"[d], R);
    grid->wraps |= periodic << d;
    /* cells and distances are rounded; across a period, by the last digit of the period */
    side[d] = R * (1 + 1e-6 + 4 * ROUNDING * P / R);
    want[d] = cells_wanted(periodic ? P : (double)high.c[d] - (double)low.c[d], side[d], periodic);
  }
  const double budget = CELLS_PER_PARTICLE * (double)n + SPARE_CELLS;
  const int cut = share_cells(want, budget < MOST_CELLS ? budget : MOST_CELLS, grid->cells);
  grid->wraps |= cut;
  grid->num_cells = 1;
  grid->low = low;
  for (int d = 0; d < DIM; d++) {
    const double turns = floor(want[d] / grid->cells[d]);
    if (period.c[d] > 0)
      side[d] = (double)period.c[d] / (turns * grid->cells[d]);
    else if (cut >> d & 1) /* near the origin: from a corner at 1e30 all look alike */
      grid->low.c[d] = smaller(larger(0, low.c[d]), high.c[d]);
    grid->inv_side.c[d] = (real)(1 / side[d]);
    grid->num_cells *= grid->cells[d];
  }
  grid->period = period;
  grid->support = support;
  return OK;
}

/* Least and most are exact in any order, so the reduction gives the same bits for any number of
 * threads. */
int positions_bounds(const vec *x, int n, vec *low, vec *high)
{
  int bad = 0;
  real least[DIM], most[DIM];
  for (int d = 0; d < DIM; d++) {
    least[d] = (real)INFINITY;
    most[d] = -(real)INFINITY;
  }
#pragma omp parallel for schedule(static) if (n > MANY) \
    reduction(min : least[:DIM]) reduction(max : most[:DIM]) reduction(+ : bad)
  for (int i = 0; i < n; i++) {
    const vec a = x[i];
    int finite = 1;
    for (int d = 0; d < DIM; d++) finite &= a.c[d] - a.c[d] == 0;
    bad += !finite;
    for (int d = 0; finite && d < DIM; d++) {
      least[d] = smaller(a.c[d], least[d]);
      most[d] = larger(a.c[d], most[d]);
    }
  }
  for (int d = 0; d < DIM; d++) {
    low->c[d] = bad < n ? least[d] + 0 : 0; /* + 0: no -0 */
    high->c[d] = bad < n ? most[d] + 0 : 0;
  }
  return bad;
}
