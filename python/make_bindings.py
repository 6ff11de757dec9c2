#!/usr/bin/env python3
"""Makes python/pointskin/_c.py from include/pointskin/c.h: constants, structs and functions for ctypes.

    make_bindings.py             writes the file
    make_bindings.py --check     exit 1 if the file is not what it would write

It understands the C that c.h is written in, no more: one typedef a struct, one line of enumerators or several, functions
that begin with PSK_C_API.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
HEADER = ROOT / "include" / "pointskin" / "c.h"
TARGET = ROOT / "python" / "pointskin" / "_c.py"

HEAD = '''"""The C interface of the library, for ctypes. Made by python/make_bindings.py from include/pointskin/c.h."""
from ctypes import (CFUNCTYPE, POINTER, Structure, c_char, c_char_p, c_double, c_float, c_int32, c_int64, c_size_t, c_uint8,
                    c_uint64, c_void_p)

psk_progress = CFUNCTYPE(c_int32, c_char_p, c_double, c_void_p)
'''

PLAIN = {"int32_t": "c_int32", "int64_t": "c_int64", "uint64_t": "c_uint64", "uint8_t": "c_uint8", "size_t": "c_size_t",
         "double": "c_double", "float": "c_float", "char": "c_char", "psk_code": "c_int32", "psk_progress": "psk_progress"}


class Types:
    """What the names of types stand for."""

    def __init__(self, structs):
        self.structs = structs

    def of(self, text):
        """The ctypes expression for a C type such as `const double*`."""
        text = text.replace("const", "")
        stars = text.count("*")
        name = text.replace("*", "").strip()
        if stars == 0:
            return "None" if name == "void" else PLAIN.get(name, name)
        if name == "char" and stars == 1:
            return "c_char_p"
        if name == "void" or (name not in PLAIN and name not in self.structs):  # handles
            return "c_void_p" if stars == 1 else "POINTER(c_void_p)"
        inner = PLAIN.get(name, name)
        return f"POINTER({inner})" if stars == 1 else f"POINTER(POINTER({inner}))"


def enumerators(text):
    constants = []
    for body in re.findall(r"enum \{(.*?)\};", text, re.DOTALL):
        constants += re.findall(r"(PSK_\w+) = (-?\d+)", body)
    return constants


def split_declaration(declaration):
    """[(C type, name, length or None)] of `const double *a, *b` or `double view[16], width`."""
    match = re.match(r"((?:const )?\w+(?: const)?)\s*(.*)$", declaration)
    base, rest = match.group(1), match.group(2)
    members = []
    for name in rest.split(","):
        stars, name, length = re.match(r"\s*(\**)\s*(\w+)(?:\[(\d+)\])?\s*$", name).groups()
        members.append((base + stars, name, int(length) if length else None))
    return members


def struct_lines(name, body, types):
    fields = []
    for declaration in body.split(";"):
        declaration = " ".join(declaration.replace("*", "* ").split()).replace(" *", "*").replace("* ", "* ")
        if not declaration:
            continue
        for c_type, member, length in split_declaration(declaration):
            code = types.of(c_type)
            fields.append(f'        ("{member}", {code}{f" * {length}" if length else ""}),')
    return [f"class {name}(Structure):", "    _fields_ = (", *fields, "    )", ""]


def function_line(text, types):
    match = re.match(r"(.*?)\b(psk_\w+)\((.*)\)$", " ".join(text.split()))
    result, name, arguments = match.groups()
    codes = []
    for argument in arguments.split(","):
        argument = argument.strip()
        if argument == "void":
            continue
        argument = re.sub(r"\[\d+\]$", "*", re.sub(r"(\w+)(\[\d+\])$", r"\2", argument)) if "[" in argument else \
            re.sub(r"\w+$", "", argument)
        codes.append(types.of(argument))
    return f'    "{name}": ({types.of(result)}, ({", ".join(codes)}{"," if len(codes) == 1 else ""})),'


def bindings(header):
    text = re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)
    structs = re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", text, re.DOTALL)
    types = Types({name for name, _ in structs})
    lines = HEAD.splitlines() + [""]
    lines += [f"{name} = {value}" for name, value in enumerators(text)] + ["", ""]
    for name, body in structs:
        lines += struct_lines(name, body, types) + [""]
    lines += ["#: Result and arguments of every function.", "FUNCTIONS = {"]
    lines += [function_line(function, types) for function in re.findall(r"^PSK_C_API (.*?);", text, re.DOTALL | re.MULTILINE)]
    kinds = [(name, value) for name, value in enumerators(text) if name.startswith("PSK_STRUCT_") and name != "PSK_STRUCT_COUNT"]
    by_kind = [(name, "psk_" + name[len("PSK_STRUCT_"):].lower()) for name, _ in kinds]
    lines += ["}", "", "#: The kind of every struct that knows its size.", "KINDS = {"]
    lines += [f"    {struct}: {kind}," for kind, struct in by_kind] + ["}"]
    return "\n".join(lines) + "\n"


def main():
    made = bindings(HEADER.read_text(encoding="utf-8"))
    if "--check" in sys.argv[1:]:
        if not TARGET.exists() or TARGET.read_text(encoding="utf-8") != made:
            print("python/pointskin/_c.py is not what include/pointskin/c.h says; run python/make_bindings.py")
            return 1
        print("python/pointskin/_c.py is what include/pointskin/c.h says")
        return 0
    TARGET.write_text(made, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
