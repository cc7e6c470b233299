#include "core/distance/stock_distance.h"
#include "core/motion/kinematics.h"
#include "core/sim/moving_body.h"
#include "core/sim/rules/rules.h"
#include "core/sim/tool_description.h"

namespace core {
namespace {

/// Positions that differ in height by less are at the same height, mm. Also the tolerance between
/// the end of a leg and the start of the next.
constexpr double level = 1e-6;

/// The overlap that counts as contact for flutes, mm.
constexpr double touch = 0.05;

/// A circle around positions, seen along the tool's axis.
struct Circle {
    Vec3 centre = Vec3(0.0);
    double radius = 0.0;
};

double beside(const Vec3& a, const Vec3& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Smallest circle around the positions; its radius is at most a few percent too large.
Circle circle_round(const std::vector<Vec3>& places) {
    Circle circle{places.front(), 0.0};
    const auto farthest = [&] {
        return *std::max_element(places.begin(), places.end(), [&](const Vec3& a, const Vec3& b) {
            return beside(a, circle.centre) < beside(b, circle.centre);
        });
    };
    constexpr int rounds = 60; // error of the centre <= radius / sqrt(rounds)
    for (int i = 1; i <= rounds; ++i)
        circle.centre += (farthest() - circle.centre) / static_cast<double>(i + 1);
    circle.radius = beside(farthest(), circle.centre);
    return circle;
}

/// Whether the edges have passed everything under the centre at the end of the trail, down to its
/// height.
bool has_cleared_its_level(const CentreWatch& watch, double centre_radius) {
    std::vector<Vec3> here;
    for (const Vec3& place : watch.trail)
        if (place.z <= watch.trail.back().z + level) here.push_back(place);
    return circle_round(here).radius > centre_radius;
}

/// Whether the region that has been under the centre during the whole trail contains material.
bool meets_matter(const CentreWatch& watch, const ToolDescription& tool, const CutModel& stock) {
    const double recess = centre_recess(tool), low = watch.trail.back().z + recess + touch;
    if (low >= watch.top) return false;
    const Circle circle = circle_round(watch.trail);
    const double radius = tool.centre_radius - circle.radius - touch;
    if (!(radius > 0.0)) return false;
    const RevolvedProfile face{{{0.0, radius, watch.top - low, radius, 0.0}}};
    const Vec3 place = watch.orientation * Vec3(circle.centre.x, circle.centre.y, low);
    const RelativeLeg rest{.orientation = watch.orientation, .places = {place}};
    return separation(shapes_of(face, rest), stock, {.limit = level}).separation.upper <= 0.0;
}

/// Continues the trail at `from`, or begins a new one if the tool was elsewhere or moves up.
void take_up(CentreWatch& watch, const Mat3& orientation, const Vec3& from, const Vec3& to) {
    const bool goes_on = !watch.trail.empty() && watch.orientation == orientation
                         && glm::distance(watch.trail.back(), from) <= level
                         && to.z <= from.z + level;
    if (goes_on) return;
    watch = {};
    watch.orientation = orientation;
    watch.trail = {from};
}

/// Number of positions to check on a leg.
int places_on(const Vec3& by, const ToolDescription& tool) {
    const double shares =
        std::max(-by.z / centre_recess(tool), std::hypot(by.x, by.y) / tool.centre_radius);
    return 1 + static_cast<int>(8.0 * std::min(shares, 1e5));
}

} // namespace

double centre_recess(const ToolDescription& tool) {
    return std::min(0.25 * tool.centre_radius, 1.0);
}

std::optional<CentreContact> follow(CentreWatch& watch, const ToolDescription& tool,
                                    const RelativeLeg& leg, const CutModel& stock) {
    if (leg.turns || leg.places.size() > 2) watch = {};
    if (leg.turns || leg.places.size() != 2) return std::nullopt;
    const Mat3 tool_from_stock = glm::transpose(leg.orientation);
    const Vec3 from = tool_from_stock * leg.places[0], to = tool_from_stock * leg.places[1];
    take_up(watch, leg.orientation, from, to);
    const bool down = to.z < from.z - level;
    if ((!down && beside(from, to) > 2.0 * tool.centre_radius) || to.z > from.z + level) {
        watch.before.reset();
        watch.trail = {to};
        return std::nullopt;
    }
    if (down && !watch.before) {
        watch.before = stock;
        watch.top = from.z;
    }
    const int count = places_on(to - from, tool);
    for (int i = 1; i <= count; ++i) {
        const double share = static_cast<double>(i) / count;
        watch.trail.push_back(from + share * (to - from));
        auto& trail = watch.trail;
        size_t above = 0;
        while (above + 1 < trail.size()
               && trail[above + 1].z >= trail.back().z + centre_recess(tool))
            ++above;
        trail.erase(trail.begin(), trail.begin() + static_cast<std::ptrdiff_t>(above));
        if (!watch.before || !meets_matter(watch, tool, *watch.before)) continue;
        const CentreContact contact{share, leg.places[0] + share * (leg.places[1] - leg.places[0])};
        watch = {};
        return contact;
    }
    if (!down && has_cleared_its_level(watch, tool.centre_radius)) {
        watch.before.reset();
        watch.trail = {to};
    }
    return std::nullopt;
}

} // namespace core
