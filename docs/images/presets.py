#!/usr/bin/env python3
"""Makes the pictures of presets in the manual: docs/images/presets/NAME.png.

    presets.py FEELER [NAME...]     FEELER: the program; without names, all pictures

Each shows a fixture with a part, a holder with a tool, or a machine with a part, and arrows at the origin. `feeler
shot` takes the picture; it is stored with at most 128 colours, so that all of them together stay small.
"""
import collections
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

FOLDER = pathlib.Path(__file__).parent / "presets"
SIZE = (400, 300)
HOLDER_SIZE = (200, 200)
MACHINE_SIZE = (260, 200)
COLOURS = 128

# The part in the picture, as the shape of [stock], in the frame of the preset.
PARTS = {
    "vise-6": "box = [[-60, -100, 20], [60, 0, 60]]",
    "strap-clamp-m12": "box = [[-60, -35, -25], [14, 35, 0]]",
    "step-clamp-m12": "box = [[-60, -35, -25], [14, 35, 0]]",
    "stud-m12": "box = [[-35, -30, -30], [35, 30, 0]]",
    "toe-clamp": "box = [[-70, -45, -4], [0, 45, 14]]",
    "1-2-3-block": "box = [[-22, -14, 25.4], [22, 14, 45]]",
    "parallel": "box = [[-40, -12, 30], [40, 12, 44]]",
    "step-block": "box = [[50, -12, 44], [110, 12, 56]]",
    "fixture-plate": "box = [[-60, -40, 0], [60, 40, 40]]",
    "t-slot-table-14": "box = [[-120, -60, 0], [120, 60, 60]]",
    "tombstone": "box = [[-70, -140, 120], [70, -100, 300]]",
    "3-jaw-chuck-6": "cylinder = { radius = 25, height = 90 }",
    "4-jaw-chuck-6": "cylinder = { radius = 25, height = 90 }",
    "collet-block-hex": "cylinder = { radius = 14, height = 50 }",
    "collet-block-square": "cylinder = { radius = 14, height = 50 }",
    "dividing-head": 'cylinder = { radius = 20, height = 110, axis = "X" }',
}

# One of each taper, one of each attachment.
HOLDERS = ("BT30-ER16", "BT40-ER32", "CAT40-ER20", "CAT50-ER40", "SK40-ER25", "HSK-A63-ER32", "ISO20-ER16", "R8-ER20",
           "ROUTER-ER20", "CAT40-EM16", "BT40-SF12", "HSK-A63-HC12", "BT40-SM27", "R8-DC13", "BT40-TC12")

# The tool stays far above, out of the picture.
PROGRAM = "G21 G90 G54\nG0 Z5000\nM30\n"

SETUP = """\
[program]
dialect = "fanuc"
start = {{ X = 0, Y = 0, Z = 5000 }}
[offsets]
G54 = {{ X = 0, Y = 0, Z = 0 }}
[stock]
{part}
[[fixture]]
name = "{kind}"
preset = "{preset}"
"""


HOLDER_SETUP = """\
[program]
dialect = "fanuc"
start = {{ X = 0, Y = 0, Z = 5000 }}
[offsets]
G54 = {{ X = 0, Y = 0, Z = 0 }}
[stock]
cylinder = {{ radius = {radius}, height = 40 }}
at = [0, 0, -40]
[[fixture]]
name = "body"
mesh = "p.stl"
"""

MACHINE_SETUP = """\
allowance = 0
[program]
dialect = "fanuc"
start = {{ X = {x}, Y = {y}, Z = {z} }}
[machine]
preset = "{preset}"
{sizes}
[offsets]
G54 = {{ X = {x}, Y = {y}, Z = {top} }}
[stock]
box = [[-{half}, -{half}, 0], [{half}, {half}, {half}]]
{corners}
"""


def picture_of(feeler, program, setup, folder, size):
    """The rows of pixels (red, green, blue)."""
    (folder / "p.nc").write_text(program)
    (folder / "p.toml").write_text(setup)
    subprocess.run([feeler, "shot", folder / "p.nc", "--setup", folder / "p.toml", "--block", "0", "--no-ui", "--theme",
                    "light", "--view", "iso", "--size", "x".join(map(str, size)), "-o", folder / "p.png"], check=True)
    return pixels_of((folder / "p.png").read_bytes())


def shoot_holder(feeler, preset, folder):
    """A holder above a tool."""
    subprocess.run([feeler, "presets", preset, "-o", folder / "p.stl"], check=True)
    radius = 3 if "16" in preset or "SF" in preset or "HC" in preset else 5
    return picture_of(feeler, "G21 G90 G54\nM30\n", HOLDER_SETUP.format(radius=radius), folder, HOLDER_SIZE)


def machine_names(feeler):
    listed = subprocess.run([feeler, "presets", "--format", "json"], check=True, capture_output=True)
    return [machine["name"] for machine in json.loads(listed.stdout)["machines"]]


def with_usual_places(sizes):
    """The sizes that a picture needs and nobody has stated."""
    x, y = (0.5 * (sizes[axis + "_min"] + sizes[axis + "_max"]) for axis in "xy")
    travel = sizes["z_max"] - sizes["z_min"]
    usual = {"centre_x": x, "centre_y": y, "centre_z": sizes["z_min"] - 100, "centre_to_table": 50,
             "spindle_to_table": 60, "pivot_length": 250, "nose_to_table": travel + 100,
             "table_length": 1.2 * (sizes["x_max"] - sizes["x_min"]), "table_width": sizes["y_max"] - sizes["y_min"],
             "table_diameter": 300}
    return {key: value for key, value in usual.items() if key in sizes and sizes[key] is None}


def shoot_machine(feeler, preset, folder):
    """A machine in the middle of its travel, with a part. What nobody has stated has some size."""
    shown = subprocess.run([feeler, "presets", preset, "--format", "json"], check=True, capture_output=True)
    report = json.loads(shown.stdout)
    sizes = {size["key"]: size["value"] for size in report["sizes"]}
    stated = with_usual_places(sizes)
    sizes |= stated
    x, y, z = (0.5 * (sizes[axis + "_min"] + sizes[axis + "_max"]) for axis in "xyz")
    half = 0.06 * (sizes["x_max"] - sizes["x_min"])
    if report["kind"] == "horizontal":
        top, low, high = sizes["z_min"] - 100, y - 300, y + 300
    elif "centre_to_table" in sizes:
        top = low = high = sizes["centre_z"] - 50
    else:
        top = low = high = sizes["z_max"] - sizes["nose_to_table"]
    reach = 0.6 * max(sizes["x_max"] - sizes["x_min"], sizes["y_max"] - sizes["y_min"])
    body = sizes["nose_length"] + sizes.get("head_height", 0)
    corners = ((x - reach, y - reach, top - 60), (x + reach, y + reach, z + body))
    text = "".join(f'[[fixture]]\nname = "corner-{i}"\nframe = "machine"\nbox = [[{u}, {v}, {w}], [{u + .1}, {v + .1}, {w + .1}]]\n'
                   for i, (u, v, w) in enumerate(corners))
    setup = MACHINE_SETUP.format(preset=preset, x=x, y=y, z=z, top=top, half=half, corners=text,
                                 sizes="".join(f"{key} = {value}\n" for key, value in stated.items()))
    return picture_of(feeler, "G21 G90 G54\nM30\n", setup, folder, MACHINE_SIZE)


def shoot(feeler, preset, folder):
    """The picture as rows of pixels (red, green, blue)."""
    if preset in HOLDERS:
        return shoot_holder(feeler, preset, folder)
    if preset not in PARTS:
        return shoot_machine(feeler, preset, folder)
    kind = "vise" if "vise" in preset or "chuck" in preset else "clamp" if "clamp" in preset else "body"
    program, setup, picture = folder / "p.nc", folder / "p.toml", folder / "p.png"
    program.write_text(PROGRAM)
    setup.write_text(SETUP.format(part=PARTS[preset], kind=kind, preset=preset))
    subprocess.run([feeler, "shot", program, "--setup", setup, "--block", "1", "--no-ui", "--theme", "light", "--view",
                    "iso", "--size", "x".join(map(str, SIZE)), "-o", picture], check=True)
    return pixels_of(picture.read_bytes())


def chunks_of(png):
    at = 8
    while at < len(png):
        length, name = struct.unpack(">I4s", png[at:at + 8])
        yield name, png[at + 8:at + 8 + length]
        at += length + 12


def pixels_of(png):
    """The rows of a PNG of 8 bits for each channel, without interlacing."""
    chunks = collections.defaultdict(bytes)
    for name, data in chunks_of(png):
        chunks[name] += data
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    channels = {2: 3, 6: 4}[kind]
    assert depth == 8 and not interlaced
    data = zlib.decompress(chunks[b"IDAT"])
    rows, above, stride = [], bytearray(width * channels), width * channels
    for y in range(height):
        start = y * (stride + 1)
        row = unfiltered(data[start], bytearray(data[start + 1:start + 1 + stride]), above, channels)
        rows.append([tuple(row[x:x + 3]) for x in range(0, stride, channels)])
        above = row
    return rows


def unfiltered(kind, row, above, channels):
    for i in range(len(row)):
        left = row[i - channels] if i >= channels else 0
        corner = above[i - channels] if i >= channels else 0
        up = above[i]
        if kind == 4:
            guess = left + up - corner
            near = sorted((abs(guess - value), order, value) for order, value in enumerate((left, up, corner)))
            add = near[0][2]
        else:
            add = (0, left, up, (left + up) // 2)[kind]
        row[i] = (row[i] + add) & 255
    return row


def coarse(pixel):
    return tuple(min(255, (value + 4) // 8 * 8) for value in pixel)


def with_few_colours(rows):
    """The palette, and rows of indices into it."""
    counts = collections.Counter(coarse(pixel) for row in rows for pixel in row)
    palette = sorted(colour for colour, _ in sorted(counts.items(), key=lambda item: (-item[1], item[0]))[:COLOURS])
    nearest = {colour: min(range(len(palette)), key=lambda i: sum((a - b)**2 for a, b in zip(colour, palette[i])))
               for colour in sorted(counts)}
    return palette, [bytes(nearest[coarse(pixel)] for pixel in row) for row in rows]


def png_of(palette, rows):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"PLTE", b"".join(map(bytes, palette)))
            + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 9)) + chunk(b"IEND", b""))


def main(feeler, names):
    FOLDER.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for preset in names or [*PARTS, *HOLDERS, *machine_names(feeler)]:
            picture = png_of(*with_few_colours(shoot(feeler, preset, pathlib.Path(folder))))
            (FOLDER / f"{preset}.png").write_bytes(picture)
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve()), sys.argv[2:]))
