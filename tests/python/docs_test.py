"""The examples of docs/python.md run, one after another, as they stand there."""
import contextlib
import io
import os
import pathlib
import re
import warnings

from common import Case, ps, unittest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"


class Docs(Case):
    def test_examples_run(self):
        blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
        self.assertGreaterEqual(len(blocks), 7)
        names = {}
        before = os.getcwd()
        os.chdir(self.folder)
        try:
            for number, block in enumerate(blocks):
                with self.subTest(block.split("\n")[0]), warnings.catch_warnings():
                    warnings.simplefilter("error", ps.PointskinWarning)
                    if "weakness=True" in block:
                        warnings.simplefilter("default", ps.PointskinWarning)
                    said = io.StringIO()
                    with contextlib.redirect_stdout(said):
                        exec(compile(block, f"{PAGE.name}, example {number + 1}", "exec"), names)
                    expected = re.findall(r"^print\(.*?\) +# (.*)$", block, re.MULTILINE)
                    self.assertEqual(said.getvalue().splitlines(), expected)
        finally:
            os.chdir(before)

    def test_the_exceptions_of_the_table_are_those_that_there_are(self):
        rows = re.findall(r"^\| `(\w+)` \|(?: `(\w+)`)? \| (\d+) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(len(rows), 8)
        for name, also, code in rows:
            kind = getattr(ps, name)
            self.assertEqual(kind.code, int(code), name)
            if also:
                self.assertTrue(issubclass(kind, getattr(__builtins__, also) if hasattr(__builtins__, also) else __builtins__[also]), name)


if __name__ == "__main__":
    unittest.main()
