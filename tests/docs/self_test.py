"""A small repository whose documents are right, and one fault of every kind planted into it."""
import pathlib
import tempfile

CLEAN = {
    "README.md": """# Program

See [the steps](docs/steps.md#how-it-works), [0001](docs/decisions/0001-one.md) and [elsewhere](https://example.org/x).

`pointskin fit scan.ply -o 'out_{}.ply' --trim 0.05` fits; `build/bin/pointskin` is the program. `POINTSKIN_TEST_DATA=folder`

    build/bin/pointskin fit scan.ply --trim auto  # and --this is a comment
    pointskin fit a.ply --peer 'Other --in {in}'

`src/octree/*.hpp`, `octree/{build,keys}.hpp`, `keys.hpp`, `X.hpp`, `src/<room>/<step>.hpp`, `<pointskin/fit.hpp>`,
`/dev/null`, `frames/frame_{}.vtk`, `.ply`, `_bytes`, `input_`
""",
    "CHANGELOG.md": "## [Unreleased]\n\n- `--trim`\n\n## [0.1.0]\n\n- `--option-of-old`, `GoneType`\n",
    "docs/steps.md": """# Steps

## How it works

`Octree::build`, `Build` and `kFaces` in `octree/build.hpp`, `std::vector<Foo>`, `x`, `FILE`; kFaces = 2, kHalf = 1/2, two sweeps.
""",
    "docs/decisions/0001-one.md": "# 0001 One\n\n`fit()` and `double-dam`\n",
    "docs/paper.md": "| model | points | depth | total | memory |\n|---|---|---|---|---|\n| Bunny, here | 10 | 8 | 1.5 ms | 2 MB |\n",
    "docs/performance.md":
        "| points | depth | median | peak on the device |\n|---|---|---|---|\n| bunny, 10 | 8 | 1.5, 1.6 ms | 2 MB |\n",
    "CMakeLists.txt": "add_executable(pointskin)\nset(POINTSKIN_TEST_DATA)\n",
    "apps/cli/cmd_fit.cpp": 'make_command({"fit", "-o --trim --peer auto folder ply double dam"});  // see octree/build.hpp\n',
    "include/pointskin/fit.hpp": "void fit(int max_bytes, int input_x);\n",
    "src/octree/build.hpp":
        "struct Octree { void build(); }; struct Build;\nint kFaces = 2; double kHalf = 0.5; int kSweeps = 2;\n// Ghost\n",
    "src/octree/keys.hpp": "struct Keys;\n",
}
# What is added to a file, and a part of the one line that is expected.
PLANTED = [
    ("README.md", "`src/octree/gone.hpp`\n", "src/octree/gone.hpp: there is no"),
    ("README.md", "`octree/{build,gone}*.cpp`\n", "there is no such file"),
    ("README.md", "`docs/report.json`\n", "docs/report.json: there is no"),
    ("README.md", "`build/bin/pointskim`\n", "nothing builds it"),
    ("README.md", "`Octree::rebuild`\n", "no rebuild"),
    ("README.md", "`Octree::fit`\n", "has both parts"),
    ("README.md", "`Ghost`\n", "no Ghost"),
    ("README.md", "`kGone` and `fit`\n", "no kGone"),
    ("README.md", "`is_gone(x)`\n", "no is_gone"),
    ("README.md", "`double-gone`\n", "no double-gone"),
    ("README.md", "`gone_`\n", "no gone_"),
    ("README.md", "`POINTSKIN_GONE=1`\n", "no POINTSKIN_GONE"),
    ("README.md", "`-DPOINTSKIN_GONE=1`\n", "no POINTSKIN_GONE"),
    ("README.md", "`fit --gone`\n", "--gone: no program"),
    ("README.md", "`--gone[=METHOD]`\n", "--gone: no program"),
    ("README.md", "`pointskin gone`\n", "no such command"),
    ("README.md", "\n    pointskin gone a.ply\n", "no such command"),
    ("README.md", "\n    pointskin fit a.ply --gone\n", "--gone: no program"),
    ("README.md", "[a](docs/gone.md)\n", "leads nowhere"),
    ("README.md", "[a](docs/steps.md#how-it-does-not)\n", "no such heading"),
    ("README.md", "[0002](docs/decisions/0001-one.md)\n", "opens 0001-one.md"),
    ("README.md", "[decision 2](docs/decisions/0001-one.md)\n", "opens 0001-one.md"),
    ("README.md", "`Build`,\n`Keys` in `octree/keys.hpp`\n", "keys.hpp has no Build"),
    ("README.md", "six sweeps\n", "kSweeps is"),
    ("docs/steps.md", "\n    h = kFaces = 3\n", "kFaces = 3: the sources say"),
    ("docs/steps.md", "kHalf = 1/3\n", "kHalf = 1/3: the sources say"),
    ("docs/decisions/0001-one.md", "`Gone`\n", "no Gone"),
    ("docs/decisions/0002-two.md", "# 2. Two\n", "does not begin with # 0002"),
    ("docs/paper.md", "| Bunny, here | 10 | 8 | 1.7 ms | 2 MB |\n", "1.7 ms, but 1.5, 1.6 ms"),
    ("docs/paper.md", "| Bunny, here | 10 | 8 | 1.6 ms | 3 MB |\n", "3 MB, but 2 MB"),
    ("docs/paper.md", "| Bunny, here | 10 | 9 | 1.6 ms | 2 MB |\n", "no such run"),
    ("src/octree/keys.hpp", "// as in octree/gone.hpp\n", "octree/gone.hpp: there is no such file"),
]


def found_with(find_faults, name, text):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for file, content in {**CLEAN, name: CLEAN.get(name, "") + text}.items():
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            (root / file).write_text(content, encoding="utf-8")
        return find_faults(root)


def failures(find_faults):
    found = [f"clean tree: {line}" for line in found_with(find_faults, "README.md", "")]
    for name, text, expected in PLANTED:
        faults = found_with(find_faults, name, text)
        if len(faults) != 1 or expected not in faults[0]:
            found.append(f"{name} with {text!r}: expected one fault with {expected!r}, found {faults}")
    return found
