#!/usr/bin/env python3
"""Runs programs on the circuit and on the emulator: feeler coproc prints the same of both.

usage: programs.py FEELER FOLDER [PATIENCE]

FOLDER holds a folder of programs for each dialect. Programs that cannot be checked without a set-up, or take longer than
PATIENCE seconds, are counted and left out.
"""

import collections
import pathlib
import re
import subprocess
import sys
import tempfile

DIALECTS = {"fanuc-like": "fanuc", "grbl-hobby": "grbl", "heidenhain": "heidenhain", "linuxcnc": "linuxcnc",
            "siemens": "siemens"}


def coproc(feeler, program, patience, *options):
    """The exit status and the text; None if it takes too long."""
    command = [feeler, "coproc", program, "--dialect", DIALECTS[program.parent.name], *options]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False,
                              timeout=patience)  # clock: ends what takes too long
    except subprocess.TimeoutExpired:
        return None
    return done.returncode, done.stdout


def main(feeler, folder, patience):
    counts, work, different = collections.Counter(), collections.Counter(), []
    with tempfile.TemporaryDirectory() as temporary:
        config = pathlib.Path(temporary, "device.toml")
        config.write_text("[device]\nelements = 2\n", encoding="utf-8")  # as the circuit
        for program in sorted(path for name in DIALECTS for path in pathlib.Path(folder, name).iterdir()):
            emulated = coproc(feeler, program, patience, "--config", config)
            if emulated and emulated[0] > 1:
                counts["not checked"] += 1
                continue
            on_circuit = emulated and coproc(feeler, program, patience, "--device", "rtl")
            if not on_circuit:
                counts["too long"] += 1
            elif on_circuit != emulated:
                counts["different"] += 1
                different.append(str(program))
            else:
                counts["same"] += 1
                found = re.search(r"(\d+) blocks, (\d+) queries, .* (\d+) cycles", emulated[1])
                work.update(dict(zip(("blocks", "queries", "cycles"), map(int, found.groups()))) if found else {})
    print(*(f"{number} {name}" for name, number in counts.items()), sep=", ")
    print(*(f"{number} {name}" for name, number in work.items()), sep=", ")
    assert not different, different
    assert counts["same"] >= 50 and work["queries"] > 100_000, "too few to say anything"


if __name__ == "__main__":
    if not pathlib.Path(sys.argv[2]).is_dir():
        sys.exit(77)
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]) if len(sys.argv) > 3 else 120.0)
