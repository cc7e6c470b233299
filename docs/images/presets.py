#!/usr/bin/env python3
"""Makes the pictures of docs/manual/presets.md: docs/images/presets/NAME.png.

    presets.py FEELER [NAME...]     FEELER: the program; without names, all pictures

Each shows a preset with a part, and arrows at its origin. `feeler shot` takes the picture; it is stored with at most
128 colours, so that all of them together stay small.
"""
import collections
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

FOLDER = pathlib.Path(__file__).parent / "presets"
SIZE = (400, 300)
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


def shoot(feeler, preset, folder):
    """The picture as rows of pixels (red, green, blue)."""
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
        for preset in names or PARTS:
            picture = png_of(*with_few_colours(shoot(feeler, preset, pathlib.Path(folder))))
            (FOLDER / f"{preset}.png").write_bytes(picture)
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve()), sys.argv[2:]))
