"""Solids: lists of triangles, each three (x, y, z), facing outwards; and their volumes."""

import math

# --- polygons: lists of (u, v), counter-clockwise ------------------------------------------------


def cross(a, b, c):
    """Twice the area of triangle abc, positive when it turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def triangulate(polygon):
    """Ear clipping of a simple polygon. Points on straight edges are kept as corners."""
    rest, triangles = list(polygon), []
    while len(rest) > 3:
        ear = next(i for i in range(len(rest)) if is_ear(rest, i))
        triangles.append((rest[ear - 1], rest[ear], rest[(ear + 1) % len(rest)]))
        del rest[ear]
    assert cross(*rest) > 0, "the rest of the polygon is flat"
    return triangles + [tuple(rest)]


def is_ear(polygon, i):
    corner = (polygon[i - 1], polygon[i], polygon[(i + 1) % len(polygon)])
    if cross(*corner) <= 1e-9:
        return False
    return not any(is_inside(p, corner) for p in polygon if p not in corner)


def is_inside(p, triangle):
    """The border counts as inside, so that no ear cuts a point off an edge."""
    a, b, c = triangle
    return min(cross(a, b, p), cross(b, c, p), cross(c, a, p)) >= -1e-9


# --- solids: lists of triangles, each three (x, y, z) --------------------------------------------


def prism(polygon, length, point):
    """The polygon extruded along its normal; `point(u, v, w)` gives x, y, z, w from 0 to length."""
    low = lambda p: point(p[0], p[1], 0.0)
    high = lambda p: point(p[0], p[1], length)
    solid = []
    for a, b, c in triangulate(polygon):
        solid += [(high(a), high(b), high(c)), (low(c), low(b), low(a))]
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        solid += [(low(a), low(b), high(b)), (low(a), high(b), high(a))]
    return solid


def along_x(polygon, width):
    """A profile in (y, z), extruded over x from -width/2 to width/2."""
    return prism(polygon, width, lambda u, v, w: (w - width / 2, u, v))


def along_y(polygon, width):
    """A profile in (x, z), extruded over y from -width/2 to width/2."""
    # (u, v, w) -> (x, z, -y) keeps the axes right-handed.
    return prism(polygon, width, lambda u, v, w: (u, width / 2 - w, v))


def chamfered_box(size, chamfer):
    """A box with all its edges chamfered at 45 degrees, centred in x and y, with its base at z = 0."""
    half = [s / 2 for s in size]

    def corner(signs, axis):
        """The corner point in the face normal to `axis`."""
        p = [s * (h - (0 if i == axis else chamfer)) for i, (s, h) in enumerate(zip(signs, half))]
        return (p[0], p[1], p[2] + half[2])

    all_signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    solid = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            face = []
            for su, sv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                signs = [0, 0, 0]
                signs[axis], signs[u], signs[v] = side, su, sv
                face.append(corner(signs, axis))
            solid += fan(face if side > 0 else face[::-1])
        for su in (-1, 1):
            for sv in (-1, 1):
                signs = [0, 0, 0]
                signs[u], signs[v] = su, sv
                low, high = list(signs), list(signs)
                low[axis], high[axis] = -1, 1
                edge = [corner(low, u), corner(low, v), corner(high, v), corner(high, u)]
                solid += fan(edge if su * sv > 0 else edge[::-1])
    for signs in all_signs:
        tip = [corner(signs, axis) for axis in range(3)]
        solid += fan(tip if signs[0] * signs[1] * signs[2] > 0 else tip[::-1])
    return solid


def fan(face):
    return [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]


def drilled_block(width, top, bottom, holes):
    """A block over x 0..width whose upper side is the line `top` [(y, z), ...], drilled through.

    Holes are (x, y, radius). The plan is cut into strips between the points of `top` and the
    lowest, middle and highest point of each hole; a hole cuts its strips in two.
    """
    cuts = sorted({y for y, _ in top} | {y + k * r for _, y, r in holes for k in (-1, 0, 1)})
    solid = []

    def lift(p):
        return (p[0], p[1], height(top, p[1]))

    def drop(p):
        return (p[0], p[1], bottom)

    def wall(a, b):
        return [(drop(a), drop(b), lift(b)), (drop(a), lift(b), lift(a))]

    for low, high in zip(cuts, cuts[1:]):
        solid += wall((width, low), (width, high)) + wall((0.0, high), (0.0, low))
        for plan in strip_pieces(width, low, high, holes):
            for a, b, c in triangulate(plan):
                solid += [(lift(a), lift(b), lift(c)), (drop(c), drop(b), drop(a))]
        for left, right in hole_borders(low, high, holes):
            for border in (left, right[::-1]):
                for a, b in zip(border, border[1:]):
                    solid += wall(a, b)
    ends = row(width, cuts[0], holes), row(width, cuts[-1], holes)[::-1]
    for end in ends:
        for a, b in zip(end, end[1:]):
            solid += wall(a, b)
    return solid


def height(top, y):
    for (y0, z0), (y1, z1) in zip(top, top[1:]):
        if y0 <= y <= y1:
            return z0 + (z1 - z0) * (y - y0) / (y1 - y0)
    raise ValueError(f"y {y} is outside the block")


def row(width, y, holes):
    """The points of the line between two strips: the corners, and the ends of holes."""
    tips = [(cx, y) for cx, cy, r in holes if y in (cy - r, cy + r)]
    return [(0.0, y), *tips, (width, y)]


def hole_borders(low, high, holes):
    """The left and right side, upwards, of each hole that spans low to high."""
    for cx, cy, r in holes:
        if cy - r <= low and high <= cy + r:
            right = arc((cx, cy, r), low, high)
            yield [(2 * cx - x, y) for x, y in right], right


def arc(hole, low, high):
    """Points of the right half of a circle from y = low to y = high, at most ten degrees apart."""
    cx, cy, r = hole
    start, end = (math.asin(max(-1.0, min(1.0, (y - cy) / r))) for y in (low, high))
    count = math.ceil((end - start) / math.radians(10) - 1e-9)
    points = [(cx + half_chord(r, low - cy), low)]
    for i in range(1, count):
        angle = start + (end - start) * i / count
        points.append((cx + r * math.cos(angle), cy + r * math.sin(angle)))
    return points + [(cx + half_chord(r, high - cy), high)]


def half_chord(r, d):
    """Half the chord at distance d from the centre; exactly 0 at the ends, to avoid slivers."""
    return 0.0 if abs(abs(d) - r) < 1e-12 else math.sqrt(r * r - d * d)


def strip_pieces(width, low, high, holes):
    borders = list(hole_borders(low, high, holes))
    if not borders:
        return [row(width, low, holes) + row(width, high, holes)[::-1]]
    ((left, right),) = borders
    return [[(0.0, low), *left, (0.0, high)], [(width, low), (width, high), *right[::-1]]]


def turned(profile, count, place):
    """A polygon [(w, r), ...], counter-clockwise, rotated about the axis in `count` flat sides.

    `place(u, v, w)` maps to x, y, z; w runs along the axis. Radii are those of the edges: divide a
    radius by cos(pi / count) to contain the whole circle.
    """
    def at(p, i):
        if p[1] == 0.0:
            return place(0.0, 0.0, p[0])
        angle = 2 * math.pi * (i % count) / count
        return place(p[1] * math.cos(angle), p[1] * math.sin(angle), p[0])

    solid = []
    for p, q in zip(profile, profile[1:] + profile[:1]):
        for i in range(count):
            if q[1] != 0.0:
                solid.append((at(p, i), at(q, i), at(q, i + 1)))
            if p[1] != 0.0:
                solid.append((at(p, i), at(q, i + 1), at(p, i + 1)))
    return solid


def turned_volume(rings, count):
    """Volume of rings (outer radius, inner radius, length) with `count` flat sides."""
    share = count / 2 * math.sin(2 * math.pi / count)
    return share * sum((outer**2 - inner**2) * length for outer, inner, length in rings)


# --- volumes, by an independent method -----------------------------------------------------------


def chamfered_box_volume(size, chamfer):
    """Minkowski sum of the box, smaller by the chamfer on each side, and an octahedron of that radius."""
    p, q, r = (s - 2 * chamfer for s in size)
    return (
        p * q * r
        + 2 * chamfer * (p * q + q * r + r * p)
        + 2 * chamfer**2 * (p + q + r)
        + 4 / 3 * chamfer**3
    )


def drilled_block_volume(width, top, bottom, holes):
    """Cross-sections over y; between two corners of the plan they are quadratic: Simpson is exact."""
    corners = {y for y, _ in top}
    for hole in holes:
        _, cy, r = hole
        cuts = sorted({y for y, _ in top if abs(y - cy) < r} | {cy - r, cy, cy + r})
        for low, high in zip(cuts, cuts[1:]):
            corners |= {y for _, y in arc(hole, low, high)}

    def chord(hole, low, high, y):
        cx, cy, r = hole
        if not cy - r <= low < high <= cy + r:
            return 0.0
        a, b = half_chord(r, low - cy), half_chord(r, high - cy)
        return 2 * (a + (b - a) * (y - low) / (high - low))

    total = 0.0
    ordered = sorted(corners)
    for low, high in zip(ordered, ordered[1:]):
        section = lambda y: (height(top, y) - bottom) * (
            width - sum(chord(hole, low, high, y) for hole in holes)
        )
        total += (high - low) / 6 * (section(low) + 4 * section((low + high) / 2) + section(high))
    return total
