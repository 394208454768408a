#!/usr/bin/python3
"""Scenes with exact answers, through the command line: errors that are small, fall with the spacing
and show what a method is known to do."""
import unittest

import cli_case


class Drops(cli_case.Case):
    def metrics(self, scene, solver, *words):
        out, _ = self.call("run", scene, "--solver", solver, "--json", "-", "--quiet", *words)
        facts = cli_case.read_json(out)
        return {name: entry["value"] for name, entry in facts["metrics"].items()}

    def test_elliptical_drop(self):
        """Semi-axes, paths and pressure at half of Monaghan's time, by two spacings."""
        words = "--t-end", 3.8e-3, "--set", "samples=20", "--spacing"
        coarse, fine = (self.metrics("elliptical-drop", "dual-sc", *words, dx)
                        for dx in (0.1, 0.05))
        for name, most in (("axes_error", 0.01), ("trajectory_error", 0.06),
                           ("velocity_error", 0.07), ("centre_pressure_error", 0.3)):
            self.assertLess(fine[name], most, name)
            self.assertLess(fine[name], 0.6 * coarse[name], name)

    def test_elliptical_drop_in_space(self):
        for stretch in "plane", "round":
            found = self.metrics("elliptical-drop", "dfsph", "--dim", 3, "--t-end", 2e-3,
                                 "--spacing", 0.2, "--set", f"stretch={stretch}")
            self.assertLess(found["trajectory_error"], 0.1)
            self.assertLess(found["axes_error"], 0.02)

    def test_period_of_the_oscillating_drop(self):
        """Methods that move first and last feel the same field."""
        for solver in "dfsph", "pbf", "dual-sc":
            found = self.metrics("oscillating-drop", solver, "--spacing", 0.1, "--dt", 0.01,
                                 "--t-end", 2.6)
            self.assertLess(found["period_error"], 0.05, solver)

    def test_tension(self):
        """A rotating disc: clamped pressure lets it fly apart, free pressure holds it."""
        words = "--spacing", 0.1, "--t-end", 1, "--dt", 0.01
        held = self.metrics("rotating-disc", "dual-sc", *words)
        flown = self.metrics("rotating-disc", "pbf", *words)
        self.assertLess(held["axes_error"], 0.05)
        self.assertAlmostEqual(flown["axes_error"], 2 ** 0.5 - 1, delta=0.01)  # straight on
        self.assertLess(flown["spin_error"], 1e-12)

    def test_two_particles(self):
        """Nothing acts on them where pressure cannot pull."""
        for solver in "pbf", "dfsph":
            found = self.metrics("two-particle", solver)
            self.assertLess(found["trajectory_error"], 1e-12, solver)
            self.assertLess(found["spin_error"], 1e-12, solver)
        self.assertGreater(self.metrics("two-particle", "dual-sc")["trajectory_error"], 0.1)

    def test_manufactured_projection(self):
        """First order with pressures on the particles; on nodes it depends on where those lie."""
        errors = [self.metrics("manufactured-projection", "dual-sa", "--spacing", dx)
                  for dx in (0.08, 0.04, 0.02)]
        for name, most in (("pressure_error", 0.06), ("velocity_error", 0.025)):
            for coarse, fine in zip(errors, errors[1:]):
                self.assertLess(fine[name], 0.6 * coarse[name], name)
            self.assertLess(errors[-1][name], most)

    def test_stiffness_of_the_column(self):
        """K of position-based iterations is proportional to their number."""
        few, many = (self.metrics("column", "pbf", "--spacing", 0.02, "--set",
                                  f"fixed_iterations={n}")["bulk_modulus"] for n in (2, 10))
        self.assertAlmostEqual(many / few, 5, delta=0.25)

    def test_waves(self):
        """Periods within 5 % of linear theory."""
        for scene, spacing in (("standing-wave", 0.08), ("sloshing", 0.05)):
            found = self.metrics(scene, "dfsph", "--spacing", spacing)
            self.assertLess(found["period_error"], 0.05, scene)

    def test_vortices(self):
        """Periodic squares are refused where they cannot be, and steady at the start elsewhere."""
        out, err = self.call("run", "taylor-green", "--solver", "dual-sc", code=2)
        self.assertEqual(out, "")
        self.one_sentence(err, "periodic")
        found = self.metrics("taylor-green", "dfsph", "--t-end", 0.04, "--set", "clamp=free",
                             "--spacing", 0.05)
        self.assertLess(found["velocity_error"], 0.02)
        found = self.metrics("gresho", "dual-sc", "--t-end", 0.1, "--spacing", 0.04)
        self.assertLess(found["velocity_error"], 0.1)

    def test_viscous_flows(self):
        """Plates and vortices. The viscosity of pairs on a lattice is a sixth short at R = 2.5 dx,
        which Couette's end state does not see."""
        for solver in "dfsph", "pbf":
            found = self.metrics("couette", solver, "--spacing", 5e-5)
            self.assertLess(found["velocity_error"], 0.08, solver)
        coarse, fine = (self.metrics("poiseuille", "pbf", "--spacing", dx)["velocity_error"]
                        for dx in (5e-5, 2.5e-5))
        self.assertLess(fine, 0.9 * coarse)
        found = self.metrics("taylor-green", "pbf", "--set", "reynolds=100", "--set", "jitter=0.1",
                             "--t-end", 0.2, "--spacing", 0.04)
        self.assertLess(found["velocity_error"], 0.2)


if __name__ == "__main__":
    cli_case.main()
