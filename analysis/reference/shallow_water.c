/* Dam breaks of shallow-water theory. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include "internal.h"

/* The rarefaction into water of depth h0: c = sqrt(g h) = (2 c0 - x/t)/3, u = 2 (c0 - c). */
static struct reference_shallow rarefaction(double c0, double g, double speed)
{
  const double c = (2 * c0 - speed) / 3;
  return (struct reference_shallow){sq(c) / g, 2 * (c0 - c)};
}

struct reference_shallow reference_ritter(struct reference_dry_bed d, double x, double t)
{
  if (!(d.h0 > 0 && d.g > 0 && t > 0)) return (struct reference_shallow){NAN, NAN};
  const double c0 = sqrt(d.g * d.h0), speed = x / t;
  if (speed <= -c0) return (struct reference_shallow){d.h0, 0};
  if (speed >= 2 * c0) return (struct reference_shallow){0, 0};
  return rarefaction(c0, d.g, speed);
}

/* Speed behind the rarefaction minus that behind the bore, for the intermediate depth hm. */
static double mismatch(double hm, void *wet_bed)
{
  const struct reference_wet_bed *w = wet_bed;
  return 2 * (sqrt(w->g * w->hl) - sqrt(w->g * hm)) -
         (hm - w->hr) * sqrt(w->g * (hm + w->hr) / (2 * hm * w->hr));
}

/* It falls from > 0 at hr to < 0 at hl: Brent's method (GSL). NaN: no memory. */
static double intermediate_depth(struct reference_wet_bed w)
{
  enum { MOST = 200 };
  const double close = 4e-16;
  gsl_function f = {mismatch, &w};
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  double found = NAN;
  if (!solver) return found;
  int stop = gsl_root_fsolver_set(solver, &f, w.hr, w.hl) != GSL_SUCCESS;
  for (int k = 0; k < MOST && !stop; k++) {
    stop = gsl_root_fsolver_iterate(solver) != GSL_SUCCESS;
    found = gsl_root_fsolver_root(solver);
    stop |= gsl_root_test_interval(gsl_root_fsolver_x_lower(solver),
                                   gsl_root_fsolver_x_upper(solver), 0, close) == GSL_SUCCESS;
  }
  gsl_root_fsolver_free(solver);
  return found;
}

static bool is_wet_bed(const struct reference_wet_bed *w)
{
  return w->g > 0 && w->hr > 0 && w->hl > w->hr && isfinite(w->hl) && isfinite(w->g);
}

struct reference_stoker_states reference_stoker_states(const struct reference_wet_bed *w)
{
  if (!is_wet_bed(w)) return (struct reference_stoker_states){NAN, NAN, NAN, NAN, NAN};
  const double hm = intermediate_depth(*w);
  const double um = 2 * (sqrt(w->g * w->hl) - sqrt(w->g * hm));
  return (struct reference_stoker_states){
    .hm = hm,
    .um = um,
    .bore = sqrt(w->g * hm * (hm + w->hr) / (2 * w->hr)),
    .tail = um - sqrt(w->g * hm),
    .head = -sqrt(w->g * w->hl),
  };
}

struct reference_shallow reference_stoker(const struct reference_wet_bed *w, double x, double t)
{
  if (!is_wet_bed(w) || !(t > 0)) return (struct reference_shallow){NAN, NAN};
  const struct reference_stoker_states s = reference_stoker_states(w);
  const double speed = x / t;
  if (speed <= s.head) return (struct reference_shallow){w->hl, 0};
  if (speed < s.tail) return rarefaction(-s.head, w->g, speed);
  if (speed < s.bore) return (struct reference_shallow){s.hm, s.um};
  return (struct reference_shallow){w->hr, 0};
}
