#include <set>

#include <gtest/gtest.h>

#include "hwsim/registers.h"

namespace hwsim {
namespace {

TEST(Registers, DoNotOverlap) {
    std::set<uint32_t> taken;
    for (uint32_t i = 0; i < counter_count; ++i) {
        EXPECT_TRUE(taken.insert(address_of(static_cast<Counter>(i))).second);
        EXPECT_TRUE(taken.insert(address_of(static_cast<Counter>(i)) + 4).second);
    }
    for (uint32_t at = address_of(Register::ring_base_low); at <= address_of(Register::ring_head);
         at += 4)
        EXPECT_TRUE(taken.insert(at).second);
    EXPECT_TRUE(taken.insert(address_of(Register::found_valid)).second);
}

} // namespace
} // namespace hwsim
