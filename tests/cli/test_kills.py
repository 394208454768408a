"""A sweep survives kill -9 of its driver and of its runs, at any moment: it ends with the results
of an undisturbed one, bit for bit but for times.

    test_kills.py SPHBENCH [unittest's arguments]         20 runs, 4 kills
    test_kills.py SPHBENCH --long [unittest's arguments]  200 runs, 20 kills"""
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import time
import unittest

import cli_case
from cli_case import ROOT, read_json

PLAN = """name: kills
about: many tiny runs
runs:
  - scene: free-fall
    solvers: [{solvers}]
    t_end: 0.01
    frames: 1
    product:
      - {{name: side, values: [{sides}]}}
      - {{name: dt, values: [0.001, 0.0005]}}
"""
SHORT = {"runs": 20, "kills": 4, "solvers": ["dfsph", "pbf"], "sides": 5}
LONG = {"runs": 200, "kills": 20, "solvers": ["dfsph", "pbf", "wcsph", "dual-sc", "iisph"],
        "sides": 20}
SEED = 20240117
TIMES = ("timing", "memory", "provenance")


def children_of(pid):
    try:
        text = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text()
    except OSError:
        return []
    return [int(word) for word in text.split()]


class Kills(cli_case.Case):
    what = SHORT

    def setUp(self):
        super().setUp()
        sides = ", ".join(f"{0.05 + 0.005 * k:.3f}" for k in range(self.what["sides"]))
        self.plan = self.dir / "kills.yaml"
        self.plan.write_text(PLAN.format(solvers=", ".join(self.what["solvers"]), sides=sides))

    def journal(self, results):
        """Of the runs that came to an end, by whole lines; the last may be torn."""
        path = self.dir / results / "journal.jsonl"
        lines = path.read_text().split("\n") if path.exists() else []
        entries = []
        for line in lines:
            try:
                entries.append(json.loads(line))
            except ValueError:
                continue
        return [entry for entry in entries if entry["status"] != "interrupted"]

    def drive(self):
        return self.start("sweep", self.plan, "--results", "killed", "--quiet", "--jobs", "2",
                          stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)

    def disturb(self, chance):
        """Kill the driver or one of its runs each time that so many runs are finished."""
        kills = {"driver": 0, "run": 0}
        most = self.what["runs"] * 9 // 10
        moments = sorted(chance.randrange(most) for _ in range(self.what["kills"]))
        driver = self.drive()
        while moments:
            if driver.poll() is not None:  # it came to its end, some runs of it killed
                driver = self.drive()
            if len(self.journal("killed")) < moments[0]:
                time.sleep(0.001)
                continue
            time.sleep(chance.uniform(0, 0.03))
            victims = children_of(driver.pid) if chance.random() < 0.5 else []
            target = chance.choice(victims) if victims else driver.pid
            try:
                os.kill(target, signal.SIGKILL)
            except ProcessLookupError:  # the run has just ended: at another moment
                continue
            if target == driver.pid:
                if driver.wait() != -signal.SIGKILL:
                    continue
                driver = self.drive()
            kills["run" if victims else "driver"] += 1
            moments.pop(0)
        driver.kill()
        driver.wait()
        return kills

    def test_the_results_are_those_of_an_undisturbed_sweep(self):
        chance = random.Random(SEED)
        kills = self.disturb(chance)
        self.assertEqual(sum(kills.values()), self.what["kills"])
        self.assertGreater(kills["driver"], 0)
        self.assertGreater(kills["run"], 0)
        before = len(self.journal("killed"))
        self.assertLess(before, self.what["runs"], "the kills came after all was done")
        self.call("sweep", self.plan, "--results", "killed", "--quiet")
        self.call("sweep", self.plan, "--results", "calm", "--quiet")
        self.same_journals()
        self.same_results()
        out, _ = self.call("sweep", self.plan, "--results", "killed", "--dry-run")
        self.assertIn(f"{self.what['runs']} runs, 0 to do", out)

    def test_a_run_ends_with_its_driver(self):
        """Even one that does not listen: later it could write over the results of another."""
        self.plan.write_text(PLAN.format(solvers="dfsph", sides="0.4").replace(
            "t_end: 0.01", "t_end: 100"))
        driver = self.drive()
        runs = []
        while not runs and driver.poll() is None:
            runs = [pid for pid in children_of(driver.pid)
                    if b"free-fall" in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()]
            time.sleep(0.01)
        self.assertTrue(runs)
        os.kill(runs[0], signal.SIGSTOP)
        driver.kill()
        driver.wait()
        for _ in range(500):
            try:
                said = pathlib.Path(f"/proc/{runs[0]}/stat").read_text()
            except OSError:
                return
            if said.rpartition(")")[2].split()[0] in "ZX":
                return
            time.sleep(0.01)
        os.kill(runs[0], signal.SIGKILL)
        self.fail("the run lives on")

    def same_journals(self):
        killed, calm = self.journal("killed"), self.journal("calm")
        for entries in (killed, calm):
            self.assertEqual(len(entries), self.what["runs"], "each run ended once")
            self.assertEqual(len({entry["id"] for entry in entries}), self.what["runs"])
            for entry in entries:
                del entry["seconds"], entry["date"]
        self.assertEqual(sorted(killed, key=str), sorted(calm, key=str))

    def same_results(self):
        names = [sorted(os.listdir(self.dir / results / "runs")) for results in ("killed", "calm")]
        self.assertEqual(names[0], names[1], "nothing is left behind and nothing is missing")
        self.assertEqual(len(names[0]), 3 * self.what["runs"])
        for name in names[0]:
            pair = [self.dir / results / "runs" / name for results in ("killed", "calm")]
            if name.endswith(".json"):
                a, b = (read_json(path.read_text()) for path in pair)
                for key in TIMES:
                    del a[key], b[key]
                self.assertEqual(a, b, name)
        frames = [name for name in names[0] if name.endswith(".vtkhdf")]
        for name in random.Random(SEED).sample(frames, min(20, len(frames))):
            subprocess.run([sys.executable, ROOT / "tools" / "h5same",
                            self.dir / "killed" / "runs" / name,
                            self.dir / "calm" / "runs" / name], check=True)


if __name__ == "__main__":
    if "--long" in sys.argv:
        sys.argv.remove("--long")
        Kills.what = LONG
        cli_case.LONGEST = 600
    if not children_of(os.getpid()) and not pathlib.Path(
            f"/proc/{os.getpid()}/task/{os.getpid()}/children").exists():
        print("skipped: this system does not list the children of a process")
        sys.exit(77)
    cli_case.main()
