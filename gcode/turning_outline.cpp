#include "gcode/turning_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace gcode {
namespace {

using core::ErrorCode;

constexpr double vanishing = 1e-3;   // program units: pieces smaller than this are dropped
constexpr double gap_for_arc = 1e-2; // likewise: a wider gap at a corner gets an arc

/// Smaller than half of this, a step moves no piece past its own centre.
double size_of(const OutlinePiece& piece) {
    const double length = std::abs(piece.start - piece.end);
    return piece.is_arc() ? std::min(length, std::abs(piece.start - piece.centre)) : length;
}

template <typename Map>
void map_points(Outline& outline, Map map, bool mirrors) {
    for (OutlinePiece& piece : outline.pieces) {
        piece.start = map(piece.start);
        piece.end = map(piece.end);
        piece.centre = map(piece.centre);
        if (mirrors) piece.counterclockwise = !piece.counterclockwise;
    }
}

/// Moves a piece sideways: a line to the left as one walks back along it, an arc outwards if it
/// turns counter-clockwise.
void move_aside(OutlinePiece& piece, double distance) {
    if (piece.is_arc()) {
        const double radius = std::abs(piece.start - piece.centre);
        const double factor = (radius + (piece.counterclockwise ? distance : -distance)) / radius;
        piece.start = factor * (piece.start - piece.centre) + piece.centre;
        piece.end = factor * (piece.end - piece.centre) + piece.centre;
        return;
    }
    const ZxPoint back = piece.start - piece.end;
    const ZxPoint aside = ZxPoint(0, 1) * distance * back / std::abs(back);
    piece.start += aside;
    piece.end += aside;
}

/// Where a line crosses the circle through `on_circle`: of the two places the one nearer to `near`.
ZxPoint line_and_circle(const OutlinePiece& line, ZxPoint centre, ZxPoint on_circle, ZxPoint near) {
    const ZxPoint level = std::conj(line.start - line.end) / std::abs(line.start - line.end);
    const ZxPoint c = (centre - line.end) * level;
    const ZxPoint p = (on_circle - line.end) * level;
    const double half = std::sqrt(std::max(0.0, std::norm(c - p) - c.imag() * c.imag()));
    const ZxPoint a = (c.real() + half) / level + line.end;
    const ZxPoint b = (c.real() - half) / level + line.end;
    return std::abs(near - a) < std::abs(near - b) ? a : b;
}

/// Where two circles cross, on the left of the way from the second's centre to the first's.
ZxPoint circle_and_circle(const OutlinePiece& first, const OutlinePiece& second) {
    const double a = std::abs(second.start - second.centre);
    const double b = std::abs(first.start - first.centre);
    const double c = std::abs(second.centre - first.centre);
    const double cosine = (c * c + a * a - b * b) / 2.0 / a / c;
    const ZxPoint turned(cosine, std::sqrt(1.0 - std::min(cosine * cosine, 1.0)));
    return turned * (first.centre - second.centre) / c * a + second.centre;
}

/// Makes the end of a piece and the start of the next the place where they cross.
core::Result<void> join(OutlinePiece& first, OutlinePiece& second) {
    ZxPoint at;
    if (first.is_arc() && second.is_arc()) {
        at = circle_and_circle(first, second);
    } else if (!first.is_arc() && !second.is_arc()) {
        const ZxPoint back = second.start - second.end;
        const ZxPoint level = std::conj(back) / std::abs(back);
        const ZxPoint from = (first.start - second.end) * level;
        const ZxPoint to = (first.end - second.end) * level;
        if ((from - to).imag() == 0.0)
            return core::fail(ErrorCode::invalid_value,
                              "two lines of the contour that follow each other are parallel, their "
                              "offsets do not meet: make one line of them");
        const double t = from.imag() / (from - to).imag();
        at = (from + t * (to - from)) / level + second.end;
    } else {
        if (std::abs(second.start - first.end) < zx_tolerance) return {};
        at = first.is_arc() ? line_and_circle(second, first.centre, first.end, second.start)
                            : line_and_circle(first, second.centre, second.end, second.start);
    }
    first.end = second.start = at;
    return {};
}

tl::unexpected<core::Error> nothing_left() {
    return core::fail(ErrorCode::invalid_value,
                      "nothing is left of the contour at this distance from it");
}

/// Puts one fillet or chamfer in its place.
core::Result<void> shape_corner(OutlinePiece& before, OutlinePiece& corner, OutlinePiece& after) {
    OutlinePiece p, n;
    const auto overlap = [&](double size) {
        p = before;
        n = after;
        move_aside(p, size);
        move_aside(n, size);
        return (p.end - n.start).real() > gap_for_arc;
    };
    double size = corner.corner_size;
    if (overlap(size)) {
        size = -size;
        if (overlap(size))
            return core::fail(ErrorCode::invalid_value,
                              fmt::format("the corner at X{:.4f} Z{:.4f}, as the cycle has turned "
                                          "the contour, has no room for its fillet or chamfer",
                                          before.end.imag(), before.end.real()));
    }
    if (auto joined = join(p, n); !joined) return joined;
    const ZxPoint centre = (p.end + n.start) / 2.0;
    move_aside(p, -size);
    move_aside(n, -size);
    corner.start = before.end = p.end;
    corner.end = after.start = n.start;
    if (!corner.is_arc()) return {};
    corner.centre = centre;
    corner.counterclockwise =
        (corner.start - centre).imag() > 0.0 || (corner.end - centre).imag() > 0.0;
    corner.is_corner = false;
    return {};
}

void drop_vanishing(std::vector<OutlinePiece>& pieces) {
    std::erase_if(pieces, [](const OutlinePiece& piece) { return size_of(piece) < vanishing; });
}

/// Fills the gaps that an offset by `step` has opened at outside corners with arcs about them.
void fill_gaps(std::vector<OutlinePiece>& pieces, double step, bool outwards) {
    for (size_t i = 0; i + 1 < pieces.size(); ++i) {
        if (!((pieces[i].end - pieces[i + 1].start).real() > gap_for_arc)) continue;
        OutlinePiece before = pieces[i], after = pieces[i + 1];
        move_aside(before, -step);
        move_aside(after, -step);
        OutlinePiece arc{OutlinePiece::Kind::arc, pieces[i].end, pieces[i + 1].start};
        arc.centre = (before.end + after.start) / 2.0;
        arc.counterclockwise = outwards;
        pieces.insert(pieces.begin() + static_cast<std::ptrdiff_t>(++i), arc);
    }
}

/// Joins all neighbours; a piece that the offset has turned round, or its smaller neighbour before
/// it, is dropped. After a loss it goes on with the second piece, as LinuxCNC does.
core::Result<void> join_all(std::vector<OutlinePiece>& pieces) {
    const auto drop = [&](size_t i) {
        pieces.erase(pieces.begin() + static_cast<std::ptrdiff_t>(i));
    };
    for (size_t i = 0; i + 1 != pieces.size(); ++i) {
        if (i >= pieces.size()) return nothing_left();
        if (!runs_down(pieces[i])) {
            if (i == 0) return nothing_left();
            drop(size_of(pieces[i]) < size_of(pieces[i - 1]) ? i : i - 1);
            i = 0;
        }
        if (pieces.size() < 2) return nothing_left();
        if (size_of(pieces[i]) < vanishing) {
            drop(i);
            i = 0;
        } else if (auto joined = join(pieces[i], pieces[i + 1]); !joined) {
            return joined;
        }
    }
    return {};
}

} // namespace

void turn(Outline& outline) {
    map_points(
        outline, [](ZxPoint p) { return -p * ZxPoint(0, 1); }, false);
    outline.turned = !outline.turned;
}

void face_cutting_direction(Outline& outline) {
    const ZxPoint back = outline.pieces.front().end - outline.pieces.back().end;
    if (back.imag() > 0.0) {
        map_points(
            outline, [](ZxPoint p) { return std::conj(p); }, true);
        outline.x_mirrored = !outline.x_mirrored;
    }
    if (back.real() < 0.0) {
        map_points(
            outline, [](ZxPoint p) { return -std::conj(p); }, true);
        outline.z_mirrored = !outline.z_mirrored;
    }
}

ZxPoint lathe_from_outline(const Outline& outline, ZxPoint place) {
    if (outline.x_mirrored) place = std::conj(place);
    if (outline.z_mirrored) place = -std::conj(place);
    return outline.turned ? ZxPoint(0, 1) * place : place;
}

bool is_reversed(const Outline& outline) { return outline.x_mirrored != outline.z_mirrored; }

bool runs_down(const OutlinePiece& piece) {
    constexpr double slack = 1e-3; // program units
    const double advance = (piece.end - piece.start).real();
    if (!piece.is_arc()) return advance <= slack;
    if (piece.is_corner && piece.corner_size != 0.0) return true;
    const double sign = piece.counterclockwise ? 1.0 : -1.0;
    return sign * (piece.start - piece.centre).imag() >= -slack
           && sign * (piece.end - piece.centre).imag() >= -slack && advance <= -slack;
}

core::Result<void> check_runs_down(Outline& outline) {
    OutlinePiece& way_in = outline.pieces.front();
    if ((way_in.end - way_in.start).real() > 0.0) way_in.start.real(way_in.end.real());
    for (const OutlinePiece& piece : outline.pieces)
        if (!runs_down(piece)) {
            const ZxPoint at = lathe_from_outline(outline, piece.end);
            return core::fail(
                ErrorCode::invalid_value,
                fmt::format("the contour turns back before X{:.4f} Z{:.4f}: it must run one way "
                            "along the cuts, and an arc at most a quarter from each side",
                            at.imag(), at.real()));
        }
    return {};
}

core::Result<void> shape_corners(Outline& outline) {
    std::vector<OutlinePiece>& pieces = outline.pieces;
    for (size_t i = 1; i + 1 < pieces.size(); ++i)
        if (pieces[i].is_corner)
            if (auto shaped = shape_corner(pieces[i - 1], pieces[i], pieces[i + 1]); !shaped)
                return shaped;
    drop_vanishing(pieces);
    if (pieces.empty()) return nothing_left();
    return {};
}

core::Result<void> offset_outline(Outline& outline, double distance) {
    constexpr int greatest_steps = 10'000;
    std::vector<OutlinePiece>& pieces = outline.pieces;
    OutlinePiece way_in = pieces.front();
    const ZxPoint in = way_in.end - way_in.start;
    const ZxPoint across = pieces.back().start - way_in.start;
    if ((in / across).imag() < 0.0) distance = -distance;
    pieces.erase(pieces.begin());
    int steps = 0;
    for (double done = 0.0; done != distance;) {
        double step = 1e9;
        for (const OutlinePiece& piece : pieces) step = std::min(step, size_of(piece) / 2.0);
        step = std::min(step, std::abs(distance - done));
        if (!(step > 0.0) || ++steps > greatest_steps) return nothing_left();
        if (distance < 0.0) step = -step;
        for (OutlinePiece& piece : pieces) move_aside(piece, step);
        drop_vanishing(pieces);
        if (pieces.empty()) return nothing_left();
        fill_gaps(pieces, step, distance > 0.0);
        if (auto joined = join_all(pieces); !joined) return joined;
        done += step;
    }
    if (pieces.empty()) return nothing_left();
    for (size_t i = 0; i + 1 < pieces.size(); ++i)
        pieces[i].end = pieces[i + 1].start = (pieces[i].end + pieces[i + 1].start) / 2.0;
    way_in.end = pieces.front().start;
    pieces.insert(pieces.begin(), way_in);
    return {};
}

std::vector<double> crossings(const OutlinePiece& piece, double x) {
    const ZxPoint from = piece.start, to = piece.end;
    if (!piece.is_arc()) {
        if (std::min(from.imag(), to.imag()) > x + zx_tolerance
            || std::max(from.imag(), to.imag()) < x - zx_tolerance)
            return {};
        if (std::abs((from - to).imag()) < zx_tolerance) return {from.real(), to.real()};
        const double t = (x - from.imag()) / (to.imag() - from.imag());
        return {t * (to.real() - from.real()) + from.real()};
    }
    const double radius = std::abs(from - piece.centre);
    const double height = x - piece.centre.imag();
    const double square = -(height - radius) * (height + radius);
    if (square < -zx_tolerance) return {};
    const double half = std::sqrt(std::max(square, 0.0));
    std::vector<double> places;
    const double sense = piece.counterclockwise ? 1.0 : -1.0;
    for (const double z : {piece.centre.real() + half, piece.centre.real() - half}) {
        const ZxPoint spoke = ZxPoint(z, x) - piece.centre;
        const double after_start = (std::conj(from - piece.centre) * spoke).imag();
        const double after_end = (std::conj(to - piece.centre) * spoke).imag();
        if (sense * after_start >= -zx_tolerance && sense * after_end <= zx_tolerance)
            places.push_back(z);
    }
    return places;
}

} // namespace gcode
