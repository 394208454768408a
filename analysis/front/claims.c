/* `sphbench claims`: what the papers state, and what of it holds here. */
#include "claims.h"

#include <cyaml/cyaml.h>
#include <math.h>
#include <string.h>

#include "../../core/base/yaml_source.h"
#include "arguments.h"
#include "front.h"
#include "index.h"
#include "json_out.h"
#include "variants.h"

struct claim {
  char *id, *paper, *place, *statement, *figure, *value, *rule, *cause, *undecidable;
};
struct claims {
  struct claim *claims;
  unsigned num_claims;
};

#define TEXT(member, flags)                                                              \
  CYAML_FIELD_STRING_PTR(#member, CYAML_FLAG_POINTER | (flags), struct claim, member, 1, \
                         CYAML_UNLIMITED)

static const cyaml_schema_field_t claim_fields[] = {TEXT(id, 0),
                                                    TEXT(paper, 0),
                                                    TEXT(place, 0),
                                                    TEXT(statement, 0),
                                                    TEXT(figure, CYAML_FLAG_OPTIONAL),
                                                    TEXT(value, CYAML_FLAG_OPTIONAL),
                                                    TEXT(rule, CYAML_FLAG_OPTIONAL),
                                                    TEXT(cause, CYAML_FLAG_OPTIONAL),
                                                    TEXT(undecidable, CYAML_FLAG_OPTIONAL),
                                                    CYAML_FIELD_END};
static const cyaml_schema_value_t claim_entry = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct claim, claim_fields)};
static const cyaml_schema_field_t claims_fields[] = {
  CYAML_FIELD_SEQUENCE_COUNT("claims", CYAML_FLAG_POINTER, struct claims, claims, num_claims,
                             &claim_entry, 1, CYAML_UNLIMITED),
  CYAML_FIELD_END};
static const cyaml_schema_value_t claims_value_schema = {
  CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct claims, claims_fields)};

enum verdict { HOLDS, HOLDS_NOT, UNDECIDED, NUM_VERDICTS };
static const char *const verdict_words[] = {"holds", "does not hold", "cannot be decided"};

struct decided {
  enum verdict verdict;
  double value;
  char why[512]; /* where it could not be decided */
};

/* A claim needs a figure, a value and a rule, or says why it has none; ids differ. */
static status check(const struct yaml_source *source, const struct claims *all)
{
  for (unsigned k = 0; k < all->num_claims; k++) {
    const struct claim *c = &all->claims[k];
    const struct path at = path_of("claims[%u]", k + 1);
    const int measured = c->figure && c->value && c->rule, half = c->figure || c->value || c->rule;
    int unused;
    if (!measured && (half || !c->undecidable))
      return yaml_source_refuse(source, at.text,
                                "figure, value and rule are needed, or undecidable in their place");
    for (unsigned j = 0; j < k; j++)
      if (strcmp(all->claims[j].id, c->id) == 0)
        return yaml_source_refuse(source, at.text, "the id '%s' was there before", c->id);
    if (measured && claim_holds(c->rule, 0, &unused) != OK)
      return yaml_source_refuse(source, at.text, "the rule '%s' is not like 'value <= 1.2'",
                                c->rule);
  }
  return OK;
}

static void decide(const struct claim *claim, struct evidence *evidence, struct decided *d)
{
  int holds = 0;
  *d = (struct decided){.verdict = UNDECIDED, .value = (double)NAN};
  if (claim->undecidable) {
    snprintf(d->why, sizeof d->why, "%s", claim->undecidable);
    return;
  }
  status result = evidence_read(evidence, claim->figure);
  if (result == OK) result = claim_value(evidence, claim->value, &d->value);
  if (result == OK) result = claim_holds(claim->rule, d->value, &holds);
  if (result != OK)
    snprintf(d->why, sizeof d->why, "%s", status_sentence());
  else
    d->verdict = holds ? HOLDS : HOLDS_NOT;
}

/* --- what is written --- */

static json_t *as_json(const struct claim *c, const struct decided *d)
{
  const char *cause = d->verdict == UNDECIDED ? d->why : d->verdict == HOLDS ? NULL : c->cause;
  return json_pack("{s:s, s:s, s:s, s:s, s:s?, s:s?, s:o, s:s?, s:s, s:s?}", "id", c->id, "paper",
                   c->paper, "place", c->place, "statement", c->statement, "figure", c->figure,
                   "expression", c->value, "value", json_out_number(d->value), "rule", c->rule,
                   "verdict", verdict_words[d->verdict], "cause", cause);
}

static void write_row(FILE *out, const struct claim *c, const struct decided *d)
{
  const char *cause = d->verdict == UNDECIDED ? d->why : c->cause && d->verdict ? c->cause : "";
  fprintf(out, "| %s | %s | %s | ", c->id, c->place, c->statement);
  if (isfinite(d->value)) fprintf(out, "%.4g (%s)", d->value, c->rule);
  fprintf(out, " | %s | %s |\n", verdict_words[d->verdict], cause);
}

static status write_table(const char *path, const struct claims *all, const struct decided *d,
                          const int *count)
{
  struct new_file file;
  const char *paper = "";
  TRY(file_begin(&file, path));
  fprintf(file.stream, "# What the papers state, and what of it holds here\n\n");
  fprintf(file.stream, "%d hold, %d do not, %d cannot be decided.\n", count[HOLDS],
          count[HOLDS_NOT], count[UNDECIDED]);
  for (unsigned k = 0; k < all->num_claims; k++) {
    const struct claim *c = &all->claims[k];
    if (strcmp(paper, c->paper) != 0)
      fprintf(file.stream,
              "\n## %s\n\n| claim | place | statement | value (rule) | verdict | why |\n"
              "|:--|:--|:--|:--|:--|:--|\n",
              c->paper);
    paper = c->paper;
    write_row(file.stream, c, &d[k]);
  }
  return file_commit(&file);
}

static status decide_all(const struct claims *all, const char *results, const char *json)
{
  const struct path page = path_of("%s/claims.md", results);
  const struct path own = path_of("%s/claims.json", results);
  struct evidence evidence = {.results = path_of("%s", results),
                              .figures = path_of("%s/figures", results)};
  struct decided *decided = calloc(all->num_claims, sizeof *decided);
  json_t *list = json_array();
  int count[NUM_VERDICTS] = {0};
  for (unsigned k = 0; decided && k < all->num_claims; k++) {
    const struct claim *c = &all->claims[k];
    decide(c, &evidence, &decided[k]);
    count[decided[k].verdict]++;
    printf("%-17s  %-10.4g  %s\n", verdict_words[decided[k].verdict], decided[k].value, c->id);
    json_array_append_new(list, as_json(c, &decided[k]));
  }
  status result =
    decided ? write_table(page.text, all, decided, count) : status_set(ERR_MEMORY, "out of memory");
  if (result == OK) result = json_out_finish(json_incref(list), own.text, json);
  if (result == OK) result = index_write(results, evidence.figures.text);
  printf("%d hold, %d do not, %d cannot be decided; %s\n", count[HOLDS], count[HOLDS_NOT],
         count[UNDECIDED], page.text);
  json_decref(list);
  free(decided);
  evidence_free(&evidence);
  if (result == OK && count[HOLDS_NOT])
    return status_set(ERR_WORSE, "%d of %u claims do not hold", count[HOLDS_NOT], all->num_claims);
  return result;
}

status verb_claims(int argc, char **argv)
{
  const char *results = "results", *json = NULL;
  const struct flag flags[] = {{"--results", &results, NULL}, {"--json", &json, NULL}};
  const struct arguments what = {"claims", flags, 2, NULL, 0, NULL};
  const struct path data = data_folder(), file = path_of("%s/paper-figures/claims.yaml", data.text);
  struct yaml_source *source;
  void *read;
  TRY(arguments_parse(&what, argc, argv));
  if (!path_is_folder(results)) return user_error("--results: there is no folder '%s'", results);
  TRY(yaml_source_read(file.text, &claims_value_schema, &source, &read));
  status result = check(source, read);
  if (result == OK) result = decide_all(read, results, json);
  yaml_source_free(source, read);
  return result;
}
