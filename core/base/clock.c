#include "clock.h"

#include <string.h>
#include <time.h>

static double phase_seconds[NUM_PHASES], phase_begun;
static enum phase phase_now;
static struct stage_clock *first_stage, **last_stage = &first_stage;
void (*clock_settle)(void);

double clock_now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

enum phase clock_enter(enum phase phase)
{
  if (clock_settle && phase != phase_now) clock_settle();
  const double now = clock_now();
  const enum phase before = phase_now;
  if (phase_begun > 0) phase_seconds[phase_now] += now - phase_begun;
  phase_begun = now;
  phase_now = phase;
  return before;
}

void clock_phases(double seconds[NUM_PHASES])
{
  clock_enter(phase_now);
  memcpy(seconds, phase_seconds, sizeof phase_seconds);
}

const char *clock_phase_name(enum phase phase)
{
#define P(name, text, about) text,
  static const char *const names[] = {PHASE_LIST(P)};
#undef P
  return names[phase];
}

const char *clock_phase_about(enum phase phase)
{
#define P(name, text, about) about,
  static const char *const texts[] = {PHASE_LIST(P)};
#undef P
  return texts[phase];
}

void clock_reset(void)
{
  memset(phase_seconds, 0, sizeof phase_seconds);
  phase_begun = clock_now();
  for (struct stage_clock *s = first_stage; s; s = s->next) {
    s->seconds = 0;
    s->calls = s->items = 0;
  }
}

double stage_begin(struct stage_clock *stage)
{
  if (!stage->listed) {
    stage->listed = 1;
    *last_stage = stage;
    last_stage = &stage->next;
  }
  return clock_now();
}

void stage_end(struct stage_clock *stage, double begun, long items)
{
  stage->seconds += clock_now() - begun;
  stage->calls++;
  stage->items += items;
}

const struct stage_clock *stage_list(void) { return first_stage; }
