#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_run.h"
#include "app/debug/condition.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/dialect.h"
#include "gcode/language/environment.h"

namespace app_test {
namespace {

using app::Condition;
using testing::HasSubstr;

/// A rapid with T3 that comes within 0.4 mm of clamp-1 (minimum clearance 2 mm), and the state
/// before it.
struct OneBlock {
    app::CheckRun record;
    gcode::Environment environment;
    gcode::InterpreterState control;

    OneBlock() {
        record.dialect = environment.dialect = gcode::DialectId::fanuc;
        record.setup.fixtures.push_back({"clamp-1", core::ConvexShape{}});
        app::CheckedBlock block{
            core::BlockIndex{0}, 23, "/N210 G0 X10. Y-5. (to G81)", "", {7, 9}, {}};
        block.result.motion = core::BlockMotion::rapid;
        block.result.tool = core::ToolNumber{3};
        block.result.duration = 0.5;
        block.result.verdict = core::Verdict::violation;
        core::PairClearance pair;
        pair.pair = {core::PartKind::holder, 0, 0};
        pair.allowance.distance = 2.0;
        pair.lower = 0.4;
        pair.upper = 0.5;
        block.result.pairs = {pair};
        block.result.deciding = 0;
        record.blocks.push_back(block);
        block.result.pairs.clear();
        block.result.deciding.reset();
        block.result.motion = core::BlockMotion::none;
        record.blocks.push_back(block);
        core::Finding finding{
            "near-miss", core::Severity::error, core::BlockIndex{0}, "", "", {"holder", "clamp-1"},
            1.5};
        record.findings = {finding};
        control = gcode::initial_state(environment);
        control.modal.position = {{10.0, 20.0, -3.0}};
        control.modal.feed = 250.0;
        control.modal.plane = gcode::Plane::zx;
        control.parameters.write().set_numbered(100, 7.5);
        control.parameters.write().set_numbered(101, 0.1 + 0.2);
    }

    bool holds(const std::string& text, size_t block = 0) const {
        const auto condition = Condition::read(text);
        EXPECT_TRUE(condition) << text << ": " << (condition ? "" : condition.error().message);
        return condition && condition->holds({record, block, &control, &environment});
    }
};

TEST(Condition, KnowsNoClearanceOfABlockThatWasNotJudged) {
    OneBlock one;
    one.record.blocks.change(1, [](app::CheckedBlock& block) { block.result.checked = false; });
    for (const char* text : {"clearance > 1", "upper > 1", "margin > 0", "clearance < 1"})
        EXPECT_FALSE(one.holds(text, 1)) << text;
    EXPECT_EQ(app::evaluate("clearance", {one.record, 1})->text, "unknown");
}

TEST(Condition, MatchesARuleThatIsReportedAsPartOfAnother) {
    OneBlock one;
    std::swap(one.record.findings, one.record.combined_findings);
    EXPECT_TRUE(one.holds("near-miss"));
}

TEST(Condition, IsTrueOfABlockThatAnswersIt) {
    const OneBlock one;
    for (const char* text : {"clearance < 1 and rapid",
                             "clearance=0.4",
                             "upper == 0.5",
                             "clearance < upper",
                             "allowance = 2",
                             "margin < -1",
                             "margin = -1.5",
                             "line = 23",
                             "block = 0",
                             "depth = 2",
                             "duration >= .5",
                             "tool = 3",
                             "T3",
                             "t3 and N210",
                             "tool = T3",
                             "not feed",
                             "!(arc || cycle || none)",
                             "violation",
                             "not clear",
                             "near-miss",
                             "rule = near-miss",
                             "rule != air-cut",
                             "not near",
                             "finding and error",
                             "not warning",
                             "\"clamp-1\"",
                             "'HOLDER'",
                             "~ \"g81\"",
                             "~'y-5.'",
                             "motion = rapid",
                             "motion != feed",
                             "verdict = violation",
                             "0 < clearance < 1",
                             "1 > clearance > 0",
                             "feed > 200 and rapid",
                             "2 * feed - 100 = 400",
                             "F = 250",
                             "plane = ZX",
                             "plane = g18",
                             "plane <> XY",
                             "unit = mm",
                             "unit = \"G21\"",
                             "z < -2",
                             "x + y * 2 = 50",
                             "(x + y) * 2 = 60",
                             "[x + y] / 2 = 15",
                             "-z = 3",
                             "- - x = 10",
                             "10 - 3 - 2 = 5",
                             "12 / 3 / 2 = 2",
                             "#100 = 7.5",
                             "#100 EQ 7.5 AND #100 GT 7",
                             "#101 = 0.3",
                             "not (#33 = 1)",
                             "offset = G54",
                             "machine.x = 10",
                             "1000 > 999"})
        EXPECT_TRUE(one.holds(text)) << text;
    for (const char* text : {"feed",
                             "arc",
                             "clear",
                             "collision",
                             "clearance > 1",
                             "T4",
                             "N21",
                             "N2100",
                             "tool != 3",
                             "gouge",
                             "\"clamp-2\"",
                             "\"clamp\"",
                             "~ \"G82\"",
                             "0 < clearance < 0.3",
                             "rapid and not near-miss",
                             "1 / 0 = 1",
                             "not (1 / 0 = 1) and feed",
                             "plane = XY",
                             "#33 = 0",
                             "#33 != 0",
                             "H9 > 0",
                             "clearance < upper < 0.45"})
        EXPECT_FALSE(one.holds(text)) << text;
}

TEST(Condition, BindsNotBeforeAndBeforeOr) {
    const OneBlock one;
    EXPECT_TRUE(one.holds("rapid or feed and arc"));
    EXPECT_FALSE(one.holds("(rapid or feed) and arc"));
    EXPECT_FALSE(one.holds("not rapid and feed or arc"));
    EXPECT_TRUE(one.holds("not (rapid and feed) or arc"));
    EXPECT_TRUE(one.holds("not clearance > 1"));
}

TEST(Condition, TakesAnUnknownClearanceForLargerThanAnyNumber) {
    const OneBlock one;
    EXPECT_TRUE(one.holds("clearance > 1000000", 1));
    EXPECT_FALSE(one.holds("margin < 5", 1));
    EXPECT_FALSE(one.holds("allowance >= 0", 1));
    EXPECT_TRUE(one.holds("none", 1));
}

TEST(Condition, ReadsTheControlOnlyWhereItNamesIt) {
    for (const char* text : {"clearance < 1", "feed", "T3", "near-miss", "line = 3", "tool = 3"})
        EXPECT_FALSE(Condition::read(text)->uses_control()) << text;
    for (const char* text :
         {"feed > 1", "x < 3", "rapid and #100 = 1", "not (plane = XY)", "1 + 2 * G54.x < 3"})
        EXPECT_TRUE(Condition::read(text)->uses_control()) << text;
}

TEST(Condition, SaysWhereAndHowItIsWrong) {
    struct Wrong {
        const char* text;
        uint32_t column;
        const char* why;
    };
    for (const Wrong& wrong : std::initializer_list<Wrong>{
             {"", 1, "there is no condition"},
             {"clearence < 1", 1, "nearest name is 'clearance'"},
             {"rapid and near-mis", 11, "nearest name is 'near-miss'"},
             {"clearance", 1, "a number, not a condition"},
             {"plane", 1, "a word, not a condition"},
             {"clearance <", 12, "ends too early"},
             {"clearance < and rapid", 13, "a value is missing before 'and'"},
             {"(rapid or feed", 15, "')' of the bracket in column 1 is missing"},
             {"[1 + 2) = 3", 7, "']' of the bracket in column 1 is missing"},
             {"rapid) and feed", 6, "never opened"},
             {"rapid feed", 7, "'and' or 'or' is missing"},
             {"clearance < 1 2", 15, "'and' or 'or' is missing"},
             {"rapid < 1", 1, "true or false, not a number"},
             {"1 < rapid", 5, "true or false, not a number"},
             {"clearance and rapid", 1, "a number, not a condition"},
             {"plane < XY", 1, "only be compared with = and !="},
             {"plane = XZ", 9, "it may be G17"},
             {"motion = G1", 10, "it may be none, rapid, feed"},
             {"x < 1.2.3", 8, ""},
             {"x < 12abc", 5, "not a number"},
             {"# = 1", 1, "# must be followed by a number"},
             {"#<x = 1", 1, "a named parameter is written"},
             {"~ 3", 3, "~ must be followed by a text"},
             {"~ \"G81", 3, "quotation mark"},
             {"rapid @ feed", 7, "is not allowed here"},
             {"not 3", 5, "a number, not a condition"},
             {"-rapid = 1", 2, "not a number"}}) {
        const auto condition = Condition::read(wrong.text);
        ASSERT_FALSE(condition) << wrong.text;
        EXPECT_EQ(condition.error().where.column, wrong.column) << wrong.text;
        EXPECT_THAT(condition.error().message, HasSubstr(wrong.why)) << wrong.text;
    }
}

TEST(Condition, RefusesWhatIsNestedWithoutEnd) {
    for (const char* piece : {"(", "not ", "-", "!", "[", "+"}) {
        std::string text;
        for (int i = 0; i < 600; ++i) text += piece;
        EXPECT_FALSE(Condition::read(text + "x")) << piece;
    }
    EXPECT_FALSE(Condition::read(std::string(1'000'000, 'x')));
}

/// An expression as text and its value, made by the same random choices.
struct Written {
    std::string text;
    double number = 0.0;
    bool truth = false;
    int strength = 9; // of its outermost operator: 1 or, 2 and, 3 not, 4 comparison, 5 +, 6 *
};

class Writer {
public:
    explicit Writer(unsigned seed) : random_(seed) {}

    Written truth(int depth) {
        const int kind = depth <= 0 ? 3 : pick(4);
        if (kind == 0) return joined(truth(depth - 1), truth(depth - 1), "or", 1);
        if (kind == 1) return joined(truth(depth - 1), truth(depth - 1), "and", 2);
        if (kind == 2) {
            const Written inner = truth(depth - 1);
            return {"not " + bracketed(inner, 3), 0.0, !inner.truth, 3};
        }
        const Written left = number(depth - 1), right = number(depth - 1);
        const bool less = pick(2) == 0;
        return {bracketed(left, 5) + (less ? " < " : ">=") + bracketed(right, 5), 0.0,
                less ? left.number < right.number : left.number >= right.number, 4};
    }

private:
    int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }

    std::string bracketed(const Written& part, int least) {
        const bool needs = part.strength < least;
        return needs || pick(5) == 0 ? "(" + part.text + ")" : part.text;
    }

    Written joined(const Written& a, const Written& b, const char* sign, int strength) {
        return {bracketed(a, strength) + " " + sign + " " + bracketed(b, strength), 0.0,
                strength == 1 ? a.truth || b.truth : a.truth && b.truth, strength};
    }

    Written number(int depth) {
        const int kind = depth <= 0 ? 4 + pick(2) : pick(6);
        if (kind == 4) {
            const int value = pick(9);
            return {std::to_string(value), static_cast<double>(value), false, 9};
        }
        if (kind == 5) return {"#100", 7.5, false, 9};
        const Written a = number(depth - 1), b = number(depth - 1);
        if (kind == 0)
            return {bracketed(a, 5) + "+" + bracketed(b, 6), a.number + b.number, false, 5};
        if (kind == 1)
            return {bracketed(a, 5) + " - " + bracketed(b, 6), a.number - b.number, false, 5};
        if (kind == 2)
            return {bracketed(a, 6) + " * " + bracketed(b, 7), a.number * b.number, false, 6};
        return {"-" + bracketed(a, 7), -a.number, false, 7};
    }

    std::mt19937 random_;
};

TEST(Condition, MeansWhatItWasMadeFrom) {
    const OneBlock one;
    Writer writer(20);
    int holding = 0;
    constexpr int count = 3000;
    for (int i = 0; i < count; ++i) {
        const Written written = writer.truth(5);
        ASSERT_EQ(one.holds(written.text), written.truth) << written.text;
        holding += written.truth;
    }
    EXPECT_GT(holding, count / 4);
    EXPECT_LT(holding, count * 3 / 4);
}

TEST(Condition, SurvivesAnyText) {
    const OneBlock one;
    const std::string letters = "xT3#<>=!&|()[]+-*/~\"' .1andornotrapidG54plane$_,\t";
    std::mt19937 random(5);
    size_t readable = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text;
        const auto length = random() % 12;
        for (size_t j = 0; j < length; ++j) text += letters[random() % letters.size()];
        const auto condition = Condition::read(text);
        if (condition) {
            ++readable;
            condition->holds({one.record, 0, &one.control, &one.environment});
        } else {
            EXPECT_GE(condition.error().where.column, 1u) << text;
            EXPECT_LE(condition.error().where.column, text.size() + 1) << text;
        }
    }
    EXPECT_GT(readable, 10u);
}

TEST(Evaluate, GivesNumbersWordsAndTruth) {
    const OneBlock one;
    const Condition::Subject subject{one.record, 0, &one.control, &one.environment};
    EXPECT_EQ(app::evaluate("#100 * 2 + 1", subject)->text, "16");
    EXPECT_EQ(app::evaluate("clearance", subject)->text, "0.4");
    EXPECT_EQ(app::evaluate("plane", subject)->text, "G18");
    EXPECT_EQ(app::evaluate("rapid and T3", subject)->text, "true");
    EXPECT_EQ(app::evaluate("#33 + 1", subject)->text, "unknown");
    EXPECT_FALSE(app::evaluate("R5 + 1", subject)); // this control has # parameters
    EXPECT_EQ(app::evaluate("clearance", {one.record, 1})->text, "beyond the search limit");
}

} // namespace
} // namespace app_test
