#include "tests/support/run_difference.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace test_support {
namespace {

constexpr double exact = 1e-6;   // mm and degrees
constexpr double printed = 6e-5; // four decimals
constexpr double printed_inch = 25.4 * printed;

bool near(double a, double b, double tolerance) {
    return std::abs(a - b) <= tolerance + 1e-9 * std::abs(b);
}

template <typename Values>
bool all_near(const Values& a, const Values& b, double tolerance) {
    return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b),
                      [=](double x, double y) { return near(x, y, tolerance); });
}

bool is_motion(const PlainCommand& command) {
    return command.kind.ends_with("_feed") || command.kind.starts_with("straight_")
           || command.kind == "rigid_tap";
}

bool has_feed(const PlainCommand& command) {
    return command.kind == "straight_feed" || command.kind == "arc_feed"
           || command.kind == "straight_probe";
}

bool has_pitch(const PlainCommand& command) {
    return command.kind == "thread_feed" || command.kind == "rigid_tap";
}

/// The reference gives only three axes of a tapping move.
bool ends_differ(const PlainCommand& reference, const PlainCommand& ours) {
    if (reference.kind != "rigid_tap") return !all_near(reference.end, ours.end, exact);
    const std::vector<double> end(ours.end.begin(), ours.end.begin() + 3);
    return !all_near(reference.values, end, exact);
}

/// The difference in offsets and tool; empty when there is none.
std::string place_difference(const PlainState& reference, const PlainState& ours) {
    if (reference.work_offset != ours.work_offset) return "work offset number";
    if (!all_near(reference.work, ours.work, exact)) return "work offset";
    if (!all_near(reference.axis, ours.axis, exact)) return "G92 or G52 offset";
    if (!near(reference.rotation_deg, ours.rotation_deg, exact)) return "rotation";
    if (!all_near(reference.tool_offset, ours.tool_offset, exact)) return "tool offset";
    return {};
}

std::string mode_difference(const PlainState& reference, const PlainState& ours) {
    if (reference.tool != ours.tool) return "tool";
    if (reference.selected_tool != ours.selected_tool) return "selected tool";
    if (reference.spindle != ours.spindle) return "spindle";
    // A stopped spindle has no speed; the reference keeps the last S word.
    if (ours.spindle != "stopped" && !near(reference.speed, ours.speed, printed)) return "speed";
    if (!near(reference.fastest_speed, ours.fastest_speed, printed)) return "fastest speed";
    if (reference.mist != ours.mist || reference.flood != ours.flood) return "coolant";
    if (reference.path != ours.path) return "path mode";
    if (reference.path == "continuous"
        && (!near(reference.tolerance, ours.tolerance, printed_inch)
            || !near(reference.naive_tolerance, ours.naive_tolerance, printed_inch)))
        return "path tolerance";
    if (reference.feed_override != ours.feed_override
        || reference.speed_override != ours.speed_override
        || reference.adaptive_feed != ours.adaptive_feed || reference.feed_hold != ours.feed_hold)
        return "override";
    return {};
}

/// The difference in the command itself; empty when there is none.
std::string own_difference(const PlainCommand& reference, const PlainCommand& ours) {
    if (reference.kind != ours.kind) return "kind";
    if (is_motion(reference) && ends_differ(reference, ours)) return "end";
    if (reference.kind == "arc_feed") {
        if (reference.state.plane != ours.state.plane) return "plane";
        if (!all_near(reference.centre, ours.centre, exact)) return "centre";
        if (reference.turns != ours.turns) return "turns";
    }
    if (has_feed(reference) && !near(reference.state.feed, ours.state.feed, exact)) return "feed";
    if (has_pitch(reference) && !near(reference.state.pitch, ours.state.pitch, printed_inch))
        return "pitch";
    if (!is_motion(reference) && !all_near(reference.values, ours.values, printed)) return "values";
    return {};
}

/// Whether a feed moves rotary axes only; empty if that does not follow from the commands.
std::optional<bool> turns_only(const std::vector<PlainCommand>& commands, size_t i) {
    size_t before = i;
    while (before > 0 && !is_motion(commands[before - 1])) --before;
    if (before == 0) return std::nullopt;
    const PlainCommand& from = commands[before - 1];
    const PlainState &a = from.state, &b = commands[i].state;
    if (a.work != b.work || a.axis != b.axis || a.tool_offset != b.tool_offset
        || a.rotation_deg != b.rotation_deg)
        return std::nullopt;
    for (size_t axis = 0; axis < from.end.size(); ++axis)
        if (axis / 3 != 1 && from.end[axis] != commands[i].end[axis]) return false;
    return from.end != commands[i].end;
}

/// The reference has its feed for linear axes, and for rotary axes alone.
void choose_feed(PlainCommand& reference, const std::vector<PlainCommand>& ours, size_t i) {
    if (reference.kind != "straight_feed" || ours[i].kind != reference.kind
        || reference.state.turning_feed < 0.0)
        return;
    const bool is_nearer = near(reference.state.turning_feed, ours[i].state.feed, exact);
    if (turns_only(ours, i).value_or(is_nearer))
        reference.state.feed = reference.state.turning_feed;
}

/// At the end of a program the reference resets modes that no longer matter.
std::string difference_of(const PlainCommand& reference, const PlainCommand& ours,
                          bool has_actions) {
    std::string what = own_difference(reference, ours);
    const bool is_end = reference.kind == "program_end";
    if (what.empty() && !is_end) what = place_difference(reference.state, ours.state);
    if (what.empty() && has_actions && !is_end) what = mode_difference(reference.state, ours.state);
    if (what.empty() && is_motion(reference) && reference.line != ours.line) what = "line";
    return what;
}

std::string text_of(const PlainCommand& command) {
    const PlainState& state = command.state;
    std::string text = fmt::format("{}: {}", command.line, command.kind);
    if (is_motion(command))
        text += fmt::format(" end={} feed={}", fmt::join(command.end, ","), state.feed);
    if (!command.values.empty()) text += fmt::format(" values={}", fmt::join(command.values, ","));
    if (command.kind == "arc_feed")
        text += fmt::format(" plane={} centre={} turns={}", state.plane,
                            fmt::join(command.centre, ","), command.turns);
    if (has_pitch(command)) text += fmt::format(" pitch={}", state.pitch);
    text += fmt::format(" | G5x {}: {} G92: {} turned {} tool offset {}", state.work_offset,
                        fmt::join(state.work, ","), fmt::join(state.axis, ","), state.rotation_deg,
                        fmt::join(state.tool_offset, ","));
    text += fmt::format(" | T{} next T{} {} S{} ({}) mist {} flood {} {} {} {} overrides {}{}{}{}",
                        state.tool, state.selected_tool, state.spindle, state.speed,
                        state.fastest_speed, state.mist, state.flood, state.path, state.tolerance,
                        state.naive_tolerance, int(state.feed_override), int(state.speed_override),
                        int(state.adaptive_feed), int(state.feed_hold));
    return text;
}

std::string ending_of(const PlainRun& run) {
    if (run.is_endless) return "endless";
    return run.refused ? fmt::format("refused in line {}: {}", *run.refused, run.message)
                       : std::string("accepted");
}

/// Whether a straight move ends where the previous one did. One interpreter may report such a move
/// and the other not.
bool goes_nowhere(const PlainCommand& command, const PlainCommand& before) {
    const PlainState &now = command.state, &then = before.state;
    return (command.kind == "straight_traverse" || command.kind == "straight_feed")
           && all_near(command.end, before.end, exact) && now.work == then.work
           && now.axis == then.axis && now.tool_offset == then.tool_offset
           && now.rotation_deg == then.rotation_deg;
}

/// Leaves out spindle orientation and pallet changes, which have no modelled motion.
std::vector<PlainCommand> comparable(const PlainRun& run, std::optional<size_t> refused) {
    std::vector<PlainCommand> commands;
    PlainCommand last_move;
    for (const PlainCommand& command : run.commands) {
        const bool is_reported = run.has_actions || is_motion(command) || command.kind == "dwell";
        if (is_reported && command.kind != "orient_spindle" && command.kind != "pallet_shuttle"
            && !goes_nowhere(command, last_move))
            commands.push_back(command);
        if (is_motion(command) && command.kind != "rigid_tap") last_move = command;
    }
    // Commands of a refused line before it was refused.
    while (refused && !commands.empty() && commands.back().line == *refused) commands.pop_back();
    return commands;
}

/// Our commands without those that a six-axis reference does not report.
std::vector<PlainCommand> without_actions(std::vector<PlainCommand> commands) {
    std::erase_if(commands, [](const PlainCommand& command) {
        return !is_motion(command) && command.kind != "dwell";
    });
    return commands;
}

/// A spline is one command in the reference and may be many here: skips to the last one of its
/// line.
void skip_to_end_of_spline(const PlainCommand& spline, std::vector<PlainCommand>& ours,
                           size_t index) {
    size_t last = index;
    while (last + 1 < ours.size() && is_motion(ours[last + 1])
           && ours[last + 1].line == spline.line)
        ++last;
    ours.erase(ours.begin() + static_cast<long>(index), ours.begin() + static_cast<long>(last));
    if (is_motion(ours[index])) ours[index].kind = spline.kind;
}

bool is_accepted(const PlainRun& reference, const std::vector<std::string>& accepted_refusals) {
    return reference.refused
           && std::any_of(accepted_refusals.begin(), accepted_refusals.end(),
                          [&](const std::string& part) {
                              return reference.message.find(part) != std::string::npos;
                          });
}

void compare_endings(const PlainRun& reference, const PlainRun& ours, RunComparison& comparison) {
    const bool same = reference.refused.has_value() == ours.refused.has_value()
                      && reference.is_endless == ours.is_endless;
    const bool same_line = reference.refused.value_or(0) == ours.refused.value_or(0);
    if (same && same_line) return;
    comparison.differences.push_back({reference.refused.value_or(0),
                                      same ? "refused line" : "refusal", ending_of(reference),
                                      ending_of(ours)});
}

} // namespace

RunComparison compare_runs(const PlainRun& reference, const PlainRun& ours,
                           const std::vector<std::string>& accepted_refusals) {
    RunComparison comparison;
    auto there = comparable(reference, reference.refused);
    auto here = comparable(ours, {});
    if (!reference.has_actions) here = without_actions(std::move(here));
    comparison.total = there.size();
    for (size_t i = 0; i < std::min(there.size(), here.size()); ++i) {
        if (there[i].kind == "nurbs_feed") skip_to_end_of_spline(there[i], here, i);
        choose_feed(there[i], here, i);
        const std::string what = difference_of(there[i], here[i], reference.has_actions);
        comparison.equal += what.empty();
        if (what.empty()) continue;
        comparison.differences.push_back(
            {there[i].line, what, text_of(there[i]), text_of(here[i])});
        if (what == "kind" || what == "line") return comparison;
    }
    const bool accepted = is_accepted(reference, accepted_refusals);
    if (!accepted) compare_endings(reference, ours, comparison);
    if (there.size() > here.size() && comparison.differences.empty())
        comparison.differences.push_back(
            {there[here.size()].line, "missing", text_of(there[here.size()]), "nothing"});
    else if (there.size() < here.size() && !accepted && comparison.differences.empty())
        comparison.differences.push_back({0, "too many", "nothing", text_of(here[there.size()])});
    return comparison;
}

std::string report_of(const RunComparison& comparison, const std::string& program) {
    std::vector<std::string> lines;
    std::istringstream stream(program);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    std::string text;
    for (const RunDifference& difference : comparison.differences) {
        const size_t line = difference.line;
        text += fmt::format("{} differs in line {}: {}\n  reference {}\n  ours      {}\n",
                            difference.what, line,
                            line > 0 && line <= lines.size() ? lines[line - 1] : "",
                            difference.reference, difference.ours);
    }
    return text;
}

} // namespace test_support
