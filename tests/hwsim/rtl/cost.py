#!/usr/bin/env python3
"""Synthesizes the units of the circuit for ECP5 and Xilinx 7 with yosys, and prints what they need.

Usage: cost.py SOURCE_DIRECTORY [--check] [UNIT...]

With --check it fails if a unit needs more than its limits below, or if anything in the whole device becomes a latch.
The units are those of LIMITS unless some are named; search_element takes ten minutes, register_file two. Those two
have no limits.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

# (LUT, flip-flops, multipliers, blocks of RAM of 16 or 18 kbit) for ECP5 and Xilinx 7. The number of LUTs of the same unit
# differs by up to a sixth when names in it change, so yosys reads only what a unit consists of.
LIMITS = {
    "path_unit": ((3_400, 1_950, 12, 0), (1_700, 1_050, 6, 0)),
    "gap_unit": ((4_900, 5_400, 16, 0), (2_900, 1_950, 10, 0)),
    "check_unit": ((3_600, 2_400, 0, 0), (3_100, 920, 0, 0)),
    "line_cache": ((4_300, 1_400, 0, 16), (1_400, 320, 0, 16)),
    "search_thread": ((8_000, 3_250, 0, 0), (4_900, 3_250, 0, 0)),
    "permit_unit": ((4_900, 1_700, 4, 5), (1_900, 1_500, 2, 0)),
    "ring_unit": ((7_700, 4_200, 0, 0), (5_200, 3_150, 0, 0)),
    "memory_unit": ((4_500, 2_700, 0, 2), (3_600, 1_250, 0, 2)),
}
FAMILIES = {"ECP5": "synth_ecp5", "Xilinx 7": "synth_xilinx -family xc7 -flatten"}
FILES = ("device", "path_unit", "gap_unit", "check_unit", "line_cache", "search_thread", "search_element", "permit_unit",
         "ring_unit", "memory_unit", "register_file", "coprocessor")
# Cells, and how many of a column they are.
COLUMNS = (
    {r"LUT\d": 1, r"SRL.*": 1, r"RAM(32|64|128)X?.*": 2, r"TRELLIS_DPR16X4": 2, r"CCU2C": 2},
    {r"TRELLIS_FF|FD[RSCP]E(_1)?": 1},
    {r"MULT18X18D|DSP48E1": 1},
    {r"DP16KD|PDPW16KD|RAMB18E1": 1, r"RAMB36E1": 2},
)


def files_of(source, unit):
    """The package, then the files of the units that the unit consists of, and its own."""
    paths = {name: pathlib.Path(source, "hwsim/rtl", name + ".sv") for name in FILES}
    needed, pending = {"device"}, [unit]
    while pending:
        name = pending.pop()
        needed.add(name)
        text = paths[name].read_text(encoding="utf-8")
        pending += [other for other in FILES if other not in needed and re.search(rf"^\s*{other}\s*(#\(|\w+\s*\()", text, re.M)]
    return [str(paths[name]) for name in FILES if name in needed]


def elaborated(source, unit):
    """The commands that read a unit and fail if something in it becomes a latch."""
    return (f"read_verilog -sv {' '.join(files_of(source, unit))}; hierarchy -top {unit}; proc; check -assert; "
            "select -assert-none t:$dlatch t:$adlatch t:$dlatchsr")


def run_yosys(unit, commands):
    result = subprocess.run(["yosys", "-q", "-p", commands], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        sys.exit(f"{unit}: {result.stdout[-2000:]}")


def cells_of(source, unit, synthesis):
    with tempfile.TemporaryDirectory() as folder:
        run_yosys(unit, f"{elaborated(source, unit)}; {synthesis} -top {unit}; tee -o {folder}/stat.json stat -json")
        text = pathlib.Path(folder, "stat.json").read_text(encoding="utf-8")
    # yosys 0.23 writes a line of its log before the object.
    return json.loads(text[text.index("{"):])["design"]["num_cells_by_type"]


def cost_of(cells):
    return tuple(sum(int(number) * weight for cell, number in cells.items() for pattern, weight in column.items()
                     if re.fullmatch(pattern, cell)) for column in COLUMNS)


def main(source, *arguments):
    units = [a for a in arguments if not a.startswith("--")] or LIMITS
    print("| unit | " + " | ".join(f"{family}: LUT, FF, multipliers, RAM" for family in FAMILIES) + " |")
    print("|---" * (1 + len(FAMILIES)) + "|")
    problems = []
    for unit in units:
        costs = [cost_of(cells_of(source, unit, synthesis)) for synthesis in FAMILIES.values()]
        print(f"| `{unit}` | " + " | ".join(", ".join(f"{n:,}" for n in cost) for cost in costs) + " |", flush=True)
        if unit in LIMITS:
            problems += [f"{unit} for {family} needs {cost}; its limits are {limits}"
                         for family, cost, limits in zip(FAMILIES, costs, LIMITS[unit])
                         if any(c > l for c, l in zip(cost, limits))]
    if "--check" in arguments:
        run_yosys("coprocessor", elaborated(source, "coprocessor"))
        if problems:
            sys.exit("\n".join(problems))


if __name__ == "__main__":
    main(*sys.argv[1:])
