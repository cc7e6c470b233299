"""Checked binary STL files."""

import math
import struct
from pathlib import Path

FOLDER = Path(__file__).resolve().parent


def check_closed(name, solid):
    edges = set()
    for triangle in solid:
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            assert a != b, f"{name}: an edge without length at {a}"
            assert (a, b) not in edges, f"{name}: the edge {a} {b} is used twice"
            edges.add((a, b))
    for a, b in edges:
        assert (b, a) in edges, f"{name}: open at the edge {a} {b}"


def volume(solid):
    def det(a, b, c):
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    return math.fsum(det(*triangle) for triangle in solid) / 6


def normal(a, b, c):
    u, v = ([q - p for p, q in zip(a, other)] for other in (b, c))
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(x * x for x in n))
    return tuple(x / length for x in n)


def write_stl(name, solid):
    data = bytearray(f"{name}, mm".encode().ljust(80)) + struct.pack("<I", len(solid))
    for triangle in solid:
        values = [*normal(*triangle), *(x for p in triangle for x in p)]
        data += struct.pack("<12fH", *(x + 0.0 for x in values), 0)
    (FOLDER / name).write_bytes(data)


def rounded_to_float(solid):
    """The coordinates as stored in the file."""
    as_float = lambda x: struct.unpack("<f", struct.pack("<f", x))[0] + 0.0
    return [tuple(tuple(map(as_float, p)) for p in triangle) for triangle in solid]


def write_checked(name, solid, expected_volume):
    solid = rounded_to_float(solid)
    check_closed(name, solid)
    found = volume(solid)
    assert abs(found - expected_volume) <= 1e-6 * expected_volume, (name, found, expected_volume)
    write_stl(name, solid)
    print(f"{name}: {len(solid)} triangles, {found:.1f} mm3")
