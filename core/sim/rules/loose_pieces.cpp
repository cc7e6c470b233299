#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/rule_table.h"
#include "core/dbm/cut_model.h"
#include "core/sim/rules/rules.h"
#include "core/sim/setup.h"

namespace core {
namespace {

/// Names of the mounted fixtures that touch a piece, to within a mesh size.
std::vector<std::string> holders_of(const Setup& setup, const std::vector<bool>& there,
                                    const CutModel& stock, const PieceMap& map, size_t number,
                                    const Aabb& box) {
    const double reach = stock.lines.grid.spacing;
    std::vector<const Fixture*> near;
    for (size_t i = 0; i < setup.fixtures.size(); ++i)
        if (there[i] && distance(bounds(setup.fixtures[i].body), box) <= reach)
            near.push_back(&setup.fixtures[i]);
    std::vector<std::string> names;
    if (near.empty()) return names;
    const auto stretches = map.stretches(stock, number);
    for (const Fixture* fixture : near) {
        const Aabb body = bounds(fixture->body);
        const bool touches = std::any_of(stretches.begin(), stretches.end(), [&](const auto& s) {
            if (distance(body, Aabb{s.first, s.second}) > reach) return false;
            return separation(convex_segment(s.first, s.second), fixture->body,
                              {.limit = 2.0 * reach})
                       .upper
                   <= reach;
        });
        if (touches) names.push_back(fixture->name);
    }
    return names;
}

std::string holding_text(const Setup& setup, const std::vector<std::string>& names) {
    if (!names.empty()) return fmt::format("Still touched by {}.", fmt::join(names, " and "));
    if (setup.fixtures.empty())
        return "The set-up describes no fixture that could hold it: it may fall or be thrown.";
    return "No fixture touches it: it may fall or be thrown.";
}

Finding finding_of(const Setup& setup, const StockPiece& piece, double spacing,
                   const std::vector<std::string>& holders) {
    const Vec3 size = piece.box.size() + Vec3(spacing, spacing, 0);
    Finding finding;
    finding.rule = rule_id("loose-piece");
    finding.severity = severity_of(setup, finding.rule);
    finding.message = fmt::format(
        "A piece of {:.1f} x {:.1f} x {:.1f} mm, {:.0f} mm3, is cut loose at X {:.1f} Y {:.1f} Z "
        "{:.1f} in stock coordinates. {}",
        size.x, size.y, size.z, piece.volume, piece.position.x, piece.position.y, piece.position.z,
        holding_text(setup, holders));
    finding.cure = "Leave tabs that are cut later, or clamp the piece before this cut.";
    return finding;
}

} // namespace

PieceTracker piece_tracker(const CutModel& stock) {
    PieceTracker tracker;
    // A box or a cylinder is one piece; a mesh or a stock with earlier cuts may be several.
    const bool uncut = stock.log.size() == 0;
    if (uncut && !std::holds_alternative<SolidMesh>(stock.solid.shape)) return tracker;
    tracker.known = tracker.map.pieces(stock).size();
    return tracker;
}

std::vector<Finding> track_pieces(const Setup& setup, const std::vector<bool>& mounted_fixtures,
                                  const CutModel& stock, size_t first, PieceTracker& tracker) {
    std::vector<Finding> findings;
    if (first == stock.log.size() || severity_of(setup, rule_id("loose-piece")) == Severity::off)
        return findings;
    const Aabb box = box_of_cuts(stock, first);
    tracker.map.note_cut(stock, box);
    if (is_still_connected(stock, box)) return findings;
    // With several pieces, one may have become a crumb.
    if (tracker.known == 1
        && (hangs_together_within(stock, box) || !tracker.map.may_have_separated(stock)))
        return findings;
    const std::vector<StockPiece> pieces = tracker.map.pieces(stock);
    size_t fresh = pieces.size() > tracker.known ? pieces.size() - tracker.known : 0;
    tracker.known = pieces.size();
    const Aabb near = box.grown(2.0 * stock.lines.grid.spacing);
    // New pieces are next to the cut, and the smaller ones are the ones that come loose.
    for (size_t i = pieces.size(); i-- > 1 && fresh > 0;) {
        if (!overlaps(pieces[i].box, near)) continue;
        const auto holders =
            holders_of(setup, mounted_fixtures, stock, tracker.map, i, pieces[i].box);
        findings.push_back(finding_of(setup, pieces[i], stock.lines.grid.spacing, holders));
        --fresh;
    }
    return findings;
}

} // namespace core
