#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

using test_support::SetupWriter;

// Random programs with conditions on values that only the machine knows. The truth is found by
// running each program, as a list of statements, for all values that its conditions tell apart.

using Value = std::optional<double>; // empty: vacant

constexpr std::array<const char*, 4> variables = {"#500", "#501", "#1", "#2"};
constexpr std::array<const char*, 6> operators = {"EQ", "NE", "LT", "LE", "GT", "GE"};
constexpr std::array<size_t, 6> opposites = {1, 0, 5, 4, 3, 2};

struct Statement {
    enum class Kind { rise, sink, cross, set, copy, skip } kind = Kind::rise;
    size_t variable = 0, from = 0;
    size_t comparison = 0;
    double number = 0.0;
};

bool holds(size_t comparison, Value a, double b) {
    if (!a && comparison < 2) return comparison == 1;
    const double value = a.value_or(0.0);
    const bool results[] = {value == b, value != b, value<b, value <= b, value> b, value >= b};
    return results[comparison];
}

/// Whether the tool crosses the clamp while it is low.
bool crashes(const std::vector<Statement>& statements, std::array<Value, 4> values) {
    bool is_low = false;
    for (size_t i = 0; i < statements.size(); ++i) {
        const Statement& step = statements[i];
        using enum Statement::Kind;
        if (step.kind == rise) is_low = false;
        if (step.kind == sink) is_low = true;
        if (step.kind == cross && is_low) return true;
        if (step.kind == set) values[step.variable] = step.number;
        if (step.kind == copy) values[step.variable] = values[step.from];
        if (step.kind == skip && holds(step.comparison, values[step.variable], step.number)) ++i;
    }
    return false;
}

bool crashes_for_any_values(const std::vector<Statement>& statements, bool may_be_vacant) {
    std::vector<Value> each = {-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0};
    if (may_be_vacant) each.emplace_back();
    std::array<Value, 4> values;
    for (const Value a : each)
        for (const Value b : each)
            for (const Value c : each)
                for (const Value d : each) {
                    values = {a, b, c, d};
                    if (crashes(statements, values)) return true;
                }
    return false;
}

/// Whether the program crashes for some outcomes of its conditions, each free of the others.
bool crashes_for_any_outcomes(const std::vector<Statement>& statements, size_t from, bool is_low) {
    for (size_t i = from; i < statements.size(); ++i) {
        using enum Statement::Kind;
        if (statements[i].kind == rise) is_low = false;
        if (statements[i].kind == sink) is_low = true;
        if (statements[i].kind == cross && is_low) return true;
        if (statements[i].kind == skip && crashes_for_any_outcomes(statements, i + 2, is_low))
            return true;
    }
    return false;
}

std::vector<Statement> random_statements(unsigned seed) {
    std::mt19937 random(seed);
    const auto pick = [&](size_t count) {
        return std::uniform_int_distribution<size_t>(0, count - 1)(random);
    };
    using enum Statement::Kind;
    const auto move = [&] {
        constexpr Statement::Kind moves[] = {rise, sink, cross};
        return Statement{moves[pick(3)]};
    };
    // Few variables and numbers, so that conditions meet often.
    const auto variable = [&] { return pick(3) == 0 ? pick(variables.size()) : pick(2); };
    std::vector<Statement> statements;
    size_t conditions = 0;
    while (statements.size() < 14) {
        const size_t choice = pick(10);
        if (choice < 5 && conditions < 6) {
            ++conditions;
            statements.push_back({.kind = skip,
                                  .variable = variable(),
                                  .comparison = pick(operators.size()),
                                  .number = static_cast<double>(pick(3))});
            statements.push_back(
                pick(4) == 0 ? Statement{.kind = copy, .variable = variable(), .from = variable()}
                             : move());
        } else if (choice == 5) {
            statements.push_back({.kind = copy, .variable = variable(), .from = variable()});
        } else if (choice == 6) {
            statements.push_back(
                {.kind = set, .variable = variable(), .number = static_cast<double>(pick(3))});
        } else {
            statements.push_back(move());
        }
    }
    return statements;
}

std::string text_of(const std::vector<Statement>& statements, bool is_fanuc) {
    std::string text = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nG43 H1 G0 Z100.\nS1000 M3\n"
                       "G0 X50. Y50.\nG0 Z60.\n";
    std::string label, end; // of the condition before
    for (const Statement& step : statements) {
        using enum Statement::Kind;
        const std::string name = variables[step.variable];
        std::string line;
        switch (step.kind) {
        case rise:
            line = "G0 Z60.\n";
            break;
        case sink:
            line = "G0 Z5.\n";
            break;
        case cross: // there and back
            line = "G0 Y150.\nG0 Y50.\n";
            break;
        case set:
            line = name + "=" + std::to_string(static_cast<int>(step.number)) + "\n";
            break;
        case copy:
            line = name + "=" + variables[step.from] + "\n";
            break;
        case skip: {
            label = std::to_string(10 + std::count(text.begin(), text.end(), '\n'));
            const size_t comparison = is_fanuc ? step.comparison : opposites[step.comparison];
            const std::string condition = "[" + name + " " + operators[comparison] + " "
                                          + std::to_string(static_cast<int>(step.number)) + "]";
            text += is_fanuc ? "IF " + condition + " GOTO " + label + "\n"
                             : "o" + label + " if " + condition + "\n";
            end = is_fanuc ? "N" + label + "\n" : "o" + label + " endif\n";
            continue;
        }
        }
        text += line + end;
        end.clear();
    }
    return text + "G0 Z100.\nM30\n";
}

Checked checked(const std::string& program, const std::string& dialect) {
    SetupWriter setup;
    setup.program("dialect = \"" + dialect + "\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    setup.machine("rapid = \"straight\"\n" + SetupWriter::mill());
    setup.fixture("clamp", "box = [[40, 104, -30], [60, 130, 12]]\n");
    return check(setup, program);
}

TEST(RandomConditions, TheVerdictIsClearExactlyIfNoValuesCrash) {
    size_t crash_count = 0, saved_count = 0, clear_count = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        const std::vector<Statement> statements = random_statements(seed);
        for (const bool is_fanuc : {true, false}) {
            const std::string program = text_of(statements, is_fanuc);
            const bool crash = crashes_for_any_values(statements, is_fanuc);
            const Checked result = checked(program, is_fanuc ? "fanuc" : "linuxcnc");
            ASSERT_NE(result.status, 2) << result.err << program;
            EXPECT_EQ(result.verdict, crash ? "collision" : "clear")
                << "seed " << seed << ": " << result.errors() << "\n"
                << program;
            EXPECT_EQ(result.status == 1, crash) << result.errors() << "\n" << program;
            crash_count += crash;
            clear_count += !crash;
            saved_count += !crash && crashes_for_any_outcomes(statements, 0, false);
        }
    }
    // Enough of each kind: crashes, none, and none only because conditions exclude each other.
    EXPECT_GT(crash_count, 20U);
    EXPECT_GT(clear_count, 20U);
    EXPECT_GT(saved_count, 5U);
}

} // namespace
} // namespace app_test
