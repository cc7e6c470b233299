"""Prints the compile time of each module in the last build, from ninja's log.

usage: build_times.py build/release/.ninja_log
"""
import collections
import os
import re
import sys


def module_of(output):
    """The folder of the sources of an object or library."""
    folder = re.sub(r"/CMakeFiles/.*", "", output) if "CMakeFiles" in output else os.path.dirname(output)
    return folder or "(headers)"


def main():
    if len(sys.argv) != 2 or not os.path.exists(sys.argv[1]):
        sys.exit(__doc__)
    latest = {}
    with open(sys.argv[1], encoding="utf-8") as log:
        for line in log:
            fields = line.rstrip("\n").split("\t")
            if len(fields) == 5:
                latest[fields[3]] = (int(fields[1]) - int(fields[0])) / 1000
    seconds, steps, slowest = collections.Counter(), collections.Counter(), {}
    for output, taken in latest.items():
        if not output.endswith((".o", ".gch")):
            continue
        module = module_of(output)
        seconds[module] += taken
        steps[module] += 1
        slowest[module] = max(slowest.get(module, 0), taken)
    print(f"{'module':28} {'seconds':>8} {'objects':>8} {'slowest':>8}")
    for module, taken in seconds.most_common():
        print(f"{module:28} {taken:8.1f} {steps[module]:8} {slowest[module]:8.1f}")
    print(f"{'all':28} {sum(seconds.values()):8.1f} {sum(steps.values()):8}")


if __name__ == "__main__":
    main()
