#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/check/feed_use.h"
#include "core/base/rule_table.h"
#include "core/distance/body_distance.h"
#include "core/motion/kinematics.h"
#include "core/motion/path.h"
#include "core/sim/run/finding_text.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "gcode/language/canonical.h"

namespace app {
namespace {

constexpr double nearly_all = 0.9;  // of the feed travel
constexpr double cut_through = 3.0; // mm below the stock that cutting through may reach
constexpr double in_the_air = 0.5;  // mm above the stock; feeds closer to its top may be intended
constexpr double slack = 0.01;      // mm by which a cut along a face may miss the face
constexpr double path_error = 0.5;  // mm, of chords

/// "G54", "G59.1", "G54.1 P7"; without a work offset, a name for that.
std::string name_of_offset(size_t index) {
    return index >= gcode::no_work_offset ? "machine coordinates" : gcode::name_of_offset(index);
}

/// The path of the tool over a motion, in the frame of the stock.
struct ToolTrack {
    std::vector<core::Vec3> tips; // at least two
    core::Aabb flutes;            // box around the flutes on the way
    bool upright = true;

    double low() const { return reached().min.z; }
    double high() const { return reached().max.z; }
    core::Aabb reached() const {
        core::Aabb box;
        for (const core::Vec3& tip : tips) box.extend(tip);
        return box;
    }
    double length() const {
        double way = 0.0;
        for (size_t i = 1; i < tips.size(); ++i) way += glm::distance(tips[i - 1], tips[i]);
        return way;
    }
};

/// The axis values at which a motion is looked at; empty if one of its ends is unknown.
std::vector<core::AxisValues> stations(const core::Machine& machine, const core::Motion& motion) {
    core::AxisValues from = {}, to = {};
    bool turns = false;
    for (size_t i = 0; i < core::axis_count; ++i) {
        if (!machine.axes[i].present) continue;
        if (!motion.from[i] || !motion.to[i]) return {};
        from[i] = *motion.from[i];
        to[i] = *motion.to[i];
        turns = turns || (core::is_rotary(i) && from[i] != to[i]);
    }
    std::vector<core::AxisValues> values = {from};
    const bool bends = motion.arc || (turns && !motion.tip);
    if (bends && motion.kind != core::MotionKind::rapid)
        for (const core::Leg& leg : core::path_of(motion, machine, path_error).legs)
            values.insert(values.end(), leg.positions.begin(), leg.positions.end());
    values.push_back(to);
    return values;
}

std::optional<ToolTrack> track_of(const core::Setup& setup, const core::Motion& motion,
                                  const core::ToolAssembly& tool) {
    const core::Mount mount{setup.machine.spindle, core::translation({0.0, 0.0, -tool.length})};
    const double radius = 0.5 * tool.description.diameter;
    ToolTrack track;
    for (const core::AxisValues& values : stations(setup.machine, motion)) {
        const core::Transform pose =
            core::target_from_mover(setup.machine, setup.stock_mount, mount, values);
        track.tips.push_back(pose.translation);
        track.upright = track.upright && pose.rotation[2].z > 0.9999;
        for (const double height : {0.0, tool.description.flute_length}) {
            const core::Vec3 middle = pose * core::Vec3(0.0, 0.0, height);
            track.flutes.extend(core::Aabb{middle, middle}.grown(radius));
        }
    }
    if (track.tips.empty()) return std::nullopt;
    // Below an upright tool there is nothing.
    if (track.upright) track.flutes.min.z = track.low();
    return track;
}

/// Whether two boxes overlap in XY, at any height.
bool overlaps_in_plane(const core::Aabb& a, const core::Aabb& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

/// The box of a fixture on the stock's link, in the frame of the stock.
core::Aabb box_of(const core::Setup& setup, const core::Fixture& fixture) {
    const core::Transform stock_from_fixture =
        setup.stock_mount.link_from_body.inverse() * fixture.mount.link_from_body;
    const core::Aabb body = core::bounds(fixture.body);
    core::Aabb box;
    for (const double x : {body.min.x, body.max.x})
        for (const double y : {body.min.y, body.max.y})
            for (const double z : {body.min.z, body.max.z})
                box.extend(stock_from_fixture * core::Vec3(x, y, z));
    return box;
}

/// Lower bound of the distance of the flutes to what they are there to cut: the stock and
/// expendable fixtures.
double gap_to_work(const core::Setup& setup, const core::Aabb& flutes, const core::Aabb& stock) {
    double gap = core::distance(flutes, stock);
    for (const core::Fixture& fixture : setup.fixtures) {
        if (!fixture.expendable) continue;
        if (fixture.mount.link != setup.stock_mount.link) return 0.0; // it moves; not compared
        gap = std::min(gap, core::distance(flutes, box_of(setup, fixture)));
    }
    return gap;
}

/// The length of a tool in the control, and its true length. Equal if the length acts along another
/// axis than Z or the tool is tilted.
LengthError length_of(const core::ToolAssembly& tool, const gcode::Offsets& offsets,
                      const core::SimulatorState& state, const ToolTrack& track) {
    const bool is_along_z = offsets.tool[0] == 0.0 && offsets.tool[1] == 0.0 && track.upright;
    return {.tool = tool.description.number,
            .number = state.length_offset.number,
            .counted = is_along_z ? offsets.tool[2] : tool.length,
            .length = tool.length};
}

/// The datum of the work offset at the end of a motion. `higher`: how much higher the tip is than
/// the control counts.
void note_datum(OffsetUse& use, const gcode::Offsets& offsets, const core::Motion& motion,
                const ToolTrack& track, double higher) {
    const gcode::Position from = gcode::program_from_machine(offsets, motion.from);
    const gcode::Position to = gcode::program_from_machine(offsets, motion.to);
    core::Vec3 first(0.0), last(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<size_t>(axis);
        first[axis] = from[i].value_or(0.0);
        last[axis] = to[i].value_or(0.0);
    }
    const core::Vec3 up(0.0, 0.0, higher);
    use.datum = track.tips.back() - last - up;
    constexpr double rounding = 1e-3;
    use.is_parallel =
        use.is_parallel && glm::distance(track.tips.front() - first - up, use.datum) < rounding;
}

void add_feed(OffsetUse& use, const core::Setup& setup, const ToolTrack& track,
              const core::Aabb& stock, core::BlockIndex block) {
    const double length = track.length();
    if (!use.first) use.first = block;
    use.total += length;
    use.feeds.extend(track.reached());
    use.gap = std::min(use.gap, gap_to_work(setup, track.flutes, stock));
    if (!overlaps_in_plane(track.flutes, stock.grown(core::air_gap))) {
        use.beside += length;
        if (!use.beside_block) use.beside_block = block;
    }
}

/// Adds a feed within the stock's outline to those above or below the stock.
void add_height(OffsetUse& use, const ToolTrack& track, const core::Aabb& stock,
                core::BlockIndex block, const LengthError& error) {
    const double length = track.length(), higher = error.higher();
    use.way += length;
    bool is_by_length = false;
    if (track.low() >= stock.max.z - slack) {
        use.above += length;
        if (!use.above_block) use.above_block = block;
        is_by_length = track.low() - higher < stock.max.z - slack;
        if (is_by_length) use.above_by_length += length;
    } else if (track.high() <= stock.min.z + slack) {
        use.below += length;
        use.under = std::min(use.under, stock.min.z - track.high());
        if (!use.below_block) use.below_block = block;
        is_by_length = track.high() - higher > stock.min.z + slack;
        if (is_by_length) use.below_by_length += length;
    } else {
        return;
    }
    if (is_by_length && !use.length_error) use.length_error = error;
    const double zero = use.datum.z + higher;
    use.lowest = std::min(use.lowest, track.low() - zero);
    use.highest = std::max(use.highest, track.high() - zero);
    use.highest_bottom = std::max(use.highest_bottom, track.low());
}

/// Whether a part of the feeds within the stock's outline is nearly all of them.
bool is_nearly_all(const OffsetUse& use, double part) {
    return use.way > 0.0 && part >= nearly_all * use.way;
}

/// The wrong length because of which the feeds are above or below the stock; null if that is not
/// the cause.
const LengthError* length_cause(const OffsetUse& use) {
    const bool is_above =
        is_nearly_all(use, use.above) && !is_nearly_all(use, use.above - use.above_by_length);
    const bool is_below =
        is_nearly_all(use, use.below) && !is_nearly_all(use, use.below - use.below_by_length);
    return is_above || is_below ? &*use.length_error : nullptr;
}

/// "The control counts with a length of 150.000 mm (H3) for tool 1, which is 100.000 mm long: its
/// tip is 50.000 mm higher than programmed".
std::string length_text(const LengthError& error) {
    const int tool = core::value_of(error.tool);
    const bool is_of_other = error.number && core::value_of(*error.number) != tool;
    return fmt::format(
        "The control counts with a length of {:.3f} mm{} for tool {}, which is {:.3f} mm long: its "
        "tip is {:.3f} mm {} than programmed",
        error.counted,
        is_of_other ? fmt::format(" (H{})", core::value_of(*error.number)) : std::string(), tool,
        error.length, std::abs(error.higher()), error.higher() > 0.0 ? "higher" : "lower");
}

std::string cure_of(const LengthError& error) {
    const int tool = core::value_of(error.tool);
    if (error.number && core::value_of(*error.number) != tool)
        return fmt::format("Use H{}, or correct its length.", tool);
    return fmt::format("Correct the length of tool {} in the control; if it is right there, "
                       "correct the tool in the set-up.",
                       tool);
}

/// "X0.000 to X10.000, Y..." of those axes in which the boxes are apart, or of all.
std::string ranges_text(const core::Aabb& box, const core::Aabb& other, bool all_axes) {
    std::string text;
    for (int axis = 0; axis < 3; ++axis) {
        const bool apart =
            box.min[axis] > other.max[axis] || other.min[axis] > box.max[axis] || all_axes;
        if (!apart) continue;
        const char letter = core::axis_letters[static_cast<size_t>(axis)];
        text += fmt::format("{}{}{:.3f} to {}{:.3f}", text.empty() ? "" : ", ", letter,
                            box.min[axis], letter, box.max[axis]);
    }
    return text;
}

/// Where the feeds and the stock are, to follow a colon.
std::string places_text(const std::string& offset, const OffsetUse& use, const core::Aabb& stock) {
    const core::Vec3 datum = use.is_parallel ? use.datum : core::Vec3(0.0);
    const core::Aabb feeds{use.feeds.min - datum, use.feeds.max - datum};
    const core::Aabb body{stock.min - datum, stock.max - datum};
    const bool apart = !core::overlaps(feeds, body);
    return fmt::format("in {} the tip feeds at {}, and the stock is at {}",
                       use.is_parallel ? offset : "the frame of the stock",
                       ranges_text(feeds, body, !apart), ranges_text(body, feeds, !apart));
}

core::Finding new_finding(const core::Setup& setup, const char* rule,
                          std::optional<core::BlockIndex> block) {
    core::Finding finding;
    finding.rule = rule;
    finding.severity = core::severity_of(setup, finding.rule);
    finding.block = block;
    return finding;
}

core::Finding height_finding(const core::Setup& setup, size_t index, const OffsetUse& use,
                             const core::Aabb& stock, bool above) {
    core::Finding finding = new_finding(setup, core::rule_id("offset-implausible"),
                                        above ? use.above_block : use.below_block);
    const std::string where =
        above ? "all cuts are above the stock" : "the cuts are below the stock";
    if (const LengthError* error = length_cause(use)) {
        finding.message = fmt::format("{}, and {}.", length_text(*error), where);
        finding.cure = cure_of(*error);
        return finding;
    }
    const std::string name = name_of_offset(index);
    finding.message = fmt::format(
        "In {} the program feeds between Z{:.3f} and Z{:.3f}, but the stock is between "
        "Z{:.3f} and Z{:.3f}: {}.",
        name, use.lowest, use.highest, stock.min.z - use.datum.z, stock.max.z - use.datum.z, where);
    finding.cure = fmt::format("Check whether the program's zero is at the top or the bottom of "
                               "the stock, and set Z of {} there.",
                               name);
    return finding;
}

core::Finding beside_finding(const core::Setup& setup, size_t index, const OffsetUse& use,
                             const core::Aabb& stock, bool cuts_elsewhere) {
    core::Finding finding =
        new_finding(setup, core::rule_id("offset-implausible"), use.beside_block);
    const std::string name = name_of_offset(index);
    finding.message =
        fmt::format("The cuts are beside the stock: {}.", places_text(name, use, stock));
    finding.cure = fmt::format("Compare X and Y of {} with the position of the stock.", name);
    if (!cuts_elsewhere) return finding;
    finding.severity = std::min(finding.severity, core::Severity::note);
    finding.cure = fmt::format("If a second workpiece is clamped at {}, check it with a set-up of "
                               "its own. {}",
                               name, finding.cure);
    return finding;
}

bool feeds(const core::BlockEvents& block) {
    return std::any_of(block.events.begin(), block.events.end(), [](const core::Event& event) {
        const auto* motion = std::get_if<core::Motion>(&event);
        return motion && motion->kind != core::MotionKind::rapid;
    });
}

bool is_beside(const OffsetUse& use) { return use.beside >= nearly_all * use.total; }

} // namespace

void track_offsets(OffsetUses& uses, const core::Setup& setup, const gcode::Offsets& offsets,
                   const core::BlockEvents& block, const core::SimulatorState& state) {
    const auto tool = state.tool ? setup.tools.find(*state.tool) : setup.tools.end();
    if (tool == setup.tools.end()) return;
    if (state.length_offset.is_assumed) {
        if (feeds(block)) uses[offsets.active].gap = 0.0; // it may cut the stock
        return;
    }
    const core::Aabb& stock = state.stock.outer_box;
    for (const core::Event& event : block.events) {
        const auto* motion = std::get_if<core::Motion>(&event);
        const auto track = motion ? track_of(setup, *motion, tool->second) : std::nullopt;
        if (!track) continue;
        const bool is_rapid = motion->kind == core::MotionKind::rapid;
        const bool cuts = !is_rapid && core::turns_to_cut(state.spindle, tool->second);
        core::Aabb around = track->reached();
        around = around.grown(0.5 * tool->second.description.diameter);
        const bool crosses = overlaps_in_plane(around, stock);
        if (!cuts && !crosses) continue;
        OffsetUse& use = uses[offsets.active];
        if (crosses) use.is_upright = use.is_upright && track->upright;
        if (is_rapid) {
            // A rapid may retract upwards out of a cut that goes through the stock.
            const bool leaves = track->tips.front().z < track->tips.back().z;
            use.rapids_through =
                use.rapids_through || (!leaves && track->low() < stock.max.z - slack);
            continue;
        }
        if (!cuts) continue;
        const LengthError error = length_of(tool->second, offsets, state, *track);
        note_datum(use, offsets, *motion, *track, error.higher());
        add_feed(use, setup, *track, stock, block.block);
        if (crosses) add_height(use, *track, stock, block.block, error);
    }
}

std::vector<core::Finding> implausible_offsets(const OffsetUses& uses, const core::Setup& setup,
                                               const core::Aabb& stock) {
    std::vector<core::Finding> findings;
    const bool some_cut = std::any_of(uses.begin(), uses.end(), [](const auto& entry) {
        return entry.second.total > 0.0 && entry.second.gap <= core::air_gap
               && !is_beside(entry.second);
    });
    for (const auto& [index, use] : uses) {
        if (use.total <= 0.0) continue;
        if (is_beside(use)) {
            findings.push_back(beside_finding(setup, index, use, stock, some_cut));
            continue;
        }
        if (!use.is_upright) continue;
        const bool above =
            is_nearly_all(use, use.above) && use.highest_bottom > stock.max.z + in_the_air;
        const bool below =
            is_nearly_all(use, use.below) && (use.rapids_through || use.under > cut_through);
        if (above || below) findings.push_back(height_finding(setup, index, use, stock, above));
    }
    std::erase_if(findings, [](const core::Finding& finding) {
        return finding.severity == core::Severity::off;
    });
    return findings;
}

std::optional<core::Finding> nothing_cut(const OffsetUses& uses, const core::Setup& setup,
                                         const core::Aabb& stock, bool is_located) {
    double total = 0.0, gap = core::infinity;
    const std::pair<const size_t, OffsetUse>* main = nullptr;
    std::optional<core::BlockIndex> first;
    for (const auto& entry : uses) {
        const OffsetUse& use = entry.second;
        gap = std::min(gap, use.gap);
        if (use.total <= 0.0) continue;
        total += use.total;
        if (!main || use.total > main->second.total) main = &entry;
        if (use.first && (!first || *use.first < *first)) first = use.first;
    }
    constexpr double least = 1.0; // mm of feed travel
    if (!main || total < least || gap <= core::air_gap) return std::nullopt;
    core::Finding finding = new_finding(setup, core::rule_id("nothing-cut"), first);
    if (finding.severity == core::Severity::off) return std::nullopt;
    finding.message = fmt::format(
        "The program feeds {:.0f} mm with the spindle on, but cuts nothing: the flutes "
        "stay at least {:.3f} mm away from the stock{}.",
        total, std::floor(1000.0 * gap) / 1000.0,
        is_located ? "" : "; " + places_text(name_of_offset(main->first), main->second, stock));
    finding.cure = "Check the work offset, the tool lengths and the position of the stock: one of "
                   "them is probably wrong.";
    if (const LengthError* error = length_cause(main->second)) {
        if (!is_located) finding.message += fmt::format(" {}.", length_text(*error));
        finding.cure = cure_of(*error);
    }
    return finding;
}

} // namespace app
