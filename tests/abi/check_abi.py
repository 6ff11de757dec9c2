#!/usr/bin/env python3
"""Checks what other programs were compiled against: the symbols of the shared library, and the structs of C.

    check_abi.py symbols LIBRARY            what `nm` lists is what symbols.txt says
    check_abi.py layout CC INCLUDE FOLDER   sizes and offsets, as the compiler CC has them, are those of layout.txt
    check_abi.py layout-members INCLUDE     prints the lines of layout_members.inc, from c.h itself
    ... --update                            writes the list anew: a line that is gone or changed breaks callers

A line that is added needs --update and a look. A line that is removed or changed needs a new PSK_C_ABI and a new soname.
"""
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent


def structs_of(header):
    """[(name, [members])] of every `typedef struct NAME { ... } NAME;` of the text of c.h."""
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
    structs = []
    for match in re.finditer(r"typedef struct (\w+) \{(.*?)\} \1;", text, re.DOTALL):
        members = []
        for declaration in match.group(2).split(";"):
            declaration = " ".join(declaration.split())
            if declaration:
                names = re.sub(r"^(const )?\w+( const)?\s*\*?\s*", "", declaration, count=1)
                members += [re.sub(r"[\s*]|\[.*", "", name) for name in names.split(",")]
        structs.append((match.group(1), members))
    return structs


def member_lines(include):
    header = (pathlib.Path(include) / "pointskin" / "c.h").read_text(encoding="utf-8")
    lines = []
    for name, members in structs_of(header):
        lines.append(f"STRUCT({name});")
        lines += [f"MEMBER({name}, {member});" for member in members]
    return lines


def layout(compiler, include, folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "layout_members.inc").write_text("\n".join(member_lines(include)) + "\n", encoding="utf-8")
    program = folder / "layout"
    subprocess.run([compiler, "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I", include, "-I", folder,
                    HERE / "layout.c", "-o", program], check=True)
    return subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()


def symbols(library):
    listing = subprocess.run(["nm", "-D", "-C", "--defined-only", library], check=True, capture_output=True, text=True)
    found = {re.sub(r"^[0-9a-f]+ ", "", line) for line in listing.stdout.splitlines()}
    return sorted(line for line in found if not line.startswith("A "))


def compare(found, file, update):
    if update:
        file.write_text("\n".join(found) + "\n", encoding="utf-8")
        print(f"{file.name}: {len(found)} lines")
        return 0
    known = file.read_text(encoding="utf-8").splitlines()
    gone, new = [line for line in known if line not in set(found)], [line for line in found if line not in set(known)]
    for line in gone:
        print(f"{file.name}: gone or changed: {line}")
    for line in new:
        print(f"{file.name}: new: {line}")
    if not gone and not new:
        print(f"{file.name}: {len(found)} lines, as they were")
    return 1 if gone or new else 0


def main(arguments):
    update = "--update" in arguments
    arguments = [argument for argument in arguments if argument != "--update"]
    if arguments[:1] == ["symbols"]:
        return compare(symbols(arguments[1]), HERE / "symbols.txt", update)
    if arguments[:1] == ["layout"]:
        return compare(layout(*arguments[1:4]), HERE / "layout.txt", update)
    if arguments[:1] == ["layout-members"]:
        print("\n".join(member_lines(arguments[1])))
        return 0
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
