"""Timed sweeps: what is kept of each timed run, the order that they take turns in, and how children
are started."""
import json
import os
import pathlib
import subprocess
import sys

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
"""
RUNS, REPEAT = 4, 4

# A busy neighbour of the timed runs.
SPIN = "import os, sys\nos.sched_setaffinity(0, {int(sys.argv[1])})\nwhile True: pass"


class Timed(cli_case.Case):
    def plan(self, text=PLAN):
        (self.dir / "tiny.yaml").write_text(text)

    def sweep(self, *words, **more):
        """Standard output; what the machine's load makes it say is left out."""
        with self.start("sweep", "tiny.yaml", "--results", "r", *words, stdout=subprocess.PIPE,
                        stderr=subprocess.PIPE, **more) as process:
            out, err = process.communicate(timeout=cli_case.LONGEST)
        self.assertEqual(process.returncode, 0, err)
        return out.decode()

    def timings(self):
        with open(self.dir / "r/timings.jsonl") as file:
            return [json.loads(line) for line in file]

    def test_rounds_there_and_back(self):
        self.plan()
        out = self.sweep("--timed", REPEAT)
        lines = self.timings()
        ids = [line["id"] for line in lines]
        there = ids[:RUNS]
        self.assertEqual(len(set(there)), RUNS)
        self.assertEqual(ids, 2 * (there + there[::-1]))
        mine = {str(core) for core in os.sched_getaffinity(0)}
        for line in lines:
            self.assertGreater(line["seconds"], 0)
            self.assertLess(line["seconds"], line["wall"])
            self.assertIn(line["cores"], mine)
            for key in ("load_before", "load_after", "others"):
                self.assertIsInstance(line[key], float)
        for line in lines[:RUNS]:
            times = sorted(one["seconds"] for one in lines if one["id"] == line["id"])
            self.assertIn(f"{(times[1] + times[2]) / 2:.4g} ", out)
            self.assertIn(f"[{times[0]:9.4g}, {times[3]:9.4g}]", out)
        self.assertEqual(sorted(path.name for path in (self.dir / "r").iterdir()),
                         ["journal.jsonl", "runs", "timings.jsonl"])

    def test_what_was_timed_is_not_timed_again(self):
        self.plan(PLAN.replace("runs:", "timed: 2\nruns:"))
        for words, lines in (((), 2), ((), 2), (("--timed", 3), 3), (("--threads", 2), 5),
                             (("--fresh",), 7)):
            self.sweep("--quiet", *words)
            self.assertEqual(len(self.timings()), lines * RUNS, words)

    def test_a_busy_machine_is_told_of(self):
        cores = sorted(os.sched_getaffinity(0))
        if len(cores) < 2:
            self.skipTest("there is one core only")
        self.plan()
        self.sweep("--quiet")
        with subprocess.Popen([sys.executable, "-c", SPIN, str(cores[0])]) as busy:
            try:
                said = subprocess.run([cli_case.command(), "sweep", "tiny.yaml", "--results", "r",
                                       "--timed", "2"], cwd=self.dir, capture_output=True,
                                      text=True, timeout=cli_case.LONGEST)
            finally:
                busy.kill()
        self.assertRegex(said.stderr, "the machine was busy before|others kept .* cores busy")
        others = sum(line["others"] for line in self.timings())
        self.assertGreater(others, 0.5 * sum(line["wall"] for line in self.timings()))

    def test_threads(self):
        """A parameter of a plan like others; the results do not depend on it."""
        self.plan(PLAN.replace("dt, values: [0.001, 0.0005]", "threads, values: [1, 2]"))
        self.sweep("--quiet")
        facts = [json.loads(path.read_text()) for path in (self.dir / "r/runs").glob("*.json")]
        found = sorted((one["solver"], one["provenance"]["threads"]) for one in facts)
        self.assertEqual(found, [("dfsph", 1), ("dfsph", 2), ("pbf", 1), ("pbf", 2)])
        for solver in ("dfsph", "pbf"):
            pair = [one["metrics"] for one in facts if one["solver"] == solver]
            self.assertEqual(*pair)

    def test_mistakes(self):
        self.plan(PLAN.replace("runs:", "timed: 1\nruns:"))
        self.one_sentence(self.call("sweep", "tiny.yaml", "--quiet", code=2)[1], "--timed: 1 found")
        _, said = self.call("sweep", "tiny.yaml", "--emit", "slurm", "job", "--timed", "3", code=2)
        self.one_sentence(said, "--timed does not go with --emit")


class Children(cli_case.Case):
    """What a run is started with, seen by one that stands in for it."""

    def setUp(self):
        super().setUp()
        built = pathlib.Path(cli_case.command()).resolve()
        (self.dir / "bin/variants").mkdir(parents=True)
        (self.dir / "bin/sphbench").write_bytes(built.read_bytes())
        (self.dir / "bin/sphbench").chmod(0o755)
        real = built.parent / "variants/sphbench-openmp-2d-f64"
        script = self.dir / "bin/variants/sphbench-openmp-2d-f64"
        script.write_text(f"#!/bin/sh\nenv | grep -E '^(OMP|GOMP)' > {self.dir}/env.$$\n"
                          f"grep Cpus_allowed_list /proc/self/status >> {self.dir}/env.$$\n"
                          f"exec {real} \"$@\"\n")
        script.chmod(0o755)

    def seen(self, *words):
        (self.dir / "tiny.yaml").write_text(PLAN)
        environment = {key: value for key, value in os.environ.items()
                       if not key.startswith(("OMP_", "GOMP_"))}
        ran = subprocess.run([self.dir / "bin/sphbench", "sweep", "tiny.yaml", "--quiet", *words],
                             cwd=self.dir, env=environment, capture_output=True, text=True,
                             timeout=cli_case.LONGEST)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        texts = [path.read_text() for path in self.dir.glob("env.*")]
        return [text for text in texts if "OMP_NUM_THREADS=1" in text]

    def test_nothing_spins_and_cores_are_free_or_held(self):
        untimed = self.seen()
        self.assertEqual(len(untimed), RUNS)
        everywhere = len(os.sched_getaffinity(0))
        for text in untimed:
            self.assertIn("OMP_WAIT_POLICY=passive", text)
            self.assertIn("OMP_PROC_BIND=false", text)
            self.assertEqual("," in text or "-" in text.split("list:")[1], everywhere > 1)
        for path in self.dir.glob("env.*"):
            path.unlink()
        timed = self.seen("--timed", "2")
        self.assertGreaterEqual(len(timed), 2 * RUNS + 1)
        for text in timed:
            self.assertIn("OMP_WAIT_POLICY=passive", text)
            self.assertRegex(text, r"Cpus_allowed_list:\s+\d+\n")
        self.assertEqual(len({text.split("list:")[1] for text in timed}), 1)


if __name__ == "__main__":
    cli_case.main()
