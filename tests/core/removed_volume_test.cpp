#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/dbm/cut_model.h"

namespace core {
namespace {

constexpr double h = 0.5, fraction = 0.01, pi = std::numbers::pi;

/// A block with a random position of its grid relative to the cuts.
CutModel block_anywhere(std::mt19937& rng, const Vec3& size) {
    std::uniform_real_distribution<double> off(0.0, h);
    const Vec3 low(-off(rng) - 2.0, -off(rng) - 2.0, -size.z - off(rng));
    const Vec3 high(size.x + 2.0 + off(rng), size.y + 2.0 + off(rng), 0.0);
    return make_cut_model({SolidBox{{low, high}}, 0.0}, h).value();
}

std::shared_ptr<const Cutter> cutter(const RevolvedProfile& profile) {
    return std::make_shared<const Cutter>(make_cutter(profile, 0.0));
}

RevolvedProfile flat(double radius) { return {{{0, radius, 40, radius, 0}}}; }

TEST(RemovedVolume, IsThatOfARoundHole) {
    std::mt19937 rng(901);
    std::uniform_real_distribution<double> position(9.0, 11.0);
    for (double diameter = 3.0; diameter <= 12.0; diameter += 0.75)
        for (int i = 0; i < 4; ++i) {
            CutModel model = block_anywhere(rng, {20, 20, 25});
            const Vec3 at(position(rng), position(rng), 0.0);
            const double depth = position(rng), r = 0.5 * diameter;
            double removed = 0.0;
            for (int peck = 1; peck <= 3; ++peck)
                removed += cut(model, {cutter(flat(r)), at + Vec3(0, 0, 1),
                                       at - Vec3(0, 0, depth * peck / 3.0)});
            const double truth = pi * r * r * depth;
            EXPECT_NEAR(removed, truth, fraction * truth) << diameter << ' ' << i;
        }
}

TEST(RemovedVolume, IsThatOfADrilledHole) {
    std::mt19937 rng(905);
    std::uniform_real_distribution<double> position(9.0, 11.0);
    for (double diameter = 3.0; diameter <= 12.0; diameter += 0.5)
        for (int i = 0; i < 3; ++i) {
            CutModel model = block_anywhere(rng, {20, 20, 25});
            const double r = 0.5 * diameter, tip = r / std::tan(59.0 * pi / 180.0);
            const RevolvedProfile drill{{{0, 0, tip, r, 0}, {tip, r, 50, r, 0}}};
            const Vec3 at(position(rng), position(rng), 0.0);
            const double depth = tip + position(rng);
            double removed = 0.0;
            for (int peck = 1; peck <= 3; ++peck)
                removed += cut(model, {cutter(drill), at + Vec3(0, 0, 1),
                                       at - Vec3(0, 0, depth * peck / 3.0)});
            const double truth = pi * r * r * (depth - tip * 2.0 / 3.0);
            EXPECT_NEAR(removed, truth, fraction * truth) << diameter << ' ' << i;
        }
}

TEST(RemovedVolume, IsThatOfASlotInAnyDirection) {
    std::mt19937 rng(902);
    std::uniform_real_distribution<double> position(-0.5, 0.5), turn(0.0, 2.0 * pi),
        width(3.0, 9.0);
    for (int i = 0; i < 60; ++i) {
        CutModel model = block_anywhere(rng, {50, 50, 15});
        const double angle = i % 4 ? turn(rng) : 0.5 * pi * (i % 16) / 4.0;
        const double w = width(rng), depth = 6.0 + 2.0 * position(rng), length = 18.0;
        const Vec3 middle(25 + position(rng), 25 + position(rng), -depth);
        const Vec3 half = 0.5 * length * Vec3(std::cos(angle), std::sin(angle), 0.0);
        const double removed = cut(model, {cutter(flat(0.5 * w)), middle - half, middle + half});
        const double truth = depth * (w * length + 0.25 * pi * w * w);
        EXPECT_NEAR(removed, truth, fraction * truth) << i << ' ' << angle << ' ' << w;
    }
}

TEST(RemovedVolume, IsThatOfARoundGroove) {
    std::mt19937 rng(903);
    std::uniform_real_distribution<double> position(-0.5, 0.5), turn(0.0, 2.0 * pi), size(1.8, 5.0);
    for (int i = 0; i < 40; ++i) {
        CutModel model = block_anywhere(rng, {60, 60, 15});
        const double angle = turn(rng), r = size(rng), length = 20.0;
        const RevolvedProfile ball{{{r, 0, r, 0, r}, {r, r, 40, r, 0}}};
        const Vec3 middle(30 + position(rng), 30 + position(rng), -r);
        const Vec3 half = 0.5 * length * Vec3(std::cos(angle), std::sin(angle), 0.0);
        const double removed = cut(model, {cutter(ball), middle - half, middle + half});
        const double truth = 0.5 * pi * r * r * length + 2.0 / 3.0 * pi * r * r * r;
        EXPECT_NEAR(removed, truth, fraction * truth) << i << ' ' << angle << ' ' << r;
    }
}

TEST(RemovedVolume, IsThatOfARoundPocketCutInRings) {
    std::mt19937 rng(904);
    std::uniform_real_distribution<double> position(-0.5, 0.5);
    for (int i = 0; i < 6; ++i) {
        CutModel model = block_anywhere(rng, {50, 50, 15});
        const double depth = 5.0 + position(rng);
        const Vec3 centre(25 + position(rng), 25 + position(rng), -depth);
        double removed = cut(model, {cutter(flat(3)), centre + Vec3(0, 0, 9), centre});
        constexpr int chords = 90;
        double truth = 0.0;
        for (double ring = 4.0; ring <= 12.0; ring += 4.0) {
            // The chords form a polygon; the cutter rounds its corners.
            const double side = 2.0 * ring * std::sin(pi / chords);
            truth = depth
                    * (0.5 * chords * ring * ring * std::sin(2.0 * pi / chords)
                       + chords * side * 3.0 + pi * 9.0);
            for (int k = 0; k < chords; ++k) {
                const auto at = [&](int n) {
                    const double angle = 2.0 * pi * n / chords;
                    return centre + ring * Vec3(std::cos(angle), std::sin(angle), 0.0);
                };
                const double now = cut(model, {cutter(flat(3)), at(k), at(k + 1)});
                ASSERT_GE(now, 0.0);
                removed += now;
            }
        }
        EXPECT_NEAR(removed, truth, 0.004 * truth) << i;
    }
}

} // namespace
} // namespace core
