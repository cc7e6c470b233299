#include "tests/support/canonical_program.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>

namespace test_support {
namespace {

constexpr std::string_view letters = "XYZABCUVW";

class CanonicalWriter {
public:
    std::string program(const PlainRun& run) {
        text_ = "G21 G90 G94 G40 G49 G80 G90.1 G97\n";
        for (const PlainCommand& command : run.commands) {
            change_state(command.state);
            write(command);
            now_ = command.state;
        }
        return text_;
    }

private:
    template <typename... Values>
    void line(fmt::format_string<Values...> format, Values&&... values) {
        text_ += fmt::format(format, std::forward<Values>(values)...) + "\n";
    }

    static std::string number(double value) { return fmt::format("{:.12f}", value); }

    static std::string words(const Axes& axes) {
        std::string text;
        for (size_t axis = 0; axis < axes.size(); ++axis)
            text += fmt::format(" {}{}", letters[axis], number(axes[axis]));
        return text;
    }

    static std::string offset_code(int number) {
        return number <= 6 ? fmt::format("G{}", 53 + number) : fmt::format("G59.{}", number - 6);
    }

    void change_offsets(const PlainState& to) {
        if (to.work != now_.work || to.rotation_deg != now_.rotation_deg
            || to.work_offset != now_.work_offset) {
            line("G10 L2 P{}{} R{}", to.work_offset, words(to.work), number(to.rotation_deg));
            line("{}", offset_code(to.work_offset));
        }
        if (to.axis != now_.axis) line("G52{}", words(to.axis));
        if (to.tool_offset != now_.tool_offset) line("G43.1{}", words(to.tool_offset));
    }

    void change_tool(const PlainState& to) {
        // A tool that was not loaded by a tool change was set by M61.
        if (to.tool != now_.tool) line("M61 Q{}", to.tool);
        if (to.selected_tool != now_.selected_tool) line("T{}", to.selected_tool);
    }

    void change_machine(const PlainState& to) {
        if (to.fastest_speed != now_.fastest_speed || to.speed != now_.speed
            || to.spindle != now_.spindle) {
            if (to.fastest_speed > 0.0)
                line("G96 D{} S{}", number(to.fastest_speed), number(to.speed));
            else
                line("G97 S{}", number(to.speed));
            line("{}", to.spindle == "stopped" ? "M5" : to.spindle == "clockwise" ? "M3" : "M4");
        }
        if (to.mist != now_.mist || to.flood != now_.flood)
            line("M9{}{}", to.mist ? "\nM7" : "", to.flood ? "\nM8" : "");
        if (to.path != now_.path || to.tolerance != now_.tolerance
            || to.naive_tolerance != now_.naive_tolerance) {
            if (to.path == "continuous")
                line("G64 P{} Q{}", number(to.tolerance), number(to.naive_tolerance));
            else
                line("{}", to.path == "exact_path" ? "G61" : "G61.1");
        }
        if (to.feed_override != now_.feed_override) line("M50 P{}", int(to.feed_override));
        if (to.speed_override != now_.speed_override) line("M51 P{}", int(to.speed_override));
        if (to.adaptive_feed != now_.adaptive_feed) line("M52 P{}", int(to.adaptive_feed));
        if (to.feed_hold != now_.feed_hold) line("M53 P{}", int(to.feed_hold));
    }

    void change_state(const PlainState& to) {
        change_machine(to);
        change_offsets(to);
    }

    void write_arc(const PlainCommand& command) {
        constexpr std::pair<std::string_view, std::string_view> planes[] = {
            {"XY", "G17"}, {"ZX", "G18"}, {"YZ", "G19"}};
        constexpr std::string_view centres[] = {"IJ", "KI", "JK"};
        for (size_t plane = 0; plane < std::size(planes); ++plane) {
            if (planes[plane].first != command.state.plane) continue;
            line("{} {}{} {}{} {}{} P{} F{}", planes[plane].second, command.turns > 0 ? "G3" : "G2",
                 words(command.end), centres[plane][0], number(command.centre[0]),
                 centres[plane][1], number(command.centre[1]), std::abs(command.turns),
                 number(command.state.feed));
            return;
        }
        throw std::invalid_argument("an arc in the plane " + command.state.plane);
    }

    void write(const PlainCommand& command) {
        const std::string& kind = command.kind;
        const auto value = [&](size_t index) { return number(command.values.at(index)); };
        if (kind != "change_tool") change_tool(command.state);
        if (kind == "straight_traverse") return line("G0{}", words(command.end));
        if (kind == "straight_feed")
            return line("G1{} F{}", words(command.end), number(command.state.feed));
        if (kind == "arc_feed") return write_arc(command);
        if (kind == "dwell") return line("G4 P{}", value(0));
        if (kind == "change_tool") return line("T{} M6", static_cast<int>(command.values.at(0)));
        if (kind == "program_stop") return line("M0");
        if (kind == "optional_stop") return line("M1");
        if (kind == "program_end") return line("M2");
        if (kind == "set_output") return write_output(command);
        throw std::invalid_argument("a command " + kind);
    }

    void write_output(const PlainCommand& command) {
        const bool analog = command.values.at(2) != 0.0, with_motion = command.values.at(3) != 0.0;
        const int output = static_cast<int>(command.values.at(0));
        if (analog)
            line("M{} E{} Q{}", with_motion ? 67 : 68, output, number(command.values.at(1)));
        else
            line("M{} P{}", (with_motion ? 62 : 64) + (command.values.at(1) == 0.0), output);
    }

    std::string text_;
    PlainState now_;
};

} // namespace

std::string canonical_program(const PlainRun& run) { return CanonicalWriter().program(run); }

} // namespace test_support
