#include "journal.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

const char *const outcome_words[NUM_OUTCOMES] = {
#define O(name, word, meaning) word,
  OUTCOME_LIST(O)
#undef O
};

int journal_count(const struct journal *journal, const char *id)
{
  int n = 0;
  for (int k = 0; k < journal->n; k++) n += strcmp(journal->entry[k].id, id) == 0;
  return n;
}

static void entry_free(struct journal_entry *entry)
{
  free(entry->reason);
  free(entry->scene);
  free(entry->solver);
  free(entry->variant);
  free(entry->what);
}

/* Takes the entry's texts. */
static status keep(struct journal *journal, struct journal_entry *entry)
{
  if (journal->n == journal->room) {
    const int room = journal->room ? 2 * journal->room : 64;
    struct journal_entry *more = realloc(journal->entry, (size_t)room * sizeof *more);
    if (!more) {
      entry_free(entry);
      return status_set(ERR_MEMORY, "out of memory for the journal");
    }
    journal->entry = more;
    journal->room = room;
  }
  journal->entry[journal->n++] = *entry;
  return OK;
}

/* --- reading --- */

static char *text_of(const json_t *object, const char *key)
{
  const char *text = json_string_value(json_object_get(object, key));
  return strdup(text ? text : "");
}

static int outcome_of(const json_t *object)
{
  const char *word = json_string_value(json_object_get(object, "status"));
  int outcome = 0;
  while (word && outcome < NUM_OUTCOMES && strcmp(word, outcome_words[outcome]) != 0) outcome++;
  return word ? outcome : NUM_OUTCOMES;
}

static status take_line(struct journal *journal, const char *line, size_t length)
{
  json_t *object = json_loadb(line, length, 0, NULL);
  const char *id = json_string_value(json_object_get(object, "id"));
  const int outcome = outcome_of(object);
  status result = OK;
  if (id && strlen(id) == HASH_TEXT - 1 && outcome < NUM_OUTCOMES) {
    struct journal_entry entry = {
      .outcome = (enum outcome)outcome,
      .exit_code = (int)json_integer_value(json_object_get(object, "exit")),
      .seconds = json_number_value(json_object_get(object, "seconds")),
      .reason = text_of(object, "reason"),
      .scene = text_of(object, "scene"),
      .solver = text_of(object, "solver"),
      .variant = text_of(object, "variant"),
      .what = text_of(object, "what"),
    };
    const char *date = json_string_value(json_object_get(object, "date"));
    snprintf(entry.id, sizeof entry.id, "%s", id);
    snprintf(entry.date, sizeof entry.date, "%s", date ? date : "");
    result = keep(journal, &entry);
  }
  json_decref(object);
  return result;
}

static status take_lines(struct journal *journal, const char *text)
{
  for (const char *line = text; *line;) {
    const size_t length = strcspn(line, "\n");
    TRY(take_line(journal, line, length));
    line += length + (line[length] == '\n');
  }
  return OK;
}

/* --- writing --- */

static char *line_of(const struct journal_entry *entry)
{
  json_t *object =
    json_pack("{s:s, s:s, s:i, s:s, s:f, s:s, s:s, s:s, s:s, s:s}", "id", entry->id, "status",
              outcome_words[entry->outcome], "exit", entry->exit_code, "reason", entry->reason,
              "seconds", entry->seconds, "scene", entry->scene, "solver", entry->solver, "variant",
              entry->variant, "what", entry->what, "date", entry->date);
  char *text = object ? json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
  json_decref(object);
  char *line = text ? text_make("%s\n", text) : NULL;
  free(text);
  return line;
}

/* What a log holds need not be UTF-8, which JSON must be. */
static char *plain(const char *bytes)
{
  char *copy = strdup(bytes ? bytes : "");
  json_t *valid = copy ? json_string(copy) : NULL;
  for (char *c = copy; c && !valid && *c; c++)
    if ((unsigned char)*c > 126) *c = '?';
  json_decref(valid);
  return copy;
}

/* Adds the entry as it is, with its date. */
static status write_entry(struct journal *journal, const struct journal_entry *entry)
{
  struct journal_entry copy = *entry;
  copy.reason = plain(entry->reason);
  copy.scene = plain(entry->scene);
  copy.solver = plain(entry->solver);
  copy.variant = plain(entry->variant);
  copy.what = plain(entry->what);
  char *line = line_of(&copy);
  status result = line ? OK : status_set(ERR_MEMORY, "out of memory for the journal");
  if (line && write(journal->file, line, strlen(line)) != (ssize_t)strlen(line))
    result = status_set(ERR_IO, "cannot write the journal: %s", strerror(errno));
  free(line);
  if (result == OK) return keep(journal, &copy);
  entry_free(&copy);
  return result;
}

/* A line that a killed process left unfinished must not swallow the next one. */
static void close_torn_line(int file)
{
  char last = '\n';
  const off_t size = lseek(file, 0, SEEK_END);
  if (size > 0 && pread(file, &last, 1, size - 1) == 1 && last != '\n')
    if (write(file, "\n", 1) != 1) return;
}

static status busy(const char *what)
{
  return user_error("another sphbench is running into '%s'; wait for it or choose another "
                    "--results",
                    what);
}

/* Open a file to append to it, locked: LOCK_EX or LOCK_SH. */
static status open_locked(int *file, const char *path, int lock, const char *what)
{
  *file = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (*file < 0) return status_set(ERR_IO, "cannot write '%s': %s", path, strerror(errno));
  return flock(*file, lock | LOCK_NB) ? busy(what) : OK;
}

static status take_file(struct journal *journal, const char *path)
{
  char *text;
  size_t size;
  if (!path_is_file(path)) return OK;
  TRY(file_read(path, &text, &size));
  const status result = take_lines(journal, text);
  free(text);
  return result;
}

/* --- parts --- */

static int is_part(const char *name)
{
  const char *end = strstr(name, ".part.jsonl");
  return strncmp(name, "journal-", 8) == 0 && end && strlen(end) == 11;
}

static status take_parts(struct journal *journal, const char *results)
{
  struct names names = folder_names(results);
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    const struct path path = path_of("%s/%s", results, names.name[k]);
    if (is_part(names.name[k])) result = take_file(journal, path.text);
  }
  names_free(&names);
  return result;
}

/* Was it taken in before, by one who was killed before the part was gone? */
static int is_known(const struct journal *journal, const struct journal_entry *entry)
{
  const struct journal_entry *last = journal_find(journal, entry->id);
  return last && strcmp(last->date, entry->date) == 0 && last->outcome == entry->outcome;
}

/* The lines of a part go into the journal, then the part goes. */
static status fold_part(struct journal *journal, const char *path)
{
  struct journal part = {.file = -1};
  status result = take_file(&part, path);
  for (int k = 0; k < part.n && result == OK; k++)
    if (!is_known(journal, &part.entry[k])) result = write_entry(journal, &part.entry[k]);
  if (result == OK && fsync(journal->file) == 0) unlink(path);
  journal_close(&part);
  return result;
}

static status fold_parts(struct journal *journal, const char *results)
{
  struct names names = folder_names(results);
  status result = OK;
  for (int k = 0; k < names.n && result == OK; k++) {
    const struct path path = path_of("%s/%s", results, names.name[k]);
    if (is_part(names.name[k])) result = fold_part(journal, path.text);
  }
  names_free(&names);
  return result;
}

/* --- opening --- */

status journal_open(struct journal *journal, const char *results, int write)
{
  const struct path path = path_of("%s/journal.jsonl", results);
  *journal = (struct journal){.file = -1};
  status result = write ? open_locked(&journal->file, path.text, LOCK_EX, results) : OK;
  if (result == OK && write) close_torn_line(journal->file);
  if (result == OK) result = take_file(journal, path.text);
  if (result == OK) result = write ? fold_parts(journal, results) : take_parts(journal, results);
  if (result != OK) journal_close(journal);
  return result;
}

status journal_open_part(struct journal *journal, const char *results, const char *name)
{
  const struct path path = path_of("%s/journal.jsonl", results);
  const struct path part = path_of("%s/journal-%s.part.jsonl", results, name);
  *journal = (struct journal){.file = -1};
  status result = open_locked(&journal->shared, path.text, LOCK_SH, results);
  if (result == OK) result = open_locked(&journal->file, part.text, LOCK_EX, part.text);
  if (result == OK) {
    close_torn_line(journal->file);
    result = take_file(journal, path.text);
  }
  if (result == OK) result = take_parts(journal, results);
  if (result != OK) journal_close(journal);
  return result;
}

const struct journal_entry *journal_find(const struct journal *journal, const char *id)
{
  for (int k = journal->n - 1; k >= 0; k--)
    if (strcmp(journal->entry[k].id, id) == 0) return &journal->entry[k];
  return NULL;
}

status journal_add(struct journal *journal, const struct journal_entry *entry)
{
  struct journal_entry dated = *entry;
  const time_t now = time(NULL);
  struct tm utc;
  strftime(dated.date, sizeof dated.date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
  return write_entry(journal, &dated);
}

void journal_close(struct journal *journal)
{
  if (journal->file >= 0) close(journal->file);
  if (journal->shared > 0) close(journal->shared);
  for (int k = 0; k < journal->n; k++) entry_free(&journal->entry[k]);
  free(journal->entry);
  *journal = (struct journal){.file = -1};
}
