#include "core/sim/tool_assembly.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/sim/tool_description.h"

namespace core {
namespace {

constexpr double right_angle = 0.5 * std::numbers::pi;

/// The rounded edge of a tool: a torus of a ball of radius `corner` around a circle of radius
/// `disc`.
struct Rounding {
    double disc = 0.0;
    double corner = 0.0;

    /// Point of the edge at an angle from straight down, as z and r.
    ProfileElement at(double angle) const {
        const double r = disc + corner * core::sin(angle), z = corner * (1.0 - core::cos(angle));
        return {z, r, z, r, 0.0};
    }
    ProfileElement whole() const { return {corner, disc, corner, disc, corner}; }
};

/// Approximates the rounding between two angles by cones, none of them outside it.
void add_cones(RevolvedProfile& profile, const Rounding& round, double from, double to) {
    const double step = 2.0 * core::acos(std::max(0.0, 1.0 - rounding_sag / round.corner));
    const int cones = std::max(4, static_cast<int>(std::ceil((to - from) / step)));
    profile.form_error = rounding_sag;
    ProfileElement below = round.at(from);
    for (int i = 1; i <= cones; ++i) {
        const bool upright = i == cones && to == right_angle;
        const ProfileElement above =
            upright ? ProfileElement{round.corner, round.disc + round.corner, 0.0, 0.0, 0.0}
                    : round.at(from + (to - from) * i / cones);
        profile.elements.push_back({below.z0, below.r0, above.z0, above.r0, 0.0});
        below = above;
    }
}

/// Adds the rounding from the tip up to an angle. If the flutes are high enough, its upper half is
/// inside the tool, so the whole torus can be used, which is exact.
void add_tip(RevolvedProfile& profile, const Rounding& round, double to, double height) {
    if (height >= 2.0 * round.corner)
        profile.elements.push_back(round.whole());
    else
        add_cones(profile, round, 0.0, to);
}

ProfileElement upright(double z0, double z1, double r) { return {z0, r, z1, r, 0.0}; }

/// A head that consists of flutes only.
ToolHead plain(const ToolDescription& tool, RevolvedProfile flutes) {
    const ProfileElement& last = flutes.elements.back();
    const double top = 2.0 * (last.r1 + last.margin);
    return {std::move(flutes), {}, tool.flute_length, top};
}

Result<ToolHead> flat(const ToolDescription& tool) {
    return plain(tool, {{upright(0.0, tool.flute_length, 0.5 * tool.diameter)}});
}

Result<ToolHead> rounded(const ToolDescription& tool, double corner) {
    const double r = 0.5 * tool.diameter;
    if (corner == 0.0) return flat(tool);
    RevolvedProfile flutes;
    add_tip(flutes, {r - corner, corner}, right_angle, tool.flute_length);
    if (tool.flute_length > corner)
        flutes.elements.push_back(upright(corner, tool.flute_length, r));
    ToolHead head = plain(tool, std::move(flutes));
    head.top_diameter = tool.diameter;
    return head;
}

Result<ToolHead> ball(const ToolDescription& tool) {
    const double r = 0.5 * tool.diameter;
    if (tool.corner_radius && std::abs(*tool.corner_radius - r) > 0.001)
        return tool_error(tool, fmt::format("corner_radius of a ball is half its diameter, {} {}, "
                                            "not {}; omit it, or use shape \"bull\"",
                                            shown(tool, r), unit_of(tool),
                                            shown(tool, *tool.corner_radius)));
    if (tool.flute_length < r)
        return tool_error(tool, fmt::format("flute_length {} is shorter than the ball's radius {}",
                                            shown(tool, tool.flute_length), shown(tool, r)));
    return rounded(tool, r);
}

Result<ToolHead> bull(const ToolDescription& tool) {
    if (!tool.corner_radius) return tool_error(tool, "shape \"bull\" needs corner_radius");
    const double corner = *tool.corner_radius;
    if (!(corner >= 0.0 && corner <= 0.5 * tool.diameter))
        return tool_error(tool, "corner_radius must lie between 0 and half the diameter");
    if (tool.flute_length <= corner)
        return tool_error(tool, fmt::format("flute_length {} is shorter than corner_radius {}",
                                            shown(tool, tool.flute_length), shown(tool, corner)));
    return rounded(tool, corner);
}

/// A point or flank from the tip out to the full radius, then a cylinder. A corner radius at the
/// tip is tangent to the flank.
Result<ToolHead> coned(const ToolDescription& tool, double tip, double from_axis) {
    const double r = 0.5 * tool.diameter, steep = core::tan(from_axis);
    const double corner = tool.corner_radius.value_or(0.0);
    const Rounding round{tip - corner, corner};
    const double angle = right_angle - from_axis;
    const double z0 = corner > 0.0 ? round.at(angle).z0 : 0.0;
    const double r0 = corner > 0.0 ? round.at(angle).r0 : tip;
    if (tool.flute_length <= z0)
        return tool_error(tool, fmt::format("flute_length {} ends within the rounding of the "
                                            "tip, which is {} high",
                                            shown(tool, tool.flute_length), shown(tool, z0)));
    RevolvedProfile flutes;
    if (corner > 0.0) add_tip(flutes, round, angle, tool.flute_length);
    const double height = z0 + (r - r0) / steep;
    // A flank higher than the flutes ends with them, below the full diameter.
    const double end = std::min(height, tool.flute_length);
    const double r_end = height >= tool.flute_length ? r0 + (end - z0) * steep : r;
    flutes.elements.push_back({z0, r0, end, r_end, 0.0});
    if (height < tool.flute_length)
        flutes.elements.push_back(upright(height, tool.flute_length, r));
    return plain(tool, std::move(flutes));
}

Result<ToolHead> drill(const ToolDescription& tool) {
    const double point = tool.point_deg.value_or(118.0);
    if (point == 180.0) return flat(tool);
    if (!(point > 0.0 && point < 180.0))
        return tool_error(tool, "point_deg must lie between 0 and 180");
    return coned(tool, 0.0, radians_of(0.5 * point));
}

Result<ToolHead> tapered(const ToolDescription& tool) {
    if (!tool.angle_deg)
        return tool_error(tool, fmt::format("{} tools need angle_deg, the flank's angle from the "
                                            "axis",
                                            name_of(tool.shape)));
    if (!(*tool.angle_deg > 0.0 && *tool.angle_deg < 90.0))
        return tool_error(tool, "angle_deg, the flank's angle from the axis, must lie between 0 "
                                "and 90 degrees");
    const double corner = tool.corner_radius.value_or(0.0);
    const double tip = tool.tip_diameter > 0.0 ? 0.5 * tool.tip_diameter : corner;
    if (!(tip >= 0.0 && 2.0 * tip < tool.diameter))
        return tool_error(tool, "tip_diameter must be below diameter");
    if (!(corner >= 0.0 && corner <= tip))
        return tool_error(tool, fmt::format("corner_radius {} is more than half of tip_diameter {}",
                                            shown(tool, corner), shown(tool, tool.tip_diameter)));
    return coned(tool, tip, radians_of(*tool.angle_deg));
}

Result<ToolHead> tslot(const ToolDescription& tool) {
    const double r = 0.5 * tool.diameter, height = tool.flute_length;
    const double corner = tool.corner_radius.value_or(0.0);
    if (corner == 0.0) return flat(tool);
    if (!(corner > 0.0 && corner < r && 2.0 * corner <= height))
        return tool_error(tool,
                          fmt::format("corner_radius {} must be at most half of "
                                      "flute_length {} and below half the diameter, {}",
                                      shown(tool, corner), shown(tool, height), shown(tool, r)));
    const double inner = r - corner;
    RevolvedProfile flutes{{{corner, inner, corner, inner, corner}}};
    if (2.0 * corner < height) {
        flutes.elements.push_back(upright(corner, height - corner, r));
        flutes.elements.push_back({height - corner, inner, height - corner, inner, corner});
    }
    return ToolHead{std::move(flutes), {}, height, 2.0 * inner};
}

Result<ToolHead> dovetail(const ToolDescription& tool) {
    if (!tool.angle_deg || !(*tool.angle_deg > 0.0 && *tool.angle_deg < 90.0))
        return tool_error(tool, "dovetail needs angle_deg, the flank's angle from the axis, "
                                "between 0 and 90");
    const double r = 0.5 * tool.diameter, height = tool.flute_length;
    const double corner = tool.corner_radius.value_or(0.0),
                 steep = core::tan(radians_of(*tool.angle_deg));
    if (!(corner >= 0.0 && corner < r && 2.0 * corner <= height))
        return tool_error(tool, fmt::format("corner_radius {} must be at most half of "
                                            "flute_length {} and below half the diameter",
                                            shown(tool, corner), shown(tool, height)));
    const Rounding round{r - corner, corner};
    const ProfileElement flank = round.at(right_angle + radians_of(*tool.angle_deg));
    const double z0 = corner > 0.0 ? flank.z0 : 0.0, r0 = corner > 0.0 ? flank.r0 : r;
    const double top = r0 - (height - z0) * steep;
    if (!(top > 0.0 && z0 < height))
        return tool_error(tool, fmt::format("at {:g} degrees the flank meets the axis below "
                                            "flute_length {}",
                                            *tool.angle_deg, shown(tool, height)));
    RevolvedProfile flutes;
    if (corner > 0.0) flutes.elements.push_back(round.whole());
    flutes.elements.push_back({z0, r0, height, top, 0.0});
    return ToolHead{std::move(flutes), {}, height, 2.0 * top};
}

Result<ToolHead> lollipop(const ToolDescription& tool) {
    const double r = 0.5 * tool.diameter;
    if (!tool.neck_diameter) return tool_error(tool, "lollipop needs neck_diameter");
    const double neck = 0.5 * *tool.neck_diameter;
    if (!(neck > 0.0 && neck < r))
        return tool_error(tool,
                          fmt::format("neck_diameter {} must be above 0 and below diameter {}",
                                      shown(tool, 2.0 * neck), shown(tool, tool.diameter)));
    const double ball_end = r + std::sqrt(r * r - neck * neck);
    const double flutes = tool.flute_length > 0.0 ? tool.flute_length : ball_end;
    if (flutes < r)
        return tool_error(tool, fmt::format("flute_length {} is shorter than the ball's radius {}",
                                            shown(tool, flutes), shown(tool, r)));
    ToolHead head{.length = std::max(flutes, ball_end), .top_diameter = 2.0 * neck};
    const Rounding round{0.0, r};
    if (flutes >= ball_end) {
        head.flutes.elements.push_back(round.whole());
        if (flutes > ball_end)
            head.above_flutes.elements.push_back(upright(ball_end, flutes, neck));
    } else {
        const double end = core::acos(std::clamp(1.0 - flutes / r, -1.0, 1.0));
        add_cones(head.flutes, round, 0.0, right_angle);
        if (end > right_angle) add_cones(head.flutes, round, right_angle, end);
        add_cones(head.above_flutes, round, end, std::numbers::pi - core::asin(neck / r));
    }
    return head;
}

/// Adds a tooth row of a thread mill from `z` up: the basic profile of its thread, with a crest of
/// 1/8 of the pitch and a root of 1/4.
void add_row(RevolvedProfile& flutes, double z, double pitch, double crest, double root) {
    const double flank = 0.3125 * pitch, half_root = 0.125 * pitch, flat = 0.125 * pitch;
    flutes.elements.push_back(upright(z, z + half_root, root));
    z += half_root;
    flutes.elements.push_back({z, root, z + flank, crest, 0.0});
    flutes.elements.push_back(upright(z + flank, z + flank + flat, crest));
    flutes.elements.push_back({z + flank + flat, crest, z + 2.0 * flank + flat, root, 0.0});
    z += 2.0 * flank + flat;
    flutes.elements.push_back(upright(z, z + half_root, root));
}

Result<ToolHead> threadmill(const ToolDescription& tool) {
    if (!tool.pitch) return flat(tool);
    const double pitch = *tool.pitch, angle = tool.thread_deg.value_or(60.0);
    if (!(pitch > 0.0 && pitch <= tool.flute_length))
        return tool_error(tool, fmt::format("pitch {} must be above 0 and at most flute_length {}",
                                            shown(tool, pitch), shown(tool, tool.flute_length)));
    if (!(angle > 0.0 && angle < 180.0))
        return tool_error(tool, "thread_deg must lie between 0 and 180");
    constexpr double whole = 1.0 + 1e-9; // so that 1.0 / 0.1 gives ten rows despite rounding
    const int most = static_cast<int>(tool.flute_length / pitch * whole);
    const int rows = tool.teeth.value_or(most);
    constexpr int too_many = 200;
    if (rows < 1 || rows > most || rows > too_many)
        return tool_error(tool,
                          fmt::format("teeth = {}: flute_length {} has room for 1 to {}", rows,
                                      shown(tool, tool.flute_length), std::min(most, too_many)));
    const double crest = 0.5 * tool.diameter;
    const double root = crest - 0.3125 * pitch / core::tan(radians_of(0.5 * angle));
    if (!(root > 0.0))
        return tool_error(tool, fmt::format("pitch {} is too large for diameter {}",
                                            shown(tool, pitch), shown(tool, tool.diameter)));
    RevolvedProfile flutes;
    for (int i = 0; i < rows; ++i) add_row(flutes, i * pitch, pitch, crest, root);
    if (rows * pitch < tool.flute_length)
        flutes.elements.push_back(upright(rows * pitch, tool.flute_length, root));
    return ToolHead{std::move(flutes), {}, tool.flute_length, 2.0 * root};
}

/// Adds a piece of an outline: up to `flutes_end` to the flutes, the rest to the part above them.
void add_piece(ToolHead& head, const ProfileElement& piece, double flutes_end) {
    if (piece.z0 >= flutes_end) return head.above_flutes.elements.push_back(piece);
    if (piece.z1 <= flutes_end) return head.flutes.elements.push_back(piece);
    const double fraction = (flutes_end - piece.z0) / (piece.z1 - piece.z0);
    const double r = piece.r0 + fraction * (piece.r1 - piece.r0);
    head.flutes.elements.push_back({piece.z0, piece.r0, flutes_end, r, 0.0});
    head.above_flutes.elements.push_back({flutes_end, r, piece.z1, piece.r1, 0.0});
}

Result<ToolHead> outlined(const ToolDescription& tool) {
    if (tool.outline.size() < 2)
        return tool_error(tool, "profile needs at least two [r, z] points");
    if (tool.outline[0][1] != 0.0) return tool_error(tool, "profile must begin at the tip, z = 0");
    const double top = tool.outline.back()[1];
    if (tool.flute_length > top + 0.001)
        return tool_error(tool,
                          fmt::format("flute_length {} goes beyond the profile, which ends at {}",
                                      shown(tool, tool.flute_length), shown(tool, top)));
    const double flutes_end = tool.flute_length > 0.0 ? tool.flute_length : top;
    ToolHead head{.length = top, .top_diameter = 2.0 * tool.outline.back()[0]};
    for (size_t i = 0; i < tool.outline.size(); ++i) {
        const auto [r, z] = tool.outline[i];
        if (!std::isfinite(r) || !std::isfinite(z) || r < 0.0)
            return tool_error(tool, "profile points need a finite z and an r that is not negative");
        if (i == 0) continue;
        const auto [r_below, z_below] = tool.outline[i - 1];
        if (z < z_below) return tool_error(tool, "profile points must be in order from the tip up");
        if (z > z_below && (r > 0.0 || r_below > 0.0))
            add_piece(head, {z_below, r_below, z, r, 0.0}, flutes_end);
    }
    if (head.flutes.empty()) return tool_error(tool, "profile encloses no volume");
    return head;
}

Result<ToolHead> shaped(const ToolDescription& tool) {
    switch (tool.shape) {
    case ToolShape::ball:
        return ball(tool);
    case ToolShape::bull:
        return bull(tool);
    case ToolShape::drill:
        return drill(tool);
    case ToolShape::taper:
    case ToolShape::chamfer:
        return tapered(tool);
    case ToolShape::tslot:
        return tslot(tool);
    case ToolShape::dovetail:
        return dovetail(tool);
    case ToolShape::lollipop:
        return lollipop(tool);
    case ToolShape::threadmill:
        return threadmill(tool);
    case ToolShape::profile:
        return outlined(tool);
    case ToolShape::flat:
        break;
    }
    return tool.corner_radius ? bull(tool) : flat(tool);
}

/// Adds the neck on top of the head. It does not cut, so it is part of the shank.
Result<void> add_neck(const ToolDescription& tool, ToolHead& head) {
    if (!tool.neck_diameter) {
        if (tool.neck_length) return tool_error(tool, "neck_length needs neck_diameter");
        return {};
    }
    if (!(*tool.neck_diameter > 0.0 && *tool.neck_diameter <= tool.diameter))
        return tool_error(
            tool, fmt::format("neck_diameter {} must be above 0 and at most diameter {}",
                              shown(tool, *tool.neck_diameter), shown(tool, tool.diameter)));
    const bool undercuts = tool.shape == ToolShape::tslot || tool.shape == ToolShape::dovetail;
    if (undercuts && *tool.neck_diameter > head.top_diameter + 1e-6)
        return tool_error(
            tool, fmt::format("neck_diameter {} is wider than the top of the head, {}",
                              shown(tool, *tool.neck_diameter), shown(tool, head.top_diameter)));
    if (!tool.neck_length) return {};
    head.above_flutes.elements.push_back(
        upright(head.length, head.length + *tool.neck_length, 0.5 * *tool.neck_diameter));
    head.length += *tool.neck_length;
    head.top_diameter = *tool.neck_diameter;
    return {};
}

} // namespace

Result<ToolHead> tool_head(const ToolDescription& tool) {
    if (auto wrong = check_keys(tool); !wrong) return tl::unexpected(wrong.error());
    FEELER_TRY(ToolHead head, shaped(tool));
    if (auto wrong = add_neck(tool, head); !wrong) return tl::unexpected(wrong.error());
    return head;
}

namespace {

constexpr double same_length = 0.001; // mm; catalogue values are rounded

bool is_size(double value) { return std::isfinite(value) && value > 0.0; }

bool differ(double a, double b) { return std::abs(a - b) > same_length; }

/// Stacks cones upwards from `z` and sets `z` to their top.
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

/// Distance from the tip to the holder's lower face, if it is given independently of the shank.
std::optional<double> stated_stick_out(const ToolDescription& tool) {
    if (tool.stick_out) return tool.stick_out;
    if (tool.gauge_length && !tool.holder.empty())
        return *tool.gauge_length - total_length(tool.holder);
    return std::nullopt;
}

/// The cylinder between the head and the holder's lower face if no shank is described.
Result<std::vector<ConeStep>> filling_shank(const ToolDescription& tool, const ToolHead& head) {
    const auto stick_out = stated_stick_out(tool);
    if (!stick_out || !differ(*stick_out, head.length)) return std::vector<ConeStep>{};
    if (*stick_out < head.length)
        return tool_error(tool,
                          fmt::format("flutes and neck are {0} {3} long, but {1} leaves {2} {3} "
                                      "below the holder",
                                      shown(tool, head.length),
                                      tool.stick_out ? "stick_out" : "gauge_length",
                                      shown(tool, *stick_out), unit_of(tool)));
    double diameter = tool.diameter > 0.0 ? tool.diameter : head.top_diameter;
    if (tool.neck_diameter && !tool.neck_length) diameter = *tool.neck_diameter;
    if (tool.shank_diameter) diameter = *tool.shank_diameter;
    return std::vector<ConeStep>{{diameter, diameter, *stick_out - head.length}};
}

/// Checks lengths that are given in two ways.
Result<void> check_lengths(const ToolDescription& tool, double to_holder, double to_gauge_line) {
    if (tool.stick_out && differ(*tool.stick_out, to_holder))
        return tool_error(tool, fmt::format("stick_out is {0} {2}, but flutes, neck and shank are "
                                            "{1} {2} long",
                                            shown(tool, *tool.stick_out), shown(tool, to_holder),
                                            unit_of(tool)));
    if (!tool.gauge_length) return {};
    if (!tool.holder.empty() && differ(*tool.gauge_length, to_gauge_line))
        return tool_error(tool, fmt::format("gauge_length is {0} {2}, but flutes, shank and holder "
                                            "are {1} {2} long",
                                            shown(tool, *tool.gauge_length),
                                            shown(tool, to_gauge_line), unit_of(tool)));
    if (*tool.gauge_length < to_gauge_line - same_length)
        return tool_error(tool, fmt::format("gauge_length is {0} {2}, but flutes and shank alone "
                                            "are {1} {2} long",
                                            shown(tool, *tool.gauge_length),
                                            shown(tool, to_gauge_line), unit_of(tool)));
    return {};
}

/// Extends the flutes a little into the slender part above them. Shrinking the head, which
/// distinguishes contact from collision, lowers the upward faces of steps but not the top face; the
/// stub turns the top face into a step.
void bare_upper_face(const ToolDescription& tool, const RevolvedProfile& above,
                     RevolvedProfile& flutes) {
    constexpr double stub = 0.2; // mm; more than twice the amount by which a head is shrunk
    const ProfileElement& top = flutes.elements.back();
    const double usual = tool.neck_diameter.value_or(0.5 * tool.diameter);
    const double r = above.empty() ? 0.5 * usual : above.elements.front().r0;
    const double z = bounds(top).max.z;
    if (r > 0.0 && r < top.r1) flutes.elements.push_back({z, r, z + stub, r, 0.0});
}

/// Extends the flutes past their end by less than the accuracy of their length. Otherwise a cut
/// exactly as deep as the flutes are long would leave a skin at the top of the outer model, thinner
/// than rounding or the error of an arc, and the shank would seem to meet it.
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

namespace {

/// A boring bar without its edge: a cylinder as wide as the shank takes the place of the flutes.
Result<ToolAssembly> without_edge(const ToolAssembly& tool) {
    const ToolDescription& description = tool.description;
    const double above = description.shank.empty()
                             ? description.shank_diameter.value_or(description.diameter)
                             : description.shank.front().lower_diameter;
    const double bar = description.neck_diameter.value_or(above);
    if (bar >= description.diameter)
        return fail(ErrorCode::invalid_value,
                    fmt::format("tool {}: a boring bar (single_point) is thinner than its diameter "
                                "above the edge: state shank_diameter or shank",
                                value_of(description.number)));
    ToolAssembly edgeless = tool;
    RevolvedProfile& flutes = edgeless.parts[0].profile;
    const Aabb box = bounds(flutes);
    flutes.elements = {ProfileElement{box.min.z, 0.5 * bar, box.max.z, 0.5 * bar, 0.0}};
    return edgeless;
}

} // namespace

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
    RevolvedProfile shank = std::move(head.above_flutes);
    shank.elements.insert(shank.elements.end(), steps.elements.begin(), steps.elements.end());
    if (cuts_undercuts(description.shape))
        bare_upper_face(description, shank.empty() ? holder : shank, head.flutes);
    else
        reach_past_end(head.flutes);
    tool.parts.push_back({PartKind::flutes, std::move(head.flutes)});
    if (!shank.empty()) tool.parts.push_back({PartKind::shank, std::move(shank)});
    holder.form_error += description.holder_deviation;
    holder.deviation = description.holder_deviation;
    if (!holder.empty()) tool.parts.push_back({PartKind::holder, std::move(holder)});
    tool.length = holder.empty() ? description.gauge_length.value_or(z) : z;
    if (description.touched_off) {
        tool.gauge_rise = tool.length - *description.touched_off;
        tool.length = *description.touched_off;
    }
    if (tool.description.diameter == 0.0)
        tool.description.diameter = 2.0 * bounds(tool.parts[0].profile).max.x;
    if (!description.single_point) return tool;
    FEELER_TRY(ToolAssembly edgeless, without_edge(tool));
    tool.oriented = std::make_shared<const ToolAssembly>(std::move(edgeless));
    return tool;
}

} // namespace core
