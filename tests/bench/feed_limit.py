#!/usr/bin/env python3
"""Prints the feed at which the default coprocessor no longer keeps up, for the jobs in assets.

usage: feed_limit.py FEELER ASSETS [--only NAME] [--config DEVICE.toml]

The whole plan is run faster and faster, as with a feed override (`feeler coproc`), until a permit comes late;
then bisection finds that override to 5 %. The feed is the programmed one of the first late block, times the
override. The next columns give the override at which a machine that stops at once would reach a block without
a permit, and the share of the device's time in which it reads lines from the host.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

JOBS = (  # program, set-up
    ("TEST_G90.NC", "test_g90"),
    ("TEST_G90.NC", "test_g90_vise6"),
    ("PARALLEL.NC", "parallel"),
    ("clamped_plate.nc", "clamped_plate"),
    ("indexed_flats.nc", "indexed_flats"),
    ("tilted_faces.nc", "tilted_faces"),
)
PRECISION = 1.05
MOST = 10.0  # times the programmed feed: the highest override of a device file


def bracket(keeps_up, most=MOST, precision=PRECISION):
    """The highest override found at which `keeps_up` holds, and the lowest at which it does not, or None."""
    kept, missed = 0.0, 1.0
    while keeps_up(missed):
        if missed >= most:
            return missed, None
        kept, missed = missed, min(2.0 * missed, most)
    if kept == 0.0:
        return 0.0, 1.0
    while missed > precision * kept:
        middle = (kept * missed) ** 0.5
        if keeps_up(middle):
            kept = middle
        else:
            missed = middle
    return kept, missed


def first_late(report):
    """The first block whose permit came late, or None."""
    for block in report["blocks"]:
        if block["slack"] is not None and block["slack"] < 0.0:
            return block
    return None


def feeds(trace):
    """The kind of each block, from the lines of a trace: a feed in mm/min, or "rapid"; a feed takes precedence."""
    found = {}
    for line in trace.splitlines():
        command = json.loads(line)
        if command.get("feed"):
            found[command["block"]] = command["feed"]
        elif command["command"] == "straight_traverse":
            found.setdefault(command["block"], "rapid")
    return found


def asked_after(blocks, ahead):
    """For each block the planned time of its request: when the machine enters the first block that moves and is
    at most the look-ahead before it."""
    entered, moments = math.inf, [0.0] * len(blocks)
    for j in reversed(range(len(blocks))):
        if blocks[j]["entered"] is not None:
            entered = blocks[j]["entered"]
        if j + ahead < len(blocks):
            moments[j + ahead] = entered
    return moments


def stretches(blocks, ahead):
    """For each block except the first that moves: pairs of planned seconds and the cycles needed in them at
    least, one pair for each earlier block to start with.

    A permit comes a block's cycles after its request, and its interval after the previous permit. The machine
    waits for the first permit.
    """
    asked = asked_after(blocks, ahead)
    first = next((i for i, b in enumerate(blocks) if b["entered"] is not None), len(blocks))
    queue, intervals, begin = 0, [0], 0.0  # `queue`: cycles to a permit of those requested at the start
    for i, block in enumerate(blocks):
        if i == first:
            begin = block["entered"]
        queue = max(queue + block["interval"], block["cycles"] if asked[i] <= begin else 0)
        intervals.append(intervals[-1] + block["interval"])
        if i == first:
            waited = queue
        if i <= first or block["entered"] is None:
            continue
        pairs = [(block["entered"] - begin, queue - waited)]
        pairs += [(block["entered"] - asked[j],
                   blocks[j]["cycles"] + intervals[i + 1] - intervals[j + 1])
                  for j in range(first + 1, i + 1) if asked[j] > begin]
        yield block, pairs


def without_braking(report):
    """The lowest override at which a permit would come after its block is reached, and that block: the
    limit for a machine that stops instantly. The report must be of a run in which nothing was late.
    """
    clock = 1e6 * report["config"]["device"]["clock_mhz"]
    least, late = math.inf, None
    for block, pairs in stretches(report["blocks"], report["config"]["control"]["look_ahead"]):
        override = min((clock * way / cycles for way, cycles in pairs if cycles > 0),
                       default=math.inf)
        if override < least:
            least, late = override, block
    return least, late


def host_share(report):
    """The share of the device's time in which descriptors and lines come from the host."""
    lines = report["counters"]["host_lines"] * report["config"]["device"]["host_cycles_per_line"]
    return min(1.0, lines / max(sum(block["interval"] for block in report["blocks"]), 1))


def read_at(report, block):
    """When the control reads a block: when the machine enters the one that is the look-ahead before it."""
    first = report["blocks"][0]["block"]
    before = block["block"] - first - report["config"]["control"]["look_ahead"]
    return 0.0 if before < 0 else report["blocks"][before]["entered"] or 0.0


def reason(report, block):
    """The cause of a late block."""
    if block["asked"] >= block["due"]:
        if read_at(report, block) < block["due"]:
            return "control: it makes lines for the device"
        return "look-ahead: the way to brake is longer"
    at_once = sum(1 for b in report["blocks"] if b["due"] == block["due"])
    if at_once > 1:
        return f"device: {at_once} blocks due at once"
    own = block["cycles"] / (1e6 * report["config"]["device"]["clock_mhz"])
    if own > 0.5 * (block["permitted"] - block["asked"]):
        return "device: the block itself"
    return "device: the blocks before it"


def number(value):
    """Three digits, without an exponent."""
    value = float(f"{value:.3g}")
    return f"{value:.0f}" if value >= 100.0 or value == int(value) else f"{value:g}"


class Job:
    """A program with its set-up and its device."""

    def __init__(self, feeler, assets, program, setup, config=""):
        self.feeler = feeler
        self.program = os.path.join(assets, "programs", program)
        self.setup = os.path.join(assets, "setups", setup + ".toml")
        self.config = config
        self.reports = {}

    def report(self, override):
        """The device's report at an override. Refused blocks are run all the same."""
        if override not in self.reports:
            with tempfile.NamedTemporaryFile("w", suffix=".toml", encoding="utf-8") as file:
                file.write(f"{self.config}\n[control]\nfeed_override = {override!r}\n")
                file.flush()
                self.reports[override] = json.loads(self.run(
                    "coproc", "--setup", self.setup, "--config", file.name, "--format", "json",
                    "--no-fit", "--past-refusals"))
        return self.reports[override]

    def run(self, command, *options):
        done = subprocess.run([self.feeler, command, self.program, *options], capture_output=True,
                              text=True, check=False)
        if done.returncode not in (0, 1):
            sys.exit(f"feed_limit.py: {done.stderr.strip()}")
        return done.stdout

    def keeps_up(self, override):
        return self.report(override)["totals"]["missed"] == 0

    def row(self):
        feed_of = feeds(self.run("trace", "--format", "jsonl"))

        def cells(override, block):
            """An override, the feed of a block then, and its line."""
            if block is None:
                return ["-", "-", "-"]
            feed = feed_of.get(block["block"], "-")
            return [number(override), feed if isinstance(feed, str) else number(feed * override),
                    f"{block['line']}"]

        normal = self.report(1.0)
        _, missed = bracket(self.keeps_up)
        late = first_late(self.report(missed)) if missed else None
        return ([f"{100.0 * host_share(normal):.0f} %"] + cells(*without_braking(normal))
                + cells(missed, late) + [reason(self.report(missed), late) if late else f"none up to {MOST:.0f}"])


def main():
    parser = argparse.ArgumentParser(description="Prints the feed at which the coprocessor is too slow.")
    parser.add_argument("feeler")
    parser.add_argument("assets")
    parser.add_argument("--only", help="a set-up")
    parser.add_argument("--config", help="a device file with [device], without [control]")
    options = parser.parse_args()
    config = ""
    if options.config:
        with open(options.config, encoding="utf-8") as file:
            config = file.read()
    print("| set-up | host | late without braking at | feed, mm/min | line "
          "| late at override | feed, mm/min | line | by |")
    print("|---|---|---|---|---|---|---|---|---|")
    for program, setup in JOBS:
        if options.only not in (None, setup):
            continue
        job = Job(options.feeler, options.assets, program, setup, config)
        print("| " + " | ".join([f"`{setup}`"] + job.row()) + " |", flush=True)


if __name__ == "__main__":
    main()
