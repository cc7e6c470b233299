#include "gcode/lower/trace.h"

#include <initializer_list>
#include <string_view>

#include <fmt/format.h>

#include "core/base/text.h"

namespace gcode {
namespace {

constexpr int decimals = 6; // numbers are rounded to a millionth

/// Appends key=value pairs to a text, each after a blank.
class Pairs {
public:
    explicit Pairs(std::string& text) : text_(text) {}

    Pairs& add(std::string_view key, double value) {
        begin(key);
        core::append_number(text_, value, decimals);
        return *this;
    }
    Pairs& add(std::string_view key, std::string_view value) {
        begin(key);
        text_ += value;
        return *this;
    }
    Pairs& add(std::string_view key, const char* value) = delete; // it would become a bool
    Pairs& add(std::string_view key, int64_t value) {
        begin(key);
        text_ += fmt::format_int(value).c_str();
        return *this;
    }
    Pairs& add(std::string_view key, bool value) { return add(key, int64_t{value}); }

    /// Several numbers, with commas between them.
    Pairs& add(std::string_view key, std::initializer_list<double> values) {
        begin(key);
        for (const double& value : values) {
            if (&value != values.begin()) text_ += ',';
            core::append_number(text_, value, decimals);
        }
        return *this;
    }

    Pairs& add(const Position& position) {
        // Axes other than X, Y and Z that are at zero usually do not exist.
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (position[axis] && (axis < 3 || *position[axis] != 0.0))
                add(name(axis), *position[axis]);
            else if (!position[axis] && axis >= 3)
                add(name(axis), std::string_view("?"));
        return *this;
    }

    Pairs& add(const char* word) {
        text_ += ' ';
        text_ += word;
        return *this;
    }

    static std::string_view name(size_t axis) {
        static constexpr std::string_view names = "xyzabcuvw"; // axis_letters in small letters
        static_assert(names.size() == axis_letters.size());
        return names.substr(axis, 1);
    }

private:
    void begin(std::string_view key) {
        text_ += ' ';
        text_ += key;
        text_ += '=';
    }

    std::string& text_;
};

std::string_view name_of(core::SpindleDirection direction) {
    if (direction == core::SpindleDirection::stopped) return "stopped";
    return direction == core::SpindleDirection::clockwise ? "clockwise" : "counterclockwise";
}

/// Appends the values of a command.
struct Details {
    Pairs pairs;

    void operator()(const StraightTraverse& command) {
        pairs.add(command.end);
        if (command.in_plane) pairs.add("in_plane");
    }
    void operator()(const StraightFeed& command) {
        pairs.add(command.end).add("feed", command.feed);
        if (command.in_plane) pairs.add("in_plane");
    }
    void operator()(const ArcFeed& command) {
        pairs.add(command.end)
            .add("plane", name_of(command.plane))
            .add("centre", {command.centre[0], command.centre[1]})
            .add("turns", int64_t{command.turns})
            .add("feed", command.feed);
    }
    void operator()(const Dwell& command) { pairs.add("seconds", command.seconds); }
    void operator()(const SelectTool& command) {
        pairs.add("tool", int64_t{value_of(command.tool)});
    }
    void operator()(const ChangeTool& command) {
        pairs.add("tool", int64_t{command.tool ? value_of(*command.tool) : 0});
    }
    void operator()(const NameTool& command) {
        pairs.add("tool", int64_t{command.tool ? value_of(*command.tool) : 0});
    }
    void operator()(const Spindle& command) {
        pairs.add("direction", name_of(command.direction)).add("speed", command.speed);
    }
    void operator()(const Coolant& command) {
        pairs.add("mist", command.mist).add("flood", command.flood);
    }
    void operator()(const SelectPlane& command) { pairs.add("plane", name_of(command.plane)); }
    void operator()(const SetOffset& command) {
        const Offsets& offsets = command.offsets;
        Position sum;
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (offsets.axis[axis])
                sum[axis] = offsets.work.origin[axis] + offsets.local[axis] + *offsets.axis[axis];
        pairs.add("offset", std::string_view(name_of_offset(offsets.active))).add(sum);
        if (offsets.work.rotation_deg != 0.0) pairs.add("rotation", offsets.work.rotation_deg);
        if (!offsets.has_frame) return;
        const auto& m = offsets.frame.linear;
        const auto& shift = offsets.frame.shift;
        pairs.add("frame", {m[0][0], m[1][0], m[2][0], m[0][1], m[1][1], m[2][1], m[0][2], m[1][2],
                            m[2][2], shift.x, shift.y, shift.z});
    }
    void operator()(const UseToolLengthOffset& command) {
        if (command.number) pairs.add("number", int64_t{value_of(*command.number)});
        pairs.add("length", command.offset[2]);
        for (size_t axis = 0; axis < axis_count; ++axis)
            if (axis != 2 && command.offset[axis] != 0.0)
                pairs.add(Pairs::name(axis), command.offset[axis]);
        if (command.follows_tip) pairs.add("follows_tip");
    }
    void operator()(const UseSpindleMode& command) {
        pairs.add("surface_speed", command.surface_speed)
            .add("speed", command.speed)
            .add("fastest_speed", command.fastest_speed);
    }
    void operator()(const SetPathMode& command) {
        constexpr std::string_view names[] = {"exact_path", "exact_stop", "continuous"};
        pairs.add("mode", names[static_cast<size_t>(command.mode)])
            .add("tolerance", command.tolerance)
            .add("naive_tolerance", command.naive_tolerance);
        const auto add = [&](const char* name, const std::optional<double>& value) {
            if (value) pairs.add(name, *value);
        };
        add("distance", command.corners.distance);
        // In LinuxCNC's G64 P it is the tolerance.
        if (command.corners.rapid_tolerance != command.tolerance)
            add("rapid_tolerance", command.corners.rapid_tolerance);
        add("rapid_distance", command.corners.rapid_distance);
    }
    void operator()(const EnableOverride& command) {
        constexpr std::string_view names[] = {"feed", "speed", "adaptive_feed", "feed_hold"};
        pairs.add("kind", names[static_cast<size_t>(command.kind)]).add("enabled", command.enabled);
    }
    void operator()(const SetOutput& command) {
        pairs.add("number", int64_t{command.number})
            .add("value", command.value)
            .add("analog", command.is_analog)
            .add("with_motion", command.with_motion);
    }
    void operator()(const WaitForInput& command) {
        pairs.add("number", int64_t{command.number})
            .add("analog", command.is_analog)
            .add("seconds", command.seconds);
    }
    void operator()(const Message& command) { pairs.add("text", std::string_view(command.text)); }
    void operator()(const StraightProbe& command) {
        pairs.add(command.end)
            .add("feed", command.feed)
            .add("towards", command.towards)
            .add("must_succeed", command.must_succeed);
    }
    void operator()(const ThreadFeed& command) {
        pairs.add(command.end).add("pitch", command.pitch).add("back_again", command.back_again);
    }
    void operator()(const ProgramStop&) {}
    void operator()(const OptionalStop&) {}
    void operator()(const ProgramEnd&) {}
};

} // namespace

void append_text(const CanonicalCommand& command, std::string& text) {
    text += command_name(command);
    std::visit(Details{Pairs(text)}, command);
}

std::string to_text(const CanonicalCommand& command) {
    std::string text;
    append_text(command, text);
    return text;
}

} // namespace gcode
