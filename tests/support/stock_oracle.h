#pragma once

#include <random>
#include <vector>

#include "core/dbm/cut_model.h"
#include "tests/support/tilted_sweep.h"

namespace test_support {

/// A cut box, defined by its cuts alone, independent of the model.
struct CutBox {
    struct Cut {
        core::RevolvedProfile flutes;
        core::Vec3 from, to;
        core::Mat3 orientation = core::Mat3(1.0);
    };
    core::Aabb box;
    double path_error = 0.0;
    std::vector<Cut> cuts;

    /// The distance of a point from everything that was cut, with the paths shifted by `off`.
    double outside_cuts(const core::Vec3& p, const core::Vec3& off = core::Vec3(0.0)) const {
        double least = core::infinity;
        for (const Cut& cut : cuts)
            least = std::min(least, outside_tilted_sweep(cut.flutes, cut.orientation,
                                                         cut.from + off, cut.to + off, p));
        return least;
    }

    core::CutModel uncut(double spacing) const {
        return core::make_cut_model({core::SolidBox{box}, 0.0}, spacing).value();
    }
    core::CutterSweep sweep(size_t i) const {
        return {std::make_shared<core::Cutter>(core::make_cutter(cuts[i].flutes, path_error)),
                cuts[i].from, cuts[i].to, cuts[i].orientation, static_cast<uint32_t>(i)};
    }
    core::CutModel model(double spacing) const {
        core::CutModel result = uncut(spacing);
        for (size_t i = 0; i < cuts.size(); ++i) core::cut(result, sweep(i));
        return result;
    }
};

inline core::Vec3 random_point(const core::Aabb& box, std::mt19937& rng) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    const core::Vec3 at(fraction(rng), fraction(rng), fraction(rng));
    return box.min + at * box.size();
}

/// The outlines of cutters of every kind, convex or not.
inline std::vector<core::RevolvedProfile> cutters() {
    return {
        {{{0, 3, 12, 3, 0}}},                                        // flat
        {{{2, 0, 2, 0, 2}, {2, 2, 9, 2, 0}}},                        // ball
        {{{0.8, 2, 0.8, 2, 0.8}, {0.8, 2.8, 9, 2.8, 0}}},            // bull nose
        {{{0, 0, 1.2, 2, 0}, {1.2, 2, 14, 2, 0}}},                   // drill
        {{{0, 0.3, 10, 3, 0}}},                                      // taper
        {{{0, 4, 1.5, 4, 0}, {1.5, 1.5, 8, 1.5, 0}}},                // T-slot
        {{{0, 3.5, 3, 1.5, 0}, {3, 1.2, 9, 1.2, 0}}},                // dovetail
        {{{0, 2, 1, 1, 0}, {1, 1, 2, 2.5, 0}, {2, 2.5, 8, 2.5, 0}}}, // a profile with a waist
    };
}

/// Random cuts at various heights and directions, many of them horizontal, vertical or along an
/// axis.
inline CutBox random_cut_box(std::mt19937& rng, size_t count, double path_error) {
    CutBox world{{{-8, -7, -6}, {9, 8, 2}}, path_error, {}};
    const std::vector<core::RevolvedProfile> tools = cutters();
    for (size_t i = 0; i < count; ++i) {
        core::Vec3 from = random_point(world.box.grown(2.0), rng);
        core::Vec3 to = random_point(world.box.grown(2.0), rng);
        const unsigned kind = static_cast<unsigned>(rng() % 7);
        if (kind < 3) to.z = from.z;
        if (kind == 1) to.y = from.y;
        if (kind == 2) to.x = from.x;
        if (kind == 3) to = {from.x, from.y, to.z};
        if (kind == 4) to = from;
        if (kind == 0) from = glm::round(from), to = glm::round(to);
        world.cuts.push_back({tools[rng() % tools.size()], from, to});
    }
    return world;
}

/// As random_cut_box, but with the tool in any direction, including along an axis and upside down.
inline CutBox random_tilted_cut_box(std::mt19937& rng, size_t count, double path_error) {
    CutBox world = random_cut_box(rng, count, path_error);
    for (CutBox::Cut& cut : world.cuts) {
        cut.orientation = random_rotation(rng);
        const unsigned kind = static_cast<unsigned>(rng() % 4);
        const auto quarter = [&] { return 90.0 * static_cast<double>(rng() % 4); };
        if (kind == 0) cut.orientation = core::rotation_xyz_deg({quarter(), quarter(), 0.0});
        if (kind == 1) cut.to = cut.from + (cut.to.z - cut.from.z) * cut.orientation[2];
    }
    return world;
}

/// Calls act(i, j, square) for every cell whose closed square contains the point.
template <typename Act>
void for_cells_at(const core::CutModel& model, const core::Vec3& p, const Act& act) {
    for (int j = 0; j < model.columns.v_count(); ++j)
        for (int i = 0; i < model.columns.u_count(); ++i) {
            const core::Square s = core::cell_square(model, i, j);
            if (s.x0 <= p.x && p.x <= s.x1 && s.y0 <= p.y && p.y <= s.y1) act(i, j, s);
        }
}

} // namespace test_support
