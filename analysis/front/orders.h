/* orders.h - the observed order of convergence p in error = C h^p, with its interval. */
#ifndef ORDERS_H
#define ORDERS_H
#include "../../core/base/status.h"

/* The error at one level. */
struct level {
  double h;     /* spacing, or time step */
  double error; /* of one run, or the mean over several starts */
  double sd;    /* of the mean, relative to it; 0: one run */
};

struct order {
  double order, low, high; /* 95 %, by Student's t with n - 2 degrees of freedom */
  double level;            /* log C */
  int n;                   /* levels that have an error */
};

/* Weighted least squares of log error on log h over the levels that have an error > 0 (GSL). The
 * weights are 1/sd^2 where all levels have an sd, else equal; the scatter about the line sets the
 * interval, but where there are sds it is never narrower than they make it. h_reference > 0: the
 * error is the distance from the result at that h, so C (h^p - h_reference^p) is fitted. ERR_USER:
 * fewer than 3 levels with an error; an error against a reference that hardly falls; built without
 * GSL. */
status order_fit(const struct level *levels, int n, double h_reference, struct order *fit);

/* The order between two levels alone; NaN where they have none. */
double order_local(const struct level *coarse, const struct level *fine, double h_reference);

#endif
