#include <gtest/gtest.h>

#include "core/base/text.h"

namespace core {
namespace {

TEST(Text, ChangesTheCaseOfPlainLettersOnly) {
    EXPECT_EQ(upper_case("g1 x-0.5 \xC3\xA4"), "G1 X-0.5 \xC3\xA4");
    EXPECT_EQ(lower_case("CLAMP_2 [\xC3\x84]"), "clamp_2 [\xC3\x84]");
}

TEST(Text, LosesBlanksAtItsEndsOnly) {
    EXPECT_EQ(stripped("\t UNITS = mm "), "UNITS = mm");
    EXPECT_EQ(stripped(" \t"), "");
    EXPECT_EQ(stripped(""), "");
}

TEST(Text, CountsTheLettersThatDiffer) {
    EXPECT_EQ(edit_distance("diameter", "diametre"), 2U);
    EXPECT_EQ(edit_distance("", "flute"), 5U);
    EXPECT_EQ(nearest_name("shnak", {"flutes", "shank", "holder"}), "shank");
    EXPECT_EQ(nearest_name("shnak", {}), "");
}

} // namespace
} // namespace core
