#!/usr/bin/env python3
"""Prints how many times faster our engine is than the others, with the targets.

usage: ratios.py RESULTS.json [--best] [--keep FILE]

RESULTS.json is what feeler_bench wrote, or a file kept before. --best takes the fastest repetition of
each benchmark instead of the median, which is nearer to what a quiet machine would show. --keep writes
a whole run, with the machine named, for the repository.
"""

import argparse
import json
import math
import statistics
import sys

SIZES = ("h1", "h0.5", "h0.1")
AGAINST = (  # engine, its name in the table, target for times faster
    ("paper", "the paper's engine", (9, 25, 100)),
    ("fcl", "FCL", (10, 8, 10)),
    ("nanoflann", "nanoflann", (35, 100, 1000)),
    ("embree", "Embree", (15, 50, 200)),
)
ABSOLUTE = (  # first part of the row's name, its name in the table, target in microseconds
    ("spheres", "cold, us a query", 1.0, (15, 25, 110)),
    ("warm", "warm, us a pose", 1.0, (3, 8, 25)),
    ("build", "build, ms a body", 1e3, (5e3, 15e3, 500e3)),
)
FLAT = (("flat-aligned", 100), ("flat-shifted", 100), ("flat-turned", 100))
OTHERS = (
    "axis-h0.5",
    "turned-h0.5",
    "limit-10-h0.5",
    "closer-than-5.5-h0.5",
    "tori-apart",
    "tori-linked",
    "pin-in-cup",
    "lumps",
    "gears",
)
IN_TURN = "in-turn"
KEPT_FACTS = ("date", "commit", "cpu", "cores", "mhz_per_cpu", "caches", "simd", "system", "compiler",
              "fcl", "nanoflann", "embree", "challenger", "load_avg", "spread")
MICROSECONDS = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


class Results:
    """CPU times in microseconds, by row, pose and engine."""

    def __init__(self, data, best=False):
        self.context = data["context"]
        self.challenger = self.context["challenger"]
        self.statistic = "fastest" if best else "medians"
        repeated = {}
        self.median, self.fastest = {}, {}
        for run in data["benchmarks"]:
            key = tuple(run["name"].split("/")[:3])
            unit = MICROSECONDS[run["time_unit"]]
            if run["run_type"] == "iteration":
                repeated.setdefault(key, []).append(run["cpu_time"] * unit)
            elif "fastest" in run:
                self.median[key], self.fastest[key] = run["cpu_time"] * unit, run["fastest"] * unit
        for key, times in repeated.items():
            self.median[key], self.fastest[key] = statistics.median(times), min(times)
        self.time = self.fastest if best else self.median
        factors = [max(times) / min(times) for times in repeated.values() if len(times) > 2]
        if factors:
            self.context["spread"] = round(statistics.median(factors), 2)

    def poses(self, row, contestant):
        return {pose for r, pose, c in self.time if (r, c) == (row, contestant)} - {IN_TURN}

    def figure(self, row, contestant):
        """The geometric mean over the poses of a row; None if it was not measured."""
        poses = self.poses(row, contestant)
        if not poses or poses != self.poses(row, self.challenger):
            return None
        return statistics.geometric_mean(self.time[row, pose, contestant] for pose in sorted(poses))

    def ratio(self, row, contestant):
        ours, theirs = self.figure(row, self.challenger), self.figure(row, contestant)
        return theirs / ours if ours and theirs else None


def rounded(value):
    """To three digits."""
    return float(f"{value:.3g}")


def number(value):
    if value is None:
        return "-"
    value = rounded(value)
    digits = max(0, 2 - math.floor(math.log10(value))) if value > 0 else 0
    return f"{value:.{digits}f}"


class Table:
    """Lines of cells, and which targets were missed in them."""

    def __init__(self):
        self.lines = []
        self.missed = []
        self.measured = 0

    def cell(self, what, value, target, is_ratio):
        """A value with its target, and a ! if it misses the target."""
        aim = f"({target:g})"
        if value is None:
            return f"{'-':>8}  {aim:<8}"
        short = rounded(value) < target if is_ratio else rounded(value) > target
        self.measured += 1
        if short:
            self.missed.append(f"{what}: {number(value)}, aimed at {target:g}")
        return f"{number(value):>8}{'!' if short else ' '} {aim:<8}"

    def row(self, title, cells):
        self.lines.append((f"{title:<37}" + "".join(cells)).rstrip())


def head(results):
    facts = results.context
    machine = [facts.get("cpu", "unknown processor"), f"{facts.get('cores', '?')} cores"]
    machine += [facts[key] for key in ("simd", "compiler", "system") if key in facts]
    lines = [
        ", ".join(machine),
        f"{facts.get('date', 'no date')}, commit {facts.get('commit', 'unknown')}",
        "",
        f"Engine '{results.challenger}'. CPU times: {results.statistic} of repetitions, geometric means over poses.",
        "In brackets what is aimed at; ! marks what falls short of it.",
    ]
    if "spread" in facts:
        lines.append(f"Repetitions of one benchmark differ by a factor of {facts['spread']} (the middle one).")
    missing = [title for name, title, _ in AGAINST[1:] if name not in facts]
    if missing:
        lines.append(f"Not found when this was built, so a dash below: {', '.join(missing)}.")
    return lines + [""]


def targets(results, table):
    table.row("two balls of 50 mm", [f"{'h = ' + size[1:]:>8}  {'':<8}" for size in SIZES])
    for contestant, title, aims in AGAINST:
        title = "times faster than " + title
        table.row(title, [table.cell(f"{title}, h = {size[1:]}", results.ratio("spheres-" + size, contestant),
                                     aim, True)
                          for size, aim in zip(SIZES, aims)])
    for start, title, unit, aims in ABSOLUTE:
        cells = []
        for size, aim in zip(SIZES, aims):
            time = results.figure(f"{start}-{size}", results.challenger)
            cells.append(table.cell(f"{title}, h = {size[1:]}", time and time / unit, aim / unit,
                                    False))
        table.row(title, cells)


def flat(results, table):
    table.lines.append("")
    table.row("flat over flat", [f"{name.removeprefix('flat-'):>8}  {'':<8}" for name, _ in FLAT])
    title = "times faster than " + AGAINST[0][1]
    table.row(title, [table.cell(f"{title}, {row}", results.ratio(row, AGAINST[0][0]), aim, True)
                      for row, aim in FLAT])


def others(results, table):
    """Our own time, and how many times slower the others are."""
    names = [name for name, _, _ in AGAINST]
    rows = [row for row, _ in FLAT] + list(OTHERS) + ["build-" + size for size in SIZES]
    table.lines.append("")
    table.row("all cases, times slower", [f"{results.challenger + ', us':>11}"] + [f"{n:>11}" for n in names])
    for row in rows:
        ours = results.figure(row, results.challenger)
        if ours:
            table.row(row, [f"{number(ours):>11}"]
                      + [f"{number(results.ratio(row, name)):>11}" for name in names])


def in_turn(results, table):
    """The gain from repeating a query at one pose."""
    table.lines.append("")
    for size in SIZES:
        row, ours = "spheres-" + size, results.challenger
        together = results.time.get((row, IN_TURN, ours))
        poses = results.poses(row, ours)
        if not together or not poses:
            continue
        alone = sum(results.time[row, pose, ours] for pose in sorted(poses))
        table.lines.append(f"The gaps of h = {size[1:]} in turn take {together / alone:.2f} times as long as "
                           "each repeated by itself.")


def report(results):
    table = Table()
    targets(results, table)
    flat(results, table)
    others(results, table)
    in_turn(results, table)
    lines = head(results) + table.lines + [""]
    if table.missed:
        lines.append(f"{len(table.missed)} of {table.measured} targets missed:")
        lines += ["  " + miss for miss in table.missed]
    elif table.measured:
        lines.append(f"All {table.measured} targets met that were measured.")
    return "\n".join(lines)


def kept(results):
    """A run as stored in the repository: one benchmark on each line, without names of hosts or files."""
    facts = {key: results.context[key] for key in KEPT_FACTS if key in results.context}
    lines = []
    for key in sorted(results.time):
        line = {"name": "/".join(key), "run_type": "aggregate", "aggregate_name": "median",
                "cpu_time": float(f"{results.median[key]:.5g}"),
                "fastest": float(f"{results.fastest[key]:.5g}"), "time_unit": "us"}
        lines.append("    " + json.dumps(line))
    return ('{\n  "context": ' + json.dumps(facts) + ',\n  "benchmarks": [\n' + ",\n".join(lines)
            + "\n  ]\n}\n")


def is_whole(results):
    rows = {row for row, _, _ in results.time}
    wanted = {f"{start}-{size}" for start, _, _, _ in ABSOLUTE for size in SIZES}
    return wanted | {row for row, _ in FLAT} | set(OTHERS) <= rows


def main():
    parser = argparse.ArgumentParser(description="Prints the ratios of a run of feeler_bench.")
    parser.add_argument("results")
    parser.add_argument("--best", action="store_true")
    parser.add_argument("--keep", metavar="FILE")
    options = parser.parse_args()
    with open(options.results, encoding="utf-8") as file:
        results = Results(json.load(file), options.best)
    print(report(results))
    if options.keep:
        if not is_whole(results):
            sys.exit("ratios.py: not kept, as this is not a whole run")
        with open(options.keep, "w", encoding="utf-8") as file:
            file.write(kept(results))
        print(f"\nKept as {options.keep}")


if __name__ == "__main__":
    main()
