#!/usr/bin/env python3
"""Makes the wheel of a build: make_wheel.py BUILD VERSION DIST.

One wheel for every Python from 3.9 on: the package is plain Python over the C interface. Inside are the shared library, the
program, and what both need beside glibc and the C++ runtime, found by relative paths. The same build gives the same bytes."""
import base64
import hashlib
import os
import pathlib
import shutil
import sys
import tempfile
import time
import zipfile

import bundle

ROOT = pathlib.Path(__file__).resolve().parents[1]

METADATA = """Metadata-Version: 2.1
Name: pointskin
Version: {version}
Summary: Oriented points in, watertight triangle mesh out, on a GPU in milliseconds, on a CPU in a second
License: {license}
Requires-Python: >=3.9
Requires-Dist: numpy
Classifier: Operating System :: POSIX :: Linux
Classifier: Programming Language :: Python :: 3
Classifier: Topic :: Scientific/Engineering
Classifier: Typing :: Typed
Description-Content-Type: text/markdown

{description}"""


def license_name():
    first = (ROOT / "LICENSE").read_text(encoding="utf-8").strip().splitlines()[0]
    return first.replace(" License", "").strip()


def fill(folder, build, version):
    """Lays the files of the wheel out in `folder`. Returns its ELF files."""
    package = folder / "pointskin"
    shutil.copytree(ROOT / "python" / "pointskin", package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "bin").mkdir()
    library, program = package / "libpointskin.so.0", package / "bin" / "pointskin"
    shutil.copyfile(build / "lib" / "libpointskin.so.0", library)
    shutil.copyfile(build / "bin" / "pointskin", program)
    for file in (library, program):
        file.chmod(0o755)
        bundle.run("strip", "--strip-unneeded", file)
    copies = bundle.bundle([library, program], folder / "pointskin.libs", tagged=True)
    info = folder / f"pointskin-{version}.dist-info"
    info.mkdir()
    description = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    (info / "METADATA").write_text(METADATA.format(version=version, license=license_name(), description=description), encoding="utf-8")
    (info / "entry_points.txt").write_text("[console_scripts]\npointskin = pointskin.program:main\n", encoding="utf-8")
    shutil.copyfile(ROOT / "LICENSE", info / "LICENSE")
    return [library, program, *copies], info


def digest_of(data):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def write_archive(folder, info, target):
    """A zip with sorted names and one date; RECORD comes last."""
    moment = time.gmtime(max(int(os.environ.get("SOURCE_DATE_EPOCH", "315532800")), 315532800))[:6]
    record = []
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        def add(name, data, mode):
            entry = zipfile.ZipInfo(name, moment)
            entry.external_attr, entry.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)

        for file in sorted(path for path in folder.rglob("*") if path.is_file()):
            name, data = file.relative_to(folder).as_posix(), file.read_bytes()
            add(name, data, 0o755 if os.access(file, os.X_OK) else 0o644)
            record.append(f"{name},{digest_of(data)},{len(data)}")
        record.append(f"{info.name}/RECORD,,")
        add(f"{info.name}/RECORD", "\n".join(record) + "\n", 0o644)


def main(build, version, dist):
    build, dist = pathlib.Path(build), pathlib.Path(dist)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        files, info = fill(folder, build, version)
        glibc = max(bundle.newest_glibc(files), (2, 36))  # what it is built and tested on: Debian 12
        if glibc > (2, 36):
            raise SystemExit(f"the build asks for glibc {glibc[0]}.{glibc[1]}, newer than Debian 12's 2.36: build it there")
        tag = f"py3-none-manylinux_{glibc[0]}_{glibc[1]}_x86_64"
        (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: pointskin\nRoot-Is-Purelib: false\nTag: {tag}\n", encoding="utf-8")
        target = dist / f"pointskin-{version}-{tag}.whl"
        target.unlink(missing_ok=True)
        write_archive(folder, info, target)
    print(f"{target}: {target.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])
