#!/usr/bin/env python3
"""Checks that .ci/packages names all that the build uses, and that README.md repeats it.

    check_packages.py BUILD      BUILD is a configured build folder with tests; exit 1 and a line per fault
    check_packages.py --self-test BUILD   takes packages out of the list and expects each to be missed

A package that merely lies on this machine is what this test is about: every file that CMake found under /usr must belong
to a package of the list, or to one that such a package depends on. Files that no Debian package owns do not count.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
TASKS = ("build", "test")


def read_list(text):
    """{task: [Debian packages]} of the text of .ci/packages."""
    tasks = {}
    for line in text.splitlines():
        if line.strip() and not line.startswith("#"):
            task, needs = line.split(":")
            tasks[task] = [need.split("=")[-1] for need in needs.split()]
    return tasks


def readme_faults(readme, tasks):
    """README.md has one line `apt-get install ...` a task, in the order of the list."""
    commands = re.findall(r"^ *apt-get install ([^#\n]*)", readme, re.MULTILINE)
    named = [command.split() for command in commands]
    wanted = [tasks[task] for task in TASKS]
    if named[:len(wanted)] != wanted:
        lines = "\n".join("    apt-get install " + " ".join(packages) for packages in wanted)
        return [f"README.md: its packages differ from .ci/packages; these lines belong there:\n{lines}"]
    return []


def found_by_cmake(cache):
    """Existing files and folders under /usr that the text of a CMakeCache.txt names."""
    paths = set()
    for name, value in re.findall(r"^([\w.-]+):(?:FILEPATH|PATH|STRING|UNINITIALIZED)=(/usr/[^\n;]*)$", cache, re.MULTILINE):
        if not value.startswith("/usr/local/") and not name.startswith("CMAKE_INSTALL") and pathlib.Path(value).exists():
            paths.add(str(pathlib.Path(value).resolve()))
    return paths


def owners_of(paths):
    """{path: the Debian packages that own it}, without what was not installed by dpkg and folders of everybody."""
    found = subprocess.run(["dpkg-query", "-S", *paths], capture_output=True, text=True, check=False).stdout if paths else ""
    owners = {path: set() for path in paths}
    for line in found.splitlines():
        names, _, path = line.rpartition(": ")
        if path in owners:
            owners[path] |= {name.split(":")[0] for name in names.split(", ")}
    return {path: names for path, names in owners.items() if 1 <= len(names) <= 2}


def installed():
    """{package: [groups of alternatives it depends on]} and {virtual name: {packages}}, of this machine."""
    form = "${Package}\t${Essential}\t${Pre-Depends}, ${Depends}\t${Provides}\n"
    listing = subprocess.run(["dpkg-query", "-W", "-f", form], capture_output=True, text=True, check=True).stdout
    strip = lambda name: re.sub(r"[\s:(].*", "", name.strip())
    depends, provides, essential = {}, {}, set()
    for line in listing.splitlines():
        package, is_essential, needs, offers = line.split("\t")
        depends[package] = [[strip(name) for name in group.split("|")] for group in needs.split(",") if group.strip()]
        for name in filter(None, map(strip, offers.split(","))):
            provides.setdefault(name, set()).add(package)
        if is_essential == "yes":
            essential.add(package)
    return depends, provides, essential


def closure(packages, machine):
    """All installed packages that come with `packages`."""
    depends, provides, essential = machine
    reached, todo = set(), list(packages) + list(essential)
    while todo:
        package = todo.pop()
        for name in {package} | provides.get(package, set()):
            if name in depends and name not in reached:
                reached.add(name)
                todo += [alternative for group in depends[name] for alternative in group]
    return reached


def build_faults(owners, packages, machine):
    """@param owners  what owners_of() says of all that CMake found"""
    reached = closure(packages, machine)
    for path, names in owners.items():
        if not names & reached:
            yield f".ci/packages: {path} is used and belongs to {', '.join(sorted(names))}, which no task names"


def self_test(owners, tasks, machine):
    listed = [package for task in TASKS for package in tasks[task]]
    faults = []
    for package in ("libeigen3-dev", "libtbb-dev", "libgtest-dev"):
        rest = [name for name in listed if name != package]
        if not any(package in fault for fault in build_faults(owners, rest, machine)):
            faults.append(f"self test: {package} was taken out of the list, and nothing was missed")
    if not readme_faults("    apt-get install g++\n", tasks):
        faults.append("self test: a README without the packages passed")
    return faults


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--self-test"]
    cache = (pathlib.Path(arguments[0]) / "CMakeCache.txt").read_text(encoding="utf-8")
    tasks = read_list((ROOT / ".ci/packages").read_text(encoding="utf-8"))
    try:
        machine, owners = installed(), owners_of(sorted(found_by_cmake(cache)))
    except (FileNotFoundError, subprocess.CalledProcessError):
        print("no dpkg here: only README.md was compared")
        machine = None
    if "--self-test" in sys.argv:
        faults = self_test(owners, tasks, machine) if machine else []
    else:
        faults = readme_faults((ROOT / "README.md").read_text(encoding="utf-8"), tasks)
        if machine:
            faults += build_faults(owners, [package for task in TASKS for package in tasks[task]], machine)
    print("\n".join(faults) if faults else "packages: all that the build uses is listed")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
