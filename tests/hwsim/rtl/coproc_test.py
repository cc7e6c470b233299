#!/usr/bin/env python3
"""Runs a program on the circuit: feeler coproc --device rtl reports what it reports of the emulator.

Usage: coproc_test.py FEELER
"""

import pathlib
import subprocess
import sys
import tempfile

SETUP = """mesh_size = 1
[program]
dialect = "linuxcnc"
start = { X = 0, Y = 0, Z = 60 }
[offsets]
G54 = { X = 0, Y = 0, Z = 0 }
[stock]
box = [[0, 0, -20], [40, 30, 0]]
[[fixture]]
name = "clamp"
box = [[42, 5, -20], [50, 25, 8]]
[[tool]]
number = 1
shape = "flat"
diameter = 8
flute_length = 20
stick_out = 40
spindle = "clockwise"
"""
CUTS = "".join(f"G1 X{x} F900\nZ{-1 - y % 3}\n" for y, x in enumerate((30, 4, 28, 6, 26, 8)))
CLEAR = "G21 G90 G17 G54 G61\nT1 M6\nG43 H1\nM3 S3000\nG0 X4 Y10 Z5\nG1 Z-1 F300\n" + CUTS + "G0 Z20\nM2\n"


def coproc(feeler, folder, program, *options):
    path = pathlib.Path(folder, "p.ngc")
    path.write_text(program, encoding="utf-8")
    pathlib.Path(folder, "s.toml").write_text(SETUP, encoding="utf-8")
    return subprocess.run([feeler, "coproc", path, "--setup", f"{folder}/s.toml", "--no-fit", *options],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)


def main(feeler):
    with tempfile.TemporaryDirectory() as folder:
        config = pathlib.Path(folder, "device.toml")
        config.write_text("[device]\nelements = 2\n", encoding="utf-8")
        for program, status in ((CLEAR, 0), (CLEAR.replace("X28", "X42"), 1)):
            emulated = coproc(feeler, folder, program, "--config", config)
            assert emulated.returncode == status, emulated
            assert "2 elements of 4 threads" in emulated.stdout, emulated
            on_circuit = coproc(feeler, folder, program, "--device", "rtl")
            assert on_circuit.returncode == status and on_circuit.stdout == emulated.stdout, on_circuit
        config.write_text("[device]\nelements = 5\n", encoding="utf-8")
        other = coproc(feeler, folder, CLEAR, "--config", config, "--device", "rtl")
        assert other.returncode == 2 and "the circuit has 2 elements of 4 threads" in other.stderr, other


main(sys.argv[1])
