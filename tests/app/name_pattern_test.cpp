#include <gtest/gtest.h>

#include "app/library/find/name_pattern.h"

namespace app {
namespace {

TEST(NamePattern, MatchesNames) {
    EXPECT_TRUE(matches_pattern("*", "part.nc"));
    EXPECT_TRUE(matches_pattern("*.nc", "part.nc"));
    EXPECT_TRUE(matches_pattern("p?rt.[nm]c", "part.nc"));
    EXPECT_TRUE(matches_pattern("O[0-9]*", "O1000"));
    EXPECT_TRUE(matches_pattern("[]x]", "]"));
    EXPECT_TRUE(matches_pattern("a*b*c", "a-b-b-c"));
    EXPECT_TRUE(matches_pattern("", ""));
    EXPECT_TRUE(matches_pattern("**", ""));
    EXPECT_FALSE(matches_pattern("*.nc", "part.txt"));
    EXPECT_FALSE(matches_pattern("*.nc", ".nc"));
    EXPECT_TRUE(matches_pattern(".*", ".nc"));
    EXPECT_FALSE(matches_pattern("?", ""));
    EXPECT_FALSE(matches_pattern("[!0-9]", "5"));
    EXPECT_TRUE(matches_pattern("[!0-9]", "x"));
    EXPECT_FALSE(matches_pattern("abc", "ab"));
    EXPECT_FALSE(matches_pattern("ab", "abc"));
    EXPECT_TRUE(matches_pattern("[a", "[a"));
}

TEST(NamePattern, CountsCharactersAndNotBytes) {
    EXPECT_TRUE(matches_pattern("?.nc", "\u00fc.nc"));
    EXPECT_TRUE(matches_pattern("[\u00e0-\u00ff].nc", "\u00fc.nc"));
    EXPECT_FALSE(matches_pattern("[\u00e0-\u00ff].nc", "u.nc"));
    EXPECT_TRUE(matches_pattern("[!a].nc", "\U0001F527.nc"));
    EXPECT_TRUE(matches_pattern("\u6587*", "\u6587\u4ef6.nc"));
    EXPECT_TRUE(matches_pattern("?", "\xfc")) << "not UTF-8";
    EXPECT_TRUE(matches_pattern("\xfc", "\xfc"));
    EXPECT_FALSE(matches_pattern("?", "\xfc\xfc"));
    EXPECT_TRUE(matches_pattern("\xe6\x96?", "\xe6\x96z")) << "ends within a character";
    EXPECT_FALSE(matches_pattern("?", "\xc0\xaf")) << "longer than need be";
    EXPECT_FALSE(matches_pattern("?", "\xed\xa0\x80")) << "a surrogate";
    EXPECT_FALSE(matches_pattern("?", "\xf4\x90\x82\x80")) << "beyond U+10FFFF";
}

TEST(NamePattern, KnowsClassesAndEscapes) {
    EXPECT_TRUE(matches_pattern("[[:alpha:]]*.nc", "part.nc"));
    EXPECT_FALSE(matches_pattern("[[:alpha:]]*.nc", "1part.nc"));
    EXPECT_TRUE(matches_pattern("O[![:alpha:]_]", "O7"));
    EXPECT_TRUE(matches_pattern("a\\*", "a*"));
    EXPECT_FALSE(matches_pattern("a\\*", "ab"));
    EXPECT_TRUE(matches_pattern("[a\\]b]", "]"));
    EXPECT_TRUE(matches_pattern("a[b-]", "a-"));
    EXPECT_FALSE(matches_pattern("[.]nc", ".nc"));
}

TEST(NamePattern, TakesLittleTimeForManyStars) {
    std::string pattern;
    for (int i = 0; i < 200; ++i) pattern += "a*";
    EXPECT_FALSE(matches_pattern(pattern + "b", std::string(5000, 'a')));
    EXPECT_TRUE(matches_pattern(pattern, std::string(5000, 'a')));
}

} // namespace
} // namespace app
