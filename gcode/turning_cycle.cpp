#include "gcode/turning_cycle.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gcode/turning_outline.h"

namespace gcode {
namespace {

using core::ErrorCode;

constexpr double nearby = 1e-3; // program units: arcs shorter than this are not cut

/// Collects moves given in the outline's frame.
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
        constexpr double same = 1e-4; // program units: LinuxCNC leaves such an arc out
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
                              "the cycle cannot follow this contour: two of its pieces do not meet "
                              "at the distance asked for");
    return std::move(writer.moves);
}

tl::unexpected<core::Error> endless() {
    return core::fail(ErrorCode::invalid_value,
                      "the cycle does not come to an end on this contour: a greater depth of cut "
                      "I, or a contour without arcs that come back, may help");
}

/// Roughing: levels are cut from the way in, `depth` apart; then the contour is followed upwards
/// until it dives into a pocket, in which the same begins again.
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
    std::int64_t budget = 20'000'000; // visits of pieces, so that it ends
};

void go(Roughing& roughing, ZxPoint end, bool rapid) {
    roughing.out.line(end, rapid);
    roughing.at = end;
}

void go_round(Roughing& roughing, const OutlinePiece& piece, ZxPoint end, bool unless_there) {
    if (!unless_there || std::abs(roughing.at - end) > nearby) roughing.out.arc(piece, end);
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
                          "the cycle starts below a piece of its contour that leads down: start it "
                          "outside of the material");
    go(roughing, {places.front(), level}, rapid);
    return PassResult::done;
}

PassResult dive_along_arc(Roughing& roughing, const OutlinePiece& piece, double level) {
    ZxPoint& at = roughing.at;
    if (std::abs(at - piece.end) < zx_tolerance || (at - piece.end).real() <= zx_tolerance) {
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
    return PassResult::done; // also where only the far side is met: the level comes down to it
}

/// Goes down along a piece to a level, or to its end if that is higher.
core::Result<PassResult> dive(Roughing& roughing, double level) {
    const OutlinePiece& piece = roughing.pieces[roughing.piece];
    if (piece.is_arc()) return dive_along_arc(roughing, piece, level);
    return dive_along_line(roughing, piece, roughing.piece == 0, level);
}

/// The end of the rising part of an arc.
ZxPoint top_of(const OutlinePiece& piece) {
    if (!piece.counterclockwise || piece.end.real() >= piece.centre.real()) return piece.end;
    return piece.centre + ZxPoint(0, std::abs(piece.start - piece.centre));
}

/// Goes up along a piece from where the tool is.
core::Result<PassResult> climb(Roughing& roughing) {
    const OutlinePiece& piece = roughing.pieces[roughing.piece];
    if (!piece.is_arc()) {
        if (piece.end.imag() + zx_tolerance < piece.start.imag()) return PassResult::not_this_way;
        if (std::abs(roughing.at - piece.start) > zx_tolerance)
            return core::fail(ErrorCode::invalid_value,
                              "the cycle has lost its contour: its pieces do not meet");
        go(roughing, piece.end, false);
        return PassResult::done;
    }
    const double across = roughing.at.real() - piece.centre.real();
    if (piece.counterclockwise ? across < 0.0 : across > 0.0) return PassResult::not_this_way;
    go_round(roughing, piece, top_of(piece), true);
    // At its top a counter-clockwise arc may go down again.
    return piece.counterclockwise ? PassResult::not_this_way : PassResult::done;
}

/// Goes straight across to a piece that rises from the level of the tool, and up along it.
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

/// One cut at the level of the tool, to the first piece that stands in the way, and back.
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
            if (std::abs(from - roughing.pieces[i].start) < zx_tolerance)
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

/// Leaves a level that the contour does not go below: up along it to the next pocket.
///
/// Result: whether there is one.
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

/// Goes down the first pocket without cutting its levels: G71.1 has cut them before.
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

/// Turns the outline as G70 must to follow it: by a right angle if it runs back otherwise.
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
        return core::fail(ErrorCode::invalid_value, "I, the depth of a cut, must be positive");
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

core::Result<TurningArc> turning_arc_from_radius(TurningPoint start, TurningPoint end,
                                                 double radius, bool counterclockwise) {
    const ZxPoint from(start.z, start.x), to(end.z, end.x);
    const double square = radius * radius / std::norm(to - from) - 0.25;
    if (!(square >= 0.0))
        return core::fail(ErrorCode::invalid_value,
                          fmt::format("the radius {:.4f} mm does not reach from the arc's start to "
                                      "its end, half of the way is {:.4f} mm",
                                      radius, 0.5 * std::abs(to - from)));
    const ZxPoint aside = ZxPoint(0, 1) * std::sqrt(square) * (to - from);
    const ZxPoint centre = (from + to) / 2.0 + (counterclockwise ? aside : -aside);
    return TurningArc{{centre.imag(), centre.real()}, counterclockwise};
}

} // namespace gcode
