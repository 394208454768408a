"""What the tests of the command line share: a folder of their own, and how a run is started.

Each of them is called as `test_NAME.py PATH/TO/sphbench [unittest's arguments]`; without h5py it is
skipped (77)."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
except ImportError:
    h5py = None

ROOT = pathlib.Path(__file__).resolve().parents[2]
LONGEST = 60  # seconds that one command may take
SECTIONS = ("solvers", "scenes", "metrics")


def command():
    return main.command


def no_constant(word):
    raise ValueError(f"{word} is not JSON")


def read_json(text):
    """JSON without the NaN and Infinity that Python allows."""
    return json.loads(text, parse_constant=no_constant)


class Case(unittest.TestCase):
    """A test in a new folder, which is the current one of every command."""

    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sphbench-cli-")
        self.addCleanup(folder.cleanup)
        self.dir = pathlib.Path(folder.name)

    def start(self, *words, env=None, **more):
        """Start the command, its output to be read by communicate()."""
        variables = dict(os.environ, OMP_NUM_THREADS="1", **(env or {}))
        return subprocess.Popen([command(), *map(os.fsencode, map(str, words))], cwd=self.dir,
                                env=variables, stdin=subprocess.DEVNULL, **more)

    def call(self, *words, code=0, env=None, **more):
        """Run the command to its end: (standard output, standard error) as text."""
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
        with self.start(*words, env=env, **pipes) as process:
            try:
                out, err = process.communicate(timeout=LONGEST)
            except subprocess.TimeoutExpired:
                process.kill()
                raise
        texts = [(text or b"").decode(errors="replace") for text in (out, err)]
        said = f"sphbench {' '.join(map(str, words))[:300]}: {texts[1][:600]}"
        self.assertEqual(process.returncode, code, said)
        if code == 0:
            self.assertEqual(texts[1], "", said)
        return texts

    def asked(self, *words):
        """The object that `list` or `show` print."""
        return read_json(self.call(*words, "--json")[0])

    def run_scene(self, scene, solver, *words, **more):
        """A quiet run with both files: (facts, result file open for reading)."""
        self.call("run", scene, "--solver", solver, "--quiet", "-o", "r.vtkhdf", "--json",
                  "r.json", *words, **more)
        return self.results()

    def results(self, name="r"):
        facts = read_json((self.dir / f"{name}.json").read_text())
        file = h5py.File(self.dir / f"{name}.vtkhdf", "r")
        self.addCleanup(file.close)
        return facts, file

    def files(self):
        return sorted(str(path.relative_to(self.dir)) for path in self.dir.rglob("*"))

    def one_sentence(self, err, *parts):
        """Is this one line that begins as it should and holds these parts?"""
        self.assertRegex(err, r"\Asphbench: [^\n]{10,2100}\n\Z")
        for part in parts:
            self.assertIn(part, err)


def frame(file, k):
    """Rows of frame k: a function from the name of an array to its values."""
    root = file["VTKHDF"]
    first, count = root["Steps/PointOffsets"][k], root["NumberOfPoints"][k]

    def rows(name):
        data = root["Points"] if name == "position" else root["PointData"][name]
        return data[first:first + count]
    return rows


def main():
    if h5py is None:
        print("skipped: h5py is missing")
        sys.exit(77)
    main.command = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
