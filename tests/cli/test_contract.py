#!/usr/bin/python3
"""Every pair of a scene and a solver that fit runs in every variant and leaves what the contract
of the command line promises; and every flag does what it says."""
import math
import re
import subprocess
import sys

import cli_case
from cli_case import Case, frame, read_json

TEXT, WHOLE, NUMBER = str, int, (int, float)
KEYS = {
    "scene": TEXT, "solver": TEXT, "variant": TEXT, "parameters": dict, "status": TEXT,
    "reason": (str, type(None)), "steps": WHOLE, "time_end": NUMBER, "particles": WHOLE,
    "iterations": {"mean": NUMBER, "max": WHOLE, "total": WHOLE},
    "residual": {"last": (int, float, type(None))},
    "metrics": dict, "series": dict,
    "timing": dict.fromkeys(("total", "neighbours", "solver", "integrate", "other", "per_step",
                             "per_iteration"), NUMBER),
    "memory": {"bytes_per_particle": NUMBER, "peak_rss_bytes": WHOLE, "fields": list},
    "provenance": {"commit": TEXT, "dirty": bool, "compiler": TEXT, "flags": TEXT, "cpu": TEXT,
                   "threads": WHOLE, "libraries": dict, "date": TEXT, "argv": list},
}
GENERAL = ("gamma_mean", "kinetic_energy", "potential_energy", "total_energy", "linear_momentum",
           "angular_momentum", "density_error_mean", "density_error_max", "volume_change")
# Where there is nothing to measure: a patch of few particles has none deep inside, and the front
# has not reached the first measured point; nothing has swung yet, the disc has no wave, and the
# column has not sunk.
MAY_BE_NULL = {"gamma_mean", "front_error", "period_error", "mode_amplitude", "mode_error",
               "bulk_modulus"}
# A force along a periodic axis has no potential.
NO_HEIGHT = {"poiseuille": {"potential_energy", "total_energy"}}
STEPS = 4
MATRIX = [(dim, precision) for dim in (2, 3) for precision in ("double", "float")]


class Pairs(Case):
    """Scene x solver x variant, on a lattice four times as coarse as the default."""

    def check_types(self, found, wanted, where=""):
        for key, kind in wanted.items():
            self.assertIn(key, found, f"{where}.{key}")
            if isinstance(kind, dict):
                self.check_types(found[key], kind, f"{where}.{key}")
            else:
                self.assertIsInstance(found[key], kind, f"{where}.{key}")

    def check_parameters(self, facts, scene, solver):
        rows = scene["parameters"] + solver["parameters"]
        names = [row["name"] for row in rows] + ["seed"]
        self.assertEqual(sorted(names), sorted(facts["parameters"]), "one name, one parameter")
        for row in rows:
            value = facts["parameters"][row["name"]]
            if "|" in row["unit"]:
                self.assertIn(value, row["unit"].split("|"))
            else:
                self.assertIsInstance(value, float)

    def check_metrics(self, facts, scene):
        metrics, series = facts["metrics"], facts["series"]
        self.assertLessEqual(set(GENERAL) | set(scene["metrics"]), set(metrics))
        self.assertEqual(set(series), set(metrics) | {"time", "iterations", "residual"})
        self.assertEqual(len({len(column) for column in series.values()}), 1)
        self.assertEqual(series["time"][0], 0)
        self.assertEqual(series["time"][-1], facts["time_end"])
        for name, metric in metrics.items():
            self.assertEqual(metric["unit"], self.units[name])
            self.assertEqual(metric["value"], series[name][-1])
            if name not in MAY_BE_NULL | NO_HEIGHT.get(scene["name"], set()):
                self.assertIsInstance(metric["value"], float, name)

    def check_file(self, facts, file, precision):
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        self.assertEqual(steps.attrs["NSteps"], len(steps["Values"]))
        self.assertEqual(steps["Values"][0], 0)
        self.assertEqual(steps["Values"][-1], facts["time_end"])
        self.assertEqual(root["Points"].dtype, {"double": "f8", "float": "f4"}[precision])
        before = None
        for k in range(steps.attrs["NSteps"]):
            rows = frame(file, k)
            x, label = rows("position"), rows("id")
            self.assertEqual(list(label), list(range(facts["particles"])))
            if before is not None:  # rows that were mixed up would leap
                self.assertLess(abs(x - before).max(), facts["parameters"]["spacing"])
            before = x
        self.assertEqual(file["run"].attrs["status"], "complete")
        for name, metric in facts["metrics"].items():
            found = file["metrics/final"][name][()]
            same = math.isnan(found) if metric["value"] is None else found == metric["value"]
            self.assertTrue(same, name)
        self.assertEqual("walls" in file, facts["walls"] > 0)
        for part in ("metrics", "run", "particles"):
            file[part].visititems(lambda name, node: hasattr(node, "shape") and self.assertEqual(
                {"unit", "description"} - set(node.attrs), set(), f"{part}/{name}"))

    def check_pair(self, scene, solver, dim, precision):
        spacing = next(4 * row["default"] for row in scene["parameters"]
                       if row["name"] == "spacing")
        words = ["--dim", dim, "--precision", precision, "--spacing", spacing]
        dt = next(row["default"] for row in scene["parameters"] if row["name"] == "dt")
        lacking = set(scene["asks"]) - set(solver["can"])
        if lacking:
            out, err = self.call("run", scene["name"], "--solver", solver["name"], *words, code=2)
            self.assertEqual(out, "")
            self.one_sentence(err, f"solver '{solver['name']}' cannot", "which the scene asks")
            return 0
        projection = "PROJECT" in scene["asks"]
        if not projection:
            words += ["--t-end", STEPS * dt, "--frames", 2]
        facts, file = self.run_scene(scene["name"], solver["name"], *words)
        self.check_types(facts, KEYS)
        self.assertEqual((facts["scene"], facts["solver"]), (scene["name"], solver["name"]))
        self.assertEqual(facts["variant"],
                         f"openmp-{dim}d-{'f32' if precision == 'float' else 'f64'}")
        self.assertEqual((facts["status"], facts["reason"]), ("ok", None))
        self.assertEqual(facts["steps"], 1 if projection else STEPS)
        self.assertEqual(file["VTKHDF/Steps"].attrs["NSteps"], 2 if projection else 3)
        self.check_parameters(facts, scene, solver)
        self.check_metrics(facts, scene)
        self.check_file(facts, file, precision)
        file.close()
        return 1

    def check_variant(self, dim, precision):
        self.units = {row["name"]: self.asked("show", row["name"])["unit"]
                      for row in self.asked("list", "metrics")}
        solvers = [self.asked("show", row["name"]) for row in self.asked("list", "solvers")]
        done = 0
        for row in self.asked("list", "scenes"):
            scene = self.asked("show", row["name"], "--dim", dim)
            for solver in solvers:
                if dim in scene["dims"]:
                    with self.subTest(scene=scene["name"], solver=solver["name"]):
                        done += self.check_pair(scene, solver, dim, precision)
        self.assertGreater(done, 10)

    def test_2d_double(self):
        self.check_variant(2, "double")

    def test_2d_float(self):
        self.check_variant(2, "float")

    def test_3d_double(self):
        self.check_variant(3, "double")

    def test_3d_float(self):
        self.check_variant(3, "float")


class Flags(Case):
    PATCH = ("run", "rotating-patch", "--solver", "dual-sc", "--spacing", "0.02", "--t-end",
             "0.004")

    def test_values_reach_the_run(self):
        facts, _ = self.run_scene(
            "rotating-patch", "dual-sc", "--dt=0.002", "--t-end", "0.006", "--spacing", "0.024",
            "--seed", "7", "--threads", "2", "--set", "volume=printed", "--set", "tolerance=1e-6",
            "--set", "support=3", "--set", "omega=1.5", "--set", "kernel=wendland2")
        found = {key: facts["parameters"][key] for key in (
            "dt", "t_end", "spacing", "seed", "volume", "tolerance", "support", "omega", "kernel")}
        self.assertEqual(found, {"dt": 0.002, "t_end": 0.006, "spacing": 0.024, "seed": 7,
                                 "volume": "printed", "tolerance": 1e-6, "support": 3,
                                 "omega": 1.5, "kernel": "wendland2"})
        self.assertEqual((facts["steps"], facts["particles"]), (3, 100))
        self.assertEqual(facts["provenance"]["threads"], 2)
        self.assertAlmostEqual(facts["time_end"], 0.006)
        self.assertEqual(facts["provenance"]["argv"][1:3], ["run", "rotating-patch"])

    def test_automatic_values_are_resolved(self):
        for scene, kappa in (("rotating-patch", 0), ("dam-break", 0.1)):
            facts, _ = self.run_scene(scene, "dual-sa", "--t-end", "0.001", "--spacing", "0.05")
            self.assertEqual(facts["parameters"]["kappa"], kappa)

    def test_seed(self):
        def start(seed):
            _, file = self.run_scene("rotating-patch", "pbf", "--set", "jitter=0.1", "--t-end",
                                     "0", "--seed", seed, "--spacing", "0.02")
            x = frame(file, 0)("position").tolist()
            file.close()
            return x
        self.assertEqual(start(1), start(1))
        self.assertNotEqual(start(1), start(2))

    def test_frames(self):
        for frames, found in ((1, 2), (4, 5), (100, 5)):  # at most one per step
            _, file = self.run_scene("rotating-patch", "pbf", "--spacing", "0.02", "--t-end",
                                     "0.004", "--frames", frames)
            self.assertEqual(file["VTKHDF/Steps"].attrs["NSteps"], found)
            file.close()

    def test_only_the_start(self):
        facts, file = self.run_scene("dam-break", "dfsph", "--spacing", "0.05", "--t-end", "0")
        self.assertEqual((facts["steps"], facts["status"]), (0, "ok"))
        self.assertEqual(file["VTKHDF/Steps"].attrs["NSteps"], 1)

    def test_output(self):
        self.call(*self.PATCH, "--quiet", "-o", "only.vtkhdf")
        self.assertEqual(self.files(), ["only.vtkhdf"])
        self.call(*self.PATCH, "--quiet", "--json", "only.json")
        self.assertEqual(self.files(), ["only.json", "only.vtkhdf"])
        out, _ = self.call(*self.PATCH, "--json", "-")
        self.assertEqual(read_json(out)["status"], "ok")
        out, _ = self.call(*self.PATCH, "--json", "/dev/stdout", "--quiet")
        self.assertEqual(read_json(out)["status"], "ok")
        self.assertEqual(self.call(*self.PATCH, "--quiet")[0], "")
        out, _ = self.call(*self.PATCH)
        self.assertIn("gamma_mean", out)
        self.assertIn("time:", out)
        self.assertEqual(len(self.files()), 2)

    def test_replaces_an_older_result(self):
        (self.dir / "r.vtkhdf").write_text("old")
        (self.dir / "r.json").write_text("old")
        facts, _ = self.run_scene("rotating-patch", "pbf", "--t-end", "0.001", "--spacing", "0.04")
        self.assertEqual(facts["steps"], 1)
        self.assertEqual(self.files(), ["r.json", "r.vtkhdf"])

    def test_dry_run(self):
        out, _ = self.call(*self.PATCH, "--dry-run", "-o", "a.vtkhdf", "--json", "a.json")
        self.assertIn("144 fluid and 0 wall particles, 4 steps of 0.001 s", out)
        self.assertRegex(out, r"volume +saturated ")
        self.assertEqual(self.files(), [])
        self.call(*self.PATCH, "--dry-run", "--set", "volume=3", code=2)

    def test_explain(self):
        out, _ = self.call(*self.PATCH, "--quiet", "--explain")
        for line in ("fields allocated", "fields left out:", "bytes per particle:",
                     "features absent: WALLS GRAVITY PERIODIC", "stages run"):
            self.assertIn(line, out)
        self.assertRegex(out, r"(?m)^  xsph +4 ")

    def test_help(self):
        out, _ = self.call("run", "--help")
        for flag in ("--solver", "--dt", "--t-end", "--spacing", "--dim", "--seed", "--set",
                     "--precision", "--backend", "--threads", "--frames", "-o", "--json",
                     "--quiet", "--explain", "--dry-run"):
            self.assertRegex(out, rf"(?m)^  {flag} ")
        self.assertNotIn("--particles", out)

    def test_vtkhdf_structure(self):
        checker = cli_case.ROOT / "tests/unit/check_vtkhdf.py"
        for scene, words in (("dam-break", ["--spacing", "0.05"]),
                             ("tank", ["--dim", "3", "--precision", "float", "--spacing", "0.1"])):
            self.run_scene(scene, "dual-sc", "--t-end", "0.003", *words)
            done = subprocess.run([sys.executable, checker, self.dir / "r.vtkhdf"],
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Lists(Case):
    def test_list(self):
        for kind in ("solvers", "scenes", "metrics", "figures", "variants"):
            rows = self.asked("list", kind)
            self.assertGreater(len(rows), 2, kind)
            for row in rows:
                self.assertRegex(row["name"], r"\A[a-z][a-z0-9_-]*\Z")
                self.assertRegex(row["about"], r"\A[^\n]{5,}\Z")
            out, _ = self.call("list", kind)
            self.assertEqual(len(out.splitlines()), len(rows))
            for row in rows:
                self.assertRegex(out, rf"(?m)^{row['name']} ")
        names = [row["name"] for row in self.asked("list")]
        for known in ("dual-sc", "dam-break", "gamma_mean", "patch-gallery", "openmp-2d-f64"):
            self.assertIn(known, names)

    def test_a_name_means_one_thing(self):
        names = [row["name"] for row in self.asked("list") if row["kind"] != "plans"]
        self.assertEqual(sorted(names), sorted(set(names)))

    def test_show(self):
        wanted = {"solvers": {"paper", "doi", "differences", "parameters", "fields", "can"},
                  "scenes": {"source", "parameters", "asks", "dims", "metrics"},
                  "metrics": {"unit"}}
        for kind, keys in wanted.items():
            for row in self.asked("list", kind):
                shown = self.asked("show", row["name"])
                self.assertLessEqual(keys | {"kind", "name", "about"}, set(shown))
                self.assertEqual(shown["about"], row["about"])
                for parameter in shown.get("parameters", ()):
                    self.assertLessEqual({"name", "unit", "meaning", "default"}, set(parameter))
                    self.assertEqual("|" in parameter["unit"], "range" not in parameter)
                out, _ = self.call("show", row["name"])
                self.assertIn(row["about"], out)
                for parameter in shown.get("parameters", ()):
                    self.assertRegex(out, rf"(?m)^  {parameter['name']} ")

    def test_set_takes_all_that_show_lists(self):
        rows = {row["name"]: row for name in ("tank", "dual-sc")
                for row in self.asked("show", name)["parameters"]}
        words = [word for name, row in rows.items()
                 for word in ("--set", f"{name}={row['default']}")]
        out, _ = self.call("run", "tank", "--solver", "dual-sc", "--dry-run", *words)
        for name in rows:
            self.assertRegex(out, rf"(?m)^  {name} ")


class SceneFile(Case):
    TEXT = """name: drop
dim: 2
params: {spacing: 0.02, dt: 0.001, t_end: 0.004, xsph: 0.01}
fluid:
  - disc: {centre: [0, 0.3], radius: 0.1}
  - box: {low: [-0.2, 0], high: [0.2, 0.1]}
walls:
  - box: {low: [-0.2, 0], high: [0.2, 0.4], open_top: true}
"""

    def test_run(self):
        (self.dir / "a.yaml").write_text(self.TEXT)
        facts, file = self.run_scene("a.yaml", "dfsph", "--set", "xsph=0.02", "--frames", "2")
        self.assertEqual((facts["scene"], facts["steps"], facts["status"]), ("drop", 4, "ok"))
        self.assertEqual(facts["parameters"]["xsph"], 0.02)
        self.assertEqual(file["VTKHDF/Steps"].attrs["NSteps"], 3)
        self.assertGreater(facts["walls"], 50)
        self.assertLessEqual(set(GENERAL), set(facts["metrics"]))
        file.close()
        self.run_scene(self.dir / "a.yaml", "dual-sb", "--precision", "float")

    def test_three_dimensions_without_asking(self):
        (self.dir / "b.yaml").write_text(
            "dim: 3\nparams: {spacing: 0.1, t_end: 0.002}\n"
            "fluid:\n  - box: {low: [0, 0, 0], high: [0.4, 0.4, 0.4]}\n")
        facts, _ = self.run_scene("b.yaml", "pbf")
        self.assertEqual((facts["variant"], facts["particles"]), ("openmp-3d-f64", 64))
        self.assertEqual(facts["scene"], "b")

    def test_the_example(self):
        example = cli_case.ROOT / "benchmarks/two-drops.yaml"
        name = re.search(r"(?m)^name: (\S+)$", example.read_text())[1]
        facts, _ = self.run_scene(example, "dual-sc", "--t-end", "0.002")
        self.assertEqual((facts["scene"], facts["status"]), (name, "ok"))


if __name__ == "__main__":
    cli_case.main()
