#!/usr/bin/python3
"""Runs that do not reach their end: stopped, killed, or diverged. What they computed is kept."""
import os
import signal
import subprocess
import time

import h5py
import numpy

import cli_case
from cli_case import Case, frame

# A million steps of a few milliseconds, a frame for each.
LONG = ("run", "rotating-patch", "--solver", "pbf", "--spacing", "0.01", "--t-end", "1000",
        "--frames", "1000000", "--set", "samples=1e6", "-o", "r.vtkhdf", "--json", "r.json")
UNDER_WAY = 300000  # bytes of the result file: some tens of frames
OPEN = {"HDF5_USE_FILE_LOCKING": "FALSE"}


class Stopped(Case):
    def under_way(self, *words):
        """A run of which some frames are written. (Of flags given twice the last counts.)"""
        process = self.start(*LONG, *words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(lambda: (process.kill(), process.communicate()))
        temporary = self.dir / "r.vtkhdf.tmp"
        for _ in range(6000):
            if temporary.exists() and temporary.stat().st_size > UNDER_WAY:
                return process
            if process.poll() is not None:
                break
            time.sleep(0.005)
        self.fail("the run did not start: " + process.stderr.read().decode())

    def check_whole(self, facts, file):
        """Do the frames and the series reach the end that the facts tell of?"""
        steps, count = file["VTKHDF/Steps"], facts["steps"] + 1
        self.assertEqual(steps.attrs["NSteps"], count)
        self.assertEqual(steps["Values"].shape, (count,))
        self.assertEqual(file["VTKHDF/FieldData/step"][-1], facts["steps"])
        self.assertEqual(steps["Values"][-1], facts["time_end"])
        self.assertEqual(facts["series"]["time"][-1], facts["time_end"])
        self.assertEqual(file["metrics/time"].shape, (count,))
        self.assertEqual(file["metrics/steps/iterations"].shape, (count - 1,))
        self.assertEqual(file["VTKHDF/Points"].shape[0], count * facts["particles"])
        self.assertTrue(numpy.isfinite(frame(file, count - 1)("position")).all())
        self.assertGreater(file["metrics/final/kinetic_energy"][()], 0)

    def test_signals(self):
        for number, said in ((signal.SIGINT, "stopped by Ctrl-C"),
                             (signal.SIGTERM, "stopped by SIGTERM"),
                             (signal.SIGHUP, "terminal was closed")):
            with self.subTest(signal=number):
                process = self.under_way()
                begun = time.monotonic()
                process.send_signal(number)
                out, err = process.communicate(timeout=20)
                self.assertLess(time.monotonic() - begun, 10)  # a step takes milliseconds
                self.assertEqual(process.returncode, 3)
                self.one_sentence(err.decode(), "was stopped at t = ", said)
                self.assertIn(b"gamma_mean", out)
                self.assertEqual(self.files(), ["r.json", "r.vtkhdf"])
                facts, file = self.results()
                self.assertEqual(facts["status"], "interrupted")
                self.assertIn(said, facts["reason"])
                self.assertEqual(file["run"].attrs["status"], "interrupted")
                self.assertIn(said, file["run"].attrs["reason"])
                self.check_whole(facts, file)
                file.close()

    def test_many_signals(self):
        """As from `timeout`, which signals twice, or an impatient user."""
        process = self.under_way("--quiet")
        for number in (signal.SIGINT, signal.SIGINT, signal.SIGTERM, signal.SIGINT):
            process.send_signal(number)
        out, err = process.communicate(timeout=20)
        self.assertEqual((process.returncode, out), (3, b""))
        self.one_sentence(err.decode(), "was stopped")
        facts, file = self.results()
        self.check_whole(facts, file)

    def test_without_files(self):
        words = LONG[:LONG.index("-o")]
        process = self.start(*words, "--quiet", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(0.5)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=20)
        self.assertEqual(out, b"")
        if process.returncode != -signal.SIGTERM:  # it was so slow that it had not begun
            self.assertEqual(process.returncode, 3)
            self.one_sentence(err.decode(), "was stopped")
        self.assertEqual(self.files(), [])

    def test_nohup(self):
        process = self.under_way("--quiet")
        process.terminate()
        process.communicate(timeout=20)
        process = self.start(*LONG, "--quiet", stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                             preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        time.sleep(0.5)
        process.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        process.terminate()
        process.communicate(timeout=20)

    def between_frames(self, process):
        """Wait until a frame has just been written."""
        temporary, size = self.dir / "r.vtkhdf.tmp", 0
        while size == 0 or temporary.stat().st_size == size:
            size = temporary.stat().st_size
            self.assertIsNone(process.poll())
            time.sleep(0.002)
        while temporary.stat().st_size != size:
            size = temporary.stat().st_size
            time.sleep(0.02)

    def test_killed(self):
        """In the middle of writing a frame HDF5 can be left with half of it: not tested here."""
        process = self.under_way("--frames", "10000", "--spacing", "0.0075")
        self.between_frames(process)
        process.kill()
        process.communicate(timeout=20)
        self.assertEqual(self.files(), ["r.vtkhdf.tmp"])
        with h5py.File(self.dir / "r.vtkhdf.tmp", "r") as file:
            self.assertEqual(file["run"].attrs["status"], "running")
            self.assertEqual(file["run"].attrs["scene"], "rotating-patch")
            count = int(file["VTKHDF/Steps"].attrs["NSteps"])
            self.assertGreater(count, 3)
            for k in range(count):
                rows = frame(file, k)
                self.assertEqual(list(rows("id")), list(range(1024)))
                self.assertTrue(numpy.isfinite(rows("position")).all())
            times = file["VTKHDF/Steps/Values"][()]
            self.assertTrue(numpy.allclose(times, 0.1 * numpy.arange(count), atol=6e-4))
            self.assertGreaterEqual(file["metrics/time"].shape[0], count - 1)
            self.assertGreater(file["metrics/kinetic_energy"][()].min(), 0)
        # the next run takes the place over
        facts, _ = self.run_scene("rotating-patch", "pbf", "--spacing", "0.03", "--t-end", "0.002")
        self.assertEqual(facts["status"], "ok")
        self.assertEqual(self.files(), ["r.json", "r.vtkhdf"])

    def test_two_runs_and_one_name(self):
        process = self.under_way()
        _, err = self.call(*LONG[:-2], code=2)
        self.one_sentence(err, "'r.vtkhdf'", "another run is writing it")
        process.terminate()
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, 3)
        self.check_whole(*self.results())

    def test_read_while_it_runs(self):
        process = self.under_way()
        script = ("import h5py; f = h5py.File('r.vtkhdf.tmp', 'r'); "
                  "print(f['VTKHDF/Steps'].attrs['NSteps'] > 3)")
        for _ in range(10):  # who comes in the middle of a flush must come again
            done = subprocess.run(["/usr/bin/python3", "-c", script], cwd=self.dir, check=False,
                                  env={**os.environ, **OPEN}, capture_output=True, text=True)
            if done.returncode == 0:
                break
        self.assertEqual(done.stdout.strip(), "True", done.stderr)
        process.terminate()
        process.communicate(timeout=20)


class Diverged(Case):
    # Beyond what the iteration bears: see the parameter's meaning and the solver's differences.
    WORDS = ("--set", "relaxation=2", "--set", "clamp=free", "--spacing", "0.02", "--t-end", "1")

    def check(self, scene, solver, *words, reason):
        out, err = self.call("run", scene, "--solver", solver, "-o", "r.vtkhdf", "--json",
                             "r.json", *words, code=3)
        facts, file = self.results()
        self.assertEqual(facts["status"], "diverged")
        self.assertRegex(facts["reason"], reason)
        warning, err = err.split("\n", 1)
        self.assertIn("relaxation 2 is beyond", warning)
        self.one_sentence(err, f"the run diverged at t = {facts['time_end']:.6g} s "
                          f"(step {facts['steps']}): {facts['reason']}")
        self.assertIn("gamma_printed", out)
        self.assertEqual(self.files(), ["r.json", "r.vtkhdf"])
        self.assertEqual(file["run"].attrs["status"], "diverged")
        self.assertEqual(file["run"].attrs["reason"], facts["reason"])
        self.assertGreaterEqual(facts["steps"], 1)
        self.assertEqual(file["metrics/steps/time"].shape[0], facts["steps"])
        for name in ("VTKHDF/Points", "VTKHDF/PointData/velocity", "metrics/kinetic_energy"):
            self.assertTrue(numpy.isfinite(file[name][()]).all(), name)
        return facts, file

    def test_too_fast(self):
        """A state that is absurd but finite is the last frame."""
        facts, file = self.check("rotating-patch", "dfsph", *self.WORDS,
                                 reason="times what the energy allows")
        self.assertEqual(file["VTKHDF/Steps/Values"][-1], facts["time_end"])

    def test_not_finite(self):
        """The last frame is the last one due that can be drawn."""
        for words in ((), ("--frames", "1000")):
            facts, file = self.check("rotating-patch", "dfsph", *self.WORDS, *words, "--precision",
                                     "float", reason="not finite|not a number")
            last = file["VTKHDF/Steps/Values"][-1]
            self.assertLess(last, facts["time_end"])
            if words:
                self.assertEqual(file["VTKHDF/Steps"].attrs["NSteps"], facts["steps"])
            file.close()

    def test_every_solver_ends_somehow(self):
        """Far too large a step: nothing crashes, hangs or is called a success with NaN in it."""
        for row in self.asked("list", "solvers"):
            for scene in ("dam-break", "rotating-patch"):
                for dt in ("0.3", "1e3", "1e6"):
                    with self.subTest(solver=row["name"], scene=scene, dt=dt):
                        words = ("run", scene, "--solver", row["name"], "--spacing", "0.05",
                                 "--dt", dt, "--t-end", 5 * float(dt), "-o", "r.vtkhdf", "--json",
                                 "r.json", "--quiet")
                        with self.start(*words, stderr=subprocess.PIPE) as process:
                            process.communicate(timeout=cli_case.LONGEST)
                        facts, file = self.results()
                        self.assertEqual(facts["status"],
                                         {0: "ok", 3: "diverged"}.get(process.returncode))
                        self.assertTrue(numpy.isfinite(file["VTKHDF/Points"][()]).all())
                        file.close()


if __name__ == "__main__":
    cli_case.main()
