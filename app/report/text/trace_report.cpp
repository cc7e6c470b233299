#include "app/report/text/trace_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/report/text/text_report.h"
#include "gcode/lower/trace.h"

namespace app {
namespace {

std::string_view direction_name(core::SpindleDirection direction) {
    switch (direction) {
    case core::SpindleDirection::stopped:
        return "stopped";
    case core::SpindleDirection::clockwise:
        return "clockwise";
    default:
        return "counterclockwise";
    }
}

struct Keys {
    JsonLine& json;
    std::string& text; // receives the line

    template <typename Number>
    void add_number(std::string_view key, const std::optional<Number>& number) const {
        if (number)
            json.add(key, int64_t(core::value_of(*number)));
        else
            json.add_null(key);
    }

    void operator()(const gcode::StraightTraverse& c) const {
        json.add_position("end", c.end);
        if (c.in_plane) json.add("in_plane", true);
    }
    void operator()(const gcode::StraightFeed& c) const {
        json.add_position("end", c.end);
        json.add("feed", c.feed);
        if (c.in_plane) json.add("in_plane", true);
    }
    void operator()(const gcode::ArcFeed& c) const {
        json.add_position("end", c.end);
        json.add("plane", gcode::name_of(c.plane));
        json.add_numbers("centre", c.centre, 2);
        json.add("turns", int64_t(c.turns));
        json.add("feed", c.feed);
    }
    void operator()(const gcode::Dwell& c) const { json.add("seconds", c.seconds); }
    void operator()(const gcode::SelectTool& c) const {
        json.add("tool", int64_t(core::value_of(c.tool)));
    }
    void operator()(const gcode::ChangeTool& c) const { add_number("tool", c.tool); }
    void operator()(const gcode::NameTool& c) const { add_number("tool", c.tool); }
    void operator()(const gcode::Spindle& c) const {
        json.add("direction", direction_name(c.direction));
        json.add("speed", c.speed);
    }
    void operator()(const gcode::Coolant& c) const {
        json.add("mist", c.mist);
        json.add("flood", c.flood);
    }
    void operator()(const gcode::SelectPlane& c) const {
        json.add("plane", gcode::name_of(c.plane));
    }
    void operator()(const gcode::SetOffset& c) const {
        json.add("number", int64_t(c.offsets.active) + 1);
        json.add_position("offset", gcode::machine_minus_program(c.offsets));
        json.add("rotation_deg", c.offsets.work.rotation_deg);
        if (!c.offsets.has_frame) return;
        const gcode::ProgramFrame& frame = c.offsets.frame;
        json.begin("frame");
        for (int row = 0; row < 3; ++row) {
            text += row == 0 ? "[[" : ",[";
            for (int column = 0; column < 3; ++column) {
                json.append(frame.linear[column][row]);
                text += ',';
            }
            json.append(frame.shift[row]);
            text += ']';
        }
        text += ']';
    }
    void operator()(const gcode::UseToolLengthOffset& c) const {
        add_number("number", c.number);
        json.add("length", c.offset[2]);
        json.add_numbers("tool_offset", c.offset.data(), c.offset.size());
        if (c.follows_tip) json.add("follows_tip", true);
    }
    void operator()(const gcode::StraightProbe& c) const {
        json.add_position("end", c.end);
        json.add("feed", c.feed);
        json.add("towards", c.towards);
        json.add("must_succeed", c.must_succeed);
    }
    void operator()(const gcode::ThreadFeed& c) const {
        json.add_position("end", c.end);
        json.add("pitch", c.pitch);
        json.add("back_again", c.back_again);
    }
    void operator()(const gcode::UseSpindleMode& c) const {
        json.add("surface_speed", c.surface_speed);
        json.add("speed", c.speed);
        json.add("fastest_speed", c.fastest_speed);
    }
    void operator()(const gcode::SetPathMode& c) const {
        constexpr const char* names[] = {"exact_path", "exact_stop", "continuous"};
        json.add("mode", std::string_view(names[static_cast<size_t>(c.mode)]));
        json.add("tolerance", c.tolerance);
        json.add("naive_tolerance", c.naive_tolerance);
        if (c.corners.distance) json.add("distance", *c.corners.distance);
        if (c.corners.rapid_tolerance) json.add("rapid_tolerance", *c.corners.rapid_tolerance);
        if (c.corners.rapid_distance) json.add("rapid_distance", *c.corners.rapid_distance);
    }
    void operator()(const gcode::EnableOverride& c) const {
        constexpr const char* names[] = {"feed", "speed", "adaptive_feed", "feed_hold"};
        json.add("kind", std::string_view(names[static_cast<size_t>(c.kind)]));
        json.add("enabled", c.enabled);
    }
    void operator()(const gcode::SetOutput& c) const {
        json.add("number", int64_t(c.number));
        json.add("value", c.value);
        json.add("analog", c.is_analog);
        json.add("with_motion", c.with_motion);
    }
    void operator()(const gcode::WaitForInput& c) const {
        json.add("number", int64_t(c.number));
        json.add("analog", c.is_analog);
        json.add("seconds", c.seconds);
    }
    void operator()(const gcode::Message& c) const {
        json.add("message", std::string_view(c.text));
    }
    void operator()(const gcode::ProgramStop&) const {}
    void operator()(const gcode::OptionalStop&) const {}
    void operator()(const gcode::ProgramEnd&) const {}
};

void append_calls(const std::vector<uint32_t>& calls, JsonLine& json, std::string& text) {
    if (calls.empty()) return;
    json.begin("calls");
    fmt::format_to(std::back_inserter(text), "[{}]", fmt::join(calls, ","));
}

} // namespace

void append_trace_text(const gcode::BlockCommands& block, std::string& text) {
    for (const gcode::CanonicalCommand& command : block.commands) {
        text += fmt::format_int(block.line).c_str();
        text += ": ";
        gcode::append_text(command, text);
        text += '\n';
    }
}

void append_trace_json(const gcode::BlockCommands& block, std::string& text) {
    for (size_t i = 0; i < block.commands.size(); ++i) {
        JsonLine json(text);
        json.add("block", int64_t(core::value_of(block.block)));
        if (!block.file.empty()) json.add("file", block.file);
        json.add("line", int64_t(block.line));
        json.add("column", int64_t(block.columns[i]));
        append_calls(block.calls, json, text);
        json.add("command", gcode::command_name(block.commands[i]));
        std::visit(Keys{json, text}, block.commands[i]);
        json.add("text", block.text);
        json.finish();
    }
}

namespace {

/// Whether a text needs no escaping in JSON.
bool is_plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(),
                       [](char c) { return c >= ' ' && c < 0x7F && c != '"' && c != '\\'; });
}

} // namespace

void JsonLine::begin(std::string_view key) {
    if (!is_first_) text_ += ',';
    is_first_ = false;
    text_ += '"';
    text_ += key;
    text_ += "\":";
}

void JsonLine::append(double value) {
    if (!std::isfinite(value)) {
        text_ += "null";
        return;
    }
    fmt::format_to(std::back_inserter(text_), "{}", value);
}

void JsonLine::add(std::string_view key, double value) {
    begin(key);
    append(value);
}

void JsonLine::add(std::string_view key, int64_t value) {
    begin(key);
    fmt::format_to(std::back_inserter(text_), "{}", value);
}

void JsonLine::add(std::string_view key, bool value) {
    begin(key);
    text_ += value ? "true" : "false";
}

void JsonLine::add(std::string_view key, std::string_view value) {
    begin(key);
    if (is_plain(value)) {
        text_ += '"';
        text_ += value;
        text_ += '"';
        return;
    }
    using Json = nlohmann::json;
    text_ += Json(std::string(value)).dump(-1, ' ', false, Json::error_handler_t::replace);
}

void JsonLine::add_null(std::string_view key) {
    begin(key);
    text_ += "null";
}

void JsonLine::add_numbers(std::string_view key, const double* values, size_t count) {
    begin(key);
    for (size_t i = 0; i < count; ++i) {
        text_ += i == 0 ? '[' : ',';
        append(values[i]);
    }
    text_ += ']';
}

void JsonLine::add_position(std::string_view key, const gcode::Position& position) {
    begin(key);
    for (size_t axis = 0; axis < gcode::axis_count; ++axis) {
        text_ += axis == 0 ? '[' : ',';
        if (position[axis])
            append(*position[axis]);
        else
            text_ += "null";
    }
    text_ += ']';
}

namespace {

constexpr uint64_t most_lines = 10;      // printed per message
constexpr size_t most_messages = 10'000; // distinct messages that are counted

} // namespace

std::string WarningLog::line_for(const gcode::Warning& warning, std::string_view file) {
    auto found = counts_.find(warning.message);
    if (found == counts_.end()) {
        if (counts_.size() == most_messages) {
            ++others_;
            return {};
        }
        found = counts_.emplace(warning.message, 0).first;
    }
    if (++found->second > most_lines) return {};
    const std::string cure = warning.cure.empty() ? "" : " (" + warning.cure + ")";
    return error_text(
               {core::ErrorCode::syntax, warning.where, warning.message + cure, std::string(file)})
           + "\n";
}

std::string WarningLog::rest() const {
    std::string text;
    for (const auto& [message, count] : counts_)
        if (count > most_lines)
            text += fmt::format("{} more times: {}\n", count - most_lines, message);
    if (others_ > 0) text += fmt::format("and {} other warnings\n", others_);
    return text;
}

} // namespace app
