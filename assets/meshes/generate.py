#!/usr/bin/env python3
"""Write the meshes of this folder: binary STL, millimetres, closed, facing outwards.

Every mesh is checked before it is written: each edge is used once in each direction, and the
volume must equal the one computed by another method. Every run writes the same bytes.
"""

import math

from solids import (
    along_x,
    along_y,
    chamfered_box,
    chamfered_box_volume,
    drilled_block,
    drilled_block_volume,
    prism,
    turned,
    turned_volume,
)
from stl import write_checked

# --- the meshes ----------------------------------------------------------------------------------


def vise_profile(opening):
    """Bed, fixed jaw (+y) and moving jaw (-y), seen along the jaws. Bed at z 0, jaws 50 high."""
    half = opening / 2
    return [
        (-half - 75, -40),
        (half + 70, -40),
        (half + 70, -18),
        (half + 40, -18),
        (half + 40, 40),
        (half + 30, 50),
        (half, 50),
        (half, 0),
        (-half, 0),
        (-half, 50),
        (-half - 35, 50),
        (-half - 45, 40),
        (-half - 45, -18),
        (-half - 75, -18),
    ]


def write_vise(name, opening):
    profile = vise_profile(opening)
    # Base, two flanges less deep than the jaws, jaws without their chamfer of 10.
    sections = (opening + 145) * 22 + (opening + 85) * 18 + (40 + 45) * 50 - 2 * 10 * 10 / 2
    write_checked(name, along_x(profile, 150), sections * 150)


def write_clamp(name):
    """A strap clamp on its own heel: nose at x 0, resting at z 0; heel 22 lower."""
    profile = [(0, 0), (30, 0), (30, 3), (85, 3), (85, -22), (110, -22), (110, 20), (25, 20), (0, 8)]
    # Strap of 20, less the relief below and the slope of the nose, and the heel.
    section = 110 * 20 - 55 * 3 - 25 * 12 / 2 + 25 * 22
    write_checked(name, along_y(profile, 30), section * 30)


def write_blank(name):
    size, chamfer = (116, 116, 46), 0.5
    write_checked(name, chamfered_box(size, chamfer), chamfered_box_volume(size, chamfer))


# Upper side of PARALLEL.NC's work, about 0.3 mm above the finished surface: y and z, mm.
ROUGHED_TOP = [
    (0.0, -10.15),
    (6.5, -8.3),
    (12.0, -7.4),
    (18.5, -6.9),
    (19.5, -6.3),
    (21.2, -4.4),
    (22.7, -3.45),
    (27.0, -2.1),
    (32.0, -1.15),
    (37.1, -0.7),
    (38.1, -0.7),
]


def write_roughed(name):
    """Roughed and drilled 8.5 mm; finished holes are 3/8 inch."""
    block = (38.1, ROUGHED_TOP, -35.0, [(19.05, 14.46, 4.25), (19.05, 30.65, 4.25)])
    write_checked(name, drilled_block(*block), drilled_block_volume(*block))


# --- the 6 inch vise: three meshes, combined for any opening -------------------------------------


def write_vise6():
    """Origin: on the bed, at the fixed jaw's face, in the middle of the jaws' width."""
    width, front, back = 152.0, 330.0, 75.0
    foot = [(-76, -73), (76, -73), (76, -45), (60, -45), (60, 0), (-60, 0), (-60, -45), (-76, -45)]
    body = prism(foot, front + back, lambda u, v, w: (u, back - w, v))
    write_checked("vise6-body.stl", body, (152 * 28 + 120 * 45) * (front + back))
    fixed = [(0, 0), (60, 0), (60, 25), (45, 45), (0, 45)]
    write_checked("vise6-fixed-jaw.stl", along_x(fixed, width), (60 * 45 - 15 * 20 / 2) * width)
    moving = [(-85, 0), (0, 0), (0, 45), (-45, 45), (-85, 25)]
    write_checked("vise6-moving-jaw.stl", along_x(moving, width), (85 * 45 - 40 * 20 / 2) * width)


# --- a strap clamp: fork, stud with nut, step block ----------------------------------------------


def write_fork(name):
    """A forked strap, 125 x 40 x 25: nose at x 0 resting at z 0, open at the back for an M12 stud."""
    plan = [(0, -20), (125, -20), (125, -7), (30, -7), (30, 7), (125, 7), (125, 20), (0, 20)]
    upright = lambda u, v, w: (u, v, w)
    write_checked(name, prism(plan, 25.0, upright), (125 * 40 - 95 * 14) * 25)


def write_stud(name):
    """M12 with washer and nut, which rest on the strap at z 0; protrudes 12 mm from the nut."""
    count = 24
    stud, nut, washer = (r / math.cos(math.pi / count) for r in (6.0, 11.0, 13.0))
    profile = [(-100, 0), (33, 0), (33, stud), (21, stud), (21, nut), (3, nut), (3, washer)]
    profile += [(0, washer), (0, stud), (-100, stud)]
    rings = [(stud, 0, 100), (washer, 0, 3), (nut, 0, 18), (stud, 0, 12)]
    upright = lambda u, v, w: (u, v, w)
    write_checked(name, turned(profile, count, upright), turned_volume(rings, count))


def write_step_block(name):
    """Five steps of 12 x 8, the lowest 12 high at x 0, the highest 44 high at x 60; 30 wide."""
    profile = [(0, 0), (60, 0), (60, 44), (48, 44), (48, 36), (36, 36), (36, 28), (24, 28)]
    profile += [(24, 20), (12, 20), (12, 12), (0, 12)]
    write_checked(name, along_y(profile, 30), 12 * (12 + 20 + 28 + 36 + 44) * 30)


# --- a chuck for a rotary table, and the cradle of a trunnion ------------------------------------


def write_chuck(name):
    """Three-jaw chuck without its jaws, 160 across, axis X; its back at x 0, its face at x 66."""
    count, bore = 36, 20.0
    body, step = (r / math.cos(math.pi / count) for r in (80.0, 62.5))
    profile = [(0, bore), (66, bore), (66, body), (12, body), (12, step), (0, step)]
    rings = [(step, bore, 12), (body, bore, 54)]
    along = lambda u, v, w: (w, u, v)
    write_checked(name, turned(profile, count, along), turned_volume(rings, count))


def write_chuck_jaw(name):
    """One jaw, 20 wide: on the chuck's face at x 0, gripping at z 0, outwards along +z."""
    profile = [(0, 0), (37, 0), (37, 14), (26, 14), (26, 32), (15, 32), (15, 50), (0, 50)]
    write_checked(name, along_y(profile, 20), (37 * 14 + 26 * 18 + 15 * 18) * 20)


def write_cradle(name):
    """A trunnion's cradle seen from the front, 180 deep; the origin is on its tilting axis."""
    profile = [(-190, -120), (190, -120), (190, 90), (150, 90), (150, -70), (-150, -70)]
    profile += [(-150, 90), (-190, 90)]
    write_checked(name, along_y(profile, 180), (380 * 50 + 2 * 40 * 160) * 180)


if __name__ == "__main__":
    write_vise("vise-116.stl", 116)
    write_vise("vise-38.stl", 38.1)
    write_clamp("clamp.stl")
    write_blank("blank.stl")
    write_roughed("roughed.stl")
    write_vise6()
    write_fork("fork.stl")
    write_stud("stud.stl")
    write_step_block("step-block.stl")
    write_chuck("chuck.stl")
    write_chuck_jaw("chuck-jaw.stl")
    write_cradle("cradle.stl")
