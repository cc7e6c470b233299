#include "app/setup/tools/found_tool.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/math.h"
#include "core/base/units.h"

namespace app {
namespace {

using core::ToolDescription;
using core::ToolShape;

/// Usual sizes of tools, in multiples of the diameter and in mm.
constexpr double flutes_of_mill = 3.0, flutes_of_drill = 8.0, shank_beyond_flutes = 3.0;
constexpr double longest_flutes_of_mill = 60.0, longest_flutes_of_drill = 250.0;
constexpr double shortest_shank = 20.0, longest_shank = 60.0;

/// Names of shapes in the sources of tools.
namespace shape_names {

using enum core::ToolShape;

// The first match counts: "BALL END MILL" is not a flat end mill.
constexpr ShapeName of_comments[] = {{"LOLLIPOP", lollipop},
                                     {"DOVETAIL", dovetail},
                                     {"DOVE MILL", dovetail},
                                     {"T-SLOT", tslot},
                                     {"TSLOT", tslot},
                                     {"T SLOT", tslot},
                                     {"SLOT MILL", tslot},
                                     {"SLITTING", tslot},
                                     {"WOODRUFF", tslot},
                                     {"KEY CUTTER", tslot},
                                     {"THREAD", threadmill},
                                     {"THRD", threadmill},
                                     {"TAPERED", taper},
                                     {"TAPER MILL", taper},
                                     {"TAPER END", taper},
                                     {"TPR MILL", taper},
                                     {"BULL", bull},
                                     {"TORUS", bull},
                                     {"TOROID", bull},
                                     {"BALL", ball},
                                     {"SPHER", ball},
                                     {"KUGEL", ball},
                                     {"V-BIT", chamfer},
                                     {"VBIT", chamfer},
                                     {"V BIT", chamfer},
                                     {"VEE", chamfer},
                                     {"V-CARV", chamfer},
                                     {"V-CUT", chamfer},
                                     {"V-GROOVE", chamfer},
                                     {"ENGRAV", chamfer},
                                     {"CHAM", chamfer},
                                     {"COUNTERSINK", chamfer},
                                     {"COUNTER SINK", chamfer},
                                     {"CSINK", chamfer},
                                     {"SLOT DRILL", flat},
                                     {"DRILL", drill},
                                     {"DRL", drill},
                                     {"BOHRER", drill},
                                     {"END MILL", flat},
                                     {"ENDMILL", flat},
                                     {"END-MILL", flat},
                                     {"FACE MILL", flat},
                                     {"FACEMILL", flat},
                                     {"SHELL MILL", flat},
                                     {"FLAT", flat},
                                     {"CYLIND", flat},
                                     {"ROUTER", flat},
                                     {"UPCUT", flat},
                                     {"DOWNCUT", flat},
                                     {"COMPRESSION", flat},
                                     {"REAM", flat},
                                     {"BORING", flat},
                                     {"BORE", flat},
                                     {"CUTTER", flat},
                                     {"FREZ", flat},
                                     {"FRAES", flat},
                                     {"FRESA", flat},
                                     {"FL ", flat},
                                     {"FLUTE", flat},
                                     {"EM ", flat},
                                     {" TAP", flat},
                                     {"MILL", flat}};

constexpr ShapeName of_freecad[] = {{"endmill", flat},
                                    {"ballend", ball},
                                    {"ballnose", ball},
                                    {"bullnose", bull},
                                    {"torus", bull},
                                    {"chamfer", chamfer},
                                    {"vbit", chamfer},
                                    {"drill", drill},
                                    {"dovetail", dovetail},
                                    {"slittingsaw", tslot},
                                    {"threadmill", threadmill},
                                    {"reamer", flat},
                                    {"tap", flat},
                                    {"taperedballnose", taper}};

constexpr ShapeName of_fusion[] = {
    {"flat end mill", flat},     {"ball end mill", ball},   {"bull nose end mill", bull},
    {"face mill", flat},         {"tapered mill", taper},   {"chamfer mill", chamfer},
    {"lollipop mill", lollipop}, {"slot mill", tslot},      {"dovetail mill", dovetail},
    {"thread mill", threadmill}, {"drill", drill},          {"spot drill", drill},
    {"center drill", drill},     {"counter sink", chamfer}, {"reamer", flat},
    {"boring bar", flat},        {"counter bore", flat},    {"tap right hand", flat},
    {"tap left hand", flat},     {"radius mill", flat}};

} // namespace shape_names

double cone_height(const ToolDescription& tool, double angle_deg) {
    return 0.5 * (tool.diameter - tool.tip_diameter) / core::tan(core::radians_of(angle_deg));
}

/// Completes the sizes that belong to the shape; drops impossible combinations.
void complete_shape(ToolDescription& tool, std::vector<std::string>& assumed) {
    const auto assume_angle = [&](std::optional<double>& angle, double usual, const char* name) {
        if (angle && *angle > 0.0 && *angle < (angle == tool.point_deg ? 180.0 : 90.0)) return;
        angle = usual;
        assumed.push_back(fmt::format("{} {:g} degrees", name, usual));
    };
    if (tool.shape == ToolShape::drill && tool.point_deg.value_or(118.0) != 180.0)
        assume_angle(tool.point_deg, 118.0, "point");
    if (tool.shape == ToolShape::chamfer || tool.shape == ToolShape::dovetail)
        assume_angle(tool.angle_deg, 45.0, "flank");
    if (tool.shape == ToolShape::taper) assume_angle(tool.angle_deg, 5.0, "flank");
    if (tool.shape == ToolShape::bull && !tool.corner_radius) {
        tool.corner_radius = 0.1 * tool.diameter;
        assumed.push_back(fmt::format("corner radius {:g} mm", *tool.corner_radius));
    }
    if (tool.shape == ToolShape::lollipop && !tool.neck_diameter) {
        tool.neck_diameter = 0.6 * tool.diameter;
        assumed.push_back(fmt::format("neck {:g} mm", *tool.neck_diameter));
    }
}

double usual_flutes(const ToolDescription& tool) {
    const double d = tool.diameter;
    switch (tool.shape) {
    case ToolShape::drill:
        return std::max(std::min(flutes_of_drill * d, longest_flutes_of_drill), d);
    case ToolShape::chamfer:
        return cone_height(tool, *tool.angle_deg) + 0.5 * d;
    case ToolShape::tslot:
        return 0.25 * d;
    case ToolShape::dovetail: // at most to half the radius, so that a neck remains
        return 0.25 * d / core::tan(core::radians_of(*tool.angle_deg));
    case ToolShape::taper:
        return std::max(std::min(flutes_of_mill * d, longest_flutes_of_mill),
                        cone_height(tool, *tool.angle_deg));
    case ToolShape::ball:
    case ToolShape::bull: // at least as high as the corner radius
        return std::max(std::min(flutes_of_mill * d, longest_flutes_of_mill), d);
    default:
        return std::min(flutes_of_mill * d, longest_flutes_of_mill);
    }
}

void complete_lengths(ToolDescription& tool, double least_flutes,
                      std::vector<std::string>& assumed) {
    if (tool.flute_length <= 0.0 && tool.shape != ToolShape::lollipop) {
        tool.flute_length = usual_flutes(tool);
        const bool undercuts = tool.shape == ToolShape::tslot || tool.shape == ToolShape::dovetail;
        if (!undercuts) tool.flute_length = std::max(tool.flute_length, least_flutes);
        if (tool.stick_out)
            tool.flute_length =
                std::min(tool.flute_length, *tool.stick_out - tool.neck_length.value_or(0.0));
        const double room = tool.gauge_length.value_or(0.0) - core::total_length(tool.holder);
        if (!tool.stick_out && !tool.holder.empty() && room > tool.neck_length.value_or(0.0))
            tool.flute_length = std::min(tool.flute_length, room - tool.neck_length.value_or(0.0));
        assumed.push_back(fmt::format("flutes {:.4g} mm", tool.flute_length));
    }
    if (!tool.shank_diameter) {
        const bool slender = tool.shape == ToolShape::tslot || tool.shape == ToolShape::dovetail;
        tool.shank_diameter =
            tool.neck_diameter.value_or(slender ? 0.4 * tool.diameter : tool.diameter);
        assumed.push_back(fmt::format("shank {:.4g} mm", *tool.shank_diameter));
    }
    const bool known =
        tool.stick_out || !tool.shank.empty() || (tool.gauge_length && !tool.holder.empty());
    if (known || tool.shape == ToolShape::profile) return;
    const double head =
        std::max(tool.flute_length, tool.shape == ToolShape::lollipop ? tool.diameter : 0.0)
        + tool.neck_length.value_or(0.0);
    tool.stick_out =
        head + std::clamp(shank_beyond_flutes * tool.diameter, shortest_shank, longest_shank);
    if (tool.gauge_length && *tool.gauge_length < *tool.stick_out)
        tool.stick_out = std::max(head, *tool.gauge_length);
    if (tool.gauge_length && *tool.gauge_length < head) tool.gauge_length.reset();
    assumed.push_back(
        fmt::format("{:.4g} mm from the tip to the end of its shank", *tool.stick_out));
}

} // namespace

std::span<const ShapeName> shape_words() { return shape_names::of_comments; }
std::span<const ShapeName> freecad_shapes() { return shape_names::of_freecad; }
std::span<const ShapeName> fusion_shapes() { return shape_names::of_fusion; }

std::optional<core::ToolShape> shape_in(std::span<const ShapeName> names, std::string_view name) {
    const auto found = std::find_if(names.begin(), names.end(),
                                    [&](const ShapeName& row) { return row.name == name; });
    return found == names.end() ? std::nullopt : std::optional(found->shape);
}

std::set<std::string> known_keys(const FoundTool& found) {
    const ToolDescription& tool = found.tool;
    std::set<std::string> keys;
    const auto add = [&](const char* key, bool is_known) {
        if (is_known) keys.insert(key);
    };
    if (!found.is_described) return keys;
    for (const core::ToolSize& size : core::tool_sizes()) add(size.key, size.of(tool).has_value());
    if (!found.has_diameter) keys.erase("diameter");
    add("shape", found.has_shape);
    add("name", !tool.name.empty());
    add("profile", !tool.outline.empty());
    add("shank", !tool.shank.empty());
    add("holder", !tool.holder.empty());
    add("teeth", tool.teeth.has_value());
    add("spindle", tool.cuts == core::SpindleDirection::counterclockwise);
    return keys;
}

CompleteTool complete(const FoundTool& found, double least_flutes) {
    CompleteTool whole{found.tool, {}};
    std::vector<std::string> assumed = found.assumed;
    if (!found.has_shape) assumed.emplace_back("its shape");
    if (!found.has_diameter) assumed.emplace_back("its diameter");
    complete_shape(whole.tool, assumed);
    complete_lengths(whole.tool, least_flutes, assumed);
    if (whole.tool.holder.empty()) assumed.emplace_back("no holder");
    whole.assumed =
        fmt::format("tool {} is {} of {:.4g} mm, according to {}; {} {} assumed",
                    core::value_of(whole.tool.number), core::description_of(found.tool.shape),
                    whole.tool.diameter, found.source, fmt::join(assumed, ", "),
                    assumed.size() == 1 ? "is" : "are");
    if (assumed.empty()) whole.assumed = whole.assumed.substr(0, whole.assumed.find(';'));
    return whole;
}

} // namespace app
