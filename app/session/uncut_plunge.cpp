#include "app/session/uncut_plunge.h"

#include <algorithm>
#include <cmath>

#include "app/session/program_motions.h"
#include "app/session/tip_track.h"

namespace app {
namespace {

using core::Aabb;
using core::Vec3;

constexpr double same_height = 0.05; // mm

/// How deep feeds have been, in square cells over a box.
class CutHeights {
public:
    CutHeights(const Aabb& box, double widest)
        : box_(box),
          cell_(std::max({0.5, std::max(box.size().x, box.size().y) / 400.0, widest / 8.0})),
          columns_(1 + static_cast<long>(box.size().x / cell_)),
          rows_(1 + static_cast<long>(box.size().y / cell_)),
          heights_(static_cast<size_t>(columns_ * rows_), box.max.z) {}

    void cut(const TipTrack& track, double radius) {
        for (size_t i = 1; i < track.places.size(); ++i) {
            const Vec3 from = track.places[i - 1], way = track.places[i] - from;
            const long steps = 1 + static_cast<long>(std::hypot(way.x, way.y) / cell_);
            for (long step = 0; step <= steps; ++step)
                cut(from + way * (static_cast<double>(step) / static_cast<double>(steps)), radius);
        }
    }

    /// Whether a tool that stands there stands in what no feed has cut. Cells count by their
    /// middle; between two places of a cut, its side is that much nearer than its radius.
    bool is_uncut(const Vec3& tip, double radius) const {
        const double missed = 0.01 + cell_ * cell_ / (8.0 * std::max(radius, cell_));
        bool uncut = false;
        visit(tip, radius - missed,
              [&](size_t at) { uncut |= heights_[at] > tip.z + same_height; });
        return uncut;
    }

private:
    void cut(const Vec3& tip, double radius) {
        visit(tip, radius, [&](size_t at) { heights_[at] = std::min(heights_[at], tip.z); });
    }

    /// Calls for every cell whose middle lies within a radius, the one below the place at least.
    template <typename Visit>
    void visit(const Vec3& place, double radius, Visit&& call) const {
        const double x = (place.x - box_.min.x) / cell_, y = (place.y - box_.min.y) / cell_;
        const double reach = std::max(0.75, radius / cell_);
        const auto first = [](double v) { return std::max(0L, std::lround(std::floor(v))); };
        const auto last = [](double v, long count) {
            return std::min(count - 1, std::lround(std::floor(v)));
        };
        for (long row = first(y - reach); row <= last(y + reach, rows_); ++row)
            for (long column = first(x - reach); column <= last(x + reach, columns_); ++column)
                if (std::hypot(static_cast<double>(column) + 0.5 - x,
                               static_cast<double>(row) + 0.5 - y)
                    <= reach)
                    call(static_cast<size_t>(row * columns_ + column));
    }

    Aabb box_;
    double cell_;
    long columns_, rows_;
    std::vector<double> heights_;
};

bool goes_straight_down(const TipTrack& track) {
    return !track.sideways && track.places.back().z < track.places[0].z;
}

bool ends_inside(const TipTrack& track, const Aabb& box) {
    const Vec3& tip = track.places.back();
    return tip.z < box.max.z - same_height && tip.x > box.min.x && tip.x < box.max.x
           && tip.y > box.min.y && tip.y < box.max.y;
}

} // namespace

std::vector<UncutPlunge> uncut_plunges(const gcode::Program& program,
                                       const gcode::Environment& environment,
                                       const SurveyTools& tools, const Aabb& box) {
    double widest = 0.0;
    for (const auto& [number, radius] : tools.radii) widest = std::max(widest, radius);
    CutHeights heights(box, widest);
    std::vector<UncutPlunge> plunges;
    visit_events(program, environment, [&](const ProgramEvent& event) {
        const auto* motion = std::get_if<core::Motion>(&event.event);
        if (!motion) return;
        const auto track = tip_track(*motion, size_of(tools.lengths, event.tool));
        if (!track) return;
        const double radius = size_of(tools.radii, event.tool);
        if (motion->kind != core::MotionKind::rapid)
            heights.cut(*track, radius);
        else if (goes_straight_down(*track) && ends_inside(*track, box)
                 && heights.is_uncut(track->places.back(), radius))
            plunges.push_back({track->places.back(), radius, event.line});
    });
    return plunges;
}

} // namespace app
