"""How a run of a sweep may end, each with its reason, and what the sweep says meanwhile."""
import json
import os
import pty
import re
import signal
import subprocess
import time

import cli_case

LONG = """name: long
about: a run that does not end by itself
runs:
  - {scene: free-fall, solvers: [pbf], t_end: 0.01, frames: 1}
  - {scene: rotating-patch, solvers: [pbf], dt: 0.00001, spacing: 0.02}
"""
DIVERGES = """name: mixed
about: one that ends well, one that diverges, one that the solver cannot do
runs:
  - {scene: free-fall, solvers: [pbf], t_end: 0.01, frames: 1}
  - {scene: rotating-patch, solvers: [dfsph], t_end: 1, spacing: 0.1,
     set: [relaxation=2, clamp=free]}
  - {scene: normal-impact, solvers: [pbf]}
"""


class States(cli_case.Case):
    def journal(self):
        path = self.dir / "r/journal.jsonl"
        return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []

    def plan(self, text):
        (self.dir / "p.yaml").write_text(text)

    def begun(self, plan):
        """A sweep that has done its short run and works at the long one."""
        self.plan(plan)
        sweep = self.start("sweep", "p.yaml", "--results", "r", "--quiet", "--jobs", "1",
                           stderr=subprocess.PIPE)
        self.addCleanup(lambda: (sweep.kill(), sweep.communicate()))
        until = time.monotonic() + cli_case.LONGEST
        while not self.journal() or not self.children(sweep.pid):
            self.assertLess(time.monotonic(), until)
            time.sleep(0.02)
        return sweep

    @staticmethod
    def children(pid):
        with open(f"/proc/{pid}/task/{pid}/children") as file:
            return [int(word) for word in file.read().split()]

    def states(self):
        return [(line["status"], line["reason"]) for line in self.journal()]

    def test_ok_diverged_skipped(self):
        self.plan(DIVERGES)
        self.call("sweep", "p.yaml", "--results", "r", "--quiet", "--jobs", "1")
        (ok, nothing), (diverged, when), (skipped, why) = self.states()
        self.assertEqual((ok, nothing), ("ok", ""))
        self.assertEqual(diverged, "diverged")
        self.assertRegex(when, r" at t = [0-9.]+ s$")
        self.assertEqual(skipped, "skipped")
        self.assertIn("pbf", why)
        out, _ = self.call("sweep", "p.yaml", "--results", "r")
        self.assertIn("3 runs: 1 ok 1 diverged 1 skipped; 0 done now", out)

    def test_stopped_with_the_sweep_and_run_again(self):
        sweep = self.begun(LONG)
        sweep.send_signal(signal.SIGINT)
        self.assertIn(b"1 of 2 runs were finished", sweep.communicate(timeout=40)[1])
        self.assertEqual(sweep.returncode, 3)
        self.assertEqual(self.states()[1], ("interrupted", "stopped with the sweep"))
        out, _ = self.call("sweep", "p.yaml", "--results", "r", "--dry-run")
        self.assertIn("2 runs, 1 to do", out)

    def test_killed_from_outside_and_run_again(self):
        sweep = self.begun(LONG)
        os.kill(self.children(sweep.pid)[0], signal.SIGKILL)
        self.assertIn(b"1 of 2 runs were stopped from outside", sweep.communicate(timeout=40)[1])
        self.assertEqual(sweep.returncode, 3)
        self.assertEqual(self.states()[1], ("interrupted", "ended by signal 9 (Killed)"))
        out, _ = self.call("sweep", "p.yaml", "--results", "r", "--dry-run")
        self.assertIn("2 runs, 1 to do", out)


class Estimates(cli_case.Case):
    """--dry-run: what the runs of a plan will take."""

    def dry_run(self, runs):
        (self.dir / "p.yaml").write_text(f"name: p\nabout: p\nruns:\n  - {runs}\n")
        return self.call("sweep", "p.yaml", "--results", "r", "--jobs", "2", "--dry-run")[0]

    def facts(self, name):
        path, = (self.dir / "r/runs").glob(f"{name}.json")
        return json.loads(path.read_text())

    def test_time_and_memory(self):
        small = "{scene: rotating-patch, solvers: [pbf], spacing: 0.01, t_end: 0.05, frames: 1}"
        large = small.replace("0.01,", "0.002,").replace("0.05", "0.01")
        words = self.dry_run(large).splitlines()
        self.assertIn("1 runs, 1 to do", words[1])
        self.dry_run(small)
        self.call("sweep", "p.yaml", "--results", "r", "--quiet")
        facts = self.facts("*")
        self.assertIn(": ok already", self.dry_run(small))
        line, summary = self.dry_run(large).splitlines()
        said = re.search(r": about (\S+) s, about (\S+) MiB$", line)
        seconds, mebibytes = map(float, said.groups())
        self.call("sweep", "p.yaml", "--results", "r", "--quiet")
        found = self.facts(line.split()[0])
        rate = ((facts["timing"]["total"] - facts["timing"]["output"]) / facts["steps"]
                / facts["particles"])
        expected = 0.1 + rate * found["particles"] * found["steps"]
        self.assertAlmostEqual(seconds / expected, 1, delta=0.06)  # two digits
        self.assertGreater(found["particles"], 20 * facts["particles"])
        peak = found["memory"]["peak_rss_bytes"] / 2**20
        self.assertGreater(peak, mebibytes / 1.5)
        self.assertLess(peak, mebibytes * 1.5)
        at_once = float(re.search(r"on 2; at most about (\S+) MiB at once$", summary).group(1))
        self.assertAlmostEqual(at_once / (2 * mebibytes), 1, delta=0.01)
        again = self.dry_run(large.replace("t_end", "set: [samples=200], t_end"))
        self.assertNotIn("took", again)
        self.call("sweep", "p.yaml", "--results", "r", "--quiet")
        self.assertRegex(self.call("sweep", "p.yaml", "--results", "r", "--fresh", "--dry-run")[0],
                         r": took \S+ s, about")

    def test_refused(self):
        self.assertIn(": refused", self.dry_run("{scene: normal-impact, solvers: [pbf]}"))


class Progress(cli_case.Case):
    """A bar with the time left on a terminal, plain lines elsewhere, nothing with --quiet."""

    def said(self, *words, tty):
        (self.dir / "p.yaml").write_text(LONG.replace("dt: 0.00001", "t_end: 0.3"))
        if not tty:
            return subprocess.run([cli_case.command(), *words], cwd=self.dir, check=True,
                                  stdin=subprocess.DEVNULL, capture_output=True).stderr.decode()
        mine, theirs = pty.openpty()
        with subprocess.Popen([cli_case.command(), *words], cwd=self.dir, stderr=theirs,
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              env=dict(os.environ, NO_COLOR="1", TERM="xterm")) as child:
            os.close(theirs)
            text = b""
            try:
                while part := os.read(mine, 4096):
                    text += part
            except OSError:  # the other end is closed
                pass
            os.close(mine)
        self.assertEqual(child.returncode, 0)
        return text.decode()

    def test_sweeps_and_runs(self):
        sweep = "sweep", "p.yaml", "--fresh"
        run = "run", "rotating-patch", "--solver", "pbf", "--spacing", "0.01", "--t-end", "2"
        for words, label in ((sweep, "runs ["), (run, "[")):
            bar = self.said(*words, tty=True)
            self.assertIn(label, bar)
            self.assertRegex(bar, r"\d+ %  \d+ s left")
            self.assertNotRegex(bar, "\x1b\\[[0-9;]*m", "NO_COLOR")
            plain = self.said(*words, tty=False)
            self.assertNotRegex(plain, "[\r\x1b]")
            self.assertEqual(self.said(*words, "--quiet", tty=False), "")
            self.assertEqual(self.said(*words, "--quiet", tty=True), "")
        self.assertRegex(self.said(*sweep, tty=False),
                         r"\A\[1/2\] free-fall with pbf .*: ok, \d+\.\d s\n\[2/2\] .*\n\Z")


if __name__ == "__main__":
    cli_case.main()
