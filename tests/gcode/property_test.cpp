#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gcode/lower/lowering.h"
#include "tests/gcode/programs.h"

namespace gcode {
namespace {

/// Random programs of straight moves, arcs, cycles and offsets, one word at a time.
class Generator {
public:
    explicit Generator(uint32_t seed) : random_(seed) {}

    int whole(int lowest, int highest) {
        return lowest + static_cast<int>(random_() % static_cast<uint32_t>(highest - lowest + 1));
    }

    /// Blocks as vectors of words; lengths are multiples of 1/8, exact in mm and in inches alike.
    std::vector<std::vector<std::pair<std::string, double>>> blocks(int count) {
        std::vector<std::vector<std::pair<std::string, double>>> result;
        result.push_back({{"G90 G17 F", 80.0}, {"G0 X", 0.0}, {"Y", 0.0}, {"Z", 40.0}});
        for (int i = 0; i < count; ++i) result.push_back(block());
        return result;
    }

private:
    double length() { return whole(-160, 160) / 8.0; }

    std::vector<std::pair<std::string, double>> block() {
        switch (whole(0, 6)) {
        case 0:
            return {{"G90 G0 X", length()}, {"Y", length()}};
        case 1:
            return {{"G90 G1 X", length()}, {"Z", length()}};
        case 2:
            return {{"G91 G1 Y", length()}, {"Z", length()}};
        case 3:
            return {{"G91 G2 X", 16.0}, {"Y", 0.0}, {"I", 8.0}, {"Z", length()}};
        case 4:
            return {{"G91 G3 I", 8.0}, {"J", length()}};
        case 5:
            return {{"G90 G99 G81 X", length()}, {"Z", -30.0}, {"R", 30.0}};
        default:
            return {{"G10 L2 P1 X", length()}, {"Y", length()}};
        }
    }

    std::mt19937 random_;
};

std::string written(const std::vector<std::vector<std::pair<std::string, double>>>& blocks,
                    const std::string& first, double scale) {
    std::string text = first + "\n";
    for (const auto& block : blocks) {
        for (const auto& [letter, value] : block)
            text += fmt::format("{}{:.6f} ", letter, value * scale);
        text += "\n";
    }
    return text + "M30\n";
}

std::vector<core::Event> events_of(const std::string& text) {
    const Environment environment = known_environment(DialectId::fanuc);
    const Ran ran = run_text(text, environment);
    EXPECT_FALSE(ran.run.error) << (ran.run.error ? ran.run.error->message : "") << "\n" << text;
    Lowering lowering = initial_lowering(environment);
    std::vector<core::Event> events;
    for (const BlockCommands& block : ran.run.blocks)
        for (const core::Event& event : lower(block, lowering)) events.push_back(event);
    return events;
}

TEST(Property, InchAndMillimetreTwinsAgree) {
    size_t arcs = 0, rapids = 0;
    for (uint32_t seed = 1; seed <= 50; ++seed) {
        Generator generator(seed);
        const auto blocks = generator.blocks(40);
        const auto metric = events_of(written(blocks, "G21", 25.4));
        const auto inch = events_of(written(blocks, "G20", 1.0));
        ASSERT_EQ(metric.size(), inch.size()) << seed;
        for (size_t i = 0; i < metric.size(); ++i) {
            const auto* a = std::get_if<core::Motion>(&metric[i]);
            const auto* b = std::get_if<core::Motion>(&inch[i]);
            ASSERT_EQ(a == nullptr, b == nullptr);
            if (!a) continue;
            ASSERT_EQ(a->kind, b->kind);
            arcs += a->kind == core::MotionKind::arc;
            rapids += a->kind == core::MotionKind::rapid;
            ASSERT_NEAR(a->feed, b->feed, 1e-9);
            for (size_t axis = 0; axis < 3; ++axis) ASSERT_NEAR(*a->to[axis], *b->to[axis], 1e-4);
        }
    }
    EXPECT_GT(arcs, 200u);
    EXPECT_GT(rapids, 200u);
}

/// The same words with different case, blanks, comments and block numbers.
std::string disguised(const std::string& text, Generator& generator) {
    std::string result;
    bool start = true;
    for (const char c : text) {
        if (start && generator.whole(0, 3) == 0)
            result += fmt::format("N{}", generator.whole(1, 999));
        start = c == '\n';
        if (start && generator.whole(0, 3) == 0) result += "; rest";
        if (c == ' ' && generator.whole(0, 1) == 0) continue;
        if (c != '\n' && generator.whole(0, 3) == 0) result += ' ';
        if (c >= 'A' && c <= 'Z' && generator.whole(0, 5) == 0) result += "(X9)";
        result += generator.whole(0, 1) ? static_cast<char>(std::tolower(c)) : c;
    }
    return result;
}

TEST(Property, CaseBlanksAndCommentsChangeNothing) {
    for (uint32_t seed = 1; seed <= 50; ++seed) {
        Generator generator(seed);
        const std::string text = written(generator.blocks(40), "G21", 1.0);
        const std::string other = disguised(text, generator);
        ASSERT_NE(text, other);
        const Ran plain = run_text(text), changed = run_text(other);
        ASSERT_FALSE(changed.run.error) << changed.run.error->message << "\n" << other;
        ASSERT_EQ(commands_of(plain.run), commands_of(changed.run)) << other;
    }
}

TEST(Property, RandomBytesNeverDoMoreThanFail) {
    std::mt19937 random(7);
    constexpr std::string_view alphabet = "GGGXYZIJKRPQFSTMHLNO0123456789.-+ ()/%;#[]\r\n\n\n";
    size_t good = 0, bad = 0;
    for (int run_number = 0; run_number < 20000; ++run_number) {
        std::string text = "G0";
        const size_t length = 1 + random() % 60;
        for (size_t i = 0; i < length; ++i) text += alphabet[random() % alphabet.size()];
        const auto id = static_cast<DialectId>(random() % 4);
        const Ran ran = run_text(text, known_environment(id));
        (ran.run.error ? bad : good) += 1;
        ASSERT_TRUE(!ran.run.error || !ran.run.error->message.empty());
    }
    EXPECT_GT(good, 50u);
    EXPECT_GT(bad, 1000u);
}

} // namespace
} // namespace gcode
