#include <gtest/gtest.h>

#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"

namespace core {
namespace {

constexpr double centre_radius = 2.5, recess = 0.625;

/// A block with its top at Z 0 and a 10 mm end mill that does not cut within 2.5 mm of its axis.
struct Shop {
    Setup setup;
    std::optional<SimulatorState> state;
    uint32_t block = 0;
    Vec3 tip = Vec3(50, 50, 20);

    explicit Shop(bool cuts_at_centre = false) {
        setup.stock = {SolidBox{{{0, 0, -30}, {100, 100, 0}}}, 0.0};
        ToolDescription tool;
        tool.number = ToolNumber{1};
        tool.diameter = 10;
        tool.flute_length = 25;
        tool.stick_out = 60;
        tool.cuts_at_centre = cuts_at_centre;
        tool.centre_radius = cuts_at_centre ? 0.0 : centre_radius;
        setup.tools.emplace(tool.number, *assemble(tool));
        state = *start_of_run(setup, {});
        give({ToolChange{ToolNumber{1}}});
        give({SpindleChange{SpindleDirection::clockwise, 6000.0}});
    }

    BlockResult give(const std::vector<Event>& events) {
        return run_block(setup, {BlockIndex{block++}, false, events}, *state);
    }
    /// Whether the block crashes. Every collision here is one of the flutes.
    bool crashes(MotionKind kind, const Vec3& to) {
        const double length = setup.tools.at(ToolNumber{1}).length;
        const auto at = [&](const Vec3& p) { return AxisPosition{p.x, p.y, p.z + length}; };
        const BlockResult result =
            give({Motion{.kind = kind, .from = at(tip), .to = at(to), .feed = 600.0}});
        tip = to;
        return result.verdict == Verdict::collision;
    }
    bool feed(const Vec3& to) { return crashes(MotionKind::feed, to); }
    bool rapid(const Vec3& to) { return crashes(MotionKind::rapid, to); }

    /// Moves down a helix of chords. Returns the Z of the first crash, or of the end.
    double wind(double radius, double pitch, double depth) {
        feed({50 + radius, 50, 0.5});
        constexpr int chords = 48;
        for (int i = 1; tip.z > -depth; ++i) {
            const double angle = 2.0 * 3.14159265358979 * i / chords;
            if (feed({50 + radius * std::cos(angle), 50 + radius * std::sin(angle),
                      0.5 - pitch * i / chords}))
                return tip.z;
        }
        return tip.z;
    }
};

TEST(CentreTracker, FindsAPlungeOnTheCentre) {
    Shop shop;
    shop.feed({50, 50, 1});
    const double length = shop.setup.tools.at(ToolNumber{1}).length;
    const BlockResult result = shop.give({Motion{.kind = MotionKind::feed,
                                                 .from = {50, 50, 1 + length},
                                                 .to = {50, 50, -9 + length},
                                                 .feed = 600.0}});
    EXPECT_EQ(result.verdict, Verdict::collision);
    ASSERT_EQ(result.findings.size(), 1u);
    EXPECT_EQ(result.findings[0].rule, "collision");
    EXPECT_NE(result.findings[0].message.find("does not cut within 2.5 mm"), std::string::npos);
    ASSERT_TRUE(result.deciding);
    // Reported when the end face, not the cutting edges, reaches the stock: 1.625 mm of 10.
    EXPECT_NEAR(result.pairs[*result.deciding].time, 0.17 * result.duration,
                0.02 * result.duration);
    EXPECT_FALSE(Shop(true).feed({50, 50, -9}));
}

TEST(CentreTracker, FindsAPlungeInSmallSteps) {
    Shop shop;
    shop.feed({50, 50, 0});
    double z = 0.0;
    while (z > -2.0 && !shop.feed({50, 50, z -= 0.05})) {
    }
    EXPECT_NEAR(z, -recess - 0.1, 0.1);
}

TEST(CentreTracker, IsSilentWhereTheEdgesLeaveNothing) {
    Shop shop; // next to the stock, in the open, and across it
    EXPECT_FALSE(shop.rapid({-20, 50, 20}));
    EXPECT_FALSE(shop.feed({-20, 50, -5}));
    EXPECT_FALSE(shop.feed({120, 50, -5}));
    EXPECT_FALSE(shop.feed({120, 50, 20}));
    EXPECT_FALSE(shop.rapid({60, 50, 20}));
    EXPECT_FALSE(shop.feed({60, 50, -4.9})); // down into its own slot
}

TEST(CentreTracker, IsSilentInAHoleThatWasDrilled) {
    Shop shop(true);
    shop.feed({50, 50, -10});
    shop.rapid({50, 50, 20});
    ToolDescription blunt = shop.setup.tools.at(ToolNumber{1}).description;
    blunt.cuts_at_centre = false;
    blunt.centre_radius = centre_radius;
    shop.setup.tools.at(ToolNumber{1}).description = blunt;
    EXPECT_FALSE(shop.feed({50, 50, -10}));
    EXPECT_TRUE(shop.feed({50, 50, -12}));
}

TEST(CentreTracker, DistinguishesARampFromADive) {
    for (const double degrees : {2.0, 4.0, 6.5}) {
        Shop shop;
        shop.feed({20, 50, 0.2});
        EXPECT_FALSE(shop.feed({70, 50, 0.2 - 50 * std::tan(degrees / 57.29578)})) << degrees;
    }
    for (const double degrees : {10.0, 30.0, 60.0}) {
        Shop shop;
        shop.feed({20, 50, 0.2});
        const double z = -12.0;
        EXPECT_TRUE(shop.feed({20 + 12.2 / std::tan(degrees / 57.29578), 50, z})) << degrees;
    }
}

TEST(CentreTracker, IsSilentOnARampToAndFroThatIsLongEnough) {
    Shop shop;
    shop.feed({40, 50, 0});
    for (int i = 0; i < 10; ++i)
        EXPECT_FALSE(shop.feed({i % 2 ? 40.0 : 60.0, 50, -0.5 * (i + 1)})) << i;
    // On a path smaller than the non-cutting centre a pillar remains.
    Shop narrow;
    narrow.feed({40, 50, 0});
    bool found = false;
    for (int i = 0; i < 10; ++i)
        found = narrow.feed({i % 2 ? 40.0 : 42.0, 50, -0.2 * (i + 1)}) || found;
    EXPECT_TRUE(found);
}

TEST(CentreTracker, DistinguishesAHelixFromOneThatIsTooNarrow) {
    EXPECT_LT(Shop().wind(4.0, 0.8, 6.0), -5.9);
    EXPECT_LT(Shop().wind(3.0, 0.5, 4.0), -3.9);
    EXPECT_NEAR(Shop().wind(1.5, 0.5, 4.0), -recess, 0.3); // the pillar in the centre
    EXPECT_GT(Shop().wind(4.0, 6.0, 6.0), -2.0);           // too steep
}

TEST(CentreTracker, IsSilentOnASurfaceThatGoesUpAndDown) {
    Shop shop;
    shop.rapid({-10, 50, 20});
    shop.feed({-10, 50, -3});
    for (double x = -9.5; x < 110.0; x += 0.5)
        ASSERT_FALSE(shop.feed({x, 50, -3 + 2 * std::sin(0.05 * x)})) << x;
}

} // namespace
} // namespace core
