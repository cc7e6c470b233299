#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/view/model/unit_words.h"
#include "tests/viewer/rows.h"

namespace viewer_test {
namespace {

using namespace app::viewer;

ViewModel in_inches() {
    ViewModel model;
    model.settings.inch = true;
    return model;
}

std::string inches(const std::string& words) { return words_in_unit(in_inches(), words); }

TEST(UnitWords, StayInMmInAWindowInMm) {
    const std::string words = "Retract 17.0 mm higher (keeps 2.000 mm).";
    EXPECT_EQ(words_in_unit(ViewModel(), words), words);
    EXPECT_EQ(positions_in_unit(ViewModel(), "X1 Y2"), "X1 Y2");
}

TEST(UnitWords, ChangeEveryLength) {
    EXPECT_EQ(inches("Retract 17.0 mm higher (keeps 2.000 mm)."),
              "Retract 0.669 in higher (keeps 0.07874 in).");
    EXPECT_EQ(inches("25.4 mm"), "1.000 in");
    EXPECT_EQ(inches("-254 mm, and 254 mm."), "-10.00 in, and 10.00 in.");
    EXPECT_EQ(inches("+2.54 mm"), "+0.1000 in");
    EXPECT_EQ(inches("(0 mm)"), "(0.00 in)");
}

TEST(UnitWords, ChangeAllNumbersOfAList) {
    EXPECT_EQ(inches("The overlap is 2.54 to 5.08 mm deep"),
              "The overlap is 0.1000 to 0.2000 in deep");
    EXPECT_EQ(inches("stock 254 x 127 x 25.4 mm"), "stock 10.00 x 5.00 x 1.000 in");
    EXPECT_EQ(inches("bounds 0.254 \xE2\x80\xA6 0.508 mm"),
              "bounds 0.01000 \xE2\x80\xA6 0.02000 in");
}

TEST(UnitWords, ChangeSpeedsButNotAreasAndVolumes) {
    EXPECT_EQ(inches("feed 254 mm/min"), "feed 10.00 in/min");
    EXPECT_EQ(inches("254 mm3, 254 mm2, 254 mmm"), "254 mm3, 254 mm2, 254 mmm");
}

TEST(UnitWords, LeaveOtherNumbersAlone) {
    for (const char* words :
         {"line 93, block 12", "parameter 1008#0 (ROA) is 0", "T3 mm", "turns 90 degrees",
          "G54.1 mm", "12 mm12", "", " mm", "mm", "1 to 2", "1.2.3", "-", "v1.2-3 mm"})
        EXPECT_EQ(inches(words), words) << words;
}

TEST(UnitWords, ChangePositionsWithTheirLetter) {
    EXPECT_EQ(positions_in_unit(in_inches(), "X25.4 Y0 Z-254 A90, rotated 3 deg"),
              "X1.000 Y0.00 Z-10.00 A90, rotated 3 deg");
    EXPECT_EQ(positions_in_unit(in_inches(), "MAX3 X"), "MAX3 X");
}

TEST(UnitWords, AgreeWithANumberForEveryLength) {
    std::mt19937 random(2);
    std::uniform_int_distribution<int> um(-2'000'000, 2'000'000);
    for (int i = 0; i < 2000; ++i) {
        const double mm = um(random) / 1000.0;
        EXPECT_EQ(inches(fmt::format("at {:.3f} mm;", mm)),
                  fmt::format("at {:.5f} in;", mm / 25.4 == 0.0 ? 0.0 : mm / 25.4));
    }
}

TEST(UnitWords, SurviveAnyText) {
    std::mt19937 random(9);
    const std::string letters = "0123456789.-+ mX,to#\xE2\x80\xA6";
    std::uniform_int_distribution<size_t> letter(0, letters.size() - 1), length(0, 40);
    for (int i = 0; i < 20000; ++i) {
        std::string words;
        for (size_t left = length(random); left > 0; --left) words += letters[letter(random)];
        EXPECT_GE(inches(words).size() + words.size(), words.size());
        static_cast<void>(positions_in_unit(in_inches(), words));
    }
    EXPECT_FALSE(inches(std::string(400, '9') + " mm").empty());
}

} // namespace
} // namespace viewer_test
