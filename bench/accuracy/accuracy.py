#!/usr/bin/env python3
"""How close meshes come to the truth, beside another program where one is given. See docs/accuracy.md.

    bench/accuracy/accuracy.py --peer 'PoissonRecon --in {in} --out {out} --depth {depth}' --depths 8,9
"""
import argparse
import json
import math
import pathlib
import shlex
import sys
import tempfile

import cases
import programs
import verdict

BEGIN, END = "<!-- results: begin -->", "<!-- results: end -->"
ROOT = pathlib.Path(__file__).resolve().parents[2]


def whole_numbers(text):
    return [int(word) for word in text.split(",")]


def parse(words):
    parser = argparse.ArgumentParser(description="Prints a Markdown table of the accuracy of meshes.",
                                     formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    add = parser.add_argument
    add("--cases", metavar="PATTERN,...", default="*", help="run only cases with such a name, as in 'gyroid-*,srb_*'")
    add("--list", action="store_true", help="print the names of the cases and end")
    add("--data", metavar="FOLDER", type=pathlib.Path,
        help="also every NAME.ply with normals of this folder, with NAME_gt.ply as the truth, and scans of the truth")
    add("--depths", metavar="D,...", type=whole_numbers, default=[8], help="octree depths")
    add("--points", type=int, help="points of every generated cloud, instead of the usual number")
    add("--seed", type=int, default=1, help="of the generated clouds")
    add("--bin", type=pathlib.Path, default=ROOT / "build/bin", help="folder of the programs")
    add("--program", metavar="PATH", type=pathlib.Path, help="another build of pointskin to judge (default: of --bin)")
    add("--options", metavar="WORDS", default="", help="options for pointskin reconstruct")
    add("--without-normals", action="store_true",
        help="take the normals of every cloud away; both programs get those that pointskin orient finds")
    add("--peer", metavar="CMD", help="another program; {in}, {out}, {depth} and {threads} are replaced, no shell runs")
    add("--equal-triangles", action="store_true",
        help="also compare with the peer at the same number of triangles, between its depths")
    add("--keep", metavar="FOLDER", type=pathlib.Path, help="keep clouds, meshes and measures there")
    add("--reuse-peer", action="store_true", help="do not run the peer again where --keep has its result")
    add("--samples", type=int, default=500_000, help="points drawn on either surface to measure distances")
    add("--tau", type=float, default=0.001, help="threshold of the F-score, as a fraction of the diagonal")
    add("--tolerance", type=float, default=0.005, help="how much worse, relatively, still counts as not worse")
    add("--threads", type=int, default=0, help="of our programs and for {threads}; 0: all")
    add("--timeout", metavar="SECONDS", type=float, default=1800, help="of one run of a program")
    add("--update", metavar="FILE", type=pathlib.Path,
        help=f"put the table into this text, between {BEGIN} and {END}")
    add("--brief", action="store_true",
        help="with --update: one row a case instead, ours over the peer's, losses first")
    add("--json", metavar="FILE", type=pathlib.Path, help="write everything that was measured, and wall clocks")
    options = parser.parse_args(words)
    if options.peer and not all(name in options.peer for name in ("{in}", "{out}")):
        parser.error("--peer needs {in} and {out}")
    if options.reuse_peer and not options.keep:
        parser.error("--reuse-peer needs --keep")
    if options.equal_triangles and not (options.peer and "{depth}" in options.peer):
        parser.error("--equal-triangles needs --peer with {depth}")
    if options.update and not (options.update.is_file() and marked(options.update)):
        parser.error(f"--update: {options.update} has no lines {BEGIN} and {END}")
    if options.brief and not (options.peer and options.update):
        parser.error("--brief needs --peer and --update")
    if options.data and not options.data.is_dir():
        parser.error(f"--data: {options.data} is no folder")
    return options


def marked(path):
    """The text before and after the results, or None if they are not marked."""
    before, begin, rest = path.read_text(encoding="utf-8").partition(BEGIN)
    _, end, after = rest.partition(END)
    return (before + begin, end + after) if end else None


class Table:
    """Runs the cases and prints their rows as they come."""

    def __init__(self, options, folder):
        self.options = options
        tools = options.bin
        self.program = str(options.program or tools / "pointskin")
        ours = [self.program, "reconstruct", "{in}", "-o", "{out}", "--depth",
                "{depth}", "--threads", "{threads}", "-q", *shlex.split(options.options)]
        self.ours = ("pointskin", ours)
        peer = shlex.split(options.peer) if options.peer else []
        self.peer = (pathlib.Path(peer[0]).name, peer) if peer else None
        metrics = [str(tools / "pointskin_metrics"), "--samples", str(options.samples), "--tau", str(options.tau),
                   "--threads", str(options.threads)]
        self.bench = programs.Bench(folder, metrics, options.threads, options.timeout)
        self.entries, self.lines, self.right_signs = [], verdict.table_head(), None

    def entry(self, case, cloud, program, depth):
        """Runs one program; returns the row's entry, not yet printed."""
        reuse = self.options.reuse_peer and program is self.peer
        result = self.bench.result(case, cloud, program, depth, reuse)
        entry = {"case": case.name, "depth": depth, "program": program[0], **result}
        if self.right_signs is not None:
            entry["right_signs"] = self.right_signs
        if "metrics" in result:
            entry["row"] = verdict.summary_of(result["metrics"])
        return entry

    def show(self, entry, judged=None):
        entry["verdict"] = judged
        self.entries.append(entry)
        self.lines.append(verdict.table_row(entry))
        print(self.lines[-1], flush=True)

    def judge(self, ours, peer):
        if "failed" in ours:
            return {"worse_in": ["failed"], "not_worse": False, "better": False}
        if "failed" in peer:
            return {"text": "alone"}
        return verdict.compare(ours["row"], peer["row"], self.options.tolerance)

    def at_triangles(self, case, cloud, program, start, triangles):
        """The program's row at this number of triangles, between two of its depths, from `start` on; None without."""
        step = 1 if start["row"]["triangles"] < triangles else -1
        entry = start
        for _ in range(2):
            other = self.entry(case, cloud, program, entry["depth"] + step)
            if "failed" in other:
                return None
            low, high = (entry, other) if step > 0 else (other, entry)
            if low["row"]["triangles"] <= triangles <= high["row"]["triangles"]:
                return {"case": case.name, "depth": f"{low['depth']}..{high['depth']}", "program": program[0],
                        "row": verdict.interpolate(low["row"], high["row"], triangles), "interpolated": True}
            entry = other
        return None

    def show_at_equal_triangles(self, case, cloud, ours, peer):
        """The peer at our number of triangles or, where none of its depths has so many, ours at the peer's."""
        between = self.at_triangles(case, cloud, self.peer, peer, ours["row"]["triangles"])
        if between:
            return self.show(between, self.judge(ours, between))
        between = self.at_triangles(case, cloud, self.ours, ours, peer["row"]["triangles"])
        if between:
            return self.show(between, self.judge(between, peer))
        return self.show({"case": case.name, "depth": ours["depth"], "program": self.peer[0], "interpolated": True,
                          "failed": "no depths with equal numbers of triangles"}, {"text": "alone"})

    def run(self, case):
        cloud = self.bench.cloud(case, self.options.reuse_peer)
        if self.options.without_normals:
            try:
                cloud, self.right_signs = self.bench.orient(case, cloud, self.program)
            except programs.Failed as failure:
                self.show({"case": case.name, "depth": self.options.depths[0], "program": self.ours[0], "failed": str(failure)})
                return
        for depth in self.options.depths:
            ours = self.entry(case, cloud, self.ours, depth)
            if not self.peer:
                self.show(ours)
                continue
            peer = self.entry(case, cloud, self.peer, depth)
            self.show(ours, self.judge(ours, peer))
            self.show(peer)
            if self.options.equal_triangles and "failed" not in ours and "failed" not in peer:
                self.show_at_equal_triangles(case, cloud, ours, peer)

    def brief(self):
        """The rows of both programs at equal depth, where neither failed, side by side."""
        ours = {(e["case"], e["depth"]): e for e in self.entries if e["program"] == self.ours[0] and "row" in e}
        peers = [e for e in self.entries if e["program"] == self.peer[0] and "row" in e and not e.get("interpolated")]
        return verdict.brief_table([(ours[e["case"], e["depth"]], e) for e in peers if (e["case"], e["depth"]) in ours])

    def summary(self):
        lines = []
        for text, interpolated in (("at equal depth", False), ("at equal numbers of triangles", True)):
            n = verdict.count(e["verdict"] for e in self.entries if e.get("interpolated", False) == interpolated)
            if n["compared"]:
                lines.append(f"{text}: not worse on {n['not_worse']} of {n['compared']}, "
                             f"better on {n['better']} of {n['compared']}")
        failed = sum("failed" in e and e["program"] == self.ours[0] for e in self.entries)
        return lines + ([f"failed: {failed}"] if failed else [])


def without_infinities(value):
    """JSON has no infinity."""
    if isinstance(value, dict):
        return {name: without_infinities(v) for name, v in value.items()}
    if isinstance(value, list):
        return [without_infinities(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def main(words):
    options = parse(words)
    chosen = cases.choose(cases.known_cases(options.bin, options.points, options.seed, options.data), options.cases)
    if not chosen:
        print(f"accuracy.py: no case matches {options.cases}; see --list", file=sys.stderr)
        return 2
    if options.list:
        print("\n".join(case.name for case in chosen))
        return 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = (options.keep or pathlib.Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        table = Table(options, folder)
        print("\n".join(table.lines), flush=True)
        try:
            for case in chosen:
                table.run(case)
        except (programs.Failed, OSError, ValueError) as failure:
            print(f"accuracy.py: {failure}", file=sys.stderr)
            return 1
    lines = table.summary()
    for line in lines:
        print("\n" + line)
    if options.update:
        before, after = marked(options.update)
        text = "\n\n".join(["\n".join(table.brief() if options.brief else table.lines), *(line + "." for line in lines)])
        options.update.write_text(f"{before}\n\n{text}\n\n{after}", encoding="utf-8")
    if options.json:
        report = {"version": 1, "peer": options.peer, "depths": options.depths, "options": options.options,
                  "samples": options.samples, "tau": options.tau, "tolerance": options.tolerance,
                  "entries": table.entries, "summary": lines}
        options.json.write_text(json.dumps(without_infinities(report), indent=1) + "\n", encoding="utf-8")
    return 1 if any("failed" in e and e["program"] == "pointskin" for e in table.entries) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
