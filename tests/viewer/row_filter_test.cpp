#include <gtest/gtest.h>

#include "app/viewer/row_filter.h"
#include "tests/viewer/rows.h"

namespace {

using app::viewer::BlockRow;
using app::viewer::RowFilter;

BlockRow rapid_with_t3() {
    BlockRow row = viewer_test::row_with(0.42);
    row.motion = core::BlockMotion::rapid;
    row.tool = core::ToolNumber{3};
    row.text = "N1880 G0 X-34.635";
    row.part = "holder";
    row.body = "clamp-1";
    return row;
}

TEST(RowFilter, LetsAllThroughThatAllWordsAreTrueOf) {
    const BlockRow row = rapid_with_t3();
    for (const char* text : {"", "T3", "t3 rapid", "clr<1", "clearance<=0.42", "violation", "x-34",
                             "CLAMP-1", "T3 and rapid and clr<0.5", "holder g0"})
        EXPECT_TRUE(RowFilter(text).holds(row)) << text;
    for (const char* text : {"T4", "T33", "feed", "clr>1", "near", "clear", "T3 feed", "clamp-2"})
        EXPECT_FALSE(RowFilter(text).holds(row)) << text;
}

TEST(RowFilter, NoClearanceIsLessThanAnyNumber) {
    BlockRow row;
    EXPECT_FALSE(RowFilter("clr<1000").holds(row));
    row.motion = core::BlockMotion::feed;
    EXPECT_FALSE(RowFilter("clear").holds(row)) << "nobody has checked it";
}

TEST(RowFilter, HalfAComparisonIsText) {
    const BlockRow row = rapid_with_t3();
    EXPECT_FALSE(RowFilter("clr<").holds(row));
    EXPECT_FALSE(RowFilter("clr<1x").holds(row));
}

} // namespace
