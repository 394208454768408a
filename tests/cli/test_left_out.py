#!/usr/bin/python3
"""What a scene does not need is neither allocated, nor computed, nor written."""
import re

import cli_case
from cli_case import Case

ALWAYS = {"x", "v", "id"}
SECOND_SET = {"VI", "wet", "source", "diag", "pI", "r", "d", "q"}
DUAL = ALWAYS | SECOND_SET | {"m", "rho", "V", "p"}
# The fields of a solver in a scene without walls, gravity and viscosity; a solver that is not here
# is held to the rules alone.
OWN = {
    "dual-sa": DUAL,
    "dual-sb": DUAL | {"X", "excess", "lambda", "shift"},
    "dual-sc": DUAL | {"X"},
    "pbf": ALWAYS | {"m", "rho", "p", "lambda", "shift"},
    "dfsph": ALWAYS | {"m", "rho", "p", "excess", "factor", "push", "push_v", "change"},
}
OF_WALLS = {"dual-sa": {"normal", "hold"}, "dual-sb": {"normal", "hold"},
            "dual-sc": {"normal", "hold"}, "pbf": set(), "dfsph": set()}
OF_XSPH = {"rho", "m", "V", "dv"}
PUBLIC = {"x", "v", "m", "id", "rho", "V", "p", "dv", "normal", "light", "fluid", "mu", "body",
          "arm", "mu_dir", "mu_op", "mu_diag", "slant", "colour"}

WALL_STAGES = {"dual-sa": {"hold_off_walls", "add_hold"}, "dual-sb": {"hold_off_walls", "add_hold"},
               "dual-sc": {"hold_off_walls", "add_hold"}, "pbf": set(), "dfsph": set()}
GRAVITY_STAGES = {"fall"}
XSPH_STAGES = {"density", "volume", "xsph", "add_change"}
PERIODIC_STAGES = {"wrap"}

FEATURES = {"WALLS", "GRAVITY", "XSPH", "PERIODIC", "VISCOSITY", "TENSION", "FLUIDS",
            "MOVING_WALLS", "BODIES", "EMITTERS"}

PATCH = ("rotating-patch", "--spacing", "0.02")
DAM = ("dam-break", "--spacing", "0.05")


class LeftOut(Case):
    def look(self, solver, *words):
        """(fields, stages, the words of --explain, facts, result file) of a run of two steps."""
        words = ("run", *words, "--solver", solver, "--t-end", "0.002", "-o", "r.vtkhdf", "--json",
                 "r.json", "--quiet")
        out, _ = self.call(*words, "--explain")
        facts, file = self.results()
        rows = facts["memory"]["fields"]
        fields = {row["name"] for row in rows}
        self.assertEqual(len(rows), len(fields), "a field twice")
        self.assertEqual(fields, set(file["run/memory/fields"]))
        told = re.search(r"(?s)fields allocated[^\n]*\n(.*?)fields left out: ([^\n]*)\n", out)
        self.assertEqual(fields, set(re.findall(r"(?m)^  (\w+) ", told[1])))
        left = set() if told[2] == "none" else set(told[2].split())
        self.assertEqual(fields & left, set())
        private = {row["name"] for row in self.asked("show", solver)["fields"]}
        self.assertEqual(fields | left, PUBLIC | private)
        stages = set(re.findall(r"(?m)^  (\w+)", out[out.index("stages run"):]))
        self.assertGreater(len(stages), 3)
        return fields, stages, out, facts, file

    def present(self, out):
        """The features that are not in the line that names the absent ones."""
        absent = set(re.search(r"(?m)^features absent: (.*)$", out)[1].split())
        self.assertLessEqual(absent, FEATURES)
        return FEATURES - absent

    def solvers(self):
        for row in self.asked("list", "solvers"):
            with self.subTest(solver=row["name"]):
                yield row["name"]

    def test_patch(self):
        """No walls, no gravity, and viscosity only where it is asked for."""
        for solver in self.solvers():
            shown = {row["name"]: row["where"] for row in self.asked("show", solver)["fields"]}
            plain, stages, out, _, file = self.look(solver, *PATCH, "--set", "xsph=0")
            self.assertEqual({name for name in plain if shown.get(name) == "walls"}, set())
            self.assertNotIn("normal", plain)
            self.assertNotIn("dv", plain)
            self.assertEqual(self.present(out), set())
            self.assertEqual(stages & (GRAVITY_STAGES | PERIODIC_STAGES), set())
            self.assertEqual(stages & {"xsph", "add_change"}, set())
            self.assertEqual(stages & WALL_STAGES.get(solver, set()), set())
            self.assertNotIn("walls", file)
            self.assertEqual(set(file["VTKHDF/PointData"]), {"velocity", "pressure", "id"})
            if solver in OWN:
                self.assertEqual(plain, OWN[solver])
            file.close()
            viscous, more, out, _, file = self.look(solver, *PATCH)  # 0.03 by default
            self.assertEqual(viscous, plain | OF_XSPH)
            self.assertLessEqual({"xsph", "add_change"}, more)
            self.assertLessEqual(more - stages, XSPH_STAGES)
            self.assertEqual(self.present(out), {"XSPH"})
            file.close()

    def test_dam_break(self):
        for solver in self.solvers():
            shown = {row["name"]: row["where"] for row in self.asked("show", solver)["fields"]}
            patch, patch_stages, *_, file = self.look(solver, *PATCH)
            file.close()
            dam, stages, out, facts, file = self.look(solver, *DAM)
            walls = {name for name in dam if shown.get(name) == "walls" or name == "normal"}
            self.assertEqual(dam - patch, walls)
            self.assertEqual(patch - dam, set())
            self.assertEqual(self.present(out), {"WALLS", "GRAVITY", "XSPH"})
            self.assertEqual(file["walls/position"].shape, (facts["walls"], 3))
            self.assertEqual(stages & PERIODIC_STAGES, set())
            if solver in OF_WALLS:
                self.assertEqual(walls, OF_WALLS[solver])
                self.assertLessEqual(stages - patch_stages, WALL_STAGES[solver] | GRAVITY_STAGES)
                self.assertLessEqual(WALL_STAGES[solver], stages)
            file.close()

    def test_gravity_switched_off(self):
        for solver in self.solvers():
            _, stages, out, _, file = self.look(solver, *DAM, "--set", "gravity=0")
            self.assertEqual(stages & GRAVITY_STAGES, set())
            self.assertEqual(self.present(out), {"WALLS", "XSPH"})
            file.close()

    def test_second_set(self):
        """Fields of a second set of particles are of those methods that have one."""
        for row in self.asked("list", "solvers"):
            virtual = {field["name"] for field in self.asked("show", row["name"])["fields"]
                       if field["where"] == "virtual"}
            if row["name"] in OWN:
                with_nodes = {"X"} if row["name"] in ("dual-sb", "dual-sc") else set()
                copies = {"excess"} if row["name"] == "dual-sb" else set()
                wanted = SECOND_SET | {"lift"} | with_nodes | copies
                self.assertEqual(virtual, wanted if row["name"].startswith("dual") else set())

    def test_parameters(self):
        """A field that only one choice of a parameter needs."""
        for solver in ("dual-sa", "dual-sb", "dual-sc"):
            plain, *_, file = self.look(solver, *PATCH)
            file.close()
            adjoint, *_, file = self.look(solver, *PATCH, "--set", "gradient=adjoint")
            file.close()
            self.assertEqual(adjoint - plain, {"lift"})

    def test_dimension_and_precision(self):
        """A 2-D scene carries no z, and a float is half a double."""
        for dim, precision, real in ((2, "double", 8), (2, "float", 4), (3, "double", 8),
                                     (3, "float", 4)):
            *_, facts, file = self.look("dfsph", *DAM, "--dim", dim, "--precision", precision,
                                        "--spacing", "0.1")
            bytes_of = {row["name"]: row["bytes_per_particle"] for row in facts["memory"]["fields"]}
            n, all_ = facts["particles"], facts["particles"] + facts["walls"]
            self.assertAlmostEqual(bytes_of["x"], dim * real * (all_ + 1) / n)
            self.assertAlmostEqual(bytes_of["rho"], real * (n + 1) / n)
            self.assertGreater(facts["memory"]["bytes_per_particle"], sum(bytes_of.values()))
            file.close()


if __name__ == "__main__":
    cli_case.main()
