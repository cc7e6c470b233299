// The units of the circuit, each held against the emulator.

#include <deque>
#include <random>

#include <gtest/gtest.h>

#include "CheckUnitCircuit.h"
#include "GapUnitCircuit.h"
#include "PathUnitCircuit.h"
#include "tests/hwsim/random_models.h"
#include "tests/hwsim/rtl/fields.h"

namespace hwsim::rtl {
namespace {

constexpr int vectors = 10'000;

/// What a unit must answer after its latency; empty: nothing.
template <typename Answer>
using Expected = std::deque<std::optional<Answer>>;

/// A coordinate that is often at an end of the range, or near another one.
int32_t edgy_coordinate(std::mt19937& rng, int32_t reach) {
    switch (rng() % 8) {
    case 0:
        return least_coordinate + static_cast<int32_t>(rng() % 3);
    case 1:
        return greatest_coordinate - static_cast<int32_t>(rng() % 3);
    case 2:
        return static_cast<int32_t>(rng() % 3) - 1;
    default:
        return within(rng, reach);
    }
}

FixedVec edgy_place(std::mt19937& rng, int32_t reach) {
    return {edgy_coordinate(rng, reach), edgy_coordinate(rng, reach), edgy_coordinate(rng, reach)};
}

int32_t edgy_extent(std::mt19937& rng) {
    switch (rng() % 4) {
    case 0:
        return 0;
    case 1:
        return Record::greatest_extent - static_cast<int32_t>(rng() % 2);
    default:
        return static_cast<int32_t>(rng() % (1U << (1 + rng() % Record::extent_bits)));
    }
}

Box edgy_box(std::mt19937& rng, int32_t reach) {
    Box box{edgy_place(rng, reach), edgy_place(rng, reach)};
    for (size_t axis = 0; axis < 3; ++axis)
        if (box.min[axis] > box.max[axis]) std::swap(box.min[axis], box.max[axis]);
    return box;
}

int32_t any_reach(std::mt19937& rng) {
    return std::array<int32_t, 4>{3, 400, 200'000, greatest_coordinate}[rng() % 4];
}

SearchPair edgy_pair(std::mt19937& rng, uint32_t samples) {
    const int32_t reach = any_reach(rng);
    SearchPair pair{.tool = rng() % 3 == 0 ? Reference::leaf(5, 3) : Reference::node(7),
                    .work = rng() % 3 == 0 ? Reference::leaf(5, 3) : Reference::node(7),
                    .tool_volume = {edgy_box(rng, reach), edgy_extent(rng)},
                    .work_box = edgy_box(rng, reach),
                    .first = static_cast<uint16_t>(rng() % (samples + 1))};
    pair.last = static_cast<uint16_t>(pair.first + rng() % (samples + 1U - pair.first));
    return pair;
}

TEST(PathUnit, DividesAndMovesAsTheEmulator) {
    std::mt19937 rng(1);
    PathUnitCircuit unit;
    Expected<PathAnswer> expected(PathUnit::latency);
    std::array<int, 4> divisions{};
    for (int i = 0; i < vectors; ++i) {
        const auto log2_steps = static_cast<uint8_t>(rng() % 13);
        Segment segment{.log2_steps = log2_steps};
        const int32_t reach = any_reach(rng);
        segment.start = edgy_place(rng, reach);
        segment.end = rng() % 4 == 0 ? segment.start : edgy_place(rng, reach);
        const SearchPair pair = edgy_pair(rng, 1U << log2_steps);

        const bool is_asked = rng() % 4 != 0;
        const auto thread = static_cast<uint8_t>(rng() % 4);
        Fields question;
        question.put(pair.work_box);
        question.put(pair.tool_volume);
        question.put(pair.work.is_leaf(), 1);
        question.put(pair.tool.is_leaf(), 1);
        question.put(pair.first, 13);
        question.put(pair.last, 13);
        question.put(segment);
        set(unit.question, question);
        unit.in_valid = is_asked;
        unit.in_thread = thread;
        clock(unit);
        expected.push_back({});
        if (is_asked)
            expected.back() = {true,
                               thread,
                               division_of(pair, segment, Volumes::boxes),
                               {offset_at(segment, pair.first), offset_at(segment, pair.last)}};

        const std::optional<PathAnswer> now = expected[1];
        expected.pop_front();
        ASSERT_EQ(unit.out_valid, now.has_value()) << i;
        if (!now) continue;
        ++divisions[static_cast<size_t>(now->division)];
        ASSERT_EQ(unit.out_thread, now->thread);
        Fields answer;
        answer.put(now->offset[0]);
        answer.put(now->offset[1]);
        answer.put(static_cast<int64_t>(now->division), 2);
        for (size_t w = 0; w < answer.words().size(); ++w)
            ASSERT_EQ(unit.answer[w], answer.words()[w]) << i << " word " << w;
    }
    for (const int count : divisions) EXPECT_GT(count, 300);
}

/// The question of an answer: a half from `pair` that moves from one offset to another, or records.
Fields question_of(const GapAnswer& answer, const SearchPair& pair, const FixedVec& from,
                   const FixedVec& to, const Record& tool, const Record& work) {
    Fields question;
    question.put(answer.work_record, 28);
    question.put(answer.tool_record, 28);
    question.put(work);
    question.put(tool);
    question.put(pair.work_box);
    question.put(pair.tool_volume);
    question.put(from);
    question.put(to);
    question.put(answer.half, 1);
    question.put(answer.of_records, 1);
    return question;
}

TEST(GapUnit, MeasuresAsTheEmulator) {
    std::mt19937 rng(2);
    GapUnitCircuit unit;
    Expected<GapAnswer> expected(GapUnit::latency);
    int out_of_range = 0, touching = 0;
    for (int i = 0; i < 4 * vectors; ++i) {
        GapAnswer answer{.valid = rng() % 4 != 0,
                         .thread = static_cast<uint8_t>(rng() % 4),
                         .of_records = rng() % 2 == 0,
                         .half = static_cast<uint8_t>(rng() % 2),
                         .tool_record = static_cast<uint32_t>(rng() >> 4),
                         .work_record = static_cast<uint32_t>(rng() >> 4)};
        const SearchPair pair = edgy_pair(rng, 0);
        const int32_t reach = any_reach(rng);
        const FixedVec from = edgy_place(rng, reach), to = edgy_place(rng, reach);
        Record tool, work;
        if (answer.of_records) {
            // Records are inside of boxes in the range.
            const int32_t narrow = std::min(reach, 3'000'000);
            tool = random_record(rng, narrow);
            work = random_record(rng, narrow);
            const FixedVec offset = random_place(rng, narrow);
            answer.squared = squared_distance(tool, offset, work);
            set(unit.question, question_of(answer, pair, offset, offset, tool, work));
        } else {
            const auto gap = squared_gap(pair.tool_volume, from, to, pair.work_box);
            answer.in_range = gap.has_value();
            answer.squared = gap.value_or(0);
            tool = random_record(rng, reach);
            work = random_record(rng, reach);
            set(unit.question, question_of(answer, pair, from, to, tool, work));
        }
        unit.in_valid = answer.valid;
        unit.in_thread = answer.thread;
        clock(unit);
        expected.push_back(answer);
        const GapAnswer now = expected[1].value_or(GapAnswer{});
        expected.pop_front();
        ASSERT_EQ(unit.out_valid, now.valid) << i;
        if (!now.valid) continue;
        ASSERT_EQ(unit.out_thread, now.thread);
        ASSERT_EQ(field(unit.answer, 50, 28), now.work_record);
        ASSERT_EQ(field(unit.answer, 78, 28), now.tool_record);
        ASSERT_EQ(field(unit.answer, 107, 1), now.half);
        ASSERT_EQ(field(unit.answer, 108, 1), now.of_records);
        if (!now.of_records) {
            ASSERT_EQ(field(unit.answer, 106, 1), now.in_range) << i;
        }
        if (now.in_range) {
            ASSERT_EQ(field(unit.answer, 0, 50), now.squared) << i;
        }
        out_of_range += !now.in_range;
        touching += now.in_range && now.squared == 0;
    }
    EXPECT_GT(out_of_range, vectors / 10);
    EXPECT_GT(touching, vectors / 20);
}

TEST(CheckUnit, FindsWrongLinesAsTheEmulator) {
    std::mt19937 rng(3);
    CheckUnitCircuit unit;
    struct Checked {
        uint8_t tag = 0;
        uint32_t address = 0;
        Line line;
        bool is_intact = false;
    };
    Expected<Checked> expected(CheckUnit::latency);
    int wrong = 0;
    for (int i = 0; i < vectors; ++i) {
        Checked next{.tag = static_cast<uint8_t>(rng()),
                     .address = static_cast<uint32_t>(rng() % 4 ? rng() % 64 : rng())};
        for (uint32_t& word : next.line.word) word = static_cast<uint32_t>(rng());
        if (rng() % 8 == 0) next.line = {};
        next.line.word[Line::check_word] = check_of(next.line, next.address);
        for (uint32_t flips = rng() % 2 ? 0 : 1 + rng() % 3; flips > 0; --flips)
            next.line.word[rng() % Line::words] ^= 1U << (rng() % 32);
        next.is_intact = is_intact(next.line, next.address);
        unit.in_valid = rng() % 4 != 0;
        unit.in_tag = next.tag;
        unit.in_address = next.address;
        for (size_t w = 0; w < Line::words; ++w) unit.in_line[w] = next.line.word[w];
        clock(unit);
        expected.push_back({});
        if (unit.in_valid) expected.back() = next;
        const std::optional<Checked> now = expected[1];
        expected.pop_front();
        ASSERT_EQ(unit.out_valid, now.has_value());
        if (!now) continue;
        ASSERT_EQ(unit.tag, now->tag);
        ASSERT_EQ(unit.address, now->address);
        ASSERT_EQ(unit.is_intact, now->is_intact) << i;
        for (size_t w = 0; w < Line::check_word; ++w) ASSERT_EQ(unit.line[w], now->line.word[w]);
        wrong += !now->is_intact;
    }
    EXPECT_GT(wrong, vectors / 4);
}

} // namespace
} // namespace hwsim::rtl
