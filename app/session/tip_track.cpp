#include "app/session/tip_track.h"

#include <algorithm>
#include <cmath>

namespace app {
namespace {

using core::Vec3;

constexpr double sideways_from = 0.01; // mm

std::optional<Vec3> known(const core::AxisPosition& position) {
    if (!position[0] || !position[1] || !position[2]) return std::nullopt;
    return Vec3(*position[0], *position[1], *position[2]);
}

/// Places along an arc, so many that its box is found to a thousandth of its radius.
void add_arc(const core::ArcPath& arc, const Vec3& from, const Vec3& to,
             std::vector<Vec3>& places) {
    constexpr int places_of_turn = 72;
    const int u = (arc.normal + 1) % 3, v = (arc.normal + 2) % 3, w = arc.normal;
    const double du = from[u] - arc.centre[u], dv = from[v] - arc.centre[v];
    const int count =
        1 + static_cast<int>(std::min(20.0, std::abs(arc.angle) / (2.0 * M_PI)) * places_of_turn);
    for (int i = 1; i < count; ++i) {
        const double share = static_cast<double>(i) / count, angle = share * arc.angle;
        Vec3 p(0.0);
        p[u] = arc.centre[u] + du * std::cos(angle) - dv * std::sin(angle);
        p[v] = arc.centre[v] + du * std::sin(angle) + dv * std::cos(angle);
        p[w] = from[w] + share * (to[w] - from[w]);
        places.push_back(p);
    }
}

} // namespace

double TipTrack::lowest() const {
    double z = core::infinity;
    for (const Vec3& p : places) z = std::min(z, p.z);
    return z;
}

double TipTrack::length() const {
    double way = 0.0;
    for (size_t i = 1; i < places.size(); ++i) way += glm::distance(places[i - 1], places[i]);
    return way;
}

std::optional<TipTrack> tip_track(const core::Motion& motion, double tool_length) {
    const auto from = known(motion.from), to = known(motion.to);
    if (!from || !to) return std::nullopt;
    TipTrack track;
    track.places.push_back(*from);
    if (motion.arc) add_arc(*motion.arc, *from, *to, track.places);
    track.places.push_back(*to);
    for (Vec3& p : track.places) {
        p.z -= tool_length;
        track.sideways =
            track.sideways
            || std::hypot(p.x - track.places[0].x, p.y - track.places[0].y) > sideways_from;
    }
    return track;
}

} // namespace app
