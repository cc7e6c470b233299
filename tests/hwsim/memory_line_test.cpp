#include <random>

#include <gtest/gtest.h>

#include "hwsim/registers.h"
#include "hwsim/search.h"

namespace hwsim {
namespace {

int32_t coordinate(std::mt19937& rng) {
    // The corners of the range come often.
    switch (rng() % 6) {
    case 0:
        return least_coordinate;
    case 1:
        return greatest_coordinate;
    case 2:
        return static_cast<int32_t>(rng() % 3) - 1;
    default:
        return static_cast<int32_t>(rng() % (1U << 24)) + least_coordinate;
    }
}

FixedVec position(std::mt19937& rng) { return {coordinate(rng), coordinate(rng), coordinate(rng)}; }

int32_t extent(std::mt19937& rng) {
    return rng() % 4 == 0 ? Record::greatest_extent
                          : static_cast<int32_t>(rng() % (1U << Record::extent_bits));
}

Node random_node(std::mt19937& rng) {
    Node node;
    for (Volume& volume : node.volume) volume = {{position(rng), position(rng)}, extent(rng)};
    node.child[0] = Reference::leaf(rng() % (1U << Reference::line_bits), 1 + rng() % 32);
    node.child[1] = rng() % 2 == 0 ? Reference{} : Reference::node(rng() % (1U << 26));
    return node;
}

TEST(MemoryLine, GivesBackTheNodeThatWasPutIn) {
    std::mt19937 rng(1);
    for (int i = 0; i < 10'000; ++i) {
        const Node node = random_node(rng);
        const Line line = packed(node, 7, 99);
        ASSERT_EQ(node_in(line), node);
        ASSERT_EQ(epoch_of(line), 7U);
        ASSERT_TRUE(is_intact(line, 99));
    }
}

TEST(MemoryLine, GivesBackTheRecordsThatWerePutIn) {
    std::mt19937 rng(2);
    for (int i = 0; i < 10'000; ++i) {
        Records records;
        for (Record& r : records) r = {position(rng), extent(rng), extent(rng)};
        const Line line = packed(records, 0xFFFF'FFFFU, 3);
        ASSERT_EQ(records_in(line), records);
        ASSERT_EQ(epoch_of(line), 0xFFFF'FFFFU);
    }
}

TEST(MemoryLine, HasItsBitsWhereTheLayoutSays) {
    Node node;
    node.volume[0] = {{{1, 2, 3}, {}}, 77};
    node.child[0] = Reference::leaf(5, 16);
    const Line line = packed(node, 0, 0);
    EXPECT_EQ(line.word[0], 0x0200'0001U);
    EXPECT_EQ(line.word[1], 0x0003'0000U);
    EXPECT_EQ(line.word[9], 0xBC00'0005U);
    EXPECT_EQ(line.word[10], Reference::none_word);
    EXPECT_EQ(line.word[11], 77U);
    Records records{};
    records[0] = {{-1, 0, 0}, 1, 2};
    const Line leaf = packed(records, 0, 0);
    EXPECT_EQ(leaf.word[0], 0x00FF'FFFFU);
    EXPECT_EQ(leaf.word[2], 0x1U << 8 | 0x2U << 28);
}

TEST(MemoryLine, ChecksAsCrc32Does) {
    // CRC-32 of 64 zero bytes, the address being 0: a value known from elsewhere.
    EXPECT_EQ(check_of(Line{}, 0), 0x758D'6336U);
}

TEST(MemoryLine, SeesEveryWrongBitAndEveryPairOfThem) {
    std::mt19937 rng(3);
    const Line good = packed(random_node(rng), 12, 1000);
    for (size_t a = 0; a < 512; ++a)
        for (size_t b = a; b < 512; ++b) {
            Line bad = good;
            bad.word[a / 32] ^= 1U << (a % 32);
            if (b != a) bad.word[b / 32] ^= 1U << (b % 32);
            ASSERT_FALSE(is_intact(bad, 1000)) << a << " " << b;
        }
}

TEST(MemoryLine, IsNotTakenForThatOfAnotherAddress) {
    std::mt19937 rng(4);
    const Line line = packed(random_node(rng), 12, 1000);
    for (uint32_t address = 0; address < 100'000; ++address) {
        ASSERT_EQ(is_intact(line, address), address == 1000);
    }
}

TEST(MemoryLine, DistinguishesNodesLeavesAndNothing) {
    EXPECT_TRUE(Reference{}.is_none());
    EXPECT_FALSE(Reference{}.is_leaf());
    for (const uint32_t line : {0U, 1U, (1U << 26) - 1})
        for (uint32_t count = 1; count <= 32; ++count) {
            EXPECT_TRUE(Reference::leaf(line, count).is_leaf());
            EXPECT_EQ(Reference::leaf(line, count).count(), count);
            EXPECT_EQ(Reference::leaf(line, count).line(), line);
            EXPECT_FALSE(Reference::node(line).is_leaf());
            EXPECT_FALSE(Reference::node(line).is_none());
            EXPECT_EQ(Reference::node(line).line(), line);
        }
}

} // namespace
} // namespace hwsim
