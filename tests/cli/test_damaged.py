#!/usr/bin/python3
"""Files that hold what no run wrote: refused with one sentence before anything is computed."""
import shutil

import cli_case
from cli_case import Case, h5py

RUN = ("run", "s.yaml", "--solver", "dfsph", "--quiet")
SCENE = """dim: 2
params: {spacing: 0.25, dt: 0.001, t_end: 0.004}
fluid:
  - box: {low: [0, 0], high: [0.75, 0.5]}
  - box: {low: [0, 0.5], high: [0.5, 0.75]}
    rho0: 800
walls:
  - box: {low: [0, 0], high: [2, 2], layers: 1}
bodies:
  - box: {low: [1, 1], high: [1.5, 1.25]}
    density: 500
"""


class Restart(Case):
    def setUp(self):
        super().setUp()
        (self.dir / "s.yaml").write_text(SCENE)
        self.call(*RUN, "--t-end", "0.002", "--checkpoint", "0", "-o", "a.vtkhdf")

    def refused(self, change, *says):
        with self.subTest(says=says):
            shutil.copy(self.dir / "a.restart", self.dir / "b.restart")
            with h5py.File(self.dir / "b.restart", "r+") as file:
                change(file)
            out, err = self.call(*RUN, "--restart", "b.restart", "-o", "b.vtkhdf", code=2)
            self.assertEqual(out, "")
            self.one_sentence(err, "'b.restart'", *says)
            self.assertNotIn("b.vtkhdf", self.files())

    def put(self, name, value, at=0):
        """A change of one number."""
        def change(file):
            data = file[name]
            if data.shape:
                data[at] = value
            else:
                data[()] = value
        return change

    def test_it(self):
        self.call(*RUN, "--restart", "a.restart", "-o", "c.vtkhdf")
        last = -1
        for name, value, at, says in (
                ("fields/id", 1000000, 0, "allowed are 0 to"),
                ("fields/id", -1, 2, "allowed are 0 to"),
                ("fields/id", 1, slice(None), "each of them once"),
                ("fields/fluid", 2, 0, "allowed are 0 to 1"),
                ("fields/body", 2, last, "allowed are 0 to 1"),
                ("fields/body", 0.5, last, "allowed are 0 to 1"),
                ("fields/body", float("nan"), last, "allowed are 0 to 1"),
                ("solver/max_iterations", 1e300, 0, "allowed is 1 to 1e+06"),
                ("time", float("nan"), 0, "stands at t = nan"),
                ("dt", 0, 0, "stands at"),
                ("step", -5, 0, "step -5"),
                ("layers", -1, 0, "has made -1 layers"),
                ("particles", 900000000, 0, "positions of 9"),
                ("virtual", 7, 0, "virtual particles"),
                ("record/samples", 1 << 39, 0, "record/sample0 has"),
                ("record/steps", 1 << 39, 0, "record/step0 has")):
            self.refused(self.put(name, value, at), says)
        self.refused(lambda file: file.pop("fields/x"), "positions of")


class Plan(Case):
    def test_too_many_runs(self):
        values = ", ".join(str(k + 1) for k in range(101))
        (self.dir / "p.yaml").write_text(
            "name: p\nabout: too much\nruns:\n  - scene: two-particle\n    solvers: [dfsph]\n"
            f"    product:\n      - {{name: seed, values: [{values}]}}\n"
            f"      - {{name: frames, values: [{values}]}}\n")
        _, err = self.call("sweep", "p.yaml", "--dry-run", code=2)
        self.one_sentence(err, "p.yaml:7:7", "10201 runs", "at most 10000")


if __name__ == "__main__":
    cli_case.main()
