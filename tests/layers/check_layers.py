#!/usr/bin/env python3
"""Checks who includes whom: data flows octree -> poisson -> field -> surface, and no arrow runs back.

    check_layers.py [ROOT]      checks the sources under ROOT (default: this repository); exit 1 and a line per violation
    check_layers.py --self-test plants every kind of violation in a temporary tree and expects it to be found
"""
import pathlib
import re
import sys
import tempfile

# What the files of src/<folder> may include with quotes. All may include <pointskin/...>; src/*.cpp may include all.
SOLVE = {"core", "exec", "octree", "poisson", "field", "surface", "mesh", "envelope", "diagnose", "reconstruct"}
LAYERS = {
    "core": {"core"},
    "exec": {"core", "exec"},
    "octree": {"core", "exec", "octree"},
    "poisson": {"core", "exec", "octree", "poisson"},
    "field": {"core", "exec", "octree", "field"},
    "surface": {"core", "exec", "octree", "field", "surface"},
    "mesh": {"core", "exec", "mesh"},
    "envelope": {"core", "exec", "octree", "mesh", "envelope"},
    "io": {"core", "exec", "io"},
    "ranks": {"core", "exec", "ranks"},
    "diagnose": {"core", "exec", "octree", "poisson", "field", "surface", "diagnose"},
    # What joins the parts to one reconstruction, and the features that are built on it: none knows another.
    "reconstruct": SOLVE,
    "normals": SOLVE | {"normals"},
    "edit": SOLVE | {"edit"},
    "deform": SOLVE | {"deform"},
    "boolean": SOLVE | {"boolean"},
    "fluid": SOLVE | {"fluid"},
    "simulation": SOLVE | {"fluid", "simulation"},  # shows its water by the surfaces of fluid
    "render": {"core", "exec", "octree", "mesh", "render"},
    "problems": {"core", "exec", "mesh", "render", "problems"},
    # Files larger than memory: what the rooms below do for arrays, in parts.
    "scale": {"core", "exec", "octree", "poisson", "field", "surface", "mesh", "io", "diagnose", "reconstruct", "scale"},
    "c": {"c"},  # calls what every program may call
}
# The rooms of the program: what the files of apps/<room> may include with quotes, by its path from apps/. A file may
# include those of its own room by their names alone.
APP_ROOMS = {
    "scene": {"scene"},
    "studio/wire": {"studio/wire"},
    "studio/session": {"scene", "studio/session", "studio/wire"},
    "studio/server": {"studio/server", "studio/session/application.hpp"},  # serves an Application, and knows no scene
}
# Headers of libraries that a room alone names.
OWNED = {"meshoptimizer": "studio/wire", "CLI/": "cli"}
SOURCES = {".hpp", ".cpp", ".cuh", ".cu", ".h"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
COMPILER = re.compile(r"__CUDACC__|__CUDA_ARCH__")
# Headers of the backends, which only exec/ names; .cu and .cuh files are CUDA by nature.
BACKEND = re.compile(r"^(cuda|cub/|thrust/|curand|nvtx3/|cooperative_groups|tbb/|oneapi/)")


def violations_in(path, where, allowed, may_name_backend, may_ask_compiler):
    """Yields one line per violation in the file `path`; `allowed` is None where every folder may be included."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        place = f"{where}:{number}"
        if COMPILER.search(line) and not may_ask_compiler:
            yield f"{place}: asks for the CUDA compiler; only src/core and src/exec may"
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, target = match.groups()
        folder = target.split("/")[0]
        if target.endswith(("_impl.hpp", ".cpp")):
            yield f"{place}: includes {target}; what two steps share lies in a header with a name of its own"
        elif target == "exec/this_space.hpp" and path.suffix != ".cpp":
            yield f"{place}: includes {target}; only the .cpp of a step does"
        elif BACKEND.match(target) and not may_name_backend:
            yield f"{place}: includes {target}; only src/exec names a backend"
        elif quote == "<" or allowed is None:
            continue
        elif folder == "pointskin":
            yield f'{place}: includes "{target}"; public headers are included as <{target}>'
        elif "/" not in target:
            yield f'{place}: includes "{target}"; headers are included by their path from src/'
        elif folder not in allowed:
            yield f"{place}: includes {target}; it may include only {', '.join(sorted(allowed))}"


def violations_in_room(path, where, room):
    """Yields one line per violation in a file of apps/<room>. Rooms that are in no list may include any other."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, target = match.groups()
        for library, owner in OWNED.items():
            if target.startswith(library) and room != owner:
                yield f"{where}:{number}: includes {target}; only apps/{owner} names this library"
        if BACKEND.match(target):
            yield f"{where}:{number}: includes {target}; only src/exec names a backend"
        allowed = APP_ROOMS.get(room)
        if quote == '"' and allowed is not None and "/" in target:
            if target not in allowed and str(pathlib.PurePosixPath(target).parent) not in allowed:
                yield f"{where}:{number}: includes {target}; it may include only {', '.join(sorted(allowed))}"


def room_of(parts):
    """apps/studio/wire/a.cpp -> studio/wire, apps/cli/bench/a.cpp -> cli."""
    folders = parts[:-1]
    return "/".join(folders[:2]) if folders[:1] == ("studio",) else folders[0] if folders else ""


def violations_in_apps(root):
    for path in sorted((root / "apps").rglob("*")):
        if path.suffix in SOURCES and "node_modules" not in path.parts:
            where = path.relative_to(root)
            yield from violations_in_room(path, where, room_of(path.relative_to(root / "apps").parts))


# Boost is compiled once, for the server of the studio, and named nowhere else.
MAY_NAME_BOOST = {"apps/studio/server/net.hpp"}


def boost_violations(root):
    for path in sorted(path for folder in ("src", "include", "apps") for path in (root / folder).rglob("*")):
        where = path.relative_to(root).as_posix()
        if path.suffix not in SOURCES or "node_modules" in path.parts or where in MAY_NAME_BOOST:
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if match and match.group(2).startswith("boost/"):
                yield f"{where}:{number}: includes {match.group(2)}; only apps/studio/server/net.hpp names Boost"
            if match and match.group(2) == "studio/server/net.hpp" and not where.startswith("apps/studio/server/"):
                yield f"{where}:{number}: includes {match.group(2)}, which brings Boost; the public header is server.hpp"


def find_violations(root):
    found = list(boost_violations(root)) + list(violations_in_apps(root))
    for path in sorted((root / "src").rglob("*")):
        if path.suffix not in SOURCES:
            continue
        parts = path.relative_to(root / "src").parts
        where = path.relative_to(root)
        folder = parts[0] if len(parts) > 1 else None
        if folder is not None and folder not in LAYERS:
            found.append(f"{where}: src/{folder} has no layer; say in tests/layers/check_layers.py what it may include")
            continue
        is_cuda = path.suffix in {".cu", ".cuh"}
        found += violations_in(path, where, LAYERS.get(folder), folder == "exec" or is_cuda, folder in {"core", "exec"})
    for path in sorted((root / "include").rglob("*.h*")):
        where = path.relative_to(root)
        found += violations_in(path, where, set(), False, False)
    return found


CLEAN = {
    "src/core/view.hpp": "#ifdef __CUDACC__\n#endif\n",
    "src/exec/cpu.cpp": '#include <oneapi/tbb/parallel_for.h>\n#include "core/view.hpp"\n#include <pointskin/a.hpp>\n',
    "src/surface/mesh.cu": '#include <cub/cub.cuh>\n#include "field/field.hpp"\n',
    "src/reconstruct.cpp": '#include "surface/mesh.hpp"\n#include "io/ply.hpp"\n',
    "include/pointskin/a.hpp": "#include <vector>\n#include <pointskin/b.hpp>\n",
    "apps/scene/a.cpp": '#include "json.hpp"\n#include "scene/b.hpp"\n#include <pointskin/a.hpp>\n',
    "apps/studio/server/a.cpp": '#include "studio/session/application.hpp"\n',
    "apps/studio/server/net.hpp": "#include <boost/asio.hpp>\n",
    "apps/studio/web/node_modules/a.hpp": "#include <boost/asio.hpp>\n",
    "apps/cli/a.cpp": '#include <CLI/CLI.hpp>\n#include "scene/b.hpp"\n',
}
PLANTED = {
    "src/core/a.hpp": '#include "exec/cpu.hpp"\n',
    "src/exec/a.hpp": '#include "octree/octree.hpp"\n',
    "src/octree/a.hpp": '#include "poisson/solve.hpp"\n',
    "src/poisson/a.hpp": '#include "surface/extract.hpp"\n',
    "src/io/a.cpp": '#include "octree/octree.hpp"\n',
    "src/mesh/a.cpp": "#include <oneapi/tbb/parallel_for.h>\n",
    "src/field/a.hpp": "#ifdef __CUDA_ARCH__\n#endif\n",
    "src/surface/a.cpp": '#include "surface.hpp"\n',
    "src/io/b.cpp": '#include "pointskin/io.hpp"\n',
    "src/octree/b.cpp": '#include "octree/search_impl.hpp"\n',
    "src/octree/c.hpp": '#include "exec/this_space.hpp"\n',
    "src/reconstruct.cpp": "#include <cuda_runtime.h>\n",
    "src/unheard_of/a.cpp": "\n",
    "apps/cli/a.cpp": "#include <boost/asio.hpp>\n",
    "apps/studio/cmd_studio.cpp": '#include "studio/server/net.hpp"\n',
    "include/pointskin/a.hpp": "#include <cuda_runtime.h>\n",
    "include/pointskin/b.hpp": '#include "core/view.hpp"\n',
    "apps/scene/a.hpp": '#include "cli/args.hpp"\n',
    "apps/studio/session/a.hpp": '#include "studio/server/server.hpp"\n',
    "apps/studio/session/b.cpp": "#include <boost/asio.hpp>\n",
    "apps/studio/server/a.hpp": '#include "studio/session/engine.hpp"\n',
    "apps/studio/wire/a.cpp": "#include <oneapi/tbb/parallel_for.h>\n",
    "apps/scene/b.cpp": "#include <CLI/CLI.hpp>\n",
}


def found_in_tree(files):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        return find_violations(root)


def self_test():
    failures = [f"clean tree: {line}" for line in found_in_tree(CLEAN)]
    for name, text in PLANTED.items():
        found = found_in_tree({name: text})
        if len(found) != 1 or not found[0].startswith(name):
            failures.append(f"{name} with {text!r}: expected one violation, found {found}")
    return failures


def main():
    if sys.argv[1:] == ["--self-test"]:
        found = self_test()
    else:
        here = pathlib.Path(__file__).resolve()
        found = find_violations(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here.parents[2])
    print("\n".join(found) if found else "layers: no violation")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
