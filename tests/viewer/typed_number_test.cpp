#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/view/model/typed_number.h"

namespace {

using namespace app::viewer;

double number(const std::string& text) {
    const auto value = typed_number(text);
    EXPECT_TRUE(value) << text << ": " << value.error().message;
    return value.value_or(std::nan(""));
}

std::string refusal(const std::string& text) {
    const auto value = typed_number(text);
    EXPECT_FALSE(value) << text << " was understood as " << value.value_or(0.0);
    return value ? "" : value.error().message;
}

TEST(TypedNumber, IsReadAsPeopleWriteIt) {
    EXPECT_EQ(number("12.5"), 12.5);
    EXPECT_EQ(number(" -350,5 "), -350.5);
    EXPECT_EQ(number("1,5"), 1.5);
    EXPECT_EQ(number("0,375"), 0.375);
    EXPECT_EQ(number(".5"), 0.5);
    EXPECT_EQ(number("4 3/4"), 4.75);
    EXPECT_EQ(number("-2 1/2"), -2.5);
    EXPECT_EQ(number("3/8"), 0.375);
    EXPECT_EQ(number("210/2"), 105.0);
    EXPECT_EQ(number("210/2-12"), 93.0);
    EXPECT_EQ(number("3*(4 + 5) - -1"), 28.0);
    EXPECT_EQ(number("\xE2\x88\x92"
                     "7"),
              -7.0)
        << "pasted from a text";
    EXPECT_EQ(number("1000000"), 1e6);
}

TEST(TypedNumber, IsRefusedIfItIsNotWhollyUnderstood) {
    for (const char* text : {"",        "  ",
                             "-",       "abc",
                             "12a",     "1.2.3",
                             "1,2,3",   "1.234,5",
                             "1e300",   "1e3",
                             "nan",     "inf",
                             "0x10",    "(1",
                             "1)",      "1 2",
                             "4 3",     "1/0",
                             "0/0",     "5mm",
                             "1000001", "99999999999999999999999999",
                             "1 / ",    "* 3"})
        refusal(text);
    EXPECT_THAT(refusal("1,234"), testing::HasSubstr("1.234 or 1234"));
    EXPECT_THAT(refusal("12,750"), testing::HasSubstr("12.750 or 12750"));
}

TEST(TypedNumber, OfALengthCanHaveAUnit) {
    const auto mm = [](const std::string& text, bool inch) {
        const auto value = typed_length(text, inch);
        EXPECT_TRUE(value) << text;
        return value.value_or(0.0);
    };
    EXPECT_EQ(mm("12", false), 12.0);
    EXPECT_EQ(mm("2", true), 50.8);
    EXPECT_EQ(mm("1.5in", false), 1.5 * 25.4);
    EXPECT_EQ(mm("1 1/2\"", false), 1.5 * 25.4);
    EXPECT_EQ(mm("1/2in", false), 12.7);
    EXPECT_EQ(mm("30 mm", true), 30.0);
    EXPECT_EQ(mm("2*30mm + 5 mm", true), 65.0);
    EXPECT_EQ(mm("1 inch / 4", false), 6.35);
    for (const char* text : {"1in + 5", "5 + 1in", "2mm * 3mm", "3 / 2mm", "5 ft"})
        EXPECT_FALSE(typed_length(text, false)) << text;
}

TEST(TypedNumber, TakesBackWhatAFieldShows) {
    std::mt19937 random(11);
    for (int i = 0; i < 2000; ++i) {
        const double value = (static_cast<double>(random()) / 4e9 - 0.5) * std::pow(10.0, i % 7);
        const std::string shown = field_text(value, 4);
        EXPECT_NEAR(number(shown), value, 0.51e-4) << shown;
        EXPECT_EQ(field_text(number(shown), 4), shown);
    }
    EXPECT_EQ(field_text(0.0, 4), "0");
    EXPECT_EQ(field_text(-0.00001, 4), "0");
    EXPECT_EQ(field_text(1200.0, 4), "1200");
    EXPECT_EQ(field_text(12.5, 4), "12.5");
}

} // namespace
