#include <gtest/gtest.h>

#include "app/check/block_events.h"

namespace app_test {
namespace {

TEST(MCodes, AreFoundOutsideOfComments) {
    EXPECT_TRUE(app::has_m_code("N10 G0 X1 M61", 61));
    EXPECT_TRUE(app::has_m_code("m061", 61));
    EXPECT_FALSE(app::has_m_code("M6 (M61)", 61));
    EXPECT_FALSE(app::has_m_code("M6 ; M61", 61));
    EXPECT_FALSE(app::has_m_code("M610", 61));
}

} // namespace
} // namespace app_test
