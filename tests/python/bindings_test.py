"""What Python believes about the C interface is what the compiler says."""
import ctypes
import pathlib
import subprocess
import sys

from common import Case, unittest
from pointskin import _c
from pointskin._library import library

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Bindings(Case):
    def test_are_made_of_the_header_as_it_is(self):
        done = subprocess.run([sys.executable, ROOT / "python" / "make_bindings.py", "--check"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_structs_lie_as_the_compiler_lays_them(self):
        lines = (ROOT / "tests" / "abi" / "layout.txt").read_text().split("\n")
        seen = 0
        for line in filter(None, lines):
            name, *numbers = line.split()
            if "." in name:
                struct, member = name.split(".")
                field = getattr(getattr(_c, struct), member)
                self.assertEqual([field.offset, field.size], [int(number) for number in numbers], name)
            else:
                self.assertEqual(ctypes.sizeof(getattr(_c, name)), int(numbers[0]), name)
            seen += 1
        self.assertGreater(seen, 300)

    def test_sizes_are_those_of_the_library_that_was_loaded(self):
        for struct, kind in _c.KINDS.items():
            self.assertEqual(ctypes.sizeof(struct), library().psk_struct_size(kind), struct.__name__)


if __name__ == "__main__":
    unittest.main()
