"""Shared libraries that a program needs and a plain system lacks: found, copied beside it, and named by relative paths.

What every Linux of the same glibc has stays outside: the C and C++ runtimes and the loader. Nothing of a GPU is copied: the
CUDA runtime is linked in, and the driver is looked up when it is needed."""
import os
import pathlib
import re
import shutil
import subprocess

BASE = re.compile(r"^(linux-vdso|ld-linux|libc|libm|libdl|librt|libpthread|libstdc\+\+|libgcc_s)[.-]")
FORBIDDEN = re.compile(r"^(libGL|libcuda|libcudart|libX11)")


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def needed(file):
    """{name: path} of all libraries that `file` loads, those of its libraries included."""
    found = {}
    for line in run("ldd", file).splitlines():
        match = re.match(r"\s*(\S+)(?: => (\S+))? ", line)
        if match and "not found" in line:
            raise SystemExit(f"{file} needs {match.group(1)}, which is not installed")
        if match:
            found[pathlib.Path(match.group(1)).name] = match.group(2)
    return found


def check(file):
    for name in needed(file):
        if FORBIDDEN.match(name):
            raise SystemExit(f"{file} loads {name}, which servers lack")


def bundle(files, folder, tagged=False):
    """Copies what `files` need to `folder`, and sets their RUNPATH to it, relative.

    tagged: the copies get names of their own, so that another package's copy of the same library is another library.
    Returns the copies."""
    folder.mkdir(parents=True, exist_ok=True)
    copies, renamed = [], {}
    for file in files:
        check(file)
        for name, path in sorted(needed(file).items()):
            if BASE.match(name) or path is None or name in renamed or name.startswith("libpointskin"):
                continue
            target = folder / (re.sub(r"\.so", "-pointskin.so", name, count=1) if tagged else name)
            shutil.copyfile(pathlib.Path(path).resolve(), target)
            target.chmod(0o755)
            renamed[name] = target.name
            copies.append(target)
    for file in [*files, *copies]:
        if tagged:
            for old, new in renamed.items():
                if old in run("patchelf", "--print-needed", file).split():
                    run("patchelf", "--replace-needed", old, new, file)
        if file in copies:
            run("patchelf", "--set-soname", file.name, file)
        up = "$ORIGIN" if file in copies else f"$ORIGIN/{os.path.relpath(folder, file.parent)}"
        run("patchelf", "--set-rpath", up, file)
    return copies


def newest_glibc(files):
    """The newest version of glibc that `files` ask for, as (2, 36)."""
    newest = (2, 17)
    for file in files:
        for found in re.findall(r"GLIBC_(\d+)\.(\d+)", run("objdump", "-T", file)):
            newest = max(newest, tuple(int(part) for part in found))
    return newest
