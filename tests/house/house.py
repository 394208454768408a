#!/usr/bin/env python3
"""The rules of the house that a compiler does not check.

    house.py [--root DIR]     check a tree (the project's own by default)
    house.py --self-test      plant one fault per rule in a small tree and see it found

Prints `file:line: rule: text` for each violation and exits with 1 if there is one; lines that say
"(aim)" are advice and do not count. Needs nothing but Python's standard library and, to leave out
what is not committed, git.
"""
import argparse
import ast
import bisect
import pathlib
import re
import socket
import subprocess
import sys

C_LIKE = {".c", ".h", ".cu", ".cuh", ".def"}
CODE = C_LIKE | {".py", ".sh", ".cmake", ".gp"}
DATA = {".csv", ".json", ".svg", ".html"}
TEXT = CODE | DATA | {".md", ".txt", ".in", ".yaml", ".yml", ".cff", ".1", ""}
NOT_COMMITTED = {".git", "build", "runs", "figures", "__pycache__"}

# Folder: the floor that an includer there may reach up to, and the floor that it counts as when it
# is included. Analysis spans three: metrics are for the runner, comparisons stand above it.
FLOORS = {
    "core/base": (0, 0),
    "core/sph": (1, 1),
    "core/particles": (1, 1),
    "core/backend": (2, 1),
    "core/neighbours": (2, 2),
    "core/scene": (2, 2),
    "core/linear": (2, 2),
    "core": (3, 3),
    "solvers": (4, 4),
    "benchmarks": (4, 4),
    "core/run": (5, 5),
    "core/io": (5, 5),
    "analysis": (6, 4),
    "paper-figures": (7, 7),
    "tools": (8, 8),
    "tests": (8, 8),
}
CONTRACTS = 3  # floors from here up may read the lists of names (*.def) of any floor
STRANGERS = {"solvers": ("benchmarks", "analysis"), "benchmarks": ("solvers",)}

AIM_FUNCTION, MOST_FUNCTION = 60, 100
AIM_FILE, MOST_FILE = 500, 700
MOST_COLUMNS = 100

COMMENT_OR_STRING = re.compile(
    r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.DOTALL)
DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(\w+)(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
QUOTED = re.compile(r"`[^`\n]*`")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.MULTILINE)


def blank(match):
    """As many spaces as the match is long, on as many lines."""
    return re.sub(r"[^\n]", " ", match.group())


class Source:
    """A file of the tree, as text and with comments, strings or directives blanked out."""

    def __init__(self, root, path):
        self.path = path
        self.folder = path.rpartition("/")[0]
        self.suffix = pathlib.PurePosixPath(path).suffix
        raw = (root / path).read_bytes()
        self.binary = b"\0" in raw
        self.text = "" if self.binary else raw.decode("utf-8", "replace")
        self.lines = self.text.split("\n")
        self.starts = [0]
        for line in self.lines:
            self.starts.append(self.starts[-1] + len(line) + 1)
        self.is_c = self.suffix in C_LIKE
        self.is_code = self.suffix in CODE or self.text.startswith("#!") \
            or path.endswith("CMakeLists.txt")
        self.no_comments = self.code = ""
        if self.is_c:
            comment = lambda m: blank(m) if m.group()[0] == "/" else m.group()
            self.no_comments = COMMENT_OR_STRING.sub(comment, self.text)
            self.code = COMMENT_OR_STRING.sub(blank, self.text)
            self.functions = list(c_functions(self))

    def line(self, offset):
        return bisect.bisect_right(self.starts, offset)

    def under(self, *folders):
        return any(self.path.startswith(folder + "/") for folder in folders)


def c_functions(source):
    """(name, first line, last line) of the functions of a C file.

    Braces are counted outside directives; the branches of an #if each start from the same depth.
    """
    code = source.code
    marks = re.compile(r"[{};]|" + DIRECTIVE.pattern, re.MULTILINE)
    depth, saved, after, begun = 0, [], 0, None
    for mark in marks.finditer(code):
        token = mark.group()
        if token == "{":
            head = code[after:mark.start()]
            if depth == 0 and re.search(r"\)\s*$", head) and "=" not in head:
                start = mark.start() - len(re.split(r"\n[ \t]*\n", head)[-1].lstrip())
                name = re.search(r"(\w+)\s*\(", code[start:])
                begun = name.group(1), source.line(start)
            elif depth == 0 and re.search(r'extern\s*"C"\s*$', source.text[after:mark.start()]):
                depth -= 1
            depth += 1
        elif token == "}":
            depth = max(depth - 1, 0)
            if depth == 0 and begun:
                yield *begun, source.line(mark.start())
                begun = None
        elif mark.group(1):
            if mark.group(1) in ("if", "ifdef", "ifndef"):
                saved.append((depth, begun))
            elif mark.group(1) in ("else", "elif") and saved:
                depth, begun = saved[-1]
            elif mark.group(1) == "endif" and saved:
                saved.pop()
        if depth == 0:
            after = mark.end()


def git_listing(root):
    if not (root / ".git").exists():
        return []
    ask = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listing = subprocess.run(ask, cwd=root, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return []
    return [path for path in listing.stdout.split("\0") if path]


class Tree:
    """The committed files below a folder."""

    def __init__(self, root):
        self.root = pathlib.Path(root).resolve()
        self.sources = {path: Source(self.root, path) for path in self.committed()}
        self.c = [s for s in self.sources.values() if s.is_c]

    def committed(self):
        """Paths of the files that are, or are about to be, committed."""
        paths = git_listing(self.root)
        if not paths:
            relative = (p.relative_to(self.root) for p in self.root.rglob("*"))
            paths = [p.as_posix() for p in relative if not NOT_COMMITTED & set(p.parts)]
        return sorted(p for p in set(paths) if (self.root / p).is_file()
                      and pathlib.PurePosixPath(p).suffix in TEXT)

    def find(self, source, name):
        """The path in the tree that an include of `name` in this source means."""
        parts = (source.folder + "/" + name).split("/")
        while ".." in parts[1:]:
            at = parts.index("..", 1)
            del parts[at - 1:at + 1]
        tried = ["/".join(parts), name, "core/" + name]
        tried += [p for p in self.sources if p.endswith("/" + name)]
        return next((p for p in tried if p in self.sources), None)

    def solver_names(self):
        listed = self.sources.get("solvers/solvers.def")
        return re.findall(r"^\s*SOLVER\((\w+)\)", listed.no_comments, re.M) if listed else []


def floor_of(path):
    folder = path.rpartition("/")[0]
    while folder and folder not in FLOORS:
        if folder.startswith("core/"):
            return None
        folder = folder.rpartition("/")[0]
    return FLOORS.get(folder)


def floors(tree):
    """A file includes only what lies on its floor or below."""
    for source in tree.c:
        if floor_of(source.path) is None:
            yield source, 1, f"the folder {source.folder or '.'} has no floor in tests/house"
            continue
        for match in INCLUDE.finditer(source.no_comments):
            target = tree.find(source, match.group(2)) if match.group(1) == '"' else None
            if target is None or floor_of(target) is None:
                continue
            own, other = floor_of(source.path)[0], floor_of(target)[1]
            line, folder = source.line(match.start()), source.path.split("/")[0]
            if target.endswith(".def") and own >= CONTRACTS:
                continue
            if other > own:
                yield source, line, f"includes {target} (floor {other}) from floor {own}"
            elif target.split("/")[0] in STRANGERS.get(folder, ()):
                yield source, line, f"includes {target}: {folder}/ must not know of it"


def names(tree):
    """No C file outside solvers/ holds a solver's name."""
    if not tree.solver_names():
        return
    words = "|".join(name.replace("_", "[-_]") for name in tree.solver_names())
    pattern = re.compile(rf"(?<![A-Za-z0-9])({words})(?![A-Za-z0-9])", re.IGNORECASE)
    for source in tree.c:
        if not source.under("solvers", "tests", "docs"):
            for match in pattern.finditer(source.no_comments):
                yield source, source.line(match.start()), f"names the solver '{match.group()}'"


def lengths(tree):
    """Short functions, short files, short lines."""
    for source in tree.sources.values():
        if not source.is_code:
            continue
        count = len(source.lines) - 1
        yield from too_long(source, 1, "the file", count, AIM_FILE, MOST_FILE)
        for number, line in enumerate(source.lines, 1):
            if len(line) > MOST_COLUMNS:
                yield source, number, f"{len(line)} columns (at most {MOST_COLUMNS})"
        for name, first, last in source.functions if source.is_c else python_functions(source):
            yield from too_long(source, first, name, last - first + 1, AIM_FUNCTION, MOST_FUNCTION)


def too_long(source, line, what, count, aim, most):
    if count > most:
        yield source, line, f"{what} has {count} lines (at most {most})"
    elif count > aim:
        yield source, line, f"(aim) {what} has {count} lines (aim: {aim})"


def python_functions(source):
    if source.suffix == ".py":
        for node in ast.walk(ast.parse(source.text)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                yield node.name, node.lineno, node.end_lineno


def arguments(text, start):
    """The top-level arguments of the call whose parenthesis opens at start."""
    parts, depth, begin = [], 0, start + 1
    token = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'|[(){},]')
    for match in token.finditer(text, start):
        depth += {"(": 1, "{": 1, ")": -1, "}": -1}.get(match.group(), 0)
        if depth == 0 or depth == 1 and match.group() == ",":
            parts.append(text[begin:match.start()].replace("\\\n", " ").strip())
            begin = match.end()
            if depth == 0:
                break
    return parts


def table_rows(source):
    """(offset, macro) of the rows of field, metric and parameter tables."""
    if source.suffix == ".def":
        for match in re.finditer(r"^\s*(FIELD|METRIC)\s*(?=\()", source.no_comments, re.M):
            yield match.end(), match.group(1)
    for listing in DIRECTIVE.finditer(source.no_comments):
        head = re.match(r"\s*#\s*define\s+\w+\((F|P)\)", listing.group())
        if head:
            for match in re.finditer(rf"\b{head.group(1)}\s*(?=\()", listing.group()[head.end():]):
                yield listing.start() + head.end() + match.end(), head.group(1)


def units(tree):
    """Every field, metric and parameter has a unit and a meaning."""
    for source in tree.c:
        for offset, macro in table_rows(source):
            row = arguments(source.no_comments, offset)
            unit, meaning = ([""] * 2 + row)[-2:]
            line, name = source.line(offset), " ".join(row[:2 if macro in ("FIELD", "F") else 1])
            if not re.fullmatch(r'"[^"]*[^"\s][^"]*"|[A-Z_]+_CHOICES|WHOLE', unit) or len(row) < 3:
                yield source, line, f"{macro}({name}) has no unit"
            if not re.fullmatch(r'"[^"]*[A-Za-z]{2}[^"]*"(\s*"[^"]*")*', meaning):
                yield source, line, f"{macro}({name}) has no meaning"


def variants(tree):
    """No #if in solvers/ and benchmarks/: a variant is its own executable."""
    for source in tree.c:
        if not source.under("solvers", "benchmarks"):
            continue
        guard = re.match(r"\s*#\s*ifndef\s+(\w+)\s*\n\s*#\s*define\s+\1\b", source.no_comments)
        for match in DIRECTIVE.finditer(source.no_comments):
            if match.group(1) in ("if", "ifdef", "ifndef", "elif") and not (
                    guard and match.start() <= guard.end()):
                yield source, source.line(match.start()), f"#{match.group(1)}"


def exits(tree):
    """What fails below main returns a status; only main ends the process."""
    call = re.compile(r"(?<![\w.>])(exit|abort|quick_exit|_Exit)\s*\(")
    for source in tree.c:
        if source.under("tests"):
            continue
        main = next((f[1:] for f in source.functions if f[0] == "main"), (0, 0))
        for match in call.finditer(source.code):
            line = source.line(match.start())
            if not main[0] <= line <= main[1]:
                yield source, line, f"{match.group(1)}() below main"


def blanks(tree):
    """No tabs, no trailing blanks, a newline at the end."""
    for source in tree.sources.values():
        if source.suffix in DATA or not source.text:
            continue
        for number, line in enumerate(source.lines, 1):
            if "\t" in line:
                yield source, number, "tab"
            if line != line.rstrip():
                yield source, number, "blank at the end of the line"
        if source.lines[-1]:
            yield source, len(source.lines), "no newline at the end of the file"


def traces(tree):
    """No trace of the machine or of the days on which a file was written."""
    places = r"(?<![\w.~})])/(?:work|root|home/\w+|Users/\w+)(?![\w-])"
    host = socket.gethostname().split(".")[0]
    if len(host) > 5 and re.search(r"\d", host):  # a name that is no word of the trade
        places += rf"|\b{re.escape(host)}\b"
    diary = r"(?i:\bs[e]ssions?\b)"  # in brackets, so that this file does not report itself
    pattern = re.compile(f"({places})|{diary}")
    for source in tree.sources.values():
        for match in pattern.finditer(source.text):
            name_in_code = source.is_c and source.code[match.start()] != " "
            if match.group(1) or not name_in_code:
                yield source, source.line(match.start()), f"'{match.group()}'"


def papers(tree):
    """A solver's file opens with its paper, the DOI and how the code differs from it."""
    for source in tree.c:
        defines = re.search(r"^const struct solver solver_\w+ =", source.code, re.M)
        if not source.under("solvers") or not defines:
            continue
        opening = re.match(r"/\*.*?\*/", source.text, re.DOTALL)
        if not opening or not re.search(r"\b10\.\d{4,}/\S", opening.group()):
            yield source, 1, "the opening comment names no DOI"
        if not opening or "ifferences" not in opening.group():
            yield source, 1, "the opening comment has no section 'Differences from the paper'"


def equations(tree):
    """Above each stage of a solver stands what it computes: a formula, or where the paper has it.

    A stage that fits on one line says it itself.
    """
    stage = re.compile(r"^STAGE\s+\w+\s+(\w+)\([^)]*\bint i\)\s*\{[ \t]*\n", re.MULTILINE)
    cited = re.compile(r"\b(Eqs?\.|Alg\.|Algorithm|Sec\.|Section|Fig\.)\s*\(?[A-Z]?\d|[-+]?=\s")
    for source in tree.c:
        if not source.under("solvers"):
            continue
        for match in stage.finditer(source.code):
            number = source.line(match.start())
            above = re.search(r"/\*(?:(?!\*/).)*\*/\s*$", source.text[:match.start()], re.DOTALL)
            said = (above.group() if above else "") + source.lines[number - 1]
            if not cited.search(said):
                yield source, number, f"the stage {match.group(1)} has no equation above it"


def licences(tree):
    """GSL is GPL: analysis and tests may use it, what is linked into a variant may not."""
    for source in tree.c:
        for match in INCLUDE.finditer(source.no_comments):
            if match.group(2).startswith("gsl/") and not source.under("analysis", "tests"):
                yield source, source.line(match.start()), f"includes {match.group(2)}"


def links(tree):
    """What README.md and the pages in docs/ link to exists: a file or folder of the tree, and in a
    page of Markdown the heading that stands behind the #."""
    link = re.compile(r"\]\(<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\)|(?:src|href)=\"([^\"]+)\"")
    for source in tree.sources.values():
        if source.path != "README.md" and not (source.under("docs") and source.suffix == ".md"):
            continue
        for match in link.finditer(QUOTED.sub(blank, FENCED.sub(blank, source.text))):
            where, line = match.group(1) or match.group(2), source.line(match.start())
            path, _, heading = where.partition("#")
            if re.match(r"[a-z][a-z0-9+.-]*:", where):
                continue
            here = tree.root / source.path
            target = (here.parent / path).resolve() if path else here
            if tree.root not in target.parents or not target.exists():
                yield source, line, f"links to {path}, which is not there"
            elif heading and target.suffix == ".md" and heading not in anchors(target.read_text()):
                yield source, line, f"links to {where}, which has no such heading"


def anchors(text):
    """The names by which headings of a page are linked to."""
    titles = re.findall(r"^#+[ \t]+(.*?)[ \t]*$", FENCED.sub(blank, text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


RULES = [floors, names, lengths, units, variants, exits, blanks, traces, papers, equations,
         licences, links]


def violations(root):
    """(path, line, rule, text) of everything found, in the order of the files."""
    tree = Tree(root)
    return sorted((source.path, line, rule.__name__, text)
                  for rule in RULES for source, line, text in rule(tree))


def main():
    here = pathlib.Path(__file__).resolve()
    parser = argparse.ArgumentParser(description="Check the rules of the house.")
    parser.add_argument("--root", default=here.parents[2], help="the tree to check")
    parser.add_argument("--self-test", action="store_true", help="find planted faults")
    asked = parser.parse_args()
    if asked.self_test:
        import planted
        return planted.run(violations, [rule.__name__ for rule in RULES])
    found = violations(asked.root)
    for path, line, rule, text in found:
        print(f"{path}:{line}: {rule}: {text}")
    count = sum(not text.startswith("(aim)") for *_, text in found)
    print(f"{count} violations")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
