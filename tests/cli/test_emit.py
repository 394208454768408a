"""Sweeps that another engine carries out: the manifest, its tasks, GNU parallel."""
import json
import shutil
import signal
import subprocess
import time
import unittest

import cli_case
import sweep_case


def has_parallel():
    """Another program has the same name (of the moreutils)."""
    if not shutil.which("parallel"):
        return False
    said = subprocess.run(["parallel", "--version"], capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)
    return said.stdout.startswith("GNU parallel")


class Tasks(sweep_case.Case):
    def manifest(self):
        return json.loads((self.dir / "job/manifest.json").read_text())

    def test_runs_are_dealt_out(self):
        self.assertIn("9 runs in 3 tasks, at most 4 in one", self.emit("slurm", "--batch", "4"))
        self.assertEqual([len(task) for task in self.manifest()["tasks"]], [4, 4, 1])
        script = (self.dir / "job/job.sh").read_text()
        self.assertIn("#SBATCH --array=0-2\n", script)
        self.emit("slurm", "--batch", 2, "--jobs", 3, "--memory", 100, "--timeout", 30)
        script = (self.dir / "job/job.sh").read_text()
        self.assertIn("#SBATCH --array=0-4%3\n", script)
        self.assertIn("#SBATCH --mem=356M\n#SBATCH --time=3\n", script)

    def test_short_runs_share_a_task(self):
        self.assertIn("9 runs in 2 tasks", self.emit("slurm"))  # taken to be 10 s each
        shutil.rmtree(self.dir / "job")
        self.call("sweep", "tiny.yaml", "--results", "r", "--quiet")
        _, said = self.call("sweep", "tiny.yaml", "--emit", "slurm", "job", "--results", "r",
                            code=2)
        self.one_sentence(said, "all 9 runs are finished")
        self.assertFalse((self.dir / "job").exists())
        self.assertIn("9 runs in 1 tasks, at most 9", self.emit("slurm", "--fresh"))

    def test_tasks_merge_by_id(self):
        self.emit("parallel", "--batch", "3")
        for number in (2, 0):
            self.task(number)
        self.assertEqual([len(path.read_text().splitlines()) for path in self.parts()], [3, 3])
        out, _ = self.call("sweep", "tiny.yaml", "--results", "r", "--dry-run")
        self.assertIn("9 runs, 3 to do", out)
        self.task(1)
        self.gathered()
        self.same_as_a_plain_sweep()

    def test_a_task_that_is_started_again(self):
        """A killed one goes on where it was; a finished one does nothing; with --fresh neither does
        what it did."""
        self.call("sweep", "tiny.yaml", "--results", "r", "--quiet")
        self.emit("slurm", "--fresh")
        child = self.start("sweep", "--manifest", "job/manifest.json", "--task", "0", "--quiet")
        self.wait_until(lambda: len(self.journal()) >= sweep_case.RUNS + 2)
        child.send_signal(signal.SIGKILL)
        child.wait()
        done = len(self.journal()) - sweep_case.RUNS
        self.assertLess(done, sweep_case.RUNS, "the task was too short for this test")
        time.sleep(0.5)  # its child ends too
        for _ in range(2):
            self.task(0)
            self.assertEqual(len(self.journal()), 2 * sweep_case.RUNS)

    def test_torn_lines_and_parts_taken_in_twice(self):
        self.emit("slurm", "--batch", "5")
        self.task(0)
        self.task(1)
        part = self.parts()[0]
        lines = part.read_text()
        with open(self.dir / "r/journal.jsonl", "a") as file:
            file.write(lines[:lines.index("\n") + 1])  # killed while it took the part in
        with open(part, "a") as file:
            file.write('{"id": "0123456789abcdef", "sta')
        self.gathered()

    def test_who_may_work_at_once(self):
        (self.dir / "tiny.yaml").write_text(sweep_case.PLAN.replace(
            "set: [relaxation=2, clamp=free]", "dt: 0.00001"))
        self.emit("slurm", "--batch", "8", "--timeout", 50)
        child = self.start("sweep", "--manifest", "job/manifest.json", "--task", "1", "--quiet",
                           stderr=subprocess.DEVNULL)
        self.addCleanup(lambda: (child.kill(), child.wait()))
        self.wait_until(self.parts)
        self.one_sentence(self.task(1, code=2)[1], "another sphbench", "part")
        _, said = self.call("sweep", "tiny.yaml", "--results", "r", code=2)
        self.one_sentence(said, "another sphbench is running into 'r'")
        self.task(0)
        child.send_signal(signal.SIGTERM)
        self.assertEqual(child.wait(30), 3)

    def test_mistakes(self):
        def refused(*words, parts):
            self.one_sentence(self.call("sweep", *words, code=2)[1], *parts)
        refused("tiny.yaml", "--emit", "slrm", "job", parts=["'slrm'", "slurm or parallel"])
        refused("tiny.yaml", "--emit", "slurm", parts=["two values"])
        refused("tiny.yaml", "--batch", "3", parts=["--batch goes with --emit"])
        refused("tiny.yaml", "--emit", "slurm", "job", "--batch", "0", parts=["--batch: 0 found"])
        refused("--manifest", "job/manifest.json", "--task", "0", parts=["job/manifest.json"])
        self.emit("slurm")
        manifest = "--manifest", "job/manifest.json", "--task"
        refused(*manifest, "2", parts=["--task: 2 found, allowed is 0 to 1"])
        refused(*manifest[:2], parts=["--manifest and --task go together"])
        refused(*manifest, "0", "--timeout", "3", parts=["stands in the manifest"])
        refused("tiny.yaml", *manifest, "0", parts=["takes the place of a plan"])
        path = self.dir / "job/manifest.json"
        text = path.read_text()
        path.write_text(text.replace("side=0.1", "side=0.12"))
        refused(*manifest, "0", parts=["would be", "emit it again"])
        path.write_text(text[:-30])
        refused(*manifest, "0", parts=["manifest.json:"])
        path.write_text(text.replace("manifest of sphbench, 1", "manifest of sphbench, 2"))
        refused(*manifest, "0", parts=["sphbench, 2"])
        self.assertEqual([*(self.dir / "r/runs").iterdir()], [])


@unittest.skipUnless(has_parallel(), "GNU parallel is missing")
class Parallel(sweep_case.Case):
    def test_a_plan(self):
        folder = "a job's folder"
        self.emit("parallel", "--batch", "2", "--jobs", "2", folder=folder)
        ran = subprocess.run([self.dir / folder / "job.sh"], cwd="/", capture_output=True,
                             text=True, timeout=cli_case.LONGEST)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        log = (self.dir / folder / "joblog").read_text().splitlines()
        self.assertEqual([line.split("\t")[6] for line in log[1:]], ["0"] * 5)
        self.assertEqual(len(self.parts()), 5)
        self.gathered()
        self.same_as_a_plain_sweep()


if __name__ == "__main__":
    cli_case.main()
