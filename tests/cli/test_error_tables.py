#!/usr/bin/python3
"""tools/error-tables: what it says of planted points, whose verdicts are known."""
import json
import pathlib
import subprocess

import cli_case
from cli_case import Case

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools/error-tables"


def point(solver, error, time, iterations):
    return {"solver": solver, "valid": True, "error": error, "time": time, "steps": 10,
            "iterations": iterations, "density_error": 1e-3, "reason": None,
            "parameters": {"spacing": 0.1, "dt": 0.01, "tolerance_factor": 1}}


def row(target, times):
    """A line of the table, from [(solver, time)] with the cheapest first."""
    ranking = [{"solver": s, "point": 0, "error": target, "time": t, "time_low": t,
                "time_high": t, "slower_by": None} for s, t in times]
    return {"target": target, "cheapest": times[0][0] if times else None,
            "difference": "2 times" if len(times) > 1 else "no other gets there",
            "ranking": ranking}


class Claims(Case):
    def tables(self, helmholtz, dfsph, iterations):
        result = {
            "scene": "planted", "quick": True, "noise": {"floor": 1.1, "means": "planted"},
            "error": {"metric": "e", "kind": "total"},
            "origin": {"threads": 1, "date": "2026-01-01"},
            "points": [point("dual-sb", 0.1, 1, iterations), point("dual-sa", 0.1, 1, 20)],
            "table": [row(0.1, sorted([("helmholtz", helmholtz), ("dfsph", dfsph)],
                                      key=lambda pair: pair[1])),
                      row(0.03, [("dfsph", 2.0)]), row(0.01, [])],
            "density_table": {"spacing": 0.1, "table": []}, "refused": [], "fairness": [],
            "warm_start": {}}
        folder = self.dir / "results/precision/planted/total"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "precision.json").write_text(json.dumps(result))
        done = subprocess.run([TOOL, "--results", self.dir / "results"], text=True, check=True,
                              capture_output=True, cwd=self.dir)
        return done.stdout

    def verdict(self, text, where, against):
        lines = [line for line in text.splitlines()
                 if f"over {against}" in line and f"| {where} |" in line]
        self.assertEqual(len(lines), 1, text)
        return lines[0].split("|")[-2].strip()

    def test_verdicts_follow_the_numbers(self):
        for ours, expected in ((1.0, "**holds**"), (1.95, "**no difference**"),
                               (2.1, "**no difference**"), (4.0, "**does not hold**")):
            text = self.tables(ours, 2.0, 20)
            self.assertEqual(self.verdict(text, "planted, 10 %", "dfsph"), expected)
        self.assertEqual(self.verdict(text, "planted, 3 %", "dfsph"), "**does not hold**")
        self.assertNotIn("| planted, 1 % |", text)

    def test_iterations_at_equal_knobs(self):
        for ours, expected in ((10, "**holds**"), (20, "**no difference**"),
                               (30, "**does not hold**")):
            text = self.tables(1.0, 2.0, ours)
            self.assertEqual(self.verdict(text, "planted", "dual-sa"), expected)


if __name__ == "__main__":
    cli_case.main()
