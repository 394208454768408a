"""What `compare` lets pass and what not: a change planted in the results for every rule."""
import json
import pathlib
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree

import cli_case
from cli_case import ROOT, read_json

PLAN = """name: gates
about: single runs, seeds and spacings
runs:
  - scene: dam-break
    solvers: [dfsph]
    spacing: 0.05
    t_end: 0.03
    frames: 1
  - scene: tank
    solvers: [iisph]
    spacing: 0.08
    t_end: 0.01
    frames: 1
    set: [jitter=0.1]
    product:
      - {name: seed, values: [1, 2, 3, 4, 5]}
  - scene: free-fall
    solvers: [pbf]
    t_end: 0.01
    frames: 1
    product:
      - {name: spacing, values: [0.02, 0.025, 0.04]}
"""


class Gates(cli_case.Case):
    @classmethod
    def setUpClass(cls):
        """The plan is swept once; each test has a copy of the results."""
        super().setUpClass()
        cls.store = cli_case.tempfile.TemporaryDirectory(prefix="sphbench-gates-")
        cls.addClassCleanup(cls.store.cleanup)
        store = pathlib.Path(cls.store.name)
        (store / "gates.yaml").write_text(PLAN)
        for words in (("sweep", "gates.yaml", "--results", "r", "--quiet"),
                      ("bless", "r", "b.json", "--reason", "the first")):
            subprocess.run([cli_case.command(), *words], cwd=store, check=True,
                           stdout=subprocess.DEVNULL)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.store.name, self.dir, dirs_exist_ok=True)
        self.runs = {"single": [], "seed": [], "spacing": []}
        for path in sorted((self.dir / "r" / "runs").glob("*.json")):
            facts = read_json(path.read_text())
            words = facts["provenance"]["argv"]
            kind = ("seed" if "--seed" in words else
                    "spacing" if facts["scene"] == "free-fall" else "single")
            self.runs[kind].append((path, facts))

    def plant(self, kind, change, numbers=(0,)):
        """Change the facts of some runs of a kind; change(facts) or change(facts, number)."""
        for number in numbers:
            path, facts = self.runs[kind][number]
            facts = json.loads(json.dumps(facts))
            change(facts)
            path.write_text(json.dumps(facts))

    def compare(self, *words, code=0):
        self.call("compare", "r", "b.json", "--json", "c.json", *words, code=code)
        return read_json((self.dir / "c.json").read_text())

    def failed(self, *words):
        return {row["name"] for row in self.compare(*words, code=1)["metrics"] if not row["pass"]}

    def edit(self, change):
        """Change the baseline."""
        baseline = read_json((self.dir / "b.json").read_text())
        change(baseline)
        (self.dir / "b.json").write_text(json.dumps(baseline))

    # --- values

    def test_every_gate_is_where_it_is_said_to_be(self):
        rows = [row for row in self.compare()["metrics"] if row["run"].startswith("dam-break")]
        _, facts = self.runs["single"][0]
        tried = 0
        for row in rows:
            if row["name"] not in facts["metrics"]:
                continue
            tried += 1
            for part, is_caught in ((0.98, False), (1.02, True)):
                by = part * row["tolerance"] if row["tolerance"] else is_caught

                def change(facts, name=row["name"], value=row["baseline"] + by):
                    facts["metrics"][name]["value"] = value
                self.plant("single", change)
                with self.subTest(metric=row["name"], part=part):
                    if is_caught:
                        self.assertEqual(self.failed(), {row["name"]})
                    else:
                        self.compare()
        self.assertGreater(tried, 12)
        out = self.call("compare", self.store.name + "/r", "b.json", "--all")[0]
        shown = [line for line in out.splitlines() if line.startswith("ok ")]
        self.assertEqual(len(shown), self.compare(code=1)["compared"])
        self.assertIn("smallest change", out)

    def test_iterations_volume_and_height_are_gated(self):
        """Also in the baseline of ./check, where every run has them, and every line is small."""
        for key, by in (("mean", 0.5), ("max", 2)):
            def change(facts):
                facts["iterations"][key] += by
            self.plant("single", change)
            self.assertEqual(self.failed(), {f"iterations_{key}"})
        for name in ("volume_change", "potential_energy", "front_position"):
            def change(facts):
                facts["metrics"][name]["value"] += 0.01
            self.plant("single", change)
            self.assertEqual(self.failed(), {name})
        path = ROOT / "results" / "baselines" / "quick.json"
        self.assertLess(path.stat().st_size, 150_000)
        baseline = read_json(path.read_text())
        self.assertGreater(len(baseline["runs"]), 100)
        for key, run in baseline["runs"].items():
            if "--spacing *" not in key:
                names = {"volume_change", "iterations_mean", "steps"}
                if not key.startswith("poiseuille"):  # without gravity, periodic
                    names.add("potential_energy")
                self.assertLessEqual(names, set(run["values"]), key)
        for entry in baseline["history"]:
            self.assertTrue(entry["reason"].strip())

    def test_sides(self):
        rule = {"abs": 1e-6, "rel": 0, "why": "a test"}
        for side, sign in (("above", 1), ("below", -1)):
            self.edit(lambda b: b["rules"].update(volume_change=dict(rule, side=side)))
            for by in (1e-5, -1e-5):
                def change(facts):
                    facts["metrics"]["volume_change"]["value"] += by
                self.plant("single", change)
                if by * sign > 0:
                    self.assertEqual(self.failed(), {"volume_change"})
                else:
                    self.compare()

    def test_a_rule_for_one_scene(self):
        def change(facts):
            facts["iterations"]["mean"] += 0.5
        self.plant("single", change)
        self.assertEqual(self.failed(), {"iterations_mean"})
        wide = {"abs": 1, "rel": 0, "why": "a test"}
        self.edit(lambda b: b["rules"].update({"tank/iterations_mean": wide}))
        self.assertEqual(self.failed(), {"iterations_mean"})
        self.edit(lambda b: b["rules"].update({"dam-break/iterations_mean": wide}))
        self.compare()

    def test_nothing_that_is_no_number_passes(self):
        self.edit(lambda b: b["rules"].update(default={"abs": 1e300, "rel": 1e300, "why": ""}))
        for value in (None, "1"):
            def change(facts):
                facts["metrics"]["front_position"]["value"] = value
            self.plant("single", change)
            self.assertEqual(self.failed(), {"front_position"})
        self.plant("single", lambda facts: facts["metrics"].pop("front_position"))
        self.assertEqual(self.failed(), {"front_position"})

    def test_what_is_new_warns(self):
        self.plant("single", lambda f: f["metrics"].update(new={"value": 1, "unit": "1"}))
        self.assertEqual(self.compare()["unknown"], 1)
        self.assertIn("warning: 1 ", self.call("compare", "r", "b.json")[0])

    # --- curves

    def bend(self, name, function):
        def change(facts):
            series = facts["series"]
            end = series["time"][-1]
            series[name] = [function(y, t / end) if y is not None else None
                            for y, t in zip(series[name], series["time"])]
        self.plant("single", change)

    def test_curves(self):
        largest = max(self.runs["single"][0][1]["series"]["kinetic_energy"])
        name = "kinetic_energy"
        self.bend(name, lambda y, t: y * (1 + 2e-5))
        self.compare()
        for function in (lambda y, t: y * (1 + 3e-4),              # scaled
                         lambda y, t: y + 3e-4 * largest,          # shifted
                         lambda y, t: y + 3e-2 * largest * (abs(t - 0.37) < 0.02)):  # a spike
            self.bend(name, function)
            self.assertIn(name + ".curve", self.failed())
        # a tilt about the middle: a rate of its own
        wide = {"abs": 0.05 * largest, "rel": 0, "why": ""}
        self.edit(lambda b: b["curves"].update({name: wide}))
        self.bend(name, lambda y, t: y + 0.15 * largest * (t - 0.5))
        self.assertEqual(self.failed(), {name + ".rate"})

    def test_a_curve_that_is_cut_missing_or_no_number(self):
        def cut(facts):
            for name, curve in facts["series"].items():
                facts["series"][name] = curve[:len(curve) // 2]
        self.plant("single", cut)
        self.assertIn("gamma_mean", self.failed())
        self.plant("single", lambda facts: facts["series"].pop("gamma_mean"))
        self.assertEqual(self.failed(), {"gamma_mean"})

        def hole(facts):
            facts["series"]["gamma_mean"][4] = None
        self.plant("single", hole)
        self.assertEqual(self.failed(), {"gamma_mean.curve", "gamma_mean.rate"})

    # --- the same bits

    def test_bits(self):
        found = self.compare("--bitwise")
        self.assertEqual((found["identical"], found["same_build"]), (5, 5))

        def change(facts):  # by the last bit of one number in the middle of a curve
            curve = facts["series"]["kinetic_energy"]
            curve[9] *= 1 + 3e-16
        self.plant("single", change)
        self.assertEqual(self.compare()["identical"], 4)
        self.assertEqual(self.failed("--bitwise"), {"bits"})

    def test_another_build_is_never_of_the_same_bits(self):
        def change(facts):
            facts["provenance"]["compiler"] = "another 1.0"
            facts["metrics"]["kinetic_energy"]["value"] *= 1 + 1e-9
        self.plant("single", change)
        self.assertEqual(self.compare()["same_build"], 4)
        rows = self.compare("--bitwise", code=1)["metrics"]
        self.assertEqual([row["name"] for row in rows if not row["pass"]], ["bits"])
        self.assertIn("another compiler", rows[0]["note"])

    def test_a_gpu_keeps_to_what_the_processor_found(self):
        def change(facts):
            facts["variant"] = facts["variant"].replace("openmp", "cuda")
            facts["provenance"]["argv"][5:5] = ["--backend", "cuda"]
            facts["metrics"]["kinetic_energy"]["value"] *= 1 + 1e-9
        self.plant("single", change)
        self.assertEqual(self.compare()["unknown"], 0)

        def worse(facts):
            change(facts)
            facts["metrics"]["kinetic_energy"]["value"] *= 1.01
        self.plant("single", worse)
        self.assertEqual(self.failed(), {"kinetic_energy"})

    # --- seeds and spacings

    def shift_seeds(self, by, numbers):
        def change(facts):
            facts["metrics"]["kinetic_energy"]["value"] += by
        self.plant("seed", change, numbers)

    def test_medians_over_seeds(self):
        baseline = read_json((self.dir / "b.json").read_text())
        keys = [key for key in baseline["runs"] if "--seed *" in key]
        self.assertEqual(len(keys), 1)
        self.assertFalse([key for key in baseline["runs"] if "--seed 1" in key])
        run = baseline["runs"][keys[0]]
        values = sorted(f["metrics"]["kinetic_energy"]["value"] for _, f in self.runs["seed"])
        median = values[2]
        mad = sorted(abs(value - median) for value in values)[2]
        self.assertEqual(run["seeds"], 5)
        self.assertAlmostEqual(run["values"]["kinetic_energy"] / median, 1, places=6)
        self.assertAlmostEqual(run["mad"]["kinetic_energy"] / mad, 1, places=6)
        gate = next(row["tolerance"] for row in self.compare()["metrics"]
                    if row["run"] == keys[0] and row["name"] == "kinetic_energy")
        sigma = 1.4826 * 1.2533 * mad * (2 / 5) ** 0.5
        self.assertAlmostEqual(gate / (4 * sigma), 1, places=3)
        self.shift_seeds(0.9 * gate, range(5))
        self.compare()
        self.shift_seeds(1.1 * gate, range(5))
        self.assertEqual(self.failed(), {"kinetic_energy"})

    def test_one_seed_may_stray_but_not_all(self):
        order = sorted(range(5), key=lambda k:
                       self.runs["seed"][k][1]["metrics"]["kinetic_energy"]["value"])
        self.shift_seeds(1e3, order[4:])  # the largest, further out
        self.compare()
        values = {}
        for rank, number in enumerate(order):  # the median stays, the scatter grows

            def change(facts, by=(rank - 2) * 1e3):
                facts["metrics"]["kinetic_energy"]["value"] += by
            self.plant("seed", change, [number])
            values[rank] = number
        self.assertEqual(self.failed(), {"kinetic_energy.spread"})

    def test_no_seed_may_fail(self):
        def change(facts):
            facts["metrics"]["kinetic_energy"]["value"] = None
        self.plant("seed", change, [3])
        self.assertEqual(self.failed(), {"kinetic_energy"})
        self.plant("seed", lambda facts: facts.update(status="diverged"), [3])
        self.assertEqual(self.failed(), {"status"})

    def test_the_order_over_the_spacing(self):
        self.assertIn("trajectory_error.order", {row["name"] for row in
                                                 self.compare()["metrics"]})
        errors = {"trajectory_error": 1}

        def change(facts):  # as if by h^2 where it does not depend on it; each a little
            for name in errors:
                facts["metrics"][name]["value"] *= (facts["parameters"]["spacing"] / 0.025) ** 2
        self.plant("spacing", change, range(3))
        self.edit(lambda b: b["rules"].update(
            trajectory_error={"abs": 1e3, "rel": 0, "why": "only the order is judged here"}))
        self.assertEqual(self.failed(), {"trajectory_error.order"})

    def test_the_list_of_planted_faults(self):
        """What was found is of the faults that there are, and the page is made from it."""
        sys.path.insert(0, str(ROOT / "tests" / "mutations"))
        self.addCleanup(sys.path.pop, 0)
        import mutate
        from mutations import FAULTS
        known = read_json((ROOT / "results" / "mutations.json").read_text())
        self.assertEqual([row["name"] for row in known["faults"]], [one.name for one in FAULTS])
        self.assertGreaterEqual(known["caught"], 12)
        self.assertEqual([row["name"] for row in known["faults"] if not row["caught"]],
                         [one.name for one in FAULTS if one.blind])
        self.assertEqual((ROOT / "docs" / "planted-faults.md").read_text(), mutate.page_of(known))

    # --- files

    def test_junit_of_odd_names(self):
        def change(facts):
            facts["scene"] = 'a<b> & "c" \u00e9'
        self.plant("single", change)
        self.call("bless", "r", "b.json", "--reason", "odd names")

        def worse(facts):
            change(facts)
            facts["steps"] += 1
        self.plant("single", worse)
        self.call("compare", "r", "b.json", "--junit", "j.xml", code=1)
        suite = xml.etree.ElementTree.parse(self.dir / "j.xml").getroot()
        self.assertEqual(suite.tag, "testsuite")
        failed = [case for case in suite if case.find("failure") is not None]
        self.assertEqual(int(suite.get("failures")), len(failed))
        self.assertEqual(int(suite.get("tests")), len(suite))
        names = [case.get("classname") for case in failed if case.get("name") == "steps"]
        self.assertEqual([name.split(" (")[0] for name in names], ['a<b> & "c" \u00e9 with dfsph'])
        if shutil.which("xmllint"):
            subprocess.run(["xmllint", "--noout", self.dir / "j.xml"], check=True)

    def test_bless(self):
        def change(facts):
            facts["metrics"]["front_position"]["value"] += 0.5
        self.plant("single", change)
        before = (self.dir / "b.json").read_text()
        for words in ((), ("--reason",), ("--reason", ""), ("--reason", "  \n ")):
            self.one_sentence(self.call("bless", "r", "b.json", *words, code=2)[1], "--reason")
            self.assertEqual((self.dir / "b.json").read_text(), before)
        out = self.call("bless", "r", "b.json", "--reason", 'walls "press" back')[0]
        self.assertRegex(out, r"FAIL  front_position +1\.\d+ +1\.\d+ .*dam-break with dfsph")
        self.assertIn("1 values changed, 0 runs are new", out)
        self.compare()
        after = read_json((self.dir / "b.json").read_text())
        first, second = after["history"]
        self.assertEqual((first["reason"], second["reason"], second["changes"]),
                         ("the first", 'walls "press" back', 1))
        self.assertRegex(second["date"], r"^\d{4}-\d\d-\d\dT")
        self.assertTrue(second["commit"])
        self.assertEqual(sum(a != b for a, b in zip(before.splitlines(), (
            self.dir / "b.json").read_text().splitlines()) if '" with ' in a or " with " in a), 1,
            "a run is a line")

    def test_damaged(self):
        for change, part in ((lambda b: b.pop("history"), "'history'"),
                             (lambda b: b["rules"]["default"].update(abs=-1), "at least 0"),
                             (lambda b: next(run for run in b["runs"].values() if "mad" in run)
                              .update(seeds=0), "seeds"),
                             (lambda b: next(run for run in b["runs"].values() if "curves" in run)
                              ["curves"].update(residual=[1]), "residual has 1 numbers")):
            baseline = read_json((pathlib.Path(self.store.name) / "b.json").read_text())
            change(baseline)
            (self.dir / "b.json").write_text(json.dumps(baseline))
            self.one_sentence(self.call("compare", "r", "b.json", code=2)[1], "b.json", part)


if __name__ == "__main__":
    cli_case.main()
