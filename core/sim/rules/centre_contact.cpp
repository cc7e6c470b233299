#include "core/base/math.h"
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

double distance_xy(const Vec3& a, const Vec3& b) { return core::hypot(a.x - b.x, a.y - b.y); }

/// Smallest circle around the positions; its radius is at most a few percent too large.
Circle circle_round(const std::vector<Vec3>& positions) {
    Circle circle{positions.front(), 0.0};
    const auto farthest = [&] {
        return *std::max_element(
            positions.begin(), positions.end(), [&](const Vec3& a, const Vec3& b) {
                return distance_xy(a, circle.centre) < distance_xy(b, circle.centre);
            });
    };
    constexpr int rounds = 60; // error of the centre <= radius / sqrt(rounds)
    for (int i = 1; i <= rounds; ++i)
        circle.centre += (farthest() - circle.centre) / static_cast<double>(i + 1);
    circle.radius = distance_xy(farthest(), circle.centre);
    return circle;
}

/// Whether the edges have passed everything under the centre at the end of the trail, down to its
/// height.
bool has_cleared_its_level(const CentreTracker& tracker, double centre_radius) {
    std::vector<Vec3> here;
    for (const Vec3& position : tracker.trail)
        if (position.z <= tracker.trail.back().z + level) here.push_back(position);
    return circle_round(here).radius > centre_radius;
}

/// Whether the region that has been under the centre during the whole trail contains material; or,
/// if not `certain`, may contain some.
bool meets_matter(const CentreTracker& tracker, const ToolDescription& tool, const CutModel& stock,
                  bool certain) {
    const double recess = centre_recess(tool), low = tracker.trail.back().z + recess + touch;
    if (low >= tracker.top) return false;
    const Circle circle = circle_round(tracker.trail);
    const double radius = tool.centre_radius - circle.radius - touch;
    if (!(radius > 0.0)) return false;
    const RevolvedProfile face{{{0.0, radius, tracker.top - low, radius, 0.0}}};
    const Vec3 position = tracker.orientation * Vec3(circle.centre.x, circle.centre.y, low);
    const RelativeLeg rest{.orientation = tracker.orientation, .positions = {position}};
    if (certain)
        return separation(shapes_of(face, rest), stock, {.limit = level}).separation.upper <= 0.0;
    const StockGoal goal{.limit = 2.0 * level, .bound = StockBound::lower, .threshold = level};
    return separation(shapes_of(face, rest), stock, goal).separation.lower <= 0.0;
}

/// Continues the trail at `from`, or begins a new one if the tool was elsewhere or moves up.
void take_up(CentreTracker& tracker, const Mat3& orientation, const Vec3& from, const Vec3& to) {
    const bool goes_on = !tracker.trail.empty() && tracker.orientation == orientation
                         && glm::distance(tracker.trail.back(), from) <= level
                         && to.z <= from.z + level;
    if (goes_on) return;
    tracker = {};
    tracker.orientation = orientation;
    tracker.trail = {from};
}

/// Number of positions to check on a leg.
int sample_count(const Vec3& by, const ToolDescription& tool) {
    const double steps =
        std::max(-by.z / centre_recess(tool), core::hypot(by.x, by.y) / tool.centre_radius);
    return 1 + static_cast<int>(8.0 * std::min(steps, 1e5));
}

} // namespace

double centre_recess(const ToolDescription& tool) {
    return std::min(0.25 * tool.centre_radius, 1.0);
}

std::optional<CentreContact> follow(CentreTracker& tracker, const ToolDescription& tool,
                                    const RelativeLeg& leg, const CutModel& stock, bool certain) {
    if (leg.turns || leg.positions.size() > 2) tracker = {};
    if (leg.turns || leg.positions.size() != 2) return std::nullopt;
    const Mat3 tool_from_stock = glm::transpose(leg.orientation);
    const Vec3 from = tool_from_stock * leg.positions[0], to = tool_from_stock * leg.positions[1];
    take_up(tracker, leg.orientation, from, to);
    const bool down = to.z < from.z - level;
    if ((!down && distance_xy(from, to) > 2.0 * tool.centre_radius) || to.z > from.z + level) {
        tracker.before.reset();
        tracker.trail = {to};
        return std::nullopt;
    }
    if (down && !tracker.before) {
        tracker.before = stock;
        tracker.top = from.z;
    }
    const int count = sample_count(to - from, tool);
    for (int i = 1; i <= count; ++i) {
        const double fraction = static_cast<double>(i) / count;
        tracker.trail.push_back(from + fraction * (to - from));
        auto& trail = tracker.trail;
        size_t above = 0;
        while (above + 1 < trail.size()
               && trail[above + 1].z >= trail.back().z + centre_recess(tool))
            ++above;
        trail.erase(trail.begin(), trail.begin() + static_cast<std::ptrdiff_t>(above));
        if (!tracker.before || !meets_matter(tracker, tool, *tracker.before, certain)) continue;
        const CentreContact contact{
            fraction, leg.positions[0] + fraction * (leg.positions[1] - leg.positions[0])};
        tracker = {};
        return contact;
    }
    if (!down && has_cleared_its_level(tracker, tool.centre_radius)) {
        tracker.before.reset();
        tracker.trail = {to};
    }
    return std::nullopt;
}

} // namespace core
