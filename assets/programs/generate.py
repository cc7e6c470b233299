#!/usr/bin/env python3
"""Writes the programs for LinuxCNC's five-axis machines: python3 generate.py

Each function computes the path and the direction of the tool relative to the work, and from them the
positions of the rotary axes, with the directions of the axes in the machine files.
"""

import math
import pathlib

folder = pathlib.Path(__file__).parent


def line_of(code, position, axes):
    """A block; axes are pairs of a letter and an angle."""
    words = [f"{letter}{value:.3f}" for letter, value in zip("XYZ", position)]
    words += [f"{letter}{angle:.3f}" for letter, angle in axes]
    return " ".join([code, *words])


def along(point, direction, distance):
    return tuple(p + distance * d for p, d in zip(point, direction))


def dome(follows_tip):
    """A dome of radius 20 on a bar of 24, in a spiral from its rim to its top. The ball end mill of 6
    leans 10 degrees outwards from the surface."""
    radius, ball, rim, lean, step = 20.0, 3.0, 12.0, 10.0, 1.0
    apex = 24.0  # above the rotary table

    def place(polar, azimuth):
        """The tip, and the direction of the tool, both relative to the work."""
        def direction(angle):
            a, b = math.radians(angle), math.radians(azimuth)
            return (math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a))

        centre = along((0.0, 0.0, apex - radius), direction(polar), radius + ball)
        tool = direction(polar + lean)
        # A tilts the tool to -Y of the table, and C turns it from there the other way round.
        return along(centre, tool, -ball), tool, (("A", -(polar + lean)), ("C", -90.0 - azimuth))

    widest = math.asin(rim / radius)  # angle from the axis to the rim
    turns = widest * radius / step
    points = []
    for i in range(int(turns * 36) + 1):
        done = i / (turns * 36)
        points.append(place(math.degrees(widest) * (1.0 - done), 10.0 * i))
    start, tool, axes = points[0]
    text = [
        "(A DOME OF RADIUS 20 ON A BAR OF 24)",
        "(G54: X0 Y0 ON THE AXIS OF C, Z0 ON THE FACE OF THE ROTARY TABLE)",
        "(T1 BALL END MILL 6)",
        "G21 G17 G90 G40 G49 G80 G94",
        "G53 G0 Z120.",
        "T1 M6",
        "G54",
        "S6000 M3",
        "G43 H1",
    ]
    if follows_tip:
        text += ["M428 (THE TIP FOLLOWS THE WORK)"]
    text += [
        line_of("G0", along(start, tool, 8.0), axes),
        line_of("G0", along(start, tool, 3.0), ()),
        line_of("G1", start, ()) + " F300.",
    ]
    text += [line_of("G1", point, turned) + (" F600." if i == 0 else "")
             for i, (point, _, turned) in enumerate(points[1:])]
    end, tool, _ = points[-1]
    text += [line_of("G0", along(end, tool, 8.0), ())]
    if follows_tip:
        text += ["M429"]
    return text + ["G53 G0 Z120.", "G0 A0.", "M5", "G49", "M30"]


def flutes():
    """Six spiral flutes in a bar of 30, with a ball end mill of 4 that leans 15 degrees towards the
    free end."""
    radius, ball, depth, lean = 15.0, 2.0, 1.5, 15.0
    first, last, twist = 62.0, 32.0, 60.0  # X of a flute's ends, and its rotation

    def place(x, angle):
        a, b = math.radians(angle), math.radians(lean)
        normal = (0.0, -math.sin(a), math.cos(a))
        tool = (math.sin(b), -math.cos(b) * math.sin(a), math.cos(b) * math.cos(a))
        centre = along((x, 0.0, 0.0), normal, radius - depth + ball)
        return along(centre, tool, -ball), tool, (("A", angle), ("B", lean))

    text = [
        "(SIX SPIRAL FLUTES IN A BAR OF 30)",
        "(G54: X0 ON THE FACE OF THE ROTARY TABLE, Y0 Z0 ON THE AXIS OF A)",
        "(T2 BALL END MILL 4)",
        "G21 G17 G90 G40 G49 G80 G94",
        "G53 G0 Z200.",
        "T2 M6",
        "G54",
        "S8000 M3",
        "G43 H2",
        "M428 (THE TIP FOLLOWS THE WORK)",
    ]
    for flute in range(6):
        begin = 60.0 * flute
        start, tool, axes = place(first, begin)
        text += [
            f"(FLUTE {flute + 1})",
            line_of("G0", along(start, tool, 40.0), axes),
            line_of("G0", along(start, tool, 3.0), ()),
            line_of("G1", start, ()) + " F200.",
        ]
        steps = 30
        for i in range(1, steps + 1):
            end, tool, axes = place(first + (last - first) * i / steps, begin + twist * i / steps)
            text.append(line_of("G1", end, axes) + (" F400." if i == 1 else ""))
        text.append(line_of("G0", along(end, tool, 40.0), ()))
    return text + ["M429", "G53 G0 Z200.", "G0 A0. B0.", "M5", "G49", "M30"]


for name, program in (("dome.ngc", dome(True)), ("dome_m428.ngc", dome(False)),
                      ("flutes.ngc", flutes())):
    (folder / name).write_text("\n".join(program) + "\n")
