#!/usr/bin/env python3
"""Compares two folders of packages byte by byte: compare_packages.py ONE TWO. Exit 1 and a line a difference.

Of archives that differ it names the files within that do, as far as they can be unpacked with Python and dpkg-deb."""
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import zipfile


def contents(package):
    """{name: bytes} of the files in a package; {} for what is no archive. Names of tar files carry mode and owner."""
    if package.suffix == ".whl":
        with zipfile.ZipFile(package) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    with tempfile.TemporaryDirectory() as folder:
        tar = package
        if package.suffix == ".deb":
            tar = pathlib.Path(folder, "data.tar")
            with open(tar, "wb") as out:
                subprocess.run(["dpkg-deb", "--fsys-tarfile", package], check=True, stdout=out)
        elif not package.name.endswith(".tar.gz"):
            return {}
        with tarfile.open(tar) as archive:
            describe = lambda entry: f"{entry.name} ({entry.mode:o} {entry.uname}:{entry.gname} {entry.mtime})"
            return {describe(entry): archive.extractfile(entry).read() if entry.isfile() else b"" for entry in archive}


def differences(one, two):
    names = [{path.name for path in folder.iterdir()} for folder in (one, two)]
    for name in sorted(names[0] ^ names[1]):
        yield f"{name}: only one of the builds has it"
    for name in sorted(names[0] & names[1]):
        if (one / name).read_bytes() == (two / name).read_bytes():
            continue
        within = contents(one / name), contents(two / name)
        different = sorted(file for file in within[0].keys() | within[1].keys() if within[0].get(file) != within[1].get(file))
        yield f"{name} differs" + (": " + ", ".join(different[:20]) if different else "")


def main(one, two):
    one, two = pathlib.Path(one), pathlib.Path(two)
    packages = sorted(path.name for path in one.iterdir())
    found = list(differences(one, two))
    if not packages:
        found.append(f"there are no packages in {one}")
    print("\n".join(found) if found else f"reproducible: {len(packages)} packages have the same bytes in both builds")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
