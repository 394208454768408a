/* What the solvers tell of a scene before it is run, and what became of a run. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "figure.h"
#include "process.h"
#include "stability.h"

const char *const verdict_words[NUM_VERDICTS] = {"crashed",
#define CRITERION(name, word, unit, limit, blow_up, meaning) word,
#include "../../core/run/criteria.def"
#undef CRITERION
                                                 "stable", "timeout", "skipped"};

enum verdict verdict_named(const char *word)
{
  for (int k = 0; k < NUM_VERDICTS; k++)
    if (word && strcmp(word, verdict_words[k]) == 0) return (enum verdict)k;
  return NUM_VERDICTS;
}

/* --- requests --- */

struct words {
  char dt[32], seed[32], jitter[48];
  char *set[MOST_SETS + 4];
};

static struct run_request request_of(const struct stability *s, const struct trial *t,
                                     struct words *w)
{
  struct run_request r = {.scene = s->scene,
                          .solver = s->solver[t->method].name,
                          .dim = s->dim,
                          .precision = s->precision,
                          .backend = s->backend,
                          .spacing = s->spacing,
                          .t_end = s->t_end,
                          .frames = "1"};
  if (t->dt > 0) {
    snprintf(w->dt, sizeof w->dt, "%.6g", t->dt);
    r.dt = w->dt;
  }
  for (int k = 0; k < s->num_sets; k++) w->set[r.num_sets++] = s->set[k];
  if (s->jitter > 0) {
    snprintf(w->jitter, sizeof w->jitter, "jitter=%.6g", s->jitter);
    w->set[r.num_sets++] = w->jitter;
  }
  snprintf(w->seed, sizeof w->seed, "%ld", t->seed);
  r.seed = w->seed;
  if (t->row >= 0) {
    r.vary = s->map.key;
    r.value = s->map.value[t->row];
    if (strcmp(r.vary, "spacing") == 0) r.spacing = NULL;
    if (strcmp(r.vary, "t_end") == 0) r.t_end = NULL;
  }
  r.set = w->set;
  return r;
}

status trial_add(struct stability *s, int method, double dt, long seed, int row)
{
  struct words words;
  if (s->n == s->room) {
    const int room = s->room ? 2 * s->room : 64;
    struct trial *more = realloc(s->trial, (size_t)room * sizeof *more);
    if (!more) return status_set(ERR_MEMORY, "out of memory");
    s->trial = more;
    s->room = room;
  }
  struct trial *t = &s->trial[s->n];
  *t = (struct trial){.method = method, .row = row, .dt = dt, .seed = seed, .time = (double)NAN};
  t->verdict = t->first = VERDICT_STABLE;
  const struct run_request request = request_of(s, t, &words);
  const int before = s->queue.n;
  TRY(queue_add(&s->queue, &request, &t->run));
  s->n++;
  if (s->fresh && t->run >= before) s->queue.run[t->run].finished = 0;
  return OK;
}

/* --- what became of them --- */

void facts_judge(const json_t *facts, unsigned ignored, struct trial *t)
{
  const json_t *list = json_object_get(facts, "judged"), *row;
  size_t k;
  json_array_foreach(list, k, row)
  {
    const enum verdict found = verdict_named(json_string_value(json_object_get(row, "criterion")));
    if (found == VERDICT_LEAK) t->leaks = (int)json_number_value(json_object_get(row, "value"));
    if (found >= VERDICT_LEAK || ignored >> found & 1u) continue;
    if (t->first == VERDICT_STABLE) {
      t->first = found;
      t->time = json_number_value(json_object_get(row, "time"));
    }
    if (found < t->verdict) t->verdict = found;
  }
  t->speed_max = fact_number(facts, "speed_max");
}

static void set_verdict(struct trial *t, enum verdict verdict) { t->verdict = t->first = verdict; }

void trial_read(struct stability *s, struct trial *t)
{
  const struct run *run = &s->queue.run[t->run];
  set_verdict(t, VERDICT_STABLE);
  t->time = (double)NAN;
  if (run->outcome == OUTCOME_CRASHED) set_verdict(t, VERDICT_CRASHED);
  if (run->outcome == OUTCOME_TIMEOUT) set_verdict(t, VERDICT_TIMEOUT);
  if (run->outcome == OUTCOME_UNABLE) set_verdict(t, VERDICT_UNABLE);
  if (t->verdict != VERDICT_STABLE) return;
  json_t *facts = run_facts_json(&s->queue, t->run);
  if (facts) facts_judge(facts, s->ignored, t);
  if (!facts) set_verdict(t, VERDICT_CRASHED);
  json_decref(facts);
}

/* --- what a dry run tells --- */

/* The value behind a parameter's name; NaN: there is none, or it is a word. */
static double told_number(const char *log, const char *name)
{
  const struct path line = path_of("\n  %s ", name);
  const char *at = strstr(log, line.text);
  if (!at) return (double)NAN;
  at += strlen(line.text);
  char *end;
  const double value = strtod(at, &end);
  return end == at ? (double)NAN : value;
}

static int told_word(const char *log, const char *name, const char *word)
{
  const struct path line = path_of("\n  %s ", name);
  const char *at = strstr(log, line.text);
  if (!at) return 0;
  at += strlen(line.text);
  at += strspn(at, " ");
  return strncmp(at, word, strlen(word)) == 0;
}

/* A method that takes its pressure from a speed of sound, and does not divide its steps by it. */
static double explicit_sound(const char *log)
{
  const double c = told_number(log, "c"), cfl = told_number(log, "cfl");
  const int divides = !isnan(cfl) && !(told_number(log, "max_substeps") <= 1);
  return isnan(c) || divides ? 0 : c;
}

static void take_told(struct candidate_solver *c, const char *log)
{
  c->dt = told_number(log, "dt");
  c->t_end = told_number(log, "t_end");
  c->spacing = told_number(log, "spacing");
  c->support = told_number(log, "support");
  c->rho0 = told_number(log, "rho0");
  c->viscosity = told_number(log, "viscosity");
  c->sound = explicit_sound(log);
  c->implicit_viscosity = told_word(log, "viscosity_form", "implicit");
}

/* Start a run of trial 0 with --dry-run, its words into a log; *code is how it ended. */
static status start_dry(const struct run *run, const char *log, int *code)
{
  const char **argv = calloc((size_t)run->argc + 3, sizeof *argv);
  if (!argv) return status_set(ERR_MEMORY, "out of memory");
  argv[0] = run->executable.text;
  for (int k = 0; k < run->argc; k++) argv[1 + k] = run->argv[k];
  argv[1 + run->argc] = "--dry-run";
  const struct process process = {.argv = argv, .log = log, .one_thread = 1};
  const status result = process_wait(&process, code);
  free(argv);
  return result;
}

static status ask_dry(struct stability *s, int number, const char *log)
{
  struct words words;
  struct run run = {.argc = 0};
  struct candidate_solver *c = &s->solver[number];
  const double dt = s->dt ? strtod(s->dt, NULL) : 0;
  const struct trial wanted = {.method = number, .row = -1, .seed = 1, .dt = dt};
  const struct run_request request = request_of(s, &wanted, &words);
  int code = 0;
  status result = run_make(&request, &run);
  if (result == OK) result = start_dry(&run, log, &code);
  run_release(&run);
  if (result != OK) return result;
  if (code != 0) {
    c->refusal = run_last_words(log);
    return OK;
  }
  char *text = NULL;
  size_t size;
  TRY(file_read(log, &text, &size));
  take_told(c, text);
  free(text);
  return OK;
}

/* --- the solvers --- */

static status add_solver(struct stability *s, const struct names *all, const char *name)
{
  int number;
  TRY(solver_number(all, name, &number));
  for (int k = 0; k < s->num_solvers; k++)
    if (strcmp(s->solver[k].name, name) == 0)
      return user_error("--solvers: '%s' is named twice", name);
  if (s->num_solvers == MOST_METHODS) return user_error("--solvers: more than %d", MOST_METHODS);
  s->solver[s->num_solvers++] = (struct candidate_solver){
    .name = strdup(name), .colour = number, .failed = HUGE_VAL, .reason = VERDICT_STABLE};
  return OK;
}

static status choose_solvers(struct stability *s, const char *wanted)
{
  struct names all;
  TRY(solver_names(&all));
  status result = OK;
  char *text = wanted ? strdup(wanted) : NULL;
  for (int k = 0; !wanted && k < all.n && result == OK; k++)
    result = add_solver(s, &all, all.name[k]);
  for (char *rest = text, *name; result == OK && rest && (name = strsep(&rest, ","));)
    result = add_solver(s, &all, name);
  free(text);
  names_free(&all);
  return result;
}

status stability_learn(struct stability *s, const char *solvers)
{
  const struct path log = path_of("%s/check-%d.tmp", s->folder.text, (int)getpid());
  int able = 0;
  TRY(choose_solvers(s, solvers));
  status result = folder_make(s->folder.text);
  for (int k = 0; k < s->num_solvers && result == OK; k++) {
    result = ask_dry(s, k, log.text);
    able += !s->solver[k].refusal;
  }
  unlink(log.text);
  if (result != OK || able > 0) return result;
  return user_error("stability: no solver can run this: %s", s->solver[0].refusal);
}
