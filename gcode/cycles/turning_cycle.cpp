#include "gcode/cycles/turning_cycle.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/result.h"

namespace gcode {

/// A point in the ZX plane, program units: Z is the real part, X the imaginary part.
using ZxPoint = std::complex<double>;

// The absolute value and the quotient of complex numbers come from the libraries of system and
// compiler, with other bits on other systems.

double length_of(ZxPoint p) { return core::hypot(p.real(), p.imag()); }

/// Rounded as by the compiler of LinuxCNC, whose choice of a side depends on it where a quotient is
/// nearly real. Source: Smith, "Algorithm 116: complex division" (1962).
ZxPoint quotient(ZxPoint p, ZxPoint q) {
    if (std::abs(q.real()) < std::abs(q.imag())) {
        const double ratio = q.real() / q.imag();
        const double size = q.real() * ratio + q.imag();
        return {(p.real() * ratio + p.imag()) / size, (p.imag() * ratio - p.real()) / size};
    }
    const double ratio = q.imag() / q.real();
    const double size = q.imag() * ratio + q.real();
    return {(p.imag() * ratio + p.real()) / size, (p.imag() - p.real() * ratio) / size};
}

/// A segment of an outline. A corner becomes a line (chamfer) or an arc (fillet) once its position
/// is known.
struct OutlinePiece {
    enum class Kind : uint8_t { line, arc };
    Kind kind = Kind::line;
    ZxPoint start, end;
    ZxPoint centre{}; // of an arc
    bool counterclockwise = false;
    bool is_corner = false; // to be fitted between its neighbours
    double corner_size = 0.0;

    bool is_arc() const { return kind == Kind::arc; }
};

/// The contour of a turning cycle in the frame in which it is cut: it runs in -Z and, overall, in
/// +X. The first segment leads from the tool to the contour.
struct Outline {
    std::vector<OutlinePiece> pieces;
    bool turned = false, x_mirrored = false, z_mirrored = false;
};

/// Points closer than this are equal, program units (as in LinuxCNC).
constexpr double zx_tolerance = 1e-6;

/// Rotates the outline by 90 degrees, so that X and Z change roles.
void turn(Outline& outline);

/// Mirrors the outline so that it leads from large Z and small X to small Z and large X.
void face_cutting_direction(Outline& outline);

/// Converts a point from the outline's frame to the lathe's frame.
ZxPoint lathe_from_outline(const Outline& outline, ZxPoint place);

/// Whether mirroring has reversed the direction of arcs.
bool is_reversed(const Outline& outline);

/// Whether a segment never runs back in Z; an arc must also stay on one side of its centre.
bool runs_down(const OutlinePiece& piece);

/// Checks that the outline can be cut. A lead-in that runs back is first made vertical.
///
/// Errors: a segment runs back.
core::Result<void> check_runs_down(Outline& outline);

/// Fits fillets and chamfers between their neighbours and removes segments without length.
///
/// Errors: a corner does not fit.
core::Result<void> shape_corners(Outline& outline);

/// Offsets the outline, except its lead-in, away from the material.
///
/// Errors: consecutive segments are parallel; nothing is left of the outline.
/// Source: behaves as LinuxCNC's offset, which proceeds in steps of half the smallest segment.
core::Result<void> offset_outline(Outline& outline, double distance);

/// The Z values at which a segment crosses an X: none, one or two. A level segment gives its ends
/// in its own direction; otherwise the greater Z comes first.
std::vector<double> crossings(const OutlinePiece& piece, double x);

namespace {

using core::ErrorCode;

constexpr double nearby = 1e-3; // program units: arcs shorter than this are not cut

/// Collects moves, given in the outline's frame.
struct MoveWriter {
    const Outline& outline;
    double mm_per_unit;
    ZxPoint at; // in the lathe's frame
    TurningMoves moves{};

    TurningPoint to_mm(ZxPoint p) const { return {p.imag() * mm_per_unit, p.real() * mm_per_unit}; }

    void line(ZxPoint end, bool rapid) {
        at = lathe_from_outline(outline, end);
        moves.push_back({to_mm(at), rapid});
    }
    void arc(const OutlinePiece& piece, ZxPoint end) {
        constexpr double same = 1e-4; // program units: LinuxCNC omits shorter arcs
        const ZxPoint to = lathe_from_outline(outline, end);
        if (std::abs((to - at).real()) < same && std::abs((to - at).imag()) < same) return;
        at = to;
        const ZxPoint centre = lathe_from_outline(outline, piece.centre);
        moves.push_back(
            {to_mm(to), false,
             TurningArc{to_mm(centre), piece.counterclockwise != is_reversed(outline)}});
    }
};

Outline outline_from_contour(TurningPoint start, const TurningContour& contour,
                             double mm_per_unit) {
    const auto place = [&](TurningPoint p) {
        return ZxPoint(p.z / mm_per_unit, p.x / mm_per_unit);
    };
    Outline outline;
    ZxPoint at = place(start);
    for (const TurningSegment& segment : contour) {
        using Kind = OutlinePiece::Kind;
        OutlinePiece piece{segment.arc ? Kind::arc : Kind::line, at, place(segment.end)};
        if (segment.arc) {
            piece.centre = place(segment.arc->centre);
            piece.counterclockwise = segment.arc->counterclockwise;
        }
        if (piece.start == piece.end) continue;
        at = piece.end;
        outline.pieces.push_back(piece);
        if (segment.corner == CornerShape::sharp) continue;
        OutlinePiece corner{segment.corner == CornerShape::fillet ? Kind::arc : Kind::line, at, at};
        corner.centre = at;
        corner.is_corner = true;
        corner.corner_size = segment.corner_size / mm_per_unit;
        outline.pieces.push_back(corner);
    }
    return outline;
}

core::Result<void> check_length(const TurningContour& contour) {
    if (contour.size() <= greatest_contour) return {};
    return core::fail(ErrorCode::invalid_value,
                      fmt::format("the contour has more than {} segments", greatest_contour));
}

core::Result<TurningMoves> checked(MoveWriter writer) {
    const auto finite = [](const TurningPoint& p) {
        return std::isfinite(p.x) && std::isfinite(p.z);
    };
    for (const TurningMove& move : writer.moves)
        if (!finite(move.end) || (move.arc && !finite(move.arc->centre)))
            return core::fail(ErrorCode::invalid_value,
                              "the cycle cannot follow this contour: two of its segments do not "
                              "meet at the given distance");
    return std::move(writer.moves);
}

tl::unexpected<core::Error> endless() {
    return core::fail(ErrorCode::invalid_value,
                      "the cycle does not finish on this contour: try a greater depth of cut I, or "
                      "a contour without arcs that turn back");
}

/// Roughing: cuts levels from the lead-in, `depth` apart, then follows the contour upwards until it
/// descends into a pocket, where cutting levels starts again.
struct Roughing {
    const std::vector<OutlinePiece>& pieces;
    MoveWriter& out;
    double depth;
    ZxPoint escape;
    PocketCutting pockets;
    std::vector<double> pocket_tops{}; // X
    ZxPoint at{};
    size_t piece = 0;
    double level = 0.0; // X of the next cut
    bool follows_pockets = false;
    std::int64_t budget = 20'000'000; // segment visits, to guarantee termination
};

void go(Roughing& roughing, ZxPoint end, bool rapid) {
    roughing.out.line(end, rapid);
    roughing.at = end;
}

void go_round(Roughing& roughing, const OutlinePiece& piece, ZxPoint end, bool unless_there) {
    if (!unless_there || length_of(roughing.at - end) > nearby) roughing.out.arc(piece, end);
    roughing.at = end;
}

enum class PassResult : uint8_t { done, not_this_way };

core::Result<PassResult> dive_along_line(Roughing& roughing, const OutlinePiece& piece, bool rapid,
                                         double level) {
    if (piece.start.imag() <= piece.end.imag() + zx_tolerance) return PassResult::not_this_way;
    if (level < piece.end.imag()) {
        go(roughing, piece.end, rapid);
        return PassResult::done;
    }
    const std::vector<double> places = crossings(piece, level);
    if (places.empty())
        return core::fail(ErrorCode::invalid_value,
                          "the cycle starts below a descending segment of its contour: start it "
                          "outside the material");
    go(roughing, {places.front(), level}, rapid);
    return PassResult::done;
}

PassResult dive_along_arc(Roughing& roughing, const OutlinePiece& piece, double level) {
    ZxPoint& at = roughing.at;
    if (length_of(at - piece.end) < zx_tolerance || (at - piece.end).real() <= zx_tolerance) {
        at = piece.end;
        return PassResult::done;
    }
    std::vector<double> places = crossings(piece, level);
    if (places.empty()) places = crossings(piece, level - zx_tolerance);
    const double top = piece.centre.real();
    if (piece.counterclockwise) {
        if (at.real() - zx_tolerance > top) return PassResult::not_this_way;
        const bool whole = places.empty() || places.back() > top;
        go_round(roughing, piece, whole ? piece.end : ZxPoint(places.back(), level), false);
        return PassResult::done;
    }
    if (at.real() <= top) return PassResult::not_this_way;
    if (places.empty())
        go_round(roughing, piece, piece.end, false);
    else if (places.front() >= top)
        go_round(roughing, piece, {places.front(), level}, false);
    return PassResult::done; // also if only the far side is reached: the level comes down to it
}

/// Moves down along a segment to a level, or to its end if that is higher.
core::Result<PassResult> dive(Roughing& roughing, double level) {
    const OutlinePiece& piece = roughing.pieces[roughing.piece];
    if (piece.is_arc()) return dive_along_arc(roughing, piece, level);
    return dive_along_line(roughing, piece, roughing.piece == 0, level);
}

/// The end of the rising part of an arc.
ZxPoint top_of(const OutlinePiece& piece) {
    if (!piece.counterclockwise || piece.end.real() >= piece.centre.real()) return piece.end;
    return piece.centre + ZxPoint(0, length_of(piece.start - piece.centre));
}

/// Moves up along a segment from the tool position.
core::Result<PassResult> climb(Roughing& roughing) {
    const OutlinePiece& piece = roughing.pieces[roughing.piece];
    if (!piece.is_arc()) {
        if (piece.end.imag() + zx_tolerance < piece.start.imag()) return PassResult::not_this_way;
        if (length_of(roughing.at - piece.start) > zx_tolerance)
            return core::fail(ErrorCode::invalid_value,
                              "the cycle cannot follow its contour: the segments do not meet");
        go(roughing, piece.end, false);
        return PassResult::done;
    }
    const double across = roughing.at.real() - piece.centre.real();
    if (piece.counterclockwise ? across < 0.0 : across > 0.0) return PassResult::not_this_way;
    go_round(roughing, piece, top_of(piece), true);
    // A counterclockwise arc may descend again after its top.
    return piece.counterclockwise ? PassResult::not_this_way : PassResult::done;
}

/// Moves straight across to a segment that rises from the level of the tool, and up along it.
void climb_across(Roughing& roughing) {
    const OutlinePiece& piece = roughing.pieces[roughing.piece];
    if (!piece.is_arc() && piece.end.imag() < piece.start.imag()) return;
    const std::vector<double> places = crossings(piece, roughing.at.imag());
    if (places.empty()) return;
    const bool ccw_arc = piece.is_arc() && piece.counterclockwise;
    const bool cw_arc = piece.is_arc() && !piece.counterclockwise;
    const double z = cw_arc ? places.back() : places.front();
    if (cw_arc && z > piece.centre.real()) return;
    if (ccw_arc && z < piece.centre.real()) return;
    go(roughing, {z, roughing.at.imag()}, false);
    if (piece.is_arc())
        go_round(roughing, piece, top_of(piece), true);
    else
        go(roughing, piece.end, false);
}

/// One cut at the level of the tool to the first segment in its way, and back.
void cut_level(Roughing& roughing) {
    const ZxPoint from = roughing.at;
    for (size_t i = roughing.piece; i < roughing.pieces.size(); ++i) {
        const std::vector<double> places = crossings(roughing.pieces[i], from.imag());
        if (places.empty()) continue;
        const bool is_own = i == roughing.piece;
        const double z = is_own ? places.back() : places.front();
        if (z - zx_tolerance > from.real()) continue;
        const double length = std::abs(z - from.real());
        if (length < zx_tolerance) {
            if (is_own) continue;
            if (length_of(from - roughing.pieces[i].start) < zx_tolerance)
                roughing.piece = i;
            else
                roughing.level -= roughing.depth;
            return;
        }
        go(roughing, {z, from.imag()}, false);
        const ZxPoint away = std::min(1.0, length / 2.0 / roughing.escape.real()) * roughing.escape;
        go(roughing, roughing.at + away, true);
        go(roughing, from - std::conj(away), true);
        go(roughing, from, roughing.piece == 0);
        roughing.level -= roughing.depth;
        return;
    }
}

/// Leaves a level below which the contour does not go: follows the contour up to the next pocket.
///
/// Result: whether there is another pocket.
core::Result<bool> follow_to_pocket(Roughing& roughing) {
    const size_t count = roughing.pieces.size();
    if (roughing.pockets == PocketCutting::none) {
        for (; roughing.piece < count; ++roughing.piece) climb_across(roughing);
        return false;
    }
    for (; roughing.piece < count; ++roughing.piece) {
        FEELER_TRY(const PassResult step, climb(roughing));
        if (step == PassResult::done) continue;
        std::vector<double>& tops = roughing.pocket_tops;
        if (roughing.follows_pockets) {
            if (roughing.at.imag() > tops.back() && tops.size() > 1) tops.pop_back();
            if (tops.size() == 1) tops.push_back(roughing.at.imag());
        }
        roughing.level = tops.back();
        return true;
    }
    return false;
}

/// Moves down the first pocket without cutting its levels, which G71.1 has already cut.
core::Result<void> skip_first_descent(Roughing& roughing) {
    for (; roughing.piece < roughing.pieces.size(); ++roughing.piece) {
        FEELER_TRY(const PassResult step, dive(roughing, -1e9));
        if (step == PassResult::not_this_way) break;
    }
    roughing.follows_pockets = true;
    return {};
}

core::Result<void> cut(Roughing& roughing) {
    if (roughing.pockets == PocketCutting::rest)
        if (auto skipped = skip_first_descent(roughing); !skipped) return skipped;
    while (roughing.piece < roughing.pieces.size()) {
        const double above = roughing.level - zx_tolerance - roughing.at.imag();
        if (!(above / roughing.depth < 1e6) || roughing.budget < 0) return endless();
        roughing.budget -= static_cast<std::int64_t>(roughing.pieces.size());
        while (roughing.level - zx_tolerance > roughing.at.imag()) roughing.level -= roughing.depth;
        FEELER_TRY(const PassResult step, dive(roughing, roughing.level));
        if (step == PassResult::not_this_way) {
            FEELER_TRY(const bool pocket, follow_to_pocket(roughing));
            if (!pocket) return {};
        } else if (std::abs(roughing.at.imag() - roughing.level) > zx_tolerance) {
            ++roughing.piece;
        } else {
            cut_level(roughing);
        }
    }
    return {};
}

/// Orients the outline for G70: rotated by 90 degrees if it would run back otherwise.
core::Result<void> orient_for_finishing(Outline& outline) {
    Outline contour = outline;
    contour.pieces.erase(contour.pieces.begin());
    face_cutting_direction(contour);
    if (!std::all_of(contour.pieces.begin(), contour.pieces.end(), runs_down)) {
        turn(contour);
        face_cutting_direction(contour);
    }
    if (auto runs = check_runs_down(contour); !runs) return runs;
    if (contour.turned) turn(outline);
    face_cutting_direction(outline);
    if (auto shaped = shape_corners(outline); !shaped) return shaped;
    return check_runs_down(outline);
}

} // namespace

core::Result<TurningMoves> roughing_moves(TurningPoint start, const TurningContour& contour,
                                          const RoughingWords& words, double mm_per_unit) {
    if (auto length = check_length(contour); !length) return tl::unexpected(length.error());
    const double depth = words.depth.value_or(mm_per_unit) / mm_per_unit;
    Outline outline = outline_from_contour(start, contour, mm_per_unit);
    if (outline.pieces.size() < 2) return TurningMoves{};
    if (!(depth > 0.0))
        return core::fail(ErrorCode::invalid_value, "I, the depth of cut, must be positive");
    const ZxPoint tool = outline.pieces.front().start;
    if (words.facing) turn(outline);
    face_cutting_direction(outline);
    if (auto shaped = shape_corners(outline); !shaped) return tl::unexpected(shaped.error());
    if (auto runs = check_runs_down(outline); !runs) return tl::unexpected(runs.error());
    if (auto moved = offset_outline(outline, words.allowance / mm_per_unit); !moved)
        return tl::unexpected(moved.error());
    std::vector<OutlinePiece>& pieces = outline.pieces;
    for (OutlinePiece& piece : pieces) {
        const ZxPoint shift = ZxPoint(words.shift_z, words.shift_x) / mm_per_unit;
        piece.start += shift;
        piece.end += shift;
        piece.centre += shift;
    }
    const ZxPoint top = pieces.front().start;
    const ZxPoint end = pieces.back().end;
    if (end.imag() < top.imag())
        pieces.push_back({OutlinePiece::Kind::line, end, {end.real(), top.imag()}});
    MoveWriter writer{outline, mm_per_unit, tool};
    const double retract = words.retract.value_or(0.5 * mm_per_unit) / mm_per_unit;
    Roughing roughing{
        pieces,        writer,      std::max(depth, 2.0 * zx_tolerance), {retract, retract},
        words.pockets, {top.imag()}};
    roughing.level = top.imag();
    go(roughing, top, true);
    if (auto done = cut(roughing); !done) return tl::unexpected(done.error());
    return checked(std::move(writer));
}

core::Result<TurningMoves> finishing_moves(TurningPoint start, const TurningContour& contour,
                                           const FinishingWords& words, double mm_per_unit) {
    if (auto length = check_length(contour); !length) return tl::unexpected(length.error());
    Outline outline = outline_from_contour(start, contour, mm_per_unit);
    if (outline.pieces.size() < 2) return TurningMoves{};
    const ZxPoint tool = outline.pieces.front().start;
    if (auto oriented = orient_for_finishing(outline); !oriented)
        return tl::unexpected(oriented.error());
    if (!(std::abs(words.passes) * static_cast<double>(outline.pieces.size() + 1)
          < static_cast<double>(greatest_turning_moves)))
        return endless();
    MoveWriter writer{outline, mm_per_unit, tool};
    for (int pass = static_cast<int>(words.passes); pass > 0; --pass) {
        const double further = (words.first_distance - words.last_distance) / words.passes;
        Outline path = outline;
        if (auto moved =
                offset_outline(path, ((pass - 1) * further + words.last_distance) / mm_per_unit);
            !moved)
            return tl::unexpected(moved.error());
        writer.line(path.pieces.front().start, true);
        writer.line(path.pieces.front().end, true);
        for (size_t i = 1; i < path.pieces.size(); ++i)
            if (path.pieces[i].is_arc())
                writer.arc(path.pieces[i], path.pieces[i].end);
            else
                writer.line(path.pieces[i].end, false);
    }
    return checked(std::move(writer));
}

namespace {

constexpr double vanishing = 1e-3;   // program units: smaller segments are removed
constexpr double gap_for_arc = 1e-2; // program units: a wider gap at a corner gets an arc

/// An offset by less than half of this does not move an arc past its centre.
double size_of(const OutlinePiece& piece) {
    const double length = length_of(piece.start - piece.end);
    return piece.is_arc() ? std::min(length, length_of(piece.start - piece.centre)) : length;
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

/// Offsets a segment: a line to the left when seen against its direction, a counterclockwise arc
/// outwards.
void move_aside(OutlinePiece& piece, double distance) {
    if (piece.is_arc()) {
        const double radius = length_of(piece.start - piece.centre);
        const double factor = (radius + (piece.counterclockwise ? distance : -distance)) / radius;
        piece.start = factor * (piece.start - piece.centre) + piece.centre;
        piece.end = factor * (piece.end - piece.centre) + piece.centre;
        return;
    }
    const ZxPoint back = piece.start - piece.end;
    const ZxPoint aside = ZxPoint(0, 1) * distance * back / length_of(back);
    piece.start += aside;
    piece.end += aside;
}

/// Where a line crosses the circle through `on_circle`: the intersection nearer to `near`.
ZxPoint line_and_circle(const OutlinePiece& line, ZxPoint centre, ZxPoint on_circle, ZxPoint near) {
    const ZxPoint level = std::conj(line.start - line.end) / length_of(line.start - line.end);
    const ZxPoint c = (centre - line.end) * level;
    const ZxPoint p = (on_circle - line.end) * level;
    const double half = std::sqrt(std::max(0.0, std::norm(c - p) - c.imag() * c.imag()));
    const ZxPoint a = quotient(c.real() + half, level) + line.end;
    const ZxPoint b = quotient(c.real() - half, level) + line.end;
    return length_of(near - a) < length_of(near - b) ? a : b;
}

/// Where two circles cross, to the left of the line from the second centre to the first.
ZxPoint circle_and_circle(const OutlinePiece& first, const OutlinePiece& second) {
    const double a = length_of(second.start - second.centre);
    const double b = length_of(first.start - first.centre);
    const double c = length_of(second.centre - first.centre);
    const double cosine = (c * c + a * a - b * b) / 2.0 / a / c;
    const ZxPoint turned(cosine, std::sqrt(1.0 - std::min(cosine * cosine, 1.0)));
    return turned * (first.centre - second.centre) / c * a + second.centre;
}

/// Moves the end of a segment and the start of the next to their intersection.
core::Result<void> join(OutlinePiece& first, OutlinePiece& second) {
    ZxPoint at;
    if (first.is_arc() && second.is_arc()) {
        at = circle_and_circle(first, second);
    } else if (!first.is_arc() && !second.is_arc()) {
        const ZxPoint back = second.start - second.end;
        const ZxPoint level = std::conj(back) / length_of(back);
        const ZxPoint from = (first.start - second.end) * level;
        const ZxPoint to = (first.end - second.end) * level;
        if ((from - to).imag() == 0.0)
            return core::fail(ErrorCode::invalid_value,
                              "two consecutive lines of the contour are parallel and their offsets "
                              "do not meet: combine them into one line");
        const double t = from.imag() / (from - to).imag();
        at = quotient(from + t * (to - from), level) + second.end;
    } else {
        if (length_of(second.start - first.end) < zx_tolerance) return {};
        at = first.is_arc() ? line_and_circle(second, first.centre, first.end, second.start)
                            : line_and_circle(first, second.centre, second.end, second.start);
    }
    first.end = second.start = at;
    return {};
}

tl::unexpected<core::Error> nothing_left() {
    return core::fail(ErrorCode::invalid_value, "nothing is left of the contour at this distance");
}

/// Fits one fillet or chamfer between its neighbours.
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
                              fmt::format("the corner at X{:.4f} Z{:.4f} (as the cycle orients the "
                                          "contour) has no room for its fillet or chamfer",
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

/// Fills the gaps that an offset by `step` opens at outside corners with arcs around the corners.
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

/// Joins all consecutive segments. A segment that the offset has reversed is removed, or its
/// predecessor if that is smaller. After a removal it continues with the second segment, as
/// LinuxCNC does.
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
                fmt::format(
                    "the contour turns back before X{:.4f} Z{:.4f}: it must run in one direction "
                    "along the cuts, and an arc may span at most a quarter on each side",
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
    if (quotient(in, across).imag() < 0.0) distance = -distance;
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
    const double radius = length_of(from - piece.centre);
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
