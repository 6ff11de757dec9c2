"""Manual pages and completion are what man and the shells understand. Tools that are missing are skipped, with their names."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["POINTSKIN_PROGRAM"]


def run(*command, stdin="", **more):
    return subprocess.run(command, input=stdin, capture_output=True, text=True, check=False, timeout=60, **more)


def program(*arguments):
    done = run(PROGRAM, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def needs(tool):
    return unittest.skipUnless(shutil.which(tool), f"{tool} is not installed")


def commands():
    text = program("--help")
    return re.findall(r"^  ([a-z]+) ", text[text.index("Commands:"):], re.MULTILINE)


class Pages(unittest.TestCase):
    def test_have_every_option_of_the_help(self):
        for command in commands():
            options = set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", program(command, "--help"), re.MULTILINE))
            page = program("manual", command).replace("\\-", "-")
            for option in options:
                self.assertIn(f"\\fB{option}\\fR", page, command)

    @needs("mandoc")
    def test_are_right_to_mandoc(self):
        for command in ["", *commands()]:
            done = run("mandoc", "-Tlint", "-Wwarning", stdin=program("manual", *filter(None, [command])))
            faults = [line for line in done.stdout.splitlines() if "missing date" not in line]
            self.assertEqual(faults, [], command)

    @needs("man")
    def test_are_shown_by_man(self):
        with tempfile.NamedTemporaryFile("w", suffix=".1") as page:
            page.write(program("manual", "reconstruct"))
            page.flush()
            done = run("man", "--warnings", "-l", page.name, env={**os.environ, "MANPAGER": "cat", "MANWIDTH": "80"})
        self.assertEqual(done.stderr, "")
        self.assertIn("pointskin-reconstruct - Fit a watertight mesh to oriented points", done.stdout)


class Completion(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.folder = pathlib.Path(self._folder.name)

    def script(self, shell, name):
        path = self.folder / name
        path.write_text(program("completion", shell), encoding="utf-8")
        return path

    @needs("bash")
    def test_of_bash(self):
        (self.folder / "scan.ply").touch()
        script = self.script("bash", "pointskin")
        ask = (f". {script}; complete -p pointskin; "
               "t() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _pointskin; echo \"${COMPREPLY[*]}\"; }; "
               "t pointskin rec; t pointskin reconstruct --dep; t pointskin orient sc; t pointskin help ori")
        done = run("bash", "--norc", "-c", ask, cwd=self.folder)
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.stdout.splitlines(),
                         ["complete -F _pointskin pointskin", "reconstruct", "--depth", "scan.ply", "orient"])

    @needs("zsh")
    def test_of_zsh(self):
        script = self.script("zsh", "_pointskin")
        self.assertEqual(run("zsh", "-n", str(script)).stderr, "")
        done = run("zsh", "-f", "-c", f"fpath=({self.folder} $fpath); autoload -U compinit; compinit -u -D; print -r -- $_comps[pointskin]")
        self.assertEqual(done.stdout.strip(), "_pointskin", done.stderr)

    @needs("fish")
    def test_of_fish(self):
        script = self.script("fish", "pointskin.fish")
        env = {**os.environ, "HOME": str(self.folder)}
        for typed, expected in (("pointskin rec", "reconstruct"), ("pointskin reconstruct --dep", "--depth")):
            done = run("fish", "--no-config", "-c", f"source {script}; complete -C '{typed}'", env=env)
            self.assertTrue(done.stdout.startswith(expected), f"{typed}: {done.stdout} {done.stderr}")

    def test_of_another_shell_is_refused(self):
        done = run(PROGRAM, "completion", "tcsh")
        self.assertEqual(done.returncode, 2)
        self.assertIn("bash, zsh and fish, not for tcsh", done.stderr)


if __name__ == "__main__":
    unittest.main()
