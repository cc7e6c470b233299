#!/usr/bin/env python3
"""Counts the instructions of eleven runs of feeler with valgrind, and compares them with the expected figures.

usage: instructions.py FEELER SHIM [--update] [SCENE ...]

SHIM: a library to preload (valgrind_shim.cpp). Instructions do not depend on what else the machine does, so 3 % more
than expected is a regression. 3 % less has to be noted too, or a later regression up to the old figure is not seen.
With --update, the figures in instructions.txt are replaced: state the reason there and in the commit.
"""

import argparse
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ASSETS = HERE.parent.parent / "assets"
EXPECTED = HERE / "instructions.txt"
TOLERANCE = 0.03

HEAD = "G21 G90 G17 G54 G61\nT1 M6\nG43 H1\nS12000 M3\nG0 X0 Y0 Z50\n"
TAIL = "G0 Z50\nM5\nM2\n"

SETUP = """mesh_size = {mesh_size}
[program]
dialect = "linuxcnc"
start = {{ X = 0, Y = 0, Z = 100 }}
[offsets]
G54 = {{ X = 0, Y = 0, Z = 0 }}
[stock]
box = [[0, 0, -30], [100, 100, {top}]]
[[fixture]]
name = "jaw"
box = [[-20, -12, -60], [120, -1, -12]]
[[fixture]]
name = "clamp"
box = [[-20, 40, 1], [-4, 60, 14]]
[[tool]]
number = 1
{tool}
spindle = "clockwise"
"""

BALL = 'shape = "ball"\ndiameter = 6\nflute_length = 12\nshank = [[6, 6, 20]]\nholder = [[40, 40, 30]]'
SHORT_BALL = 'shape = "ball"\ndiameter = 6\nflute_length = 4\nshank = [[6, 6, 28]]\nholder = [[40, 40, 30]]'
SHORT_FLAT = 'shape = "flat"\ndiameter = 12\nflute_length = 4\nshank = [[12, 12, 26]]\nholder = [[40, 40, 30]]'
FLAT = 'shape = "flat"\ndiameter = 8\nflute_length = 20\nshank = [[8, 8, 20]]\nholder = [[40, 40, 30]]'
DRILL = 'shape = "drill"\ndiameter = 5\npoint_deg = 118\nflute_length = 30\nshank = [[5, 5, 20]]\nholder = [[40, 40, 30]]'


def surface_tip(x, y, radius=3.0):
    """The height of a ball's tip that touches z = -5 + 3 sin(kx) cos(ky) above (x, y)."""
    k = 2.0 * math.pi / 25.0
    u, v = x, y
    for _ in range(60):
        along_x = 3.0 * k * math.cos(k * u) * math.cos(k * v)
        along_y = -3.0 * k * math.sin(k * u) * math.sin(k * v)
        w = math.sqrt(1.0 + along_x * along_x + along_y * along_y)
        u += 0.5 * (x + radius * along_x / w - u)
        v += 0.5 * (y + radius * along_y / w - v)
    return -5.0 + 3.0 * math.sin(k * u) * math.cos(k * v) + radius / w - radius


def raster(blocks, passes=1):
    lines = []
    rows = math.ceil(blocks / 400)
    for row in range(rows):
        y = 20.13 + 0.4 * row
        xs = [0.125 + 0.25 * i for i in range(min(400, blocks - 400 * row))]
        for x in xs[::-1] if row % 2 else xs:
            lines.append(f"G1 X{x:.3f} Y{y:.3f} Z{surface_tip(x, y):.3f} F1500\n")
    back = "G0 Z20\nG0 X0 Y20\n"
    return HEAD + back.join(["".join(lines)] * passes) + TAIL


def helix():
    lines = ["G0 X60 Y50\nG1 Z1 F800\n"]
    lines += [f"G3 X60 Y50 Z{0.5 - 0.5 * i:.2f} I-10 J0 F800\n" for i in range(16)]
    return HEAD + "".join(lines) + TAIL


def holes():
    lines = [f"X{10 + 16 * (i % 6)} Y{10 + 16 * (i // 6)}\n" for i in range(36)]
    return HEAD + "G0 Z5\nG83 X5 Y5 Z-15 R2 Q5 F200\n" + "".join(lines) + "G80\n" + TAIL


def pocket():
    """A spiral of half circles."""
    lines = ["G0 X50 Y50\nG1 Z-3 F300\n"]
    at = 50.0
    for i in range(1, 40):
        to = 50.0 + (0.8 * i if i % 2 else -0.8 * i)
        lines.append(f"G3 X{to:.3f} Y50 I{(to - at) / 2:.4f} J0 F900\n")
        at = to
    return HEAD + "".join(lines) + TAIL


def many_lines():
    """20,000 lines to be read, half of them with a number."""
    lines = [f"{f'N{i} ' if i % 2 else ''}G1 X{i % 97 + 0.125:.3f} Y{i * 7 % 89 / 3:.4f} Z-{i % 11}.5\n"
             for i in range(20000)]
    return HEAD + "G1 Z0 F800\n" + "".join(lines) + TAIL


def start_of_tilted_faces():
    """The first block of the ring groove."""
    lines = (ASSETS / "programs/tilted_faces.nc").read_text(encoding="utf-8").split("\n")
    first = next(i for i, line in enumerate(lines) if line.startswith("T1 M6"))
    groove = next(i for i, line in enumerate(lines) if line.startswith("T3 M6"))
    return "\n".join(lines[:first] + lines[groove:groove + 1] + ["G54"] + lines[groove + 1:groove + 9]
                     + ["G0 Z30.", "G49", "G53 G0 Z0", "M30", "%", ""])


def turning():
    """A ball end mill that leans 10 degrees goes round a dome, while A tilts it and C turns it in each block."""
    radius, ball, lean, pitch, chord = 50.0, 3.0, 10.0, 0.3, 0.25
    polar, azimuth = math.degrees(math.asin(0.6)), 0.0

    def block(code, lift):
        def direction(angle):
            a, b = math.radians(angle), math.radians(azimuth)
            return (math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a))
        tool = direction(polar + lean)
        tip = [(radius + ball) * n + (lift - ball) * t for n, t in zip(direction(polar), tool)]
        return (f"{code} X{tip[0]:.4f} Y{tip[1]:.4f} Z{tip[2] - 30.0:.4f} A{-(polar + lean):.4f} "
                f"C{-90.0 - azimuth:.4f} F900\n")

    lines = ["G21 G90 G17 G54 G64 P0.02\nT1 M6\nG43 H1\nM428\nS9000 M3\nG0 A-46.87 C-90\n", block("G0", 12.0), block("G1", 0.0)]
    for _ in range(1500):
        step = math.degrees(chord / (radius * math.sin(math.radians(polar))))
        azimuth += step
        polar -= math.degrees(pitch / radius) * step / 360.0
        lines.append(block("G1", 0.0))
    return "".join(lines) + block("G0", 12.0) + "M2\n"


TURNING = f"""mesh_size = 0.5
[program]
dialect = "linuxcnc"
start = {{ X = 0, Y = 0, Z = 120, A = 0, C = 0 }}
tool_at_start = 0
[control]
M428 = "TCP"
[machine]
file = "{ASSETS}/machines/xyzac.toml"
[offsets]
G54 = {{ X = 0, Y = 0, Z = 0 }}
[stock]
cylinder = {{ radius = 31, height = 16 }}
at = [0, 0, 5]
frame = "G54"
[[fixture]]
name = "block"
box = [[-36, -36, 0], [36, 36, 3]]
frame = "G54"
[[tool]]
number = 1
shape = "ball"
diameter = 6
flute_length = 12
shank_diameter = 5
stick_out = 25
holder = {{ preset = "ISO20-ER11", length = 45 }}
[[length_offset]]
number = 1
length = 70
"""


def scenes():
    """Name, program, and set-up or the arguments of the run."""
    def setup(tool, mesh_size, top=0):
        return SETUP.format(mesh_size=mesh_size, tool=tool, top=top)

    tilted = (ASSETS / "setups/tilted_faces.toml").read_text(encoding="utf-8").replace("../", f"{ASSETS}/")
    return [
        ("raster-0.5", raster(4000), setup(BALL, 0.5)),
        ("raster-0.1", raster(500), setup(BALL, 0.1)),
        ("second-pass", raster(1200, 2), setup(BALL, 0.5)),
        ("shank-rubs", raster(300), setup(SHORT_BALL, 0.2, 3)),
        ("helix", helix(), setup(FLAT, 0.5)),
        ("bore", helix(), setup(SHORT_FLAT, 0.5)),
        ("holes", holes(), setup(DRILL, 0.5)),
        ("pocket", pocket(), setup(FLAT, 0.3)),
        ("tilted", start_of_tilted_faces(), tilted),
        ("turning", turning(), TURNING),
        ("trace", many_lines(), ["trace", "{program}", "--dialect", "linuxcnc"]),
        ("distance", "", ["distance", "sphere:20", "box:30,20,10", "--move", "45.3,12.1,7.7", "--rotate", "17,29,41",
                          "--mesh-size", "0.5"]),
    ]


def instructions(feeler, shim, arguments):
    env = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8", "HOME": "/nonexistent", "LD_PRELOAD": shim}
    done = subprocess.run(["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null",
                           feeler, *arguments], env=env, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
    told = done.stderr.decode("utf-8", "replace")
    found = re.search(r"I +refs: +([0-9,]+)", told)
    if done.returncode not in (0, 1) or not found:
        sys.exit(f"valgrind feeler {' '.join(arguments)} ended with status {done.returncode}:\n{told}")
    return int(found.group(1).replace(",", ""))


def expected_figures():
    lines = EXPECTED.read_text(encoding="utf-8").split("\n")
    return {line.split()[0]: float(line.split()[1]) for line in lines if line and not line.startswith("#")}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("feeler")
    parser.add_argument("shim")
    parser.add_argument("--update", action="store_true")
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    if not shutil.which("valgrind"):
        print("skipped: valgrind is not installed")
        return 77
    expected = expected_figures()
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, program, how in scenes():
            if options.scenes and name not in options.scenes:
                continue
            nc, toml = pathlib.Path(folder, f"{name}.nc"), pathlib.Path(folder, "setup.toml")
            nc.write_text(program, encoding="utf-8")
            arguments = ["check", str(nc), "--setup", str(toml), "--jobs", "1"]
            if isinstance(how, str):
                toml.write_text(how, encoding="utf-8")
            else:
                arguments = [argument.format(program=nc) for argument in how]
            found[name] = instructions(options.feeler, options.shim, arguments) / 1e6
            print(f"{name:12} {found[name]:9.1f} million instructions, expected {expected.get(name, math.nan):9.1f}",
                  flush=True)
    if options.update:
        text = EXPECTED.read_text(encoding="utf-8")
        for name, figure in found.items():
            text = re.sub(rf"^{re.escape(name)} +[0-9.]+", f"{name:12} {figure:9.1f}", text, flags=re.MULTILINE)
        EXPECTED.write_text(text, encoding="utf-8")
        return 0
    changes = {name: figure / expected.get(name, math.nan) - 1.0 for name, figure in found.items()}
    changes = {name: change for name, change in changes.items() if not abs(change) <= TOLERANCE}
    for name, change in changes.items():
        print(f"{name}: {100.0 * change:+.1f} %. If that is meant, run instructions.py with --update and state the "
              "reason in instructions.txt.")
    return 1 if changes else 0


sys.exit(main())
