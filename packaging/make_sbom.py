#!/usr/bin/env python3
"""Lists what a build is made of: make_sbom.py BUILD VERSION DIST. SPDX 2.3, JSON.

Debian packages whose shared libraries are loaded or whose headers and archives are compiled in, and the npm packages that the
page of the studio bundles, with versions and licences, from what is installed and from the lock file."""
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

import bundle

ROOT = pathlib.Path(__file__).resolve().parents[1]
COMPILED_IN = ("libfmt-dev", "libcli11-dev", "nlohmann-json3-dev", "libboost1.81-dev", "libmeshoptimizer-dev", "libpugixml-dev",
               "liblzf-dev", "libminizip-dev")
NPM = ROOT / "apps" / "studio" / "web" / "package-lock.json"


def query(*arguments):
    done = subprocess.run(["dpkg-query", *arguments], capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else ""


def licences_of(package):
    """The licences that /usr/share/doc/PACKAGE/copyright names, as SPDX has them where they are plain."""
    file = pathlib.Path("/usr/share/doc", package, "copyright")
    if not file.exists():
        return "NOASSERTION"
    names = re.findall(r"^License: (\S+)", file.read_text(encoding="utf-8", errors="replace"), re.MULTILINE)
    known = {"Expat": "MIT", "MIT": "MIT", "Apache-2.0": "Apache-2.0", "Zlib": "Zlib", "zlib": "Zlib", "BSL-1.0": "BSL-1.0",
             "Boost-1.0": "BSL-1.0", "BSD-2-clause": "BSD-2-Clause", "BSD-3-clause": "BSD-3-Clause", "libpng": "libpng-2.0"}
    return known.get(names[0], "NOASSERTION") if names else "NOASSERTION"


def debian(name, relation):
    version = query("-W", "-f=${Version}", name)
    return None if not version else {
        "relation": relation, "name": name, "versionInfo": version, "licenseDeclared": licences_of(name),
        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                          "referenceLocator": f"pkg:deb/debian/{name}@{version}"}]}


def loaded(build):
    """Debian packages of the shared libraries that program and library load."""
    candidates = set()
    for file in (build / "bin" / "pointskin", build / "lib" / "libpointskin.so.0"):
        for path in filter(None, bundle.needed(file).values()):
            candidates |= {path, str(pathlib.Path(path).resolve()), path.replace("/lib/", "/usr/lib/", 1)}
    # One search for all: each reads the lists of every package. It fails for the names that no package owns.
    done = subprocess.run(["dpkg-query", "-S", *sorted(candidates)], capture_output=True, text=True, check=False)
    return sorted({line.split(":")[0] for line in done.stdout.splitlines() if not line.startswith("diversion ")})


def npm_packages(build):
    """What the page bundles; nothing where the studio was left out."""
    if "POINTSKIN_STUDIO_BUILT:INTERNAL=ON" not in (build / "CMakeCache.txt").read_text(encoding="utf-8"):
        return []
    lock = json.loads(NPM.read_text(encoding="utf-8"))["packages"]
    return [{"relation": "CONTAINS", "name": name.split("node_modules/")[-1], "versionInfo": entry["version"],
             "licenseDeclared": entry.get("license", "NOASSERTION"),
             "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                               "referenceLocator": f"pkg:npm/{name.split('node_modules/')[-1].replace('@', '%40')}@{entry['version']}"}]}
            for name, entry in sorted(lock.items()) if name and not entry.get("dev")]


def main(build, version, dist):
    build = pathlib.Path(build)
    parts = [debian(name, "DYNAMIC_LINK") for name in loaded(build)]
    parts += [debian(name, "STATIC_LINK") for name in COMPILED_IN] + npm_packages(build)
    parts = [part for part in parts if part]
    moment = datetime.datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), datetime.timezone.utc)
    packages = [{"SPDXID": "SPDXRef-pointskin", "name": "pointskin", "versionInfo": version, "downloadLocation": "NOASSERTION",
                 "filesAnalyzed": False, "licenseConcluded": "MIT", "licenseDeclared": "MIT", "copyrightText": "The Pointskin authors"}]
    relations = [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-pointskin"}]
    for part in parts:
        identifier = "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", f"{part['name']}-{part['versionInfo']}")
        relations.append({"spdxElementId": "SPDXRef-pointskin", "relationshipType": part.pop("relation"),
                          "relatedSpdxElement": identifier})
        packages.append({"SPDXID": identifier, "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
                         "licenseConcluded": "NOASSERTION", "copyrightText": "NOASSERTION", **part})
    document = {"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"pointskin-{version}",
                "creationInfo": {"created": moment.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: pointskin-make_sbom"]},
                "packages": packages, "relationships": relations}
    # Other contents have another name space, as SPDX asks, and the same contents the same.
    digest = hashlib.sha256(json.dumps(document).encode()).hexdigest()
    document["documentNamespace"] = f"https://spdx.org/spdxdocs/pointskin-{version}-{digest[:32]}"
    target = pathlib.Path(dist) / f"pointskin-{version}.spdx.json"
    target.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    print(f"{target}: {len(packages) - 1} parts")


if __name__ == "__main__":
    main(*sys.argv[1:])
