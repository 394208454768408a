"""Runs judged, and the largest stable time step, through the command line."""
import json
import os
import subprocess
import unittest

import numpy

import cli_case

TINY = ("--spacing", "0.05", "--t-end", "0.05", "--quiet")


class Judged(cli_case.Case):
    def test_a_sound_run_breaks_nothing(self):
        facts, file = self.run_scene("free-fall", "pbf", "--t-end", "0.02")
        self.assertEqual(facts["judged"], [])
        self.assertLess(facts["energy_growth"], 0.01)
        self.assertGreater(facts["speed_max"], 0.1)
        self.assertNotIn("judged", file["run"])

    def test_a_failed_one_says_when_and_leaves_a_good_frame(self):
        self.call("run", cli_case.ROOT / "benchmarks/extreme-compressed.yaml", "--solver", "pbf",
                  "--set", "samples=1e6", "--quiet", "-o", "r.vtkhdf", "--json", "r.json", code=3)
        facts, file = self.results()
        words = [row["criterion"] for row in facts["judged"]]
        self.assertEqual(facts["status"], "diverged")
        self.assertIn("speed", words)
        times = [row["time"] for row in facts["judged"]]
        self.assertEqual(times, sorted(times))
        for row in facts["judged"]:
            self.assertGreater(row["value"], row["limit"])
        at = facts["judged"][words.index("speed")]["time"]
        self.assertLessEqual(facts["time_end"] - at, 3 * facts["parameters"]["dt"])
        self.assertEqual([w.decode() for w in file["run/judged/criterion"]], words)
        self.assertEqual(list(file["run/judged/time"]), times)
        for name in ("position", "velocity"):
            rows = cli_case.frame(file, -1)(name)
            self.assertGreater(len(rows), 10)
            self.assertTrue(numpy.isfinite(rows).all())


class Limits(cli_case.Case):
    def stability(self, *words, code=0):
        out, err = self.call("stability", *words, "--results", "r", "--json", "s.json", code=code)
        return out, err, cli_case.read_json((self.dir / "s.json").read_text())

    def journal(self):
        return (self.dir / "r/journal.jsonl").read_text().count("\n")

    def test_limits_and_map(self):
        words = ("tank", "--solvers", "pbf,dual-sc", "--seeds", "2", "--map",
                 "fixed_iterations=1,5", "--dts", "0.001,0.012", *TINY)
        _, _, found = self.stability(*words)
        self.assertEqual(found["scene"], "tank")
        self.assertEqual([row["solver"] for row in found["limits"]], ["pbf", "dual-sc"])
        for row in found["limits"]:
            stable = {}
            for trial in row["trials"]:
                stable.setdefault(trial["dt"], []).append(trial["failed"])
            good = [dt for dt, failed in stable.items() if failed == [None, None]]
            self.assertEqual(max(good, default=None), row["dt_max"])
            if row["reason"] is None:  # stable up to the longest that was tried
                self.assertAlmostEqual(row["dt_max"], 0.05 / 4)
            elif row["dt_max"] is not None:
                self.assertLessEqual(row["dt_failed"] / row["dt_max"], 1.051)
                self.assertEqual([w for w in stable[row["dt_failed"]] if w][0], row["reason"])
            if row["dt_max"] is not None:
                cfl = 0.4 * (2.5 * 0.05 / 2) / row["speed_max"]
                self.assertAlmostEqual(row["predicted"] / cfl, 1)
                self.assertEqual(row["predicted_by"], "cfl")
        self.assertEqual(len(found["map"]["cells"]), 2 * 2 * 2)
        self.assertEqual({cell["value"] for cell in found["map"]["cells"]}, {"1", "5"})
        files = self.files()
        for name in ("stability-limits", "stability-map"):
            for kind in ("svg", "png"):
                self.assertIn(f"r/stability/tank-fixed_iterations/{name}.{kind}", files)
        done = self.journal()
        _, _, again = self.stability(*words)
        self.assertEqual(self.journal(), done)  # nothing is run twice
        self.assertEqual(again, found)

    def test_a_criterion_can_be_left_out(self):
        words = ("dam-break", "--solvers", "pbf", "--seeds", "1", "--jitter", "0.5", *TINY)
        _, _, found = self.stability(*words)
        reason = found["limits"][0]["reason"]
        self.assertIsNotNone(reason)
        _, _, found = self.stability(*words, "--ignore", reason)
        self.assertNotIn(reason, [t["failed"] for t in found["limits"][0]["trials"]])
        self.assertEqual(found["ignored"], [reason])

    def test_viscous_limit(self):
        _, _, found = self.stability("tank", "--solvers", "pbf", "--seeds", "1", "--dt", "0.0005",
                                     "--set", "viscosity=2000", "--set", "viscosity_form=explicit",
                                     *TINY)
        row = found["limits"][0]
        self.assertAlmostEqual(row["predictions"]["viscous"], 0.125 * 0.0625**2 / 2, places=9)

    def test_mistakes(self):
        for words, parts in (((), ("SCENE",)),
                             (("tank", "--solvers", "pfb"), ("'pfb'", "'pbf'")),
                             (("tank", "--map", "kappa"), ("--map", "KEY=VALUE")),
                             (("tank", "--map", "dt=1,2"), ("--dts",)),
                             (("tank", "--ignore", "volum"), ("'volum'", "'volume'")),
                             (("tank", "--seeds", "0"), ("--seeds",)),
                             (("nowhere",), ("nowhere",)),
                             (("--extreme", "tank"), ("'tank'",))):
            _, err = self.call("stability", *words, "--results", "r", code=2)
            self.one_sentence(err, *parts)


PLAN = """name: tiny
about: one that works, one that fails, one that is refused
runs:
  - {scene: free-fall, solvers: [pbf], t_end: 0.01, frames: 1}
  - {scene: compressed.yaml, solvers: [pbf], frames: 1}
  - {scene: near.yaml, solvers: [pbf], frames: 1}
"""
NEAR = """name: near
dim: 2
params: {spacing: 0.01}
fluid:
  - box: {low: [0, 0], high: [0.02, 0.02]}
  - box: {low: [0, 0], high: [0.02, 0.02]}
"""


class Extreme(cli_case.Case):
    def test_a_particle_far_away_and_one_nowhere(self):
        for ending in ("", "-3d"):
            scene = cli_case.ROOT / f"benchmarks/extreme-far{ending}.yaml"
            facts, file = self.run_scene(scene, "pbf")
            self.assertEqual(facts["particles"], 126 if ending else 101)
            self.assertEqual(numpy.abs(cli_case.frame(file, 0)("position")).max(), 1e30)
            scene = cli_case.ROOT / f"benchmarks/extreme-nan{ending}.yaml"
            _, err = self.call("run", scene, "--solver", "pbf", code=2)
            self.one_sentence(err, "fluid[2].particle", ".nan")

    def test_a_table(self):
        folder = self.dir / "plans"
        os.mkdir(folder)
        (folder / "tiny.yaml").write_text(PLAN)
        (folder / "near.yaml").write_text(NEAR)  # found beside the plan
        compressed = cli_case.ROOT / "benchmarks/extreme-compressed.yaml"
        (folder / "compressed.yaml").write_text(compressed.read_text())
        out, _ = self.call("stability", "--extreme", "--plan", "plans/tiny.yaml", "--results", "r",
                           "--quiet", "--json", "-")
        rows = {row["scene"].rpartition("/")[2]: row for row in json.loads(out)["rows"]}
        self.assertEqual(len(rows), 3)
        good, bad, none = rows["free-fall"], rows["compressed.yaml"], rows["near.yaml"]
        self.assertTrue(good["finished"] and good["finite"] and good["failed"] is None)
        self.assertAlmostEqual(good["energy_ratio"], 1, delta=0.01)
        self.assertEqual((bad["status"], bad["finished"]), ("diverged", False))
        self.assertIsNotNone(bad["failed"])
        self.assertEqual(none["status"], "skipped")
        self.assertIn("fluid particle 0 and fluid particle 4", none["reason"])
        self.assertIn("r/stability/extreme.json", self.files())
        small = self.dir / "small.json"
        subprocess.run([cli_case.ROOT / "tools/stability-page", "--condense",
                        self.dir / "r/stability/extreme.json", small], check=True)
        cases = json.loads(small.read_text())["cases"]
        states = {case.split()[0]: runs["2d f64"]["pbf"][0] for case, runs in cases.items()}
        self.assertEqual(states, {"free-fall": "ok", "near": "skipped",
                                  "compressed": f"diverged ({bad['failed']})"})


if __name__ == "__main__":
    cli_case.main()
