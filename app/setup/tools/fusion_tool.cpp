#include "app/setup/tools/fusion_tool.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "app/base/text.h"
#include "app/setup/tools/tool_text.h"
#include "core/base/math.h"
#include "core/base/units.h"

namespace app {
namespace {

using core::ConeStep;
using core::ToolDescription;
using core::ToolShape;

constexpr double same_size = 0.001; // mm

std::optional<ToolShape> shape_of_type(const std::string& type) {
    if (const auto shape = shape_in(fusion_shapes(), type)) return shape;
    return shape_of_words(plain_capitals(type));
}

double tangent(double degrees) { return core::tan(core::radians_of(degrees)); }

bool is_flank(const std::optional<double>& degrees) {
    return degrees && *degrees > 0.0 && *degrees < 90.0;
}

// --- outlines of form tools
// -----------------------------------------------------------------------

/// A cutter that rounds outer corners: its flank is a quarter of a circle, hollow.
void outline_radius_mill(const FusionTool& tool, ToolDescription& made) {
    if (!tool.corner_radius || !tool.diameter) return;
    constexpr int pieces = 24; // which lie less than 0.0006 of the radius outside the circle
    const double corner = *tool.corner_radius, outer = 0.5 * *tool.diameter + corner;
    made.shape = ToolShape::profile;
    for (int i = 0; i <= pieces; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / pieces;
        made.outline.push_back({outer - corner * core::cos(angle), corner * core::sin(angle)});
    }
    made.outline.front()[1] = 0.0;
    made.diameter = 2.0 * outer;
    const double top = tool.flute_length.value_or(corner);
    if (top > corner + same_size) made.outline.push_back({outer, top});
}

/// A pilot with a point, and above it a countersink.
void outline_centre_drill(const FusionTool& tool, ToolDescription& made) {
    if (!tool.tip_diameter || !tool.tip_length || !tool.flank_deg || !tool.diameter) return;
    const double point = 0.5 * tool.point_deg.value_or(118.0), flank = 0.5 * *tool.flank_deg;
    const double pilot = 0.5 * *tool.tip_diameter, r = 0.5 * *tool.diameter;
    if (!is_flank(point) || !is_flank(flank) || pilot >= r) return;
    const double tip = std::min(pilot / tangent(point), *tool.tip_length);
    const double shoulder = *tool.tip_length + (r - pilot) / tangent(flank);
    made.shape = ToolShape::profile;
    made.outline = {{0.0, 0.0}, {pilot, tip}, {pilot, *tool.tip_length}, {r, shoulder}};
    if (tool.flute_length.value_or(0.0) > shoulder + same_size)
        made.outline.push_back({r, *tool.flute_length});
}

/// A face mill whose inserts lean outwards.
void outline_face_mill(const FusionTool& tool, ToolDescription& made) {
    const bool leans = tool.diameter && tool.largest_diameter && tool.flute_length
                       && *tool.largest_diameter > *tool.diameter + same_size;
    if (!leans) return;
    made.shape = ToolShape::profile;
    made.diameter = *tool.largest_diameter;
    made.outline = {{0.5 * *tool.diameter, 0.0}, {0.5 * made.diameter, *tool.flute_length}};
}

// --- shapes -------------------------------------------------------------------------------------

/// DC is measured at the tip.
void shape_taper(const FusionTool& tool, ToolDescription& made) {
    made.tip_diameter = made.diameter;
    made.corner_radius = tool.corner_radius;
    made.angle_deg = tool.flank_deg;
    const double at_flutes =
        is_flank(tool.flank_deg) && tool.flute_length
            ? made.tip_diameter + 2.0 * *tool.flute_length * tangent(*tool.flank_deg)
            : std::max(tool.shank_diameter.value_or(0.0), 1.5 * made.tip_diameter);
    made.diameter = std::max(at_flutes, made.tip_diameter + same_size);
}

void shape_chamfer(const FusionTool& tool, ToolDescription& made) {
    made.angle_deg = tool.flank_deg;
    if (!tool.flank_deg && tool.point_deg) made.angle_deg = 0.5 * *tool.point_deg;
    made.tip_diameter = tool.tip_diameter.value_or(0.0);
}

void shape_rounded(const FusionTool& tool, ToolDescription& made) {
    const auto corner = tool.corner_radius;
    if (made.shape == ToolShape::flat && corner && 2.0 * *corner < made.diameter)
        made.shape = ToolShape::bull;
    if (made.shape == ToolShape::bull || made.shape == ToolShape::tslot)
        made.corner_radius = corner;
}

/// The part of undercutting tools above their head, which they cannot do without.
void add_undercut_neck(const FusionTool& tool, ToolDescription& made) {
    const bool has_neck = core::cuts_undercuts(made.shape) || made.shape == ToolShape::lollipop;
    if (has_neck && tool.shoulder_diameter && *tool.shoulder_diameter < made.diameter)
        made.neck_diameter = tool.shoulder_diameter;
}

void read_fusion_shape(const FusionTool& tool, ToolDescription& made) {
    if (tool.type == "radius mill") outline_radius_mill(tool, made);
    if (tool.type == "center drill") outline_centre_drill(tool, made);
    if (tool.type == "face mill") outline_face_mill(tool, made);
    if (made.shape == ToolShape::profile) return;
    shape_rounded(tool, made);
    if (has_size(made.shape, &ToolDescription::point_deg)) made.point_deg = tool.point_deg;
    if (made.shape == ToolShape::chamfer) shape_chamfer(tool, made);
    if (made.shape == ToolShape::dovetail) made.angle_deg = tool.flank_deg;
    if (made.shape == ToolShape::taper) shape_taper(tool, made);
    if (made.shape == ToolShape::threadmill && tool.pitch
        && *tool.pitch <= tool.flute_length.value_or(0.0))
        made.pitch = tool.pitch;
    add_undercut_neck(tool, made);
}

// --- lengths ------------------------------------------------------------------------------------

/// Makes flutes at least as long as the ball or the rounding at the tip is high.
void keep_head_whole(ToolDescription& made) {
    if (made.shape == ToolShape::ball || made.shape == ToolShape::lollipop)
        made.flute_length = std::max(made.flute_length, 0.5 * made.diameter);
    if (made.shape == ToolShape::bull)
        made.flute_length =
            std::max(made.flute_length, made.corner_radius.value_or(0.0) + same_size);
}

/// The length of the flutes; a ball or a rounding is never higher.
void read_flutes(const FusionTool& tool, ToolDescription& made) {
    if (made.shape == ToolShape::profile) {
        made.flute_length = made.outline.back()[1];
        return;
    }
    made.flute_length = tool.flute_length.value_or(0.0);
    if (made.flute_length > 0.0) keep_head_whole(made);
}

/// The steps up to a total length; the last one is cut where it goes beyond.
std::vector<ConeStep> cut_at(std::vector<ConeStep> steps, double length) {
    double below = 0.0;
    for (size_t i = 0; i < steps.size(); ++i) {
        ConeStep& step = steps[i];
        const double room = length - below;
        if (step.length >= room - same_size) {
            const double part = std::min(1.0, room / step.length);
            step.upper_diameter =
                step.lower_diameter + part * (step.upper_diameter - step.lower_diameter);
            step.length = room;
            steps.resize(room > same_size ? i + 1 : i);
            return steps;
        }
        below += step.length;
    }
    return steps;
}

/// What lies between the flutes and the holder: shoulder, shaft and shank.
void read_shank(const FusionTool& tool, ToolDescription& made) {
    made.shank_diameter = tool.shank_diameter;
    made.stick_out = tool.body_length;
    if (!tool.body_length || made.flute_length <= 0.0) return;
    if (made.shape == ToolShape::lollipop) return; // its head is longer than its flutes
    double room = *tool.body_length - made.flute_length;
    if (room < -same_size && made.shape != ToolShape::profile) {
        // The flutes end where the holder begins; the head alone may be longer.
        made.flute_length = tool.body_length.value_or(0.0);
        keep_head_whole(made);
        room = *tool.body_length - made.flute_length;
    }
    if (room < -same_size) made.stick_out = made.flute_length;
    if (room <= same_size) return;
    const double shoulder = tool.shoulder_length.value_or(0.0) - made.flute_length;
    std::vector<ConeStep> steps;
    const double slender = tool.shoulder_diameter.value_or(tool.diameter.value_or(made.diameter));
    if (shoulder > same_size) steps.push_back({slender, slender, shoulder});
    steps.insert(steps.end(), tool.shaft.begin(), tool.shaft.end());
    if (steps.empty()) return; // the shank begins above the flutes
    const double last = tool.shank_diameter.value_or(steps.back().upper_diameter);
    steps.push_back({last, last, *tool.body_length});
    made.shank = cut_at(std::move(steps), room);
}

/// The holder up to the gauge line.
void read_fusion_holder(const FusionTool& tool, FoundTool& found) {
    if (tool.is_damaged_above) {
        found.assumed.emplace_back("no holder (the library has sizes of it that are no numbers)");
        return;
    }
    std::vector<ConeStep> steps = tool.holder;
    if (steps.empty()) return;
    const double missing = tool.holder_length.value_or(0.0) - core::total_length(steps);
    if (tool.holder_length && missing > same_size) {
        const double top = steps.back().upper_diameter;
        steps.push_back({top, top, missing});
        found.assumed.push_back(fmt::format("the upper {:.4g} mm of its holder", missing));
    }
    found.tool.holder = cut_at(std::move(steps), tool.holder_length.value_or(core::infinity));
}

bool is_same(const std::vector<ConeStep>& a, const std::vector<ConeStep>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const ConeStep& x, const ConeStep& y) {
                          return x.lower_diameter == y.lower_diameter
                                 && x.upper_diameter == y.upper_diameter && x.length == y.length;
                      });
}

/// Whether two entries describe the same tool.
bool is_same(const ToolDescription& a, const ToolDescription& b) {
    const auto sizes = core::tool_sizes();
    return a.shape == b.shape && a.outline == b.outline && a.cuts == b.cuts
           && is_same(a.shank, b.shank) && is_same(a.holder, b.holder)
           && std::all_of(sizes.begin(), sizes.end(),
                          [&](const core::ToolSize& size) { return size.of(a) == size.of(b); });
}

} // namespace

bool is_no_rotating_cutter(const std::string& type) {
    constexpr std::array others = {"holder",        "probe",      "waterjet",    "laser cutter",
                                   "plasma cutter", "deposition", "marking tool"};
    return type.starts_with("turning")
           || std::find(others.begin(), others.end(), type) != others.end();
}

FoundTool found_tool_of(const FusionTool& tool, const std::string& source) {
    FoundTool found;
    found.source = source;
    ToolDescription& made = found.tool;
    made.number = core::ToolNumber{tool.number};
    made.name = tool.name;
    made.diameter = tool.diameter.value_or(0.0);
    const auto shape = shape_of_type(tool.type);
    found.has_shape = shape.has_value();
    made.shape = shape.value_or(ToolShape::flat);
    if (tool.is_left_hand) made.cuts = core::SpindleDirection::counterclockwise;
    read_fusion_shape(tool, made);
    read_flutes(tool, made);
    read_shank(tool, made);
    read_fusion_holder(tool, found);
    return found;
}

void NumberedTools::add(const FusionTool& tool) {
    if (tool.number <= 0 || tool.diameter.value_or(0.0) <= 0.0) return;
    FoundTool found = found_tool_of(tool, source_);
    const core::ToolNumber number = found.tool.number;
    const auto [entry, is_new] = entries_.try_emplace(number, Entry{found});
    if (!is_new && !is_same(entry->second.tool.tool, found.tool)) ++entry->second.others;
}

core::Result<std::map<core::ToolNumber, FoundTool>> NumberedTools::result() const {
    if (entries_.empty())
        return tl::unexpected(core::Error{
            core::ErrorCode::syntax, {}, "contains no milling tool with a number", source_});
    std::map<core::ToolNumber, FoundTool> tools;
    for (const auto& [number, entry] : entries_) {
        FoundTool tool = entry.tool;
        if (entry.others > 0)
            tool.assumed.insert(
                tool.assumed.begin(),
                fmt::format("the first of {} different tools with this number", entry.others + 1));
        tools.emplace(number, std::move(tool));
    }
    return tools;
}

} // namespace app
