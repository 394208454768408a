#!/usr/bin/python3
"""Check that tools/h5same sees every difference but those that it is told to ignore.

    check_h5same.py H5SAME PROGRAM     PROGRAM [FILE [elsewhere]] writes a sample (test_result_file)
"""
import os
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

NAN = "metrics/final/pressure_error"  # of the sample: NaN


def put(path, index, value):
    def change(file):
        file[path][index] = value
    return change


def nan_of_other_bits(file):
    bits = numpy.array([file[NAN][()]]).view("u8") ^ 1
    file[NAN][()] = bits.view("f8")[0]


def retype(file):
    values = file["metrics/time"][()]
    del file["metrics/time"]
    file["metrics/time"] = values.astype("f4")


def rename(file):
    file["run"].move("parameters/dt", "parameters/dtt")


def attribute(path, name, value):
    def change(file):
        file[path].attrs[name] = value
    return change


# What is done to a copy, and the words that the answer must hold; None: it must be the same.
CASES = (
    ("nothing", lambda file: None, None),
    ("a date", attribute("run/volatile", "date", "1970-01-01T00:00:00Z"), None),
    ("the time spent", put("run/volatile/timing/solver", (), 99.0), None),
    ("one more volatile number", lambda file: file["run/volatile"].create_dataset("new", data=1),
     None),
    ("a position", put("VTKHDF/Points", (3, 1), 7.5), "/VTKHDF/Points: 1 of 45 differ"),
    ("the sign of zero", put("VTKHDF/Points", (3, 2), -0.0), "first at [3, 2]: 0.0 and -0.0"),
    ("a label", put("VTKHDF/PointData/id", 0, 17), "/VTKHDF/PointData/id"),
    ("a number for NaN", put(NAN, (), 1.0), NAN),
    ("another NaN", nan_of_other_bits, NAN),
    ("a word", put("run/parameters/kernel", (), "spiky"), "/run/parameters/kernel"),
    ("a unit", attribute("metrics/time", "unit", "ms"), "/metrics/time@unit"),
    ("a status", attribute("run", "status", "diverged"), "/run@status"),
    ("a new attribute", attribute("run", "new", 1), "'new' is only in B"),
    ("a type", retype, "float64[20] and float32[20]"),
    ("a name", rename, "'dt' is only in A"),
    ("a length", lambda file: file["metrics/time"].resize((19,)), "[20]"),
)


def verdict(tool, *files):
    done = subprocess.run([tool, *files], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def main(tool, program):
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        sample, elsewhere = (os.path.join(folder, name) for name in ("a.vtkhdf", "b.vtkhdf"))
        subprocess.run([program, sample], check=True)
        subprocess.run([program, elsewhere, "elsewhere"], check=True)
        code, answer = verdict(tool, sample, elsewhere)
        if code or answer:
            wrong.append(f"the same run on another machine: exit code {code}, {answer!r}")
        copy, text = os.path.join(folder, "copy.vtkhdf"), os.path.join(folder, "text")
        for about, change, words in CASES:
            shutil.copyfile(sample, copy)
            with h5py.File(copy, "r+") as file:
                change(file)
            code, answer = verdict(tool, sample, copy)
            if code != (1 if words else 0) or (words or "") not in answer:
                wrong.append(f"{about}: exit code {code}, {answer!r}")
        with open(text, "w", encoding="ascii") as file:
            file.write("no result\n")
        for other in (text, os.path.join(folder, "missing")):
            code, answer = verdict(tool, sample, other)
            if code != 2 or other not in answer or "Traceback" in answer:
                wrong.append(f"{other}: exit code {code}, {answer!r}")
    for line in wrong:
        print(line)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
