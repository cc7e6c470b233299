#include "app/setup/setup_tables.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/utf8_text.h"

namespace app {
namespace {

std::string key(const char* name, double value) {
    return fmt::format("{} = {}\n", name, toml_number(value));
}

std::string key(const char* name, const std::optional<double>& value) {
    return value ? key(name, *value) : std::string();
}

std::string cones(const char* name, const std::vector<core::ConeStep>& steps) {
    std::vector<std::string> rows;
    for (const core::ConeStep& s : steps)
        rows.push_back(fmt::format("[{}, {}, {}]", toml_number(s.lower_diameter),
                                   toml_number(s.upper_diameter), toml_number(s.length)));
    return rows.empty() ? "" : fmt::format("{} = [{}]\n", name, fmt::join(rows, ", "));
}

std::string outline(const core::ToolDescription& tool) {
    std::vector<std::string> rows;
    for (const auto& [r, z] : tool.outline)
        rows.push_back(fmt::format("[{}, {}]", toml_number(r), toml_number(z)));
    return rows.empty() ? "" : fmt::format("profile = [{}]\n", fmt::join(rows, ", "));
}

std::string lengths(const core::ToolDescription& tool) {
    std::string text = cones("shank", tool.shank) + key("shank_diameter", tool.shank_diameter)
                       + key("stick_out", tool.stick_out) + cones("holder", tool.holder)
                       + key("gauge_length", tool.gauge_length);
    if (tool.touched_off)
        text += fmt::format("touched_off = {}     # the control counts this as its length, and the "
                            "work offset fits; take it out to have the true length count\n",
                            toml_number(*tool.touched_off));
    return text;
}

} // namespace

std::string toml_number(double value) { return fmt::format("{}", value); }

std::string toml_text(std::string_view text) {
    std::string safe;
    for (const char c : utf8_text(text)) {
        const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
        if (c == '"' || c == '\\') safe += '\\';
        if (is_control)
            safe += fmt::format("\\u{:04x}", c);
        else
            safe += c;
    }
    return "\"" + safe + "\"";
}

std::string tool_table(const core::ToolDescription& tool) {
    std::string text = "\n[[tool]]\n";
    text += fmt::format("number = {}\n", core::value_of(tool.number));
    if (!tool.name.empty()) text += fmt::format("name = {}\n", toml_text(tool.name));
    text += fmt::format("shape = \"{}\"\n", core::name_of(tool.shape));
    text += key("diameter", tool.diameter);
    if (tool.flute_length > 0.0) text += key("flute_length", tool.flute_length);
    text += key("corner_radius", tool.corner_radius) + key("point_deg", tool.point_deg)
            + key("angle_deg", tool.angle_deg);
    if (tool.tip_diameter > 0.0) text += key("tip_diameter", tool.tip_diameter);
    text += outline(tool) + key("neck_diameter", tool.neck_diameter)
            + key("neck_length", tool.neck_length) + key("pitch", tool.pitch)
            + key("thread_deg", tool.thread_deg);
    if (tool.teeth) text += fmt::format("teeth = {}\n", *tool.teeth);
    text += lengths(tool);
    if (tool.cuts == core::SpindleDirection::counterclockwise)
        text += "spindle = \"counterclockwise\"\n";
    if (!tool.cuts_at_centre)
        text += "cuts_at_centre = false\n" + key("centre_diameter", 2.0 * tool.centre_radius);
    return text;
}

std::string stock_table(const core::Solid& stock, std::string_view frame) {
    const auto triple = [](const core::Vec3& v) {
        return fmt::format("[{}, {}, {}]", toml_number(v.x), toml_number(v.y), toml_number(v.z));
    };
    std::string text = "\n[stock]";
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        text += fmt::format("     # two corners\nbox = [{}, {}]\n", triple(box->box.min),
                            triple(box->box.max));
    } else if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        text += fmt::format("     # stands on `at`\ncylinder = {{ radius = {}, height = {}, axis = "
                            "\"{}\" }}\nat = {}\n",
                            toml_number(round->radius), toml_number(round->height),
                            "XYZ"[round->axis], triple(round->base));
    } else {
        return {};
    }
    text += fmt::format("frame = {}\n", toml_text(frame));
    if (stock.tolerance > 0.0) text += key("tolerance", stock.tolerance);
    return text;
}

} // namespace app
