"""The first step of the rotating square and of a dam break, by variational staggered SPH and on
stress points, against their exact pressures."""
import math
import unittest

import cli_case

OMEGA, SIDE = 2.0943951023931953, 0.24


def exact_pressure(x, y, numpy):
    """Of a square [-SIDE/2, SIDE/2]^2 turning at OMEGA with p = 0 around it: lap p = 2 rho0 OMEGA^2
    as a double sine series, rho0 = 1000 kg/m^3."""
    odd = numpy.arange(1, 400, 2)
    wave = odd * numpy.pi / SIDE
    sines = [numpy.sin(numpy.outer(a + SIDE / 2, wave)) for a in (x, y)]
    modes = -32 * 1000 * OMEGA**2 / numpy.pi**2 / numpy.outer(odd, odd)
    modes /= wave[:, None]**2 + wave[None, :]**2
    return numpy.einsum("im,mn,in->i", sines[0], modes, sines[1])


class FirstStep(cli_case.Case):
    def metric(self, scene, solver, name, *words):
        out, _ = self.call("run", scene, "--solver", solver, "--precision", "double", "--json", "-",
                           "--quiet", *words)
        return cli_case.read_json(out)["metrics"][name]["value"]

    def test_kept_lattice(self):
        """One projection on the lattice itself: order 0.91 to 0.96."""
        for dx, expected in zip((0.01, 0.005, 0.0025), (0.1533, 0.0814, 0.0419)):
            error = self.metric("first-step", "vssph", "pressure_error", "--spacing", dx)
            self.assertAlmostEqual(error / expected, 1, delta=0.01)

    def test_stress_points(self):
        """First order, wherever the stress points are."""
        for arrangement in ("pair", "corner", "edges"):
            errors = [self.metric("first-step", "stress-point", "pressure_error", "--spacing", dx,
                                  "--set", f"arrangement={arrangement}") for dx in (0.01, 0.005)]
            self.assertTrue(0.8 < math.log2(errors[0] / errors[1]) < 1.3, f"{arrangement} {errors}")
            self.assertLess(errors[1], 0.075, arrangement)

    def step_error(self, dx, dt):
        """Of one step from the rotating lattice, relative, over all particles."""
        import h5py
        import numpy
        self.call("run", "rotating-patch", "--solver", "vssph", "--spacing", dx, "--dt", dt,
                  "--t-end", dt, "--precision", "double", "--set", "xsph=0", "--frames", 1,
                  "--quiet", "-o", self.dir / "step.vtkhdf")
        with h5py.File(self.dir / "step.vtkhdf", "r") as file:
            n = int(file["VTKHDF/NumberOfPoints"][-1])
            x = file["VTKHDF/Points"][-n:]
            p = file["VTKHDF/PointData/pressure"][-n:]
        truth = exact_pressure(x[:, 0], x[:, 1], numpy)
        return float(numpy.sqrt(((p - truth)**2).sum() / (truth**2).sum()))

    def test_real_step(self):
        """Within 2 % of an independent prototype that moved the particles for dt = 1 ms first.

        That expands the lattice by (omega dt)^2/2 = 2e-6, which lowers every A_ii below A_max; the
        lift then takes 0.7 % off the pressure at the finest spacing. With a tenth of dt the errors
        are those of the kept lattice."""
        for dx, expected in zip((0.01, 0.005, 0.0025), (0.153, 0.080, 0.036)):
            self.assertAlmostEqual(self.step_error(dx, 1e-3) / expected, 1, delta=0.02)
        self.assertAlmostEqual(self.step_error(0.0025, 1e-4) / 0.0419, 1, delta=0.01)

    def test_walls(self):
        """Dam break at t = 0+ against the series: first order too."""
        words = "--dt", 1e-6, "--t-end", 1e-6, "--set", "tolerance=1e-7", "--spacing"
        for solver, least in (("vssph", 0.12), ("stress-point", 0.09)):
            errors = [self.metric("dam-break", solver, "pressure_error", *words, dx)
                      for dx in (0.02, 0.01)]
            self.assertLess(errors[0], least, solver)
            self.assertLess(errors[1], 0.56 * errors[0], solver)

    def test_free_fall(self):
        for solver in ("vssph", "stress-point"):
            error = self.metric("free-fall", solver, "trajectory_error", "--t-end", 0.05)
            self.assertLess(error, 1e-6, solver)


if __name__ == "__main__":
    cli_case.main()
