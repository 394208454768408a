/* front.h - the verbs that this program carries out itself; argv is the whole command line. */
#ifndef FRONT_H
#define FRONT_H
#include "../../core/base/status.h"

status verb_figure(int argc, char **argv);
status verb_frames(int argc, char **argv);
status verb_report(int argc, char **argv);
status verb_precision(int argc, char **argv);
status verb_stability(int argc, char **argv);
status verb_convergence(int argc, char **argv);
status verb_profile(int argc, char **argv);
status verb_claims(int argc, char **argv);
status verb_doctor(int argc, char **argv);
status verb_compare(int argc, char **argv);
status verb_sweep(int argc, char **argv);
status verb_bless(int argc, char **argv);

/* `list` without a kind, or of figures, variants, plans; the other kinds are the variants' own. */
status verb_list(int argc, char **argv);

/* `show NAME` for a figure; *mine is 0 where NAME is none, and nothing was shown. */
status show_figure(int argc, char **argv, int *mine);

#endif
