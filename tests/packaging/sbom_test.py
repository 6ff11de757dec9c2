"""The SBOM is valid as far as SPDX 2.3 asks, names all that is linked, and is the same every time."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD, PROGRAM = os.environ["POINTSKIN_BUILD"], os.environ["POINTSKIN_PROGRAM"]
PACKAGED_BY_DPKG = pathlib.Path("/var/lib/dpkg/status").exists()
# Packages that build: brings, of which nothing comes into the program: they make it.
TOOLS = {"g++", "cmake", "ninja-build", "nodejs", "npm"}


def made(epoch="1700000000"):
    """The bytes of an SBOM of the build."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, ROOT / "packaging" / "make_sbom.py", BUILD, "1.2.3", folder], check=True,
                       capture_output=True, env={**os.environ, "SOURCE_DATE_EPOCH": epoch})
        return pathlib.Path(folder, "pointskin-1.2.3.spdx.json").read_bytes()


def owners_of(libraries):
    """The Debian packages of shared libraries; nothing for those that dpkg does not know."""
    names = {name for library in libraries for name in (library, os.path.realpath(library), "/usr" + library)}
    done = subprocess.run(["dpkg-query", "-S", *sorted(names)], capture_output=True, text=True, check=False)
    return {line.split(":")[0] for line in done.stdout.splitlines() if not line.startswith("diversion ")}


def is_installed(package):
    done = subprocess.run(["dpkg-query", "-W", "-f=${db:Status-Status}", package], capture_output=True, text=True, check=False)
    return done.stdout == "installed"


@unittest.skipUnless(PACKAGED_BY_DPKG, "versions and licences are looked up with dpkg")
class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bytes = made()
        cls.document = json.loads(cls.bytes)
        cls.packages = {package["name"]: package for package in cls.document["packages"]}

    def test_the_document_has_what_spdx_asks_for(self):
        for name in ("spdxVersion", "dataLicense", "SPDXID", "name", "documentNamespace", "creationInfo"):
            self.assertTrue(self.document[name], name)
        self.assertEqual(self.document["spdxVersion"], "SPDX-2.3")
        self.assertRegex(self.document["documentNamespace"], r"^https://[^#\s]+$")
        for package in self.document["packages"]:
            self.assertRegex(package["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertTrue(package["name"] and package["downloadLocation"] and package["versionInfo"])

    def test_names_are_unique_and_relations_name_what_is_there(self):
        names = [package["SPDXID"] for package in self.document["packages"]]
        self.assertEqual(len(names), len(set(names)))
        known = {*names, "SPDXRef-DOCUMENT"}
        for relation in self.document["relationships"]:
            self.assertLessEqual({relation["spdxElementId"], relation["relatedSpdxElement"]}, known)
        related = {relation["relatedSpdxElement"] for relation in self.document["relationships"]}
        self.assertEqual(related, set(names), "every package is described or belongs to one that is")

    def test_it_is_about_this_program(self):
        self.assertEqual(self.packages["pointskin"]["versionInfo"], "1.2.3")

    def test_every_library_that_the_program_loads_is_in_it(self):
        loaded = subprocess.run(["ldd", PROGRAM], capture_output=True, text=True, check=True).stdout
        owners = owners_of(re.findall(r"=> (/\S+)", loaded))
        self.assertGreater(len(owners), 3)
        self.assertLessEqual(owners, set(self.packages))

    def test_every_library_that_building_needs_is_in_it(self):
        """A -dev package counts as there if it is named, or the package that its library is in."""
        line = re.search(r"^build: *(.*)$", (ROOT / ".ci" / "packages").read_text(encoding="utf-8"), re.MULTILINE).group(1)
        needed = {need.split("=")[-1] for need in line.split()} - TOOLS
        for package in sorted(filter(is_installed, needed)):
            stem = re.sub(r"-dev$", "", package).rstrip("0123456789.")
            self.assertTrue(any(name == package or name.startswith(stem) for name in self.packages), package)

    def test_versions_are_those_that_are_installed(self):
        version = subprocess.run(["dpkg-query", "-W", "-f=${Version}", "libc6"], capture_output=True, text=True, check=True)
        self.assertEqual(self.packages["libc6"]["versionInfo"], version.stdout)

    def test_the_same_build_gives_the_same_bytes(self):
        self.assertEqual(made(), self.bytes)

    def test_the_name_space_tells_documents_apart(self):
        self.assertNotEqual(json.loads(made("1700000001"))["documentNamespace"], self.document["documentNamespace"])


if __name__ == "__main__":
    unittest.main()
