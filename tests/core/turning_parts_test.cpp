// Flutes that are cut in parts while they turn: each part, with the bound of its error, against
// dense samples of the real motion.
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/motion/path.h"
#include "core/sim/leg/flute_cut.h"
#include "core/sim/leg/turning_parts.h"
#include "core/sim/setup.h"
#include "tests/support/machines.h"
#include "tests/support/profile_oracle.h"
#include "tests/support/stock_oracle.h"

namespace core {
namespace {

using test_support::outside;

Mover mover_of(const RevolvedProfile& flutes, const Machine& machine) {
    const Aabb box = bounds(flutes);
    return {.mount = {machine.spindle, translation({0.0, 0.0, -80.0})},
            .centre = Vec3(0.0, 0.0, box.center().z),
            .reach = std::hypot(box.max.x, 0.5 * box.size().z),
            .is_revolved = true};
}

/// Flutes of every kind, also long ones.
std::vector<RevolvedProfile> tools() {
    std::vector<RevolvedProfile> all = test_support::cutters();
    all.push_back({{{0, 3, 34, 3, 0}}});                                       // long
    all.push_back({{{3, 0, 3, 0, 3}, {3, 3, 40, 3, 0}}});                      // long ball
    all.push_back({{{1, 7, 1, 7, 1}, {1, 8, 60, 8, 0}}});                      // long bull nose
    all.push_back({{{0, 1, 30, 4, 0}}});                                       // long taper
    all.push_back({{{0, 5, 30, 2, 0}}});                                       // narrowing
    all.push_back({{{0, 0, 4, 3, 0}, {4, 3, 20, 5, 0}, {20, 5, 44, 5.5, 0}}}); // steps
    return all;
}

/// A random point on the surface of a piece; often on a rim.
Vec3 surface_point(const ProfileElement& e, std::mt19937& rng) {
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    const double angle = 2.0 * std::numbers::pi * fraction(rng);
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    if (e.margin > 0.0) {
        const double rise = std::numbers::pi * (fraction(rng) - 0.5);
        return e.r0 * out + Vec3(0, 0, e.z0)
               + e.margin * (std::cos(rise) * out + Vec3(0, 0, std::sin(rise)));
    }
    const unsigned kind = static_cast<unsigned>(rng() % 4);
    const double s = kind == 0 ? 0.0 : kind == 1 ? 1.0 : fraction(rng);
    const double inward = kind < 2 && rng() % 2 ? fraction(rng) : 1.0;
    return inward * (e.r0 + s * (e.r1 - e.r0)) * out + Vec3(0, 0, e.z0 + s * (e.z1 - e.z0));
}

TEST(TurningParts, StayWithinTheFlutesAndLeaveNoGaps) {
    std::mt19937 rng(2811);
    const Machine machine = test_support::trunnion(Vec3(0.0), Vec3(0.0));
    size_t divided = 0;
    for (const RevolvedProfile& flutes : tools()) {
        const std::vector<TurningPart> parts = flute_parts(flutes, mover_of(flutes, machine), 0.5);
        divided += parts.size() > 3;
        for (const TurningPart& part : parts)
            for (const ProfileElement& e : part.profile.elements)
                for (int k = 0; k < 200; ++k)
                    EXPECT_LE(outside(flutes, surface_point(e, rng)), 1e-9);
        // Each piece of the flutes, made slimmer, is covered by the parts, made slimmer.
        constexpr double slimmer = 0.01;
        for (const ProfileElement& e : flutes.elements)
            for (int k = 0; k < 500; ++k) {
                const RevolvedProfile inner = shrunk_within({{e}}, slimmer + 1e-9);
                if (inner.empty()) continue;
                const Vec3 p = surface_point(inner.elements[0], rng);
                double least = infinity;
                for (const TurningPart& part : parts)
                    least = std::min(least, outside(shrunk_within(part.profile, slimmer), p));
                EXPECT_LE(least, 1e-9);
            }
    }
    EXPECT_GE(divided, 5U);
}

/// A random leg on which the rotary axes turn by up to `turn` degrees.
Leg random_leg(const Machine& machine, double turn, std::mt19937& rng) {
    std::uniform_real_distribution<double> part(-1.0, 1.0);
    Leg leg{.positions = {AxisValues{}, AxisValues{}}, .end = 1.0};
    for (size_t i = 0; i < 6; ++i) {
        if (!machine.axes[i].present) continue;
        leg.positions[0][i] = (is_rotary(i) ? 70.0 : 30.0) * part(rng);
        leg.positions[1][i] = leg.positions[0][i] + (is_rotary(i) ? turn : 1.0) * part(rng);
    }
    return leg;
}

/// For points of the slimmer part: it is where the flutes are. For points of the flutes: a wider
/// part is where they are.
TEST(TurningParts, KeepTheirBoundsWhileTheAxesTurn) {
    std::mt19937 rng(1281);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    const std::vector<Machine> machines = {test_support::trunnion({10, 20, -60}, {-5, 12, -40}),
                                           test_support::head_and_table({3, 0, 50}, {40, -30, -50}),
                                           test_support::fork_head({1, 2, 60})};
    size_t sharper = 0, legs = 0;
    double nearest_inside = infinity, nearest_outside = infinity; // how near the bounds are met
    for (const RevolvedProfile& flutes : tools()) {
        for (int k = 0; k < 60; ++k) {
            const Machine& machine = machines[static_cast<size_t>(k) % machines.size()];
            const Mover whole = mover_of(flutes, machine);
            const Leg leg = random_leg(machine, std::pow(10.0, -1.5 + 2.5 * fraction(rng)), rng);
            const Mount target{machine.table, {}};
            struct Moved {
                TurningPart part;
                RelativeLeg way;
                RevolvedProfile within, around;
            };
            std::vector<Moved> parts;
            const double error = relative_leg(machine, target, whole, leg).error;
            for (TurningPart& part : flute_parts(flutes, whole, k % 2 ? 0.1 : 0.5)) {
                RelativeLeg way = relative_leg(machine, target, part.mover, leg);
                if (!(way.error < infinity)) continue;
                sharper += way.error < 0.5 * error, ++legs;
                RevolvedProfile within = shrunk_within(part.profile, way.error);
                RevolvedProfile around = grown(part.profile, way.error);
                parts.push_back({std::move(part), std::move(way), within, around});
            }
            if (parts.empty()) continue;
            for (int sample = 0; sample < 60; ++sample) {
                const double t = sample == 0 ? 0.0 : sample == 1 ? 1.0 : fraction(rng);
                AxisValues at = leg.positions[0];
                for (size_t i = 0; i < axis_count; ++i)
                    at[i] += t * (leg.positions[1][i] - leg.positions[0][i]);
                const Transform pose = target_from_mover(machine, target, whole.mount, at);
                const auto position = [&](const RelativeLeg& way) {
                    return way.positions[0] + t * (way.positions[1] - way.positions[0]);
                };
                for (const Moved& moved : parts) {
                    if (moved.within.empty()) continue;
                    const auto& elements = moved.within.elements;
                    const Vec3 p = surface_point(elements[rng() % elements.size()], rng);
                    const Vec3 there = moved.way.orientation * p + position(moved.way);
                    const double off = outside(flutes, pose.inverse() * there);
                    nearest_inside = std::min(nearest_inside, -off / moved.way.error);
                    EXPECT_LE(off, 1e-9);
                }
                const Vec3 p = surface_point(flutes.elements[rng() % flutes.elements.size()], rng);
                double least = infinity, reached = infinity;
                for (const Moved& moved : parts) {
                    const Vec3 own =
                        glm::transpose(moved.way.orientation) * (pose * p - position(moved.way));
                    const double off = outside(moved.around, own);
                    if (off < least) least = off, reached = -off / moved.way.error;
                }
                EXPECT_LE(least, 1e-9);
                nearest_outside = std::min(nearest_outside, reached);
            }
        }
    }
    EXPECT_GT(static_cast<double>(sharper), 0.3 * static_cast<double>(legs));
    EXPECT_LT(nearest_inside, 0.2) << "the test comes near the bounds";
    EXPECT_LT(nearest_outside, 0.3);
}

/// Shanks and holders: slender, stepped, widening, and flat ones that cannot be divided.
std::vector<RevolvedProfile> shanks() {
    return {{{{0, 2, 60, 2, 0}}},
            {{{10, 1, 30, 1, 0}, {30, 3, 70, 3, 0}}},
            {{{10, 2, 50, 6, 0}}},
            {{{20, 8, 44, 8, 0}, {44, 16, 60, 20, 0}, {60, 24, 70, 24, 0}}},
            {{{20, 8, 22, 20, 0}, {22, 20, 24, 8, 0}}},
            {{{5, 3, 5, 3, 2}, {5, 5, 40, 5, 0}}}};
}

TEST(TurningParts, OfAShankContainItAndStayWithinTheirErrorOfIt) {
    std::mt19937 rng(77);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    const std::vector<Machine> machines = {test_support::trunnion({10, 20, -60}, {-5, 12, -40}),
                                           test_support::head_and_table({3, 0, 50}, {40, -30, -50}),
                                           test_support::fork_head({1, 2, 60})};
    const std::vector<bool> no_fixtures;
    Statistics statistics;
    size_t divided = 0, sharper = 0;
    double nearest = infinity;
    for (const RevolvedProfile& shank : shanks()) {
        for (int k = 0; k < 60; ++k) {
            core::Setup setup;
            setup.machine = machines[static_cast<size_t>(k) % machines.size()];
            setup.stock_mount = {setup.machine.table, {}};
            ToolAssembly tool;
            tool.parts = {{PartKind::shank, shank}};
            tool.length = 80.0;
            CheckMemory memory;
            const LegContext context{
                setup,       tool,   FluteUse::cutting, BlockIndex{0},
                no_fixtures, memory, statistics,        moving_bodies(setup, tool)};
            const MovingBody& body = context.bodies[0];
            const Leg leg =
                random_leg(setup.machine, std::pow(10.0, -1.5 + 2.0 * fraction(rng)), rng);
            const BodyLeg& way = context.against_stock(body, leg);
            if (way.parts.empty()) continue;
            ++divided;
            sharper += way.shape_error() < 0.5 * way.error;
            const std::vector<ConvexShape> shapes = shapes_of(body, way);
            const double error = way.shape_error();
            for (int sample = 0; sample < 40; ++sample) {
                const double t = sample < 2 ? sample : fraction(rng);
                const AxisValues at = stretch(leg, 0.0, t).positions[1];
                const Transform pose =
                    target_from_mover(setup.machine, setup.stock_mount, body.mover.mount, at);
                // A point of the shank is near one of the shapes.
                const auto& elements = shank.elements;
                const Vec3 p = pose * surface_point(elements[rng() % elements.size()], rng);
                double off = infinity;
                for (const ConvexShape& shape : shapes)
                    off = std::min(off, separation(shape, convex_segment(p, p)).lower);
                ASSERT_LE(off, error + 1e-9);
                nearest = std::min(nearest, 1.0 - off / error);
                // A point of a shape at that time is near the shank.
                const BodyLeg::Part& part = way.parts[rng() % way.parts.size()];
                const auto& own = part.profile->elements;
                const Vec3 q = part.leg.positions[0]
                               + t * (part.leg.positions[1] - part.leg.positions[0])
                               + part.leg.orientation * surface_point(own[rng() % own.size()], rng);
                ASSERT_LE(outside(shank, pose.inverse() * q), part.leg.error + 1e-9);
            }
        }
    }
    EXPECT_GE(divided, 100U);
    EXPECT_GE(sharper, divided / 2);
    EXPECT_LT(nearest, 0.4) << "the test comes near the bound";
}

struct Bench {
    Setup setup;
    std::vector<bool> no_fixtures = {};
    CheckMemory memory = {};
    Statistics statistics = {};
    CutModel stock = *make_cut_model(setup.stock, setup.mesh_size);
    LegContext context{setup,
                       setup.tools.at(ToolNumber{1}),
                       FluteUse::cutting,
                       BlockIndex{7},
                       no_fixtures,
                       memory,
                       statistics,
                       moving_bodies(setup, setup.tools.at(ToolNumber{1}))};
    FluteCut flutes{context};
};

Setup turning_setup(ToolShape shape) {
    Setup setup;
    setup.machine = test_support::trunnion(Vec3(0, 20, -10), Vec3(0.0));
    setup.mesh_size = 1.0;
    setup.stock = {SolidBox{{{-20, -20, -30}, {20, 20, 0}}}, 0.0};
    setup.stock_mount = {setup.machine.table, {}};
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.shape = shape;
    tool.diameter = 6;
    tool.flute_length = 34;
    tool.shank = {{6, 6, 20}};
    setup.tools.emplace(tool.number, *assemble(tool));
    return setup;
}

const Leg tilting_leg(double length) {
    return {.positions = {AxisValues{-24, 3, length - 20, 10, 0, 0},
                          AxisValues{10, 8, length - 24, 35, 0, 50}},
            .end = 1.0};
}

/// The same cut in many short legs on which the whole flutes hardly turn.
TEST(FluteCut, RemovesInPartsWhatTheWholeFlutesRemoveInShortLegs) {
    for (const ToolShape shape : {ToolShape::flat, ToolShape::ball}) {
        Bench once{turning_setup(shape)}, shortly{turning_setup(shape)};
        const Leg leg = tilting_leg(once.context.tool.length);
        ASSERT_TRUE(once.context.flutes_turn_too_far(leg));
        const double removed = once.flutes.along(leg, once.stock);
        constexpr int count = 5'000;
        double reference = 0.0;
        for (int i = 0; i < count; ++i) {
            const Leg part = stretch(leg, double(i) / count, double(i + 1) / count);
            ASSERT_FALSE(shortly.context.flutes_turn_too_far(part));
            reference += shortly.flutes.along(part, shortly.stock);
        }
        EXPECT_GT(reference, 1000.0);
        EXPECT_NEAR(removed, reference, 0.004 * reference);
    }
}

/// Shorter legs do not reduce the error of the path, so halving must not wait for it.
TEST(FluteCut, EndsWhereThePathIsLessAccurateThanFlutesNeed) {
    Bench bench{turning_setup(ToolShape::ball)};
    Leg leg = tilting_leg(bench.context.tool.length);
    leg.path_error = 0.05;
    EXPECT_GT(bench.flutes.along(leg, bench.stock), 1000.0);
    EXPECT_LT(bench.statistics.sweeps, 20'000U);
}

TEST(FluteCut, KnowsABoringBarThatIsStoppedByItsFlutes) {
    core::Setup setup = turning_setup(ToolShape::flat);
    ToolDescription bar = setup.tools.at(ToolNumber{1}).description;
    bar.single_point = true;
    bar.shank = {{4, 4, 20}};
    setup.tools.at(ToolNumber{1}) = *assemble(bar);
    Bench turning{setup};
    const ToolAssembly& stopped = *turning.context.tool.oriented;
    LegContext context{turning.setup,         stopped,
                       FluteUse::not_cutting, BlockIndex{7},
                       turning.no_fixtures,   turning.memory,
                       turning.statistics,    moving_bodies(turning.setup, stopped)};
    FluteCut bar_alone{context};
    const Leg still{.positions = {AxisValues{0, 0, 100, 0, 0, 0}}};
    const auto radius = [&](FluteCut& flutes) {
        return bounds(flutes.sweep_on(still).cutter->pieces[0].within).max.x;
    };
    EXPECT_EQ(radius(turning.flutes), 3.0);
    EXPECT_EQ(radius(bar_alone), 2.0);
}

} // namespace
} // namespace core
