"""The tutorial runs, and makes its pictures."""
import pathlib
import subprocess
import sys

from common import Case, unittest

TUTORIAL = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python" / "tutorial.py"


class Tutorial(Case):
    def test_runs(self):
        done = subprocess.run([sys.executable, "-W", "error", TUTORIAL, self.folder], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        pictures = sorted(path.name for path in self.folder.glob("*.png"))
        self.assertEqual(pictures, ["python_drilled.png", "python_error.png", "python_scan.png", "python_surface.png"])
        self.assertIn("mean distance", done.stdout)


if __name__ == "__main__":
    unittest.main()
