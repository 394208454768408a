/* What a run is: its arguments, its id, and whether it was done before. */
#include "runs.h"

#include <jansson.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "process.h"
#include "variants.h"

int processors(void)
{
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) ? 1 : CPU_COUNT(&set);
}

struct path run_file(const char *results, const char *id, const char *suffix)
{
  return path_of("%s/runs/%s.%s", results, id, suffix);
}

static status begin(struct queue *queue, const char *results)
{
  const struct path runs = path_of("%s/runs", results);
  *queue = (struct queue){.results = results, .jobs = processors(), .journal = {.file = -1}};
  return folder_make(runs.text);
}

status queue_open(struct queue *queue, const char *results)
{
  TRY(begin(queue, results));
  return journal_open(&queue->journal, results, 1);
}

status queue_open_part(struct queue *queue, const char *results, const char *part)
{
  TRY(begin(queue, results));
  return journal_open_part(&queue->journal, results, part);
}

void run_release(struct run *run)
{
  for (int i = 0; i < run->argc; i++) free(run->argv[i]);
  free(run->argv);
  free(run->what);
  free(run->reason);
}

void queue_close(struct queue *queue)
{
  for (int k = 0; k < queue->n; k++) run_release(&queue->run[k]);
  free(queue->run);
  journal_close(&queue->journal);
  *queue = (struct queue){.journal = {.file = -1}};
}

/* --- arguments --- */

static void add(struct run *run, char *text) { run->argv[run->argc++] = text; }

static void add_flag(struct run *run, const char *flag, const char *value)
{
  if (!value) return;
  add(run, strdup(flag));
  add(run, strdup(value));
}

/* A parameter that has a flag of its own is given by it. */
static void add_varied(struct run *run, const char *name, const char *value)
{
  static const char *const own[][2] = {
    {"spacing", "--spacing"}, {"dt", "--dt"}, {"t_end", "--t-end"}};
  if (!name) return;
  for (size_t k = 0; k < sizeof own / sizeof *own; k++)
    if (strcmp(name, own[k][0]) == 0) {
      add_flag(run, own[k][1], value);
      return;
    }
  add(run, strdup("--set"));
  add(run, text_make("%s=%s", name, value));
}

static status make_arguments(struct run *run, const struct run_request *r)
{
  enum { MOST_OTHERS = 32 };
  run->argv = calloc((size_t)(MOST_OTHERS + 2 * r->num_sets), sizeof *run->argv);
  if (!run->argv) return status_set(ERR_MEMORY, "out of memory");
  add(run, strdup("run"));
  add(run, strdup(r->scene));
  add_flag(run, "--solver", r->solver);
  add_flag(run, "--dim", r->dim);
  add_flag(run, "--precision", r->precision);
  add_flag(run, "--backend", r->backend);
  add_flag(run, "--spacing", r->spacing);
  add_flag(run, "--dt", r->dt);
  add_flag(run, "--t-end", r->t_end);
  add_flag(run, "--frames", r->frames);
  add_flag(run, "--seed", r->seed);
  add_flag(run, "--threads", r->threads);
  if (r->count_pairs) add(run, strdup("--count-pairs"));
  add_varied(run, r->vary, r->value);
  for (int k = 0; k < r->num_sets; k++) add_flag(run, "--set", r->set[k]);
  for (int k = 0; k < run->argc; k++)
    if (!run->argv[k]) return status_set(ERR_MEMORY, "out of memory");
  return OK;
}

/* The arguments from number `first` on, as one text. */
static char *join(const struct run *run, int first)
{
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  for (int k = first; k < run->argc; k++) fprintf(out, "%s%s", k > first ? " " : "", run->argv[k]);
  fclose(out);
  return text;
}

/* --- identity --- */

/* Of an executable's content; read once, since all runs of a queue share few of them. */
static status executable_hash(const struct path *executable, unsigned long long *hash)
{
  static struct path known;
  static unsigned long long known_hash;
  if (strcmp(known.text, executable->text) != 0) {
    unsigned long long fresh = HASH_START;
    TRY(hash_file(&fresh, executable->text));
    known = *executable;
    known_hash = fresh;
  }
  *hash = known_hash;
  return OK;
}

/* The file that a solver of a plug-in comes from, as the executable says; "": it is built in, or
 * nobody knows it. */
static struct path plugin_of(const struct path *executable, const char *solver)
{
  struct path file = {{0}};
  const char *const argv[] = {executable->text, "list", "solvers", "--json", NULL};
  static struct path known;
  static json_t *list;
  if (!getenv("SPHBENCH_PLUGIN")) return file;
  if (strcmp(known.text, executable->text) != 0) {
    char *text = process_output(argv);
    json_decref(list);
    list = text ? json_loads(text, 0, NULL) : NULL;
    known = *executable;
    free(text);
  }
  for (size_t k = 0; k < json_array_size(list); k++) {
    const json_t *row = json_array_get(list, k);
    const char *name = json_string_value(json_object_get(row, "name"));
    const char *from = json_string_value(json_object_get(row, "plugin"));
    if (name && from && solver && strcmp(name, solver) == 0) file = path_of("%s", from);
  }
  return file;
}

static status identify(struct run *run)
{
  const char *scene = run->argv[1];
  unsigned long long hash;
  TRY(executable_hash(&run->executable, &hash));
  for (int k = 0; k < run->argc; k++)
    hash = hash_bytes(hash, run->argv[k], strlen(run->argv[k]) + 1);
  if (path_is_file(scene)) TRY(hash_file(&hash, scene));
  const struct path plugin = plugin_of(&run->executable, run->argv[3]);
  if (*plugin.text) TRY(hash_file(&hash, plugin.text));
  snprintf(run->id, sizeof run->id, "%016llx", hash);
  return OK;
}

/* Does what the journal says still hold? A run that was stopped at a limit may do with a longer or
 * larger one. */
static int is_whole(const struct queue *queue, const struct journal_entry *entry)
{
  if (entry->outcome == OUTCOME_TIMEOUT) return queue->limit > 0 && entry->seconds >= queue->limit;
  if (entry->outcome == OUTCOME_INTERRUPTED) return 0;
  long had;
  if (entry->outcome == OUTCOME_OOM)
    return queue->memory > 0 && sscanf(entry->reason, OOM_REASON, &had) == 1 &&
           had >= queue->memory;
  if (entry->outcome != OUTCOME_OK && entry->outcome != OUTCOME_DIVERGED) return 1;
  const struct path json = run_file(queue->results, entry->id, "json");
  const struct path frames = run_file(queue->results, entry->id, "vtkhdf");
  return path_is_file(json.text) && path_is_file(frames.text);
}

static void look_up(const struct queue *queue, struct run *run)
{
  const struct journal_entry *entry = journal_find(&queue->journal, run->id);
  if (!entry || !is_whole(queue, entry)) return;
  run->finished = 1;
  run->outcome = entry->outcome;
  run->seconds = entry->seconds;
  run->reason = strdup(entry->reason);
}

/* All else from the arguments. */
static status resolve(struct run *run)
{
  struct variant variant = {"openmp", "f64", 2};
  TRY(variant_choose(run->argc, run->argv, &variant));
  TRY(variant_executable(&variant, &run->executable));
  run->name = variant_name(&variant);
  run->what = join(run, 4);
  run->threads = 1;
  for (int k = 4; k + 1 < run->argc; k++)
    if (strcmp(run->argv[k], "--threads") == 0) run->threads = atoi(run->argv[k + 1]);
  return run->what ? identify(run) : status_set(ERR_MEMORY, "out of memory");
}

status run_make(const struct run_request *request, struct run *run)
{
  TRY(make_arguments(run, request));
  return resolve(run);
}

static status make_room(struct queue *queue)
{
  if (queue->n < queue->room) return OK;
  const int room = queue->room ? 2 * queue->room : 64;
  struct run *more = realloc(queue->run, (size_t)room * sizeof *more);
  if (!more) return status_set(ERR_MEMORY, "out of memory");
  queue->run = more;
  queue->room = room;
  return OK;
}

/* Takes the run; one that is there already is released. */
static status take(struct queue *queue, struct run *run, int *number)
{
  for (int k = 0; k < queue->n; k++)
    if (strcmp(queue->run[k].id, run->id) == 0) {
      *number = k;
      run_release(run);
      return OK;
    }
  look_up(queue, run);
  *number = queue->n;
  queue->run[queue->n++] = *run;
  return OK;
}

status queue_add(struct queue *queue, const struct run_request *request, int *number)
{
  struct run run = {.argc = 0};
  TRY(make_room(queue));
  const status result = run_make(request, &run);
  if (result == OK) return take(queue, &run, number);
  run_release(&run);
  return result;
}

status queue_add_arguments(struct queue *queue, const char *const *argv, int argc, int *number)
{
  struct run run = {.argv = calloc((size_t)argc + 1, sizeof(char *))};
  status result = run.argv ? make_room(queue) : status_set(ERR_MEMORY, "out of memory");
  for (int k = 0; k < argc && result == OK; k++) {
    add(&run, strdup(argv[k]));
    if (!run.argv[k]) result = status_set(ERR_MEMORY, "out of memory");
  }
  if (result == OK) result = resolve(&run);
  if (result == OK) return take(queue, &run, number);
  run_release(&run);
  return result;
}

double queue_known_time(const struct queue *queue, const struct run *run)
{
  for (int k = queue->journal.n - 1; k >= 0; k--) {
    const struct journal_entry *e = &queue->journal.entry[k];
    if (e->outcome == OUTCOME_INTERRUPTED) continue;
    if (!strcmp(e->scene, run->argv[1]) && !strcmp(e->solver, run->argv[3]) &&
        !strcmp(e->what, run->what))
      return e->seconds;
  }
  return 0;
}

static double typical_time(const struct queue *queue)
{
  double sum = 0;
  int n = 0;
  for (int k = 0; k < queue->n; k++)
    if (queue->run[k].finished) {
      sum += queue->run[k].seconds;
      n++;
    }
  return n > 0 ? sum / n : 10;
}

double queue_expected_time(const struct queue *queue, const struct run *run)
{
  const double known = queue_known_time(queue, run);
  return known > 0 ? known : typical_time(queue);
}
