#!/usr/bin/env python3
"""Prints the overhead of a batch, its database and its reports over the checks themselves, in CPU seconds.

usage: batch_overhead.py FEELER FOLDER [--rounds N] [--mesh-size MM]

Each round checks the programs of the folder separately with `feeler check`, then all as a batch with one
job: without a database, with a new one, with a new one and a report in every format, and again with the
filled one. The methods alternate, and the minimum over all rounds is used. The time to start as many
processes that do nothing is measured as well and subtracted from the first method, so the ratios refer to
the checks alone.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile

FORMS = ("json", "jsonl", "csv", "sarif", "junit", "html", "text")


def cpu_seconds(commands):
    """CPU seconds of all threads of the commands and their child processes."""

    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = used()
    for command in commands:
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        if done.returncode not in (0, 1, 2):
            sys.exit(f"{command} ended with {done.returncode}")
    return used() - before


def programs_of(feeler, folder, options):
    """CPU seconds of a batch of programs."""
    with tempfile.TemporaryDirectory() as place:
        rows = os.path.join(place, "rows.csv")
        batch = [feeler, "check", folder, "--no-cache", "--verdict-only", *options, "--format", "csv", "-o", rows]
        subprocess.run(batch, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        with open(rows, encoding="utf-8") as lines:
            return [line.split(",")[0] for line in lines][1:]


def ways_of(feeler, folder, programs, options, place):
    """The methods by name, in the order of a round."""
    batch = [feeler, "check", folder, "-j1", *options]
    cache, plain = os.path.join(place, "results.db"), os.path.join(place, "plain.db")
    reports = [word for form in FORMS for word in ("--format", form, "-o", os.path.join(place, f"report.{form}"))]
    return {
        "starting": [[feeler, "--version"]] * len(programs),
        "one by one": [[feeler, "check", program, *options] for program in programs],
        "batch": [[*batch, "--no-cache"]],
        "with database": [["rm", "-f", plain], [*batch, "--cache", plain]],
        "with all reports": [["rm", "-f", cache], [*batch, "--cache", cache, *reports]],
        "unchanged": [[*batch, "--cache", cache, *reports]],
    }


def table(least):
    """The output lines, from the least seconds of each method."""
    alone = least["one by one"] - least["starting"]
    lines = [f"{'starting as many processes':<28}{least['starting']:8.2f} s"]
    lines.append(f"{'one by one, without that':<28}{alone:8.2f} s")
    for way in ("batch", "with database", "with all reports", "unchanged"):
        lines.append(f"{way:<28}{least[way]:8.2f} s {100.0 * (least[way] / alone - 1.0):+7.1f} %")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("feeler")
    parser.add_argument("folder")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--mesh-size", default="0.5")
    words = parser.parse_args()
    options = ["--mesh-size", words.mesh_size]
    programs = programs_of(words.feeler, words.folder, options)
    seconds = {}
    with tempfile.TemporaryDirectory() as place:
        for _ in range(words.rounds):
            for way, commands in ways_of(words.feeler, words.folder, programs, options, place).items():
                seconds.setdefault(way, []).append(cpu_seconds(commands))
                print(f"{way}: {seconds[way][-1]:.2f} s", file=sys.stderr)
    print(f"{len(programs)} programs, {words.rounds} rounds, CPU seconds")
    print("\n".join(table({way: min(times) for way, times in seconds.items()})))


if __name__ == "__main__":
    main()
