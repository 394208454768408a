"""What the page of findings says: that it is up to date, and that a square of half the density
floats with a corner down."""
import importlib.machinery
import importlib.util
import json
import math
import shutil
import statistics
import subprocess
import sys
import unittest

import cli_case

FLOAT = """
dim: 2
params: {spacing: 0.02, dt: 0.001, t_end: 4.5}
domain: {low: [-0.1, -0.1], high: [1.1, 1.5]}
fluid:
  - box: {low: [0, 0], high: [1, 0.4]}
walls:
  - box: {low: [0, 0], high: [1, 0.8], open_top: true}
bodies:
  - box: {low: [0.4, 0.42], high: [0.6, 0.62]}
    density: 500
"""


class Tried(cli_case.Case):
    def test_a_corner_points_down(self):
        """With its sides level a square of density ratio 1/2 is unstable; at 45 degrees it is
        stable, and rocks about that."""
        import h5py
        scene = self.dir / "float.yaml"
        scene.write_text(FLOAT)
        self.call("run", scene, "--solver", "dfsph", "--quiet", "--frames", 90, "-o", "f.vtkhdf")
        with h5py.File(self.dir / "f.vtkhdf") as data:
            turn = [abs(angle) for angle in data["VTKHDF/FieldData/body1_turn_z"][:]]
        self.assertLess(max(turn[:15]), 0.05)
        self.assertAlmostEqual(statistics.mean(turn[-25:]), math.pi / 4, delta=0.12)


class Findings(cli_case.Case):
    """tools/findings on a copy of what it reads, so that its faults can be planted."""

    def setUp(self):
        super().setUp()
        for path in ("tools/findings", "tools/findings.json", "results/tried.json",
                     "results/claims.json", "docs/findings.md"):
            (self.dir / path).parent.mkdir(exist_ok=True)
            shutil.copy(cli_case.ROOT / path, self.dir / path)
        shutil.copytree(cli_case.ROOT / "tests", self.dir / "tests")

    def check(self):
        tool = [sys.executable, self.dir / "tools" / "findings", "--check"]
        done = subprocess.run(tool, capture_output=True, text=True)
        return done.returncode, done.stdout

    def test_the_page_is_up_to_date(self):
        self.assertEqual(self.check()[0], 0, self.check()[1])

    def test_a_changed_page_is_found(self):
        page = self.dir / "docs" / "findings.md"
        page.write_text(page.read_text().replace("does not hold", "holds", 1))
        self.assertEqual(self.check()[0], 1)

    def test_a_claim_that_no_longer_holds_is_found(self):
        claims = self.dir / "results" / "claims.json"
        kept = json.loads(claims.read_text())
        next(claim for claim in kept if claim["verdict"] == "holds")["verdict"] = "does not hold"
        claims.write_text(json.dumps(kept))
        self.assertEqual(self.check()[0], 1)
        subprocess.run([sys.executable, self.dir / "tools" / "findings", "--page"], check=True)
        self.assertEqual(self.check()[0], 0)

    def test_a_test_that_is_gone_is_found(self):
        (self.dir / "tests" / "law" / "test_tried.c").write_text("")
        code, said = self.check()
        self.assertEqual(code, 1)
        self.assertIn("test_xsph_over_dt", said)

    def test_verdicts_follow_the_bounds(self):
        """A made-up run and statements whose verdicts are known."""
        path = str(self.dir / "tools" / "findings")
        loader = importlib.machinery.SourceFileLoader("findings", path)
        tool = importlib.util.module_from_spec(importlib.util.spec_from_loader("findings", loader))
        loader.exec_module(tool)
        run = {"scene": "tank", "solver": "pbf", "parameters": {"dt": 0.001}, "status": "ok",
               "time_end": 1, "iterations": {"mean": 4}, "metrics": {"a": {"value": 3.0}},
               "series": {"time": [0, 1], "a": [2.0, 3.0]}}
        for text, low, high, verdict in (
                ("a of tank pbf dt=0.001", 3, 3, "holds"),
                ("a of tank pbf / a of tank pbf at 0", 1.4, 1.6, "holds"),
                ("a of tank pbf - iterations of tank pbf", None, -1, "holds"),
                ("a of tank pbf", None, 2.9, "does not hold"),
                ("a of tank pbf", 3.1, None, "does not hold"),
                ("a of tank pbf dt=0.002", 0, 9, "cannot be decided"),
                ("b of tank pbf", 0, 9, "cannot be decided")):
            entry = {"id": "x", "from": "y", "statement": "z", "values": [["w", text, low, high]]}
            self.assertEqual(tool.judge([run], entry)["verdict"], verdict, text)
        with self.assertRaises(tool.Trouble):
            tool.judge([run, run], entry)
        with self.assertRaises(tool.Trouble):
            tool.judge([], dict(entry, tests=["tests/law/test_tried.c:no_such_test"]))


if __name__ == "__main__":
    cli_case.main()
