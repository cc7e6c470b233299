#include <gtest/gtest.h>

#include "core/dbm/scan_lines.h"

namespace core {
namespace {

ScanLines filled(int u_count, int v_count) {
    ScanLines lines(2, u_count, v_count);
    for (int v = 0; v < v_count; ++v)
        for (int u = 0; u < u_count; ++u) lines.edit(u, v).add({0.0, 1.0 + u + 100.0 * v});
    return lines;
}

TEST(ScanLines, KeepEachLineApart) {
    const ScanLines lines = filled(37, 18);
    for (int v = 0; v < 18; ++v)
        for (int u = 0; u < 37; ++u) EXPECT_EQ(lines.line(u, v).length(), 1.0 + u + 100.0 * v);
}

TEST(ScanLines, LeaveASnapshotAsItWas) {
    ScanLines lines = filled(40, 40);
    const ScanLines snapshot = lines;
    lines.edit(20, 5).subtract({0.0, 0.5});
    EXPECT_EQ(snapshot.line(20, 5).length(), 521.0);
    EXPECT_EQ(lines.line(20, 5).length(), 520.5);
    EXPECT_FALSE(lines == snapshot);
    EXPECT_EQ(lines.line(21, 5), snapshot.line(21, 5)); // copied with the tile, not lost
}

TEST(ScanLines, ShareUnchangedTiles) {
    ScanLines lines = filled(40, 40);
    const ScanLines snapshot = lines;
    lines.edit(20, 5);
    for (int v = 0; v < 40; ++v)
        for (int u = 0; u < 40; ++u) {
            const bool touched = u / 16 == 1 && v / 16 == 0;
            EXPECT_EQ(lines.line(u, v).begin() == snapshot.line(u, v).begin(), !touched);
            EXPECT_EQ(lines.shares_tile(snapshot, u, v), !touched);
        }
}

TEST(ScanLines, CloneATileOnlyWhileItIsShared) {
    ScanLines lines = filled(8, 8);
    const ScanTile* const before = lines.tile(0);
    EXPECT_EQ(&lines.edit_tile(0), before);
    {
        const ScanLines snapshot = lines;
        EXPECT_NE(&lines.edit_tile(0), before);
    }
    const ScanTile* const after = lines.tile(0);
    EXPECT_EQ(&lines.edit_tile(0), after);
}

TEST(ScanLines, AreEmptyUntilEdited) {
    ScanLines lines(0, 20, 20);
    EXPECT_TRUE(lines.line(19, 19).empty());
    lines.edit(0, 0).add({1.0, 2.0});
    EXPECT_TRUE(lines.line(1, 0).empty());
    EXPECT_TRUE(lines.line(19, 19).empty());
}

} // namespace
} // namespace core
