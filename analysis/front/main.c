/* The command `sphbench`: carries out what concerns many runs, and starts the variant (backend,
 * dimension, precision) that does one run. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "front.h"
#include "variants.h"

#ifndef SPHBENCH_VERSION
#define SPHBENCH_VERSION "0.1.0"
#endif

static const char usage[] =
  "sphbench VERB ...: compares pressure solvers for smoothed particle hydrodynamics\n"
  "\n"
  "  run SCENE --solver NAME   one run; 'sphbench run --help' lists the flags\n"
  "  figure NAME...            run what is missing for a figure, then draw it (SVG and PNG)\n"
  "         --standard | --all    the standard ones; every one\n"
  "         [--size desk|paper] [--dry-run] [--results DIR] [-o DIR] [--jobs N] [--quiet]\n"
  "  sweep PLAN   every run of a plan, once: a kill loses only what was running\n"
  "         [--results DIR] [--jobs N] [--timeout S] [--memory MIB] [--fresh] [--dry-run]\n"
  "         [--quiet] [--timed N [--threads N]]   then take the time of each, N times\n"
  "         [--emit slurm|parallel DIR [--batch N]]   a job array instead\n"
  "         --manifest FILE --task K   one task of it\n"
  "  stability SCENE           largest stable time step of each solver; why a longer one fails\n"
  "         [--map KEY=V,V,...] [--seeds N] [--ignore CRITERION,...] [--quick] [--json FILE]\n"
  "         --extreme [--solvers A,B]   the catalogue of extreme cases\n"
  "  compare RESULTS BASELINE.json   exit code 1: something got worse\n"
  "         [--junit FILE] [--json FILE]\n"
  "  bless RESULTS BASELINE.json --reason TEXT   make RESULTS the baseline, and show what changes\n"
  "  claims [--results DIR] [--json FILE]   what the papers state, and what of it holds\n"
  "  report DIR -o FILE.html   one page with the figures, tables and origin of results\n"
  "  frames FILE.vtkhdf        its frames as PNG, and as a film where ffmpeg is there\n"
  "         [-o DIR] [--colour speed|p] [--film FILE.mp4] [--quiet]\n"
  "  list [solvers|scenes|metrics|figures|variants|plans] [--json]\n"
  "  show NAME [--json]        a solver, scene, metric or figure\n"
  "  speed [--json FILE]       time per particle of search, iteration and step\n"
  "  precision SCENE           error against run time, with figures and a table;\n"
  "         [--quick] [--solvers A,B] [--aa] [--kind total|spatial|temporal|algebraic]\n"
  "         [--error METRIC]\n"
  "         [--spacings A,B] [--dt-factors A,B] [--tolerance-factors A,B] [--t-end S]\n"
  "         [--set KEY=VALUE]... [--dim 2|3] [--precision float|double] [--backend B]\n"
  "         [--repeat N] [--threads N] [--timeout S] [--budget S] [--jobs N] [--fresh]\n"
  "         [--results DIR] [--json FILE] [--quiet]\n"
  "  convergence SCENE         observed orders, with intervals; curves over iterations\n"
  "         [--over spacing|dt] [--seeds N] [--jitter DX] and most flags of precision\n"
  "  profile FILE...           performance and data profiles over precision.json files\n"
  "         [-o DIR] [--json FILE] [--quiet]\n"
  "  doctor                    what is installed and built; cores, load, noise of the clock\n"
  "\n"
  "  --help, --version\n"
  "\n"
  "run, show, list and speed take --backend openmp|cuda, --dim 2|3, --precision float|double;\n"
  "these, figure, sweep, precision and convergence take --plugin PATH: solvers from outside.\n"
  "Exit codes: 0 done; 1 a comparison failed; 2 a mistake in the request; 3 a run failed;\n"
  "77 skipped (no GPU).\n";

static const char *const verbs[] = {
  "run",   "show",      "speed", "list",        "figure",  "report",    "doctor", "compare",
  "bless", "precision", "sweep", "convergence", "profile", "stability", "frames", "claims"};
enum { NUM_VERBS = sizeof verbs / sizeof *verbs };

/* Replace this process by the variant; returns only on failure. */
static status start_variant(int argc, char **argv, struct variant v)
{
  struct path executable;
  TRY(variant_choose(argc, argv, &v));
  const status found = variant_executable(&v, &executable);
  if (found != OK && (!strcmp(argv[1], "list") || !strcmp(argv[1], "show"))) {
    TRY(variant_any(&v, &v));
    TRY(variant_executable(&v, &executable));
  } else if (found != OK) {
    return found;
  }
  /* threads that spin at barriers cost up to 25 times the run where the machine is shared */
  setenv("OMP_WAIT_POLICY", "passive", 0);
  execv(executable.text, argv);
  return status_set(ERR_IO, "the variant '%s' cannot be started", executable.text);
}

static int is_own_list(int argc, char **argv)
{
  static const char *const variants_own[] = {"solvers", "scenes", "metrics"};
  for (int i = 2; i < argc; i++)
    for (int k = 0; k < 3; k++)
      if (strcmp(argv[i], variants_own[k]) == 0) return 0;
  return 1;
}

static status start_show(int argc, char **argv)
{
  const struct variant usual = {"openmp", "f64", 2};
  int mine = 0;
  TRY(show_figure(argc, argv, &mine));
  return mine ? OK : start_variant(argc, argv, usual);
}

static status unknown(const char *verb)
{
  const char *near = nearest_name(verb, verbs, NUM_VERBS);
  return near ? user_error("unknown verb '%s'; the nearest known one is '%s'", verb, near)
              : user_error("unknown verb '%s'; 'sphbench --help' lists the known ones", verb);
}

static status carry_out(int argc, char **argv)
{
  const struct variant usual = {"openmp", "f64", 2}, fast = {"openmp", "f32", 3};
  const char *verb = argv[1];
  if (strcmp(verb, "run") == 0) return start_variant(argc, argv, usual);
  if (strcmp(verb, "speed") == 0) return start_variant(argc, argv, fast);
  if (strcmp(verb, "show") == 0) return start_show(argc, argv);
  if (strcmp(verb, "list") == 0)
    return is_own_list(argc, argv) ? verb_list(argc, argv) : start_variant(argc, argv, usual);
  if (strcmp(verb, "figure") == 0) return verb_figure(argc, argv);
  if (strcmp(verb, "report") == 0) return verb_report(argc, argv);
  if (strcmp(verb, "sweep") == 0) return verb_sweep(argc, argv);
  if (strcmp(verb, "frames") == 0) return verb_frames(argc, argv);
  if (strcmp(verb, "compare") == 0) return verb_compare(argc, argv);
  if (strcmp(verb, "bless") == 0) return verb_bless(argc, argv);
  if (strcmp(verb, "precision") == 0) return verb_precision(argc, argv);
  if (strcmp(verb, "stability") == 0) return verb_stability(argc, argv);
  if (strcmp(verb, "convergence") == 0) return verb_convergence(argc, argv);
  if (strcmp(verb, "profile") == 0) return verb_profile(argc, argv);
  if (strcmp(verb, "claims") == 0) return verb_claims(argc, argv);
  if (strcmp(verb, "doctor") == 0) return verb_doctor(argc, argv);
  return unknown(verb);
}

/* PATH[,PATH] with folders from the root on: children run elsewhere. */
static char *absolute(const char *paths)
{
  char here[4096], *text = NULL;
  size_t size = 0;
  FILE *out = getcwd(here, sizeof here) ? open_memstream(&text, &size) : NULL;
  for (const char *at = paths; out && *at;) {
    const size_t length = strcspn(at, ",");
    fprintf(out, "%s%s%s%.*s", at == paths ? "" : ",", *at == '/' ? "" : here,
            *at == '/' ? "" : "/", (int)length, at);
    at += length + (at[length] == ',');
  }
  if (out) fclose(out);
  return text;
}

/* --plugin PATH of a verb that starts many runs goes to all of them by the environment. */
static status take_plugin(int *argc, char **argv)
{
  static const char *const with_runs[] = {"figure", "sweep", "precision", "convergence", "list"};
  int kept = 2, takes = 0;
  enum { NUM_WITH_RUNS = sizeof with_runs / sizeof *with_runs };
  for (int k = 0; k<NUM_WITH_RUNS && * argc> 1; k++) takes |= strcmp(argv[1], with_runs[k]) == 0;
  for (int i = 2; i < *argc && takes; i++) {
    const int is_it = strncmp(argv[i], "--plugin", 8) == 0 && (!argv[i][8] || argv[i][8] == '=');
    if (!is_it) {
      argv[kept++] = argv[i];
      continue;
    }
    const char *path = argv[i][8] ? argv[i] + 9 : i + 1 < *argc ? argv[++i] : "";
    if (!*path) return user_error("%s: --plugin needs a value: PATH", argv[1]);
    char *whole = absolute(path);
    if (!whole || setenv("SPHBENCH_PLUGIN", whole, 1))
      return status_set(ERR_MEMORY, "out of memory");
    free(whole);
  }
  if (takes) argv[ *argc = kept] = NULL;
  return OK;
}

static int is_help(const char *word)
{
  return !strcmp(word, "--help") || !strcmp(word, "-h") || !strcmp(word, "help");
}

int main(int argc, char **argv)
{
  const char *verb = argc > 1 ? argv[1] : "--help";
  const int own = strcmp(verb, "run") && strcmp(verb, "speed");
  if (is_help(verb) || (argc > 2 && own && is_help(argv[2]))) {
    fputs(usage, stdout);
    return 0;
  }
  if (strcmp(verb, "--version") == 0) {
    puts("sphbench " SPHBENCH_VERSION);
    return 0;
  }
  status result = take_plugin(&argc, argv);
  if (result == OK) result = carry_out(argc, argv);
  if (result != OK) fprintf(stderr, "sphbench: %s\n", status_sentence());
  return status_exit_code(result);
}
