"""Runs programs over clouds and measures their meshes. What was done is recorded beside each file."""
import hashlib
import json
import pathlib
import subprocess
import sys
import time

from cases import point_count

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import normals  # noqa: E402  of bench/


class Failed(Exception):
    """A program did not do its work; the message says which and why."""


def run(words, timeout):
    """Runs a program quietly. Returns its output and the wall clock in seconds."""
    begin = time.monotonic()
    try:
        done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                              timeout=timeout, check=False)
    except subprocess.TimeoutExpired:
        raise Failed(f"{words[0]}: no end after {timeout:g} s") from None
    except OSError as error:
        raise Failed(f"{words[0]}: {error.strerror}") from None
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()[-1:]
        raise Failed(f"{words[0]}: exit code {done.returncode}{': ' if said else ''}{''.join(said)}")
    return done.stdout, time.monotonic() - begin


def fill(words, **values):
    """Replaces {name} inside of each word."""
    for name, value in values.items():
        words = [word.replace("{" + name + "}", str(value)) for word in words]
    return words


def digest(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest() if hasattr(hashlib, "file_digest") else \
            hashlib.sha256(file.read()).hexdigest()


def read_record(path):
    try:
        return json.loads(pathlib.Path(f"{path}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def write_record(path, record):
    pathlib.Path(f"{path}.json").write_text(json.dumps(record, indent=1), encoding="utf-8")


class Bench:
    """Clouds, meshes and their measures in one folder."""

    def __init__(self, folder, metrics_words, threads, timeout):
        self.folder, self.metrics_words, self.threads, self.timeout = folder, metrics_words, threads, timeout

    def cloud(self, case, reuse):
        """The file of the case's cloud, generated unless `reuse` finds it there, from the same command."""
        if not case.generate:
            return case.cloud
        path = self.folder / f"{case.name}.ply"
        if reuse and path.exists() and read_record(path).get("command") == case.generate[1:]:
            return path
        run(fill(case.generate, out=path), self.timeout)
        write_record(path, {"command": case.generate[1:]})
        return path

    def orient(self, case, cloud, program):
        """The cloud with normals that `program orient` found, and the share of them on the side of those that were taken away."""
        bare, oriented = (self.folder / f"{case.name}-{kind}.ply" for kind in ("bare", "oriented"))
        positions, given = normals.read_ply(cloud)
        normals.write_ply(bare, positions, None)
        run([program, "orient", str(bare), "-o", str(oriented), "--threads", str(self.threads), "-q", "--overwrite"], self.timeout)
        return oriented, normals.right_share(normals.read_ply(oriented)[1], given)

    def result(self, case, cloud, program, depth, reuse):
        """Runs `program` = (name, words) and measures its mesh: {"seconds", "metrics"} or {"failed"}.

        With `reuse` the run is left out if its record names the same command and cloud, and the measuring too if it
        would be the same. The folder may have been moved or copied in between.
        """
        name, words = program
        mesh = self.folder / f"{case.name}-{name}-{depth}.ply"
        key = {"command": words, "depth": depth, "threads": self.threads, "cloud": digest(cloud)}
        words = fill(words, **{"in": cloud, "out": mesh, "depth": depth, "threads": self.threads})
        record = read_record(mesh) if reuse else {}
        try:
            if not mesh.exists() or {k: record.get(k) for k in key} != key:
                mesh.unlink(missing_ok=True)
                record = {**key, "seconds": run(words, self.timeout)[1]}
                if not mesh.exists():
                    raise Failed(f"{words[0]}: left no mesh")
            self.measure(case, cloud, mesh, record)
        except Failed as failure:
            return {"failed": str(failure)}
        write_record(mesh, record)
        return {"seconds": record["seconds"], "metrics": record["metrics"]}

    def measure(self, case, cloud, mesh, record):
        program, *options = self.metrics_words
        options += [*case.truth, "--points", str(point_count(cloud))]
        if record.get("measured") != options or "metrics" not in record:
            record["metrics"] = json.loads(run([program, str(mesh), *options], self.timeout)[0])
            record["measured"] = options
