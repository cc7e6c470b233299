#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gcode/contour/radius_compensation.h"

namespace gcode {
namespace {

using testing::HasSubstr;

/// Compensation with moves numbered from 1, and its complete output.
struct Contour {
    RadiusCompensation compensation;
    CompensatedMoves moves{};
    std::optional<core::Error> error{};
    size_t count = 0;

    void take(core::Result<CompensatedMoves> result) {
        if (!result) {
            error = result.error();
            return;
        }
        moves.insert(moves.end(), result->begin(), result->end());
    }
    Contour& line(double u, double v, bool rapid = false) {
        take(add_move(compensation, {.id = ++count, .rapid = rapid, .end = {u, v}}));
        return *this;
    }
    Contour& arc(FlatPoint end, FlatPoint centre, int turns) {
        take(add_move(compensation, {.id = ++count, .end = end, .arc = FlatArc{centre, turns}}));
        return *this;
    }
    Contour& end() {
        take(end_compensation(compensation));
        return *this;
    }
};

Contour left(double radius) { return {begin_compensation(ContourSide::left, radius, {0.0, 0.0})}; }

Contour right(double radius) {
    return {begin_compensation(ContourSide::right, radius, {0.0, 0.0})};
}

void expect_near(const CompensatedMove& move, size_t id, FlatPoint end) {
    EXPECT_EQ(move.id, id);
    EXPECT_NEAR(move.end.u, end.u, 1e-12);
    EXPECT_NEAR(move.end.v, end.v, 1e-12);
}

TEST(RadiusCompensation, EntersAtTheOffsetEndPoint) {
    const Contour contour = left(2.0).line(10.0, 0.0).end();
    ASSERT_EQ(contour.moves.size(), 1u);
    expect_near(contour.moves[0], 1, {10.0, 2.0});
}

TEST(RadiusCompensation, KeepsTheMoveBackUntilTheNextIsKnown) {
    const Contour contour = left(2.0).line(10.0, 0.0);
    EXPECT_TRUE(contour.moves.empty());
}

TEST(RadiusCompensation, ShortensBothMovesAtAnInsideCorner) {
    const Contour contour = left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 10.0).end();
    ASSERT_EQ(contour.moves.size(), 3u);
    expect_near(contour.moves[1], 2, {18.0, 2.0});
    expect_near(contour.moves[2], 3, {18.0, 10.0});
}

TEST(RadiusCompensation, RoundsAnOutsideCorner) {
    const Contour contour = right(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 10.0).end();
    ASSERT_EQ(contour.moves.size(), 4u);
    expect_near(contour.moves[1], 2, {20.0, -2.0});
    expect_near(contour.moves[2], 3, {22.0, 0.0});
    EXPECT_EQ(contour.moves[2].arc, (FlatArc{{20.0, 0.0}, 1}));
    EXPECT_TRUE(contour.moves[2].rounds_corner);
    expect_near(contour.moves[3], 3, {22.0, 10.0});
    EXPECT_FALSE(contour.moves[3].rounds_corner);
}

TEST(RadiusCompensation, CutsAnOutsideCornerShortBeforeARapid) {
    const Contour contour = right(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 10.0, true);
    ASSERT_EQ(contour.moves.size(), 3u);
    expect_near(contour.moves[2], 3, {22.0, 0.0});
    EXPECT_TRUE(contour.moves[2].rapid);
    EXPECT_FALSE(contour.moves[2].arc);
}

TEST(RadiusCompensation, GoesHalfRoundWhereTheContourComesBack) {
    const Contour contour = left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(10.0, 0.0).end();
    ASSERT_EQ(contour.moves.size(), 4u);
    expect_near(contour.moves[2], 3, {20.0, -2.0});
    EXPECT_EQ(contour.moves[2].arc->turns, -1);
}

TEST(RadiusCompensation, TakesASmallBendAsStraightOn) {
    // 0.04 radians to either side.
    for (const double rise : {0.4, -0.4}) {
        const Contour contour = left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(30.0, rise);
        ASSERT_EQ(contour.moves.size(), 2u);
        expect_near(contour.moves[1], 2, {20.0, 2.0});
    }
}

TEST(RadiusCompensation, MovesOfOtherAxesHappenWhereTheWaitingMoveEnds) {
    const Contour contour =
        left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 0.0).line(20.0, 10.0);
    ASSERT_EQ(contour.moves.size(), 3u);
    expect_near(contour.moves[1], 2, {18.0, 2.0});
    expect_near(contour.moves[2], 3, {18.0, 2.0});
}

TEST(RadiusCompensation, MovesTheEndOfAnArcOntoTheOffsetOfTheLineAfterIt) {
    // The quarter circle about (10, 10), offset 2 inwards, has the radius 8; the line leaves
    // upwards.
    const Contour contour =
        left(2.0).line(10.0, 0.0).arc({20.0, 10.0}, {10.0, 10.0}, 1).line(20.0, 20.0).end();
    ASSERT_EQ(contour.moves.size(), 3u);
    expect_near(contour.moves[1], 2, {18.0, 10.0});
    EXPECT_EQ(contour.moves[1].arc, (FlatArc{{10.0, 10.0}, 1}));
    expect_near(contour.moves[2], 3, {18.0, 20.0});
}

TEST(RadiusCompensation, EndsALineWhereItMeetsTheOffsetOfAnArc) {
    // The tool passes outside the circle of radius 5 about (25, 0), which the line ends at: at v =
    // 2, 7 from the centre.
    const Contour contour =
        left(2.0).line(10.0, 0.0).line(20.0, 0.0).arc({30.0, 0.0}, {25.0, 0.0}, -1).end();
    ASSERT_EQ(contour.moves.size(), 3u);
    expect_near(contour.moves[1], 2, {25.0 - std::sqrt(45.0), 2.0});
    expect_near(contour.moves[2], 3, {32.0, 0.0});
}

TEST(RadiusCompensation, EntersByTheArcThatMeetsTheEndInTheProgrammedDirection) {
    // Through the origin and (8, 10), upwards there: (8 - c)^2 = c^2 + 100.
    const Contour contour = left(2.0).arc({10.0, 10.0}, {0.0, 10.0}, 1).end();
    ASSERT_EQ(contour.moves.size(), 1u);
    expect_near(contour.moves[0], 1, {8.0, 10.0});
    EXPECT_NEAR(contour.moves[0].arc->centre.u, -2.25, 1e-12);
    EXPECT_NEAR(contour.moves[0].arc->centre.v, 10.0, 1e-12);
}

TEST(RadiusCompensation, ANegativeRadiusIsTheOtherSide) {
    const Contour contour = left(-2.0).line(10.0, 0.0).end();
    expect_near(contour.moves.at(0), 1, {10.0, -2.0});
}

TEST(RadiusCompensation, EndingWithoutAMoveGivesNone) {
    const Contour contour = left(2.0).end();
    EXPECT_TRUE(contour.moves.empty());
    EXPECT_FALSE(contour.error);
}

TEST(RadiusCompensation, RefusesAnEntryNoLongerThanTheRadius) {
    EXPECT_THAT(left(2.0).line(2.0, 0.0).error.value().message, HasSubstr("start farther"));
    EXPECT_THAT(left(2.0).line(0.0, 0.0).error.value().message,
                HasSubstr("than the tool radius of 2 mm, but is 0 mm long"));
    EXPECT_FALSE(left(2.0).line(2.001, 0.0).error);
}

TEST(RadiusCompensation, RefusesAnArcTheToolDoesNotFitInto) {
    const Contour contour = left(2.0).line(10.0, 0.0).arc({10.0, 4.0}, {10.0, 2.0}, 1);
    EXPECT_THAT(contour.error.value().message, HasSubstr("inside this arc of radius 2 mm"));
    EXPECT_FALSE(left(2.0).line(10.0, 0.0).arc({10.0, 4.2}, {10.0, 2.1}, 1).error);
}

TEST(RadiusCompensation, RefusesAMoveTooShortForItsInsideCorners) {
    const Contour contour =
        left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 3.0).line(10.0, 3.0);
    EXPECT_THAT(contour.error.value().message, HasSubstr("its whole length"));
    EXPECT_FALSE(
        left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 4.5).line(10.0, 4.5).end().error);
    EXPECT_TRUE(left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 1.0).end().error);
}

TEST(RadiusCompensation, RefusesAnInsideCornerThatTheToolCannotReach) {
    // At the offset line the tool is 3 from the centre of the arc; at the offset arc, 1.
    const Contour contour =
        left(3.0).line(10.0, 0.0).line(20.0, 0.0).arc({12.0, 0.0}, {16.0, 0.0}, 1);
    EXPECT_THAT(contour.error.value().message, HasSubstr("the inside corner at the start"));
}

TEST(RadiusCompensation, MarksAReversedMoveThatTheControlAccepts) {
    // The inside corner at its start reverses the second move; straight on after it.
    const Contour contour =
        left(2.0).line(10.0, 0.0).line(20.0, 0.0).line(20.0, 1.0).line(20.0, 1.5);
    ASSERT_FALSE(contour.error);
    ASSERT_EQ(contour.moves.size(), 3u);
    EXPECT_FALSE(contour.moves[1].turned_round);
    EXPECT_TRUE(contour.moves[2].turned_round);
}

TEST(RadiusCompensation, IsAsBeforeAfterAnError) {
    Contour contour = left(2.0).line(10.0, 0.0).line(20.0, 0.0);
    contour.arc({20.0, 2.0}, {20.0, 1.0}, 1);
    ASSERT_TRUE(contour.error);
    contour.line(20.0, 10.0);
    expect_near(contour.moves.back(), 2, {18.0, 2.0});
}

} // namespace
} // namespace gcode
