#!/usr/bin/env python3
"""The CUDA variants against the OpenMP ones: every solver, a few steps, the same metrics.

    test_cuda.py VARIANTS [CHOICE...]     VARIANTS is build/bin/variants; a CHOICE is such as 2d-f64

Ends with 77 (skipped) where no CUDA variant is built or no GPU is there.
"""
import itertools
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

STEPS = 5
SKIPPED = 77
# Scene, spacing [m] and time step [s]: small, with walls and gravity, and without.
SCENES = {
    "2d": [("rotating-patch", 0.02, 1e-3), ("dam-break", 0.02, 1e-3)],
    "3d": [("dam-break", 0.05, 1e-3)],
}
# Relative to the scale of a metric. Pressures in f32 lose the digits that density errors lack.
TOLERANCE = {"f64": 1e-8, "f32": 1e-3}
PRESSURE_TOLERANCE = {"f64": 1e-8, "f32": 2e-2}
# Absolute: measured on a grid and in single precision, whatever the variant.
ROUGH = {"volume_change": 1e-5}


class Skipped(Exception):
    """There is nothing to compare with."""


class Broken(Exception):
    """A run ended with an error."""


def run(folder, backend, choice, scene, solver, environment=None):
    """What `sphbench run --json` says about STEPS steps."""
    name, spacing, dt = scene
    executable = folder / f"sphbench-{backend}-{choice}"
    if not executable.is_file():
        raise Skipped(f"{executable.name} is not built")
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch) / "run.json"
        arguments = [executable, "run", name, "--solver", solver, "--spacing", str(spacing),
                     "--dt", str(dt), "--t-end", str(STEPS * dt), "--quiet", "--json", file]
        if choice.endswith("f32"):  # rounding must not decide when to stop
            arguments += ["--set", "fixed_iterations=8"]
        done = subprocess.run(arguments, capture_output=True, text=True, check=False,
                              env=dict(os.environ, **(environment or {})))
        if done.returncode == SKIPPED:
            raise Skipped(done.stderr.strip())
        if done.returncode != 0:
            raise Broken(f"{backend}: exit code {done.returncode}: {done.stderr.strip()}")
        return json.loads(file.read_text())


def scales(result, scene, dim):
    """By unit, what a difference is compared with where a metric itself is near 0."""
    mass = result["parameters"]["rho0"] * scene[1] ** dim * result["particles"]
    series = result["series"]
    energy = max(abs(e) for key in ("kinetic_energy", "potential_energy") for e in series[key])
    momentum = math.sqrt(2 * mass * energy)
    return {"J": energy, "kg m/s": momentum, "kg m^2/s": momentum, "1": 1e-2}


def differences(twin, own, scene, choice):
    """What differs by more than the tolerances, as sentences."""
    dim, precision = int(choice[0]), choice[-3:]
    floors = scales(own, scene, dim)
    for key in ("steps", "particles", "walls", "status", "iterations"):
        if twin[key] != own[key]:
            yield f"{key}: {twin[key]} against {own[key]}"
    residuals = [r["residual"]["last"] for r in (twin, own)]
    if not near(*residuals, TOLERANCE[precision], 1e-2 if precision == "f32" else 1e-4):
        yield f"residual: {residuals[0]} against {residuals[1]}"
    for name, values in own["series"].items():
        unit = own["metrics"].get(name, {}).get("unit", "1")
        table = PRESSURE_TOLERANCE if "pressure" in name else TOLERANCE
        tolerance, floor = table[precision], floors.get(unit, 0)
        if name in ROUGH:
            tolerance, floor = max(tolerance, ROUGH[name]), 1
        pairs = itertools.zip_longest(twin["series"][name], values)
        for k, (a, b) in enumerate(pairs):
            if not near(a, b, tolerance, floor):
                yield f"{name}[{k}]: {a} against {b}"


def near(a, b, tolerance, floor):
    if a is None or b is None:
        return a is b
    return abs(a - b) <= tolerance * max(abs(a), abs(b), floor)


def compare(folder, choice, scene, solver):
    """What differs between the backends, and between two runs on the GPU."""
    twin = run(folder, "cuda", choice, scene, solver)
    own = run(folder, "openmp", choice, scene, solver)
    again = run(folder, "cuda", choice, scene, solver, {"SPHBENCH_REVERSED": "1"})
    found = list(differences(twin, own, scene, choice))
    for key in ("series", "iterations", "residual"):
        if again[key] != twin[key]:
            found.append(f"{key}: other bits with the threads in the reversed order")
    return found


def is_same(folder, choice, scene, solver):
    try:
        found = compare(folder, choice, scene, solver)
    except Broken as error:
        found = [str(error)]
    for sentence in found[:8]:
        print(f"{choice} {scene[0]} {solver}: {sentence}")
    return not found


def solvers_of(folder, choice):
    listing = subprocess.run([folder / f"sphbench-openmp-{choice}", "list", "solvers", "--json"],
                             capture_output=True, text=True, check=True)
    return [row["name"] for row in json.loads(listing.stdout)]


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        return 2
    folder, choices = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
    built = sorted(p.name.removeprefix("sphbench-cuda-") for p in folder.glob("sphbench-cuda-*"))
    failed = compared = 0
    try:
        if not built:
            raise Skipped("no CUDA variant is built")
        for choice in choices or built:
            for scene in SCENES[choice[:2]]:
                for solver in solvers_of(folder, choice):
                    failed += not is_same(folder, choice, scene, solver)
                    compared += 1
    except Skipped as reason:
        print(f"skipped: {reason}")
        return SKIPPED
    print(f"{compared} runs compared, {failed} differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
