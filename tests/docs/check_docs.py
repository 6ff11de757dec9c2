#!/usr/bin/env python3
"""Checks that what the documents name exists: paths, symbols, options, commands, links, values of constants, times.

    check_docs.py [ROOT]       checks the documents under ROOT (default: this repository); exit 1 and a line per fault
    check_docs.py --self-test  plants every kind of fault in a temporary tree and expects it to be found

Looked at are README.md, CONTRIBUTING.md, what is unreleased in CHANGELOG.md, docs/*.md, docs/decisions/*.md, and the
files that comments of the sources name.
"""
import pathlib
import re
import sys

sys.dont_write_bytecode = True  # the folder of the sources stays as it is
from repository import CONSTANT, Repository, value_of

DOCUMENTS = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "docs/decisions/*.md")
OURS = r"\.(hpp|cpp|cu|cuh|md|py|sh|cmake|mjs|ts|schema\.json)"
# What users have: a name without a folder, or in a folder of theirs, with the ending of a kind of data.
USERS_FILE = re.compile(r"[\w.{}*/-]*\.(ply|xyz|pts|asc|txt|csv|obj|off|stl|vtk|json|png|svg)")
OTHER_PROGRAMS = {"cmake", "ctest", "ncu", "perf", "apt-get", "nvcc", "PoissonRecon", "docker", "mpirun", "mpiexec", "srun"}
SPAN = re.compile(r"(?<!`)`([^`]+)`(?!`)")
NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?:-[A-Za-z]\w*)*(?:(?:::|\.)[A-Za-z_]\w*)*")
LINK = re.compile(r"\[([^\[\]]*)\]\(([^()\s]+)\)")
NUMBERS = dict(zip("one two three four five six seven eight nine ten".split(), range(1, 11)))
# Numbers in prose that a constant of the sources decides.
COUNTED = {r"(\w+) sweeps": "kSweeps"}


def blanked(match):
    return re.sub(r"[^\n]", " ", match.group())


class Document:
    """One document. Places stay where they are: what is left out becomes spaces."""

    def __init__(self, repository, name, others):
        self.repository, self.name, self.others = repository, name, others
        text = (repository.root / name).read_text(encoding="utf-8")
        if name == "CHANGELOG.md":
            released = re.search(r"^## \[\d", text, re.MULTILINE)
            text = text[:released.start()] if released else text
        self.text = text
        self.prose = re.sub(r"```.*?```", blanked, text, flags=re.DOTALL)
        self.prose = re.sub(r"(?<=\n\n)(?:(?: {4}.*)?\n)+", blanked, self.prose)
        self.faults = []

    def fault(self, offset, story):
        line = self.text.count("\n", 0, offset) + 1
        self.faults.append(f"{self.name}:{line}: {story}")

    def check(self):
        for match in SPAN.finditer(self.prose):
            self.check_span(match.start(), match.group(1))
        self.check_commands()
        self.check_places()
        self.check_links()
        self.check_constants()
        return self.faults

    # Words in backticks.

    def check_span(self, at, span):
        words = span.split()
        if not words or span in self.others or words[0] in OTHER_PROGRAMS or "std::" in span:
            return
        if words[0] == "pointskin" and len(words) > 1:
            self.check_command(at, words.pop(1))
        for word in words:
            self.check_word(at, word.strip(",;:\"'()[]"))

    def check_command(self, at, word):
        if re.fullmatch("[a-z]+", word) and word not in self.repository.commands:
            self.fault(at, f"pointskin {word}: there is no such command")

    def check_word(self, at, word):
        option = re.match(r"-D(?=[A-Z])|--?[A-Za-z][\w-]*", word)
        if word in self.others:
            return
        if option and option.group() != "-D":
            self.check_option(at, option.group())
        elif word.startswith("/dev/") or re.fullmatch(r"[./]+", word):
            return
        elif re.fullmatch(r"\.[a-z]+", word):
            self.check_names(at, word[1:])
        elif re.match(r"[\w.*{<][\w.*{}<>,-]*/", word) or re.search(OURS + "$", word) or USERS_FILE.fullmatch(word):
            self.check_path(at, word)
        else:
            self.check_names(at, word.removeprefix("-D"))

    def check_option(self, at, option):
        known = self.repository.options
        if len(option) > 2 and option not in known and option not in self.others:
            self.fault(at, f"{option}: no program or script has this option")

    def check_path(self, at, path):
        first = path.removeprefix("./").split("/")[0]
        if first == "build":
            if path.split("/")[-1] not in self.repository.whole:
                self.fault(at, f"{path}: nothing builds it")
            return
        theirs = "/" not in path.removeprefix("./") or first not in self.repository.folders
        if USERS_FILE.fullmatch(path) and theirs and not path.endswith(".schema.json"):
            return
        if not self.repository.find(path, self.name):
            self.fault(at, f"{path}: there is no such file or folder")

    def check_names(self, at, word):
        word = re.sub(r"^NAME[-_]|\.\.\.", "", word)
        for match in NAME.finditer(word):
            parts = [part for part in re.split(r"::|\.", match.group()) if self.is_checked(part)]
            for part in parts:
                if not self.exists(part):
                    self.fault(at, f"{match.group()}: the sources have no {part}")
                    break
            else:
                if "::" in match.group() and not self.repository.holds_together(parts):
                    self.fault(at, f"{match.group()}: no file of the sources has both parts")

    def is_checked(self, part):
        # Single letters and words in capitals alone (FILE, N) stand for something.
        return len(part) > 1 and part not in self.others and not re.fullmatch("[A-Z]+[0-9]*", part)

    def exists(self, part):
        whole = self.repository.whole
        if part.startswith("_"):
            return any(word.endswith(part) for word in whole)
        if part.endswith("_"):
            return any(word.startswith(part) for word in whole)
        return part in whole or ("-" in part and whole.issuperset(part.split("-")))

    # Whole commands, and what is said to be where.

    def check_commands(self):
        for match in re.finditer(r"^ *(?:\$ )?(?:build/bin/)?pointskin ([a-z]+)([^#\n]*)", self.text, re.MULTILINE):
            if self.prose[match.end(1) - 1] == " ":  # in a block of code
                self.check_command(match.start(1), match.group(1))
                for option in re.finditer(r"(?<![\w-])--[A-Za-z][\w-]*", re.sub(r"'[^']*'", "''", match.group(2))):
                    self.check_option(match.start(2) + option.start(), option.group())

    def check_places(self):
        """`name` in `file`: the file has that name."""
        listed = r"((?:`[^`]+`(?:,\s+|\s+and\s+))*`[^`]+`)\s+in\s+`([\w./]+\.\w+)`"
        for match in re.finditer(listed, self.prose):
            files = [f for f in self.repository.find(match.group(2), self.name) if f in self.repository.words]
            held = set().union(*(self.repository.words[f] for f in files)) if files else None
            for name in re.findall(r"`([A-Za-z_][\w:]*)`", match.group(1)):
                if held is not None and not held.issuperset(name.split("::")) and name not in self.others:
                    self.fault(match.start(2), f"{match.group(2)} has no {name}")

    # Links.

    def check_links(self):
        for match in LINK.finditer(SPAN.sub(blanked, self.prose)):
            text, (target, _, anchor) = match.group(1), match.group(2).partition("#")
            if re.match(r"[a-z]+:", target):
                continue
            path = (self.repository.root / self.name).parent / target if target else self.repository.root / self.name
            if not path.exists():
                self.fault(match.start(), f"{match.group(2)}: the link leads nowhere")
            elif anchor and anchor not in anchors_of(path):
                self.fault(match.start(), f"{match.group(2)}: {path.name} has no such heading")
            called = re.fullmatch(r"(?:decisions?[ /])?0*(\d+)", text.strip())
            number = re.match(r"0*(\d+)-", path.name)
            if called and number and called.group(1) != number.group(1):
                self.fault(match.start(), f"the link called {text} opens {path.name}")

    # Numbers.

    def check_constants(self):
        for match in CONSTANT.finditer(self.text):
            known = self.repository.constants.get(match.group(1), set()) - {None}
            if known and value_of(match.group(2)) not in known:
                self.fault(match.start(), f"{match.group().strip()}: the sources say {sorted(known)}")
        for phrase, constant in COUNTED.items():
            for match in re.finditer(phrase, self.prose):
                said = NUMBERS.get(match.group(1), value_of(match.group(1)))
                known = self.repository.constants.get(constant, set())
                if said is not None and said not in known:
                    self.fault(match.start(), f"{match.group()}: {constant} is {sorted(known)}")


def anchors_of(path):
    text = re.sub(r"```.*?```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    headings = re.findall(r"^#+ +(.*?) *$", text, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", LINK.sub(r"\1", heading).lower()).replace(" ", "-") for heading in headings}


def tables_of(text):
    """The rows of all tables, each as {heading: cell}."""
    headings = None
    for line in text.splitlines():
        if not line.startswith("|"):
            headings = None
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if headings is None:
            headings = cells
        elif not re.fullmatch(r"[| :-]+", line):
            yield dict(zip(headings, cells))


def time_faults(root):
    """Runs of ours in docs/paper.md have the time and the memory that docs/performance.md has."""
    paper, performance = root / "docs/paper.md", root / "docs/performance.md"
    if not paper.exists() or not performance.exists():
        return
    measured = [row for row in tables_of(performance.read_text(encoding="utf-8")) if {"points", "depth", "median"} <= set(row)]
    for row in tables_of(paper.read_text(encoding="utf-8")):
        if not row.get("model", "").endswith("here"):
            continue
        same = [run for run in measured if run["depth"] == row["depth"] and row["points"] in run["points"]]
        run = f"docs/paper.md: {row['model']}, depth {row['depth']}"
        if not same:
            yield f"{run}: docs/performance.md has no such run"
        elif row["total"].split()[0] not in re.findall(r"[\d.]+", same[0]["median"]):
            yield f"{run}: {row['total']}, but {same[0]['median']} in docs/performance.md"
        elif row["memory"] != same[0]["peak on the device"]:
            yield f"{run}: {row['memory']}, but {same[0]['peak on the device']} in docs/performance.md"


def comment_faults(repository):
    """Files that comments of the sources name exist."""
    for name in sorted(repository.comments):
        for line, comment in repository.comments[name]:
            for path in re.findall(r"(?<![\w./*])[a-z][\w/]*\.(?:hpp|cpp|cuh|cu)\b", comment):
                if not repository.find(path, name):
                    yield f"{name}:{line}: {path}: there is no such file"


def title_faults(root):
    for path in sorted((root / "docs/decisions").glob("*.md")):
        if not path.read_text(encoding="utf-8").startswith(f"# {path.name[:4]} "):
            yield f"docs/decisions/{path.name}:1: the title does not begin with # {path.name[:4]}"


def find_faults(root):
    root = pathlib.Path(root)
    others = set()
    for line in (pathlib.Path(__file__).parent / "others.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            reason, _, words = line.partition(": ")
            others |= set(words.split()) | {words}
    repository = Repository(root)
    names = [str(path.relative_to(root)) for pattern in DOCUMENTS for path in sorted(root.glob(pattern))]
    found = [fault for name in names for fault in Document(repository, name, others).check()]
    return found + list(time_faults(root)) + list(title_faults(root)) + list(comment_faults(repository))


def main():
    if sys.argv[1:] == ["--self-test"]:
        from self_test import failures
        found = failures(find_faults)
    else:
        here = pathlib.Path(__file__).resolve()
        found = find_faults(sys.argv[1] if len(sys.argv) > 1 else here.parents[2])
    print("\n".join(found) if found else "docs: no fault")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
