"""What the tests of sweeps by other engines share: a small plan, and results compared bitwise."""
import json
import subprocess
import sys
import time

import cli_case

PLAN = """name: tiny
about: two solvers, two time steps, two sizes; one run diverges
runs:
  - scene: free-fall
    solvers: [pbf, dfsph]
    t_end: 0.01
    frames: 1
    product:
      - {name: dt, values: [0.001, 0.0005]}
      - {name: side, values: [0.1, 0.06]}
  - scene: rotating-patch
    solvers: [dfsph]
    t_end: 1
    spacing: 0.1
    set: [relaxation=2, clamp=free]
"""
RUNS = 9
FREE = ("timing", "memory", "provenance")  # may differ between identical runs


class Case(cli_case.Case):
    def setUp(self):
        super().setUp()
        (self.dir / "tiny.yaml").write_text(PLAN)

    def journal(self, results="r"):
        """The lines of the journal and of its parts, of runs that came to an end."""
        lines = [json.loads(line) for path in sorted((self.dir / results).glob("journal*.jsonl"))
                 for line in path.read_text().splitlines()]
        return [line for line in lines if line["status"] != "interrupted"]

    def parts(self, results="r"):
        return sorted((self.dir / results).glob("journal-*.part.jsonl"))

    def emit(self, engine, *words, folder="job"):
        out, _ = self.call("sweep", "tiny.yaml", "--emit", engine, folder, "--results", "r", *words)
        return out

    def task(self, number, *words, **more):
        return self.call("sweep", "--manifest", "job/manifest.json", "--task", number, "--quiet",
                         *words, **more)

    def wait_until(self, is_there):
        until = time.monotonic() + cli_case.LONGEST
        while not is_there():
            self.assertLess(time.monotonic(), until, "waited in vain")
            time.sleep(0.01)

    def gathered(self):
        """After the batch: a plain sweep finds all finished, and changes no file of a run."""
        before = {path: path.stat().st_mtime_ns for path in (self.dir / "r/runs").iterdir()}
        out, _ = self.call("sweep", "tiny.yaml", "--results", "r")
        self.assertIn(f"{RUNS} runs: {RUNS - 1} ok 1 diverged; 0 done now", out)
        self.assertEqual(before, {path: path.stat().st_mtime_ns
                                  for path in (self.dir / "r/runs").iterdir()})
        self.assertEqual(self.parts(), [])
        ids = [line["id"] for line in self.journal()]
        self.assertEqual(len(ids), RUNS)
        self.assertEqual(len(set(ids)), RUNS)

    def same_as_a_plain_sweep(self):
        self.call("sweep", "tiny.yaml", "--results", "plain", "--quiet")
        mine = sorted(path.name for path in (self.dir / "r/runs").glob("*.json"))
        theirs = sorted(path.name for path in (self.dir / "plain/runs").glob("*.json"))
        self.assertEqual(mine, theirs)
        self.assertEqual(len(mine), RUNS)
        for name in mine:
            facts = [json.loads((self.dir / folder / "runs" / name).read_text())
                     for folder in ("r", "plain")]
            for key in facts[0].keys() | facts[1].keys():
                if key not in FREE:
                    self.assertEqual(facts[0][key], facts[1][key], key)
            files = [str(self.dir / folder / "runs" / name.replace(".json", ".vtkhdf"))
                     for folder in ("r", "plain")]
            same = subprocess.run([sys.executable, cli_case.ROOT / "tools/h5same", *files],
                                  capture_output=True, text=True)
            self.assertEqual(same.returncode, 0, same.stdout + same.stderr)
        states = [{line["id"]: (line["status"], line["exit"], line["reason"])
                   for line in self.journal(folder)} for folder in ("r", "plain")]
        self.assertEqual(*states)
