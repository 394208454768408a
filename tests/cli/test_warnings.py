"""What `run` says before it starts: where a user is likely to have slipped, and nowhere else."""
import re
import subprocess

import cli_case

SHORT = ("--spacing", "0.05", "--t-end", "1e-9", "--quiet")

# solver, what is typed, what the sentence must hold
SLIPS = (
    ("dfsph", ("--dt", "0.1", "--t-end", "0.1"), ("dt = 0.1 s", "a support")),
    ("pbf", ("--set", "gravity=2000", "--dt", "0.01"), ("dt = 0.01 s",)),
    ("pbf", ("--set", "viscosity=400", "--set", "viscosity_form=explicit", "--dt", "0.005"),
     ("explicit viscosity", "implicit")),
    ("pbf", ("--set", "tension=50000"), ("surface tension",)),
    ("pbf", ("--set", "xsph_rate=100"), ("XSPH", "at most 1")),
    ("pbf", ("--set", "epsilon=0", "--set", "support=3"), ("epsilon 0",)),
    ("dfsph", ("--set", "relaxation=1.2"), ("relaxation 1.2", "theta_max")),
    ("iisph", ("--set", "relaxation=1.2"), ("relaxation 1.2", "theta_max")),
    ("pcisph", ("--set", "relaxation=3"), ("relaxation 3", "theta_max")),
    ("wcsph", ("--set", "c=1"), ("c = 1 m/s",)),
    ("wcsph", ("--set", "cfl=2", "--dt", "0.1", "--t-end", "0.1"), ("cfl 2",)),
    ("wcsph", ("--set", "max_substeps=1", "--set", "c=1000"), ("max_substeps",)),
    ("dual-sc", ("--set", "kappa=3"), ("kappa 3",)),
    ("vssph", ("--set", "kappa=3"), ("kappa 3",)),
    ("helmholtz", ("--set", "kappa=3"), ("kappa 3",)),
    ("stress-point", ("--set", "kappa=3"), ("kappa 3",)),
    ("flip", ("--set", "kappa=3"), ("kappa 3",)),
    ("sisph", ("--set", "K=1e9"), ("S = ", "10 iterations", "K = 1e+09")),
    ("sisph", ("--set", "K=1e9", "--set", "beta=9"), ("beta 9", "diverge")),
    ("sisph", ("--set", "mu=1e6"), ("S = ", "10 iterations")),
    ("sisph", ("--set", "K=1e9", "--set", "acceleration=anderson"), ("S = ",)),
    ("sisph", ("--dt", "0.05", "--set", "gravity=1"), ("S = ", "so soft")),
)
# the same a little further from the edge
FINE = (
    ("dfsph", ("--dt", "0.03", "--t-end", "0.03")),
    ("pbf", ("--set", "viscosity=400", "--dt", "0.005")),
    ("pbf", ("--set", "viscosity=4", "--set", "viscosity_form=explicit", "--dt", "0.005")),
    ("dfsph", ("--set", "relaxation=0.7")),
    ("dfsph", ("--set", "relaxation=1.2", "--set", "clamp=each")),
    ("pcisph", ("--set", "relaxation=1.4")),
    ("wcsph", ("--set", "cfl=1.5", "--dt", "0.1")),
    ("sisph", ("--set", "K=1e9", "--set", "fixed_iterations=40000")),
    ("sisph", ("--set", "K=2e6", "--set", "acceleration=chebyshev")),
    ("dual-sc", ("--set", "kappa=1")),
)


class Warnings(cli_case.Case):
    def told(self, solver, *words):
        """(standard error, the clauses in the JSON) of a short run in the tank."""
        pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        with self.start("run", "tank", "--solver", solver, *SHORT, *words, "--json", "r.json",
                        **pipes) as process:
            err = process.communicate(timeout=cli_case.LONGEST)[1].decode()
        facts = cli_case.read_json((self.dir / "r.json").read_text())
        return err, facts["warnings"]

    def test_slips(self):
        for solver, words, parts in SLIPS:
            with self.subTest(solver=solver, words=words):
                err, clauses = self.told(solver, *words)
                first = err.splitlines(keepends=True)[0] if err else ""
                self.one_sentence(first, "warning: ", *parts)
                self.assertEqual(first, f"sphbench: warning: {'; '.join(clauses)}\n")

    def test_what_is_fine(self):
        for solver, words in FINE:
            with self.subTest(solver=solver, words=words):
                self.assertEqual(self.told(solver, *words), ("", []))

    def test_several_are_one_sentence(self):
        err, clauses = self.told("sisph", "--set", "K=1e9", "--set", "xsph_rate=100")
        self.assertEqual(len(clauses), 2)
        self.one_sentence(err, *clauses)

    def test_a_file_has_them_too(self):
        with self.start("run", "tank", "--solver", "pbf", *SHORT, "--set", "epsilon=0", "-o",
                        "r.vtkhdf", "--json", "r.json", stderr=subprocess.DEVNULL) as process:
            process.communicate(timeout=cli_case.LONGEST)
        facts, file = self.results()
        self.assertEqual([w.decode() for w in file["run/warnings"]], facts["warnings"])

    def test_no_scene_warns_by_itself(self):
        """All scenes with all solvers at their defaults; a dry run, which warns as well."""
        solvers = [row["name"] for row in self.asked("list", "solvers")]
        for scene in (row["name"] for row in self.asked("list", "scenes")):
            for solver in solvers:
                with self.start("run", scene, "--solver", solver, "--dry-run",
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
                    err = process.communicate(timeout=cli_case.LONGEST)[1].decode()
                self.assertNotRegex(err, "warning", (scene, solver))
                if process.returncode:
                    self.assertTrue(re.search("cannot|support", err), err)

    def test_a_dry_run_warns(self):
        out, err = self.start("run", "tank", "--solver", "pbf", *SHORT, "--set", "epsilon=0",
                              "--dry-run", stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE).communicate(timeout=cli_case.LONGEST)
        self.assertIn(b"epsilon", out)
        self.one_sentence(err.decode(), "epsilon 0")


if __name__ == "__main__":
    cli_case.main()
