/* anderson.h - Anderson acceleration (Anderson 1965, doi:10.1145/321296.321305; in the form of
 * Walker & Ni 2011, doi:10.1137/10078356X) of a fixed-point iteration x <- g(x) of any field: the
 * next value that the iteration proposes is replaced by a better one,
 *   x_{k+1} = g_k - sum_j gamma_j (g_{j+1} - g_j),   j = k-m .. k-1,
 *   gamma = argmin |f_k - sum_j gamma_j (f_{j+1} - f_j)|,   f = g(x) - x,
 * which is sum_j a_j g_j with sum_j a_j = 1 and the smallest |sum_j a_j f_j|. */
#ifndef ANDERSON_H
#define ANDERSON_H
#include "../sph/sweep.h"
#ifdef __cplusplus
extern "C" {
#endif

enum { ANDERSON_MOST = 5 };

/* A field as a list of reals. */
struct anderson_field {
  int n;                   /* 0: there is none */
  real *g;                 /* in: g(x_k); out: x_{k+1} [n] */
  real *dg[ANDERSON_MOST]; /* work: differences of g [n] each; the newest may hold g itself */
};

struct anderson {
  int depth;                    /* m, 1 .. ANDERSON_MOST */
  struct anderson_field field;  /* what f is measured on */
  const real *x;                /* x_k of that field [field.n] */
  real *df[ANDERSON_MOST];      /* work: differences of f [field.n] each */
  struct anderson_field follow; /* takes the same gamma: what depends on the field linearly */
  /* the rest is begun by anderson_begin */
  int columns, slot;                         /* differences known; where the last f and g are */
  int has_last;                              /* are there last f and g? */
  double gram[ANDERSON_MOST][ANDERSON_MOST]; /* of the columns of df, by slot */
  real gamma[ANDERSON_MOST];                 /* by slot, 0 where there is no column */
  const real *left, *right;                  /* of the inner product being taken */
};

/* Forget the past: the next advance is a plain step. */
void anderson_begin(struct anderson *s);

/* Replace g by x_{k+1}, for both fields. Columns that newer ones span already are left out. */
void anderson_advance(struct anderson *s);

/* In place of advance, where the last step turned out to be a bad one: g = what the iteration
 * proposed before that step; forgets the past. Only after an advance. */
void anderson_retreat(struct anderson *s);

#ifdef __cplusplus
}
#endif
#endif
