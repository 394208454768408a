"""Scenes made of more than one fluid at rest, as their files say it: bodies that float, fluids in
layers, fluid that flows in, walls of one layer, and what is refused."""
import os
import statistics
import unittest

import cli_case

TANK = """
dim: 2
params: {{spacing: 0.02, dt: 0.001, t_end: {t_end}{more}}}
domain: {{low: [-0.1, -0.1], high: [1.1, 1.5]}}
fluid:
  - box: {{low: [0, 0], high: [1, 0.4]}}
{fluid}
walls:
  - box: {{low: [0, 0], high: [1, 0.8], open_top: true}}
{parts}
"""


class Parts(cli_case.Case):
    def scene(self, t_end, parts="", fluid="", more=""):
        path = os.path.join(self.dir, "scene.yaml")
        with open(path, "w") as file:
            file.write(TANK.format(t_end=t_end, parts=parts, fluid=fluid, more=more))
        return path

    def run_scene(self, path, solver, *words):
        out, _ = self.call("run", path, "--solver", solver, "--json", "-", "--quiet", *words)
        facts = cli_case.read_json(out)
        self.assertEqual(facts["status"], "ok", facts["reason"])
        return facts

    def test_a_square_of_half_the_density_floats_half_immersed(self):
        """By symmetry, however it is turned; the surface is at 0.4 + 0.5 * 0.2^2 / 1 = 0.42 m."""
        import h5py
        path = self.scene(2.5, "bodies:\n  - box: {low: [0.4, 0.42], high: [0.6, 0.62]}\n"
                               "    density: 500\n")
        file = os.path.join(self.dir, "out.vtkhdf")
        self.run_scene(path, "dfsph", "-o", file)
        with h5py.File(file) as data:
            height = data["VTKHDF/FieldData/body1_y"][:]
            where = data["VTKHDF/FieldData/body1_x"][:]
        self.assertAlmostEqual(height[0], 0.52, delta=1e-6)
        self.assertAlmostEqual(statistics.mean(height[-20:]), 0.42, delta=0.02)
        self.assertTrue(0.2 < where[-1] < 0.8)

    def test_layers_of_oil_on_water_stay(self):
        """Oil (500 kg/m^3) over water: next to nothing moves."""
        path = self.scene(0.3, fluid="  - box: {low: [0, 0.4], high: [1, 0.6]}\n    rho0: 500\n")
        facts = self.run_scene(path, "dfsph")
        energy = facts["metrics"]["kinetic_energy"]["value"]
        mass = 400 + 100
        self.assertLess((2 * energy / mass) ** 0.5, 0.1)
        self.assertEqual(facts["metrics"]["particles_lost"]["value"], 0)

    def test_fluid_flows_in(self):
        """0.1 m at 1 m/s for 0.2 s: 5 x 11 particles, the first layer at once."""
        path = self.scene(0.3, "emitters:\n  - {centre: [0.1, 0.6], direction: [1, 0], width: 0.1,"
                               " speed: 1, end: 0.2}\n")
        for solver in ("dfsph", "pbf", "dual-sc"):
            facts = self.run_scene(path, solver)
            self.assertEqual(facts["particles"], 1000 + 5 * 11, solver)

    def test_one_layer_of_weighted_walls_holds_water(self):
        """At the usual support of 2 dx. At 2.5 dx it does not hold (204 of 1000 particles lost in
        0.3 s). Without the factor gamma on its weights there would be 98 J at 0.3 s."""
        facts = self.run_scene(self.scene(0.3, more=", walls: akinci, support: 2"), "dfsph")
        self.assertEqual(facts["walls"], 50 + 2 + 2 * 40)
        self.assertEqual(facts["metrics"]["particles_lost"]["value"], 0)
        self.assertLess(facts["metrics"]["kinetic_energy"]["value"], 5)

    def test_what_is_not_asked_is_not_there(self):
        out, _ = self.call("run", self.scene(0.01), "--solver", "dfsph", "--explain", "--quiet")
        left = next(line for line in out.splitlines() if line.startswith("fields left out"))
        for field in ("light", "fluid", "body", "arm"):
            self.assertIn(f" {field}", left)

    def test_refusals(self):
        bad = (("bodies:\n  - disc: {centre: [0.5, 0.6], radius: 0.05}\n    density: -1\n",
                "bodies[1].density is -1, allowed is more than 0"),
               ("bodies:\n  - disc: {centre: [0.5, 0.6], radius: 0.05}\n    density: 5\n"
                "    motion: {period: 1}\n", "bodies[1].motion.period is given"),
               ("emitters:\n  - {centre: [0.1, 0.6], direction: [0, 0], width: 0.1, speed: 1}\n",
                "an emitter has no direction"),
               ("emitters:\n  - {centre: [0.1, 0.6], direction: [1, 0], width: 0.1, speed: 0}\n",
                "emitters[1].speed is 0, allowed is more than 0"))
        for parts, sentence in bad:
            _, said = self.call("run", self.scene(0.1, parts), "--solver", "dfsph", code=2)
            self.assertIn(sentence, said)
            self.assertIn("scene.yaml:", said)


if __name__ == "__main__":
    cli_case.main()
