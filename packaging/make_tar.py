#!/usr/bin/env python3
"""Makes the archive of a build that works in any folder: make_tar.py BUILD VERSION DIST.

Program, shared library, headers, manual pages and completion, with what they need beside glibc and the C++ runtime."""
import gzip
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

import bundle


def main(build, version, dist):
    name = f"pointskin-{version}-linux-x86_64"
    moment = int(os.environ.get("SOURCE_DATE_EPOCH", "0"))
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / name
        subprocess.run(["cmake", "--install", build, "--strip", "--prefix", folder], check=True, stdout=subprocess.DEVNULL)
        library = next(folder.rglob("libpointskin.so.0.*"))
        bundle.bundle([folder / "bin" / "pointskin", library], library.parent / "pointskin")

        def plain(entry):
            entry.uid = entry.gid = 0
            entry.uname = entry.gname = "root"
            entry.mtime = moment
            return entry

        target = pathlib.Path(dist) / f"{name}.tar.gz"
        with open(target, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, moment) as packed, tarfile.open(fileobj=packed, mode="w") as archive:
            for file in [folder, *sorted(folder.rglob("*"))]:
                archive.add(file, file.relative_to(scratch), recursive=False, filter=plain)
    print(f"{target}: {target.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
