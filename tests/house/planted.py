"""A small tree that keeps every rule of the house, and faults that each break one of them."""
import pathlib
import tempfile

SOLVER = """\
/* A method. A. Author, J. Comput. Phys. 1 (2000) 1-2, doi:10.1000/182.
 * Differences from the paper: none. */
#include "../core/solver.h"
#define PARAMS(P) \\
  P(rho0, 1000, 1, 1e6, "kg/m^3", "rest density") \\
  P(form, 0, 0, 1, "printed|saturated", "which of the two (both in Eq. (7))")

/* Eq. (3)   rho_i = sum_j m_j W_ij */
STAGE void density(const state *s, int i)
{
  s->rho[i] = 0;
}

STAGE void drift(const state *s, int i) /* Eq. (14) */
{
  s->x[i] = 0;
}

/* p_i = 0 */
STAGE void clear(const state *s, int i)
{
  s->p[i] = 0;
}

STAGE void add(const state *s, int i) { s->v[i] += s->dv[i]; }
const struct solver solver_first_one = {.name = "first-one"};
"""

MAIN = """\
/* first-one may be named in a comment, and exit() too */
#include "runner.h"
#ifdef __cplusplus
extern "C" {
#endif
static int parse(char **argv)
{
  return argv[0] != "exit(1)" ? worker.exit(1) : '"';
}

int main(int argc, char **argv)
{
  exit(parse(argv));
}
#ifdef __cplusplus
}
#endif
"""

CLEAN = {
    "core/base/status.h": "#ifndef STATUS_H\n#define STATUS_H\n#endif\n",
    "core/particles/fields.def": 'FIELD(vec, x, ALL, KEPT, "m", "position")\n',
    "core/solver.h": '#include "base/status.h"\n#include "../solvers/solvers.def"\n',
    "core/run/runner.h": '#include "../../analysis/metrics.h"\n',
    "core/run/main.c": MAIN,
    "solvers/solvers.def": "SOLVER(first_one)\n",
    "solvers/first_one.c": SOLVER,
    "benchmarks/guard.h": "/* A scene. */\n#ifndef GUARD_H\n#define GUARD_H\n#endif\n",
    "benchmarks/plans/all.yaml": "solvers: [first-one]\n",
    "analysis/metrics.h": "#include <gsl/gsl_math.h>\n#include \"../core/run/runner.h\"\n",
    "analysis/metrics.def": 'METRIC(energy, "J", "kinetic energy")\n',
    "analysis/ode.c": "struct ses" + "sion { int open; };\n",
    "tests/unit/test.c": 'int f(void) { exit(1); return g("first-one"); }\n',
    "tools/run.sh": "#!/bin/sh\n",
    "README.md": "# A project\n[Runs](docs/run.md#how-it-runs), [C](https://a.org/x), `[c](d)`\n",
    "docs/run.md": "# Runs\n## How it `runs`\nSee [above](../README.md).\n```\n[a](b)\n```\n",
    "results/runs.csv": "a\tb \n",
    "build/core/base/bad.h": "\t",
}

LONG_FUNCTION = "void f(void)\n{\n%s}\n"
TWO_BRANCHES = "#ifdef A\nvoid f(void) {\n#else\nvoid f(int a) {\n#endif\n%s}\n"

# rule, file, its text (added to what the clean tree has there), the line that must be reported
FAULTS = [
    ("floors", "core/base/log.c", '#include "../particles/fields.def"\n', 1),
    ("floors", "core/sph/a.h", '\n#include "../solver.h"\n', 2),
    ("floors", "core/scene/a.c", '#include "run/runner.h"\n', 1),
    ("floors", "solvers/b.c", '#include "../benchmarks/guard.h"\n', 1),
    ("floors", "benchmarks/b.c", '#include "../solvers/b.h"\n', 1),
    ("floors", "core/unheard/of.c", "int i;\n", 1),
    ("names", "core/run/a.c", "extern int solver_first_one;\n", 1),
    ("names", "benchmarks/a.c", 'const char *best = "with First-One";\n', 1),
    ("names", "analysis/a.c", "enum { FIRST_ONE };\n", 1),
    ("lengths", "core/run/a.c", "\n" + LONG_FUNCTION % ("  g();\n" * 98), 2),
    ("lengths", "core/run/a.c", TWO_BRANCHES % ("  g();\n" * 98), 4),
    ("lengths", "tools/a.py", "def f():\n" + "    g()\n" * 100, 1),
    ("lengths", "core/run/a.h", "int a;\n" * 701, 1),
    ("lengths", "tools/run.sh", "echo " + "1" * 96 + "\n", 2),
    ("units", "core/particles/fields.def", 'FIELD(real, m, ALL, KEPT, "", "mass")\n', 2),
    ("units", "core/particles/fields.def", 'FIELD(real, m, ALL, KEPT, "kg", " ")\n', 2),
    ("units", "core/particles/fields.def", "FIELD(real, m, ALL, KEPT)\n", 2),
    ("units", "analysis/metrics.def", 'METRIC(momentum, "kg m/s")\n', 2),
    ("units", "solvers/b.c", '#define PARAMS(P) \\\n  P(tolerance, 1, 0, 1, "", "how (a)")\n', 2),
    ("units", "solvers/b.c", '#define FIELDS(F) F(real, a, FLUID, STEP, "1", "")\n', 1),
    ("variants", "solvers/b.c", "#ifdef __CUDACC__\n#endif\n", 1),
    ("variants", "benchmarks/guard.h", "#if DIM == 2\n#endif\n", 5),
    ("exits", "core/io/a.c", "void f(void)\n{\n  exit(2);\n}\n", 3),
    ("exits", "core/run/main.c", "void f(void)\n{\n  abort();\n}\n", 20),
    ("blanks", "core/io/a.c", "int a;\n\tint b;\n", 2),
    ("blanks", "README.md", "A line \n", 3),
    ("blanks", "tools/run.sh", "true", 2),
    ("traces", "README.md", "See /" + "work/main.\n", 3),
    ("traces", "results/run.json", '{"cwd": "/' + 'root"}\n', 1),
    ("traces", "core/io/a.c", "/* this ses" + "sion */\n", 1),
    ("traces", "core/io/a.c", 'open("/' + 'home/ann/a");\n', 1),
    ("traces", "docs/a.md", "A\nlater ses" + "sion\n", 2),
    ("papers", "solvers/b.c", "/* Doe 2001 */\nconst struct solver solver_b = {0};\n", 1),
    ("equations", "solvers/b.c", "/* moves */\nSTAGE void f(const state *s, int i)\n{\n}\n", 2),
    ("equations", "solvers/b.c", "STAGE real f(const state *s, int i)\n{\n}\n", 1),
    ("licences", "core/linear/a.c", "#include <gsl/gsl_linalg.h>\n", 1),
    ("links", "README.md", "[Gone](docs/gone.md)\n", 3),
    ("links", "docs/run.md", "![A picture](picture.png)\n", 7),
    ("links", "docs/a.md", "\n[Outside](../../outside.md)\n", 2),
    ("links", "docs/a.md", "[Runs](run.md#no-such-heading)\n", 1),
]


def plant(root, extra):
    for path in {*CLEAN, *extra}:
        file = pathlib.Path(root, path)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(CLEAN.get(path, "") + extra.get(path, ""))


def found(violations, extra):
    with tempfile.TemporaryDirectory() as root:
        plant(root, extra)
        return violations(root)


def run(violations, rules):
    """Exit code 1 unless the clean tree is clean and each fault is found, alone, where it is."""
    failures = [f"the clean tree: {v}" for v in found(violations, {})]
    for rule, path, text, line in FAULTS:
        extra = {path: text, "solvers/b.h": ""} if "b.h" in text else {path: text}
        seen = [v[:3] for v in found(violations, extra)]
        if not seen or set(seen) != {(path, line, rule)}:
            failures.append(f"{rule}: planted in {path}:{line}, found {seen}")
    failures += [f"{rule}: no fault is planted" for rule in rules
                 if rule not in [fault[0] for fault in FAULTS]]
    print("\n".join(failures) or f"{len(FAULTS)} planted faults of {len(rules)} rules: all found")
    return 1 if failures else 0
