#include "app/setup/setup_edits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/setup/tool_table.h"

namespace app {
namespace {

constexpr double largest_stock = 20000.0;           // mm; more is a slip of the finger
constexpr double largest_edited_allowance = 1000.0; // mm

bool is_place(const core::Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_size(double value) { return value > 0.0 && value <= largest_stock; }

void check_stock(const core::Solid& stock, std::vector<EditRefusal>& refused) {
    const std::string sizes =
        fmt::format("sizes must lie above 0 and up to {:g} mm", largest_stock);
    if (const auto* box = std::get_if<core::SolidBox>(&stock.shape)) {
        const core::Vec3 size = box->box.size();
        if (!is_place(box->box.min))
            refused.push_back({{}, "box", "the corner must be a place"});
        else if (!is_size(size.x) || !is_size(size.y) || !is_size(size.z))
            refused.push_back({{}, "box", sizes});
    } else if (const auto* round = std::get_if<core::SolidCylinder>(&stock.shape)) {
        if (!is_place(round->base))
            refused.push_back({{}, "cylinder", "the foot must be a place"});
        else if (!is_size(2.0 * round->radius) || !is_size(round->height))
            refused.push_back({{}, "cylinder", sizes});
    } else {
        refused.push_back({{}, "mesh", "a mesh is stated in a set-up file only"});
    }
}

/// The key that a message about a tool begins with, or names first.
std::string key_in(const std::string& why) {
    constexpr std::array keys = {"corner_radius", "point_deg",      "angle_deg", "tip_diameter",
                                 "neck_diameter", "neck_length",    "pitch",     "teeth",
                                 "thread_deg",    "shank_diameter", "stick_out", "gauge_length",
                                 "flute_length",  "holder",         "diameter"};
    std::string first;
    size_t at = std::string::npos;
    for (const char* key : keys)
        if (const size_t found = why.find(key); found < at) {
            at = found;
            first = key;
        }
    return first;
}

void check_tool(const core::ToolDescription& tool, std::vector<EditRefusal>& refused) {
    const auto assembled = core::assemble(tool);
    if (assembled) return;
    std::string why = assembled.error().message;
    const std::string opening = fmt::format("tool {}: ", core::value_of(tool.number));
    if (why.starts_with(opening)) why = why.substr(opening.size());
    refused.push_back({tool.number, key_in(why), why});
}

/// What a set-up said to be open of a tool is no longer true.
void renew_notes(SetupFile& file, const core::ToolDescription& tool) {
    const auto old = file.setup.tools.find(tool.number);
    if (old != file.setup.tools.end())
        for (const std::string& note : notes_on(old->second.description))
            std::erase(file.assumptions, note);
    for (std::string& note : notes_on(tool)) file.assumptions.push_back(std::move(note));
}

} // namespace

std::vector<EditRefusal> refusals_of(const SetupEdits& edits) {
    std::vector<EditRefusal> refused;
    if (edits.stock) check_stock(*edits.stock, refused);
    for (const auto& [number, stated] : edits.tools) check_tool(stated.tool, refused);
    if (edits.allowance
        && !(*edits.allowance >= 0.0 && *edits.allowance <= largest_edited_allowance))
        refused.push_back(
            {{},
             "allowance",
             fmt::format("an allowance lies between 0 and {:g} mm", largest_edited_allowance)});
    return refused;
}

core::Result<void> apply(const SetupEdits& edits, SetupFile& file) {
    if (const auto refused = refusals_of(edits); !refused.empty()) {
        const EditRefusal& first = refused.front();
        return core::fail(core::ErrorCode::invalid_value,
                          first.tool
                              ? fmt::format("tool {}: {}", core::value_of(*first.tool), first.why)
                              : fmt::format("{}: {}", first.key, first.why));
    }
    if (edits.stock) {
        const double tolerance = file.setup.stock.tolerance;
        file.setup.stock = *edits.stock;
        file.setup.stock.tolerance = tolerance;
        file.setup.earlier_cuts = nullptr;
        file.needs_stock = false;
    }
    for (const auto& [number, stated] : edits.tools) {
        core::ToolAssembly tool = *core::assemble(stated.tool);
        renew_notes(file, tool.description);
        file.assumptions.push_back(fmt::format(
            "tool {} is as stated: {}{}", core::value_of(number), fmt::join(stated.stated, ", "),
            stated.stated.empty() ? "all of it" : "; the rest of it as it was"));
        file.environment.tool_lengths[number] = tool.length;
        file.environment.tool_diameters[number] = tool.description.diameter;
        file.setup.tools.insert_or_assign(number, std::move(tool));
    }
    if (edits.stock) file.assumptions.emplace_back("the stock is as stated");
    if (edits.allowance) file.setup.allowance = edits.allowance;
    if (edits.tool_at_start && !file.setup.tool_at_start)
        file.setup.tool_at_start = edits.tool_at_start;
    return {};
}

} // namespace app
