"""Compares the measures of two programs, and prints them."""
import math

ERRORS = ("mean", "rms")
DISTANCES = ("mean", "rms", "p95", "max")


def summary_of(metrics):
    """What the table shows of one mesh: distances in % of the diagonal, normals, topology."""
    truth, result = metrics["truth"], metrics["result"]
    row = {name: metrics["two_sided"]["percent"][name] for name in DISTANCES}
    row["spacings"] = metrics["two_sided"]["spacings"]["mean"]
    row["normals"] = 1 - metrics["normal_consistency"]  # an error, like the others
    row["f_score"] = metrics["f_score"]
    row["triangles"] = result["triangles"]
    row["watertight"] = result["watertight"]
    row["components"], row["genus"] = result["components"], result["genus"]
    row["true_components"], row["true_genus"] = truth["components"], truth["genus"]
    return row


def topology_error(row):
    """How many components and handles are too many or too few; none where the truth is not closed."""
    if row["true_genus"] is None:
        return 0
    if row["genus"] is None:
        return math.inf
    return abs(row["components"] - row["true_components"]) + abs(row["genus"] - row["true_genus"])


def compare(ours, peer, tolerance):
    """The verdict on ours: where it is worse, and whether it is better.

    Not worse: mean, rms and 1 - normal consistency are at most (1 + tolerance) times the peer's, and components and
    genus are right, or no farther from right than the peer's. Better: not worse, and mean or rms are less than
    (1 - tolerance) times the peer's.
    """
    worse = [name for name in (*ERRORS, "normals") if ours[name] > peer[name] * (1 + tolerance)]
    if topology_error(ours) > topology_error(peer):
        worse.append("topology")
    better = not worse and any(ours[name] < peer[name] * (1 - tolerance) for name in ERRORS)
    return {"worse_in": worse, "not_worse": not worse, "better": better}


def interpolate(low, high, triangles):
    """The row of a program at `triangles`, between the rows of two depths, linearly in the logarithms.

    Topology is that of the depth whose number of triangles is nearer.
    """
    span = math.log(high["triangles"] / low["triangles"])
    weight = math.log(triangles / low["triangles"]) / span if span else 0.0
    row = dict(high if weight > 0.5 else low)
    for name in (*DISTANCES, "spacings", "normals"):
        if low[name] > 0 and high[name] > 0:
            row[name] = math.exp((1 - weight) * math.log(low[name]) + weight * math.log(high[name]))
    row["f_score"] = (1 - weight) * low["f_score"] + weight * high["f_score"]
    row["triangles"] = triangles
    return row


HEAD = ("case", "depth", "program", "triangles", "mean %", "rms %", "p95 %", "max %", "mean / spacing", "1 - normals",
        "F-score", "components", "genus", "verdict")


def count_text(count, true):
    shown = "open" if count is None else str(count)
    return shown if true is None or count == true else f"{shown} (true: {true})"


def verdict_text(verdict):
    if verdict is None:
        return ""
    if "text" in verdict:
        return verdict["text"]
    if verdict["worse_in"]:
        return "worse: " + ", ".join(verdict["worse_in"])
    return "better" if verdict["better"] else "not worse"


def table_row(entry):
    """One line of Markdown of {"case", "depth", "program", "row" or "failed", "verdict"}."""
    cells = [entry["case"], str(entry["depth"]), entry["program"]]
    if "failed" in entry:
        cells += ["failed: " + entry["failed"].replace("|", "/")] + [""] * 9
    else:
        row = entry["row"]
        closed = row["true_genus"] is not None
        cells += [str(row["triangles"]), *(f"{row[name]:.4g}" for name in DISTANCES), f"{row['spacings']:.3f}",
                  f"{row['normals']:.5f}", f"{row['f_score']:.4f}",
                  count_text(row["components"], row["true_components"] if closed else None),
                  count_text(row["genus"], row["true_genus"] if closed else None)]
    cells.append(verdict_text(entry.get("verdict")))
    return "| " + " | ".join(cells) + " |"


def table_head():
    return ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]


BRIEF_HEAD = ("case", "depth", "mean %", "mean", "rms", "1 - normals", "components", "genus", "the peer's")


def brief_table(pairs):
    """Markdown with a row for each (ours, peer) of two entries of one case: our mean distance, what mean, rms and normals are
    over the peer's, and both topologies; the largest ratio of means first, and the geometric means last. Where normals were
    found, a column more says how many have the right sign."""
    pairs = list(pairs)
    ratios = {name: [] for name in (*ERRORS, "normals")}
    head = BRIEF_HEAD + (("right signs %",) if any("right_signs" in ours for ours, _ in pairs) else ())
    rows = []
    for ours, peer in pairs:
        row = ours["row"]
        ratio = {name: row[name] / peer["row"][name] for name in ratios}
        for name, value in ratio.items():
            ratios[name].append(value)
        closed = row["true_genus"] is not None
        topology = [count_text(r[name], r["true_" + name] if closed else None)
                    for r in (row, peer["row"]) for name in ("components", "genus")]
        cells = [ours["case"], str(ours["depth"]), f"{row['mean']:.4g}", *(f"{value:.3f}" for value in ratio.values()),
                 topology[0], topology[1], f"{topology[2]}, {topology[3]}"]
        if len(head) > len(BRIEF_HEAD):
            cells.append(f"{100 * ours['right_signs']:.2f}")
        rows.append((ratio["mean"], "| " + " | ".join(cells) + " |"))
    rows.sort(key=lambda row: -row[0])
    means = [f"{math.exp(sum(map(math.log, values)) / len(values)):.3f}" for values in ratios.values() if values]
    last = ["| geometric mean | | | " + " | ".join(means) + " |" + " |" * (len(head) - 6)] if rows else []
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *(line for _, line in rows), *last]


def count(verdicts):
    """How many verdicts there are, how many are not worse, how many better."""
    counted = [v for v in verdicts if v is not None and "worse_in" in v]
    return {"compared": len(counted), "not_worse": sum(v["not_worse"] for v in counted),
            "better": sum(v["better"] for v in counted)}
