#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/motion/path.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;

/// A ring along which the tool moves around the centre, and a pin. Frame: the machine; the tip is
/// at the gauge line minus the length.
struct Round {
    double radius = 30.0; // of the tool path
    double start = 0.0, angle = tau, rise = 0.0;
    Vec3 pin = Vec3(0.0); // its centre
    double pin_radius = 10.0;
};

/// A plain cylinder of 10 mm; no other part of the tool can come near.
ToolAssembly bare_tool() {
    ToolDescription tool;
    tool.number = ToolNumber{1};
    tool.diameter = 10.0;
    tool.flute_length = 60.0;
    return *assemble(tool);
}

Setup setup_of(const Round& round) {
    Setup setup;
    setup.stock = {SolidBox{{{900, 900, -10}, {910, 910, 0}}}, 0.0};
    setup.tools.emplace(ToolNumber{1}, bare_tool());
    Fixture pin;
    pin.name = "pin";
    pin.body = convex(ProfileElement{-100.0, round.pin_radius, 100.0, round.pin_radius, 0.0});
    pin.mount.link_from_body = translation(round.pin);
    setup.fixtures.push_back(std::move(pin));
    return setup;
}

Motion motion_of(const Round& round, double length) {
    const auto at = [&](double angle, double z) {
        return AxisPosition{round.radius * std::cos(angle), round.radius * std::sin(angle),
                            z + length};
    };
    Motion motion{.kind = MotionKind::arc,
                  .from = at(round.start, 0.0),
                  .to = at(round.start + round.angle, round.rise),
                  .feed = 600.0};
    motion.arc = ArcPath{2, Vec3(0.0), round.angle};
    return motion;
}

/// The result for flutes and pin over the whole path.
PairClearance passed(const Round& round) {
    const Setup setup = setup_of(round);
    SimulatorState state = *start_of_run(setup, {});
    const std::vector<Event> begin = {ToolChange{ToolNumber{1}}};
    run_block(setup, {BlockIndex{0}, false, begin}, state);
    const std::vector<Event> arc = {motion_of(round, bare_tool().length)};
    const BlockResult result = run_block(setup, {BlockIndex{1}, false, arc}, state);
    for (const PairClearance& pair : result.pairs)
        if (pair.pair == Pair{PartKind::flutes, 0}) return pair;
    ADD_FAILURE() << "the pair is missing from the result";
    return {};
}

/// The distance between the side of the tool and that of the pin, both upright; 0 if they overlap.
double true_distance(const Round& round) {
    const double away = std::hypot(round.pin.x, round.pin.y);
    const double towards = std::atan2(round.pin.y, round.pin.x);
    const auto apart = [&](double angle) {
        return std::hypot(round.radius * std::cos(angle) - round.pin.x,
                          round.radius * std::sin(angle) - round.pin.y);
    };
    double least = std::min(apart(round.start), apart(round.start + round.angle));
    const double sense = round.angle < 0.0 ? -1.0 : 1.0;
    const double ahead = std::fmod(sense * (towards - round.start) + 4.0 * tau, tau);
    if (ahead <= std::abs(round.angle)) least = std::abs(away - round.radius);
    return std::max(0.0, least - round.pin_radius - 5.0);
}

TEST(ArcClearance, IsWithinAThousandthForAnyPositionOfThePin) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> fraction(0.0, 1.0);
    size_t near = 0, far = 0, ends = 0;
    for (int i = 0; i < 400; ++i) {
        Round round;
        round.radius = std::pow(10.0, -0.5 + 3.0 * fraction(random));
        round.start = tau * fraction(random);
        round.angle = tau * (2.0 * fraction(random) - 1.0);
        round.rise = i % 3 == 0 ? 20.0 * fraction(random) : 0.0;
        const double gap = i % 2 ? 0.01 * fraction(random) : 30.0 * fraction(random);
        round.pin_radius = 0.5 + 20.0 * fraction(random);
        const double inside = round.radius - 5.0 - gap;
        const bool is_round_it = inside > 0.5 && i % 5 == 0;
        if (is_round_it) round.pin_radius = inside;
        const double at = tau * fraction(random);
        const double out = is_round_it ? 0.0 : round.radius + 5.0 + gap + round.pin_radius;
        round.pin = {out * std::cos(at), out * std::sin(at), 0.0};
        const PairClearance found = passed(round);
        const double truth = true_distance(round);
        if (truth >= 50.0) continue;
        EXPECT_LE(found.lower, truth + 1e-9) << i;
        EXPECT_GE(found.upper, truth - 1e-9) << i;
        EXPECT_LE(found.upper - found.lower, 1e-3) << i << ", radius " << round.radius;
        (truth < 0.02 ? near : far) += 1;
        ends += truth > gap + 1.0;
    }
    EXPECT_GT(near, 60U);
    EXPECT_GT(far, 100U);
    EXPECT_GT(ends, 50U);
}

TEST(ArcClearance, IsDecidedOnEitherSideOfTheAllowance) {
    for (const double beyond : {-1e-4, 1e-4}) {
        Round round;
        round.pin_radius = round.radius - 5.0 - 2.0 - beyond;
        const Verdict expected = beyond > 0.0 ? Verdict::clear : Verdict::violation;
        EXPECT_EQ(passed(round).verdict, expected) << beyond;
    }
}

TEST(ArcClearance, CallsAChordThatCutsThePinNoCollision) {
    Round round; // the chord midpoints are 0.00125 mm nearer to the pin
    round.pin_radius = round.radius - 5.0 - 2e-4;
    const PairClearance beside = passed(round);
    EXPECT_EQ(beside.verdict, Verdict::violation);
    EXPECT_GE(beside.upper, 2e-4);
    round.pin_radius += 0.01;
    const PairClearance within = passed(round);
    EXPECT_EQ(within.verdict, Verdict::collision);
    EXPECT_EQ(within.upper, 0.0);
}

TEST(ArcPath, StaysWithinItsErrorOfEveryChordThoughTheRadiusChanges) {
    const Machine machine;
    for (const double growth : {0.0, 0.3, 5.0}) {
        const double angle = 0.4;
        Motion motion{
            .kind = MotionKind::arc,
            .from = {10.0, 0.0, 0.0},
            .to = {(10.0 + growth) * std::cos(angle), (10.0 + growth) * std::sin(angle), 1.0},
            .feed = 100.0};
        motion.arc = ArcPath{2, Vec3(0.0), angle};
        for (const double error : {0.0025, 1e-4}) {
            double worst = 0.0;
            const Path path = path_of(motion, machine, error);
            for (const Leg& leg : path.legs)
                for (const Leg& part : halves(leg)) {
                    EXPECT_LE(part.path_error, 0.3 * error);
                    for (int i = 0; i <= 16; ++i) {
                        const double t = i / 16.0;
                        const double fraction =
                            part.arc.first + t * (part.arc.last - part.arc.first);
                        const double r = 10.0 + fraction * growth, a = fraction * angle;
                        const Vec3 real(r * std::cos(a), r * std::sin(a), fraction);
                        const AxisValues& p = part.positions[0];
                        const AxisValues& q = part.positions[1];
                        const Vec3 from(p[0], p[1], p[2]), to(q[0], q[1], q[2]);
                        const double off = glm::distance(real, from + t * (to - from));
                        EXPECT_LE(off, part.path_error + 1e-12);
                        worst = std::max(worst, off / part.path_error);
                    }
                }
            EXPECT_GT(worst, 0.9) << "the bound is near";
        }
    }
}

TEST(ArcPath, KeepsTheErrorOfItsMotionInShorterChords) {
    Motion motion{.kind = MotionKind::arc, .from = {10.0, 0, 0}, .to = {0, 10.0, 0}, .feed = 100.0};
    motion.arc = ArcPath{2, Vec3(0.0), 1.5707963267948966};
    motion.path_error = 0.02;
    const Path path = path_of(motion, Machine(), 0.0025);
    const Leg& leg = path.legs.front();
    EXPECT_EQ(leg.lasting_error, 0.02);
    const Leg part = halves(halves(leg)[0])[1];
    EXPECT_EQ(part.lasting_error, 0.02);
    EXPECT_GT(part.path_error, 0.02);
    EXPECT_LT(part.path_error, 0.02 + 0.1 * (leg.path_error - 0.02));
    EXPECT_EQ(still_half_way(leg).path_error, 0.02);
}

TEST(ArcPath, HasABoundedNumberOfChordsWhoseErrorIsStated) {
    for (const double radius : {1e6, 1e9, 1e20, 1e40}) {
        Motion motion{.kind = MotionKind::arc,
                      .from = {radius, 0.0, 0.0},
                      .to = {radius, 0.0, 0.0},
                      .feed = 100.0};
        motion.arc = ArcPath{2, Vec3(0.0), 6.283185307179586};
        const Path path = path_of(motion, Machine(), 0.0025);
        ASSERT_LE(path.legs.size(), 100'000U);
        const Leg& leg = path.legs.front();
        const double chord = std::hypot(leg.positions[1][0] - leg.positions[0][0],
                                        leg.positions[1][1] - leg.positions[0][1]);
        EXPECT_GE(leg.path_error, chord * chord / (8.0 * radius)) << radius;
        EXPECT_EQ(leg.path_error > 0.0025, radius > 1e7);
    }
}

} // namespace
} // namespace core
