"""The add-on, in Blender without a window."""
import pathlib
import shutil
import subprocess

from common import Case, unittest


class AddOn(Case):
    @unittest.skipUnless(shutil.which("blender"), "blender is not installed")
    def test_in_blender(self):
        script = pathlib.Path(__file__).resolve().parent / "blender_add_on.py"
        done = subprocess.run(["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", script],
                              capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("the add-on works", done.stdout)


if __name__ == "__main__":
    unittest.main()
