"""Sweeps, baselines and comparisons through the command line."""
import json
import os
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree

import cli_case

PLAN = """name: tiny
about: two solvers, two time steps
runs:
  - scene: free-fall
    solvers: [pbf, dfsph]
    t_end: 0.01
    frames: 1
    product:
      - {name: dt, values: [0.001, 0.0005]}
      - {name: side, values: [0.1, 0.08, 0.06]}
"""


class Case(cli_case.Case):
    def plan(self, text=PLAN):
        path = os.path.join(self.dir, "tiny.yaml")
        with open(path, "w") as file:
            file.write(text)
        return path

    def journal(self, results):
        with open(os.path.join(results, "journal.jsonl")) as file:
            return [json.loads(line) for line in file]

    def facts(self, results):
        runs = os.path.join(results, "runs")
        return [os.path.join(runs, name) for name in sorted(os.listdir(runs))
                if name.endswith(".json")]


class Sweeps(Case):
    def test_a_product_runs_once(self):
        plan, results = self.plan(), os.path.join(self.dir, "r")
        out, _ = self.call("sweep", plan, "--results", results, "--quiet", "--dry-run")
        self.assertIn("12 runs, 12 to do", out)
        self.call("sweep", plan, "--results", results, "--quiet")
        lines = self.journal(results)
        self.assertEqual(len(lines), 2 * 2 * 3)
        self.assertEqual({line["status"] for line in lines}, {"ok"})
        self.assertEqual(len({line["what"] for line in lines}), 6)
        self.call("sweep", plan, "--results", results, "--quiet")
        self.assertEqual(len(self.journal(results)), 12)
        self.call("sweep", plan, "--results", results, "--quiet", "--fresh")
        self.assertEqual(len(self.journal(results)), 24)

    def test_kills_lose_only_what_was_running(self):
        plan, results = self.plan(), os.path.join(self.dir, "r")
        for kill in range(6):
            child = subprocess.Popen([cli_case.command(), "sweep", plan, "--results", results,
                                      "--quiet"], stderr=subprocess.DEVNULL)
            time.sleep(0.1 + 0.05 * kill)
            child.send_signal(signal.SIGKILL)
            child.wait()
        for _ in range(50):  # children of the killed driver end too; its lock goes with them
            code = subprocess.run([cli_case.command(), "sweep", plan, "--results", results,
                                   "--quiet"], stderr=subprocess.DEVNULL).returncode
            if code == 0:
                break
            time.sleep(0.1)
        undisturbed = os.path.join(self.dir, "u")
        self.call("sweep", plan, "--results", undisturbed, "--quiet")
        ids = [line["id"] for line in self.journal(results)]
        self.assertEqual(len(ids), len(set(ids)))
        self.assertEqual(len(ids), 12)
        for path in self.facts(undisturbed):
            with open(path) as one, open(path.replace(undisturbed, results)) as other:
                a, b = json.load(one), json.load(other)
            for key in ("metrics", "series", "iterations", "parameters"):
                self.assertEqual(a[key], b[key])

    def test_a_time_limit(self):
        plan = self.plan(PLAN.replace("free-fall", "rotating-patch").replace("t_end: 0.01", "dt: "
                         "0.0001").split("    product")[0])
        results = os.path.join(self.dir, "r")
        self.call("sweep", plan, "--results", results, "--quiet", "--timeout", 0.4)
        lines = self.journal(results)
        self.assertEqual([line["status"] for line in lines], ["timeout"] * 2)
        self.assertIn("0.4 s", lines[0]["reason"])

    def test_mistakes(self):
        for text, parts in ((PLAN.replace("pbf", "pfb"), ("tiny.yaml:5", "'pfb' is no solver")),
                            (PLAN.replace("product", "products"), ("products", "product")),
                            (PLAN.replace("[0.001, 0.0005]", "[]"), ("'dt' has no values",)),
                            ("name: a\nabout: b\n", ("no runs",))):
            _, said = self.call("sweep", self.plan(text), "--results",
                                os.path.join(self.dir, "r"), code=2)
            for part in parts:
                self.assertIn(part, said)
        self.call("sweep", "quik", "--results", os.path.join(self.dir, "r"), code=2)
        nothing = PLAN.replace("free-fall", "normal-impact").replace("[pbf, dfsph]", "[pbf]")
        _, said = self.call("sweep", self.plan(nothing.split("    product")[0]), "--quiet",
                            "--results", os.path.join(self.dir, "r"), code=2)
        self.assertIn("nothing was run", said)


class Baselines(Case):
    def setUp(self):
        super().setUp()
        self.results = os.path.join(self.dir, "r")
        self.baseline = os.path.join(self.dir, "b.json")
        self.call("sweep", self.plan(PLAN.split("    product")[0]), "--results", self.results,
                  "--quiet")
        self.call("bless", self.results, self.baseline, "--reason", "the first")

    def change(self, what, number=0):
        path = self.facts(self.results)[number]
        with open(path) as file:
            facts = json.load(file)
        what(facts)
        with open(path, "w") as file:
            json.dump(facts, file)

    def compare(self, code):
        found = os.path.join(self.dir, "c.json")
        self.call("compare", self.results, self.baseline, "--json", found, code=code)
        with open(found) as file:
            return json.load(file)

    def fails_by(self, name, what):
        self.change(what)
        found = self.compare(1)
        self.assertEqual({row["name"] for row in found["metrics"] if not row["pass"]}, {name})
        self.assertEqual(found["metrics"][0]["name"], name, "the worst comes first")

    def test_the_same_passes(self):
        found = self.compare(0)
        self.assertEqual(found["failed"], 0)
        self.assertGreater(found["compared"], 40)

    def test_a_value_beyond_its_gate(self):
        gate = next(row["tolerance"] for row in self.compare(0)["metrics"]
                    if row["name"] == "kinetic_energy" and row["baseline"] > 0)

        def shift(by):
            def change(facts):
                facts["metrics"]["kinetic_energy"]["value"] += by
            return change
        self.change(shift(0.5 * gate))
        self.compare(0)
        self.fails_by("kinetic_energy", shift(gate))

    def test_not_a_number_never_passes(self):
        def change(facts):
            facts["metrics"]["trajectory_error"]["value"] = None
        self.fails_by("trajectory_error", change)

    def test_a_missing_metric_fails(self):
        self.fails_by("volume_change", lambda facts: facts["metrics"].pop("volume_change"))

    def test_fewer_iterations_fail(self):
        def change(facts):
            facts["iterations"]["mean"] -= 1
        self.fails_by("iterations_mean", change)

    def test_a_bent_curve_fails(self):
        def change(facts):
            curve = facts["series"]["total_energy"]
            curve[len(curve) // 2] += 1e-3 * max(map(abs, curve)) + 1e-6
        self.fails_by("total_energy.curve", change)

    def test_another_end_fails(self):
        def change(facts):
            facts["status"] = "diverged"
        self.fails_by("status", change)

    def test_a_missing_run_fails_and_a_new_metric_warns(self):
        os.remove(self.facts(self.results)[0])
        self.change(lambda facts: facts["metrics"].update(new={"value": 1, "unit": "1"}))
        found = self.compare(1)
        self.assertEqual([row["name"] for row in found["metrics"] if not row["pass"]], ["run"])
        self.assertEqual(found["unknown"], 1)

    def test_junit(self):
        self.fails_by("steps", lambda facts: facts.update(steps=11))
        path = os.path.join(self.dir, "j.xml")
        self.call("compare", self.results, self.baseline, "--junit", path, code=1)
        suite = xml.etree.ElementTree.parse(path).getroot()
        failed = [case.get("name") for case in suite if case.find("failure") is not None]
        self.assertEqual(failed, ["steps"])
        self.assertEqual(int(suite.get("tests")), len(list(suite)))

    def test_bless_tells_and_remembers(self):
        self.change(lambda facts: facts.update(steps=11))
        _, said = self.call("bless", self.results, self.baseline, code=2)
        self.assertIn("--reason", said)
        out, _ = self.call("bless", self.results, self.baseline, "--reason", "a step more")
        self.assertIn("steps", out)
        self.compare(0)
        with open(self.baseline) as file:
            history = json.load(file)["history"]
        self.assertEqual([entry["reason"] for entry in history], ["the first", "a step more"])
        self.assertEqual(history[1]["changes"], 1)

    def test_nothing_compared_is_no_pass(self):
        for path in self.facts(self.results):
            os.remove(path)
        self.call("compare", self.results, self.baseline, code=2)

    def test_damaged_baselines(self):
        with open(self.baseline) as file:
            text = file.read()
        for bad, part in ((text[:-20], "b.json:"), (text.replace('"rules"', '"rulez"'), "'rules'"),
                          (text.replace('"why"', '"side": "left", "why"', 1), "allowed is both")):
            with open(self.baseline, "w") as file:
                file.write(bad)
            _, said = self.call("compare", self.results, self.baseline, code=2)
            self.assertIn(part, said)


if __name__ == "__main__":
    cli_case.main()
