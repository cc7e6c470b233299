#pragma once

#include <random>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/dbm/cutter.h"
#include "core/dbm/dbm.h"
#include "core/distance/outer_model.h"
#include "tests/support/torus_lines.h"
#include "tests/support/true_part.h"

namespace test_support {

/// A body whose distances are known in closed form.
struct KnownBody {
    std::vector<TruePart> parts;
    double spacing = 1.0; // of its scan lines
};

/// A capsule along Z or a cylinder as pieces of a profile.
inline core::RevolvedProfile profile_of(const TruePart& part) {
    if (const auto* c = std::get_if<TrueCylinder>(&part))
        return {{{double(c->z0), double(c->radius), double(c->z1), double(c->radius), 0.0}}};
    const auto& c = std::get<TrueCapsule>(part);
    const double a = double(c.a.z), b = double(c.b.z), r = double(c.radius);
    if (a == b) return {{{a, 0.0, a, 0.0, r}}};
    return {{{a, 0.0, a, 0.0, r}, {a, r, b, r, 0.0}, {b, 0.0, b, 0.0, r}}};
}
inline core::Aabb box_of(const TrueBox& b) { return {core::Vec3(b.min), core::Vec3(b.max)}; }

inline core::IntervalList line_of(const TruePart& part, int axis, double u, double v) {
    if (const auto* torus = std::get_if<TrueTorus>(&part))
        return TorusLines{double(torus->ring), double(torus->tube)}.line(axis, u, v);
    if (const auto* box = std::get_if<TrueBox>(&part))
        return core::line_of({core::SolidBox{box_of(*box)}, 0.0}, axis, u, v);
    core::IntervalList line;
    for (const core::ProfileElement& element : profile_of(part).elements)
        if (const auto interval = core::line_interval({element, {}, {}}, axis, u, v))
            line.add(*interval);
    return line;
}

inline core::ColumnFunction columns_of(const TruePart& part) {
    if (const auto* torus = std::get_if<TrueTorus>(&part)) {
        const TorusLines lines{double(torus->ring), double(torus->tube)};
        return [lines](int axis, const core::Square& s) { return lines.column(axis, s); };
    }
    if (const auto* box = std::get_if<TrueBox>(&part))
        return core::columns_of(core::Solid{core::SolidBox{box_of(*box)}, 0.0});
    return core::columns_of(profile_of(part));
}

inline core::Aabb bounds(const TruePart& part) {
    if (const auto* box = std::get_if<TrueBox>(&part)) return box_of(*box);
    if (const auto* torus = std::get_if<TrueTorus>(&part)) {
        const double r = double(torus->ring + torus->tube), h = double(torus->tube);
        return {{-r, -r, -h}, {r, r, h}};
    }
    return core::bounds(profile_of(part));
}

inline core::Aabb bounds(const std::vector<TruePart>& parts) {
    core::Aabb box;
    for (const TruePart& part : parts) box.extend(bounds(part));
    return box;
}

inline core::Result<core::Dbm> lines_of(const KnownBody& known) {
    const auto line = [&](int axis, double u, double v) {
        core::IntervalList all;
        for (const TruePart& part : known.parts)
            for (const core::Interval& i : line_of(part, axis, u, v)) all.add(i);
        return all;
    };
    return core::scan_lines_of(bounds(known.parts), known.spacing, line);
}

inline core::ColumnFunction columns_of(const KnownBody& known) {
    std::vector<core::ColumnFunction> functions;
    for (const TruePart& part : known.parts) functions.push_back(columns_of(part));
    return [functions](int axis, const core::Square& square) {
        core::IntervalList all;
        for (const core::ColumnFunction& of_part : functions)
            for (const core::Interval& i : of_part(axis, square)) all.add(i);
        return all;
    };
}

/// A box cut along X by flat tools, leaving a floor with walls on it.
inline core::CutModel cut_model_of(const KnownBody& known) {
    const core::Aabb box = bounds(known.parts), floor = box_of(std::get<TrueBox>(known.parts[0]));
    core::CutModel model = core::make_cut_model({core::SolidBox{box}, 0.0}, known.spacing).value();
    for (size_t i = 2; i < known.parts.size(); ++i) {
        const double from = box_of(std::get<TrueBox>(known.parts[i - 1])).max.y;
        const double to = box_of(std::get<TrueBox>(known.parts[i])).min.y;
        const double r = 0.5 * (to - from), height = box.size().z + 1.0;
        const core::RevolvedProfile flat{{{0.0, r, height, r, 0.0}}};
        const core::Vec3 start(box.min.x - 2.0 * r, 0.5 * (from + to), floor.max.z);
        core::cut(model, {std::make_shared<core::Cutter>(core::make_cutter(flat, 0.0)),
                          start,
                          {box.max.x + 2.0 * r, start.y, start.z}});
    }
    return model;
}

inline double uniform(std::mt19937& rng, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
}

inline bool one_in(std::mt19937& rng, unsigned n) { return rng() % n == 0; }

inline TrueBox box_round(const core::Vec3& at, const core::Vec3& half) {
    return {RealVec(at - half), RealVec(at + half)};
}

inline TrueCapsule ball_at(const core::Vec3& at, double radius) {
    return {RealVec(at), RealVec(at), radius};
}

/// The rest of a box after two or three slots along X: a floor and walls, some thinner than h.
inline std::vector<TruePart> floor_and_walls(std::mt19937& rng, double h) {
    const double x = h * uniform(rng, 1.0, 3.0), top = h * uniform(rng, 1.0, 4.0);
    double y = 0.0;
    std::vector<TruePart> parts(1);
    const unsigned walls = 2 + rng() % 3;
    for (unsigned i = 0; i < walls; ++i) {
        const double thick =
            h * (one_in(rng, 2) ? uniform(rng, 0.01, 0.3) : uniform(rng, 0.3, 2.0));
        parts.emplace_back(TrueBox{{-x, y, 0.0}, {x, y + thick, top}});
        y += thick + h * uniform(rng, 0.5, 2.0);
    }
    const auto& last = std::get<TrueBox>(parts.back());
    parts[0] = TrueBox{{-x, 0.0, 0.0}, {x, last.max.y, h * uniform(rng, 0.1, 0.9)}};
    return parts;
}

} // namespace test_support
