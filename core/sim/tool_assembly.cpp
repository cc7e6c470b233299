#include "core/sim/tool_assembly.h"

#include <cmath>

#include <fmt/format.h>

#include "core/sim/tool_head.h"

namespace core {
namespace {

constexpr double same_length = 0.001; // mm; catalogues round

bool is_size(double value) { return std::isfinite(value) && value > 0.0; }

bool differ(double a, double b) { return std::abs(a - b) > same_length; }

/// Stacks cones upwards from `z`, which is left at their top.
Result<RevolvedProfile> stack(const ToolDescription& tool, const std::vector<ConeStep>& steps,
                              const char* key, double& z) {
    RevolvedProfile profile;
    for (const ConeStep& step : steps) {
        if (!is_size(step.length) || !is_size(std::max(step.lower_diameter, step.upper_diameter))
            || !(std::min(step.lower_diameter, step.upper_diameter) >= 0.0))
            return tool_error(tool, fmt::format("{} needs [lower diameter, upper diameter, "
                                                "length], all above 0",
                                                key));
        profile.elements.push_back(
            {z, 0.5 * step.lower_diameter, z + step.length, 0.5 * step.upper_diameter, 0.0});
        z += step.length;
    }
    return profile;
}

double height(const std::vector<ConeStep>& steps) {
    double sum = 0.0;
    for (const ConeStep& step : steps) sum += step.length;
    return sum;
}

/// The tip's distance from the holder's face, if anything says it besides the shank itself.
std::optional<double> stated_stick_out(const ToolDescription& tool) {
    if (tool.stick_out) return tool.stick_out;
    if (tool.gauge_length && !tool.holder.empty()) return *tool.gauge_length - height(tool.holder);
    return std::nullopt;
}

/// The cylinder between the head and the holder's face when no shank is described.
Result<std::vector<ConeStep>> filling_shank(const ToolDescription& tool, const ToolHead& head) {
    const auto stick_out = stated_stick_out(tool);
    if (!stick_out || !differ(*stick_out, head.length)) return std::vector<ConeStep>{};
    if (*stick_out < head.length)
        return tool_error(tool,
                          fmt::format("flutes and neck are {:g} mm long, but {} leaves {:g} "
                                      "mm below the holder",
                                      head.length, tool.stick_out ? "stick_out" : "gauge_length",
                                      *stick_out));
    double diameter = tool.diameter > 0.0 ? tool.diameter : head.top_diameter;
    if (tool.neck_diameter && !tool.neck_length) diameter = *tool.neck_diameter;
    if (tool.shank_diameter) diameter = *tool.shank_diameter;
    return std::vector<ConeStep>{{diameter, diameter, *stick_out - head.length}};
}

/// Compares what is said twice.
Result<void> check_lengths(const ToolDescription& tool, double to_holder, double to_gauge_line) {
    if (tool.stick_out && differ(*tool.stick_out, to_holder))
        return tool_error(tool, fmt::format("stick_out is {:g} mm, but flutes, neck and shank are "
                                            "{:g} mm long",
                                            *tool.stick_out, to_holder));
    if (!tool.gauge_length) return {};
    if (!tool.holder.empty() && differ(*tool.gauge_length, to_gauge_line))
        return tool_error(tool, fmt::format("gauge_length is {:g} mm, but flutes, shank and holder "
                                            "are {:g} mm long",
                                            *tool.gauge_length, to_gauge_line));
    if (*tool.gauge_length < to_gauge_line - same_length)
        return tool_error(tool, fmt::format("gauge_length is {:g} mm, but flutes and shank alone "
                                            "are {:g} mm long",
                                            *tool.gauge_length, to_gauge_line));
    return {};
}

/// Whether the tool is made to cut under an edge with the upper face of its head, or beside it.
bool cuts_undercuts(ToolShape shape) {
    return shape == ToolShape::tslot || shape == ToolShape::dovetail
           || shape == ToolShape::threadmill;
}

/// Lets the flutes reach a little into the slender part above them. A contact is told from a crash
/// by a head that is made smaller, and what shows that its upper face is free and comes down with
/// it is the narrower piece above.
void bare_upper_face(const ToolDescription& tool, const RevolvedProfile& above,
                     RevolvedProfile& flutes) {
    constexpr double stub = 0.2; // mm; more than twice of what a head is shrunk by
    const ProfileElement& top = flutes.elements.back();
    const double usual = tool.neck_diameter.value_or(0.5 * tool.diameter);
    const double r = above.empty() ? 0.5 * usual : above.elements.front().r0;
    const double z = bounds(top).max.z;
    if (r > 0.0 && r < top.r1) flutes.elements.push_back({z, r, z + stub, r, 0.0});
}

/// Lets the flutes reach past their end by less than any length of theirs is known. A cut exactly
/// as deep as they are long would leave a skin at the top of the outer model, thinner than rounding
/// or the error of an arc, that a shank then seems to meet.
void reach_past_end(RevolvedProfile& flutes) {
    constexpr double past = 0.005; // mm
    ProfileElement& last = flutes.elements.back();
    if (last.margin != 0.0 || last.r1 == 0.0) return;
    if (last.r0 == last.r1)
        last.z1 += past;
    else
        flutes.elements.push_back(ProfileElement{last.z1, last.r1, last.z1 + past, last.r1, 0.0});
}

} // namespace

const char* name_of(PartKind kind) {
    switch (kind) {
    case PartKind::flutes:
        return "flutes";
    case PartKind::shank:
        return "shank";
    case PartKind::holder:
        return "holder";
    case PartKind::nose:
        return "nose";
    default:
        return "machine";
    }
}

Result<ToolAssembly> assemble(const ToolDescription& description) {
    FEELER_TRY(ToolHead head, tool_head(description));
    ToolAssembly tool{.description = description, .parts = {}, .length = 0.0};
    if (description.shank.empty()) {
        FEELER_TRY(tool.description.shank, filling_shank(description, head));
    }
    double z = head.length;
    FEELER_TRY(RevolvedProfile steps, stack(description, tool.description.shank, "shank", z));
    const double to_holder = z;
    FEELER_TRY(RevolvedProfile holder, stack(description, description.holder, "holder", z));
    if (auto wrong = check_lengths(description, to_holder, z); !wrong)
        return tl::unexpected(wrong.error());
    RevolvedProfile shank = std::move(head.behind);
    shank.elements.insert(shank.elements.end(), steps.elements.begin(), steps.elements.end());
    if (cuts_undercuts(description.shape))
        bare_upper_face(description, shank.empty() ? holder : shank, head.flutes);
    else
        reach_past_end(head.flutes);
    tool.parts.push_back({PartKind::flutes, std::move(head.flutes)});
    if (!shank.empty()) tool.parts.push_back({PartKind::shank, std::move(shank)});
    if (!holder.empty()) tool.parts.push_back({PartKind::holder, std::move(holder)});
    tool.length = holder.empty() ? description.gauge_length.value_or(z) : z;
    if (description.touched_off) tool.length = *description.touched_off;
    if (tool.description.diameter == 0.0)
        tool.description.diameter = 2.0 * bounds(tool.parts[0].profile).max.x;
    return tool;
}

} // namespace core
