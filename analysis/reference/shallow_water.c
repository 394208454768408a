/* Dam breaks of shallow-water theory. */
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
static double mismatch(const struct reference_wet_bed *w, double hm)
{
  return 2 * (sqrt(w->g * w->hl) - sqrt(w->g * hm)) -
         (hm - w->hr) * sqrt(w->g * (hm + w->hr) / (2 * hm * w->hr));
}

static bool is_wet_bed(const struct reference_wet_bed *w)
{
  return w->g > 0 && w->hr > 0 && w->hl > w->hr && isfinite(w->hl) && isfinite(w->g);
}

struct reference_stoker_states reference_stoker_states(const struct reference_wet_bed *w)
{
  if (!is_wet_bed(w)) return (struct reference_stoker_states){NAN, NAN, NAN, NAN, NAN};
  /* mismatch falls from > 0 at hr to < 0 at hl; halve until no double lies between. */
  double low = w->hr, high = w->hl;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    *(mismatch(w, middle) > 0 ? &low : &high) = middle;
  }
  const double hm = low;
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
