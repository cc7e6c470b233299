#pragma once

#include <map>
#include <optional>
#include <random>

#include <fmt/format.h>

#include "core/dbm/solid.h"
#include "core/sim/setup.h"
#include "tests/support/machines.h"
#include "tests/support/meshes.h"
#include "tests/support/true_machining.h"

namespace test_support {

/// Random numbers.
struct Dice {
    std::mt19937 random;

    double fraction() { return std::uniform_real_distribution<double>(0.0, 1.0)(random); }
    double between(double low, double high) { return low + (high - low) * fraction(); }
    bool chance(double of) { return fraction() < of; }
    size_t index(size_t count) {
        return std::uniform_int_distribution<size_t>(0, count - 1)(random);
    }
    core::Vec3 within(const core::Aabb& box) {
        return box.min + core::Vec3(fraction(), fraction(), fraction()) * box.size();
    }
    core::Transform turned(const core::Vec3& centre, double most_deg) {
        const core::Vec3 angles(between(-most_deg, most_deg), between(-most_deg, most_deg),
                                between(-most_deg, most_deg));
        const core::Mat3 rotation = core::rotation_xyz_deg(angles);
        return {rotation, centre - rotation * centre};
    }
};

/// A set-up in the program's representation and its true geometry.
struct KnownSetup {
    core::Setup setup;
    TrueMachining world;
    std::map<core::ToolNumber, TrueTool> tools;
    core::Aabb box;                           // of the stock, in its frame
    std::optional<core::ProfileElement> nose; // the only machine body; frame: the gauge line
};

inline core::ToolDescription random_description(Dice& dice, core::ToolNumber number) {
    using core::ToolShape;
    core::ToolDescription tool;
    tool.number = number;
    tool.shape = static_cast<ToolShape>(dice.index(9));
    const double d = tool.diameter = dice.between(3.0, 14.0);
    tool.flute_length = dice.between(0.8, 2.5) * d;
    double top = d;
    if (tool.shape == ToolShape::bull) tool.corner_radius = d * dice.between(0.05, 0.45);
    if (tool.shape == ToolShape::taper || tool.shape == ToolShape::chamfer) {
        tool.angle_deg = dice.between(10.0, 50.0);
        tool.tip_diameter = d * dice.between(0.1, 0.6);
        if (dice.chance(0.5)) tool.corner_radius = 0.3 * tool.tip_diameter;
    }
    if (tool.shape == ToolShape::drill) tool.point_deg = dice.between(90.0, 140.0);
    if (tool.shape == ToolShape::tslot) {
        tool.flute_length = d * dice.between(0.2, 0.5);
        if (dice.chance(0.5)) tool.corner_radius = 0.3 * tool.flute_length;
        top = 0.5 * d;
    }
    if (tool.shape == ToolShape::dovetail) {
        tool.angle_deg = dice.between(15.0, 40.0);
        tool.flute_length = d * dice.between(0.2, 0.4);
        top = 0.3 * d;
    }
    if (tool.shape == ToolShape::lollipop) {
        tool.neck_diameter = d * dice.between(0.3, 0.7);
        tool.flute_length = dice.chance(0.5) ? 0.0 : d * dice.between(0.6, 1.2);
        top = *tool.neck_diameter;
    }
    if (dice.chance(0.2)) top *= 1.4;
    tool.shank = {{top, top, dice.between(2.0, 15.0)}};
    if (dice.chance(0.3)) tool.shank.push_back({top, 1.5 * top, 5.0});
    if (dice.chance(0.85)) tool.holder = {{20.0, 28.0, 12.0}, {40.0, 40.0, dice.between(5, 30)}};
    return tool;
}

inline core::ExactBody exact_body(const TrueSolid& solid, bool as_mesh) {
    if (const auto* cone = std::get_if<core::ProfileElement>(&solid)) return core::convex(*cone);
    const core::Aabb& box = std::get<core::Aabb>(solid);
    if (as_mesh) return core::solid_mesh(box_mesh(box.min, box.max));
    return core::convex(box);
}

inline void add_stock(Dice& dice, KnownSetup& known) {
    const double h = known.setup.mesh_size = dice.between(1.0, 3.0);
    core::Vec3 size(dice.between(8, 50), dice.between(8, 50), dice.between(4, 25));
    if (dice.chance(0.2)) size[int(dice.index(3))] = h * dice.between(0.1, 1.2);
    if (dice.chance(0.3)) {
        const double r = 0.5 * size.x, z = size.z;
        known.setup.stock = {core::SolidCylinder{{0, 0, -z}, r, z, 2}, 0.0};
        known.world.stock = core::ProfileElement{-z, r, 0.0, r, 0.0};
        known.box = {{-r, -r, -z}, {r, r, 0}};
        return;
    }
    known.box = {{-0.5 * size.x, -0.5 * size.y, -size.z}, {0.5 * size.x, 0.5 * size.y, 0.0}};
    known.world.stock = known.box;
    known.setup.stock = {core::SolidBox{known.box}, 0.0};
    if (dice.chance(0.2))
        known.setup.stock = {core::solid_mesh(box_mesh(known.box.min, known.box.max)), 0.0};
}

inline void add_fixture(Dice& dice, KnownSetup& known) {
    const core::Vec3 half(dice.between(1, 12), dice.between(1, 12), dice.between(1, 12));
    core::Vec3 centre = dice.within(known.box.grown(8.0));
    const int side = int(dice.index(3));
    centre[side] = dice.chance(0.5) || side == 2 ? known.box.max[side] + half[side]
                                                 : known.box.min[side] - half[side];
    TrueFixture truth;
    truth.solid = core::Aabb{centre - half, centre + half};
    if (dice.chance(0.3)) {
        truth.solid = core::ProfileElement{-half.z, half.x, half.z, half.y, 0.0};
        truth.mount.link_from_body = core::translation(centre);
    } else if (dice.chance(0.5)) {
        truth.mount.link_from_body = dice.turned(centre, 60.0);
    }
    truth.mount.link_from_body =
        known.world.stock_mount.link_from_body * truth.mount.link_from_body;
    truth.mount.on_table = !known.setup.machine.has_rotary() || dice.chance(0.8);
    truth.expendable = dice.chance(0.15);
    core::Fixture fixture;
    fixture.name = fmt::format("fixture-{}", known.setup.fixtures.size());
    fixture.body = exact_body(truth.solid, dice.chance(0.4));
    fixture.expendable = truth.expendable;
    fixture.mount = {truth.mount.on_table ? known.setup.machine.table : core::LinkId::base,
                     truth.mount.link_from_body};
    fixture.is_there = dice.chance(0.8);
    known.setup.fixtures.push_back(std::move(fixture));
    known.world.fixtures.push_back(truth);
}

inline void add_tools(Dice& dice, KnownSetup& known) {
    std::optional<core::ProfileElement> nose; // frame: the gauge line
    if (dice.chance(0.25)) {
        nose = core::ProfileElement{dice.between(-10, 5), 30.0, 40.0, 45.0, 0.0};
        known.nose = nose;
        core::MachineBody body;
        body.name = "nose";
        body.body = core::convex(*nose);
        body.link = known.setup.machine.spindle;
        known.setup.machine.bodies.push_back(std::move(body));
    }
    for (int number = 1; number <= 3; ++number) {
        auto made = core::assemble(random_description(dice, core::ToolNumber{number}));
        while (!made) made = core::assemble(random_description(dice, core::ToolNumber{number}));
        TrueTool tool{.length = made->length};
        for (const core::ToolPart& part : made->parts)
            tool.parts[size_t(part.kind)].emplace(part.profile);
        if (nose) {
            core::ProfileElement moved = *nose;
            moved.z0 += tool.length, moved.z1 += tool.length;
            tool.parts[size_t(core::PartKind::nose)].emplace(core::RevolvedProfile{{moved}});
        }
        known.setup.tools.emplace(core::ToolNumber{number}, *made);
        known.tools.emplace(core::ToolNumber{number}, std::move(tool));
    }
}

inline void add_allowances(Dice& dice, KnownSetup& known) {
    const char* parts[] = {"flutes", "shank", "holder", "nose"};
    for (const char* part : parts)
        for (const char* body : {"stock", "fixture"}) {
            if (dice.chance(0.6)) continue;
            core::AllowanceRule rule{.between = {part, body}};
            rule.distance = dice.chance(0.5) ? 0.0 : dice.between(0.0, 3.0);
            rule.contact = dice.chance(0.5) ? 0.05 : dice.between(0.01, 0.2);
            known.setup.allowances.push_back(rule);
        }
    known.setup.detail = static_cast<core::Detail>(dice.index(3));
    known.setup.search_limit = dice.chance(0.5) ? 50.0 : dice.between(4.0, 50.0);
}

/// A random set-up: a stock, often thinner than the mesh size, between fixtures, three tools, and
/// allowances. `turning`: on a trunnion.
inline KnownSetup random_setup(Dice& dice, bool turning) {
    KnownSetup known;
    if (turning) {
        known.world.machine = {{0, dice.between(-20, 20), dice.between(-40, 0)},
                               {dice.between(-20, 20), dice.between(-20, 20), 0}};
        known.setup.machine = trunnion(known.world.machine.a_point, known.world.machine.c_point);
    }
    if (dice.chance(0.3)) {
        known.setup.machine.rapid = core::RapidStyle::dogleg;
        for (size_t i = 0; i < 6; ++i)
            if (turning || dice.chance(0.7))
                known.setup.machine.axes[i].rapid = dice.between(5e3, 3e4);
    }
    add_stock(dice, known);
    const double lean = turning ? 20.0 : 0.0;
    known.world.stock_mount.link_from_body = dice.turned({0, 0, 0}, lean);
    known.world.stock_mount.link_from_body.translation +=
        dice.within({core::Vec3(-20), core::Vec3(20)});
    known.setup.stock_mount = {known.setup.machine.table, known.world.stock_mount.link_from_body};
    const size_t fixtures = dice.index(4);
    for (size_t i = 0; i < fixtures; ++i) add_fixture(dice, known);
    add_tools(dice, known);
    add_allowances(dice, known);
    return known;
}

/// A shape whose surface is nowhere farther than `deviation` from that of the true one, and the
/// other way round.
inline TrueSolid deviated(Dice& dice, const TrueSolid& solid, double deviation) {
    const double most = 0.57 * deviation; // of each side, so that corners keep it, too
    const auto off = [&] { return dice.between(-most, most); };
    if (const auto* box = std::get_if<core::Aabb>(&solid))
        return core::Aabb{box->min + core::Vec3(off(), off(), off()),
                          box->max + core::Vec3(off(), off(), off())};
    core::ProfileElement cone = std::get<core::ProfileElement>(solid);
    cone.z0 += off(), cone.z1 += off();
    cone.r0 = std::max(0.0, cone.r0 + off());
    cone.r1 = std::max(0.0, cone.r1 + off());
    return cone;
}

/// Replaces the bodies of a random set-up by others that deviate from the true ones, as meshes of
/// CAD files do, and states by how much.
inline void deviate(Dice& dice, KnownSetup& known) {
    for (size_t i = 0; i < known.world.fixtures.size(); ++i) {
        core::Fixture& fixture = known.setup.fixtures[i];
        fixture.deviation = dice.between(0.01, 1.0);
        const TrueSolid other = deviated(dice, known.world.fixtures[i].solid, fixture.deviation);
        fixture.body = exact_body(other, dice.chance(0.5));
    }
    for (core::MachineBody& body : known.setup.machine.bodies) {
        body.deviation = dice.between(0.01, 1.0);
        body.body = exact_body(deviated(dice, *known.nose, body.deviation), false);
    }
    const auto* box = std::get_if<core::Aabb>(&known.world.stock);
    if (!box) return;
    const double deviation = dice.between(0.01, 0.4);
    const core::Aabb other = std::get<core::Aabb>(deviated(dice, *box, deviation));
    if (glm::any(glm::lessThan(other.size(), core::Vec3(0.05)))) return;
    known.setup.stock = {core::solid_mesh(box_mesh(other.min, other.max)), deviation};
    known.setup.stock.deviation = deviation;
}

} // namespace test_support
