#!/usr/bin/env python3
"""Checks small random programs and reports the CPU time of the slowest.

usage: random_programs.py FEELER [--programs N] [--first SEED] [--mesh-size MM] [--limit SECONDS]
                          [--jobs N] [--keep FOLDER]

Each program has 40 to 70 lines and a set-up with a stock, three tools and up to ten fixtures. The
tool is moved without regard to collisions: feeds, rapids and arcs in all planes, above, in and
beside the stock. The programs depend on the seed only. Exit status 1: a program took longer than
the limit, or the check failed. `--keep` writes the programs there, as SEED.nc and SEED.toml.
"""
import argparse
import concurrent.futures
import math
import os
import random
import sys
import tempfile

AXIS = """[[machine.axis]]
name = "{name}"
kind = "linear"
side = "{side}"
direction = {direction}
min = -2000
max = 2000
home = {home}
rapid = 20000
acceleration = 3000
"""

SHAPES = ["flat", "ball", "bull", "drill", "flat", "ball", "bull", "dovetail", "tslot", "taper",
          "chamfer", "lollipop"]


def tool(dice, number):
    shape = dice.choice(SHAPES)
    d = round(dice.uniform(2.0, 13.0), 2)
    flutes = dice.uniform(0.8, 2.5) * d
    keys = {"number": number, "shape": f'"{shape}"', "diameter": d}
    top = d
    if shape == "bull":
        keys["corner_radius"] = round(dice.uniform(0.05, 0.45) * d, 2)
    elif shape == "drill":
        keys["point_deg"] = round(dice.uniform(90, 140), 1)
    elif shape in ("taper", "chamfer"):
        keys["angle_deg"] = round(dice.uniform(10, 50), 1)
        keys["tip_diameter"] = round(dice.uniform(0.1, 0.6) * d, 2)
    elif shape == "tslot":
        keys["neck_diameter"], keys["neck_length"] = round(0.5 * d, 2), round(2 * d, 2)
        flutes = dice.uniform(0.2, 0.5) * d
    elif shape == "dovetail":
        keys["angle_deg"] = round(dice.uniform(15, 40), 1)
        flutes = dice.uniform(0.2, 0.4) * d
        narrowest = d - 2 * flutes * math.tan(math.radians(keys["angle_deg"]))
        keys["neck_diameter"] = math.floor(dice.uniform(50, 99) * narrowest) / 100
        keys["neck_length"] = round(dice.uniform(1, 3) * d, 2)
    elif shape == "lollipop":
        keys["neck_diameter"] = round(dice.uniform(0.3, 0.7) * d, 2)
        keys["neck_length"] = round(dice.uniform(1, 3) * d, 2)
    if shape != "lollipop":
        keys["flute_length"] = round(flutes, 2)
    first = top if dice.random() < 0.7 else round(dice.uniform(0.7, 1.4) * top, 2)
    shank = [[first, first, round(dice.uniform(4, 20), 2)]]
    if dice.random() < 0.4:
        shank.append([first, round(dice.uniform(0.9, 1.5) * first, 2), round(dice.uniform(4, 15), 2)])
    holder = []
    for _ in range(dice.randint(1, 3)):
        a = round(dice.uniform(20, 63), 1)
        b = a if dice.random() < 0.5 else round(dice.uniform(20, 63), 1)
        holder.append([a, b, round(dice.uniform(5, 35), 1)])
    keys["shank"], keys["holder"], keys["spindle"] = shank, holder, '"clockwise"'
    return "[[tool]]\n" + "".join(f"{k} = {v}\n" for k, v in keys.items()), shape


def fixtures(dice):
    text = ""
    for i in range(dice.choice([0, 0, 5, 6, 7, 8, 9, 10])):
        size = [round(dice.uniform(3, 25), 2) for _ in range(3)]
        x, y = dice.choice([(dice.uniform(-35, -8), dice.uniform(-20, 60)),
                            (dice.uniform(42, 60), dice.uniform(-20, 60)),
                            (dice.uniform(-20, 60), dice.uniform(-35, -8)),
                            (dice.uniform(-20, 60), dice.uniform(42, 60))])
        z = dice.uniform(-30, 2)
        text += f'[[fixture]]\nname = "clamp {i}"\n'
        if dice.random() < 0.3:
            text += f'cylinder = {{ radius = {size[0]}, height = {size[2]}, axis = "Z" }}\n'
        else:
            text += f"box = [[0, 0, 0], {size}]\n"
        text += f"at = [{x:.2f}, {y:.2f}, {z:.2f}]\n"
        if dice.random() < 0.2:
            text += f"rotate_deg = [0, 0, {dice.uniform(-90, 90):.1f}]\n"
        if dice.random() < 0.1:
            text += "expendable = true\n"
    return text


def setup(dice, mesh_size):
    text = f"mesh_size = {mesh_size}\n"
    text += '[program]\ndialect = "linuxcnc"\nstart = { X = 0, Y = 0, Z = 400 }\n'
    text += '[machine]\nrapid = "straight"\n'
    for name, side, direction, home in (("X", "table", [1, 0, 0], 0), ("Y", "table", [0, 1, 0], 0),
                                        ("Z", "tool", [0, 0, 1], 400)):
        text += AXIS.format(name=name, side=side, direction=direction, home=home)
    text += "[offsets]\nG54 = { X = 0, Y = 0, Z = 0 }\n[stock]\n"
    if dice.random() < 0.4:
        text += 'cylinder = { radius = 20.0, height = 25, axis = "Z" }\nat = [20.0, 20.0, -25]\n'
    else:
        text += "box = [[0, 0, -25], [40, 40, 0]]\n"
    shapes = []
    for number in (1, 2, 3):
        table, shape = tool(dice, number)
        text += table
        shapes.append(shape)
    return text + fixtures(dice), shapes


class Program:
    """Lines of a program, and where its tool is."""

    def __init__(self, dice):
        self.dice = dice
        self.at = [0.0, 0.0, 60.0]
        self.lines = ["G21 G90 G17 G40 G49 G80", "G54"]

    def go(self, code, to):
        self.at = list(to)
        self.lines.append(f"{code} X{to[0]:.4f} Y{to[1]:.4f} Z{to[2]:.4f}")

    def point(self, low, high):
        return [self.dice.uniform(-10, 50), self.dice.uniform(-10, 50), self.dice.uniform(low, high)]

    def arc(self):
        dice = self.dice
        plane = dice.choice([17, 17, 18, 19])
        u, v = {17: (0, 1), 18: (2, 0), 19: (1, 2)}[plane]
        radius, angle = dice.uniform(1.5, 25), dice.uniform(0, 2 * math.pi)
        turn = 2 * math.pi if dice.random() < 0.35 else dice.uniform(0.3, 6.0)
        code = dice.choice(["G2", "G3"])
        sign = 1 if code == "G3" else -1
        i, j = round(-radius * math.cos(angle), 4), round(-radius * math.sin(angle), 4)
        end = list(self.at)
        if turn < 2 * math.pi:
            c, s = math.cos(sign * turn), math.sin(sign * turn)
            end[u] = self.at[u] + i - i * c + j * s
            end[v] = self.at[v] + j - i * s - j * c
        normal = 3 - u - v
        if dice.random() < 0.3:
            end[normal] += dice.uniform(-4, 3)
        offsets = f"{'IJK'[u]}{i:.4f} {'IJK'[v]}{j:.4f}"
        self.at = [round(x, 4) for x in end]
        x, y, z = self.at
        self.lines.append(f"G{plane} {code} X{x:.4f} Y{y:.4f} Z{z:.4f} {offsets}")
        self.lines.append("G17")

    def stroke(self):
        dice = self.dice
        self.go("G0", self.point(1.5, 5))
        start = list(self.at)
        self.go("G1", [*(self.point(0, 0)[:2] if dice.random() < 0.5 else self.at[:2]),
                       dice.uniform(-3.5, -0.3)])
        floor = self.at[2]
        for _ in range(dice.randint(0, 4)):
            if dice.random() < 0.4:
                self.arc()
            elif dice.random() < 0.2:
                self.go("G1", self.point(-6, -0.1))
            else:
                self.go("G1", self.point(0, 0)[:2] + [floor])
        if dice.random() < 0.2:
            self.go("G0", self.point(0, 0)[:2] + [dice.uniform(-3, 3)])
        if dice.random() < 0.2:
            self.go("G0", start[:2] + [self.at[2]])
        self.go("G0", self.at[:2] + [dice.choice([20.0, dice.uniform(1, 30)])])

    def drill(self):
        self.go("G0", self.point(2, 5))
        self.go("G1", self.at[:2] + [self.dice.uniform(-20, -1)])
        self.go("G0", self.at[:2] + [self.dice.uniform(2, 20)])

    def change(self, number):
        self.go("G0", self.at[:2] + [60.0])
        self.lines += [f"T{number} M6", f"G43 H{number}", "S1000 M3"]
        if number == 1:
            self.lines.append("F500")
        self.go("G0", self.at[:2] + [90.0])


def program(dice, shapes):
    made = Program(dice)
    length = dice.randint(40, 68)
    for number in (1, 2, 3):
        made.change(number)
        while len(made.lines) < length * number / 3 - 2:
            if shapes[number - 1] == "drill" and dice.random() < 0.8:
                made.drill()
            else:
                made.stroke()
    return "\n".join(made.lines + ["M2"]) + "\n"


def generate(seed, mesh_size):
    dice = random.Random(seed)
    setup_text, shapes = setup(dice, mesh_size)
    return program(dice, shapes), setup_text


def check(feeler, seed, mesh_size, folder):
    """CPU seconds and exit status of the check of one program."""
    nc, toml = generate(seed, mesh_size)
    base = os.path.join(folder, str(seed))
    for ending, text in ((".nc", nc), (".toml", toml)):
        with open(base + ending, "w", encoding="utf-8") as file:
            file.write(text)
    command = [feeler, "check", base + ".nc", "--setup", base + ".toml", "--format", "json", "-o",
               base + ".json"]
    child = os.posix_spawn(feeler, command, os.environ,
                           file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
    _, status, used = os.wait4(child, 0)
    return used.ru_utime + used.ru_stime, os.waitstatus_to_exitcode(status)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("feeler")
    parser.add_argument("--programs", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--mesh-size", type=float, default=0.5)
    parser.add_argument("--limit", type=float, default=3.0)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--keep")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch, \
            concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        folder = options.keep or scratch
        os.makedirs(folder, exist_ok=True)
        seeds = range(options.first, options.first + options.programs)
        found = list(pool.map(
            lambda seed: (*check(options.feeler, seed, options.mesh_size, folder), seed), seeds))
    failed = [seed for _, status, seed in found if status not in (0, 1)]
    found.sort(reverse=True)
    times = [seconds for seconds, _, _ in found]
    print(f"{len(times)} programs: {sum(times):.1f} s of CPU time, median "
          f"{times[len(times) // 2]:.2f} s")
    for seconds, _, seed in found[:10]:
        print(f"{seconds:8.2f} s  seed {seed}")
    if failed:
        print("the check failed for seeds", *failed)
    sys.exit(1 if failed or times[0] > options.limit else 0)


if __name__ == "__main__":
    main()
