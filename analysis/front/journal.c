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

/* A line that a killed process left unfinished must not swallow the next one. */
static void close_torn_line(int file)
{
  char last = '\n';
  const off_t size = lseek(file, 0, SEEK_END);
  if (size > 0 && pread(file, &last, 1, size - 1) == 1 && last != '\n')
    if (write(file, "\n", 1) != 1) return;
}

static status open_to_write(struct journal *journal, const char *path, const char *results)
{
  journal->file = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (journal->file < 0) return status_set(ERR_IO, "cannot write '%s': %s", path, strerror(errno));
  if (flock(journal->file, LOCK_EX | LOCK_NB))
    return user_error("another sphbench is running into '%s'; wait for it or choose another "
                      "--results",
                      results);
  close_torn_line(journal->file);
  return OK;
}

status journal_open(struct journal *journal, const char *results, int write)
{
  const struct path path = path_of("%s/journal.jsonl", results);
  char *text;
  size_t size;
  *journal = (struct journal){.file = -1};
  status result = write ? open_to_write(journal, path.text, results) : OK;
  if (result == OK && path_is_file(path.text)) {
    result = file_read(path.text, &text, &size);
    if (result == OK) result = take_lines(journal, text);
    free(text);
  }
  if (result != OK) journal_close(journal);
  return result;
}

const struct journal_entry *journal_find(const struct journal *journal, const char *id)
{
  for (int k = journal->n - 1; k >= 0; k--)
    if (strcmp(journal->entry[k].id, id) == 0) return &journal->entry[k];
  return NULL;
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

status journal_add(struct journal *journal, const struct journal_entry *entry)
{
  struct journal_entry copy = *entry;
  const time_t now = time(NULL);
  struct tm utc;
  strftime(copy.date, sizeof copy.date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
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

void journal_close(struct journal *journal)
{
  if (journal->file >= 0) close(journal->file);
  for (int k = 0; k < journal->n; k++) entry_free(&journal->entry[k]);
  free(journal->entry);
  *journal = (struct journal){.file = -1};
}
