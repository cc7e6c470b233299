// Programs for a trunnion with A and C, posted again for an arm with B and a rotary table with A:
// the same tool goes the same way through the same work, so each block must remove the same
// material and have clearances that agree, although every axis moves otherwise.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// X, Y, Z and the angles of A and C.
using Place = std::array<double, 5>;
constexpr std::string_view letters = "XYZAC";

struct Words {
    std::vector<std::pair<char, double>> all;

    const double* of(char letter) const {
        for (const auto& [own, value] : all)
            if (own == letter) return &value;
        return nullptr;
    }
};

/// The words of a block without its comments. Values may follow their letters after a space.
Words words_of(const std::string& line) {
    std::string text;
    bool in_comment = false;
    for (const char c : line) {
        if (c == ';') break;
        in_comment = (in_comment || c == '(') && c != ')';
        if (!in_comment && c != ')' && c != '%' && !std::isspace(static_cast<unsigned char>(c)))
            text += c;
    }
    Words words;
    for (size_t at = 0; at < text.size();) {
        // Not all that strtod reads: 0X17 would be a number.
        const size_t end = std::min(text.find_first_not_of("+-.0123456789", at + 1), text.size());
        words.all.emplace_back(text[at],
                               std::strtod(text.substr(at + 1, end - at - 1).c_str(), nullptr));
        at = end;
    }
    return words;
}

/// The angles of A and B, with A on the arm that B turns, for the direction that A and C of a
/// trunnion give the tool relative to the work.
///
/// There the work turns about -X under an angle of A and about -Z under one of C.
std::array<double, 2> on_other_machine(double a, double c) {
    const double sine = std::sin(a * degree);
    const double x = sine * std::sin(c * degree), y = sine * std::cos(c * degree);
    const double z = std::cos(a * degree);
    return {std::atan2(-y, z) / degree, std::asin(std::clamp(x, -1.0, 1.0)) / degree};
}

/// A program for both machines, block by block. Moves are divided so that neither turns far in one.
struct BothPrograms {
    std::string trunnion, arm;
};

BothPrograms post(std::istream& program) {
    constexpr double most = 1.0; // degrees in one block
    BothPrograms posted;
    const auto add = [&](const std::string& block) {
        posted.trunnion += block + "\n";
        posted.arm += block + "\n";
    };
    std::array<bool, 5> is_known{};
    Place at{};
    int motion = 0;
    std::string line;
    while (std::getline(program, line)) {
        const Words words = words_of(line);
        std::string others;
        bool moves = false, in_machine = false;
        for (const auto& [letter, value] : words.all) {
            const bool is_motion = letter == 'G' && value <= 3.0;
            if (is_motion) motion = static_cast<int>(value);
            in_machine = in_machine || (letter == 'G' && value == 53.0);
            moves = moves || letters.find(letter) != letters.npos;
            // Feeds in inverse time are those of the undivided blocks.
            const bool is_feed =
                letter == 'F' || (letter == 'G' && (value == 93.0 || value == 94.0));
            if (is_motion || is_feed || letters.find(letter) != letters.npos
                || std::string_view("IJKR").find(letter) != std::string_view::npos)
                continue;
            others += fmt::format("{}{:g} ", letter, value);
        }
        // Without tip control, the machines differ: what comes after is left out.
        if (const double* m = words.of('M'); m && *m == 429.0) {
            add("M30");
            return posted;
        }
        if (in_machine) {
            add(fmt::format("G53 G0 Z{:.4f}", *words.of('Z')));
            continue;
        }
        if (!others.empty()) add(others);
        if (!moves) continue;
        const bool begins = !(is_known[0] && is_known[1] && is_known[2]);
        Place to = at;
        for (size_t i = 0; i < to.size(); ++i)
            if (const double* value = words.of(letters[i])) to[i] = *value, is_known[i] = true;
        is_known[3] = is_known[4] = true;
        if (!(is_known[0] && is_known[1])) { // Z alone, before the first place
            at = to;
            continue;
        }
        const auto block = [&](const Place& p, const std::string& centre) {
            const auto [a, b] = on_other_machine(p[3], p[4]);
            const std::string tip =
                fmt::format("G{} X{:.5f} Y{:.5f} Z{:.5f}{} F600", motion, p[0], p[1], p[2], centre);
            posted.trunnion += fmt::format("{} A{:.5f} C{:.5f}\n", tip, p[3], p[4]);
            posted.arm += fmt::format("{} A{:.5f} B{:.5f}\n", tip, a, b);
        };
        if (motion >= 2) {
            std::string centre;
            for (const char letter : {'I', 'J', 'R'})
                if (const double* value = words.of(letter))
                    centre += fmt::format(" {}{:.5f}", letter, *value);
            block(to, centre);
        } else {
            const double turn = std::max(std::abs(to[3] - at[3]), std::abs(to[4] - at[4]));
            const int count = begins ? 1 : std::max(1, static_cast<int>(std::ceil(turn / most)));
            for (int i = 1; i <= count; ++i) {
                Place p;
                for (size_t k = 0; k < p.size(); ++k) p[k] = at[k] + (to[k] - at[k]) * i / count;
                block(p, "");
            }
        }
        at = to;
    }
    return posted;
}

/// Machines without limits, with the axes of the trunnion and of the arm.
constexpr std::string_view trunnion = R"(
[[machine.axis]]
name = "A"
side = "table"
parent = "base"
direction = [-1, 0, 0]
point = [0, 20, 10]
[[machine.axis]]
name = "C"
side = "table"
parent = "A"
direction = [0, 0, -1]
point = [0, 0, 0]
)";
constexpr std::string_view arm = R"(
[[machine.axis]]
name = "B"
side = "table"
parent = "base"
direction = [0, 1, 0]
point = [-50, -50, -100]
[[machine.axis]]
name = "A"
side = "table"
parent = "B"
direction = [1, 0, 0]
point = [0, -50, -110]
)";

Checked run(test_support::ScopedFolder& folder, const std::string& name, const std::string& program,
            const std::string& job, std::string_view axes, char other) {
    const std::string setup = fmt::format(R"(mesh_size = 0.5
[program]
dialect = "linuxcnc"
start = {{ X = 0, Y = 0, Z = 200, A = 0, {} = 0 }}
tool_at_start = 0
[control]
M428 = "TCP"
[offsets]
G54 = {{ X = 0, Y = 0, Z = 0 }}
{}{})",
                                          other, axes, job);
    return check_files(folder.write(name + ".ngc", program), folder.write(name + ".toml", setup));
}

/// Bounds of a pair that is found on both machines must not contradict each other.
void expect_alike(const Checked& one, const Checked& other, size_t least_blocks, double within) {
    ASSERT_EQ(one.status, other.status) << one.err << other.err;
    ASSERT_LT(one.status, 2) << one.err;
    ASSERT_EQ(one.blocks.size(), other.blocks.size());
    double removed[2] = {0.0, 0.0};
    size_t compared = 0;
    for (size_t i = 0; i < one.blocks.size(); ++i) {
        const BlockLine &a = one.blocks[i], &b = other.blocks[i];
        SCOPED_TRACE(a.text);
        removed[0] += a.removed;
        removed[1] += b.removed;
        for (const PairLine& pair : a.pairs) {
            const auto same =
                std::find_if(b.pairs.begin(), b.pairs.end(),
                             [&](const PairLine& any) { return any.name == pair.name; });
            if (same == b.pairs.end()) continue;
            ++compared;
            EXPECT_LE(pair.lower, same->upper.value_or(1e9) + 1e-6) << pair.name;
            EXPECT_LE(same->lower, pair.upper.value_or(1e9) + 1e-6) << pair.name;
        }
    }
    EXPECT_GE(one.blocks.size(), least_blocks);
    EXPECT_GE(compared, one.blocks.size());
    EXPECT_GT(removed[0], 100.0);
    EXPECT_NEAR(removed[1] / removed[0], 1.0, within);
    EXPECT_EQ(one.verdict, other.verdict);
}

TEST(Reposted, DomeIsTheSameOnBothMachines) {
    std::ifstream program(FEELER_SOURCE_DIR "/assets/programs/dome.ngc");
    ASSERT_TRUE(program);
    const BothPrograms posted = post(program);
    const std::string job = R"(
[stock]
cylinder = { radius = 12, height = 19 }
at = [0, 0, 5]
frame = "G54"
[[fixture]]
name = "collet-block"
box = [[-20, -20, 0], [20, 20, 12]]
frame = "G54"
[[tool]]
number = 1
shape = "ball"
diameter = 6
flute_length = 12
stick_out = 25
holder = { preset = "ISO20-ER11", length = 45 }
[[length_offset]]
number = 1
length = 70
)";
    test_support::ScopedFolder folder;
    expect_alike(run(folder, "ac", posted.trunnion, job, trunnion, 'C'),
                 run(folder, "ab", posted.arm, job, arm, 'B'), 3000, 1e-3);
}

TEST(Reposted, BoatIsTheSameOnBothMachines) {
    const std::string path = FEELER_SOURCE_DIR "/../shared/five-axis/linuxcnc-xyzac/boat-xyzac.ngc";
    std::ifstream program(path);
    if (!program) {
        if (std::getenv("FEELER_REQUIRE_SHARED")) FAIL() << path << " is missing";
        GTEST_SKIP() << path << " is missing";
    }
    BothPrograms posted = post(program);
    for (std::string* text : {&posted.trunnion, &posted.arm})
        text->insert(text->find("G54"), "G43 H1\n");
    const std::string job = R"(
[stock]
box = [[-50, -24, -13], [40, 24, 0]]
frame = "G54"
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 30
stick_out = 50
[[length_offset]]
number = 1
length = 50
)";
    test_support::ScopedFolder folder;
    expect_alike(run(folder, "ac", posted.trunnion, job, trunnion, 'C'),
                 run(folder, "ab", posted.arm, job, arm, 'B'), 4000, 2e-4);
}

} // namespace
} // namespace app_test
