#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/iso/plain_words.h"
#include "gcode/language/language.h"

namespace gcode {
namespace {

/// A line that usually consists of words, with blanks and points in right and wrong positions.
std::string random_line(std::mt19937& random) {
    constexpr std::string_view letters = "GXYZIJKFNMSTOPQRgxyz";
    constexpr std::string_view numbers[] = {"1",
                                            "-1",
                                            "+2.5",
                                            ".5",
                                            "7.",
                                            "-.25",
                                            "0",
                                            "-0.",
                                            "65",
                                            "66.1",
                                            "1 2",
                                            "3 .5",
                                            "- 4",
                                            "1.2.3",
                                            "",
                                            "123456789012345",
                                            "1234567890123456",
                                            "0.1",
                                            "00000000000000000001.5",
                                            "\t5",
                                            "0.000000000000001"};
    std::string line;
    for (auto count = random() % 6; count > 0; --count) {
        line += letters[random() % letters.size()];
        line += std::string(random() % 2, ' ');
        line += numbers[random() % std::size(numbers)];
        line += std::string(random() % 2, ' ');
    }
    return line;
}

TEST(PlainWords, AreThoseOfTheGeneralParser) {
    std::mt19937 random(1);
    int taken = 0;
    for (int round = 0; round < 100'000; ++round) {
        const DialectId id = round % 2 == 0 ? DialectId::linuxcnc : DialectId::fanuc;
        const std::string line = random_line(random);
        Block plain, general;
        if (!read_plain_words(line, 7, dialect(id), plain)) continue;
        ++taken;
        // A comment is not a plain word, so this line takes the general path.
        const auto parsed = parse_line(line + "()", 7, dialect(id), general);
        ASSERT_TRUE(parsed) << line << ": " << parsed.error().message;
        ASSERT_EQ(plain.words, general.words) << line;
        for (size_t i = 0; i < plain.words.size(); ++i) {
            EXPECT_EQ(plain.words[i].span.column, general.words[i].span.column) << line;
            EXPECT_EQ(plain.words[i].span.length, general.words[i].span.length) << line;
            EXPECT_EQ(plain.words[i].span.line, 7u);
        }
    }
    EXPECT_GT(taken, 20'000);
}

TEST(PlainWords, LeaveEverythingElseToTheGeneralParser) {
    for (const char* line : {"G1 X[1]", "G1 X#1", "(a)", "G1 X1 ;", "/G1", "O1", "X1 X2", "#1=2",
                             "G65 P1", "G1 X", "X1.2.3", "%", "G1,R2"}) {
        Block block;
        EXPECT_FALSE(read_plain_words(line, 1, dialect(DialectId::fanuc), block)) << line;
    }
}

} // namespace
} // namespace gcode
