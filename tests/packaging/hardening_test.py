"""The program and the library are linked as releases should be: an overrun of a buffer stops the process, and what the loader has
filled in cannot be written afterwards."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

PROGRAM, LIBRARY, COMPILER = (os.environ.get("POINTSKIN_" + name, "") for name in ("PROGRAM", "LIBRARY", "COMPILER"))


def readelf(file):
    """Header, segments, dynamic section and dynamic symbols of an ELF file, as text."""
    command = ["readelf", "--wide", "--file-header", "--program-headers", "--dynamic", "--dyn-syms", str(file)]
    return subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "LC_ALL": "C"}).stdout


def faults(file, is_program):
    """What `file` lacks, one word each."""
    text, found = readelf(file), []
    if not re.search(r"^ *Type: *DYN", text, re.MULTILINE) or (is_program and not re.search(r"Flags:.*\bPIE\b", text)):
        found.append("PIE")
    if not re.search(r"\(FLAGS\).*BIND_NOW|\(FLAGS_1\).*\bNOW\b|\(BIND_NOW\)", text):
        found.append("BIND_NOW")
    if not re.search(r"^ *GNU_RELRO ", text, re.MULTILINE):
        found.append("GNU_RELRO")
    if "__stack_chk_fail" not in text:
        found.append("stack protector")
    if not re.search(r" __\w+_chk@", text.replace("__stack_chk_fail", "")):
        found.append("fortified calls")
    stack = re.search(r"^ *GNU_STACK .* (R\w*) ", text, re.MULTILINE)
    if stack is None or "E" in stack.group(1):
        found.append("a stack that cannot be executed")
    return found


class Hardening(unittest.TestCase):
    def test_the_program_lacks_nothing(self):
        self.assertEqual(faults(PROGRAM, True), [])

    @unittest.skipUnless(LIBRARY, "the shared library was not built")
    def test_the_library_lacks_nothing(self):
        self.assertEqual(faults(LIBRARY, False), [])

    @unittest.skipUnless(COMPILER, "no compiler is named")
    def test_a_program_without_all_of_it_is_found_out(self):
        with tempfile.TemporaryDirectory() as folder:
            source, plain = pathlib.Path(folder, "plain.cpp"), pathlib.Path(folder, "plain")
            source.write_text("int main() { return 0; }\n", encoding="utf-8")
            subprocess.run([COMPILER, source, "-o", plain, "-no-pie", "-fno-pie", "-fno-stack-protector",
                            "-Wl,-z,norelro,-z,lazy,-z,execstack"], check=True, capture_output=True)
            self.assertEqual(faults(plain, True), ["PIE", "BIND_NOW", "GNU_RELRO", "stack protector", "fortified calls",
                                                   "a stack that cannot be executed"])


if __name__ == "__main__":
    unittest.main()
