#include "core/sim/tool_assembly.h"

#include <numbers>

#include <fmt/format.h>

namespace core {
namespace {

tl::unexpected<Error> refuse(const ToolDescription& tool, const std::string& why) {
    return fail(ErrorCode::invalid_value, fmt::format("tool {}: {}", value_of(tool.number), why));
}

bool is_size(double value) { return std::isfinite(value) && value > 0.0; }

/// The upright side of the flutes, from `z0` to their end.
ProfileElement side(const ToolDescription& tool, double z0) {
    return {z0, 0.5 * tool.diameter, tool.flute_length, 0.5 * tool.diameter, 0.0};
}

/// A point or flank from radius `tip` at z = 0 out to the full radius, then the upright side.
Result<RevolvedProfile> coned(const ToolDescription& tool, double tip, double from_axis_deg) {
    if (!(from_axis_deg > 0.0 && from_axis_deg < 90.0))
        return refuse(tool, "the flank's angle must lie between 0 and 90 degrees");
    const double r = 0.5 * tool.diameter;
    if (!(tip >= 0.0 && tip < r)) return refuse(tool, "tip_diameter must be below diameter");
    const double steep = std::tan(from_axis_deg * std::numbers::pi / 180.0);
    const double height = (r - tip) / steep;
    // A flank longer than the flutes ends with them, before it reaches the full diameter.
    if (height >= tool.flute_length)
        return RevolvedProfile{
            {{0.0, tip, tool.flute_length, tip + tool.flute_length * steep, 0.0}}};
    return RevolvedProfile{{{0.0, tip, height, r, 0.0}, side(tool, height)}};
}

/// How far a rounding made of cones stands off the round, mm.
constexpr double rounding_sag = 0.0025;

/// A rounded edge: a ball of radius `corner` about a circle of radius `disc`, up to the end of the
/// flutes. Where they end below the ball's upper half, the lower one is made of cones.
RevolvedProfile rounded(const ToolDescription& tool, double disc, double corner) {
    RevolvedProfile profile;
    if (tool.flute_length >= 2.0 * corner) {
        profile.elements.push_back({corner, disc, corner, disc, corner});
    } else {
        const double step = 2.0 * std::acos(std::max(0.0, 1.0 - rounding_sag / corner));
        const int cones = std::max(4, static_cast<int>(std::ceil(0.5 * std::numbers::pi / step)));
        double z = 0.0, r = disc;
        for (int i = 1; i <= cones; ++i) {
            const double angle = 0.5 * std::numbers::pi * i / cones;
            const double above = i == cones ? corner : corner * (1.0 - std::cos(angle));
            const double out = i == cones ? disc + corner : disc + corner * std::sin(angle);
            profile.elements.push_back({z, r, above, out, 0.0});
            z = above, r = out;
        }
    }
    if (tool.flute_length > corner) profile.elements.push_back(side(tool, corner));
    return profile;
}

Result<RevolvedProfile> ball(const ToolDescription& tool) {
    const double r = 0.5 * tool.diameter;
    if (tool.flute_length < r)
        return refuse(tool, "flute_length is shorter than the ball's radius");
    return rounded(tool, 0.0, r);
}

Result<RevolvedProfile> bull(const ToolDescription& tool) {
    if (!tool.corner_radius) return refuse(tool, "shape \"bull\" needs corner_radius");
    const double corner = *tool.corner_radius;
    const double disc = 0.5 * tool.diameter - corner;
    if (corner == 0.0) return RevolvedProfile{{side(tool, 0.0)}};
    if (!is_size(corner) || disc < 0.0)
        return refuse(tool, "corner_radius must lie between 0 and half the diameter");
    if (tool.flute_length <= corner)
        return refuse(tool, "flute_length is shorter than corner_radius");
    return rounded(tool, disc, corner);
}

Result<RevolvedProfile> outlined(const ToolDescription& tool) {
    if (tool.outline.size() < 2) return refuse(tool, "profile needs at least two [r, z] points");
    RevolvedProfile profile;
    for (size_t i = 0; i < tool.outline.size(); ++i) {
        const auto [r, z] = tool.outline[i];
        if (!std::isfinite(r) || !std::isfinite(z) || r < 0.0)
            return refuse(tool, "profile points need a finite z and an r that is not negative");
        if (i == 0) {
            if (z != 0.0) return refuse(tool, "profile must begin at the tip, z = 0");
            continue;
        }
        const auto [r_below, z_below] = tool.outline[i - 1];
        if (z < z_below) return refuse(tool, "profile must go from the tip up");
        if (z > z_below && (r > 0.0 || r_below > 0.0))
            profile.elements.push_back({z_below, r_below, z, r, 0.0});
    }
    if (profile.empty()) return refuse(tool, "profile encloses nothing");
    return profile;
}

Result<RevolvedProfile> flutes(const ToolDescription& tool) {
    if (tool.shape == ToolShape::profile) return outlined(tool);
    if (!is_size(tool.diameter)) return refuse(tool, "diameter must be above 0");
    if (!is_size(tool.flute_length)) return refuse(tool, "flute_length must be above 0");
    switch (tool.shape) {
    case ToolShape::ball:
        return ball(tool);
    case ToolShape::bull:
        return bull(tool);
    case ToolShape::drill:
        return coned(tool, 0.0, 0.5 * tool.point_deg.value_or(118.0));
    case ToolShape::taper:
    case ToolShape::chamfer:
        if (!tool.angle_deg) return refuse(tool, "taper and chamfer tools need angle_deg");
        return coned(tool, 0.5 * tool.tip_diameter, *tool.angle_deg);
    default:
        return RevolvedProfile{{side(tool, 0.0)}};
    }
}

/// Stacks cones upwards from `z`, which is left at their top.
Result<RevolvedProfile> stack(const ToolDescription& tool, const std::vector<ConeStep>& steps,
                              const char* key, double& z) {
    RevolvedProfile profile;
    for (const ConeStep& step : steps) {
        if (!is_size(step.length) || !is_size(std::max(step.lower_diameter, step.upper_diameter))
            || !(std::min(step.lower_diameter, step.upper_diameter) >= 0.0))
            return refuse(tool, fmt::format("{} needs [lower diameter, upper diameter, length], "
                                            "all above 0",
                                            key));
        profile.elements.push_back(
            {z, 0.5 * step.lower_diameter, z + step.length, 0.5 * step.upper_diameter, 0.0});
        z += step.length;
    }
    return profile;
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
    ToolAssembly tool{.description = description, .parts = {}, .length = 0.0};
    FEELER_TRY(RevolvedProfile cutting, flutes(description));
    double z = bounds(cutting).max.z;
    tool.parts.push_back({PartKind::flutes, std::move(cutting)});
    FEELER_TRY(RevolvedProfile shank, stack(description, description.shank, "shank", z));
    FEELER_TRY(RevolvedProfile holder, stack(description, description.holder, "holder", z));
    if (!shank.empty()) tool.parts.push_back({PartKind::shank, std::move(shank)});
    if (!holder.empty()) tool.parts.push_back({PartKind::holder, std::move(holder)});
    tool.length = z;
    return tool;
}

} // namespace core
