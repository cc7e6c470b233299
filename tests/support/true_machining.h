#pragma once

#include <variant>
#include <vector>

#include "core/sim/tool_assembly.h"
#include "tests/support/true_passage.h"

namespace test_support {

/// A box or a vertical cone, whose distance to a point is a formula.
using TrueSolid = std::variant<core::Aabb, core::ProfileElement>;

/// The distance of a point outside, 0 or less inside, and the nearest point of the solid.
inline PieceDistance nearest_of(const TrueSolid& solid, const core::Vec3& p) {
    if (const auto* cone = std::get_if<core::ProfileElement>(&solid)) return nearest_of(*cone, p);
    const core::Aabb& box = std::get<core::Aabb>(solid);
    const core::Vec3 nearest = glm::clamp(p, box.min, box.max);
    if (nearest != p) return {glm::distance(nearest, p), nearest};
    const core::Vec3 depth = glm::min(p - box.min, box.max - p);
    return {-std::min({depth.x, depth.y, depth.z}), p};
}

struct TrueFixture {
    TrueSolid solid;
    TrueMount mount;
    bool expendable = false;
};

/// A tool with its holder and spindle nose. Frame: the tip is the origin.
struct TrueTool {
    std::array<std::optional<TrueProfile>, 4> parts; // by kind
    double length = 0.0;

    const TrueProfile* part(core::PartKind kind) const {
        const auto& found = parts[size_t(kind)];
        return found ? &*found : nullptr;
    }
};

/// A motion of a tool; `chips`: the flutes cut the stock that they meet.
struct TruePassage {
    const TrueTool* tool;
    TruePath path;
    bool chips = false;
    std::vector<bool> mounted_fixtures = {};
    bool is_certain = true; // false: after a crash, when the remaining material is unknown
};

/// Until when a point certainly exists: a passage of the block and a fraction of it.
struct Removal {
    size_t passage;
    double fraction;
};

/// A stock as the set of points of its raw shape that the flutes have not reached. No model is
/// built: whether a point exists is calculated from the whole history.
struct TrueMachining {
    TrueTrunnion machine;
    TrueSolid stock;
    TrueMount stock_mount;
    std::vector<TrueFixture> fixtures;
    std::vector<TruePassage> history; // those that cut or may have cut

    SeenPoint seen(const TruePassage& by, const TrueMount& mount, const core::Vec3& p) const {
        return {machine, mount, by.path, by.tool->length, p};
    }

    /// The fraction of the passage from which on the flutes may have removed the point.
    std::optional<double> first_cut(const TruePassage& by, const core::Vec3& p) const {
        return first_within(*by.tool->part(core::PartKind::flutes), seen(by, stock_mount, p), 1e-9,
                            Doubt::counts);
    }

    /// Whether the point of the raw stock certainly exists. In the stock's frame.
    bool is_spared(const core::Vec3& p) const {
        if (nearest_of(stock, p).distance > 1e-12) return false; // rounding of a nearest point
        for (const TruePassage& by : history)
            if (first_cut(by, p)) return false;
        return true;
    }

    /// Whether the point may exist, with a tolerance of `slack`.
    bool may_be_there(const core::Vec3& p, double slack) const {
        if (nearest_of(stock, p).distance > slack) return false;
        for (const TruePassage& by : history)
            if (by.is_certain
                && first_within(*by.tool->part(core::PartKind::flutes), seen(by, stock_mount, p),
                                -slack, Doubt::does_not_count))
                return false;
        return true;
    }

    /// Until when the point survives the passages of a block. After a crash of flutes that are not
    /// cutting, anything they passed through is ignored.
    Removal removal(const std::vector<TruePassage>& block, bool crashed,
                    const core::Vec3& p) const {
        for (size_t i = 0; i < block.size(); ++i) {
            if (!block[i].chips && !crashed) continue;
            if (const auto first = first_cut(block[i], p))
                return {i, block[i].chips ? *first : 0.0};
        }
        return {block.size(), 0.0};
    }

    /// Whether the flutes may have cut a point of a fixture, and from which fraction on.
    std::optional<double> first_cut(const TruePassage& by, size_t fixture,
                                    const core::Vec3& p) const {
        if (!by.chips || !by.mounted_fixtures[fixture]) return std::nullopt;
        return first_within(*by.tool->part(core::PartKind::flutes),
                            seen(by, fixtures[fixture].mount, p), 1e-9, Doubt::counts);
    }

    /// Until when a point of an expendable fixture survives a block; empty if it was removed
    /// before.
    std::optional<Removal> removal(const std::vector<TruePassage>& block, size_t fixture,
                                   const core::Vec3& p) const {
        for (const TruePassage& by : history)
            if (first_cut(by, fixture, p)) return std::nullopt;
        for (size_t i = 0; i < block.size(); ++i)
            if (const auto first = first_cut(block[i], fixture, p)) return Removal{i, *first};
        return Removal{block.size(), 0.0};
    }

    /// As `removal`, for points that have certainly been removed, by more than `slack`.
    Removal certain_removal(const std::vector<TruePassage>& block, double slack,
                            const core::Vec3& p) const {
        for (size_t i = 0; i < block.size(); ++i) {
            if (!block[i].chips) continue;
            const auto first =
                first_within(*block[i].tool->part(core::PartKind::flutes),
                             seen(block[i], stock_mount, p), -slack, Doubt::does_not_count);
            if (first) return {i, *first};
        }
        return {block.size(), 0.0};
    }
};

/// The nearest approach of a pair: distance, passage, and fraction of it.
struct Nearness {
    double distance = core::infinity;
    size_t passage = 0;
    double fraction = 0.0;
};

/// A query about a block: the distance of a part of the tool to a mounted body.
struct TruePair {
    core::PartKind part;
    std::optional<size_t> fixture;

    /// Whether the pair must keep apart in this passage.
    bool counts_in(const TrueMachining& world, const TruePassage& by) const {
        if (!by.tool->part(part)) return false;
        const bool chips = by.chips && part == core::PartKind::flutes;
        if (!fixture) return !chips;
        return by.mounted_fixtures[*fixture] && !(chips && world.fixtures[*fixture].expendable);
    }
    /// Whether the flutes of the pair may cut the fixture while feeding.
    bool cuts_fixture(const TrueMachining& world) const {
        return part == core::PartKind::flutes && fixture && world.fixtures[*fixture].expendable;
    }
    const TrueMount& mount(const TrueMachining& world) const {
        return fixture ? world.fixtures[*fixture].mount : world.stock_mount;
    }
    const TrueSolid& solid(const TrueMachining& world) const {
        return fixture ? world.fixtures[*fixture].solid : world.stock;
    }
};

/// The distance of the pair's part to a point of its body while the point exists; only below
/// `limit`.
inline Nearness nearness(const TrueMachining& world, const std::vector<TruePassage>& block,
                         const TruePair& pair, const core::Vec3& p, const Removal& removal,
                         double limit) {
    Nearness best;
    for (size_t i = 0; i < block.size() && i <= removal.passage; ++i) {
        const double until = i < removal.passage ? 1.0 : removal.fraction;
        if (!pair.counts_in(world, block[i])) continue;
        const auto [distance, fraction] = nearest_passage(
            *block[i].tool->part(pair.part), world.seen(block[i], pair.mount(world), p), until,
            std::min(limit, best.distance));
        if (distance < best.distance) best = {distance, i, fraction};
    }
    return best.distance < limit ? best : Nearness{};
}

} // namespace test_support
