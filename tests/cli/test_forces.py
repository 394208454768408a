#!/usr/bin/python3
"""Viscosity, XSPH and surface tension are neither allocated nor computed where a scene asks for
none of them, and each brings its own only."""
import json
import re
import subprocess

import cli_case

BASE = {"m", "rho", "V", "dv"}
IMPLICIT = {"mu_dir", "mu_op", "mu_diag"}
FIELDS = BASE | IMPLICIT | {"slant", "colour", "mu"}
STAGES = {"xsph", "drag", "add_drag", "couple", "norm_v", "slant", "colour", "cohere", "contract",
          "add_tension"}
# What is asked for: (fields besides BASE, stages) of that and of nothing else.
ASKED = {
    (): (set(), set()),
    ("xsph_rate=0.1",): (set(), {"xsph"}),
    ("viscosity=1", "viscosity_form=explicit"): (set(), {"drag", "add_drag"}),
    ("viscosity=1",): (IMPLICIT, {"couple", "norm_v"}),
    ("tension=1",): ({"slant"}, {"slant", "cohere", "add_tension"}),
    ("tension=1", "tension_form=he"): ({"slant", "colour"},
                                       {"colour", "slant", "contract", "add_tension"}),
}


class Forces(cli_case.Case):
    def look(self, solver, settings):
        """Names of the fields and stages of a run of two steps, and what it says is absent."""
        words = [word for setting in settings for word in ("--set", setting)]
        out, _ = self.call("run", "rotating-patch", "--spacing", "0.02", "--set", "xsph=0", *words,
                           "--solver", solver, "--t-end", "0.002", "--quiet", "--json", "r.json",
                           "--explain")
        with open(self.dir / "r.json", encoding="utf-8") as file:
            facts = cli_case.read_json(file.read())
        fields = {row["name"] for row in facts["memory"]["fields"]}
        stages = set(re.findall(r"(?m)^  (\w+)", out[out.index("stages run"):]))
        absent = set(re.search(r"features absent:([^\n]*)", out)[1].split())
        return fields, stages, absent

    def refuses(self, solver, settings):
        """Does the compatibility table say that it cannot?"""
        words = [word for setting in settings for word in ("--set", setting)]
        done = subprocess.run([cli_case.command(), "run", "rotating-patch", *words, "--solver",
                               solver, "--dry-run"], capture_output=True, text=True, check=False)
        return done.returncode == 2 and "which the scene asks" in done.stderr

    def test_only_what_is_asked(self):
        for row in self.asked("list", "solvers"):
            solver = row["name"]
            plain, plain_stages, _ = self.look(solver, ())
            private = {field["name"] for field in self.asked("show", solver)["fields"]}
            for settings, (fields, stages) in ASKED.items():
                with self.subTest(solver=solver, settings=settings):
                    if self.refuses(solver, settings):
                        continue
                    found, ran, absent = self.look(solver, settings)
                    own = fields | (BASE if settings else set())
                    self.assertEqual((found & FIELDS) - private, (plain & BASE | own) - private)
                    self.assertEqual(found - plain, own - plain)
                    self.assertEqual((ran - plain_stages) & STAGES, stages - plain_stages)
                    self.assertLessEqual(plain_stages, ran)
                    for name, key in (("XSPH", "xsph"), ("VISCOSITY", "viscosity="),
                                      ("TENSION", "tension=")):
                        self.assertEqual(name in absent,
                                         not any(word.startswith(key) for word in settings))

    def test_refused(self):
        """A form that there is not, with the forms that there are."""
        for setting, allowed in (("viscosity_form=fast", "explicit"), ("tension_form=x", "akinci"),
                                 ("wall_slip=2", "none"), ("viscosity=-1", "0")):
            _, err = self.call("run", "rotating-patch", "--solver", "dfsph", "--set", setting,
                               code=2)
            self.assertIn(allowed, err)



class Solves(cli_case.Case):
    def test_each_kind_is_told(self):
        """Iterations on pressure are not those on viscosity; together they are all."""
        self.call("run", "tank", "--solver", "dfsph", "--set", "viscosity=1", "--spacing", "0.05",
                  "--t-end", "0.02", "--json", "r.json", "--quiet")
        told = json.loads((self.dir / "r.json").read_text())["iterations"]
        solves = told["solves"]
        self.assertEqual(set(solves), {"density", "divergence", "viscosity"})
        self.assertEqual(told["total"], sum(kind["total"] for kind in solves.values()))
        self.assertAlmostEqual(told["mean"], sum(kind["mean"] for kind in solves.values()))
        self.assertTrue(all(kind["solves"] == 20 for kind in solves.values()), solves)


if __name__ == "__main__":
    cli_case.main()
