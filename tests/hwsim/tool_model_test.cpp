#include <gtest/gtest.h>

#include "core/geom/gjk.h"
#include "hwsim/tool_model.h"
#include "tests/support/stock_oracle.h"

namespace hwsim {
namespace {

using core::RevolvedProfile;

/// Distance of a point from the profile, exactly but for rounding.
double outside(const RevolvedProfile& profile, const core::Vec3& p) {
    double least = core::infinity;
    for (const core::ProfileElement& element : profile.elements) {
        const auto apart = separation(core::convex(element), core::convex_segment(p, p));
        least = std::min(least, apart.lower);
    }
    return least;
}

bool holds(const std::vector<Record>& records, double r, double z) {
    for (const Record& record : records)
        if (r <= length_of(record.half) && z >= length_of(record.base[2])
            && z <= length_of(record.base[2] + record.run))
            return true;
    return false;
}

std::vector<RevolvedProfile> bodies() {
    std::vector<RevolvedProfile> all = test_support::cutters();
    all.push_back({{{-3, 0, -3, 0, 5}}});   // a ball below the origin
    all.push_back({{{2, 4, 2, 9, 1.5}}});   // a rounded disc with two rims
    all.push_back({{{0, 7, 0.4, 1, 0.3}}}); // a flat cone, wide side down, rounded
    all.push_back({{{1, 0, 90, 120, 0}}});  // a large one
    all.push_back({{{0, 20, 300, 20, 0}}}); // longer than one record
    return all;
}

TEST(CylindersRound, HoldEveryPointOfTheBody) {
    std::mt19937 rng(1);
    for (const RevolvedProfile& body : bodies()) {
        const std::vector<Record> records = cylinders_round(body, 0.05).value();
        const core::Aabb box = bounds(body);
        std::uniform_real_distribution<double> r(0.0, box.max.x), z(box.min.z, box.max.z);
        int inside = 0;
        for (int i = 0; i < 3'000; ++i) {
            const core::Vec3 p(r(rng), 0.0, z(rng));
            if (outside(body, p) > 0.0) continue;
            ++inside;
            ASSERT_TRUE(holds(records, p.x, p.z)) << p.x << " " << p.z;
        }
        EXPECT_GT(inside, 300);
    }
}

TEST(CylindersRound, ReachNoFartherThanTheTolerance) {
    for (const double tolerance : {0.5, 0.05, 0.005})
        for (const RevolvedProfile& body : bodies()) {
            const std::vector<Record> records = cylinders_round(body, tolerance).value();
            const double finest = bounds(body).size().z / 4096.0;
            for (const Record& record : records)
                for (const int32_t z : {record.base[2], record.base[2] + record.run}) {
                    const core::Vec3 rim(length_of(record.half), 0.0, length_of(z));
                    ASSERT_LE(outside(body, rim), std::max(tolerance, finest) + 2 * lsb);
                }
        }
}

TEST(CylindersRound, AreOneForACylinder) {
    const auto records = cylinders_round(RevolvedProfile{{{0, 3, 12, 3, 0}}}, 1e-3).value();
    ASSERT_EQ(records.size(), 1U);
    EXPECT_EQ(records[0], (Record{{0, 0, -1}, 12 * 4096 + 2, 3 * 4096 + 1}));
}

TEST(CylindersRound, RefuseWhatTheyCannotHold) {
    EXPECT_FALSE(cylinders_round(RevolvedProfile{}, 0.1));
    EXPECT_FALSE(cylinders_round(RevolvedProfile{{{0, 3, 12, 3, 0}}}, 0.0));
    EXPECT_FALSE(cylinders_round(RevolvedProfile{{{0, 300, 12, 300, 0}}}, 0.1));
    EXPECT_FALSE(cylinders_round(RevolvedProfile{{{0, 3, 3000, 3, 0}}}, 0.1));
}

TEST(CylindersRound, HoldTheCornersOfPosts) {
    const auto cylinders =
        cylinders_round(std::vector<Record>{{{7, -8, 9}, 5, 1000}, {{0, 0, 0}, 1, 0}});
    EXPECT_EQ(cylinders[0], (Record{{7, -8, 9}, 5, 1415}));
    EXPECT_EQ(cylinders[1], (Record{{0, 0, 0}, 1, 0}));
}

} // namespace
} // namespace hwsim
