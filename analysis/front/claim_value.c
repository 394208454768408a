/* Values of claims: a small calculator over the facts of runs. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "claims.h"
#include "figure.h"
#include "study.h"

enum { LONGEST_NAME = 128, MOST_NESTED = 64, MOST_ARGUMENTS = 32 };

/* --- evidence --- */

status evidence_read(struct evidence *e, const char *name)
{
  const struct path figure = path_of("%s/%s/figure.json", e->figures.text, name);
  const struct path values = path_of("%s/%s/values.json", e->figures.text, name);
  if (e->name && strcmp(e->name, name) == 0) return OK;
  evidence_free(e);
  e->figure = json_load_file(figure.text, 0, NULL);
  if (!e->figure) return user_error("the figure '%s' was not drawn", name);
  e->values = path_is_file(values.text) ? json_load_file(values.text, 0, NULL) : NULL;
  e->facts = json_object();
  e->name = json_string_value(json_object_get(e->figure, "name"));
  return OK;
}

void evidence_free(struct evidence *e)
{
  json_decref(e->figure);
  json_decref(e->values);
  json_decref(e->facts);
  e->figure = e->values = e->facts = NULL;
  e->name = NULL;
}

static const json_t *facts_of(struct evidence *e, const char *id)
{
  const json_t *known = json_object_get(e->facts, id);
  const struct path path = run_file(e->results.text, id, "json");
  if (known) return known;
  json_object_set_new(e->facts, id, json_load_file(path.text, 0, NULL));
  return json_object_get(e->facts, id);
}

/* --- which run --- */

static int same_text(const char *wanted, size_t length, const char *found)
{
  return found && strlen(found) == length && strncmp(wanted, found, length) == 0;
}

/* KEY=VALUE [length] of one selector. */
static int selects(const char *word, size_t length, const json_t *entry, const json_t *facts)
{
  char key[LONGEST_NAME], *end;
  const size_t n = strcspn(word, "=");
  if (n >= length || n >= sizeof key) return 0;
  snprintf(key, sizeof key, "%.*s", (int)n, word);
  const char *value = word + n + 1;
  const size_t size = length - n - 1;
  if (strcmp(key, "label") == 0)
    return same_text(value, size, json_string_value(json_object_get(entry, key)));
  if (strcmp(key, "solver") == 0)
    return same_text(value, size, json_string_value(json_object_get(facts, key)));
  const json_t *has = json_object_get(json_object_get(facts, "parameters"), key);
  const double wanted = strtod(value, &end);
  if (json_is_number(has) && end == value + size)
    return fabs(wanted - json_number_value(has)) <= 1e-9 * fabs(wanted);
  return same_text(value, size, json_string_value(has));
}

static int all_select(const char *selectors, size_t length, const json_t *entry,
                      const json_t *facts)
{
  const char *const end = selectors + length;
  for (const char *at = selectors; at < end;) {
    const size_t rest = (size_t)(end - at), comma = strcspn(at, ","),
                 n = comma < rest ? comma : rest;
    if (!selects(at, n, entry, facts)) return 0;
    at += n;
    while (at < end && (*at == ',' || *at == ' ')) at++;
  }
  return 1;
}

/* The one run that is selected; two entries of one run count once. */
static status find_run(struct evidence *e, const char *selectors, size_t length,
                       const json_t **found)
{
  const char *found_id = NULL;
  size_t k;
  json_t *entry;
  int n = 0;
  json_array_foreach(json_object_get(e->figure, "runs"), k, entry)
  {
    const char *id = json_string_value(json_object_get(entry, "id"));
    const json_t *facts = id ? facts_of(e, id) : NULL;
    if (!facts || !all_select(selectors, length, entry, facts)) continue;
    if (found_id && strcmp(found_id, id) == 0) continue;
    found_id = id;
    *found = facts;
    n++;
  }
  return n == 1
           ? OK
           : user_error("%s: %d runs with [%.*s], 1 expected", e->name, n, (int)length, selectors);
}

/* --- the calculator --- */

struct calculator {
  struct evidence *evidence;
  const char *at;
  int depth;
};
static status sum(struct calculator *c, double *value);

static void skip(struct calculator *c)
{
  while (isspace((unsigned char)*c->at)) c->at++;
}

static int takes(struct calculator *c, char sign)
{
  skip(c);
  if (*c->at != sign) return 0;
  c->at++;
  return 1;
}

static status misread(const struct calculator *c, const char *expected)
{
  return user_error("'%.40s' found, %s expected", *c->at ? c->at : "the end", expected);
}

static status call(struct calculator *c, const char *name, double *value)
{
  double a[MOST_ARGUMENTS];
  int n = 0;
  do {
    if (n == MOST_ARGUMENTS) return user_error("%s: more than %d arguments", name, MOST_ARGUMENTS);
    TRY(sum(c, &a[n++]));
  } while (takes(c, ','));
  if (!takes(c, ')')) return misread(c, "')'");
  *value = a[0];
  if (strcmp(name, "abs") == 0 && n == 1) *value = fabs(a[0]);
  if (strcmp(name, "log") == 0 && n == 1) *value = log(a[0]);
  for (int k = 1; k < n; k++)
    *value = strcmp(name, "min") == 0 ? fmin(*value, a[k]) : fmax(*value, a[k]);
  return OK;
}

static int is_function(const char *name)
{
  static const char *const known[] = {"abs", "log", "min", "max"};
  int found = 0;
  for (int k = 0; k < 4; k++) found |= strcmp(name, known[k]) == 0;
  return found;
}

static status reference(struct calculator *c, const char *name, double *value)
{
  const char *selectors = c->at;
  size_t length = 0;
  const json_t *facts = NULL;
  if (strncmp(name, "value.", 6) == 0) {
    const json_t *has = json_object_get(c->evidence->values, name + 6);
    if (!has) return user_error("%s: no value '%s'", c->evidence->name, name + 6);
    *value = json_is_number(has) ? json_number_value(has) : (double)NAN;
  } else {
    if (takes(c, '[')) {
      selectors = c->at;
      length = strcspn(selectors, "]");
      c->at += length;
      if (!takes(c, ']')) return misread(c, "']'");
    }
    TRY(find_run(c->evidence, selectors, length, &facts));
    *value = fact_value(facts, name);
  }
  return isfinite(*value) ? OK : user_error("%s: '%s' is no number", c->evidence->name, name);
}

static status named(struct calculator *c, double *value)
{
  char name[LONGEST_NAME];
  size_t n = 0;
  while (isalnum((unsigned char)c->at[n]) || c->at[n] == '_' || c->at[n] == '.') n++;
  if (n == 0 || n >= sizeof name) return misread(c, "a number or a name");
  snprintf(name, sizeof name, "%.*s", (int)n, c->at);
  c->at += n;
  if (!is_function(name)) return reference(c, name, value);
  return takes(c, '(') ? call(c, name, value) : misread(c, "'('");
}

static status operand(struct calculator *c, double *value)
{
  char *end;
  status result = OK;
  if (++c->depth > MOST_NESTED) return user_error("more than %d nested brackets", MOST_NESTED);
  if (takes(c, '-')) {
    result = operand(c, value);
    *value = -*value;
  } else if (takes(c, '(')) {
    result = sum(c, value);
    if (result == OK && !takes(c, ')')) result = misread(c, "')'");
  } else if (isdigit((unsigned char)*c->at)) {
    *value = strtod(c->at, &end);
    c->at = end;
  } else {
    result = named(c, value);
  }
  c->depth--;
  return result;
}

static status product(struct calculator *c, double *value)
{
  double other;
  TRY(operand(c, value));
  for (;;) {
    const int divides = takes(c, '/');
    if (!divides && !takes(c, '*')) return OK;
    TRY(operand(c, &other));
    *value = divides ? *value / other : *value * other;
  }
}

static status sum(struct calculator *c, double *value)
{
  double other;
  TRY(product(c, value));
  for (;;) {
    const int less = takes(c, '-');
    if (!less && !takes(c, '+')) return OK;
    TRY(product(c, &other));
    *value += less ? -other : other;
  }
}

status claim_value(struct evidence *evidence, const char *expression, double *value)
{
  struct calculator c = {evidence, expression, 0};
  *value = (double)NAN;
  TRY(sum(&c, value));
  skip(&c);
  if (*c.at) return misread(&c, "an operator");
  return isfinite(*value) ? OK : user_error("%s: the value is not finite", evidence->name);
}

status claim_holds(const char *rule, double value, int *holds)
{
  char sign[3], rest;
  double bound;
  if (sscanf(rule, " value %2[<>=] %lf %c", sign, &bound, &rest) != 2)
    return user_error("the rule '%s' is not like 'value <= 1.2'", rule);
  const int below = sign[0] == '<', or_equal = sign[1] == '=';
  if (sign[0] == '=' || (sign[1] && !or_equal))
    return user_error("the rule '%s' has none of < <= > >=", rule);
  *holds = (below ? value < bound : value > bound) || (or_equal && value == bound);
  return OK;
}
