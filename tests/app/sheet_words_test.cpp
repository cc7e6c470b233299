#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "app/report/sheet/sheet_words.h"
#include "core/geom/mesh.h"
#include "core/sim/setup.h"

namespace app {
namespace {

constexpr SheetUnit metric{false}, inches{true};

core::Solid solid_of(const core::Aabb& box) { return {core::SolidBox{box}}; }

TEST(SheetUnit, RoundsToTheNearestAndLimitsUpwards) {
    EXPECT_EQ(metric.length(12.3456), "12.346");
    EXPECT_EQ(metric.length(-0.0001), "0");
    EXPECT_EQ(metric.signed_length(0.5), "+0.5");
    EXPECT_EQ(metric.signed_length(-0.5), "-0.5");
    EXPECT_EQ(inches.length(25.4), "1");
    EXPECT_EQ(inches.length(3.175), "0.125");
    EXPECT_EQ(metric.at_least(41.601), "41.61");
    EXPECT_EQ(metric.at_least(41.6), "41.6");
    EXPECT_EQ(inches.at_least(25.401), "1.0001");
}

TEST(PlaceOnStock, SaysItInTheWordsOfTheShop) {
    const auto place = [](const core::Vec3& low, const core::Vec3& high) {
        return place_on_stock({low, high}, false, metric);
    };
    EXPECT_EQ(place({0, 0, -20}, {100, 50, 0}), "the left front top corner of the stock");
    EXPECT_EQ(place({-100, -50, 0}, {0, 0, 20}), "the right back bottom corner of the stock");
    EXPECT_EQ(place({-50, -25, -20}, {50, 25, 0}), "the centre of the top of the stock");
    EXPECT_EQ(place({0, -25, -10}, {50, 25, 10}), "the centre of the left side of the stock");
    EXPECT_EQ(place({-50, 0, -20}, {50, 25, 0}), "the middle of the front top edge of the stock");
    EXPECT_EQ(place({-50, -25, -10}, {50, 25, 10}), "the centre of the stock");
    EXPECT_EQ(place({-50, -25, -21}, {50, 25, -1}), "Z+1 from the centre of the top of the stock");
    EXPECT_EQ(place({-5, 2, -20}, {95, 52, 0}),
              "X+5 Y-2 from the left front top corner of the stock");
    EXPECT_EQ(place_on_stock({{-30, -30, -20}, {20, 20, 0}}, true, metric),
              "X+5 Y+5 from the centre of the top of the stock");
    EXPECT_EQ(place_on_stock({{-25.4, 0, -20}, {100, 50, 0}}, false, inches),
              "X+1 from the left front top corner of the stock");
}

/// The corners of a box with their names.
std::vector<std::pair<std::string, core::Vec3>> corners(const core::Aabb& box) {
    std::vector<std::pair<std::string, core::Vec3>> all;
    for (const bool x : {false, true})
        for (const bool y : {false, true})
            for (const bool z : {false, true})
                all.emplace_back(fmt::format("the {} {} {} corner of the stock",
                                             x ? "right" : "left", y ? "back" : "front",
                                             z ? "top" : "bottom"),
                                 core::Vec3(x ? box.max.x : box.min.x, y ? box.max.y : box.min.y,
                                            z ? box.max.z : box.min.z));
    return all;
}

/// Without a zero in the middle, the nearest corner and the way from there to zero are named.
TEST(PlaceOnStock, NamesTheNearestCorner) {
    std::mt19937 random(20);
    std::uniform_real_distribution<double> at(-100.0, 100.0), size(5.0, 120.0);
    for (int i = 0; i < 500; ++i) {
        const core::Vec3 low(at(random), at(random), at(random));
        const core::Aabb box{low, low + core::Vec3(size(random), size(random), size(random))};
        std::string nearest;
        double least = core::infinity;
        for (const auto& [name, corner] : corners(box)) {
            if (glm::length(corner) >= least) continue;
            least = glm::length(corner);
            nearest =
                fmt::format("X{} Y{} Z{} from {}", metric.signed_length(-corner.x),
                            metric.signed_length(-corner.y), metric.signed_length(-corner.z), name);
        }
        EXPECT_EQ(place_on_stock(box, false, metric), nearest);
    }
}

TEST(StockExtents, FollowQuarterTurnsOnly) {
    const core::Solid stock = solid_of({{0, 0, -20}, {100, 50, 0}});
    const core::Transform quarter{core::rotation_xyz_deg({0, 0, 90}), {10, 0, 0}};
    const auto turned = stock_extents(stock, quarter);
    ASSERT_TRUE(turned);
    EXPECT_EQ(turned->min, core::Vec3(-40, 0, -20));
    EXPECT_EQ(turned->max, core::Vec3(10, 100, 0));
    EXPECT_FALSE(stock_extents(stock, {core::rotation_xyz_deg({0, 0, 30}), {}}));
    const core::Solid bar{core::SolidCylinder{{}, 10.0, 50.0, 0}};
    EXPECT_FALSE(is_round_about_z(bar, {}));
    EXPECT_TRUE(is_round_about_z(bar, {core::rotation_xyz_deg({0, 90, 0}), {}}));
}

/// A turned body is as large as its own corners say, not as the box of its box.
TEST(ExtentsOf, AreThoseOfTheTurnedBody) {
    std::mt19937 random(21);
    std::uniform_real_distribution<double> angle(-180.0, 180.0), place(-50.0, 50.0);
    const core::Aabb box{{-10, -20, 0}, {30, 5, 12}};
    const core::ExactBody bodies[] = {core::convex(box), core::solid_mesh(core::mesh_of(box))};
    for (int i = 0; i < 200; ++i) {
        const core::Transform pose{
            core::rotation_xyz_deg({angle(random), angle(random), angle(random)}),
            {place(random), place(random), place(random)}};
        core::Aabb slow;
        for (const auto& [name, corner] : corners(box)) slow.extend(pose * corner);
        for (const core::ExactBody& body : bodies) {
            const core::Aabb found = extents_of(body, pose);
            EXPECT_LT(glm::length(found.min - slow.min), 1e-9);
            EXPECT_LT(glm::length(found.max - slow.max), 1e-9);
        }
    }
}

core::Setup with_fixtures(const std::vector<core::Aabb>& boxes) {
    core::Setup setup;
    for (const core::Aabb& box : boxes)
        setup.fixtures.push_back({.name = "jaw", .body = core::convex(box)});
    return setup;
}

TEST(HeightAboveJaws, NeedsTwoThatHoldOppositeSides) {
    const core::Aabb stock{{0, 0, -20}, {100, 50, 0}};
    const core::Aabb left{{-30, 0, -60}, {0, 50, -12}}, right{{100, 0, -60}, {130, 50, -15}},
        front{{0, -30, -60}, {100, 0, -12}}, higher{{100, 0, -60}, {130, 50, 5}},
        beside{{100, 60, -60}, {130, 90, -15}}, below{{0, 0, -60}, {100, 50, -20}};
    const auto height = [&](const std::vector<core::Aabb>& boxes) {
        const core::Setup setup = with_fixtures(boxes);
        return height_above_jaws(placed_fixtures(setup, {}), stock);
    };
    EXPECT_EQ(height({left, right, below}), 12.0);
    EXPECT_FALSE(height({left}));
    EXPECT_FALSE(height({left, front}));
    EXPECT_FALSE(height({left, higher}));
    EXPECT_FALSE(height({left, beside}));
    EXPECT_FALSE(height({}));
    const auto of_meshes = [&](const std::string& name) {
        core::Setup setup;
        for (const core::Aabb& box : {left, right})
            setup.fixtures.push_back({.name = name, .body = core::solid_mesh(core::mesh_of(box))});
        return height_above_jaws(placed_fixtures(setup, {}), stock);
    };
    EXPECT_EQ(of_meshes("fixed-jaw"), 12.0);
    EXPECT_FALSE(of_meshes("step block"));
}

} // namespace
} // namespace app
