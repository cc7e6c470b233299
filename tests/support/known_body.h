#pragma once

#include <random>
#include <string>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/dbm/cutter.h"
#include "core/dbm/mesh_scan.h"
#include "core/distance/measured_body.h"
#include "tests/support/meshes.h"
#include "tests/support/torus_lines.h"
#include "tests/support/true_distance.h"

namespace test_support {

/// How a body is represented in the program.
enum class BodyForm {
    primitive,
    profile,
    mesh,
    lines, // from here on represented by scan lines
    cut,   // a stock with slots cut into it, with the columns left by cutting
    lines_and_one_family,
    lines_and_columns
};

/// A body whose distances are known in closed form, together with its representation in the
/// program.
struct KnownBody {
    std::string name;
    std::vector<TruePart> parts;
    BodyForm form = BodyForm::primitive;
    double spacing = 1.0;
    core::Vec3 middle = core::Vec3(0.0); // centre of its box
    double size = 0.0;                   // half its longest diagonal
    bool by_mesh = false;                // lines and columns come from its mesh
    core::MeasuredBody body;

    bool is_exact() const { return form <= BodyForm::mesh; }
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
    return core::line_intervals(profile_of(part), axis, u, v);
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

inline core::Mesh mesh_of(const std::vector<TruePart>& boxes) {
    core::Mesh mesh;
    for (const TruePart& part : boxes) {
        const core::Aabb box = box_of(std::get<TrueBox>(part));
        mesh = together(std::move(mesh), box_mesh(box.min, box.max));
    }
    return mesh;
}

/// The exact shape of a body.
inline core::BodyShape shape_of(const KnownBody& known) {
    if (known.form == BodyForm::mesh) return core::solid_mesh(mesh_of(known.parts));
    core::RevolvedProfile profile;
    const TruePart& first = known.parts.front();
    if (known.form == BodyForm::primitive) {
        if (const auto* box = std::get_if<TrueBox>(&first))
            return core::Primitive(core::Box{core::Vec3(box->max - box->min)});
        if (const auto* ball = std::get_if<TrueCapsule>(&first))
            return core::Primitive(core::Sphere{double(ball->radius)});
        const auto& c = std::get<TrueCylinder>(first);
        return core::Primitive(core::Cylinder{double(c.radius), double(c.z1 - c.z0)});
    }
    for (const TruePart& part : known.parts)
        for (const core::ProfileElement& e : profile_of(part).elements)
            profile.elements.push_back(e);
    return profile;
}

inline core::Result<core::Dbm> lines_of(const KnownBody& known) {
    if (known.by_mesh) return core::scan(mesh_of(known.parts), known.spacing);
    const auto line = [&](int axis, double u, double v) {
        core::IntervalList all;
        for (const TruePart& part : known.parts)
            for (const core::Interval& i : line_of(part, axis, u, v)) all.add(i);
        return all;
    };
    return core::scan_lines_of(bounds(known.parts), known.spacing, line);
}

inline core::ColumnFunction columns_of(const KnownBody& known) {
    if (known.by_mesh)
        return core::columns_of(core::Solid{core::solid_mesh(mesh_of(known.parts)), 0.0});
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

inline core::Result<core::MeasuredBody> scanned(const KnownBody& known) {
    if (known.form == BodyForm::cut) {
        const core::CutModel model = cut_model_of(known);
        return core::measured_body(model.lines, core::outer_model(model));
    }
    const core::Aabb box = bounds(known.parts);
    FEELER_TRY(const core::Dbm lines, lines_of(known));
    if (known.form == BodyForm::lines) return core::measured_body(lines);
    if (known.form == BodyForm::lines_and_one_family)
        return core::measured_body(lines,
                                   core::outer_model(box, lines.grid, columns_of(known), {2}));
    return core::measured_body(lines, core::outer_model(box, lines.grid, columns_of(known)));
}

/// Creates the body's representation in an engine.
inline core::Result<KnownBody> built(core::DistanceEngine& engine, KnownBody known) {
    const core::Aabb box = bounds(known.parts);
    known.middle = box.center();
    known.size = 0.5 * glm::length(box.size());
    FEELER_TRY(core::MeasuredBody body, known.is_exact()
                                            ? core::measured_body(shape_of(known), known.spacing)
                                            : scanned(known));
    FEELER_TRY(known.body, core::taken_into(engine, std::move(body)));
    return known;
}

/// The true distance of two bodies, all their parts included.
inline Real true_distance(const KnownBody& a, const KnownBody& b, const core::Transform& a_from_b) {
    const RealPose pose = exactly(a_from_b);
    Real least = real_infinity;
    for (const TruePart& p : a.parts)
        for (const TruePart& q : b.parts) least = std::min(least, distance(p, q, pose));
    return least;
}

} // namespace test_support
