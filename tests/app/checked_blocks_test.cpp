#include <random>

#include <gtest/gtest.h>

#include "app/check/check_run.h"
#include "core/sim/run/block_clock.h"

namespace app {
namespace {

using Random = std::mt19937;

bool maybe(Random& random, int one_in) { return random() % static_cast<unsigned>(one_in) == 0; }

double some_number(Random& random) {
    constexpr double numbers[] = {0.0, -0.0, 1.0, 0.1, -3.75e-300, 1e12, core::infinity};
    if (maybe(random, 3)) return numbers[random() % std::size(numbers)];
    return std::uniform_real_distribution<double>(-1000.0, 1000.0)(random);
}

core::PairClearance some_pair(Random& random) {
    core::PairClearance pair;
    pair.pair.part = core::PartKind(random() % 4);
    if (maybe(random, 2)) pair.pair.fixture = random() % 5;
    pair.pair.carried = maybe(random, 4) ? random() % 3 : 0;
    pair.allowance = {maybe(random, 2) ? 2.0 : 0.1, maybe(random, 3) ? 0.05 : 0.0};
    pair.lower = some_number(random);
    pair.verdict = core::all_verdicts[random() % core::all_verdicts.size()];
    pair.unless_removed = maybe(random, 5);
    if (maybe(random, 2)) pair.upper = maybe(random, 2) ? pair.lower : some_number(random);
    if (maybe(random, 3)) pair.time = some_number(random);
    for (core::Vec3* witness : {&pair.on_tool, &pair.on_body})
        if (maybe(random, 2))
            *witness = {some_number(random), some_number(random), some_number(random)};
    return pair;
}

CheckedBlock some_block(Random& random) {
    CheckedBlock block;
    block.block = core::BlockIndex{static_cast<uint32_t>(random())};
    block.line = maybe(random, 4) ? static_cast<uint32_t>(random()) : random() % 300;
    const size_t length = maybe(random, 9) ? random() % 70'000 : random() % 30;
    for (size_t i = 0; i < length; ++i)
        block.text += maybe(random, 2) ? "G01 X-2.5Y"[random() % 10] : static_cast<char>(random());
    if (maybe(random, 3)) block.file = "sub" + std::to_string(random() % 4) + ".nc";
    for (size_t n = maybe(random, 3) ? random() % 4 : 0; n > 0; --n)
        block.calls.push_back(random() % 3);
    core::BlockResult& result = block.result;
    result.motion = core::all_block_motions[random() % core::all_block_motions.size()];
    if (!maybe(random, 3)) result.tool = core::ToolNumber{static_cast<int32_t>(random())};
    result.time = some_number(random);
    result.duration = some_number(random);
    result.removed = some_number(random);
    result.checked = !maybe(random, 4);
    result.verdict = core::all_verdicts[random() % core::all_verdicts.size()];
    for (size_t n = random() % 4; n > 0; --n) result.pairs.push_back(some_pair(random));
    if (maybe(random, 2)) result.deciding = random() % 300;
    for (size_t n = maybe(random, 5) ? random() % 3 : 0; n > 0; --n)
        result.findings.push_back(
            {"collision", core::Severity::error, {}, "too near", "", {}, 0.5});
    return block;
}

core::BlockTime some_time(Random& random) {
    core::BlockTime time{.start = some_number(random), .duration = some_number(random)};
    for (size_t n = random() % 3; n > 0; --n)
        time.stretches.push_back(
            {0.5 * n, {.duration = 0.7 * n, .length = maybe(random, 2) ? 3.0 : 0.0}});
    return time;
}

/// As text, to the last bit of each number.
std::string described(const CheckedBlock& block) {
    std::string text;
    const auto add = [&](const auto& value) {
        text.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const core::BlockResult& result = block.result;
    text += block.text + '|' + block.file + '|';
    for (const uint32_t line : block.calls) add(line);
    add(block.block), add(block.line), add(result.motion), add(result.checked);
    add(result.time), add(result.duration), add(result.removed), add(result.verdict);
    add(result.tool.has_value()), add(result.tool.value_or(core::ToolNumber{}));
    add(result.deciding.has_value()), add(result.deciding.value_or(0));
    for (const core::Finding& finding : result.findings) text += finding.rule + finding.message;
    for (const core::PairClearance& pair : result.pairs) {
        add(pair.pair.part), add(pair.pair.fixture.value_or(1000)), add(pair.pair.carried);
        add(pair.allowance.distance), add(pair.allowance.contact);
        add(pair.lower), add(pair.upper), add(pair.on_tool), add(pair.on_body), add(pair.time);
        add(pair.verdict), add(pair.unless_removed);
    }
    return text;
}

void expect_same(const CheckedBlocks& packed, const std::vector<CheckedBlock>& blocks) {
    ASSERT_EQ(packed.size(), blocks.size());
    size_t at = 0;
    for (const CheckedBlock& block : packed) {
        ASSERT_EQ(described(block), described(blocks[at])) << "block " << at;
        ++at;
    }
    ASSERT_EQ(at, blocks.size());
}

TEST(CheckedBlocks, ReturnWhatWasPutInToTheLastBit) {
    Random random(1);
    CheckedBlocks packed;
    std::vector<CheckedBlock> blocks;
    for (int i = 0; i < 2000; ++i) {
        blocks.push_back(some_block(random));
        packed.push_back(blocks.back());
        ASSERT_EQ(described(packed.back()), described(blocks.back()));
    }
    expect_same(packed, blocks);
    const CheckedBlocks copy = packed;
    packed.truncate(0);
    EXPECT_TRUE(packed.empty());
    expect_same(copy, blocks);
    for (size_t i = 0; i < blocks.size(); i += 97)
        EXPECT_EQ(described(copy[i]), described(blocks[i]));
}

TEST(CheckedBlocks, CanBeChangedAnywhereAndCutBack) {
    Random random(2);
    CheckedBlocks packed;
    std::vector<CheckedBlock> blocks;
    for (int step = 0; step < 8000; ++step) {
        const unsigned what = random() % 100;
        if (what < 60 || blocks.empty()) {
            blocks.push_back(some_block(random));
            packed.push_back(blocks.back());
        } else if (what < 80) {
            const size_t i = random() % blocks.size();
            blocks[i] = some_block(random);
            packed.replace(i, blocks[i]);
        } else if (what < 88) {
            const size_t i = random() % blocks.size();
            blocks[i].result.time = blocks[i].result.duration = 1.5;
            packed.change(
                i, [](CheckedBlock& block) { block.result.time = block.result.duration = 1.5; });
        } else if (what < 99) {
            const size_t i = random() % blocks.size();
            const core::BlockTime time = some_time(random);
            core::settle_time(blocks[i].result, time);
            packed.settle_time(i, time);
        } else {
            const size_t last = blocks.size() - random() % (blocks.size() / 8 + 1);
            blocks.resize(last);
            packed.truncate(last);
        }
        if (step % 500 == 0) expect_same(packed, blocks);
    }
    EXPECT_GT(blocks.size(), 256U);
    expect_same(packed, blocks);
}

} // namespace
} // namespace app
