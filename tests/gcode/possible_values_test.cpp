#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "gcode/language/expression.h"

namespace gcode {
namespace {

using enum Operation;

constexpr Operation comparisons[] = {equal, not_equal,    greater, greater_or_equal,
                                     less,  less_or_equal};

/// The outcome on the control, with equality as on LinuxCNC.
bool holds(Operation operation, Value a, Value b, double equality) {
    const double left = a.value_or(0.0), right = b.value_or(0.0);
    const bool same = a && b ? std::abs(left - right) <= equality : !a && !b;
    switch (operation) {
    case equal:
        return same;
    case not_equal:
        return !same;
    case greater:
        return left > right;
    case greater_or_equal:
        return left >= right;
    case less:
        return left < right;
    default:
        return left <= right;
    }
}

TEST(PossibleValues, AreEmptyExactlyIfNoValueHasAllOutcomes) {
    std::mt19937 random(1);
    const auto pick = [&](int count) {
        return std::uniform_int_distribution<int>(0, count - 1)(random);
    };
    std::vector<Value> all = {std::nullopt};
    for (int i = -20; i <= 60; ++i) all.emplace_back(0.05 * i);
    int empty_count = 0;
    for (int run = 0; run < 2000; ++run) {
        const bool may_be_vacant = pick(2) == 0;
        const double equality = pick(2) == 0 ? 0.0 : 0.12; // between two of the values
        PossibleValues values(may_be_vacant);
        std::vector<Value> left = all;
        if (!may_be_vacant) left.erase(left.begin());
        for (int i = 0; i < 5; ++i) {
            const Value with = pick(12) == 0 ? Value() : Value(0.5 * pick(4));
            const ValueComparison comparison{comparisons[pick(6)], "#500", with};
            const bool outcome = pick(2) == 0;
            values = values.where(comparison, equality, outcome);
            std::erase_if(left, [&](const Value& value) {
                return holds(comparison.operation, value, with, equality) != outcome;
            });
            EXPECT_EQ(values.is_empty(), left.empty()) << run << " " << i;
        }
        empty_count += left.empty();
    }
    EXPECT_GT(empty_count, 200);
    EXPECT_LT(empty_count, 1900);
}

} // namespace
} // namespace gcode
