#include <gtest/gtest.h>

#include "app/base/text.h"

namespace {

using app::utf8_text;

TEST(Utf8Text, LeavesUtf8AsItIs) {
    for (const char* text : {"", "G1 X5", "\xC3\xBC", "\xE2\x82\xAC 5", "\xF0\x9F\x94\xA7",
                             "\xED\x9F\xBF", "\xF4\x8F\xBF\xBF", "\t\x7F"})
        EXPECT_EQ(utf8_text(text), text);
}

TEST(Utf8Text, TakesOtherBytesForLatin1) {
    EXPECT_EQ(utf8_text("f\xFCr"), "f\xC3\xBCr");
    EXPECT_EQ(utf8_text("\xC4SER"), "\xC3\x84SER");
    EXPECT_EQ(utf8_text("\xC3"), "\xC3\x83") << "a character that is cut off";
    EXPECT_EQ(utf8_text("\xE2\x82"), "\xC3\xA2\xC2\x82");
    EXPECT_EQ(utf8_text("\xC0\x80"), "\xC3\x80\xC2\x80") << "longer than it need be";
    EXPECT_EQ(utf8_text("\xED\xA0\x80"), "\xC3\xAD\xC2\xA0\xC2\x80") << "half of a pair";
    EXPECT_EQ(utf8_text("\xF5\x80\x80\x80"), "\xC3\xB5\xC2\x80\xC2\x80\xC2\x80");
}

TEST(Utf8Text, CountsCharacters) {
    EXPECT_EQ(app::characters_in(""), 0U);
    EXPECT_EQ(app::characters_in("(\xc3\xa9\xe6\x97\xa5) "), 5U);
    EXPECT_EQ(app::characters_in("\xe9\xff"), 2U);
}

TEST(Utf8Text, GivesTheSameWhenItIsTakenAgain) {
    std::string all;
    for (int byte = 1; byte < 256; ++byte) all += static_cast<char>(byte);
    const std::string once = utf8_text(all);
    EXPECT_NE(once, all);
    EXPECT_EQ(utf8_text(once), once);
}

} // namespace
