#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

// Random programs with open premises. Their truth is that of the programs in which every premise is
// stated, for all combinations of values.

/// A premise that a program may contain, and how a set-up states each of its values.
struct Premise {
    const char* name;
    std::vector<std::string> statements;
};

const Premise length_change = {"length change",
                               {"[control]\n\"5006#6\" = 1\n", "[control]\n\"5006#6\" = 0\n"}};
const Premise variable = {"variable", {"\"#500\" = 1\n", "\"#500\" = 0\n"}};
const Premise input = {"input", {"\"#1000\" = 1\n", "\"#1000\" = 0\n"}};
const Premise deleted = {"block delete", {"block_delete = false\n", "block_delete = true\n"}};

class RandomProgram {
public:
    explicit RandomProgram(unsigned seed) : random_(seed) {
        text_ = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nG43 H1 G0 Z100.\nS1000 M3\n";
        for (int i = 0; i < 12; ++i) add_block();
        text_ += "G0 Z120.\nM30\n";
    }

    const std::string& text() const { return text_; }
    const std::vector<const Premise*>& premises() const { return premises_; }

private:
    double from(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    bool happens(double probability) { return from(0.0, 1.0) < probability; }
    std::string number(double low, double high) {
        char text[32];
        std::snprintf(text, sizeof text, "%.1f", from(low, high));
        return text;
    }
    void use(const Premise& premise) {
        if (std::find(premises_.begin(), premises_.end(), &premise) == premises_.end())
            premises_.push_back(&premise);
    }
    std::string move() {
        if (happens(0.5)) return "G0 Z" + number(-2.0, 120.0) + "\n";
        return "G0 X" + number(-10.0, 110.0) + " Y" + number(-10.0, 140.0) + "\n";
    }
    void add_branch(const std::string& condition) {
        const std::string label = std::to_string(++labels_ * 10);
        text_ += "IF[" + condition + "]GOTO" + label + "\n" + move() + "N" + label + " ";
        text_ += move();
    }
    void add_block() {
        if (happens(0.12)) {
            use(length_change);
            text_ += happens(0.5) ? "G49\n" : "G43 H1\n";
        } else if (happens(0.12)) {
            use(variable);
            add_branch("#500EQ1");
        } else if (happens(0.1)) {
            use(input);
            add_branch("#1000EQ1");
        } else if (happens(0.1)) {
            use(deleted);
            text_ += "/" + move();
        } else {
            text_ += move();
        }
    }

    std::mt19937 random_;
    std::string text_;
    std::vector<const Premise*> premises_;
    int labels_ = 0;
};

/// The set-up that states the chosen value of each premise.
SetupWriter stating(const std::vector<const Premise*>& premises, unsigned choice) {
    SetupWriter setup;
    std::string program = "dialect = \"fanuc\"\nstart = { X = -350, Y = -200, Z = 0 }\n";
    std::string values, control;
    for (size_t i = 0; i < premises.size(); ++i) {
        const std::string& statement = premises[i]->statements[choice >> i & 1U];
        if (premises[i] == &deleted)
            program += statement;
        else if (premises[i] == &length_change)
            control += statement;
        else
            values += statement;
    }
    setup.program(program).machine("rapid = \"straight\"\n" + SetupWriter::mill());
    if (!values.empty()) setup.also("[program.values]\n" + values);
    setup.also(control);
    setup.fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]\n");
    return setup;
}

int rank_of(const std::string& verdict) {
    constexpr const char* order[] = {"clear", "undecided", "violation", "collision"};
    return static_cast<int>(std::find(std::begin(order), std::end(order), verdict)
                            - std::begin(order));
}

class RandomPremises : public testing::TestWithParam<unsigned> {};

TEST_P(RandomPremises, TheVerdictIsTheWorstOfAllReadings) {
    const RandomProgram program(GetParam());
    const auto& premises = program.premises();
    SetupWriter open = stating({}, 0);
    const Checked result = check(open, program.text());
    ASSERT_NE(result.status, 2) << result.err << program.text();
    int worst = 0;
    bool any_error = false;
    for (unsigned choice = 0; choice < 1U << premises.size(); ++choice) {
        const Checked truth = check(stating(premises, choice), program.text());
        ASSERT_NE(truth.status, 2) << truth.err << program.text();
        EXPECT_EQ(truth.errors().find("open-premise"), std::string::npos) << truth.errors() << "\n"
                                                                          << program.text();
        worst = std::max(worst, rank_of(truth.verdict));
        any_error = any_error || truth.status == 1;
    }
    EXPECT_GE(rank_of(result.verdict), worst) << result.errors() << "\n" << program.text();
    EXPECT_GE(result.status == 1, any_error) << result.errors() << "\n" << program.text();
    // An input can change between two conditions, so the open check may find more.
    if (std::find(premises.begin(), premises.end(), &input) != premises.end()) return;
    EXPECT_EQ(rank_of(result.verdict), worst) << result.errors() << "\n" << program.text();
    EXPECT_EQ(result.status == 1, any_error) << result.errors() << "\n" << program.text();
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomPremises, testing::Range(1U, 25U));

} // namespace
} // namespace app_test
