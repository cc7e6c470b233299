#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// The value that an expression assigns to #100.
double value_of_text(const std::string& text, DialectId dialect = DialectId::linuxcnc) {
    const Ran ran = run_text("#100=" + text + "\n", dialect);
    EXPECT_FALSE(ran.run.error) << text << ": " << (ran.run.error ? ran.run.error->message : "");
    return ran.run.state.parameters->numbered(100).value_or(-1e99);
}

TEST(Expression, BindsAsLinuxcncDoes) {
    const std::pair<std::string, double> truths[] = {
        {"[1+2*3-4/2]", 5},   {"[2**3**2]", 64},     {"[-2**2]", 4},        {"[-7 MOD 3]", 2},
        {"[2 LT 3 EQ 1]", 1}, {"[1 AND 0 OR 1]", 1}, {"[1 OR 1 XOR 1]", 0}, {"[2*[3+4]]", 14},
        {"-[3]", -3},         {"[10-4-3]", 3}};
    for (const auto& [text, truth] : truths) EXPECT_EQ(value_of_text(text), truth) << text;
}

TEST(Expression, HasItsFunctionsInDegrees) {
    const std::pair<std::string, double> truths[] = {
        {"FIX[-2.8]", -3},   {"FUP[-2.8]", -2},     {"ROUND[-2.5]", -3}, {"ROUND[2.5]", 3},
        {"SIN[30]", 0.5},    {"COS[60]", 0.5},      {"TAN[45]", 1},      {"SIN[180]", 0},
        {"COS[90]", 0},      {"ATAN[1]/[-1]", 135}, {"ASIN[0.5]", 30},   {"ACOS[0.5]", 60},
        {"ABS[-3]", 3},      {"SQRT[16]", 4},       {"EXP[0]", 1},       {"LN[EXP[2]]", 2},
        {"s q r t [1 6]", 4}};
    for (const auto& [text, truth] : truths) EXPECT_NEAR(value_of_text(text), truth, 1e-12) << text;
}

TEST(Expression, ComparesWithATolerance) {
    EXPECT_EQ(value_of_text("[5 EQ 5.00001]"), 1);
    EXPECT_EQ(value_of_text("[5 EQ 5.001]"), 0);
    EXPECT_EQ(value_of_text("[5 NE 5.00001]"), 0);
}

TEST(Expression, FanucBindsAndWithProductsAndWorksOnBits) {
    EXPECT_EQ(value_of_text("6 AND 3", DialectId::fanuc), 2);
    EXPECT_EQ(value_of_text("1+2*3", DialectId::fanuc), 7);
    EXPECT_EQ(value_of_text("ATAN[1,-1]", DialectId::fanuc), 135);
    EXPECT_EQ(value_of_text("POW[2,10]", DialectId::fanuc), 1024);
    EXPECT_EQ(value_of_text("BCD[25]", DialectId::fanuc), 0x25);
    EXPECT_EQ(value_of_text("BIN[37]", DialectId::fanuc), 25);
}

TEST(Expression, AVacantVariableIsNoWordAndNotZero) {
    EXPECT_EQ(trace("G0 X5\nY2 X#1"), "straight_traverse x=5 y=0 z=0\n"
                                      "straight_traverse x=5 y=2 z=0\n");
    EXPECT_EQ(value_of_text("[#1 EQ #0]", DialectId::fanuc), 1);
    EXPECT_EQ(value_of_text("[#1 EQ 0]", DialectId::fanuc), 0);
    EXPECT_EQ(value_of_text("[#1+3]", DialectId::fanuc), 3);
}

TEST(Expression, AssignmentsTakeEffectAfterTheLine) {
    EXPECT_EQ(trace("G21\n#3=5\n#3=6 G0 X#3 #4=#3\nG0 Y#4 Z#3", DialectId::linuxcnc),
              "straight_traverse x=5 y=0 z=0\nstraight_traverse x=5 y=5 z=6\n");
}

TEST(Expression, NamesWhatCannotBeComputed) {
    const auto refused = [](const std::string& text) {
        return error_of("#1=" + text, DialectId::linuxcnc);
    };
    EXPECT_EQ(refused("[1/0]"), "1:6: this is a division by zero: the value after '/' is 0");
    EXPECT_THAT(refused("SQRT[-1]"), HasSubstr("1:4: this is the square root of a negative"));
    EXPECT_THAT(refused("[1 + ]"), HasSubstr("1:9: ']' is not allowed here"));
    EXPECT_THAT(refused("[1+2"), HasSubstr("a ']' is missing"));
    EXPECT_THAT(refused("#<none>"), HasSubstr("#<none> is used before it is set"));
    EXPECT_THAT(refused("COSH[1]"), HasSubstr("there is no function 'COSH'"));
    EXPECT_THAT(refused(std::string(500, '[') + "1"), HasSubstr("nested too deeply"));
    EXPECT_THAT(refused("EXP[1000]"), HasSubstr("the result is too large"));
    EXPECT_THAT(error_of("#5.5=1", DialectId::linuxcnc), HasSubstr("whole numbers"));
}

} // namespace
} // namespace gcode
