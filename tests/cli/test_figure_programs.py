"""The programs that compute data of figures (analysis/figures), against analytic values and against
brute force over the particles of small runs."""
import itertools
import json
import math
import pathlib
import subprocess

import cli_case
from cli_case import h5py
import numpy

BLOCK = """
dim: 3
params: {spacing: 0.1, dt: 0.001, t_end: 0.001, support: 2, kernel: spiky, gravity: 0, xsph: 0,
         jitter: 0.2, samples: 1}
domain: {low: [-3, -3, -3], high: [3, 3, 3]}
fluid:
  - {box: {low: [-0.2, -0.2, -0.2], high: [0, 0.2, 0.2]}, velocity: [20, 0, 0]}
  - {box: {low: [0, -0.2, -0.2], high: [0.2, 0.2, 0.2]}, velocity: [-20, 0, 0]}
"""
SHEET = """
dim: 3
params: {spacing: 0.01, dt: 0.001, t_end: 0.001, gravity: 0, xsph: 0, samples: 1}
domain: {low: [-1, -1, -1], high: [1, 1, 1]}
fluid:
  - {box: {low: [0, 0, 0], high: [0.2, 0.1, 0.01]}, velocity: [1, 0, 0]}
"""


def spiky(r, R):
    return 15 / (math.pi * R ** 6) * (R - r) ** 3 if r < R else 0


def lattice_sum(R, dx):
    cells = range(-4, 5)
    return sum(spiky(dx * math.dist((0, 0, 0), at), R) for at in itertools.product(cells, repeat=3))


def lambdas(x, R, dx, paired=None):
    """Density over rest density; over the pairs that are within R at the places `paired`."""
    full, paired = lattice_sum(R, dx), paired or x
    return [sum(spiky(math.dist(a, b), R) for b, q in zip(x, paired) if math.dist(p, q) <= R) / full
            for a, p in zip(x, paired)]


class Programs(cli_case.Case):
    def simulate(self, name, *words):
        self.call("run", *words, "--frames", 1, "--json", f"{name}.json", "-o", f"{name}.vtkhdf")
        return f"{name}={self.dir}/{name}.json"

    def program(self, name, *words):
        """values.json and the data files' rows by name."""
        out = self.dir / f"out-{name}"
        out.mkdir(exist_ok=True)
        path = pathlib.Path(cli_case.command()).parent / f"sphbench-analysis-{name}"
        subprocess.run([path, out, *words], check=True, timeout=60)
        rows = {file.stem: [[float(word) for word in line.split()]
                            for line in file.read_text().splitlines()[2:]]
                for file in out.glob("*.dat")}
        values = out / "values.json"
        return json.loads(values.read_text()) if values.exists() else {}, rows

    def frames(self, name):
        with h5py.File(self.dir / f"{name}.vtkhdf") as file:
            fluid = file["particles/fluid"]
            spans = list(zip(fluid["first"][:], fluid["count"][:]))
            return [{key: fluid[key][first:first + count].tolist()
                     for key in ("position", "velocity")} for first, count in spans]

    def test_kernel(self):
        """In 1-D R^3 W'' = 16 u - 64 max(u - 1/2, 0), u = 1 - r/R: it passes 0 at r = R/3."""
        values, rows = self.program("kernel", "--")
        self.assertAlmostEqual(values["inflection"], 1 / 3, 8)
        self.assertAlmostEqual(values["middle_one"], 16 * 0.6 - 64 * 0.1, 6)
        self.assertAlmostEqual(values["middle_dual"], 16 * 0.8 - 64 * 0.3, 6)
        self.assertEqual(values["unstable_one"], 1)
        self.assertAlmostEqual(values["unstable_dual"], 1 / 3, 2)
        self.assertAlmostEqual(values["stiffness_one"], 2 * (3.2 + 16 * 0.2), 6)
        integral = sum(row[1] for row in rows["kernel"]) * 0.002
        self.assertAlmostEqual(integral, 1, 5)

    def test_coherence_of_a_sheet(self):
        """A flat sheet in uniform motion covers its area and has no variance."""
        (self.dir / "sheet.yaml").write_text(SHEET)
        run = self.simulate("sheet", "sheet.yaml", "--solver", "pbf")
        values, _ = self.program("coherence", "--", run)
        self.assertAlmostEqual(values["sheets_sheet"], 0.2 * 0.1, 6)
        self.assertLess(values["variance_sheet"], 1e-12)
        self.assertEqual(values["clumped_sheet"], 0)

    def test_coherence_by_brute_force(self):
        run = self.simulate("dam", "dam-break", "--solver", "dual-sc", "--spacing", 0.05, "--t-end",
                            0.3, "--set", "width=0.35")
        values, _ = self.program("coherence", "--", run)
        last = self.frames("dam")[-1]
        x, v = last["position"], last["velocity"]
        middle = [sum(c) / len(v) for c in zip(*v)]
        apart = 0
        for i, at in enumerate(x):
            near = [v[j] for j, b in enumerate(x) if j != i and math.dist(at, b) <= 0.105]
            if near:
                mean = [sum(c) / len(near) for c in zip(*near)]
                apart += math.dist(v[i], mean) ** 2
        expected = apart / sum(math.dist(a, middle) ** 2 for a in v)
        self.assertGreater(expected, 1e-4)
        self.assertAlmostEqual(values["variance_dam"] / expected, 1, 6)

    def patch(self, solver):
        run = self.simulate(solver, "rotating-patch", "--solver", solver, "--spacing", 0.01,
                            "--t-end", 1.2, "--frames", 4)
        return self.program("regularity", "--", run)[0]

    def test_regularity_by_brute_force(self):
        """S.C lets the patch deform; PBF turns it and lets it expand, which presses nothing."""
        values = self.patch("pbf")
        self.assertEqual(values["squeezed_pbf"], 0)
        self.assertEqual(values["clumped_pbf"], 0)
        values = self.patch("dual-sc")
        frames = self.frames("dual-sc")
        start, x = (numpy.array(frames[k]["position"])[:, :2] for k in (0, -1))
        clumped, squeezed = [], []
        for i in range(len(x)):
            far = numpy.hypot(*(x - x[i]).T)
            clumped.append(numpy.sort(far)[1] < 0.005)
            old, new = start - start[i], x - x[i]
            near = numpy.hypot(*old.T) < 0.0145
            fit = numpy.linalg.lstsq(old[near], new[near], rcond=None)[0]
            squeezed.append(numpy.linalg.svd(fit)[1][1] < 0.5)
        clumped, squeezed = numpy.array(clumped), numpy.array(squeezed)
        self.assertGreater(squeezed.mean(), 0.1)
        self.assertGreater(clumped.mean(), 0.02)
        self.assertAlmostEqual(values["clumped_dual_sc"], clumped.mean(), 9)
        self.assertAlmostEqual(values["squeezed_dual_sc"], squeezed.mean(), 9)
        self.assertAlmostEqual(values["elsewhere_dual_sc"], clumped[~squeezed].mean(), 9)

    def blocks(self, name, *sets):
        (self.dir / "block.yaml").write_text(BLOCK)
        words = [word for entry in sets for word in ("--set", entry)]
        return self.simulate(name, "block.yaml", "--solver", "sisph", *words)

    def psi(self, name, K):
        start, end = self.frames(name)
        x0, v0, x = start["position"], start["velocity"], end["position"]
        target = [[a + 0.001 * b for a, b in zip(*pair)] for pair in zip(x0, v0)]

        def of(at):
            shift = sum(math.dist(a, b) ** 2 for a, b in zip(at, target)) / 2
            over = [max(value - 1, 0) for value in lambdas(at, 0.2, 0.1, target)]
            return shift + 1e-6 * K / 1000 * sum(e * e / 2 for e in over)

        return of(target), of(x)

    def test_descent(self):
        """Psi of Eq. (7) after three iterations, over that of a converged step."""
        K = 1e6
        three = self.blocks("three", "fixed_iterations=3", f"K={K}")
        exact = self.blocks("exact", "tolerance=1e-9", "max_iterations=5000", f"K={K}")
        values, rows = self.program("descent", "functions", "--", three, exact)
        start, left = self.psi("three", K)
        _, least = self.psi("exact", K)
        self.assertLess(least, left)
        self.assertLess(left, start)
        expected = (left - least) / (start - least)
        self.assertAlmostEqual(values["left_three"] / expected, 1, 5)
        self.assertEqual(rows["three"][0], [0, 1, 1, 0])
        self.assertAlmostEqual(values["energy_B1"], (1.1 ** 3 - 1) / 3 - 0.1, 12)
        self.assertAlmostEqual(values["slope_B2"], 1.1 ** 3 - 1, 12)

    def test_density(self):
        run = self.blocks("density", "fixed_iterations=3", "K=1e6")
        _, rows = self.program("density", "--", run)
        expected = lambdas(self.frames("density")[-1]["position"], 0.2, 0.1)
        self.assertEqual(len(rows["density"]), 64)
        for row, value in zip(rows["density"], expected):
            self.assertAlmostEqual(row[2], value, 4)

    def test_column(self):
        """G^2 = 0.48 at R = 2 dx in 2-D; with K a load s sinks by 1 - 2 (s - log(1 + s))/s^2."""
        run = self.simulate("column", "column", "--solver", "sisph", "--t-end", 0.002, "--set",
                            "kernel=spiky", "--set", "support=2", "--set", "K=1e5")
        values, rows = self.program("column", "--", run)
        self.assertAlmostEqual(values["G2"], 0.48, 2)
        for K, plain, stiff, _ in rows["theory"]:
            for modulus, found in ((K, plain), (K * values["G2"], stiff)):
                s = 1000 * 9.81 * 0.4 / modulus
                if s > 1e-3:
                    self.assertAlmostEqual(found, 1 - 2 * (s - math.log1p(s)) / s ** 2, 4)
        # S = 2.33 chi at R = 2 dx, chi = K dt^2/(rho0 dx^2), of which ten iterations show phi
        S = 2.33 * 1e5 * 1e-6 / (1000 * 1e-4)
        s = 1000 * 9.81 * 0.4 / (1e5 * values["G2"] * (1 - (S / (1 + S)) ** 10))
        theory = 1 - 2 * (s - math.log1p(s)) / s ** 2
        self.assertAlmostEqual(values["theory_column"] / theory, 1, 2)

    def test_difference(self):
        """Two blocks in one place, of which one is half as fast again."""
        runs = [self.simulate(name, "free-fall", "--solver", "dual-sc", "--t-end", 0.001, "--set",
                              f"speed={speed}", "--set", "gravity=0")
                for name, speed in (("slow", 1), ("fast", 1.5))]
        values, _ = self.program("difference", "0.05", "--", *runs)
        self.assertEqual(values["velocity_slow"], 0)
        self.assertAlmostEqual(values["velocity_fast"], 0.5, 6)

    def test_nodes(self):
        run = self.simulate("nodes", "free-fall", "--solver", "dual-sc", "--t-end", 0.001, "--set",
                            "side=0.05", "--set", "jitter=0.3")
        values, rows = self.program("nodes", "0", "--", run)
        near = [(0, 0), (2, 0), (-2, 0), (0, 2), (0, -2)]
        near += [k for k in itertools.product((-1, 0, 1), repeat=2) if k != (0, 0)]
        places = [[math.floor(c / 0.01 + 0.5) for c in at[:2]]
                  for at in self.frames("nodes")[0]["position"]]
        expected = {(a + p, b + q) for a, b in places for p, q in near}
        found = {(round(x / 0.01), round(y / 0.01)) for x, y in rows["nodes-1-virtual"]}
        self.assertEqual(found, expected)
        self.assertAlmostEqual(values["nodes_per_particle"], len(expected) / 25)


if __name__ == "__main__":
    cli_case.main()
