#!/usr/bin/python3
"""Does the baseline of ./check notice faults? Plant them one at a time and see.

    mutate.py [--json FILE] [--only NAME]... [--work DIR] [--compare FILE]
    mutate.py --page FILE          results/mutations.json as a page, docs/planted-faults.md

With --only the others stay in FILE as they were.

In a copy of the tree each fault of mutations.py is planted, the variants that it is for are built,
the quick plan is swept and compared with results/baselines/quick.json. Without a fault all has to
pass. The list of what was caught, by which metric, goes to FILE. Exit code 1: a fault was missed
that is not said to be, or one was caught that is said not to be; or FILE of --compare tells of
other faults. 77: something to build with is missing."""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from mutations import FAULTS

ROOT = pathlib.Path(__file__).resolve().parents[2]
VARIANTS = ("2d-f64", "3d-f64", "2d-f32")
MOST_ROWS = 4  # that the list tells of each fault

PAGE = """# Planted faults

Would `./check` notice? Faults are planted in the sources one at a time, the quick plan is swept and
compared with `results/baselines/quick.json`, whose {compared} gates all pass without one. A fault
counts as caught where a metric fails that `mutations.py` names, in a run that it names. {caught} of
the {planted} are. Two were named otherwise before a first try (the float in CG, the short move in
single precision); two were missed by the plan as it was, and it has runs for them now (IISPH's
mirrored walls, PCISPH's tolerance).

    tests/mutations/mutate.py                  all of them again; also a test of `./check --all`
    tests/mutations/mutate.py --only mass-off

Written by `mutate.py --page` from `results/mutations.json`; the faults stand in
`tests/mutations/mutations.py`.
"""


def done(*words, codes=(0,), **more):
    process = subprocess.run([str(word) for word in words], capture_output=True, text=True, **more)
    if process.returncode not in codes:
        raise SystemExit(f"{' '.join(map(str, words))[:200]}:\n{process.stdout[-1500:]}"
                         f"{process.stderr[-1500:]}")
    return process


def copy_tree(to):
    """What git would commit, or all but build folders."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT,
                            capture_output=True, text=True)
    if listed.returncode or not listed.stdout:
        shutil.copytree(ROOT, to, dirs_exist_ok=True, ignore=shutil.ignore_patterns("build*"))
        return
    for name in listed.stdout.splitlines():
        if (ROOT / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, to / name)  # as new, so that all is built


class Tree:
    def __init__(self, folder):
        self.dir = folder
        copy_tree(folder)
        launcher = (["-DCMAKE_C_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else [])
        done("cmake", "-S", folder, "-B", folder / "build", "-G", "Ninja", "-DSPHBENCH_CUDA=OFF",
             "-DSPHBENCH_TESTS=OFF", *launcher)
        self.build("sphbench", *(f"sphbench-openmp-{variant}" for variant in VARIANTS))

    def build(self, *targets):
        done("ninja", "-C", self.dir / "build", *targets)

    def judge(self):
        """What `compare` says of the quick plan."""
        results, found = self.dir / "results-now", self.dir / "compare.json"
        shutil.rmtree(results, ignore_errors=True)
        command = self.dir / "build" / "bin" / "sphbench"
        done(command, "sweep", self.dir / "benchmarks" / "plans" / "quick.yaml", "--results",
             results, "--quiet", "--timeout", "60", codes=(0, 3))
        found.unlink(missing_ok=True)
        done(command, "compare", results, self.dir / "results" / "baselines" / "quick.json",
             "--json", found, codes=(0, 1))
        return json.loads(found.read_text())


def plant(tree, fault):
    """Returns the text that was there."""
    path = tree.dir / fault.file
    text = path.read_text()
    if text.count(fault.old) != 1:
        raise SystemExit(f"{fault.name}: '{fault.old}' stands {text.count(fault.old)} times in "
                         f"{fault.file}, not once: mutations.py is to be brought up to date")
    path.write_text(text.replace(fault.old, fault.new))
    return text


def row_text(row):
    if row["value"] is None:
        return f"{row['name']} of {row['run']}: {row['note']}"
    return (f"{row['name']} of {row['run']}: {row['value']:.6g}, was {row['baseline']:.6g}, "
            f"gate {row['tolerance']:.2g}")


def excess(row):
    if row["value"] is None or not row["tolerance"]:
        return float("inf")
    return abs(row["value"] - row["baseline"]) / row["tolerance"]


def verdict(fault, found):
    failed = [row for row in found["metrics"] if not row["pass"]]
    named = [row for row in failed
             if row["name"] in fault.metrics and fault.run in row["run"]]
    named.sort(key=excess, reverse=True)
    return {"name": fault.name, "what": fault.what, "file": fault.file, "caught": bool(named),
            "by": sorted({row["name"] for row in named}), "failed": len(failed),
            "runs": len({row["run"] for row in failed}),
            "worst": [row_text(row) for row in named[:1]] or
                     [row_text(row) for row in failed[:MOST_ROWS]],
            "identical": found["identical"], **({"blind": fault.blind} if fault.blind else {})}


def page_of(known):
    """The list as a page for people."""
    lines = [PAGE.format(**known), "| fault | where | caught by | worst of them |",
             "| --- | --- | --- | --- |"]
    for row in known["faults"]:
        by = ", ".join(row["by"]) or "**not caught**" + (
            f": {row['blind']}" if "blind" in row else "")
        worst = row["worst"][0] if row["worst"] else "nothing differs"
        lines.append(f"| {row['what']} | `{row['file']}` | {by}; {row['failed']} gates of "
                     f"{row['runs']} runs | {worst} |")
    return "\n".join(lines) + "\n"


def parsed():
    parser = argparse.ArgumentParser()
    parser.add_argument("--page")
    parser.add_argument("--json")
    parser.add_argument("--compare")
    parser.add_argument("--only", action="append")
    parser.add_argument("--work")
    return parser.parse_args()


def write(path, clean, fresh):
    path = path and pathlib.Path(path)
    if path:
        known = json.loads(path.read_text())["faults"] if path.exists() else []
        found = {row["name"]: row for row in known + fresh}
        rows = [found[fault.name] for fault in FAULTS if fault.name in found]
        text = json.dumps({"compared": clean["compared"], "planted": len(rows), "caught":
                           sum(row["caught"] for row in rows), "faults": rows}, indent=1)
        path.write_text(text + "\n")


def try_faults(tree, faults, told):
    """told(rows) is called after each."""
    rows, stale = [], []
    for fault in faults:
        begun = time.monotonic()
        if not set(stale) <= {f"sphbench-openmp-{variant}" for variant in fault.variants}:
            tree.build(*stale)
        before = plant(tree, fault)
        targets = [f"sphbench-openmp-{variant}" for variant in fault.variants]
        tree.build(*targets)
        rows.append(verdict(fault, tree.judge()))
        (tree.dir / fault.file).write_text(before)
        stale = targets  # built with the fault that has just been taken out
        row = rows[-1]
        print(f"{'caught' if row['caught'] else 'MISSED'} {fault.name} "
              f"({time.monotonic() - begun:.0f} s): {'; '.join(row['worst'])[:300] or 'nothing'}",
              flush=True)
        told(rows)
    return rows


def main():
    arguments = parsed()
    if arguments.page:
        known = json.loads((ROOT / "results" / "mutations.json").read_text())
        pathlib.Path(arguments.page).write_text(page_of(known))
        return 0
    if not all(map(shutil.which, ("cmake", "ninja", "cc"))):
        print("skipped: cmake, ninja or a C compiler is missing")
        return 77
    names = arguments.only or [fault.name for fault in FAULTS]
    if arguments.json and not arguments.only:
        pathlib.Path(arguments.json).unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(prefix="sphbench-mutations-") as folder:
        work = pathlib.Path(arguments.work or folder)
        work.mkdir(parents=True, exist_ok=True)
        tree = Tree(work)
        clean = tree.judge()
        if clean["failed"]:
            print(f"without a fault {clean['failed']} values differ from the baseline: "
                  f"{[row_text(row) for row in clean['metrics'][:3]]}")
            return 1
        print(f"without a fault: {clean['compared']} values agree, {clean['identical']} runs in "
              "every bit", flush=True)
        rows = try_faults(tree, [fault for fault in FAULTS if fault.name in names],
                          lambda rows: write(arguments.json, clean, rows))
    wrong = [row["name"] for row in rows if row["caught"] == bool(row.get("blind"))]
    if arguments.compare:
        known = json.loads(pathlib.Path(arguments.compare).read_text())["faults"]
        told = {row["name"]: row["caught"] for row in known}
        wrong += [row["name"] for row in rows if told.get(row["name"]) != row["caught"]]
    print(f"{sum(row['caught'] for row in rows)} of {len(rows)} faults were caught by name; not as "
          f"said: {', '.join(sorted(set(wrong))) or 'none'}")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
