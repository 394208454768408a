#!/usr/bin/env python3
"""Writes small result files, seeds of the fuzzer of their reader: `seed_result.py FOLDER`."""
import pathlib
import sys

import h5py
import numpy

PARTICLES, FRAMES = 3, 2


def write(path, **more):
    with h5py.File(path, "w", track_order=False, **more) as file:
        vtk = file.create_group("VTKHDF")
        vtk["Points"] = numpy.arange(PARTICLES * FRAMES * 3, dtype="f8").reshape(-1, 3)
        vtk["NumberOfPoints"] = numpy.full(FRAMES, PARTICLES, dtype="i8")
        vtk["PointData/velocity"] = numpy.ones((PARTICLES * FRAMES, 3), dtype="f4")
        vtk["PointData/pressure"] = numpy.zeros(PARTICLES * FRAMES)
        steps = vtk.create_group("Steps")
        steps.attrs.create("NSteps", FRAMES, dtype="i8")
        steps["Values"] = numpy.array([0, 0.01])
        steps["PointOffsets"] = numpy.array([0, PARTICLES], dtype="i8")
        run = file.create_group("run")
        text = h5py.string_dtype()
        run.attrs.create("scene", "seed", dtype=text)
        run.attrs.create("status", "ok", dtype=text)
        run["steps"] = numpy.int64(4)
        run.create_dataset("parameters/kernel", data="wendland", dtype=text)
        run["parameters/dt"] = 0.0025
        rows = numpy.linspace(0, 1, 300)
        file.create_dataset("metrics/time", data=rows, chunks=(100,), compression=1, shuffle=True)
        file["metrics/final/gamma_mean"] = 0.97
        file["walls/position"] = numpy.zeros((2, 3))


folder = pathlib.Path(sys.argv[1])
write(folder / "earliest", libver="earliest")
write(folder / "latest", libver="latest")
