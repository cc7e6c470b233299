#include "render/motion_path.h"

#include <cmath>
#include <numbers>

#include "core/motion/kinematics.h"
#include "render/setup_scene.h"

namespace render {
namespace {

constexpr double turn_step = std::numbers::pi / 60.0;

/// Positions closer than this are equal, mm.
constexpr double joined = 1e-3;

class PathMaker {
public:
    PathMaker(std::vector<PathPoint>& points, const core::Setup& setup, double tool_length,
              const MotionStyle& style)
        : points_(points), setup_(setup), tool_length_(tool_length), style_(style) {}

    void straight(const core::AxisValues& from, const core::AxisValues& to) {
        start(from);
        const double turn = core::turn_of(setup_.machine, from, to);
        const int pieces = std::max(1, static_cast<int>(std::ceil(turn / turn_step)));
        for (int i = 1; i <= pieces; ++i) {
            core::AxisValues at = to;
            for (size_t a = 0; a < core::axis_count; ++a)
                if (i < pieces) at[a] = from[a] + (to[a] - from[a]) * i / pieces;
            go(at);
        }
    }
    void start(const core::AxisValues& values) {
        const glm::vec3 position = tip_of(values);
        if (points_.empty() || !(glm::distance(points_.back().position, position) <= joined))
            points_.push_back({position, style_.block, style_.state, style_.rapid, true});
    }
    void go(const core::AxisValues& values) {
        points_.push_back({tip_of(values), style_.block, style_.state, style_.rapid, false});
    }

private:
    glm::vec3 tip_of(const core::AxisValues& values) const {
        return glm::vec3(tip_in_stock(setup_, tool_length_, values));
    }

    std::vector<PathPoint>& points_;
    const core::Setup& setup_;
    double tool_length_;
    const MotionStyle& style_;
};

} // namespace

void append_motion(std::vector<PathPoint>& points, const core::Setup& setup, double tool_length,
                   const core::Path& path, const MotionStyle& style) {
    PathMaker maker(points, setup, tool_length, style);
    for (const core::Leg& leg : path.legs) {
        if (leg.straight && leg.start_known && leg.positions.size() == 2) {
            maker.straight(leg.positions[0], leg.positions[1]);
            continue;
        }
        for (size_t i = 0; i < leg.certain.size(); ++i)
            i == 0 ? maker.start(leg.certain[i]) : maker.go(leg.certain[i]);
    }
}

} // namespace render
