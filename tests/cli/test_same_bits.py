#!/usr/bin/python3
"""A result does not depend on the number of threads, the direction of sweeps, what memory held
before, or the day: the files are the same but for /run/volatile."""
import importlib.machinery
import importlib.util
import shutil

import h5py

import cli_case
from cli_case import Case

LOADER = importlib.machinery.SourceFileLoader("h5same", str(cli_case.ROOT / "tools/h5same"))
h5same = importlib.util.module_from_spec(importlib.util.spec_from_loader("h5same", LOADER))
LOADER.exec_module(h5same)

# Disorder, so that every solver has work to do from the first step on.
STEPS = ("--t-end", "0.003", "--frames", "3", "--set", "jitter=0.2")
SCENES = {  # of more than a chunk of the sums and enough particles that loops take threads
    "rotating-patch": ("--spacing", "0.006"),
    "dam-break": ("--spacing", "0.014"),
    "dam-break --dim 3": ("--precision", "float", "--spacing", "0.04"),
}
OTHERS = {  # that must make no difference
    "again": {},
    "2 threads": {"threads": 2},
    "4 threads, reversed": {"threads": 4, "SPHBENCH_REVERSED": "1"},
    "poisoned": {"SPHBENCH_POISON": "1"},
}
# Sorting and searching take threads only for many particles: (scene, words, other)
LARGE = (
    ("tank", ("--spacing", "0.0025", "--t-end", "0.002"), "4 threads, reversed"),
    ("tank", ("--spacing", "0.0015", "--t-end", "0.001", "--precision", "float"), "2 threads"),
)


class SameBits(Case):
    def result(self, name, scene, solver, words, threads=1, **env):
        self.call("run", *scene.split(), "--solver", solver, *words, "--threads", threads,
                  "--quiet", "-o", f"{name}.vtkhdf", env=env)
        return h5py.File(self.dir / f"{name}.vtkhdf", "r")

    def compare(self, scene, solver, words, others):
        with self.result("first", scene, solver, words) as first:
            for name in others:
                with self.subTest(scene=scene, solver=solver, other=name):
                    with self.result("other", scene, solver, words, **OTHERS[name]) as other:
                        differences = list(h5same.compare("/", first, other, {"/run/volatile"}))
                    self.assertEqual(differences[:5], [])

    def check_scene(self, scene):
        for row in self.asked("list", "solvers"):
            self.compare(scene, row["name"], SCENES[scene] + STEPS, OTHERS)

    def test_patch(self):
        self.check_scene("rotating-patch")

    def test_dam_break(self):
        self.check_scene("dam-break")

    def test_dam_break_3d_float(self):
        self.check_scene("dam-break --dim 3")

    def test_many_particles(self):
        for scene, words, other in LARGE:
            for solver in ("dual-sc", "dfsph"):
                words += ("--set", "fixed_iterations=5", "--frames", "1", "--set", "jitter=0.2")
                self.compare(scene, solver, words, [other])

    def test_parameters_of_solvers(self):
        """Fields and stages that only some parameters ask for."""
        words = SCENES["dam-break"] + STEPS
        for solver, setting in (("dual-sa", "gradient=adjoint"), ("dual-sc", "gradient=adjoint"),
                                ("dual-sc", "offset=random"), ("dual-sc", "virtual_spacing=0.8"),
                                ("pbf", "scorr_k=0.01"), ("dfsph", "clamp=free"),
                                ("dfsph", "divergence_solver=off"), ("dfsph", "xsph=0")):
            self.compare("dam-break", solver, words + ("--set", setting),
                         ("4 threads, reversed", "poisoned"))

    def test_comparison_sees_a_difference(self):
        """The test of the test: one bit of one particle."""
        with self.result("first", "rotating-patch", "pbf", SCENES["rotating-patch"] + STEPS):
            pass
        shutil.copy(self.dir / "first.vtkhdf", self.dir / "other.vtkhdf")
        with h5py.File(self.dir / "other.vtkhdf", "r+") as other:
            x = other["VTKHDF/Points"][7, 0]
            other["VTKHDF/Points"][7, 0] = x * (1 + 2.3e-16)
        with h5py.File(self.dir / "first.vtkhdf", "r") as first:
            with h5py.File(self.dir / "other.vtkhdf", "r") as other:
                self.assertTrue(list(h5same.compare("/", first, other, {"/run/volatile"})))


if __name__ == "__main__":
    cli_case.main()
