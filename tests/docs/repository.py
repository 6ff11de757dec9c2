"""What exists in a repository: its files, the words of its sources, its options and commands, the values of constants."""
import fnmatch
import os
import pathlib
import re

SOURCES = ("src", "include", "apps", "mpi", "python", "packaging", "bench", "examples", "tests", "cmake", ".ci", "docs/pictures")
TEXT = {".hpp", ".cpp", ".cu", ".cuh", ".h", ".py", ".sh", ".txt", ".cmake", ".json", ".mjs", ".ts", ".in", ""}
CPLUSPLUS = {".hpp", ".cpp", ".cu", ".cuh", ".h"}
SKIPPED = {".git", "node_modules", "__pycache__", ".cache", "corpus"}
# Paths in documents are relative to one of these, or to the document.
BASES = ("", "src/", "include/", "include/pointskin/")
WORD = re.compile(r"[A-Za-z_]\w*(?:-\w+)*")
CONSTANT = re.compile(r"\b(k[A-Z]\w*)\s*=\s*(-?[0-9][0-9.e/ -]*)")
HERE = "tests/docs/"  # the planted violations and the list of other programs' names prove nothing


def value_of(text):
    """The number of a literal, or of a quotient of two; None where it is neither."""
    parts = text.strip().rstrip(".,").split("/")
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        return None
    if len(numbers) == 2 and numbers[1] != 0:
        return numbers[0] / numbers[1]
    return numbers[0] if len(numbers) == 1 else None


class Repository:
    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.files = set(self._walk())
        self.folders = {str(parent) for name in self.files for parent in pathlib.PurePath(name).parents}
        self.known = self.files | self.folders
        self.words, self.whole, self.options = {}, set(), set()
        self.constants, self.commands, self.comments = {}, set(), {}
        for name in sorted(self.files):
            if self._is_source(name):
                self._read(name)

    def _walk(self):
        for folder, folders, names in os.walk(self.root):
            folders[:] = [f for f in folders if f not in SKIPPED and not f.startswith("build")]
            for name in names:
                yield os.path.relpath(os.path.join(folder, name), self.root)

    def _is_source(self, name):
        path = pathlib.PurePath(name)
        if name.startswith(HERE) or path.suffix not in TEXT:
            return False
        return "/" not in name or name.startswith(tuple(f + "/" for f in SOURCES)) or name.endswith(".schema.json")

    def _read(self, name):
        text = (self.root / name).read_text(encoding="utf-8", errors="replace")
        suffix = pathlib.PurePath(name).suffix
        if suffix in CPLUSPLUS:  # a name that only a comment remembers is no name
            lines = enumerate(text.splitlines(), 1)
            self.comments[name] = [(number, line.partition("//")[2]) for number, line in lines if "//" in line]
            text = re.sub(r"(?<!:)//.*", "", text)
            for constant, value in CONSTANT.findall(text):
                self.constants.setdefault(constant, set()).add(value_of(value))
        hyphened = set(WORD.findall(text)) | {pathlib.PurePath(name).stem}
        self.words[name] = hyphened | {part for word in hyphened for part in word.split("-")}
        self.whole |= self.words[name]
        self.options |= set(re.findall(r"(?<![\w-])--?[A-Za-z][\w-]*", text))
        self.commands |= set(re.findall(r'(?:make_command\(|Command \w+\{)\s*\{\s*"([a-z]+)"', text))

    def holds_together(self, names):
        """One file has all `names` as words."""
        return any(words.issuperset(names) for words in self.words.values())

    def find(self, path, document):
        """Files or folders that `path` in `document` may mean; `path` may hold * and {a,b}."""
        bases = BASES + (str(pathlib.PurePath(document).parent) + "/",)
        candidates = {os.path.normpath(base + one) for base in bases for one in expanded(path)}
        if "/" not in path:  # a bare name stands for the one file that is called so
            candidates |= {name for one in expanded(path) for name in self.files
                           if fnmatch.fnmatchcase(os.path.basename(name), one)}
        return {name for one in candidates for name in self.called(one)}

    def called(self, name):
        """Files or folders of this name, in which *, ? and [...] stand for more, with or without .hpp or .cpp."""
        if re.search(r"[*?[]", name):
            return [n for pattern in (name, name + ".[hc]pp") for n in fnmatch.filter(self.known, pattern)]
        return [n for n in (name, name + ".hpp", name + ".cpp") if n in self.known]


def expanded(path):
    """`path` without braces: a{b,c} is ab and ac; placeholders (<step>, NAME, NNNN, X.cpp, `...`) stand for anything."""
    path = re.sub(r"<[^>]*>|\.\.\.|NNNN|NAME|\bX(?=[._])", "*", path)
    match = re.search(r"\{([^{}]*,[^{}]*)\}", path)
    if not match:
        return [path]
    ends = path[:match.start()], path[match.end():]
    return [one for part in match.group(1).split(",") for one in expanded(ends[0] + part.strip() + ends[1])]
