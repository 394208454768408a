#!/usr/bin/python3
"""What a user can get wrong. Each mistake is answered by one sentence on standard error that says
what was found and what is allowed, by nothing on standard output and by the exit code 2 (3 where
memory or the run failed), and leaves no file behind."""
import os
import resource
import signal
import subprocess

import cli_case
from cli_case import Case

PATCH = ("run", "rotating-patch", "--solver", "pbf", "--spacing", "0.03", "--t-end", "0.002")


class Refusal(Case):
    def refused(self, *words, says=(), code=2, **more):
        """The command is refused, and the folder is as it was."""
        with self.subTest(words=[str(word)[:60] for word in words]):
            before = self.files()
            out, err = self.call(*words, code=code, **more)
            self.assertEqual(out, "")
            self.one_sentence(err, *([says] if isinstance(says, str) else says))
            self.assertEqual(self.files(), before)


class Words(Refusal):
    def test_names(self):
        near = "the nearest known one is"
        self.refused("rum", says=["'rum'", f"{near} 'run'"])
        self.refused("run", "dam-brake", "--solver", "pbf",
                     says=["'dam-brake'", f"{near} 'dam-break'"])
        self.refused("run", "tank", "--solver", "dual-sd",
                     says=["solver 'dual-sd'", f"{near} 'dual-s"])
        self.refused("run", "tank", "--solver", "zzzzzzzz", says="'sphbench list solvers'")
        self.refused("run", "zzzzzzzz", "--solver", "pbf", says="'sphbench list scenes'")
        self.refused(*PATCH, "--sovler", "pbf", says=["'--sovler'", "'--solver'"])
        self.refused(*PATCH, "--zzzzzzzz", "1", says=["'--zzzzzzzz'", "--help"])
        self.refused(*PATCH, "-x", says="unknown flag '-x'")
        self.refused(*PATCH, "--", says="unknown flag '--'")
        self.refused("show", "gamma_main", says=["'gamma_main'", "'gamma_mean'"])
        self.refused("show", "zzzzzzzz", says="nothing is called 'zzzzzzzz'")
        self.refused("list", "solver", says=["'solver'", "allowed is solvers, scenes, metrics"])
        self.refused("speed", "--solvers", "dfsph,dfshp", says=["'dfshp'", f"{near} 'dfsph'"])

    def test_what_is_missing_or_too_much(self):
        self.refused("run", says="--solver NAME")
        self.refused("run", "tank", says="--solver NAME")
        self.refused("run", "--solver", "pbf", says="needs a scene")
        self.refused("show", says="needs the name")
        self.refused(*PATCH, "tank", says="'tank' was not expected")
        self.refused("list", "solvers", "scenes", says="'scenes' was not expected")
        for flag in ("--dt", "--t-end", "--spacing", "--seed", "--set", "--threads", "--frames",
                     "-o", "--json", "--solver"):
            self.refused(*PATCH, flag, says=f"{flag} needs a value")
            self.refused(*PATCH, flag, "--quiet", says=f"{flag} needs a value")
            self.refused(*PATCH, flag, "", says=f"{flag} needs a value")
        for flag in ("--dim", "--precision", "--backend"):
            self.refused(*PATCH, flag, says=f"{flag} needs a value")
            self.refused(*PATCH, flag, "", says=f"{flag}: ''")
        self.refused(*PATCH, "--quiet=yes", says="--quiet takes no value")
        self.refused("list", "solvers", "--json=a.json", says="--json takes no value")
        self.refused("", says="''")
        self.refused("run", "", "--solver", "pbf", says="''")

    def test_flags_of_other_verbs(self):
        self.refused(*PATCH, "--solvers", "pbf", says="run takes no --solvers")
        self.refused(*PATCH, "--particles", "5", says="run takes no --particles")
        self.refused("show", "pbf", "--dt", "1", says="show takes no --dt")
        self.refused("list", "solvers", "--set", "a=1", says="list takes no --set")

    def test_strange_text(self):
        long = "x" * 100000
        self.refused("run", long, "--solver", "pbf", says="xxx")
        self.refused("run", "tank", "--solver", long, says="xxx")
        self.refused(*PATCH, "--" + long, says="--xxx")
        self.refused(*PATCH, "--set", long, says="KEY=VALUE")
        self.refused(*PATCH, "--set", f"{long}=1", says="xxx")
        self.refused(*PATCH, "--dt", "1" + "0" * 100000, says="--dt")
        self.refused(*PATCH, "-o", long, says="xxx")
        self.refused(*PATCH, "-o", "y" * 253, says="name too long")
        self.refused(*PATCH, "--json", long, says="xxx")
        self.refused("run", os.fsdecode(b"\xff\xfe"), "--solver", "pbf", says="unknown scene")
        self.refused("run", "tank", "--solver", os.fsdecode(b"p\xffbf"), says="unknown solver")
        self.refused("run", "tank", "--solver", "a\nb\x1b[31m", says="'a?b?[31m'")
        self.refused(*PATCH, "--set", "a\nb=1", says="'a?b'")
        self.refused(*PATCH, "--dt", "%s%n%d", says="'%s%n%d'")


class Values(Refusal):
    def test_numbers(self):
        for flag, name, bad in (
                ("--dt", "dt", ("0", "-0.001", "nan", "inf", "-inf", "1e400", "text", "1e-3s",
                                "1,5", "0x", "1 2", "1e-400")),
                ("--spacing", "spacing", ("0", "-1", "nan", "inf", "text", "0.01m")),
                ("--t-end", "t_end", ("-1", "-1e-9", "nan", "inf", "text", "1e10"))):
            for value in bad:
                self.refused(*PATCH, flag, value, says=[f"{flag}: {name} is", value])
        for name, value in (("support", "0.5"), ("support", "0"), ("support", "11"), ("rho0", "0"),
                            ("xsph", "-1"), ("jitter", "2"), ("samples", "0"), ("side", "-1"),
                            ("tolerance", "nan"), ("max_iterations", "0"), ("tolerance", "")):
            self.refused(*PATCH, "--set", f"{name}={value}", says=[f"--set {name}: {name} is"])

    def test_whole_numbers(self):
        for flag, bad in (("--seed", ("-1", "1.5", "text", "99999999999999999999")),
                          ("--threads", ("0", "-1", "1.5", "text", "1000000")),
                          ("--frames", ("0", "-1", "1.5", "text", "99999999"))):
            for value in bad:
                self.refused(*PATCH, flag, value, says=[f"{flag}: ", value])
        for name, value in (("max_iterations", "2.5"), ("fixed_iterations", "0.1"),
                            ("scorr_n", "3.9"), ("samples", "10.5"), ("samples", "1.0000001")):
            self.refused(*PATCH, "--set", f"{name}={value}",
                         says=[f"--set {name}: {name} is {value}", "whole numbers from"])
        for value in ("20", "20.0", "2e1"):
            self.call(*PATCH, "--quiet", "--set", f"max_iterations={value}")

    def test_words(self):
        self.refused(*PATCH, "--set", "kernel=gauss", says=["'gauss'", "cubic|spiky"])
        self.refused(*PATCH, "--set", "kernel=0", says="cubic|spiky")
        self.refused(*PATCH, "--set", "clamp=", says=["clamp", "clamped|"])
        self.refused(*PATCH, "--precision", "half", says=["'half'", "double or float"])
        self.refused(*PATCH, "--dim", "4", says=["'4'", "2 or 3"])
        self.refused(*PATCH, "--backend", "opencl", says=["'opencl'", "openmp or cuda"])

    def test_set(self):
        self.refused(*PATCH, "--set", "tolerance", says=["'tolerance'", "KEY=VALUE"])
        self.refused(*PATCH, "--set", "=1", says="parameter ''")
        self.refused(*PATCH, "--set", "tolerence=1", says=["'tolerence'", "'tolerance'"])
        self.refused(*PATCH, "--set", "volume=printed", says="parameter 'volume'")  # not of pbf
        self.refused(*PATCH, *["--set", "xsph=0"] * 65, says="more than 64")

    def test_too_much(self):
        self.refused(*PATCH, "--spacing", "1e-7", says=["particles", "allowed"])
        self.refused(*PATCH, "--dt", "1e-12", "--t-end", "1e9", says=["1e+21 steps", "allowed"])
        self.refused(*PATCH, "--dt", "1e-12", "--dry-run", says="steps")


class Scenes(Refusal):
    def test_what_a_scene_cannot_be(self):
        self.refused("run", "rotating-patch", "--dim", "3", "--solver", "pbf",
                     says=["3 found", "2-D"])
        self.refused("run", "first-step", "--solver", "pbf", says=["'pbf' cannot project", "scene"])
        self.refused(*PATCH[:4], "--spacing", "1", says="axis 1")
        self.refused("run", "dam-break", "--solver", "pbf", "--set", "width=5", says="box")

    def write(self, text, name="a.yaml"):
        data = text if isinstance(text, bytes) else text.encode()
        (self.dir / name).write_bytes(data)
        return name

    def test_files_that_are_none(self):
        self.refused("run", "no.yaml", "--solver", "pbf", says=["no.yaml", "No such file"])
        self.refused("run", "./none", "--solver", "pbf", says=["./none", "No such file"])
        (self.dir / "folder.yaml").mkdir()
        self.refused("run", "folder.yaml", "--solver", "pbf", says="is a directory")
        for text in ("", "\n\n", "# nothing\n", "---\n"):
            self.refused("run", self.write(text), "--solver", "pbf", says="a.yaml")
        self.refused("run", self.write("a: [1"), "--solver", "pbf", says=["a.yaml:", "not YAML"])
        self.refused("run", self.write(b"\x00\x01\xff"), "--solver", "pbf", says="not YAML")
        self.refused("run", self.write("just words"), "--solver", "pbf", says="a.yaml:1:1")
        self.refused("run", self.write("dim: 2\n" + "#" * (1 << 20)), "--solver", "pbf",
                     says="1 MiB")
        if os.geteuid():
            os.chmod(self.dir / self.write("dim: 2"), 0)
            self.refused("run", "a.yaml", "--solver", "pbf", says="Permission denied")

    FLUID = "fluid:\n  - box: {low: [0, 0], high: [1, 1]}\n"

    def test_places(self):
        for text, place, parts in (
                (f"dim: 2\nfluit: 3\n{self.FLUID}", "2:1", ["'fluit'", "'fluid'"]),
                (f"dim: two\n{self.FLUID}", "1:6", ["'two'", "whole number"]),
                (f"dim: 4\n{self.FLUID}", "1:6", ["2 or 3"]),
                (f"dim: 2\nparams: {{dt: -1}}\n{self.FLUID}", "2:14", ["dt is -1", "allowed"]),
                (f"dim: 2\nparams: {{dx: 1}}\n{self.FLUID}", "2:10", ["'dx'"]),
                (f"dim: 2\nparams: {{support: 0.5}}\n{self.FLUID}", "2:19", ["support"]),
                ("dim: 2\nfluid:\n  - ball: {centre: [0, 0], radius: 1}\n", "3:", ["disc"]),
                ("dim: 2\nfluid:\n  - disc: {centre: [0, 0], radius: 0}\n", "3:", ["radius"]),
                ("dim: 2\nfluid:\n  - disc: {centre: [0, 0]}\n", "3:", ["'radius'"]),
                ("dim: 2\nfluid: []\n", "2:8", ["fluid"]),
                ("dim: 2\n", "1:1", ["'fluid'"])):
            self.refused("run", self.write(text), "--solver", "pbf",
                         says=[f"a.yaml:{place}", *parts])

    def test_particles(self):
        params = "dim: 2\nparams: {spacing: 0.1}\nfluid:\n"
        box = "  - box: {low: [0, 0], high: [1, 1]}\n"
        self.refused("run", self.write(params + box + box), "--solver", "pbf",
                     says=["both at", "overlap"])
        self.refused("run", self.write(params + "  - box: {low: [0, 0], high: [0.01, 0.01]}\n"),
                     "--solver", "pbf", says=["a.yaml:4:5", "half the spacing"])
        self.refused("run", self.write(params + "  - disc: {centre: [0, 0], radius: 0.01}\n"),
                     "--solver", "pbf", says="no fluid particle")
        self.refused("run", self.write(params + box + "domain: {low: [0, 0], high: [0.5, 0.5]}\n"),
                     "--solver", "pbf", says="outside the domain")
        self.refused("run", self.write(params + box + "domain: {low: [0, 0], high: [1, 1], "
                                       "period: [1, 0]}\n"), "--solver", "dual-sc", says="periodic")
        low = box.replace("1]}", "0.4]}")
        self.refused("run", self.write(params + low + "domain: {low: [0, 0], high: [1, 0.4], "
                                       "period: [0, 0.4]}\n"), "--solver", "pbf",
                     says="the period of 0.4 m along y is shorter")
        self.refused("run", self.write(params + box), "--solver", "pbf", "--dim", "3", says="--dim")


class Outputs(Refusal):
    def test_places_that_cannot_be_written(self):
        (self.dir / "folder").mkdir()
        for flag in ("-o", "--json"):
            self.refused(*PATCH, flag, "none/a", says=["'none/a'", "no folder 'none'"])
            self.refused(*PATCH, flag, "folder", says=["'folder'", "is a folder"])
            self.refused(*PATCH, flag, "folder/", says=["'folder/'", "folder"])
            self.refused(*PATCH, flag, "new/", says="folder")
            self.refused(*PATCH, flag, "/proc/a", says="'/proc/a'")
            self.refused(*PATCH, "--dry-run", flag, "none/a", says=["'none/a'", "no folder"])
        self.refused(*PATCH, "-o", "a", "--json", "none/b", says="'none/b'")
        self.refused(*PATCH, "-o", "none/a", "--json", "b", says="'none/a'")
        self.refused(*PATCH, "-o", "/dev/null", says="not a regular file")
        if os.geteuid():
            (self.dir / "folder").chmod(0o500)
            for flag in ("-o", "--json"):
                self.refused(*PATCH, flag, "folder/a", says=["'folder/a'", "Permission denied"])
            (self.dir / "folder").chmod(0o700)

    def test_files_in_each_others_way(self):
        self.refused(*PATCH, "-o", "a", "--json", "a", says=["-o and --json", "'a'"])
        (self.dir / "a").write_text("kept")
        self.refused(*PATCH, "-o", "a", "--json", "./a", says="-o and --json")
        self.assertEqual((self.dir / "a").read_text(), "kept")
        scene = "dim: 2\nfluid:\n  - box: {low: [0, 0], high: [1, 1]}\n"
        (self.dir / "s.yaml").write_text(scene)
        for flag in ("-o", "--json"):
            self.refused("run", "s.yaml", "--solver", "pbf", flag, "./s.yaml", says="scene file")
        self.assertEqual((self.dir / "s.yaml").read_text(), scene)
        self.refused(*PATCH, "--explain", "--json", "-", says="standard output")

    def test_full_disk(self):
        self.refused(*PATCH, "--quiet", "--json", "/dev/full",
                     says=["'/dev/full'", "No space left"])
        with open("/dev/full", "wb") as full:
            out, err = self.call(*PATCH, code=2, stdout=full)
        self.assertEqual(out, "")
        self.one_sentence(err, "standard output", "No space left")
        (self.dir / "old.vtkhdf").write_text("older")

        def limit():  # also of the signal, which Python ignores and a shell does not
            signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        for name in ("new.vtkhdf", "old.vtkhdf"):
            self.refused(*PATCH, "--quiet", "-o", name, "--json", "a.json",
                         says=[name, "too large"], preexec_fn=limit)
        self.assertEqual((self.dir / "old.vtkhdf").read_text(), "older")
        long = ("--t-end", "1", "--set", "samples=1000", "--quiet", "--json", "a.json")
        self.refused(*PATCH[:-2], *long, says=["a.json", "too large"], preexec_fn=limit)

    def with_memory(self, most, *words):
        """(exit code, what was said) of a run with so many bytes of address space."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
        with self.start("run", "rotating-patch", "--quiet", *words, preexec_fn=limit,
                        stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            out, err = process.communicate(timeout=cli_case.LONGEST)
        self.assertEqual(out, b"")
        return process.returncode, err.decode()

    def test_little_memory(self):
        """From what a tiny run needs up to what this one needs, so that it ends in many places.
        Without -o: HDF5 does not bear it."""
        for solver, step in (("dual-sc", 1 << 20), ("pbf", 1 << 18)):
            words = ("--solver", solver, "--t-end", "0.001", "--spacing")
            low, high = 1 << 20, 1 << 30
            while high - low > 1 << 20:
                middle = (low + high) // 2
                enough = self.with_memory(middle, *words, "0.03")[0] == 0
                low, high = (low, middle) if enough else (middle, high)
            endings, code = set(), 3
            while code:
                high += step
                code, err = self.with_memory(high, *words, "0.0014")
                if code:
                    self.assertEqual(code, 3, err)
                    self.one_sentence(err, "memory")
                    endings.add(err)
            self.assertGreater(len(endings), 2)

    def test_more_particles_than_the_machine_holds(self):
        machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        wanted = 1.5 * machine / (4 * 4190)  # particles whose neighbours fill it
        spacing = (0.4 ** 3 / wanted) ** (1 / 3)
        if machine > 64e9:
            self.skipTest("takes too long on a machine with so much memory")
        self.refused("run", "tank", "--dim", "3", "--solver", "pbf", "--precision", "float",
                     "--spacing", spacing, "--set", "support=10", "--dry-run",
                     says="this machine has")


if __name__ == "__main__":
    cli_case.main()
