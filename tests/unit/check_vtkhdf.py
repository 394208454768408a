#!/usr/bin/python3
"""Check that a file is what readers of VTKHDF 2.0 want, and what its own readers are promised.

    check_vtkhdf.py FILE            the structure, with h5py
    check_vtkhdf.py --vtk FILE      read by VTK itself; 77 (skipped) where VTK is older than 9.3
    check_vtkhdf.py --self-test FILE    plant faults in copies of FILE and see each one found

The rules: the VTKHDF recipe for temporal PolyData with one vertex per particle, whose number may
change from step to step. Prints one line per violation; exit code 1 if there is one.
"""
import os
import shutil
import sys
import tempfile

import h5py
import numpy

CELLS = ("Vertices", "Lines", "Polygons", "Strips")
STATUS = ("running", "complete", "diverged", "crashed", "timeout", "interrupted")


class Check:
    """Collects what is wrong."""

    def __init__(self):
        self.wrong = []

    def __call__(self, holds, text):
        if not holds:
            self.wrong.append(text)
        return holds


def numbers(check, group, path, kind, shape):
    """The values of a dataset, checked for its type and shape; None where it is missing."""
    if not check(path in group, f"{group.name}/{path} is missing"):
        return None
    data = group[path]
    check(data.dtype == kind, f"{data.name} is {data.dtype}, not {kind}")
    check(data.shape == shape, f"{data.name} has shape {data.shape}, not {shape}")
    return data[()] if data.shape == shape else None


def equal(check, group, path, wanted):
    """A list of 64-bit integers with these values."""
    wanted = numpy.asarray(wanted, dtype="<i8")
    found = numbers(check, group, path, "<i8", wanted.shape)
    if found is not None:
        check((found == wanted).all(), f"{group.name}/{path} has wrong values")


def check_header(check, root):
    """Version and Type, in the one form that VTK accepts."""
    version = root.attrs.get("Version")
    check(version is not None and list(version) == [2, 0] and version.dtype == "<i8",
          f"Version is {version}")
    if check("Type" in root.attrs, "Type is missing"):
        kind = h5py.h5a.open(root.id, b"Type").get_type()
        check(isinstance(kind, h5py.h5t.TypeStringID) and not kind.is_variable_str(),
              "Type has no fixed length")
        check(kind.get_cset() == h5py.h5t.CSET_ASCII, "Type is not ASCII")
        check(kind.get_strpad() == h5py.h5t.STR_NULLPAD, "Type is not padded with zeros")
        check(root.attrs["Type"] == b"PolyData", f"Type is {root.attrs['Type']}")


def check_topology(check, root, counts):
    steps, most = len(counts), max(counts, default=0)
    equal(check, root, "Vertices/Connectivity", numpy.arange(most))
    offsets = [numpy.arange(n + 1) for n in counts]
    equal(check, root, "Vertices/Offsets", numpy.concatenate(offsets))
    for what in ("NumberOfCells", "NumberOfConnectivityIds"):
        equal(check, root, f"Vertices/{what}", counts)
        for cells in CELLS[1:]:
            equal(check, root, f"{cells}/{what}", [0] * steps)
    for cells in CELLS[1:]:
        equal(check, root, f"{cells}/Offsets", [0] * steps)
        if f"{cells}/Connectivity" in root:
            equal(check, root, f"{cells}/Connectivity", [])
        else:
            check(False, f"{cells}/Connectivity is missing")


def check_steps(check, root, counts):
    total = len(counts)
    first = numpy.concatenate([[0], numpy.cumsum(counts)])[:total]
    steps = root["Steps"]
    count = steps.attrs.get("NSteps")
    check(count is not None and numpy.shape(count) == () and count == total, f"NSteps is {count}")
    times = numbers(check, steps, "Values", "<f8", (total,))
    check(times is None or (numpy.diff(times) >= 0).all(), "Steps/Values go back in time")
    equal(check, steps, "PartOffsets", range(total))
    equal(check, steps, "NumberOfParts", [1] * total)
    equal(check, steps, "PointOffsets", first)
    equal(check, steps, "CellOffsets", [[start, 0, 0, 0] for start in first])
    equal(check, steps, "ConnectivityIdOffsets", [[0] * 4] * total)
    for name in root["PointData"]:
        equal(check, steps, f"PointDataOffsets/{name}", first)
    for name in root["FieldData"]:
        equal(check, steps, f"FieldDataOffsets/{name}", range(total))


def check_arrays(check, root, counts):
    total = sum(counts)
    points = root.get("Points")
    if check(points is not None, "Points are missing"):
        check(points.shape == (total, 3), f"Points have shape {points.shape}")
        check(points.dtype in ("<f4", "<f8"), f"Points are {points.dtype}")
    for data in root["PointData"].values():
        check(data.shape in ((total,), (total, 3)), f"{data.name} has shape {data.shape}")
    for data in root["FieldData"].values():
        check(data.shape == (len(counts),) and data.dtype == "<f8", f"{data.name} is no f64 [T]")


def check_links(check, file):
    """/particles holds the arrays of /VTKHDF under plain names, without a copy."""
    root, fluid = file["VTKHDF"], file["particles/fluid"]
    pairs = {"position": "Points", "time": "Steps/Values"}
    pairs.update({name: f"PointData/{name}" for name in root["PointData"]})
    for name, target in pairs.items():
        check(name in fluid and fluid[name] == root[target],
              f"/particles/fluid/{name} is not /VTKHDF/{target}")


def check_labels(check, file):
    """Every dataset tells its unit and its meaning."""

    def label(name, item):
        if isinstance(item, h5py.Dataset):
            for key in ("unit", "description"):
                text = item.attrs.get(key)
                check(isinstance(text, str) and text.strip(), f"/{name} has no {key}")

    file.visititems(label)


def check_run(check, file):
    run = file["run"]
    for key in ("scene", "solver", "variant", "status"):
        check(isinstance(run.attrs.get(key), str), f"/run has no {key}")
    check(run.attrs.get("status") in STATUS, f"/run@status is {run.attrs.get('status')}")
    for key in ("commit", "dirty", "compiler", "flags"):
        check(key in run["provenance"].attrs, f"/run/provenance has no {key}")
    check("parameters" in run and len(run["parameters"]) > 0, "/run/parameters is empty")
    lengths = {len(data) for data in file.get("metrics", {}).values()
               if isinstance(data, h5py.Dataset)}
    check(len(lengths) <= 1, f"the series of /metrics have lengths {sorted(lengths)}")


def structure(name):
    """What is wrong with the file."""
    check = Check()
    with h5py.File(name, "r") as file:
        root = file["VTKHDF"]
        counts = [int(n) for n in root["NumberOfPoints"][()]]
        check(root["NumberOfPoints"].dtype == "<i8", "NumberOfPoints is not i64")
        check_header(check, root)
        for rule in (check_topology, check_steps, check_arrays):
            rule(check, root, counts)
        for rule in (check_links, check_labels, check_run):
            rule(check, file)
    return check.wrong


def by_vtk(name):
    """What VTK reads differently from h5py; None where VTK cannot read such files."""
    from vtkmodules.vtkCommonCore import vtkVersion
    version = vtkVersion()
    if (version.GetVTKMajorVersion(), version.GetVTKMinorVersion()) < (9, 3):
        print(f"skipped: VTK {version.GetVTKVersion()} is older than 9.3")
        return None
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader
    check = Check()
    reader = vtkHDFReader()
    reader.SetFileName(name)
    check(reader.CanReadFile(name), "VTK says that it cannot read the file")
    reader.UpdateInformation()
    with h5py.File(name, "r") as file:
        root = file["VTKHDF"]
        counts, first = root["NumberOfPoints"][()], root["Steps/PointOffsets"][()]
        steps = reader.GetNumberOfSteps()
        check(steps == len(counts), f"VTK sees {steps} steps")
        for step, (n, start) in enumerate(zip(counts, first)):
            reader.SetStep(step)
            reader.Update()
            data = reader.GetOutput()
            check(data.GetNumberOfPoints() == n, f"step {step}: {data.GetNumberOfPoints()} points")
            check(data.GetNumberOfCells() == n, f"step {step}: {data.GetNumberOfCells()} cells")
            check(data.CheckAttributes() == 0, f"step {step}: attributes do not fit")
            check(one_vertex_each(data.GetVerts(), n, vtk_to_numpy),
                  f"step {step}: the vertices are not the points")
            compare_arrays(check, root, data, step, slice(start, start + n), vtk_to_numpy)
    return check.wrong


def one_vertex_each(cells, n, to_numpy):
    """Is the k-th cell the vertex k?"""
    if n == 0:
        return cells.GetNumberOfCells() == 0
    return (numpy.array_equal(to_numpy(cells.GetOffsetsArray()), numpy.arange(n + 1))
            and numpy.array_equal(to_numpy(cells.GetConnectivityArray()), numpy.arange(n)))


def compare_arrays(check, root, data, step, rows, to_numpy):
    read = {"Points": data.GetPoints().GetData() if data.GetPoints() else None}
    read.update({f"PointData/{name}": data.GetPointData().GetArray(name)
                 for name in root["PointData"]})
    for path, array in read.items():
        wanted = root[path][rows]
        same = array is not None and numpy.array_equal(to_numpy(array), wanted)
        check(same or len(wanted) == 0, f"step {step}: VTK reads other {path}")
    for name in root["FieldData"]:
        array = data.GetFieldData().GetArray(name)
        check(array is not None and array.GetTuple1(0) == root["FieldData"][name][step],
              f"step {step}: VTK reads another {name}")


def drop(path):
    def fault(file):
        del file[path]
    return f"{path} is missing", fault


def attribute(path, name, value):
    def fault(file):
        del file[path].attrs[name]
        if value is not None:
            file[path].attrs[name] = value
    return f"{path}@{name} is {value!r}", fault


def one_more(path):
    def fault(file):
        file[path][-1] = file[path][-1] + 1
    return f"{path} is one too large at its end", fault


FAULTS = (
    attribute("VTKHDF", "Type", "PolyData"), attribute("VTKHDF", "Type", numpy.bytes_("Image")),
    attribute("VTKHDF", "Version", [1, 0]), attribute("VTKHDF/Steps", "NSteps", None),
    attribute("VTKHDF/Steps", "NSteps", numpy.int64(2)), attribute("run", "status", "done"),
    attribute("VTKHDF/PointData/velocity", "unit", None), attribute("metrics/time", "unit", ""),
    drop("VTKHDF/Strips/Offsets"), drop("VTKHDF/Steps/FieldDataOffsets/step"),
    drop("VTKHDF/Steps/PointDataOffsets/id"), drop("particles/fluid/velocity"),
    drop("VTKHDF/Lines/Connectivity"), one_more("VTKHDF/Vertices/Offsets"),
    one_more("VTKHDF/Vertices/Connectivity"), one_more("VTKHDF/Steps/PointOffsets"),
    one_more("VTKHDF/Steps/CellOffsets"), one_more("VTKHDF/Steps/PartOffsets"),
    one_more("VTKHDF/NumberOfPoints"), one_more("VTKHDF/Polygons/NumberOfCells"),
)


def missed_faults(name):
    """The faults that the structural check does not see."""
    wrong = structure(name)
    with tempfile.TemporaryDirectory() as folder:
        for about, fault in FAULTS:
            copy = os.path.join(folder, "copy.vtkhdf")
            shutil.copyfile(name, copy)
            with h5py.File(copy, "r+") as file:
                fault(file)
            if not structure(copy):
                wrong.append(f"not found: {about}")
    return wrong


def main(arguments):
    action = {"--vtk": by_vtk, "--self-test": missed_faults}.get(arguments[0] if arguments else "")
    names = arguments[1:] if action else arguments
    if len(names) != 1:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    wrong = (action or structure)(names[0])
    if wrong is None:
        return 77
    for line in wrong:
        print(f"{names[0]}: {line}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
