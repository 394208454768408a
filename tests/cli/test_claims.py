"""Claims are decided from the runs and values of drawn figures: here by hand-made ones."""
import json

import cli_case



class Claims(cli_case.Case):
    def figure(self, name, runs=(), values=None):
        """A drawn figure: runs are (label, facts)."""
        folder = self.dir / "results/figures" / name
        folder.mkdir(parents=True)
        (self.dir / "results/runs").mkdir(exist_ok=True)
        entries = []
        for k, (label, facts) in enumerate(runs):
            entries.append({"id": f"{name}-{k}", "label": label})
            (self.dir / f"results/runs/{name}-{k}.json").write_text(json.dumps(facts))
        (folder / "figure.json").write_text(json.dumps({"name": name, "runs": entries}))
        if values:
            (folder / "values.json").write_text(json.dumps(values))

    def decide(self, code):
        self.call("claims", "--results", "results", "--json", "out.json", code=code)
        claims = {claim["id"]: claim for claim in json.loads((self.dir / "out.json").read_text())}
        page = (self.dir / "results/claims.md").read_text()
        self.assertTrue(all(f"| {name} |" in page for name in claims))
        return claims

    def test_nothing_was_drawn(self):
        (self.dir / "results").mkdir()
        claims = self.decide(0)
        self.assertGreater(len(claims), 100)
        self.assertEqual({claim["verdict"] for claim in claims.values()}, {"cannot be decided"})

    def test_values(self):
        self.figure("dual-fig05", values={"unstable_one": 1.0, "unstable_dual": 0.6,
                                          "middle_one": 3.2, "middle_dual": -6.4,
                                          "stiffness_dual": None})
        claims = self.decide(1)
        self.assertEqual(claims["dual-kernel-always"]["verdict"], "holds")
        self.assertEqual(claims["dual-kernel-mostly"]["verdict"], "does not hold")
        self.assertAlmostEqual(claims["dual-kernel-middle"]["value"], -20.48, 12)
        self.assertEqual(claims["dual-kernel-all"]["verdict"], "cannot be decided")

    def test_runs(self):
        """S.C 1.5 times as dear as S.A; two runs that are alike cannot be told apart."""
        def facts(solver, xsph, per_step):
            return {"solver": solver, "status": "ok", "parameters": {"xsph": xsph},
                    "timing": {"per_step": per_step, "neighbours": 1}, "metrics": {}}
        runs = [("", facts("dual-sc", 0, 0.3)), ("", facts("dual-sa", 0, 0.2)),
                ("viscous", facts("dual-sc", 0.02, 9)), ("viscous", facts("dual-sa", 0.02, 7)),
                ("", facts("pbf", 0, 0.1)), ("", facts("pbf", 0, 0.2))]
        self.figure("dual-table1", runs)
        claims = self.decide(0)
        self.assertAlmostEqual(claims["dual-cost-most"]["value"], 1.5, 12)
        self.assertEqual(claims["dual-cost-most"]["verdict"], "holds")
        self.assertIn("2 runs with [solver=pbf", claims["dual-cost-sc-pbf"]["cause"])
        self.assertIn("0 runs with [solver=vssph", claims["dual-cost-sc-vssph"]["cause"])


if __name__ == "__main__":
    cli_case.main()
