#!/usr/bin/python3
"""Error over iterations: against what an analysis of the stored series gives, and against the
curves in results/curves, so that a solver whose iterations got worse is seen."""
import csv
import math
import pathlib
import shutil

import cli_case
from cli_case import Case, read_json

STORED = pathlib.Path(__file__).resolve().parents[2] / "results/curves/dam-break.json"
SOLVERS = "dual-sa,iisph,sisph,vssph"  # conjugate gradients, Jacobi, fixed point, collocation
SURE = 1e-8


def slope(curve):
    """Mean factor of an iteration, by plain least squares."""
    pairs = [(k, math.log(e)) for k, e in zip(curve["iterations"], curve["velocity_error"])
             if e > SURE]
    mean_k = sum(k for k, _ in pairs) / len(pairs)
    mean_e = sum(e for _, e in pairs) / len(pairs)
    return math.exp(sum((k - mean_k) * (e - mean_e) for k, e in pairs) /
                    sum((k - mean_k) ** 2 for k, _ in pairs))


def worse(new, old):
    """What of a curve got worse than it was, in words."""
    if new["reason"]:
        return [new["reason"]]
    found = []
    if new["rate"] > old["rate"] + 0.005:
        found.append(f"rate {new['rate']:.4f}, it was {old['rate']:.4f}")
    for name in ("velocity_error", "pressure_error"):
        if new[name][-1] > 1.05 * old[name][-1] + SURE:
            found.append(f"{name} {new[name][-1]:.3g}, it was {old[name][-1]:.3g}")
    return found


class Curves(Case):
    """One step of the dam break."""

    def curves(self, solvers, *words):
        self.call("convergence", "dam-break", "--over", "iterations", "--solvers", solvers,
                  "--spacing", "0.05", "--quiet", "--json", "c.json", *words)
        result = read_json((self.dir / "c.json").read_text())
        return {curve["solver"]: curve for curve in result["curves"]}

    def test_no_curve_got_worse(self):
        stored = {c["solver"]: c for c in read_json(STORED.read_text())["curves"]}
        for name, curve in self.curves(SOLVERS).items():
            self.assertEqual(curve["iterations"], stored[name]["iterations"])
            self.assertEqual(worse(curve, stored[name]), [], name)
            self.assertAlmostEqual(curve["rate"], slope(curve), delta=1e-9)
            self.assertLess(curve["rate_low"], curve["rate"])
            self.assertLess(curve["rate"], curve["rate_high"])
            self.assertLess(curve["velocity_error"][-1], 0.1 * curve["velocity_error"][0])
            for row in curve["reached"]:
                below = [k for k, e in zip(curve["iterations"], curve["velocity_error"])
                         if e <= row["error"]]
                self.assertEqual(row["iterations"], below[0] if below else None)
        with open(self.dir / "results/convergence/dam-break/iterations/iterations.csv",
                  encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["solver"] == "iisph"]
        self.assertEqual([int(row["iterations"]) for row in rows], stored["iisph"]["iterations"])

    def test_half_the_relaxation_is_seen(self):
        stored = {c["solver"]: c for c in read_json(STORED.read_text())["curves"]}
        usual = self.curves("iisph", "--iterations", "1")["iisph"]
        self.assertEqual(usual["no_rate"][:8], "an order")  # one number has no rate
        planted = self.curves("iisph", "--set", "relaxation=0.25")["iisph"]
        self.assertEqual(len(worse(planted, stored["iisph"])), 3)

    def test_what_has_no_curve(self):
        curves = self.curves("wcsph,pbf", "--iterations", "1,2,4")
        self.assertIn("not iterative", curves["wcsph"]["reason"])
        self.assertEqual(curves["wcsph"]["iterations"], [])
        self.assertIsNone(curves["pbf"]["reason"])
        words = ("convergence", "dam-break", "--over", "iterations", "--quiet")
        self.call(*words, "--solvers", "wcsph", code=3)
        for wrong in (("--iterations", "1,1.5"), ("--iterations", "2,2"), ("--spacings", "0.1")):
            _, err = self.call(*words, *wrong, code=2)
            self.one_sentence(err, wrong[0])


if __name__ == "__main__":
    if not shutil.which("gnuplot"):
        print("skipped: gnuplot is missing")
        raise SystemExit(77)
    cli_case.main()
