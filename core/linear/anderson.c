#include "anderson.h"

#define SPANNED 1e-12 /* share of a column's square that must be its own, beyond newer columns */

/* df = f_k - f_{k-1},   f = g - x */
STAGE void difference_f(const struct anderson *s, int i)
{
  s->df[s->slot][i] = s->field.g[i] - s->x[i] - s->df[s->slot][i];
}
/* f_k itself, until there is an f_{k+1} */
STAGE void remember_f(const struct anderson *s, int i)
{
  s->df[s->slot][i] = s->field.g[i] - s->x[i];
}

STAGE real product(const struct anderson *s, int i) { return s->left[i] * s->right[i]; }
/* df_j . f_k */
STAGE real project_f(const struct anderson *s, int i)
{
  return s->left[i] * (s->field.g[i] - s->x[i]);
}

/* One of the two fields, with what its stages need. */
struct mixture {
  struct anderson_field field;
  int depth, slot;
  real gamma[ANDERSON_MOST];
};

/* dg = g_k - g_{k-1} */
STAGE void difference_g(const struct mixture *s, int i)
{
  s->field.dg[s->slot][i] = s->field.g[i] - s->field.dg[s->slot][i];
}
/* x_{k+1} = g_k - sum_j gamma_j dg_j;   g_k is kept in place of the oldest difference */
STAGE void mix(const struct mixture *s, int i)
{
  const real g = s->field.g[i];
  real next = g;
  for (int j = 0; j < s->depth; j++)
    if (s->gamma[j] != 0) next -= s->gamma[j] * s->field.dg[j][i];
  s->field.dg[s->slot][i] = g;
  s->field.g[i] = next;
}
STAGE void go_back(const struct mixture *s, int i) { s->field.g[i] = s->field.dg[s->slot][i]; }

static struct mixture mixture_of(const struct anderson *s, int follower)
{
  struct mixture m;
  m.field = follower ? s->follow : s->field;
  m.depth = s->depth;
  m.slot = s->slot;
  for (int j = 0; j < ANDERSON_MOST; j++) m.gamma[j] = s->gamma[j];
  return m;
}

/* The slot of the k-th newest column. */
static int slot_of(const struct anderson *s, int k) { return (s->slot - k + s->depth) % s->depth; }

static void update_gram(struct anderson *s)
{
  for (int k = 0; k < s->columns; k++) {
    const int j = slot_of(s, k);
    double value;
    s->left = s->df[s->slot];
    s->right = s->df[j];
    sum_over(product, s, s->field.n, &value);
    s->gram[s->slot][j] = s->gram[j][s->slot] = value;
  }
}

/* gamma by Cholesky's factors L of the normal equations, newest column first. */
static void find_gamma(struct anderson *s)
{
  double L[ANDERSON_MOST][ANDERSON_MOST], y[ANDERSON_MOST];
  int used[ANDERSON_MOST], n = 0;
  for (int j = 0; j < ANDERSON_MOST; j++) s->gamma[j] = 0;
  for (int k = 0; k < s->columns; k++) {
    const int j = slot_of(s, k);
    double own = s->gram[j][j], rhs;
    for (int a = 0; a < n; a++) {
      L[n][a] = s->gram[j][used[a]];
      for (int b = 0; b < a; b++) L[n][a] -= L[n][b] * L[a][b];
      L[n][a] /= L[a][a];
      own -= L[n][a] * L[n][a];
    }
    if (!(own > SPANNED * s->gram[j][j])) continue;
    L[n][n] = sqrt(own);
    s->left = s->df[j];
    sum_over(project_f, s, s->field.n, &rhs);
    for (int a = 0; a < n; a++) rhs -= L[n][a] * y[a];
    y[n] = rhs / L[n][n];
    used[n++] = j;
  }
  for (int a = n - 1; a >= 0; a--) {
    double value = y[a];
    for (int b = a + 1; b < n; b++) value -= L[b][a] * (double)s->gamma[used[b]];
    s->gamma[used[a]] = (real)(value / L[a][a]);
  }
}

void anderson_begin(struct anderson *s)
{
  s->columns = s->slot = s->has_last = 0;
  for (int j = 0; j < ANDERSON_MOST; j++) s->gamma[j] = 0;
}

void anderson_advance(struct anderson *s)
{
  if (s->has_last) {
    sweep_over(difference_f, s, s->field.n);
    for (int follower = 0; follower < 2; follower++) {
      const struct mixture m = mixture_of(s, follower);
      sweep_over(difference_g, &m, m.field.n);
    }
    if (s->columns < s->depth) s->columns++;
    update_gram(s);
    find_gamma(s);
    s->slot = (s->slot + 1) % s->depth;
  }
  sweep_over(remember_f, s, s->field.n);
  for (int follower = 0; follower < 2; follower++) {
    const struct mixture m = mixture_of(s, follower);
    sweep_over(mix, &m, m.field.n);
  }
  s->has_last = 1;
}

void anderson_retreat(struct anderson *s)
{
  for (int follower = 0; follower < 2; follower++) {
    const struct mixture m = mixture_of(s, follower);
    sweep_over(go_back, &m, m.field.n);
  }
  anderson_begin(s);
}
