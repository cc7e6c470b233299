#include <gtest/gtest.h>

#include "app/tolerance/limit_search.h"
#include "tests/app/tolerance_cases.h"

namespace app_test {
namespace {

using app::Quantity;
using app::Tolerance;
using app::Tolerances;

/// A slot to X60 at Z-5, from and to machine zero.
const std::string slot = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X10 Y50\n"
                         "G43 H1 Z50\nZ2\nG1 Z-5 F300\nX60\nG0 Z50\nG28 G91 Z0\nM30\n";

/// The tip stands 5 mm below the stock's face, so the holder, 40 mm wide, begins 40 mm above it.
test_support::SetupWriter plate() { return test_support::SetupWriter().also(lengths_in_mm); }

/// With a control on which a length offset stays active after G53.
test_support::SetupWriter plate_that_keeps_lengths() {
    return test_support::SetupWriter().also(lengths_in_mm + "\"5001#6\" = 1\n");
}

Tolerances tolerances(const ToleranceCase& one) {
    const auto run = app::run_check(one.job);
    if (!run) {
        ADD_FAILURE() << run.error().message;
        return {};
    }
    auto found = app::tolerances_of(one.job, *run);
    EXPECT_TRUE(found.has_value());
    return found ? *std::move(found) : Tolerances{};
}

const Tolerance& named(const Tolerances& all, const std::string& title) {
    for (const Tolerance& tolerance : all.list)
        if (title_of(tolerance.deviation) == title) return tolerance;
    ADD_FAILURE() << "no tolerance of " << title;
    static const Tolerance none;
    return none;
}

void expect_limit(const app::ToleranceLimit& limit, double truth) {
    EXPECT_FALSE(limit.is_open);
    EXPECT_LE(limit.by, truth + 1e-6);
    EXPECT_GE(limit.by, truth - std::max(0.02, 0.05 * truth));
}

TEST(Tolerance, OfAClampThatTheHolderPassesAtFiveMillimetres) {
    // At X60 the holder reaches to X80; the clamp begins at X85 and must be 2 mm away.
    auto setup = plate();
    setup.fixture("clamp", "box = [[85, 40, 0], [99, 60, 80]]\n");
    const ToleranceCase one(setup.text(), slot);
    const Tolerances all = tolerances(one);
    expect_limit(named(all, "clamp X").less, 3.0);
    expect_limit(named(all, "G54 X").more, 3.0);
    const app::ToleranceLimit& limit = named(all, "G54 X").more;
    EXPECT_EQ(limit.line, 9U);
    EXPECT_EQ(limit.pair[0], "holder");
    EXPECT_EQ(limit.pair[1], "clamp");
    EXPECT_EQ(limit_text(limit), "line 9: holder of tool 1 near clamp");
    EXPECT_TRUE(named(all, "clamp Z").less.is_open); // a lower clamp is farther away
    EXPECT_TRUE(named(all, "stock X").more.is_open); // the holder is far above the stock
}

TEST(Tolerance, OfAStickOutLetsTheHolderDownToTheStock) {
    // The holder is 15 mm above the face and must keep 1 mm.
    auto setup = plate();
    setup.tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 5.5\nstick_out = 20\n"
               "holder = [[40, 40, 50]]\n");
    setup.lengths("[[length_offset]]\nnumber = 1\nlength = 70.0\n");
    const ToleranceCase one(setup.text(), slot);
    const Tolerances all = tolerances(one);
    expect_limit(named(all, "tool 1, stick-out").less, 14.0);
    EXPECT_TRUE(named(all, "tool 1, stick-out").more.is_open);
}

TEST(Tolerance, OfALengthEndsWhereTheRapidMeetsTheStock) {
    // The rapid ends 2 mm above the face. A control that believes the tool 2 mm shorter than it is
    // lets it touch; contact up to 0.05 mm is no collision.
    const ToleranceCase one(plate().text(), slot);
    const Tolerances all = tolerances(one);
    expect_limit(named(all, "tool 1, length").less, 2.05);
    expect_limit(named(all, "G54 Z").less, 2.05);
    expect_limit(named(all, "stock Z").more, 2.05);
    EXPECT_EQ(named(all, "G54 Z").less.line, 7U);
    EXPECT_TRUE(named(all, "tool 1, length").more.is_open);
    EXPECT_TRUE(named(all, "G54 Y").more.is_open);
}

TEST(Tolerance, OfAnOffsetEndsAtTheLimitOfAnAxis) {
    auto setup = plate();
    setup.offsets("G54 = { X = -63, Y = -200, Z = -420 }\n");
    const ToleranceCase one(setup.text(), slot);
    const app::ToleranceLimit limit = named(tolerances(one), "G54 X").more;
    EXPECT_NEAR(limit.by, 3.0, 1e-6);
    EXPECT_EQ(limit_text(limit), "line 9: X reaches its limit");
}

TEST(Tolerance, OfAnOffsetCountsTheStockThatADisplacedCutLeaves) {
    // The edge of the stock at X100 is cut away up to 10 mm deep; the shank and the holder follow
    // where it was. Displaced towards -X, the edge stays 4 mm wide of the cut.
    auto setup = plate();
    setup.tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 8\nstick_out = 8\n"
               "holder = [[10, 10, 50]]\n");
    setup.lengths("[[length_offset]]\nnumber = 1\nlength = 58.0\n");
    setup.root("mesh_size = 0.4\nallowance = 0.5\n");
    const std::string edge = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X108 Y-10\n"
                             "G43 H1 Z50\nZ-6\nG1 X102 F300\nY110\nG0 X108\nZ50\nG28 G91 Z0\nM30\n";
    const ToleranceCase one(setup.text(), edge);
    const Tolerances all = tolerances(one);
    const Tolerance& x = named(all, "G54 X");
    for (const double by : {-x.less.by, -0.5 * x.less.by, 0.5 * x.more.by, x.more.by}) {
        const auto end = checked_with(one.job, x.deviation, by);
        ASSERT_TRUE(end.has_value());
        EXPECT_TRUE(end->is_clear()) << by;
    }
}

TEST(Tolerance, OfADiameterIsThatOfTheFlutes) {
    auto setup = plate();
    setup.fixture("clamp", "box = [[67.2, 40, -30], [99, 60, 0]]\n")
        .stock("box = [[0, 0, -30], [66, 100, 0]]\n");
    const ToleranceCase one(setup.text(), slot);
    const Tolerances all = tolerances(one);
    // The flutes end at X65 and must be 2 mm away from the clamp: 0.2 mm of radius.
    expect_limit(named(all, "tool 1, diameter").more, 0.4);
    EXPECT_TRUE(named(all, "tool 1, diameter").less.is_open);
}

TEST(Tolerance, IsNotGivenWhereTheVerdictIsNotClear) {
    auto setup = plate();
    setup.fixture("clamp", "box = [[60, 40, 0], [99, 60, 80]]\n");
    const ToleranceCase one(setup.text(), slot);
    EXPECT_FALSE(tolerances(one).refusal.empty());
}

TEST(Tolerance, IsNotKnownWhereTheProgramReadsTheOffset) {
    const std::string reader = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X10 Y50\n"
                               "G43 H1 Z50\n#1=#5221*2\nG0 X[#1+710]\nG0 Z60\nM30\n";
    const std::string brancher = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X10 Y50\n"
                                 "G43 H1 Z50\nIF [#5221 EQ -349.5] GOTO 10\nG0 Z60\nN10 G0 Z70\n"
                                 "M30\n";
    for (const std::string& program : {reader, brancher}) {
        const Tolerances all = tolerances(ToleranceCase(plate().text(), program));
        EXPECT_FALSE(named(all, "G54 X").unknown.empty());
        EXPECT_TRUE(named(all, "G54 Y").unknown.empty());
        EXPECT_TRUE(named(all, "stock X").unknown.empty());
    }
}

TEST(Tolerance, HoldsForEveryReadingOfAnOpenPremise) {
    // Whether G49 alone moves the machine is not stated. If it does, the tool goes down by its
    // length, 95 mm, to 5 mm above the stock.
    const std::string program = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nG43 H1 G0 Z200.\n"
                                "S1000 M3\nG0 X50. Y50.\nG0 Z100.\nG49\nM30\n";
    const auto z_of = [&](const std::string& control) {
        test_support::SetupWriter setup;
        if (!control.empty()) setup.also("[control]\n" + control + "\n");
        const Tolerances all = tolerances(ToleranceCase(setup.text(), program));
        EXPECT_EQ(all.refusal, "");
        return named(all, "G54 Z").less;
    };
    EXPECT_TRUE(z_of("\"5006#6\" = 1").is_open);
    expect_limit(z_of("\"5006#6\" = 0"), 5.05);
    expect_limit(z_of(""), 5.05);
}

TEST(Tolerance, IsNotGivenIfAnyReadingIsNotClear) {
    const std::string program = "G21 G90 G17 G40 G49 G80 G94\nG54\nT1 M6\nG43 H1 G0 Z100.\n"
                                "S1000 M3\nG0 X50. Y50.\nG0 Z50.\nG49\nM30\n";
    EXPECT_NE(tolerances(ToleranceCase(test_support::SetupWriter().text(), program)).refusal, "");
    test_support::SetupWriter stated;
    stated.also("[control]\n\"5006#6\" = 1\n");
    EXPECT_EQ(tolerances(ToleranceCase(stated.text(), program)).refusal, "");
}

TEST(Tolerance, IsNotGivenWhereAPathIsNotKnown) {
    const std::string program = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X10 Y50\n"
                                "G43 H1 Z50.\nG0 Z#500\nG0 Y60.\nM30\n";
    EXPECT_NE(tolerances(ToleranceCase(plate().text(), program)).refusal, "");
}

TEST(Tolerance, CountsTheRoundedCornerBeforeADisplacedRapid) {
    // The rapid to X60 ends 5 mm before the clamp. The next one goes to a machine position, so the
    // simulator does not know the corner between them.
    const std::string program = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X10 Y50\n"
                                "G43 H1 Z50\nZ20\nG1 Z-5 F300\nG0 Z20\nX60\nG53 G0 X-350\n"
                                "G0 Z50\nG28 G91 Z0\nM30\n";
    auto setup = plate();
    setup.fixture("clamp", "box = [[85, 40, 0], [99, 60, 80]]\n");
    expect_limit(named(tolerances(ToleranceCase(setup.text(), program)), "G54 X").more, 3.0);
    setup.machine("rapid_corner_tolerance = 0.5\n" + test_support::SetupWriter::mill());
    expect_limit(named(tolerances(ToleranceCase(setup.text(), program)), "G54 X").more, 2.5);
}

TEST(Tolerance, IsNotKnownWhereLinuxcncBlendsTheEndOfADisplacedMotion) {
    const std::string setup = R"(mesh_size = 0.8
[program]
dialect = "linuxcnc"
[machine]
file = ")" FEELER_SOURCE_DIR R"(/assets/machines/mill4.toml"
[offsets]
G54 = { X = -350, Y = -200, Z = -400, A = 0 }
[stock]
box = [[0, 0, -30], [100, 100, 0]]
frame = "G54"
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 25
stick_out = 45
holder = "BT40-ER32"
)";
    // A turns while the tool is still on its way to the machine position.
    const auto more_y = [&](const std::string& mode) {
        const std::string program = "G21 G90 G17 G40 G49 G80 G94\n" + mode
                                    + "\nT1 M6\nS3000 M3\nG54\nG43 H1\nG0 X40 Y20 Z30\n"
                                      "G1 Z-5 F1000\nX60\nZ60\n"
                                      "G53 G1 X-270 Y-150 Z-150 F2000\nG1 A20\nG53 G0 Z0\nM2\n";
        return named(tolerances(ToleranceCase(setup, program)), "G54 Y").more.by;
    };
    EXPECT_GT(more_y("G61"), 5.0);
    EXPECT_EQ(more_y("G64 P0.05 Q0"), 0.0);
}

/// Checks the set-up with a value changed up to its limits.
void expect_clear_inside(const ToleranceCase& one, const Tolerance& tolerance) {
    EXPECT_EQ(tolerance.unknown, "");
    for (const double by : {-tolerance.less.by, -0.5 * tolerance.less.by, 0.5 * tolerance.more.by,
                            tolerance.more.by}) {
        const auto end = checked_with(one.job, tolerance.deviation, by);
        ASSERT_TRUE(end.has_value());
        EXPECT_TRUE(end->is_clear()) << title_of(tolerance.deviation) << " by " << by;
    }
}

TEST(Tolerance, OfAStickOutBringsTheSpindleNearer) {
    // A nose of 80 mm, 95 mm above the tip and so 20 mm above the top of the clamp, must keep 2.
    auto setup = plate();
    setup.machine(test_support::SetupWriter::mill()
                  + "[[machine.body]]\nname = \"nose\"\naxis = \"Z\"\n"
                    "cylinder = { radius = 40, height = 50 }\n");
    setup.fixture("clamp", "box = [[85, 40, 0], [99, 60, 70]]\n");
    const ToleranceCase one(setup.text(), slot);
    const Tolerances all = tolerances(one);
    expect_limit(named(all, "tool 1, stick-out").less, 18.0);
    expect_clear_inside(one, named(all, "tool 1, stick-out"));
}

TEST(Tolerance, OfATravellingTableMovesTheMachineWithIt) {
    // The table carries the work along X, the column does not. In lines 5 to 8, at X10, the clamp
    // ends 16 mm before the column and the stock 15 mm; they must keep 2 and 1.
    auto setup = plate();
    const auto axis = [](const char* name, const char* keys) {
        return test_support::SetupWriter::axis(name, keys);
    };
    setup.machine(axis("X",
                       "kind = \"linear\"\nside = \"table\"\ndirection = [1, 0, 0]\nmin = -700\n"
                       "max = 0\nrapid = 20000\n")
                  + axis("Y", "direction = [0, 1, 0]\nmin = -450\nmax = 0\nrapid = 20000\n")
                  + axis("Z", "direction = [0, 0, 1]\nmin = -500\nmax = 0\nrapid = 15000\n")
                  + "[[machine.body]]\nname = \"column\"\naxis = \"base\"\n"
                    "box = [[105, -1000, -1000], [200, 1000, 500]]\n");
    setup.fixture("clamp", "box = [[85, 40, 0], [99, 60, 30]]\n");
    const ToleranceCase one(setup.text(), slot);
    const Tolerances all = tolerances(one);
    EXPECT_EQ(all.refusal, "");
    EXPECT_LE(named(all, "G54 X").less.by, 14.0);
    EXPECT_GT(named(all, "G54 X").less.by, 1.0);
    for (const char* title : {"G54 X", "G54 Z", "clamp X", "tool 1, stick-out"})
        expect_clear_inside(one, named(all, title));
}

TEST(Tolerance, OfAToolThatDoesNotCutAtItsCentre) {
    // It is fed down beside the stock, 8 mm from its edge. A centre of 6 mm may not come over it.
    auto setup = plate();
    setup.tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
               "shank = [[10, 10, 25]]\nholder = [[40, 40, 50]]\ncuts_at_centre = false\n"
               "centre_diameter = 6\n");
    const std::string plunge = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG0 X-8 Y50\n"
                               "G43 H1 Z50\nZ2\nG1 Z-5 F300\nG0 Z50\nG28 G91 Z0\nM30\n";
    const ToleranceCase one(setup.text(), plunge);
    const Tolerances all = tolerances(one);
    for (const char* title : {"G54 X", "stock X"}) {
        const Tolerance& x = named(all, title);
        expect_clear_inside(one, x);
        const bool towards_plus = x.deviation.quantity == Quantity::work_offset;
        expect_limit(towards_plus ? x.more : x.less, 5.05);
        const auto beyond = checked_with(one.job, x.deviation, towards_plus ? 5.3 : -5.3);
        ASSERT_TRUE(beyond.has_value());
        EXPECT_TRUE(beyond->is_wrong());
    }
}

TEST(Tolerance, IsNotGivenToADrillThatADeviationFeedsSideways) {
    // From a machine position, the drill is fed to a position under G54 straight below it.
    auto setup = plate_that_keeps_lengths();
    setup.tool("number = 1\nshape = \"drill\"\ndiameter = 10\nflute_length = 40\n"
               "shank = [[10, 10, 25]]\nholder = [[40, 40, 30]]\n");
    const std::string drill = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG43 H1 G0 Z50\n"
                              "G53 G0 X-300 Y-150\nG53 Z-320\nG1 X50 Y50 Z-5 F100\nG0 Z50\n"
                              "G28 G91 Z0\nM30\n";
    const ToleranceCase one(setup.text(), drill);
    const Tolerances all = tolerances(one);
    expect_clear_inside(one, named(all, "G54 X"));
    const auto sideways = checked_with(one.job, named(all, "G54 X").deviation, 5.0);
    ASSERT_TRUE(sideways.has_value());
    EXPECT_TRUE(sideways->is_wrong());
}

TEST(Tolerance, HoldsWhereACycleBeginsAtAMachinePosition) {
    // The cycle begins 2 mm above its retract plane, which a deviation raises above that.
    auto setup = plate_that_keeps_lengths();
    setup.tool("number = 1\nshape = \"drill\"\ndiameter = 10\nflute_length = 40\n"
               "shank = [[10, 10, 25]]\nholder = [[40, 40, 30]]\n");
    const std::string cycle = "G21 G90 G17 G40 G49 G80\nT1 M6\nS3000 M3\nG54\nG43 H1 G0 Z50\n"
                              "G0 X50 Y50\nG53 G0 Z-313\nG98 G81 X50 Y50 Z-5 R10 F100\nX70\nG80\n"
                              "G28 G91 Z0\nM30\n";
    const ToleranceCase one(setup.text(), cycle);
    const Tolerances all = tolerances(one);
    expect_clear_inside(one, named(all, "G54 Z"));
    EXPECT_GT(named(all, "G54 Z").more.by, 2.0);
}

/// A search whose answer is known: nothing fails up to `truth`; beyond, a clearance lacks `slope`
/// times the excess, if that is told.
app::ProvenLimit searched(double truth, double slope, bool is_told) {
    return app::proven_limit(20.0, [&](double by) -> std::optional<app::LimitingPair> {
        if (by <= truth) return std::nullopt;
        app::LimitingPair limit;
        if (is_told) limit.missing = slope * (by - truth);
        return limit;
    });
}

TEST(Tolerance, SearchFindsTheLimitFromBelow) {
    for (const double truth : {0.0, 0.004, 0.3, 2.05, 7.0, 19.99, 25.0})
        for (const double slope : {0.1, 0.5, 1.0, 3.0})
            for (const bool is_told : {false, true}) {
                const app::ProvenLimit found = searched(truth, slope, is_told);
                EXPECT_LE(found.by, truth);
                EXPECT_GE(found.by, std::min(truth, 20.0) - std::max(0.03, 0.08 * truth))
                    << truth << " " << slope << " " << is_told;
                EXPECT_LE(found.runs, 12U);
                EXPECT_EQ(found.limit.has_value(), truth < 20.0);
            }
}

TEST(Tolerance, SearchIsNotMisledByShortfallsThatHardlyGrow) {
    for (const double truth : {0.3, 2.05, 3.3, 7.0})
        for (const double most : {0.02, 0.3}) {
            const app::ProvenLimit found =
                app::proven_limit(20.0, [&](double by) -> std::optional<app::LimitingPair> {
                    if (by <= truth) return std::nullopt;
                    app::LimitingPair limit;
                    limit.missing = std::min(by - truth, most);
                    return limit;
                });
            EXPECT_LE(found.by, truth);
            EXPECT_GE(found.by, 0.5 * truth) << truth << " " << most;
        }
}

TEST(Tolerance, IsNotStudiedBeyondTheLimitOfWork) {
    auto setup = plate();
    setup.fixture("clamp", "box = [[85, 40, 0], [99, 60, 80]]\n");
    const ToleranceCase one(setup.text(), slot);
    const Tolerances all = tolerances(one);
    const size_t most = all.work / 2;
    const auto run = app::run_check(one.job);
    ASSERT_TRUE(run.has_value());
    const auto limited = app::tolerances_of(one.job, *run, {}, most);
    ASSERT_TRUE(limited.has_value());
    ASSERT_EQ(limited->list.size(), all.list.size());
    EXPECT_LE(limited->work, most);
    const std::string reason =
        fmt::format("not studied: the simulations reached their limit of {} tests", most);
    size_t studied = 0;
    while (studied < all.list.size() && limited->list[studied].not_studied.empty()) ++studied;
    EXPECT_GE(studied, 1U);
    EXPECT_LT(studied, all.list.size());
    for (size_t i = 0; i < all.list.size(); ++i)
        EXPECT_EQ(range_text(limited->list[i]), i < studied ? range_text(all.list[i]) : reason);
    // The first quantity that does not fit ends the study, whichever thread is faster.
    const auto again = app::tolerances_of(one.job, *run, {}, most);
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(again->work, limited->work);
}

TEST(Tolerance, EndsItsSimulationsSoonAfterTheLimitOfWork) {
    const ToleranceCase one(plate().text(), slot);
    const auto run = app::run_check(one.job);
    ASSERT_TRUE(run.has_value());
    const auto none = app::tolerances_of(one.job, *run, {}, 0);
    ASSERT_TRUE(none.has_value());
    EXPECT_EQ(none->work, 0U);
    EXPECT_EQ(none->runs, 0U);
    ASSERT_FALSE(none->list.empty());
    for (const Tolerance& tolerance : none->list) EXPECT_NE(tolerance.not_studied, "");
}

TEST(Tolerance, HoldsForRandomJobs) {
    ToleranceTally tally;
    for (unsigned seed = 1; seed <= 6; ++seed) compare_tolerances(seed, tally);
    EXPECT_GE(tally.clear_jobs, 2U);
    EXPECT_GE(tally.limits - tally.open - tally.zero, 10U);
    EXPECT_EQ(tally.wrong, 0U);
    RecordProperty("undecided", static_cast<int>(tally.undecided));
    RecordProperty("beyond", static_cast<int>(tally.beyond));
    RecordProperty("beyond_clear", static_cast<int>(tally.beyond_clear));
}

TEST(Tolerance, HoldsForRandomJobsWithRoundedRapids) {
    ToleranceTally tally;
    for (unsigned seed = 1; seed <= 4; ++seed) compare_tolerances(seed, tally, 0.04);
    EXPECT_GE(tally.clear_jobs, 1U);
    EXPECT_EQ(tally.wrong, 0U);
}

} // namespace
} // namespace app_test
