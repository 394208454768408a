#!/usr/bin/python3
"""A solver from outside: what is installed, a project that is made and built against it, its runs
beside those of built-in solvers; and solvers that crash, hang or eat memory."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import cli_case
from cli_case import ROOT, read_json

NAME = "plain-wcsph"
PLAN = """name: two
about: a solver from outside beside a built-in one
runs:
  - scene: free-fall
    solvers: [{solvers}]
    dim: 2
    t_end: 0.02
    frames: 1
"""


RECIPE = """name: fall
about: energy of a falling block
statement: by a solver from outside and a built-in one
order: 1
runs:
  - scene: free-fall
    solvers: [{solvers}]
    t_end: 0.02
    frames: 1
extract:
  kind: series
  columns: [kinetic_energy]
labels:
  x: t
  y: E
"""


def done(*words, **more):
    process = subprocess.run([str(word) for word in words], capture_output=True, text=True, **more)
    if process.returncode:
        raise AssertionError(f"{words}: {process.stdout[-2000:]}{process.stderr[-2000:]}")
    return process.stdout


def faulty(source, fault, name):
    """The method with a fault at the beginning of its tenth step, under another name."""
    assert "  double compression;\n" in source
    code = f"  double compression;\n  if (run_step_number(run) == 9) {{ {fault} }}\n"
    return (source.replace("  double compression;\n", code).replace(f'"{NAME}"', f'"{name}"')
            .replace("#include <sphbench", "#include <stdlib.h>\n#include <string.h>\n"
                     "#include <unistd.h>\n#include <sphbench", 1))


class Plugins(cli_case.Case):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="sphbench-plugin-")
        cls.addClassCleanup(folder.cleanup)
        cls.top = pathlib.Path(folder.name)
        cls.prefix, cls.project = cls.top / "prefix", cls.top / "project"
        built = pathlib.Path(cli_case.command()).parents[1]
        done("cmake", "--install", built, "--prefix", cls.prefix)
        cls.built_in_place, cli_case.main.command = cli_case.command(), str(
            cls.prefix / "bin" / "sphbench")
        cls.addClassCleanup(setattr, cli_case.main, "command", cls.built_in_place)
        done(cls.prefix / "bin" / "sphbench-new-solver", NAME, cls.project)
        cls.source = (cls.project / f"{NAME}.c").read_text()
        done("cmake", "-S", cls.project, "-B", cls.project / "build",
             f"-DCMAKE_PREFIX_PATH={cls.prefix}", "-DSPHBENCH_PLUGIN_VARIANTS=2d-f64")
        done("cmake", "--build", cls.project / "build")
        cls.plugin = cls.project / "build"

    def compile(self, source, name, *flags, variant="openmp-2d-f64"):
        """As the pkg-config file says: the object's path."""
        (self.dir / f"{name}.c").write_text(source)
        target = self.dir / f"{name}-2d-f64.so"
        folder = next(self.prefix.glob("**/sphbench.pc")).parent
        words = done("pkg-config", "--cflags", "sphbench",
                     env=dict(os.environ, PKG_CONFIG_PATH=str(folder))).split()
        done("cc", "-std=c17", "-shared", "-fPIC", *words, "-O1", "-DDIM=2", "-DREAL=double",
             f'-DSPHBENCH_VARIANT="{variant}"', *flags, self.dir / f"{name}.c", "-o", target)
        return target

    def plan(self, solvers):
        (self.dir / "two.yaml").write_text(PLAN.format(solvers=", ".join(solvers)))
        return "two.yaml"

    def journal(self):
        lines = (self.dir / "results" / "journal.jsonl").read_text().splitlines()
        return [json.loads(line) for line in lines]

    def test_the_project(self):
        out = done("ctest", "--test-dir", self.plugin)
        self.assertIn("100% tests passed", out)
        (self.dir / "full").mkdir()
        (self.dir / "full" / "file").write_text("")
        tool = self.prefix / "bin" / "sphbench-new-solver"
        for words, part in ((("Bad Name", "x"), "Bad Name"), (("good", "full"), "not empty"),
                            (("good",), "arguments")):
            process = subprocess.run([tool, *words], cwd=self.dir, capture_output=True, text=True)
            self.assertEqual(process.returncode, 2)
            self.assertIn(part, process.stderr)
            self.assertEqual(len(process.stderr.splitlines()), 1)

    def test_list_show_run(self):
        names = [row["name"] for row in self.asked("list", "solvers")]
        self.assertNotIn(NAME, names)
        for path in (self.plugin, self.plugin / NAME, self.plugin / f"{NAME}-2d-f64.so"):
            row = self.asked("list", "solvers", "--plugin", path)[-1]
            self.assertEqual(row["name"], NAME)
            self.assertEqual(os.path.realpath(row["plugin"]),
                             os.path.realpath(self.plugin / f"{NAME}-2d-f64.so"))
        shown = self.asked("show", NAME, "--plugin", self.plugin)
        self.assertEqual(shown["params"][0]["name"] if "params" in shown else
                         shown["parameters"][0]["name"], "courant")
        facts, _ = self.run_scene("dam-break", NAME, "--plugin", self.plugin, "--spacing", "0.05",
                                  "--t-end", "0.1")
        self.assertEqual(facts["status"], "ok")
        self.assertLess(facts["metrics"]["density_error_mean"]["value"], 0.05)
        self.assertIn(f"{NAME} plug-in", json.dumps(facts["provenance"]))
        err = self.call("run", "free-fall", "--solver", NAME, code=2)[1]
        self.one_sentence(err, NAME)

    def test_restart(self):
        words = ("run", "dam-break", "--solver", NAME, "--plugin", self.plugin, "--spacing",
                 "0.05", "--quiet", "--set", "samples=20")
        self.call(*words, "--t-end", "0.04", "--json", "whole.json")
        self.call(*words, "--t-end", "0.02", "--set", "samples=10", "--checkpoint", "0",
                  "-o", "r.vtkhdf")
        self.call(*words, "--t-end", "0.04", "--restart", "r.restart", "--json", "second.json")
        whole, second = (read_json((self.dir / f"{name}.json").read_text())
                         for name in ("whole", "second"))
        for key in ("metrics", "series", "iterations"):
            self.assertEqual(whole[key], second[key])

    def test_sweep_compare_and_bless(self):
        plan = self.plan((NAME, "dfsph"))
        words = ("sweep", plan, "--results", "results", "--quiet", "--plugin", self.plugin)
        self.call("sweep", plan, "--results", "results", "--quiet", code=2)
        self.call(*words)
        first = {line["solver"]: line for line in self.journal()}
        self.assertEqual({line["status"] for line in first.values()}, {"ok"})
        self.assertEqual(set(first), {NAME, "dfsph"})
        self.assertNotIn("plugin", first[NAME]["what"])
        self.call("bless", "results", "b.json", "--reason", "the first")
        self.call("compare", "results", "b.json", "--bitwise", "--junit", "b.xml")
        cases = xml.etree.ElementTree.parse(self.dir / "b.xml").getroot()
        self.assertEqual({case.get("classname").split()[2] for case in cases}, {NAME, "dfsph"})
        self.call(*words)
        self.assertEqual(len(self.journal()), 2)
        changed = self.compile(self.source.replace("P(courant, 0.25", "P(courant, 0.2"), NAME)
        self.call(*words[:-1], changed)
        lines = self.journal()
        self.assertEqual(len(lines), 3, "what is built in needs not be run again")
        self.assertEqual(lines[2]["solver"], NAME)
        self.assertNotEqual(lines[2]["id"], first[NAME]["id"])

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is missing")
    def test_drawn(self):
        (self.dir / "fall").mkdir()
        (self.dir / "fall" / "recipe.yaml").write_text(RECIPE.format(solvers=f"{NAME}, dfsph"))
        script = (self.prefix / "share/sphbench/paper-figures/patch-energy/patch-energy.gp")
        shutil.copy(script, self.dir / "fall" / "fall.gp")
        self.call("figure", "./fall", "--quiet", "--plugin", self.plugin, "-o", "out")
        picture = (self.dir / "out" / "fall.svg").read_text()
        for name in (NAME, "dfsph"):
            self.assertIn(name, picture)
        self.assertNotIn(NAME, self.call("figure", "./fall", "--quiet", code=2)[0])

    def test_a_regression_is_found(self):
        """The maintainer's CI: blessed results, then a method that leaves out a factor."""
        plan = self.plan((NAME, "dfsph"))
        text = (self.dir / plan).read_text().replace("free-fall", "dam-break")
        (self.dir / plan).write_text(text.replace("    dim: 2\n", "    spacing: 0.05\n"))
        words = ("sweep", plan, "--quiet", "--plugin")
        self.call(*words, self.plugin, "--results", "before")
        self.call("bless", "before", "b.json", "--reason", "the first")
        worse = self.source.replace("    a = add(a, scale(of(s->p.m, ij)",
                                    "    a = add(a, scale((real)0.99 * of(s->p.m, ij)")
        self.assertNotEqual(worse, self.source)
        self.call(*words, self.compile(worse, NAME), "--results", "after")
        self.call("compare", "after", "b.json", "--json", "c.json", "--junit", "c.xml", code=1)
        rows = read_json((self.dir / "c.json").read_text())["metrics"]
        failed = [row for row in rows if not row["pass"]]
        self.assertTrue(failed)
        self.assertTrue(all(NAME in row["run"] for row in failed), failed)

    def facts(self, results):
        """Of each solver's run, but for times and places."""
        found = {}
        for path in (self.dir / results / "runs").glob("*.json"):
            facts = read_json(path.read_text())
            for key in ("timing", "memory", "provenance"):
                del facts[key]
            found[facts["solver"]] = (facts, path)
        return found

    def undisturbed(self, *solvers):
        """Are their results, bit for bit, those of a sweep of them alone?"""
        (self.dir / "alone.yaml").write_text(PLAN.format(solvers=", ".join(solvers)))
        self.call("sweep", "alone.yaml", "--results", "alone", "--quiet", "--plugin", self.plugin)
        beside, alone = self.facts("results"), self.facts("alone")
        self.assertEqual(set(alone), set(solvers))
        for name in solvers:
            self.assertEqual(beside[name][0], alone[name][0])
            frames = [path.with_suffix(".vtkhdf") for path in (beside[name][1], alone[name][1])]
            done(sys.executable, ROOT / "tools" / "h5same", *frames)

    def test_misbehaving(self):
        faults = {"crashes": "abort();",
                  "hangs": "for (;;) usleep(1000);",
                  "eats": "for (;;) memset(malloc(1 << 22), 1, 1 << 22);",
                  "asks-politely": "char *p = NULL; size_t n = 0; while ((p = malloc(1 << 22))) "
                                   "memset(p, 1, 1 << 22), n++; "
                                   'return status_set(ERR_MEMORY, "no memory for %zu blocks", n);'}
        for name, fault in faults.items():
            self.compile(faulty(self.source, fault, name), name)
        shutil.copy(self.plugin / f"{NAME}-2d-f64.so", self.dir)
        plan = self.plan(["crashes", "hangs", NAME, "eats", "dfsph", "asks-politely", "pbf"])
        words = ("sweep", plan, "--results", "results", "--quiet", "--plugin", self.dir,
                 "--jobs", "3", "--timeout", "6", "--memory", "300")
        err = self.call(*words, code=3)[1]
        self.assertIn("1 of 7 runs crashed", err)
        lines = {line["solver"]: line for line in self.journal()}
        self.assertEqual({name: line["status"] for name, line in lines.items()},
                         {"crashes": "crashed", "hangs": "timeout", "eats": "oom",
                          "asks-politely": "oom", NAME: "ok", "dfsph": "ok", "pbf": "ok"})
        self.undisturbed(NAME, "dfsph", "pbf")
        self.assertIn("300 MiB", lines["eats"]["reason"])
        self.assertIn("6 s", lines["hangs"]["reason"])
        self.assertRegex(lines["crashes"]["reason"], "signal 6")
        self.call(*words, code=3)
        self.assertEqual(len(self.journal()), 7, "none of them is to be run again")
        more = [word if word != "300" else "350" for word in words]
        self.call(*more, code=3)
        self.assertEqual(sorted(line["solver"] for line in self.journal()[7:]),
                         ["asks-politely", "eats"], "with more memory they might")

    def test_refused(self):
        text = self.dir / "text.so"
        text.write_text("nothing")
        other = self.compile(self.source, "other", variant="openmp-3d-f64")
        taken = self.compile(self.source.replace(f'"{NAME}"', '"dfsph"'), "taken")
        older = self.compile(self.source, "older", "-USOLVER_ABI", "-include",
                             self.old_headers())
        lacks = self.compile(self.source.replace("  .step = step,\n", "")
                             .replace("static status step(", "status step("), "lacks")
        empty = self.compile("int nothing;\n", "empty")
        for path, parts in ((text, ("text.so",)), (other, ("openmp-3d-f64", "openmp-2d-f64")),
                            (taken, ("'dfsph'", "already")), (older, ("interface",)),
                            (lacks, ("lacks step",)), (empty, ("no plug-in",)),
                            ("/none", ("/none",)), (self.prefix, ("2d-f64",))):
            with self.subTest(path=path):
                err = self.call("run", "free-fall", "--solver", NAME, "--plugin", path, code=2)[1]
                self.one_sentence(err, "--plugin", *parts)

    def old_headers(self):
        """A header that makes a plug-in of another interface."""
        path = self.dir / "old.h"
        path.write_text("#include <sphbench/core/solver.h>\n#undef SOLVER_ABI\n"
                        "#define SOLVER_ABI 99\n")
        return path

    def test_package(self):
        """Manual, completion and recipes lie where they are looked for."""
        page = (self.prefix / "share/man/man1/sphbench.1").read_text()
        verbs = re.findall(r"^  (\w+)", self.call("--help")[0], re.M)
        for verb in set(verbs) & {"run", "figure", "sweep", "compare", "bless", "report", "list",
                                  "show", "speed", "doctor", "precision",
                                  "convergence", "profile"}:
            self.assertRegex(page, rf'(?m)^\.B[IR]? "?{verb}\b', verb)
        script = self.prefix / "share/bash-completion/completions/sphbench"
        ask = (f'. {script}; COMP_WORDS=({self.prefix}/bin/sphbench run --solver pb); '
               'COMP_CWORD=3; _sphbench sphbench pb --solver; echo "${COMPREPLY[@]}"')
        self.assertEqual(done("bash", "-c", ask).split(), ["pbf"])
        plans = [row["name"] for row in self.asked("list", "plans")]
        self.assertIn("quick", plans)
        self.assertGreater(len(self.asked("list", "figures")), 0)
        self.assertTrue((ROOT / "cmake" / "install.cmake").exists())


if __name__ == "__main__":
    if not shutil.which("cmake") or not shutil.which("pkg-config"):
        print("skipped: cmake or pkg-config is missing")
        sys.exit(77)
    cli_case.main()
