#!/usr/bin/python3
"""Long runs: a checkpoint, a stop or a kill, and the run that goes on from there."""
import signal
import subprocess
import time

import numpy

import cli_case
from cli_case import Case, frame, read_json

RUN = ("run", "rotating-patch", "--spacing", "0.05", "--quiet", "--frames", "20", "--solver")
SAME = ("status", "steps", "time_end", "particles", "iterations", "residual", "metrics", "series")


class Restart(Case):
    def undisturbed(self, solver, *words):
        self.call(*RUN, solver, *words, "-o", "whole.vtkhdf", "--json", "whole.json")
        return self.results("whole")

    def disturbed(self, solver, number, *words):
        """A run that is ended by a signal after some steps; its restart file is there."""
        process = self.start(*RUN, solver, *words, "--checkpoint", "0", "-o", "r.vtkhdf",
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(lambda: (process.kill(), process.communicate()))
        for _ in range(6000):
            if (self.dir / "r.restart").exists():
                break
            time.sleep(0.001)
        time.sleep(0.05)
        process.send_signal(number)
        process.communicate(timeout=30)
        self.assertNotEqual(process.returncode, 0, "the run was too short for this test")

    def go_on(self, solver, *words, code=0):
        return self.call(*RUN, solver, *words, "--restart", "r.restart", "-o", "s.vtkhdf",
                         "--json", "s.json", code=code)

    def check_same(self, whole, after):
        (facts, file), (here, mine) = whole, after
        for key in SAME:
            self.assertEqual(facts[key], here[key], key)
        last = frame(file, file["VTKHDF/Steps"].attrs["NSteps"] - 1)
        mine = frame(mine, mine["VTKHDF/Steps"].attrs["NSteps"] - 1)
        for name in ("position", "velocity", "id"):
            self.assertTrue(numpy.array_equal(last(name), mine(name)), name)

    def test_stopped_and_killed(self):
        for solver, number in (("dfsph", signal.SIGTERM), ("dual-sc", signal.SIGKILL)):
            with self.subTest(solver=solver):
                words = ("--t-end", "2")
                whole = self.undisturbed(solver, *words)
                self.disturbed(solver, number, *words)
                self.go_on(solver, *words)
                self.check_same(whole, self.results("s"))
                (self.dir / "r.restart").unlink()

    def test_a_later_end(self):
        """The end may be put off: what comes before does not depend on it."""
        self.call(*RUN, "pbf", "--t-end", "0.5", "--set", "samples=50", "--checkpoint", "0",
                  "--json", "first.json", "-o", "r.vtkhdf")
        self.go_on("pbf", "--t-end", "1", "--set", "samples=100")
        facts = read_json((self.dir / "s.json").read_text())
        whole, _ = self.undisturbed("pbf", "--t-end", "1", "--set", "samples=100")
        for key in ("steps", "time_end", "metrics", "iterations"):
            self.assertEqual(facts[key], whole[key], key)

    def test_refused(self):
        self.call(*RUN, "pbf", "--t-end", "0.1", "--checkpoint", "0", "-o", "r.vtkhdf")
        for solver, words, parts in (
                ("dfsph", ("--t-end", "0.1"), ("solver 'pbf'", "'dfsph'")),
                ("pbf", ("--t-end", "0.1", "--dt", "0.003"), ("dt", "0.003")),
                ("pbf", ("--t-end", "0.1", "--set", "jitter=0.1"), ("jitter",)),
                ("pbf", ("--t-end", "0.05"), ("--t-end", "stands at")),
                ("pbf", ("--t-end", "0.1", "--precision", "float"), ("variant", "f32"))):
            with self.subTest(words=words):
                if "float" in words and "f32" not in self.variants():
                    continue
                self.one_sentence(self.go_on(solver, *words, code=2)[1], "r.restart", *parts)
        (self.dir / "r.restart").write_bytes((self.dir / "r.restart").read_bytes()[:3000])
        self.one_sentence(self.go_on("pbf", "--t-end", "0.1", code=2)[1], "r.restart")
        (self.dir / "r.restart").unlink()
        self.one_sentence(self.go_on("pbf", "--t-end", "0.1", code=2)[1], "r.restart")
        self.one_sentence(self.call(*RUN, "pbf", "--checkpoint", "soon", code=2)[1], "soon")

    def variants(self):
        built = [v["name"] for v in self.asked("list", "variants") if v["built"]]
        return "openmp-2d-f32" in built and "f32" or ""


if __name__ == "__main__":
    cli_case.main()
