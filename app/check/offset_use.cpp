#include "app/check/offset_use.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/rule_table.h"
#include "core/base/units.h"
#include "core/motion/kinematics.h"
#include "core/sim/run/finding_text.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "gcode/exec/interpreter.h"

namespace app {
namespace {

constexpr const char* names[] = {"G54", "G55",   "G56",   "G57",  "G58",
                                 "G59", "G59.1", "G59.2", "G59.3"};
constexpr double nearly_all = 0.9;  // of the feed travel
constexpr double cut_through = 3.0; // mm below the stock that cutting through may reach
constexpr double in_the_air = 0.5;  // mm above the stock; feeds closer to its top may be intended
constexpr double slack = 0.01;      // mm by which a cut along a face may miss the face

/// The tool tip at both ends of a motion, in the frame of the stock.
struct TipWay {
    core::Vec3 from = core::Vec3(0.0), to = core::Vec3(0.0);
    bool upright = true;

    double low() const { return std::min(from.z, to.z); }
    double high() const { return std::max(from.z, to.z); }
};

std::optional<TipWay> tip_way(const core::Setup& setup, const core::Motion& motion, double length) {
    core::AxisValues positions[2] = {};
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (!setup.machine.axes[i].present) continue;
        if (!motion.from[i] || !motion.to[i]) return std::nullopt;
        positions[0][i] = *motion.from[i];
        positions[1][i] = *motion.to[i];
    }
    const core::Mount tip{setup.machine.spindle, core::translation({0.0, 0.0, -length})};
    TipWay way;
    for (int end = 0; end < 2; ++end) {
        const core::Transform pose =
            core::target_from_mover(setup.machine, setup.stock_mount, tip, positions[end]);
        (end == 0 ? way.from : way.to) = pose.translation;
        way.upright = way.upright && pose.rotation[2].z > 0.9999;
    }
    return way;
}

/// Whether the motion crosses the stock's outline in XY, at any height.
bool crosses(const TipWay& way, const core::Aabb& stock, double radius) {
    for (int axis = 0; axis < 2; ++axis)
        if (std::max(way.from[axis], way.to[axis]) + radius < stock.min[axis]
            || std::min(way.from[axis], way.to[axis]) - radius > stock.max[axis])
            return false;
    return true;
}

void add_feed(OffsetUse& use, const TipWay& way, const core::Aabb& stock, double datum,
              core::BlockIndex block) {
    const double length = glm::distance(way.from, way.to);
    use.way += length;
    if (way.low() >= stock.max.z - slack) {
        use.above += length;
        if (!use.above_block) use.above_block = block;
    } else if (way.high() <= stock.min.z + slack) {
        use.below += length;
        use.under = std::min(use.under, stock.min.z - way.high());
        if (!use.below_block) use.below_block = block;
    } else {
        return;
    }
    use.lowest = std::min(use.lowest, way.low() - datum);
    use.highest = std::max(use.highest, way.low() - datum);
}

core::Finding finding_of(const core::Setup& setup, size_t index, const OffsetUse& use, bool above) {
    core::Finding finding;
    finding.rule = core::rule_id("offset-implausible");
    finding.severity = core::severity_of(setup, finding.rule);
    finding.block = above ? use.above_block : use.below_block;
    finding.message =
        fmt::format("In {} the program feeds between Z{:.3f} and Z{:.3f}, but the stock is between "
                    "Z{:.3f} and Z{:.3f}: {}.",
                    names[index], use.lowest, use.highest, use.stock_bottom, use.stock_top,
                    above ? "all cuts are above the stock" : "the cuts are below the stock");
    finding.cure = fmt::format("Check whether the program's zero is at the top or the bottom of "
                               "the stock, and set Z of {} there.",
                               names[index]);
    return finding;
}

} // namespace

void track_offsets(OffsetUses& uses, const core::Setup& setup, const gcode::InterpreterState& at,
                   const core::BlockEvents& block, const core::SimulatorState& state) {
    const size_t index = at.modal.offsets.active;
    const auto tool = state.tool ? setup.tools.find(*state.tool) : setup.tools.end();
    if (tool == setup.tools.end() || index >= std::size(names)) return;
    const core::Aabb& stock = state.stock.outer_box;
    for (const core::Event& event : block.events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        const auto way = motion ? tip_way(setup, *motion, tool->second.length) : std::nullopt;
        const double radius = 0.5 * tool->second.description.diameter;
        if (!way || !crosses(*way, stock, radius)) continue;
        OffsetUse& use = uses[index];
        use.is_judged = use.is_judged && way->upright;
        if (motion->kind == core::MotionKind::rapid) {
            // A rapid may retract upwards out of a cut that goes through the stock.
            const bool leaves = way->from.z < way->to.z;
            use.rapids_through =
                use.rapids_through || (!leaves && way->low() < stock.max.z - slack);
            continue;
        }
        if (!core::turns_to_cut(state.spindle, tool->second) || !at.modal.position[2]) continue;
        const double datum = way->to.z - *at.modal.position[2];
        use.stock_bottom = stock.min.z - datum;
        use.stock_top = stock.max.z - datum;
        add_feed(use, *way, stock, datum, block.block);
    }
}

std::vector<core::Finding> implausible_offsets(const OffsetUses& uses, const core::Setup& setup) {
    std::vector<core::Finding> findings;
    for (const auto& [index, use] : uses) {
        if (!use.is_judged || use.way <= 0.0) continue;
        const bool above =
            use.above >= nearly_all * use.way && use.highest > use.stock_top + in_the_air;
        const bool below =
            use.below >= nearly_all * use.way && (use.rapids_through || use.under > cut_through);
        if (above || below) findings.push_back(finding_of(setup, index, use, above));
    }
    std::erase_if(findings, [](const core::Finding& finding) {
        return finding.severity == core::Severity::off;
    });
    return findings;
}

namespace {

constexpr double doubt = 2.0; // a part and its stock differ by less than this factor

/// Whether a ratio of sizes is close to 25.4.
bool is_units_apart(double ratio) {
    return ratio > core::mm_per_inch / doubt && ratio < core::mm_per_inch * doubt;
}

} // namespace

void track_units(UnitsTracker& tracker, const core::BlockEvents& block) {
    for (const core::Event& event : block.events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        if (!motion || motion->kind == core::MotionKind::rapid) continue;
        for (const core::AxisPosition& end : {motion->from, motion->to}) {
            if (!end[0] || !end[1] || !end[2]) continue;
            tracker.box.extend(core::Vec3(*end[0], *end[1], *end[2]));
            if (!tracker.first) tracker.first = block.block;
        }
    }
}

std::optional<core::Finding> unit_mismatch(const UnitsTracker& tracker, const core::Setup& setup,
                                           const core::Aabb& stock, bool unit_said) {
    if (!tracker.first) return std::nullopt;
    const core::Vec3 path = tracker.box.size(), size = stock.size();
    const double longest = std::max(path.x, path.y), widest = std::max(size.x, size.y);
    if (!(longest > 0.0 && widest > 0.0)) return std::nullopt;
    const bool large = is_units_apart(longest / widest);
    const bool small = !unit_said && is_units_apart(widest / longest);
    if (!large && !small) return std::nullopt;
    core::Finding finding;
    finding.rule = core::rule_id("units-jump");
    finding.severity = core::severity_of(setup, finding.rule);
    finding.block = tracker.first;
    finding.message = fmt::format("The feed moves span {:.1f} mm and the stock {:.1f} mm, about "
                                  "25.4 times as {}: mm and inches may be mixed up.",
                                  longest, widest, large ? "much" : "little");
    finding.cure = "Check G20 and G21, and the units of the set-up.";
    if (finding.severity == core::Severity::off) return std::nullopt;
    return finding;
}

} // namespace app
