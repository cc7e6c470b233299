#include <gtest/gtest.h>

#include "tests/support/guarantee_tally.h"
#include "tests/support/pair_generator.h"

namespace core {
namespace {

using test_support::BodyForm;
using test_support::Footing;
using test_support::GuaranteeTally;
using test_support::KnownBody;
using test_support::KnownPair;
using test_support::one_in;
using test_support::uniform;

/// What came of one sample of random pairs, which several claims are about.
class GuaranteeSample : public testing::Test {
protected:
    static void SetUpTestSuite() {
        test_support::PairGenerator pairs(1);
        tally_.emplace();
        for (int i = 0; i < 4000; ++i) {
            const KnownPair pair = pairs.next();
            tally_->measure(pair, pairs.engine());
        }
    }
    static void TearDownTestSuite() { tally_.reset(); }

    static std::optional<GuaranteeTally> tally_;
};
std::optional<GuaranteeTally> GuaranteeSample::tally_;

TEST_F(GuaranteeSample, HoldsTheTruthBetweenLowerAndUpper) {
    for (size_t i = 0; i < std::min<size_t>(tally_->failures.size(), 40); ++i)
        ADD_FAILURE() << tally_->failures[i];
}

TEST_F(GuaranteeSample, HasEveryMeetingOnEveryFootingInIt) {
    EXPECT_TRUE(tally_->is_representative()) << tally_->report();
}

TEST_F(GuaranteeSample, ClosesToRoundingWhereGeometryIsKnown) {
    EXPECT_LT(tally_->width(Footing::exact, 0.99), 1.1e-7) << tally_->report();
    EXPECT_LT(tally_->width(Footing::exact, 1.0), 1e-5) << tally_->report();
    EXPECT_GT(tally_->tight_share(), 0.995) << tally_->report();
}

TEST_F(GuaranteeSample, IsZeroForBodiesWithPointsInCommon) {
    EXPECT_GT(tally_->share_closed_at_zero(), 0.995) << tally_->report();
}

TEST_F(GuaranteeSample, IsOpenByAboutAMeshSizeWhereLinesAndColumnsAreKnown) {
    for (const Footing footing : {Footing::three_families, Footing::one_family}) {
        EXPECT_LT(tally_->width(footing, 0.5), 0.5) << tally_->report();
        EXPECT_LT(tally_->width(footing, 0.99), 2.0) << tally_->report();
        EXPECT_LT(tally_->width(footing, 1.0), 6.0) << tally_->report();
    }
}

/// A body in the program's hands that the test expects to be taken.
KnownBody taken(DistanceEngine& engine, std::vector<test_support::TruePart> parts, BodyForm form,
                double spacing) {
    KnownBody known{"", std::move(parts), form, spacing};
    return built(engine, std::move(known)).value();
}

/// A pair at a pose, with its truth.
KnownPair pair_at(const KnownBody& a, const KnownBody& b, const Transform& a_from_b) {
    KnownPair pair{&a, &b, a_from_b};
    pair.truth = true_distance(a, b, a_from_b);
    return pair;
}

Measurement measured(const DistanceEngine& engine, const KnownPair& pair) {
    return measure(engine, pair.a->body, pair.b->body, pair.a_from_b, pair.goal).value();
}

TEST(Guarantee, ClosesToAHundredMillionthForSpheres) {
    const auto engine = paper_engine();
    const KnownBody ball =
        taken(*engine, {test_support::ball_at(Vec3(0.0), 25.0)}, BodyForm::primitive, 1.0);
    std::mt19937 rng(5);
    for (int i = 0; i < 200; ++i) {
        const double gap = one_in(rng, 5) ? 0.0 : uniform(rng, 0.001, 50.0);
        const Vec3 at = (50.0 + gap) * test_support::random_direction(rng);
        const KnownPair pair = pair_at(ball, ball, translation(at));
        const Measurement found = measured(*engine, pair);
        EXPECT_LT(found.upper - found.lower, 1e-8);
        EXPECT_LE(found.lower, double(pair.truth) + 1e-12);
        EXPECT_GE(found.upper, double(pair.truth) - 1e-12);
        EXPECT_GE(found.scan.distance, found.lower);
    }
}

/// The middle one of the widths of the intervals of a scanned ball over a scanned block.
double median_width(double spacing) {
    const auto engine = paper_engine();
    const KnownBody ball = taken(*engine, {test_support::ball_at(Vec3(0.0), 6.0)},
                                 BodyForm::lines_and_columns, spacing);
    const KnownBody block = taken(*engine, {test_support::box_round(Vec3(0.0), {7.0, 5.0, 3.0})},
                                  BodyForm::lines_and_columns, spacing);
    std::mt19937 rng(8);
    std::vector<double> widths;
    for (int i = 0; i < 41; ++i) {
        const Vec3 at = uniform(rng, 16.0, 20.0) * test_support::random_direction(rng);
        const KnownPair pair =
            pair_at(block, ball, {test_support::random_pose(rng, 1.0).rotation, at});
        const Measurement found = measured(*engine, pair);
        EXPECT_LE(found.lower, double(pair.truth));
        EXPECT_GE(found.upper, double(pair.truth));
        widths.push_back(found.upper - found.lower);
    }
    std::nth_element(widths.begin(), widths.begin() + 20, widths.end());
    return widths[20];
}

TEST(Guarantee, NarrowsWithTheMeshSizeForScannedBodies) {
    const double at_1 = median_width(1.0), at_half = median_width(0.5);
    EXPECT_LT(at_1, 1.5);
    EXPECT_LT(at_half, 0.75);
    EXPECT_LT(at_half, 0.7 * at_1);
}

/// A block of 8 mm with a needle of 0.1 mm on top, between all lines of a mesh size of 1 mm.
std::vector<test_support::TruePart> block_with_needle() {
    return {test_support::box_round(Vec3(0.0), Vec3(4.0)),
            test_support::box_round({0.0, 0.0, 6.0}, {0.05, 0.05, 4.0})};
}

TEST(Guarantee, SeesANeedleThinnerThanTheMeshSizeInTheOuterModel) {
    const auto engine = paper_engine();
    const KnownBody ball =
        taken(*engine, {test_support::ball_at(Vec3(0.0), 3.0)}, BodyForm::primitive, 1.0);
    for (const BodyForm form : {BodyForm::mesh, BodyForm::lines_and_columns, BodyForm::lines}) {
        const KnownBody needle = taken(*engine, block_with_needle(), form, 1.0);
        const KnownPair pair = pair_at(needle, ball, translation({0.0, 0.0, 14.0}));
        ASSERT_NEAR(double(pair.truth), 1.0, 1e-12);
        const Measurement found = measured(*engine, pair);
        EXPECT_GT(found.scan.distance, 5.0); // the points miss the needle
        EXPECT_LE(found.lower, 1.0);
        EXPECT_GE(found.upper, 1.0);
        EXPECT_EQ(found.reason.empty(), form != BodyForm::lines);
        EXPECT_EQ(found.lower == 0.0, form == BodyForm::lines);
        EXPECT_LT(found.upper, form == BodyForm::mesh ? 1.0 + 1e-6 : infinity);
        EXPECT_GT(found.lower, form == BodyForm::lines ? -1.0 : 0.4);
    }
}

TEST(Guarantee, IsZeroForABodyInsideAnotherFarFromItsSurface) {
    const auto engine = paper_engine();
    const std::vector<test_support::TruePart> block = {
        test_support::box_round(Vec3(0.0), Vec3(20.0))};
    for (const BodyForm outer_form :
         {BodyForm::primitive, BodyForm::mesh, BodyForm::lines, BodyForm::lines_and_columns})
        for (const BodyForm inner_form :
             {BodyForm::primitive, BodyForm::mesh, BodyForm::lines, BodyForm::lines_and_columns}) {
            const KnownBody outer = taken(*engine, block, outer_form, 2.0);
            const KnownBody inner =
                taken(*engine, {test_support::box_round(Vec3(0.0), Vec3(1.7))}, inner_form, 0.5);
            const KnownPair pair =
                pair_at(outer, inner, {rotation_xyz_deg({10, 20, 30}), {1.3, 2.4, 0.7}});
            ASSERT_EQ(pair.truth, 0.0L);
            const Measurement found = measured(*engine, pair);
            EXPECT_GT(found.scan.distance, 10.0);
            EXPECT_EQ(found.lower, 0.0);
            // Lines alone are a mesh size apart: the inner body may fit between matter that is
            // known.
            const bool thin = outer_form >= BodyForm::lines && inner_form >= BodyForm::lines;
            EXPECT_LE(found.upper, thin ? 1.0 : 0.0) << int(outer_form) << " " << int(inner_form);
        }
}

TEST(Guarantee, HoldsFarFromTheOrigin) {
    const auto engine = paper_engine();
    const KnownBody box =
        taken(*engine, {test_support::box_round(Vec3(0.0), Vec3(5.0))}, BodyForm::primitive, 1.0);
    for (const double far : {1e3, 1e6, 1e9, 1e11}) {
        const KnownPair pair = pair_at(box, box, translation({far, 0.25 * far, -0.5 * far}));
        const Measurement found = measured(*engine, pair);
        EXPECT_LE(found.lower, double(pair.truth));
        EXPECT_GE(found.upper, double(pair.truth));
        EXPECT_LE(found.upper - found.lower, 1e-6 + 1e-10 * far);
    }
}

TEST(Guarantee, NamesAWitnessInBothBodiesWhereTheSearchLeftTheirPointsApart) {
    for (const double share : {1e-4, 1e-2}) {
        test_support::PairGenerator pairs(2);
        GuaranteeTally tally;
        for (int i = 0; i < 1000; ++i) {
            KnownPair pair = pairs.next();
            pair.goal.tolerance = share * (pair.a->size + pair.b->size);
            tally.measure(pair, pairs.engine());
        }
        for (size_t i = 0; i < std::min<size_t>(tally.failures.size(), 20); ++i)
            ADD_FAILURE() << tally.failures[i];
        EXPECT_GT(tally.closed_at_zero, 20U) << tally.report();
    }
}

/// Found among a million random pairs: the search ends with points 5.9e-9 mm apart, and the bodies
/// are proven to meet.
TEST(Guarantee, NamesAWitnessOnAFinThatABallJustTouchesAtTheStartOfItsWay) {
    const auto engine = paper_engine();
    const KnownBody ball = taken(*engine, {test_support::ball_at(Vec3(0.0), 1.5185959420370581)},
                                 BodyForm::primitive, 1.0);
    const double half = 2.8045089598540853;
    const test_support::TrueBox block = test_support::box_round(Vec3(0.0), Vec3(half));
    const test_support::TrueBox fin{{-1.1855999308133418, -half, 0.0},
                                    {-0.8144000691866583, half, 4.8811057129158852}};
    const KnownBody finned = taken(*engine, {block, fin}, BodyForm::mesh, 1.0);
    const Mat3 quarter_turn{{0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    KnownPair pair{
        &ball,
        &finned,
        {quarter_turn, {0.71249245014873264, -0.26262631898893485, -6.2959129017608984}}};
    pair.goal.sweep = {-0.41010383143466195, -2.3532649640586145, -0.84752839336707586};
    // Seen from the fin, the ball's way is a capsule.
    test_support::TrueCapsule way = test_support::ball_at(Vec3(0.0), 1.5185959420370581);
    way.b = -test_support::RealVec(pair.goal.sweep);
    ASSERT_EQ(distance(way, fin, test_support::exactly(pair.a_from_b)), 0.0L);
    GuaranteeTally tally;
    tally.measure(pair, *engine);
    EXPECT_EQ(tally.failures, std::vector<std::string>{});
    EXPECT_EQ(measured(*engine, pair).upper, 0.0);
}

TEST(Guarantee, IsOpenUpwardsBeyondTheLimit) {
    const auto engine = paper_engine();
    const KnownBody box =
        taken(*engine, {test_support::box_round(Vec3(0.0), Vec3(5.0))}, BodyForm::primitive, 1.0);
    KnownPair pair = pair_at(box, box, translation({30.0, 0.0, 0.0}));
    pair.goal.limit = 19.0;
    const Measurement beyond = measured(*engine, pair);
    EXPECT_EQ(beyond.upper, infinity);
    EXPECT_LE(beyond.lower, 19.0);
    EXPECT_GT(beyond.lower, 19.0 - 1e-6);
    pair.goal.limit = 20.0 + 1e-12; // nearer than rounding lets anyone say
    EXPECT_EQ(measured(*engine, pair).upper, infinity);
    pair.goal.limit = 21.0;
    EXPECT_NEAR(measured(*engine, pair).upper, 20.0, 1e-6);
}

} // namespace
} // namespace core
