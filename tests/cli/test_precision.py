#!/usr/bin/python3
"""`precision`, `convergence` and `profile`: once with real solvers on a tiny scene, and with played
ones, whose errors and times are planted, so that every conclusion has a known answer."""
import json
import os
import shutil
import stat
import subprocess

import cli_case
from cli_case import Case, read_json

PICTURES = ("error-time.svg", "error-time.png", "error-pairs.svg", "error-pairs.png")
TINY = ("first-step", "--spacings", "0.03,0.02", "--tolerance-factors", "100,1", "--repeat", "5",
        "--solvers", "dual-sa,dfsph", "--quiet")
POINT_KEYS = {"solver", "parameters", "error", "error_kind", "time", "time_low", "time_high",
              "time_coverage", "repetitions", "setup", "pairs", "density_error", "valid", "reason"}

# A variant whose solvers are played: `run` writes what Played.solvers says, a time and an end.
STUB = r'''#!/usr/bin/python3
import json, os, sys
words = sys.argv[1:]
plan = json.load(open(os.path.join(os.path.dirname(sys.argv[0]), "plan.json")))
def value(flag, default=None):
    return words[words.index(flag) + 1] if flag in words else default
def row(name, default):
    return {"name": name, "unit": "1", "meaning": "m", "default": default, "range": [0, 1e9]}
if words[0] == "list":
    names = plan["solvers"] if words[1] == "solvers" else ["scene", "bare"]
    print(json.dumps([{"name": n, "about": "a"} for n in names]))
elif words[0] == "show" and words[1] in plan["solvers"]:
    print(json.dumps({"name": words[1], "parameters": [
        row("tolerance", 1e-3), row("max_iterations", 100), row("warm_start", 1)]}))
elif words[0] == "show":
    shown = {"name": words[1], "asks": [], "metrics": ["front_error", "tip_error"]}
    if words[1] == "scene":
        shown["error"] = "front_error"
    shown["parameters"] = [row("spacing", 0.01), row("dt", 0.001), row("t_end", 0.1),
                           row("kernel", 0), row("samples", 200)]
    print(json.dumps(shown))
else:
    solver = plan["solvers"][value("--solver")]
    if solver["how"] == "refuses":
        sys.stderr.write("sphbench: solver 'refuses' cannot run in a periodic domain\n")
        sys.exit(2)
    if "--dry-run" in words:
        sys.exit(0)
    sets = dict(w.split("=") for f, w in zip(words, words[1:]) if f == "--set")
    timed = sets.get("samples") == "1"
    with open(os.path.join(os.path.dirname(sys.argv[0]), "calls"), "a") as calls:
        calls.write(("timed " if timed else "checked ") + value("--solver") + "\n")
    h, dt = float(value("--spacing")), float(value("--dt"))
    seed = float(value("--seed", 0))
    tolerance = float(sets.get("tolerance", 1e-3))
    how = solver["how"]
    error = h ** 2 * (1 + 0.01 * (seed % 3)) + dt ** 2 + tolerance * 1e-6
    facts = {
        "scene": "scene", "solver": value("--solver"), "variant": "v",
        "status": "diverged" if how == "diverges" else "ok", "reason": "it flew apart",
        "steps": 3, "time_end": 0.1, "particles": round(1 / h), "walls": 0, "period": [0, 0, 0],
        "iterations": {"mean": 2, "max": 3, "total": 6 + (timed and how == "two-faced")},
        "residual": {"last": 1e-3},
        "pairs": {"visited": None if timed else 100 / h},
        "parameters": {"spacing": h, "dt": dt, "kernel": int(how == "odd"), "tolerance": tolerance,
                       "warm_start": 1, "seed": 1},
        "metrics": {"front_error": {"value": None if how == "blind" else error, "unit": "1"},
                    "kinetic_energy": {"value": 1, "unit": "J"},
                    "particles_lost": {"value": 2 * (how == "loses"), "unit": "1"}},
        "series": {"time": [0, 1], "density_error_mean": [0, 1e-3]},
        "timing": {"total": solver["time"] / h / 100 + 0.5, "metrics": 0.3, "output": 0.2},
        "provenance": {"commit": "c", "flags": "f", "cpu": "cpu", "compiler": "cc"}}
    json.dump(facts, open(value("--json"), "w")) if "--json" in words else None
    open(value("-o"), "w").close() if "-o" in words else None
    sys.exit(3 if how == "diverges" else 0)
'''


class Real(Case):
    """Two solvers and two knobs of a projection, within seconds."""

    def test_points_are_complete_and_repeat_bit_for_bit(self):
        self.call("precision", *TINY, "--results", "a", "--json", "a.json")
        self.call("precision", *TINY, "--results", "b", "--json", "b.json")
        a, b = (read_json((self.dir / name).read_text()) for name in ("a.json", "b.json"))
        self.assertEqual(len(a["points"]), 8)
        self.assertEqual(a["error"]["metric"], "pressure_error")
        self.assertIn("pressure against the scene's truth", a["error"]["about"])
        for one, other in zip(a["points"], b["points"]):
            self.assertLessEqual(POINT_KEYS, set(one))
            self.assertTrue(one["valid"], one["reason"])
            self.assertEqual(one["error_kind"], "total")
            self.assertLessEqual(one["time_low"], one["time"])
            self.assertLessEqual(one["time"], one["time_high"])
            self.assertEqual((one["repetitions"], one["time_coverage"]), (5, 0.9375))
            self.assertGreater(one["pairs"], 0)
            self.assertGreater(one["setup"], 0)
            for key in ("error", "pairs", "density_error", "iterations", "residual", "run"):
                self.assertEqual(one[key], other[key], key)
        # a projection of the rotation: the truth's order is one, and dfsph cannot pull
        errors = {(p["solver"], p["parameters"]["spacing"]): p["error"] for p in a["points"]}
        self.assertLess(errors["dual-sa", 0.02], 0.8 * errors["dual-sa", 0.03])
        self.assertTrue(all(check["same"] for check in a["fairness"]))
        checked = {check["what"] for check in a["fairness"]}
        self.assertLessEqual({"kernel", "support", "rho0", "number of particles"}, checked)
        self.assertEqual(set(a["fronts"]), {"dual-sa", "dfsph"})
        for picture in PICTURES:
            self.assertGreater((self.dir / "a/precision/first-step/total" / picture).stat().st_size,
                               3000)

    def test_counting_pairs_changes_nothing(self):
        words = ("run", "rotating-patch", "--solver", "dfsph", "--spacing", "0.02", "--t-end",
                 "0.05", "--quiet", "--json")
        self.call(*words, "a.json")
        self.call(*words, "b.json", "--count-pairs")
        a, b = (read_json((self.dir / name).read_text()) for name in ("a.json", "b.json"))
        self.assertIsNone(a["pairs"]["visited"])
        self.assertEqual(a["series"], b["series"])
        # a particle visits itself and its neighbours, at least in every iteration
        least = b["particles"] * b["iterations"]["total"] * 2
        self.assertGreater(b["pairs"]["visited"], 4 * least)
        self.assertLess(b["pairs"]["visited"], 21 * 20 * b["particles"] * b["steps"])

    def test_equations_on_a_grid_are_counted(self):
        def visited(iterations):
            out, _ = self.call("run", "elliptical-drop", "--solver", "flip", "--spacing", "0.2",
                               "--t-end", "0.0002", "--count-pairs", "--quiet", "--json", "-",
                               "--set", f"fixed_iterations={iterations}")
            return read_json(out)["pairs"]["visited"]
        # a row of the equations has the four cells beside it, in every iteration
        one, two, three = (visited(n) for n in (5, 10, 15))
        self.assertGreater(two - one, 0)
        self.assertLess(abs((three - two) / (two - one) - 1), 0.01)

    def test_other_kinds_of_error(self):
        for kind in ("algebraic", "temporal"):
            self.call("precision", "rotating-patch", "--solvers", "dual-sa", "--spacings", "0.03",
                      "--dt-factors", "2,1", "--tolerance-factors", "1000,1", "--t-end", "0.05",
                      "--repeat", "5", "--quiet", "--kind", kind, "--json", "k.json")
            points = read_json((self.dir / "k.json").read_text())["points"]
            self.assertEqual([p["error_kind"] for p in points], [kind, kind])
            self.assertGreater(points[0]["error"], 1.5 * points[1]["error"])

    def test_order_of_the_first_step(self):
        self.call("convergence", "first-step", "--solvers", "dual-sa", "--spacings",
                  "0.03,0.02,0.015,0.01", "--seeds", "0", "--quiet", "--json", "c.json")
        order = read_json((self.dir / "c.json").read_text())["orders"][0]
        self.assertLess(order["low"], 0.99)  # known: first order, as the surface is dx/2 outside
        self.assertGreater(order["high"], 0.95)
        self.assertLess(abs(order["order"] - 1), 0.1)


class Played(Case):
    """A front end whose variant is a script."""

    solvers = {
        "fast": {"how": "ok", "time": 0.1}, "slow": {"how": "ok", "time": 1.0},
        "equal": {"how": "ok", "time": 0.1002}, "diverges": {"how": "diverges", "time": 0.1},
        "loses": {"how": "loses", "time": 0.001}, "odd": {"how": "odd", "time": 0.001},
        "two-faced": {"how": "two-faced", "time": 0.001}, "blind": {"how": "blind", "time": 0.001},
        "refuses": {"how": "refuses", "time": 0.001},
    }

    def setUp(self):
        super().setUp()
        variants = self.dir / "bin/variants"
        variants.mkdir(parents=True)
        shutil.copy(cli_case.command(), self.dir / "bin/sphbench")
        stub = variants / "sphbench-openmp-2d-f64"
        stub.write_text(STUB)
        stub.chmod(stub.stat().st_mode | stat.S_IXUSR)
        (variants / "plan.json").write_text(json.dumps({"solvers": self.solvers}))

    def played(self, *words, code=0):
        done = subprocess.run([self.dir / "bin/sphbench", *words], cwd=self.dir, text=True,
                              capture_output=True, timeout=cli_case.LONGEST,
                              stdin=subprocess.DEVNULL, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout, done.stderr

    def calls(self):
        path = self.dir / "bin/variants/calls"
        lines = path.read_text().splitlines() if path.exists() else []
        return [sum(line.startswith(word) for line in lines) for word in ("checked", "timed")]

    def precision(self, *words, code=0):
        self.played("precision", "scene", "--spacings", "0.2,0.1", "--dt-factors", "1",
                    "--tolerance-factors", "1", "--repeat", "5", "--quiet", "--json", "p.json",
                    *words, code=code)
        return read_json((self.dir / "p.json").read_text())

    def test_planted_times_and_failures(self):
        result = self.precision()
        points = {(p["solver"], p["parameters"]["spacing"]): p for p in result["points"]}
        for solver, reason in (("diverges", "diverged: it flew apart"),
                               ("loses", "2 particles were lost"), ("odd", "its kernel is 1"),
                               ("two-faced", "computed something else"),
                               ("blind", "front_error is not a number")):
            for spacing in (0.2, 0.1):
                point = points[solver, spacing]
                self.assertFalse(point["valid"])
                self.assertIn(reason, point["reason"])
                for key in ("time", "time_low", "time_high"):
                    self.assertIsNone(point[key], "an invalid run has no time")
            self.assertNotIn(solver, result["fronts"])
        for solver in ("fast", "slow", "equal"):
            for spacing in (0.2, 0.1):
                time = self.solvers[solver]["time"] / spacing / 100
                self.assertAlmostEqual(points[solver, spacing]["time"], time, delta=1e-9)
        self.assertEqual([r["solver"] for r in result["refused"]], ["refuses"])
        self.assertIn("periodic", result["refused"][0]["reason"])
        self.assertEqual(result["warm_start"]["fast"], {"warm_start": 1})
        kernel = next(check for check in result["fairness"] if check["what"] == "kernel")
        self.assertFalse(kernel["same"])

    def test_table_names_the_cheapest(self):
        result = self.precision("--solvers", "slow,fast")
        ten, three, one = result["table"]
        self.assertEqual([ten["cheapest"], three["cheapest"], one["cheapest"]],
                         ["fast", "fast", None])
        # errors 0.04 at 0.2 and 0.01 (a little more) at 0.1
        self.assertAlmostEqual(ten["ranking"][0]["error"], 0.04, delta=0.001)
        self.assertAlmostEqual(three["ranking"][0]["error"], 0.01, delta=0.001)
        self.assertAlmostEqual(ten["factor_to_next"], 10, delta=1e-6)
        self.assertEqual(one["difference"], "no solver gets there")
        self.assertEqual(result["fronts"], {"slow": [0, 1], "fast": [2, 3]})

    def test_a_difference_below_the_noise_is_none(self):
        noise = {"floor": 1.05, "threads": 1, "cpu": "cpu"}
        (self.dir / "results/precision").mkdir(parents=True)
        (self.dir / "results/precision/noise.json").write_text(json.dumps(noise))
        result = self.precision("--solvers", "equal,fast")
        self.assertEqual(result["table"][0]["difference"], "none")
        self.assertIsNone(result["table"][0]["factor_to_next"])
        self.assertEqual(result["noise"]["floor"], 1.05)

    def test_the_same_solver_under_two_names(self):
        out, _ = self.played("precision", "scene", "--aa", "--solvers", "fast", "--spacings", "0.2",
                             "--repeat", "5", "--dt-factors", "1", "--tolerance-factors", "1")
        self.assertIn("noise", out)
        self.assertIn("fast (again) no slower", out)
        self.assertTrue((self.dir / "results/precision/noise.json").exists())

    def test_nothing_is_done_twice(self):
        first = self.precision("--solvers", "fast,slow")
        self.assertEqual(self.calls()[0], 4)
        calls = self.calls()
        self.assertGreaterEqual(calls[1], 20)  # 4 points, 5 times, and a warm-up
        again = self.precision("--solvers", "fast,slow")
        self.assertEqual(self.calls(), calls)
        self.assertEqual(first["points"], again["points"])
        timings = self.dir / "results/precision/scene/timings.jsonl"
        lines = timings.read_text().splitlines()
        timings.write_text("\n".join(lines[:-3]) + "\n{\"torn")  # as if it had been killed
        third = self.precision("--solvers", "fast,slow")
        self.assertEqual(first["table"], third["table"])
        self.assertEqual(self.calls()[0], 4)
        self.precision("--solvers", "fast,slow", "--fresh")
        self.assertGreaterEqual(self.calls()[1], calls[1] + 3 + 20)

    def test_turns_go_there_and_back(self):
        self.precision("--solvers", "fast,slow")
        lines = (self.dir / "results/precision/scene/timings.jsonl").read_text().splitlines()
        solvers = [json.loads(line)["solver"] for line in lines]
        self.assertEqual(solvers[:4], ["fast", "fast", "slow", "slow"])
        self.assertEqual(solvers[4:8], ["slow", "slow", "fast", "fast"])

    def test_orders_with_starts(self):
        self.played("convergence", "scene", "--solvers", "fast,diverges", "--spacings",
                    "0.8,0.4,0.2,0.1", "--seeds", "5", "--quiet", "--json", "c.json")
        result = read_json((self.dir / "c.json").read_text())
        fast, failed = result["orders"]
        self.assertAlmostEqual(fast["order"], 2, delta=0.01)
        self.assertLessEqual(fast["low"], 2)
        self.assertGreaterEqual(fast["high"], 2)
        self.assertGreater(fast["high"] - fast["low"], 0.001)
        self.assertEqual(len(result["points"]), 2 * 4 * 5)
        self.assertIsNone(failed["order"])
        self.assertIn("5 of 5 starts failed", failed["levels"][0]["reason"])

    def test_profiles(self):
        self.precision("--solvers", "slow,fast")
        out, _ = self.played("profile", "p.json", "-o", "profiles", "--json", "q.json")
        result = read_json((self.dir / "q.json").read_text())
        fast = next(s for s in result["solvers"] if s["solver"] == "fast")
        self.assertEqual((fast["fastest"], fast["solved"]), (1, 1))
        self.assertEqual(fast["faster_than"], {"slow": 1})
        self.assertEqual(len(result["problems"]), 2)
        self.assertIn("performance-profile.svg", out)

    def refused(self, *words, says):
        _, err = self.played(*words, code=2)
        self.assertRegex(err, r"\Asphbench: [^\n]{10,400}\n\Z")
        self.assertIn(says, err)

    def test_mistakes(self):
        self.refused("precision", says="SCENE is missing")
        self.refused("precision", "scen", says="nearest known one is 'scene'")
        self.refused("precision", "bare", says="no known truth")
        self.refused("precision", "my/scene.yaml", says="scene file")
        self.refused("precision", "scene", "--solvers", "fats", says="nearest known one is 'fast'")
        self.refused("precision", "scene", "--solvers", "fast,fast", says="twice")
        self.refused("precision", "scene", "--solvers", "refuses", says="periodic")
        self.refused("precision", "scene", "--kind", "sum", says="allowed is total")
        self.refused("precision", "scene", "--error", "tip_eror", says="'tip_error'")
        self.refused("precision", "scene", "--repeat", "4", says="5 to 250")
        self.refused("precision", "scene", "--spacings", "0.1,", says="numbers above 0")
        self.refused("precision", "scene", "--set", "xsph", says="KEY=VALUE")
        self.refused("precision", "scene", "--tolerance", "1", says="unknown flag")
        self.refused("precision", "scene", "--timeout", "1,2", says="one number")
        self.refused("convergence", "scene", "--over", "time",
                     says="allowed is spacing, dt or iterations")
        self.refused("convergence", "scene", "--spacings", "0.2,0.1", says="at least 4")
        self.refused("profile", says="FILEs are missing")
        (self.dir / "no.json").write_text("{}")
        self.refused("profile", "no.json", says="not a precision.json")
        self.assertFalse((self.dir / "bin/variants/calls").exists(), "nothing was run")

    def test_no_valid_run_is_a_failure(self):
        self.precision("--solvers", "diverges", code=3)


if __name__ == "__main__":
    if not shutil.which("gnuplot"):
        print("skipped: gnuplot is missing")
        raise SystemExit(77)
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    cli_case.main()
