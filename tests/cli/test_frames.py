"""Frames of a result file as PNG, and as a film."""
import os
import shutil
import sys
import unittest

import numpy

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
except ImportError:
    print("skipped: VTK's Python module is missing, which reads the pictures")
    sys.exit(77)

import cli_case
from cli_case import frame


def pixels(path):
    """A PNG [rows][columns][red, green, blue], the first row at the top."""
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars())
    return values.reshape(height, width, -1)[::-1, :, :3].astype(int)


@unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is missing")
class Frames(cli_case.Case):
    def setUp(self):
        super().setUp()
        self.call("run", "dam-break", "--solver", "pbf", "--spacing", "0.07", "--t-end", "0.4",
                  "--frames", "2", "-o", "r.vtkhdf", "--json", "r.json", "--quiet")

    def only(self, **programs):
        """An environment that finds gnuplot and these programs, and nothing else."""
        folder = self.dir / "programs"
        folder.mkdir(exist_ok=True)
        for name in ("gnuplot", "sh", "cat"):
            if not (folder / name).exists():
                (folder / name).symlink_to(shutil.which(name))
        for name, text in programs.items():
            (folder / name).write_text(text)
            (folder / name).chmod(0o755)
        return {"PATH": str(folder)}

    def test_one_window_and_one_scale_of_colours(self):
        out, _ = self.call("frames", "r.vtkhdf", "-o", "p")
        self.assertIn("p/r_0000.png to p/r_0002.png", out)
        self.assertEqual(sorted(os.listdir(self.dir / "p")), [f"r_{k:04}.png" for k in range(3)])
        images = [pixels(self.dir / f"p/r_{k:04}.png") for k in range(3)]
        self.assertEqual(images[0].shape, images[1].shape)
        height, width, _ = images[0].shape
        left, right, top, bottom = 2 * 84, width - 2 * 124, 2 * 36, height - 2 * 58
        for image in images[1:]:
            differ = (image != images[0]).any(axis=2)
            inside = differ[top:bottom, left:right]
            self.assertGreater(inside.mean(), 0.02, "the fluid moves")
            differ[top:bottom, left:right] = False
            differ[:top - 6] = False  # the time, above the picture
            self.assertFalse(differ.any(), "axes and colours are those of all frames")

    def test_particles_stand_where_they_are(self):
        """The mark of each particle, by the window that the walls have at this spacing."""
        self.call("frames", "r.vtkhdf", "-o", "p", "--quiet")
        _, file = self.results()
        image = pixels(self.dir / "p/r_0001.png")
        height, width, _ = image.shape
        everything = [frame(file, k)("position")[:, :2] for k in range(3)]
        everything.append(file["walls/position"][:, :2])
        dx = file["run/parameters/spacing"][()]
        low = numpy.min([one.min(axis=0) for one in everything], axis=0) - dx
        high = numpy.max([one.max(axis=0) for one in everything], axis=0) + dx
        at = everything[1]
        x = 168 + (at[:, 0] - low[0]) / (high[0] - low[0]) * (width - 168 - 248)
        y = 72 + (high[1] - at[:, 1]) / (high[1] - low[1]) * (height - 72 - 116)
        colours = image[y.round().astype(int), x.round().astype(int)]
        self.assertGreater((colours.max(axis=1) - colours.min(axis=1)).min(), 20, "none is grey")

    def test_films(self):
        env = self.only()
        _, said = self.call("frames", "r.vtkhdf", "--film", "f.mp4", code=2, env=env)
        self.one_sentence(said, "ffmpeg is missing", "apt-get install ffmpeg")
        self.assertFalse((self.dir / "frames").exists(), "nothing is drawn in vain")
        env = self.only(ffmpeg='#!/bin/sh\necho "$@" >> calls\nfor last; do :; done\n'
                               'case $last in *.mp4) cat frames/r_0002.png > "$last";; esac\n')
        self.call("frames", "r.vtkhdf", "--film", "f.mp4", "--quiet", "--colour", "p", env=env)
        calls = (self.dir / "calls").read_text().splitlines()
        self.assertIn("-i frames/r_%04d.png -frames:v 3 -pix_fmt yuv420p", calls[-1])
        self.assertEqual((self.dir / "f.mp4").read_bytes(),
                         (self.dir / "frames/r_0002.png").read_bytes())
        env = self.only(ffmpeg='#!/bin/sh\n[ "$1" = -version ] || { echo no codec >&2; exit 1; }\n')
        (self.dir / "f.mp4").unlink()
        _, said = self.call("frames", "r.vtkhdf", "--film", "f.mp4", "--quiet", code=2, env=env)
        self.one_sentence(said, "'f.mp4' cannot be made: no codec")
        self.assertFalse((self.dir / "f.mp4").exists())

    @unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is missing")
    def test_a_real_film(self):
        self.call("frames", "r.vtkhdf", "--film", "f.mp4", "--quiet")
        self.assertEqual((self.dir / "f.mp4").read_bytes()[4:8], b"ftyp")

    def test_mistakes(self):
        for words, part in ((("x.vtkhdf",), "'x.vtkhdf'"), ((), "needs a result file"),
                            (("r.vtkhdf", "--colour", "q"), "allowed is speed or p"),
                            (("r.json",), "r.json"), (("r.vtkhdf", "--flim", "a"), "'--film'")):
            _, said = self.call("frames", *words, code=2)
            self.one_sentence(said, part)


if __name__ == "__main__":
    cli_case.main()
