#include <set>

#include <gtest/gtest.h>

#include "hwsim/registers.h"
#include "hwsim/search.h"

namespace hwsim {
namespace {

const Segment example{.sequence = 0xFFFF'FFFFU,
                      .kind = SegmentKind::measure,
                      .tool_slot = 31,
                      .work_slot = 30,
                      .log2_steps = 12,
                      .last = false,
                      .start = {least_coordinate, 0, -1},
                      .end = {greatest_coordinate, 5, 1},
                      .threshold = static_cast<uint32_t>(greatest_coordinate),
                      .work_epoch = 77,
                      .model_header = 1234,
                      .budget = 0xFFFF'FFFFU};

TEST(SegmentWords, GiveBackTheSegmentThatWasPutIn) {
    EXPECT_EQ(segment_in(words_of(example)).segment, example);
    EXPECT_EQ(segment_in(words_of(example)).fault, Stop::none);
    EXPECT_EQ(segment_in(words_of(Segment{})).segment, Segment{});
}

TEST(SegmentWords, AreOutOfRangeWhereTheyDoNotFit) {
    for (size_t word = 2; word < 8; ++word)
        for (const int32_t value : {least_coordinate - 1, greatest_coordinate + 1}) {
            SegmentWords words = words_of(example);
            words[word] = static_cast<uint32_t>(value);
            EXPECT_EQ(segment_in(words).fault, Stop::out_of_range) << word;
        }
    SegmentWords unknown = words_of(example);
    unknown[1] |= 0xFFU;
    EXPECT_EQ(segment_in(unknown).fault, Stop::out_of_range);
    SegmentWords steps = words_of(example);
    steps[1] |= 13U << 8;
    EXPECT_EQ(segment_in(steps).fault, Stop::out_of_range);
    SegmentWords far = words_of(example);
    far[8] = 1U << 23;
    EXPECT_EQ(segment_in(far).fault, Stop::out_of_range);
}

TEST(Registers, DoNotOverlap) {
    std::set<uint32_t> taken;
    for (uint32_t i = 0; i < counter_count; ++i) {
        EXPECT_TRUE(taken.insert(address_of(static_cast<Counter>(i))).second);
        EXPECT_TRUE(taken.insert(address_of(static_cast<Counter>(i)) + 4).second);
    }
    for (uint32_t i = 0; i < segment_words; ++i)
        EXPECT_TRUE(taken.insert(address_of(Register::segment) + 4 * i).second);
    EXPECT_TRUE(taken.insert(address_of(Register::segment_push)).second);
    EXPECT_TRUE(taken.insert(address_of(Register::found_valid)).second);
}

} // namespace
} // namespace hwsim
