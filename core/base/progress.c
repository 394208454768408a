#include "progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "clock.h"

enum { WIDTH = 30 };

void progress_begin(struct progress *bar, const char *label, int quiet)
{
  bar->label = label;
  bar->begun = clock_now();
  bar->shown = 0;
  bar->on = !quiet && isatty(STDERR_FILENO);
}

static void print_time(char *buf, size_t size, double seconds)
{
  if (seconds < 60)
    snprintf(buf, size, "%.0f s", seconds);
  else if (seconds < 3600)
    snprintf(buf, size, "%d min %02d s", (int)seconds / 60, (int)seconds % 60);
  else
    snprintf(buf, size, "%d h %02d min", (int)seconds / 3600, (int)seconds % 3600 / 60);
}

void progress_show(struct progress *bar, double done, const char *note)
{
  const double now = clock_now();
  if (!bar->on || now - bar->shown < 0.1) return;
  bar->shown = now;
  char left[32] = "";
  if (done > 0.01) print_time(left, sizeof left, (now - bar->begun) * (1 / done - 1));
  const int full = (int)(done * WIDTH);
  fprintf(stderr, "\r\033[K%s [%.*s%.*s] %3.0f %%  %s%s  %s", bar->label, full,
          "##############################", WIDTH - full, "..............................",
          100 * done, left, left[0] ? " left" : "", note);
  fflush(stderr);
}

void progress_end(struct progress *bar)
{
  if (bar->on) fprintf(stderr, "\r\033[K");
  bar->on = 0;
}
