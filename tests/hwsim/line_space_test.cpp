#include <gtest/gtest.h>

#include "hwsim/stock_model.h"

namespace hwsim {
namespace {

TEST(LineSpace, BreaksUpALongRunBeforeItIsFull) {
    LineSpace space{.end = 8};
    ASSERT_EQ(take(space, 8), (LineRun{0, 8}));
    EXPECT_FALSE(take(space, 1));
    give_back(space, {0, 8});
    EXPECT_EQ(take(space, 3), (LineRun{0, 3}));
    EXPECT_EQ(take(space, 5), (LineRun{3, 5}));
    EXPECT_FALSE(take(space, 1));
}

TEST(ModelTree, RefusesRecordsThatDoNotFit) {
    constexpr int32_t most = Record::greatest_extent;
    const auto is_taken = [](const Record& record) {
        LineSpace space{.end = 8};
        ModelWriter writer{.space = &space, .epoch = 1};
        return add_tree(writer, {record}, 1).has_value();
    };
    EXPECT_TRUE(is_taken({{0, 0, 0}, most, most}));
    EXPECT_FALSE(is_taken({{0, 0, 0}, most + 1, 0}));
    EXPECT_FALSE(is_taken({{0, 0, 0}, 0, most + 1}));
    EXPECT_FALSE(is_taken({{0, 0, 0}, -1, 0}));
    EXPECT_FALSE(is_taken({{0, 0, 0}, 0, -1}));
    EXPECT_TRUE(is_taken({{least_coordinate + 5, greatest_coordinate - 5, 0}, 0, 5}));
    EXPECT_FALSE(is_taken({{least_coordinate + 4, 0, 0}, 0, 5}));
    EXPECT_FALSE(is_taken({{0, greatest_coordinate - 4, 0}, 0, 5}));
    EXPECT_FALSE(is_taken({{0, 0, greatest_coordinate - 4}, 5, 0}));
}

} // namespace
} // namespace hwsim
