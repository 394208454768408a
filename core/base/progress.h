/* progress.h - a bar with the time left, on a terminal only; nothing when standard error is a file
 * or --quiet was given. */
#ifndef PROGRESS_H
#define PROGRESS_H
#ifdef __cplusplus
extern "C" {
#endif

struct progress {
  const char *label;
  double begun, shown; /* [s] */
  int on;
};

/* Start a bar; `quiet` keeps it off. */
void progress_begin(struct progress *bar, const char *label, int quiet);

/* `done` in [0, 1]; `note` is shown behind the bar. Redraws at most ten times a second. */
void progress_show(struct progress *bar, double done, const char *note);

/* Clear the line. */
void progress_end(struct progress *bar);

#ifdef __cplusplus
}
#endif
#endif
