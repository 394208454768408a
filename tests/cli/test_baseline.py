"""The quick plan over every solver, against results/baselines/quick.json.

A change that is meant is blessed: sphbench bless RESULTS BASELINE.json --reason TEXT."""
import pathlib
import unittest

import cli_case

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Baseline(cli_case.Case):
    def test_quick_plan(self):
        self.call("sweep", "quick", "--results", "r", "--quiet")
        self.call("compare", "r", ROOT / "results" / "baselines" / "quick.json")


if __name__ == "__main__":
    cli_case.main()
