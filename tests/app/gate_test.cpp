#include <algorithm>
#include <deque>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/gate/gate.h"
#include "app/gate/grbl_protocol.h"
#include "app/gate/line_check.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(GrblProtocol, ReadsLinesAsGrblDoes) {
    EXPECT_EQ(app::as_grbl_reads("  g0 x1 (go) y-2.5 ; there"), "G0X1Y-2.5");
    EXPECT_EQ(app::as_grbl_reads("/G1\tX1"), "G1X1");
    EXPECT_EQ(app::as_grbl_reads("G0(a(b)X1"), "G0X1");
    EXPECT_EQ(app::as_grbl_reads("(no end G0X1"), "");
    EXPECT_EQ(app::as_grbl_reads("G0;X1)Y2"), "G0");
    EXPECT_EQ(app::as_grbl_reads("$J=G91 x5 f100"), "$J=G91X5F100");
}

TEST(GrblProtocol, TellsLinesApart) {
    using app::GrblLine;
    EXPECT_EQ(app::kind_of(""), GrblLine::empty);
    EXPECT_EQ(app::kind_of("G0X1"), GrblLine::code);
    EXPECT_EQ(app::kind_of("%"), GrblLine::code);
    EXPECT_EQ(app::kind_of("$J=X1F5"), GrblLine::jog);
    EXPECT_EQ(app::kind_of("$X"), GrblLine::unlock);
    EXPECT_EQ(app::kind_of("$H"), GrblLine::home);
    EXPECT_EQ(app::kind_of("$#"), GrblLine::request);
    for (const char* line :
         {"$HX", "$100=1", "$N0=G0X1", "$RST=$", "$F=A.NC", "[ESP1]", "$J", "#1=2"})
        EXPECT_EQ(app::kind_of(line), GrblLine::other) << line;
}

TEST(GrblProtocol, KnowsBytesThatActAtOnce) {
    for (const int byte : {0x3f, 0x21, 0x7e, 0x18, 0x84, 0x85, 0x90, 0x9e, 0xa0})
        EXPECT_TRUE(app::acts_at_once(static_cast<char>(byte))) << byte;
    for (const int byte : {0x47, 0x0a, 0x80, 0x8b, 0xa3, 0xc3}) // 0x8B hands over to a pendant
        EXPECT_FALSE(app::acts_at_once(static_cast<char>(byte))) << byte;
    EXPECT_TRUE(app::is_dropped(static_cast<char>(0x8b)));
    EXPECT_FALSE(app::is_dropped('G'));
}

TEST(GrblProtocol, ReadsStatusReports) {
    const auto status = app::read_status("<Hold:0|MPos:1.500,-2.000,3.250|Bf:15,128|FS:0,0>");
    ASSERT_TRUE(status && status->mpos);
    EXPECT_EQ(status->state, "Hold");
    EXPECT_EQ(*status->mpos, core::Vec3(1.5, -2.0, 3.25));
    EXPECT_FALSE(status->wpos);
    EXPECT_TRUE(app::read_status("<Idle|WPos:1,2,3,4|FS:0,0>")->wpos); // more axes
    EXPECT_FALSE(app::read_status("<Idle|MPos:1,2,x|FS:0,0>")->mpos);
    EXPECT_FALSE(app::read_status("ok"));
    EXPECT_FALSE(app::read_status("<Idle"));
}

TEST(GrblProtocol, ReadsWhatAControllerSaysOfItself) {
    app::GrblFacts facts;
    for (const char* line :
         {"[VER:1.1h.20190830:]", "[OPT:V,15,128]", "$12=0.002", "$13=0", "$100=250.000",
          "$101=80.000", "$102=400.000", "$N0=", "$N1=", "[G54:-200.000,-150.000,-60.000]",
          "[G55:0.000,0.000,0.000]", "[G56:0.000,0.000,0.000]", "[G57:0.000,0.000,0.000]",
          "[G58:0.000,0.000,0.000]", "[G59:7.000,0.000,0.000]", "[G28:-1.000,-2.000,-3.000]",
          "[G30:0.000,0.000,0.000]", "[G92:1.000,0.000,0.000]"})
        facts.take(line);
    EXPECT_FALSE(facts.has_offsets());
    facts.take("[TLO:2.500]");
    facts.take("[GC:G1 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]");
    EXPECT_TRUE(facts.has_offsets());
    EXPECT_EQ(facts.planner, 15U);
    EXPECT_EQ(facts.buffer, 128U);
    EXPECT_EQ(facts.step, core::Vec3(0.004, 0.0125, 0.0025));
    EXPECT_EQ(facts.active(), 0U);
    EXPECT_EQ(facts.zero(), core::Vec3(-199.0, -150.0, -60.0));
    EXPECT_EQ(facts.home, core::Vec3(-1.0, -2.0, -3.0));
    EXPECT_EQ(facts.length_offset, 2.5);
    EXPECT_EQ(facts.stored_line, "");
    facts.take("$N1=G0X5");
    EXPECT_EQ(facts.stored_line, "$N1=G0X5");
    facts.take("[GC:G1 G59 G17 G20]");
    EXPECT_EQ(facts.active(), 5U);
    EXPECT_EQ(facts.unknown_mode(), "");
    facts.take("[GC:G1 G17 G20]");
    EXPECT_FALSE(facts.active());
    for (const char* mode : {"G59.1", "G51", "G7", "G68"}) {
        facts.take(fmt::format("[GC:G1 G54 G17 G20 {} G90]", mode));
        EXPECT_EQ(facts.unknown_mode(), mode);
    }
    facts.take("$12=0.000");
    EXPECT_EQ(facts.arc_tolerance, 0.0);
}

TEST(GrblProtocol, ReadsReportsInInches) {
    app::GrblFacts facts;
    facts.take("$13=1");
    facts.take("[G54:-10.000,0.000,1.000]");
    EXPECT_EQ(facts.offsets[0], core::Vec3(-254.0, 0.0, 25.4));
}

TEST(GrblProtocol, ReadsNothingFromDamagedLines) {
    app::GrblFacts facts;
    for (const char* line : {"[G54:1,2", "[G54:]", "[G54:1,2]", "[TLO:]", "[OPT:]", "[OPT:V,x,y]",
                             "$100=", "$100=x", "$=", "[GC:", "[", "$", ""})
        facts.take(line);
    EXPECT_EQ(facts.seen, 0U);
    EXPECT_FALSE(facts.planner);
    EXPECT_EQ(facts.step, core::Vec3(0.0));
}

TEST(GrblProtocol, PutsNoBracketsIntoMessages) {
    EXPECT_EQ(app::grbl_message("a [b]\nc"), "[MSG:a (b) c]");
    EXPECT_EQ(app::grbl_error_in("G0: does not run (error 31)"), 31);
    EXPECT_EQ(app::grbl_error_in("G0: does not run"), 20);
}

/// A block of 100 x 60 x 20 in the middle of G54, and a clamp beside it.
const std::string bodies = R"(mesh_size = 0.5
[stock]
box = [[-50, -30, -20], [50, 30, 0]]
[[fixture]]
name = "clamp"
box = [[60, -40, -20], [80, 40, 30]]
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 30
stick_out = 100
touched_off = 0
)";

app::GrblFacts
facts_at_zero(const std::string& modes = "G0 G54 G17 G21 G90 G94 M3 M9 T0 F500 S1000") {
    app::GrblFacts facts;
    facts.modes = modes;
    facts.step = core::Vec3(0.004);
    facts.planner = 15;
    facts.seen = 0x3ff;
    return facts;
}

class CheckedLines : public ::testing::Test {
protected:
    CheckedLines() : check_(open(bodies)) {
        check_.synchronise(facts_at_zero(), core::Vec3(0, 0, 40), 0);
    }

    app::LineCheck open(const std::string& text) {
        auto check =
            app::LineCheck::open(folder_.write("router.toml", text), {.zero_is_set = true});
        if (!check) throw std::runtime_error(check.error().message);
        return *std::move(check);
    }
    app::LineVerdict judge(const std::string& line, bool is_jog = false) {
        return check_.judge(++number_, line, is_jog);
    }
    bool passes(const std::string& line) { return judge(line).answer.may_move; }

    test_support::ScopedFolder folder_;
    app::LineCheck check_;
    uint64_t number_ = 0;
};

TEST_F(CheckedLines, PassOrNotAsInACheck) {
    EXPECT_TRUE(passes("G0X53"));
    const app::LineVerdict verdict = judge("X54Z5");
    EXPECT_FALSE(verdict.answer.may_move);
    EXPECT_EQ(verdict.error, 9);
    EXPECT_THAT(verdict.answer.reason, HasSubstr("clamp"));
    EXPECT_TRUE(passes("X0")); // from X53, where the refused line began
}

TEST_F(CheckedLines, KeepTheirModes) {
    EXPECT_TRUE(passes("G91"));
    EXPECT_TRUE(passes("G0X30"));
    EXPECT_FALSE(passes("X30Z-20"));
    EXPECT_TRUE(passes("G20"));
    EXPECT_TRUE(passes("X-1"));
    EXPECT_TRUE(passes("X1.9"));
    EXPECT_FALSE(passes("X.1Z-1")); // to X55.4 and Z14.6
    EXPECT_TRUE(passes("M30"));     // G90 G1 G54 G17
    EXPECT_TRUE(passes("X0"));
}

TEST_F(CheckedLines, TellWhatGrblRefuses) {
    EXPECT_EQ(judge("M6").error, 20);
    EXPECT_EQ(judge("G0A5").error, 20);
    EXPECT_EQ(judge("#1=5").error, 1);
    EXPECT_EQ(judge("%").error, 1);
    EXPECT_EQ(judge("G0X-").error, 2);
    EXPECT_EQ(judge("G0X0000000012.5").error, 2); // Grbl reads 0
    EXPECT_EQ(judge("$J=F100", true).error, 26);  // Grbl would go to machine zero
    check_.synchronise(facts_at_zero("G1 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0"), core::Vec3(0, 0, 40),
                       number_);
    EXPECT_EQ(judge("X1").error, 22);
}

/// Grbl forgets the feed then.
TEST_F(CheckedLines, NeedAFeedAfterG93) {
    EXPECT_TRUE(passes("G93G1X1F2"));
    EXPECT_FALSE(judge("X2F2").is_plain);
    EXPECT_TRUE(passes("G94"));
    EXPECT_EQ(judge("X3").error, 22);
    EXPECT_TRUE(passes("X3F500"));
}

TEST_F(CheckedLines, LeaveNoModesAfterJogs) {
    EXPECT_TRUE(judge("$J=G91X10F100", true).answer.may_move);
    EXPECT_TRUE(passes("G0X53")); // G90 still
    EXPECT_FALSE(judge("$J=G91X1Z-30F100", true).answer.may_move);
    EXPECT_FALSE(judge("$J=G53X70Z0F100", true).answer.may_move);
    EXPECT_TRUE(judge("$J=G20G91X-1F10", true).answer.may_move);
    EXPECT_TRUE(passes("X52"));
}

TEST_F(CheckedLines, TellWhatFillsThePlanner) {
    EXPECT_TRUE(judge("G0X1").fills_planner);
    EXPECT_FALSE(judge("X1").fills_planner);
    EXPECT_FALSE(judge("X1.004").fills_planner); // about than a step
    EXPECT_TRUE(judge("X1.004").answer.may_move);
    EXPECT_FALSE(judge("G4P1").is_plain);
    EXPECT_FALSE(judge("M5").is_plain);
    EXPECT_FALSE(judge("G28.1").is_plain);
    EXPECT_TRUE(judge("N10G1X2F100S500").is_plain);
    EXPECT_TRUE(judge("G90G21G17G54").is_plain);
    for (const char* line : {"G2X3Y1R5", "G1F0X3", "G94", "G90G91", "X1X2", "G53G0X2", "X4P1"}) {
        const app::LineVerdict verdict = judge(line);
        EXPECT_FALSE(verdict.answer.may_move && verdict.is_plain) << line;
    }
    EXPECT_TRUE(judge("G10L2P2X5").asks_anew);
}

TEST_F(CheckedLines, CutOnlyWhenTheyWereMade) {
    EXPECT_TRUE(passes("G0X-60"));
    EXPECT_TRUE(passes("Z-5"));
    EXPECT_TRUE(passes("G1X0"));
    const uint64_t made = number_;
    EXPECT_TRUE(passes("X40"));
    EXPECT_TRUE(passes("G0X-60")); // along both
    check_.synchronise(facts_at_zero(), core::Vec3(-60, 0, -5), made);
    EXPECT_TRUE(passes("G0X0"));
    EXPECT_FALSE(passes("X40"));
}

TEST_F(CheckedLines, MayRetreatOnlyBeforeTheFirstThatIsClear) {
    check_.synchronise(facts_at_zero(), core::Vec3(0, 0, -5), 0); // within the stock
    EXPECT_FALSE(passes("G0X5"));
    EXPECT_TRUE(passes("Z5"));
    EXPECT_TRUE(passes("X20"));
    EXPECT_FALSE(passes("Z-5"));
}

/// Until the operator says that the zero is set, nobody knows where the bodies are.
TEST_F(CheckedLines, AreUncheckedAndFewBeforeTheZeroIsSet) {
    using Kind = app::OperatorWord::Kind;
    auto opened = app::LineCheck::open(folder_.write("router.toml", bodies), {});
    ASSERT_TRUE(opened);
    check_ = *std::move(opened);
    check_.synchronise(facts_at_zero(), core::Vec3(0, 0, 40), 0);
    EXPECT_THAT(check_.objection(), HasSubstr("$FEELER=ZERO"));
    EXPECT_TRUE(passes("G21"));
    EXPECT_TRUE(judge("$J=G91X70Z-30F500", true).answer.may_move);
    EXPECT_TRUE(passes("G38.2Z-10F50"));
    EXPECT_TRUE(passes("G0Z50"));
    EXPECT_TRUE(passes("G10L20P1X5"));
    EXPECT_THAT(judge("G0X1").answer.reason, HasSubstr("$FEELER=ZERO"));
    EXPECT_THAT(judge("G0Z30").answer.reason, HasSubstr("$FEELER=ZERO"));
    check_.synchronise(facts_at_zero(), core::Vec3(0, 0, 40), number_,
                       app::OperatorWord{Kind::zero_is_set, {}});
    EXPECT_EQ(check_.objection(), "");
    EXPECT_TRUE(passes("G0X1"));
    EXPECT_FALSE(passes("G0X70Z5"));
    check_.synchronise(facts_at_zero(), core::Vec3(1, 0, 40), number_,
                       app::OperatorWord{Kind::sets_up, {}});
    EXPECT_FALSE(passes("G0X2"));
    EXPECT_THAT(check_.why_not({Kind::sets_up, 5}), HasSubstr("does not describe tool 5"));
}

/// A program cannot move the bodies by setting an offset.
TEST_F(CheckedLines, DoNotMoveTheBodies) {
    EXPECT_TRUE(judge("G92Z80").asks_anew);
    EXPECT_THAT(judge("G0X70").answer.reason,
                HasSubstr("G54 with G92 Z is -40.000 on the control"));
    app::GrblFacts facts = facts_at_zero();
    facts.axis_offset.z = -40.0;
    check_.synchronise(facts, core::Vec3(0, 0, 40), number_);
    EXPECT_THAT(check_.objection(), HasSubstr("$FEELER=ZERO"));
    EXPECT_FALSE(passes("G0X70"));
    check_.synchronise(facts, core::Vec3(0, 0, 40), number_,
                       app::OperatorWord{app::OperatorWord::Kind::zero_is_set, {}});
    EXPECT_TRUE(passes("G0X70"));    // 80 above the clamp's lower end
    EXPECT_FALSE(passes("G0X0Z-1")); // the stock is 40 lower, too
    check_.synchronise(facts_at_zero("G0 G55 G17 G21 G90 G94 M3 M9 T0 F500 S1000"),
                       core::Vec3(0, 0, 40), number_);
    EXPECT_THAT(check_.objection(), HasSubstr("G55 is in use"));
}

/// Grbl takes them for full circles.
TEST_F(CheckedLines, AreNoFlatArcs) {
    check_.synchronise(facts_at_zero(), core::Vec3(0, 0, 5), 0);
    EXPECT_THAT(judge("G2X0.001Y0R2500").answer.reason, HasSubstr("may make a full circle"));
    EXPECT_TRUE(passes("G2X0.001Y0R5"));
    EXPECT_TRUE(passes("G2X1R100"));
    EXPECT_TRUE(passes("G2X1Y0I1J0")); // a full circle
}

/// Grbl goes along the circle of the start, also where the end is on a smaller one, and computes
/// the centre of an arc with a radius in single floats.
TEST_F(CheckedLines, MayBeArcsBesideTheirPaths) {
    const auto is_clear = [&](double x, const char* line) {
        check_.synchronise(facts_at_zero(), core::Vec3(x, -170.6681, 20), number_);
        return passes(line);
    };
    // The outermost point keeps 2.05 of 2 mm from the clamp on a spiral, and 1.8 on the circle.
    EXPECT_FALSE(is_clear(23.1066, "G3X22.6462Y170.5005I-468.9066J170.6681F500"));
    EXPECT_TRUE(is_clear(22.6066, "G3X22.1462Y170.5005I-468.9066J170.6681F500"));
    EXPECT_TRUE(is_clear(22.8066, "G3X22.8066Y170.6681I-468.9066J170.6681F500")); // a circle
    // Nearly a semicircle, at 2.03 and 2.3 mm: its centre may be 0.08 mm off.
    EXPECT_FALSE(is_clear(-117.6155, "G3X-117.6155Y170.6681R170.66812F500"));
    EXPECT_TRUE(is_clear(-117.8855, "G3X-117.8855Y170.6681R170.66812F500"));
}

/// Without a model nothing passes.
TEST_F(CheckedLines, SayWhyThereIsNoModel) {
    check_ = open("memory_limit = 0.001\n" + bodies);
    check_.synchronise(facts_at_zero(), core::Vec3(0, 0, 40), 0);
    EXPECT_FALSE(check_.is_set_up());
    EXPECT_THAT(check_.objection(), HasSubstr("scan lines"));
    EXPECT_FALSE(passes("G0X1"));
}

/// After a tool change Z of the control is another, for the centres of upright arcs, too.
TEST_F(CheckedLines, ShiftUprightArcsByTheToolsLength) {
    using Kind = app::OperatorWord::Kind;
    check_ =
        open("[program]\ntool_at_start = 1\n[[tool]]\nnumber = 2\nshape = \"flat\"\ndiameter = 10\n"
             "flute_length = 30\nstick_out = 60\ntouched_off = 0\n"
             + bodies.substr(bodies.find("[stock]")));
    app::GrblFacts facts = facts_at_zero();
    check_.synchronise(facts, core::Vec3(-60, 0, -3), 0);
    EXPECT_TRUE(passes("G1X-40"));
    check_.synchronise(facts, core::Vec3(-40, 0, -3), number_, app::OperatorWord{Kind::sets_up, 2});
    facts.offsets[0].z = -40.0;
    check_.synchronise(facts, core::Vec3(45, 0, 0), number_,
                       app::OperatorWord{Kind::zero_is_set, {}});
    ASSERT_EQ(check_.objection(), "");
    EXPECT_TRUE(passes("G18G3X95Z40R25"));  // over the clamp, up to Z65
    EXPECT_FALSE(passes("G18G3X45Z40R25")); // back below it, down to Z15
    EXPECT_TRUE(passes("G18G2X45Z40R25"));
}

TEST_F(CheckedLines, NeedFineArcsOfGrbl) {
    app::GrblFacts facts = facts_at_zero();
    facts.arc_tolerance = 0.5;
    check_.synchronise(facts, core::Vec3(0, 0, 40), 0);
    EXPECT_TRUE(passes("G1X1"));
    EXPECT_THAT(judge("G2X3R1").answer.reason, HasSubstr("$12"));
}

/// What only a full circle would cut stays.
TEST_F(CheckedLines, CutNoFullCircleOfAFlatArc) {
    EXPECT_TRUE(passes("G0X-60"));
    EXPECT_TRUE(passes("Z-2"));
    EXPECT_TRUE(passes("G1X0"));
    EXPECT_TRUE(passes("G2X0.001I15")); // a circle to X30, or nothing
    EXPECT_TRUE(passes("G0X-60"));
    EXPECT_FALSE(passes("G0X30"));
}

/// A spindle that is switched by hand does not turn again after M5.
TEST_F(CheckedLines, SwitchTheSpindleOff) {
    check_ = open(bodies + "[program]\nspindle_at_start = \"clockwise\"\n");
    const auto off = facts_at_zero("G0 G54 G17 G21 G90 G94 M5 M9 T0 F500 S0");
    check_.synchronise(off, core::Vec3(-60, 0, -3), 0);
    EXPECT_TRUE(passes("G1X-50F100"));
    EXPECT_TRUE(passes("M5"));
    check_.synchronise(off, core::Vec3(-50, 0, -3), number_);
    EXPECT_FALSE(passes("G1X-40"));
}

TEST_F(CheckedLines, KnowOnlyToolsOfGrbl) {
    EXPECT_EQ(judge("T300").error, 38);
    EXPECT_TRUE(passes("G0X1"));
    EXPECT_FALSE(passes("T2X70Z5")); // refused, so it calls nothing
    EXPECT_TRUE(passes("X2"));
    EXPECT_TRUE(passes("T2"));
    EXPECT_THAT(judge("X3").answer.reason, HasSubstr("calls tool 2"));
    // Grbl forgets T at a reset, and the gate does not.
    app::GrblFacts facts = facts_at_zero();
    facts.is_reset = true;
    check_.synchronise(facts, core::Vec3(2, 0, 40), number_);
    EXPECT_FALSE(passes("X3"));
    EXPECT_TRUE(passes("T1"));
    EXPECT_TRUE(passes("X3"));
    EXPECT_EQ(judge("T2M6").error, 20);
    EXPECT_FALSE(passes("X4"));
}

/// The clearance of many small steps does not add up.
TEST_F(CheckedLines, AreJogsFromWhereverTheLastOneMayHaveEnded) {
    check_.synchronise(facts_at_zero(), core::Vec3(100, 0, 5), number_);
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(judge("$J=G91Y1F1500", true).answer.may_move);
    EXPECT_TRUE(judge("$J=Y60F1500", true).answer.may_move);
    const app::LineVerdict beside = judge("$J=X0F1500", true); // the clamp is on the way
    EXPECT_FALSE(beside.answer.may_move);
    EXPECT_TRUE(beside.asks_first);
    EXPECT_TRUE(judge("$J=G91X20F1500", true).answer.may_move);
    check_.synchronise(facts_at_zero(), core::Vec3(120, 60, 5), number_);
    EXPECT_TRUE(judge("$J=X0F1500", true).answer.may_move);
    EXPECT_FALSE(judge("$J=X120Y0F1500", true).answer.may_move);
}

TEST_F(CheckedLines, DoNotCreepTowardsABody) {
    check_.synchronise(facts_at_zero(), core::Vec3(54.5, 0, 5), 0); // 0.5 from the clamp
    EXPECT_TRUE(passes("G91G0X0.009"));
    EXPECT_FALSE(passes("X0.009"));
    check_.synchronise(facts_at_zero(), core::Vec3(54.509, 0, 5), number_); // as after $X
    EXPECT_FALSE(passes("G91G0X0.009"));
    EXPECT_TRUE(passes("G91G0X-1"));
    EXPECT_FALSE(passes("X0.5"));
    EXPECT_TRUE(passes("X-0.1"));
}

/// Grbl with a planner of three blocks that never moves, and a sender.
class GatedSender : public ::testing::Test {
protected:
    GatedSender()
        : check_(app::LineCheck::open(folder_.write("router.toml", bodies), {.zero_is_set = true})
                     .value()) {}

    app::Gate::Links links() {
        return {[this](std::string_view bytes) { take(bytes, to_sender_, at_sender_); },
                [this](std::string_view bytes) {
                    if (bytes == "?")
                        ++asked_;
                    else
                        at_controller_ += bytes;
                },
                [](const std::string&) {},
                [this](auto work, auto done) {
                    tasks_.push_back([this, work, done] {
                        work(check_);
                        done();
                    });
                }};
    }
    static void take(std::string_view bytes, std::string& rest, std::vector<std::string>& lines) {
        rest += bytes;
        for (size_t end = rest.find("\r\n"); end != std::string::npos; end = rest.find("\r\n")) {
            if (rest[0] != '<') lines.push_back(rest.substr(0, end));
            rest.erase(0, end + 2);
        }
    }
    void check_all() {
        while (!tasks_.empty()) {
            const auto task = std::move(tasks_.front());
            tasks_.pop_front();
            task();
        }
    }
    std::string answer_to(const std::string& line) {
        if (line == "$I") return "[OPT:V,3,128]\r\nok\r\n";
        if (line == "$$") return "$100=" + steps_ + "\r\n$101=250\r\n$102=250\r\n$13=0\r\nok\r\n";
        if (line == "$G") return "[GC:G0 G54 G17 G21 G90 G94 M3 M9 T0 F500 S1000]\r\nok\r\n";
        if (line != "$#") return "ok\r\n";
        std::string text;
        for (const char* name : {"G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30", "G92"})
            text += fmt::format("[{}:0.000,0.000,0.000]\r\n", name);
        return text + "[TLO:0.000]\r\nok\r\n";
    }
    /// The place where a line with absolute positions ends.
    void go_to(const std::string& line) {
        std::array<double, 3> at{};
        std::sscanf(position_.c_str(), "%lf,%lf,%lf", &at[0], &at[1], &at[2]);
        for (size_t i = 0; i < 3; ++i)
            if (const size_t word = line.find("XYZ"[i]); word != std::string::npos)
                at[i] = std::strtod(line.c_str() + word + 1, nullptr);
        position_ = fmt::format("{:.3f},{:.3f},{:.3f}", at[0], at[1], at[2]);
    }
    /// Answers all requests for the status, and up to `most` lines.
    void play_controller(size_t most = 1000) {
        check_all();
        while (true) {
            const size_t end = at_controller_.find('\n');
            if (end != std::string::npos && most > 0) {
                const std::string line = at_controller_.substr(0, end);
                at_controller_.erase(0, end + 1);
                if (line[0] != '$') {
                    run_.push_back(line);
                    go_to(line);
                }
                --most;
                gate_.from_controller(answer_to(line));
            } else if (asked_ > 0) {
                --asked_;
                time_ += 300;
                gate_.tick(time_);
                gate_.from_controller(fmt::format("<{}|MPos:{}|FS:0,0>\r\n", state_, position_));
            } else {
                return;
            }
            check_all();
        }
    }
    void begin() {
        gate_.from_controller("Grbl 1.1h ['$' for help]\r\n");
        time_ = 5000;
        gate_.tick(time_);
        play_controller();
        at_sender_.clear();
    }
    /// As an operator, who reads the number that the gate shows.
    void say(const std::string& word) {
        send(word + "\n");
        for (const std::string& line : std::vector(at_sender_)) {
            const size_t at = line.find("send " + word + "-");
            if (at != std::string::npos) send(line.substr(at + 5, word.size() + 4) + "\n");
        }
    }
    void send(const std::string& text) {
        gate_.from_sender(text);
        play_controller();
    }

    test_support::ScopedFolder folder_;
    app::LineCheck check_;
    std::string to_sender_, at_controller_;
    std::vector<std::string> at_sender_, run_;
    std::deque<std::function<void()>> tasks_;
    std::string steps_ = "250", state_ = "Idle", position_ = "0.000,0.000,40.000";
    int64_t time_ = 0;
    int asked_ = 0; // for the status
    app::Gate gate_{links()};
};

/// While the gate asks, its own requests are on their way.
TEST_F(GatedSender, IsNotToldToResetAControllerThatIsAsked) {
    begin();
    time_ += 10'000; // nothing was sent for a while
    gate_.tick(time_);
    gate_.from_sender("$X\nG0X1\n");
    for (int i = 0; i < 3; ++i) {
        play_controller(1);
        gate_.from_controller("<Idle|MPos:0.000,0.000,40.000|FS:0,0>\r\n");
    }
    play_controller();
    for (const std::string& line : at_sender_)
        EXPECT_EQ(line.find("does not answer"), std::string::npos) << line;
    EXPECT_THAT(run_, ElementsAre("G0X1"));
}

TEST_F(GatedSender, IsGreetedOnceAndNotBehindItsLines) {
    begin();
    gate_.sender_came();
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n"); // it has reset itself
    time_ += 1000;
    send("\n$G\n");
    gate_.tick(time_);
    play_controller();
    EXPECT_EQ(std::count_if(at_sender_.begin(), at_sender_.end(),
                            [](const std::string& line) { return line.starts_with("Grbl"); }),
              1);
    at_sender_.clear();
    gate_.sender_came();
    send("\n");
    time_ += 1000;
    gate_.tick(time_);
    play_controller();
    for (const std::string& line : at_sender_) EXPECT_FALSE(line.starts_with("Grbl")) << line;
}

TEST_F(GatedSender, IsToldThatTheStatusIsOfAnOlderGrbl) {
    begin();
    gate_.from_controller("<Idle,MPos:0.000,0.000,40.000,WPos:0.000,0.000,0.000>\r\n");
    gate_.from_controller("<Idle,MPos:0.000,0.000,40.000,WPos:0.000,0.000,0.000>\r\n");
    ASSERT_EQ(at_sender_.size(), 1U);
    EXPECT_NE(at_sender_[0].find("needs Grbl 1.1"), std::string::npos);
}

TEST_F(GatedSender, HoldsTheFeedWithTheBytesOfGrblHal) {
    begin();
    gate_.from_sender("\x82");
    EXPECT_EQ(at_controller_, "\x82");
    at_controller_.clear();
    gate_.from_sender("\x19");
    EXPECT_EQ(at_controller_, "!");
    ASSERT_EQ(at_sender_.size(), 1U);
    EXPECT_NE(at_sender_[0].find("as a feed hold"), std::string::npos);
}

TEST_F(GatedSender, IsWarnedOfLostStepsAfterAnAlarmInMotion) {
    begin();
    send("G0X5\n");
    gate_.from_controller("ALARM:3\r\nGrbl 1.1h ['$' for help]\r\n");
    at_sender_.clear();
    send("$X\n");
    EXPECT_THAT(at_sender_, Contains(HasSubstr("may have lost steps")));
}

TEST_F(GatedSender, MustHomeAgainIfTheControllerIsResetMeanwhile) {
    begin();
    gate_.from_sender("$H\n");
    check_all();
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n"); // and no alarm
    at_controller_.clear();
    send("$X\nG0X1\n");
    EXPECT_THAT(at_sender_, Contains(HasSubstr("homing was not finished")));
    EXPECT_TRUE(run_.empty());
}

/// An axis of 8 steps a millimetre stands up to half a step from where a line ends.
TEST_F(GatedSender, AllowsForTheStepsOfAnAxis) {
    steps_ = "8";
    begin();
    send("G0X53\n");
    position_ = "53.110,0.000,40.000";
    gate_.from_sender("?");
    play_controller();
    EXPECT_THAT(at_sender_, Not(Contains(HasSubstr("does not stand where"))));
    position_ = "53.120,0.000,40.000";
    gate_.from_sender("?");
    play_controller();
    EXPECT_THAT(at_sender_, Contains(HasSubstr("does not stand where")));
}

TEST_F(GatedSender, GetsRepliesInOrder) {
    begin();
    send("G0X1\n(nothing)\nG0X70Z5\n\n$G\nG0X2\n");
    ASSERT_EQ(at_sender_.size(), 8U);
    EXPECT_THAT(at_sender_, ElementsAre("ok", "ok", HasSubstr("stops before G0X70Z5"), "error:9",
                                        "ok", StartsWith("[GC:"), "ok", "error:9"));
    EXPECT_THAT(run_, ElementsAre("G0X1"));
}

/// A line was lost, or somebody else has moved the machine.
TEST_F(GatedSender, AsksAgainIfTheMachineIsNotWhereItsLastLineEnds) {
    begin();
    send("G0X53\n"); // and Z40
    position_ = "53.020,0.000,40.000";
    const auto report = [&] {
        gate_.from_sender("?");
        play_controller();
    };
    report();
    report();
    send("G0X100\n"); // above the clamp
    EXPECT_THAT(at_sender_, ElementsAre("ok", "ok"));
    position_ = "53.000,0.000,20.000"; // it did not go there, and is lower
    report();
    report();
    EXPECT_THAT(at_sender_.back(), HasSubstr("does not stand where its last line ends"));
    send("G0X100\n");
    EXPECT_THAT(at_sender_.back(), StartsWith("error"));
    EXPECT_THAT(run_, ElementsAre("G0X53", "G0X100"));
}

TEST_F(GatedSender, SaysWhenTheControllerSaysNothing) {
    begin();
    gate_.from_sender("G2X1Y0I.5J0\n");
    check_all();
    for (int i = 0; i < 50; ++i) gate_.tick(time_ += 100);
    EXPECT_THAT(at_sender_, Contains(HasSubstr("does not answer, nor")));
}

/// Grbl reports nothing while it homes.
TEST_F(GatedSender, MayHomeWithoutAWordOfTheController) {
    begin();
    gate_.from_sender("$H\n");
    check_all();
    EXPECT_EQ(at_controller_, "$H\n");
    for (int i = 0; i < 200; ++i) gate_.tick(time_ += 100);
    EXPECT_TRUE(at_sender_.empty());
}

/// It stands, so nothing keeps it from answering.
TEST_F(GatedSender, SaysWhenAnAnswerIsLost) {
    begin();
    const auto stand = [&](int cycles) {
        for (int i = 0; i < cycles; ++i) {
            gate_.tick(time_ += 100);
            gate_.from_controller("<Idle|MPos:0.000,0.000,40.000|FS:0,0>\r\n");
        }
    };
    for (const char* dwell : {"G4P20\n", "G04 P20\n"}) {
        gate_.from_sender(dwell);
        check_all();
        stand(100);
        gate_.from_controller("ok\r\n");
        EXPECT_THAT(at_sender_, ElementsAre("ok"));
        at_sender_.clear();
    }
    gate_.from_sender("M8\n");
    check_all();
    stand(30);
    EXPECT_THAT(at_sender_, Contains(HasSubstr("does not answer. Reset")));
}

TEST_F(GatedSender, FillsTheControllersBufferAndNoMore) {
    begin();
    std::string text;
    for (int i = 0; i < 40; ++i) text += fmt::format("G1X{}.25Y0\n", i);
    gate_.from_sender(text);
    check_all();
    EXPECT_LE(at_controller_.size(), 127U);
    EXPECT_GE(at_controller_.size(), 110U);
    play_controller();
    EXPECT_EQ(run_.size(), 40U);
    EXPECT_EQ(at_sender_.size(), 40U);
}

TEST_F(GatedSender, SendsLinesOfOtherKindsAlone) {
    begin();
    gate_.from_sender("G1X1\nM5\nG1X2\n");
    check_all();
    EXPECT_EQ(at_controller_, "G1X1\n");
    play_controller(1);
    EXPECT_EQ(at_controller_, "M5\n");
    play_controller(1);
    EXPECT_EQ(at_controller_, "G1X2\n");
}

TEST_F(GatedSender, ReachesTheControllerAtOnceWithSomeBytes) {
    begin();
    gate_.from_sender("G1X1\nG1X");
    gate_.from_sender("!");
    EXPECT_EQ(at_controller_, "!"); // before the line, whose check has not begun
    gate_.from_sender("\x8b"
                      "2\n");
    check_all();
    EXPECT_EQ(at_controller_, "!G1X1\nG1X2\n");
}

/// Of lines that Grbl has taken in, only those that have left its planner count as cut.
TEST_F(GatedSender, CountsLinesAsCutWhenTheyHaveLeftThePlanner) {
    begin();
    send("G0X-60\nZ-5\n");
    std::string text;
    for (int x = -59; x <= -30; ++x) text += fmt::format("G1X{}\n", x);
    send(text);
    ASSERT_EQ(run_.size(), 32U);
    gate_.from_sender("\x18");
    EXPECT_THAT(at_controller_, EndsWith("\x18"));
    at_controller_.clear();
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n");
    position_ = "-60.000,0.000,-5.000";
    at_sender_.clear();
    // 3 blocks in the planner and 8 behind it: the last of 32 lines that counts ends at X-41.
    send("G0X-41\n");
    EXPECT_THAT(at_sender_.back(), "ok");
    send("G0X-40\n");
    EXPECT_THAT(at_sender_.back(), "error:9");
}

TEST_F(GatedSender, LearnsNothingFromIdleDuringAReset) {
    begin();
    send("G0X-60\nZ-5\nG1X-40\n");
    gate_.from_sender("\x18");
    gate_.from_controller("ALARM:3\r\nok\r\nGrbl 1.1h ['$' for help]\r\n");
    at_controller_.clear();
    position_ = "-60.000,0.000,-5.000";
    at_sender_.clear();
    send("G0X-40\n");
    EXPECT_THAT(at_sender_.back(), "error:9");
    EXPECT_THAT(at_sender_[at_sender_.size() - 2], HasSubstr("stock"));
}

TEST_F(GatedSender, HoldsTheFeedWhenGrblRefusesALineAndHasOthers) {
    begin();
    gate_.from_sender("G1X1\nG1X2\nG1X3\n");
    check_all();
    at_controller_.clear();
    gate_.from_controller("error:20\r\n");
    EXPECT_EQ(at_controller_, "!");
    at_controller_.clear();
    gate_.from_controller("ok\r\nok\r\n");
    EXPECT_THAT(at_sender_, ElementsAre(HasSubstr("Grbl refused G1X1"), "error:20", "ok", "ok"));
    send("G1X4\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
    EXPECT_EQ(at_controller_, "");
}

TEST_F(GatedSender, DoesNotResumeAfterThat) {
    begin();
    gate_.from_sender("G1X1\nG1X2\n");
    check_all();
    gate_.from_controller("error:20\r\n");
    at_controller_.clear();
    gate_.from_sender("~");
    EXPECT_EQ(at_controller_, "");
    gate_.from_controller("ok\r\n");
    send("$X\nG1X4\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
    gate_.from_sender("\x18");
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n");
    at_controller_.clear();
    send("G1X4\n");
    EXPECT_EQ(at_sender_.back(), "ok");
}

TEST_F(GatedSender, CancelsAJogAgainThatWasOnItsWay) {
    begin();
    gate_.from_sender("$J=X1F100\n$J=X2F100\n");
    check_all();
    EXPECT_EQ(at_controller_, "$J=X1F100\n");
    at_controller_.clear();
    gate_.from_sender("\x85");
    EXPECT_EQ(at_controller_, "\x85");
    gate_.from_controller("ok\r\n");
    EXPECT_EQ(at_controller_, "\x85\x85");
    EXPECT_THAT(at_sender_, ElementsAre("ok", "ok"));
}

TEST_F(GatedSender, NeverFillsThePlannerWithJogs) {
    begin();
    std::string text;
    for (int i = 1; i <= 10; ++i) text += fmt::format("$J=X{}F100\n", i);
    state_ = "Jog";
    gate_.from_sender(text);
    for (int i = 0; i < 10; ++i) {
        check_all();
        const size_t end = at_controller_.find('\n');
        if (end == std::string::npos) break;
        run_.push_back(at_controller_.substr(0, end));
        at_controller_.clear();
        gate_.from_controller("ok\r\n");
    }
    EXPECT_LE(run_.size(), 1U); // of three blocks
    state_ = "Idle";
    asked_ = 1;
    play_controller();
    EXPECT_EQ(std::count(at_sender_.begin(), at_sender_.end(), "ok"), 10);
}

TEST_F(GatedSender, LosesWhatFollowsTheEndOfCheckMode) {
    begin();
    send("$C\nG0X53\n");
    EXPECT_THAT(run_, ElementsAre("G0X53"));
    state_ = "Check";
    gate_.from_sender("$C\nG0X0\n");
    play_controller();
    EXPECT_THAT(run_, ElementsAre("G0X53"));
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n");
    state_ = "Idle";
    play_controller();
    EXPECT_THAT(run_, ElementsAre("G0X53"));
    send("G0X1\n");
    EXPECT_THAT(run_, ElementsAre("G0X53", "G0X1"));
}

TEST_F(GatedSender, IsToldThatTheControllerWasRestarted) {
    begin();
    send("G0X5\n");
    gate_.from_controller("<Idle|MPos:5.000,0.000,40.000|FS:0,0>\r\n");
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n");
    position_ = "0.000,0.000,0.000";
    send("G0X9\n");
    EXPECT_THAT(at_sender_, ::testing::Contains(HasSubstr("was restarted")));
    EXPECT_EQ(at_sender_.back(), "error:9");
    send("$X\n");
    say("$FEELER=NEW");
    EXPECT_EQ(at_sender_.back(), "ok");
}

/// A hold button on the board cancels jogs, and the gate does not hear of it.
TEST_F(GatedSender, TakesNothingForCutByJogs) {
    begin();
    send("G0X-60\nZ-3\n");
    position_ = "-60.000,0.000,-3.000";
    send("$J=X40F100\n");
    position_ = "-35.000,0.000,-3.000";
    send("G0X30\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
}

TEST_F(GatedSender, MustConfirmTheZeroAfterTheFirstHoming) {
    begin();
    send("G0X5\n$H\nG0X6\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
    EXPECT_THAT(at_sender_, ::testing::Contains(HasSubstr("was homed after the zero was set")));
    send("$X\n");
    at_sender_.clear();
    say("$FEELER=NEW");
    send("$H\nG0X6\n");
    EXPECT_EQ(at_sender_.back(), "ok");
}

/// What the controller said of itself is of before the homing.
TEST_F(GatedSender, MayHomeWhileTheGateAsks) {
    gate_.from_controller("Grbl 1.1h ['$' for help]\r\n");
    time_ = 5000;
    gate_.tick(time_);
    gate_.from_controller(fmt::format("<Idle|MPos:{}|FS:0,0>\r\n", position_));
    ASSERT_EQ(at_controller_, "$I\n");
    gate_.from_sender("$H\n");
    position_ = "100.000,0.000,5.000";
    play_controller();
    send("G0X50\n"); // clear from where the machine was, and not from there
    EXPECT_EQ(at_sender_.back(), "error:9");
    EXPECT_THAT(at_sender_, ::testing::Contains(HasSubstr("was homed after the zero was set")));
    EXPECT_THAT(run_, ElementsAre());
}

TEST_F(GatedSender, IsToldWhatGrblDoesNotUnderstand) {
    begin();
    send("#1=5\n");
    EXPECT_THAT(at_sender_, ::testing::Contains(HasSubstr("does not understand #1=5")));
    EXPECT_EQ(at_sender_.back(), "error:3");
}

TEST_F(GatedSender, IsToldThatTheSetupWasEdited) {
    begin();
    send("G0X5\n");
    EXPECT_EQ(at_sender_.back(), "ok");
    folder_.write("router.toml", bodies + "# corrected\n");
    send("$X\nG0X6\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
    EXPECT_THAT(at_sender_, ::testing::Contains(HasSubstr("set-up file has changed")));
}

/// It may have been cancelled by a button on the board.
TEST_F(GatedSender, JogsFromWhereverAJogBeforeMayHaveEnded) {
    begin();
    send("G0X100\nZ5\n");
    position_ = "100.000,0.000,5.000";
    send("$J=Y60F1500\n");
    position_ = "100.000,30.000,5.000";
    send("$J=X0F1500\n"); // through the clamp
    EXPECT_EQ(at_sender_.back(), "error:9");
    send("$J=Y60F1500\n");
    position_ = "100.000,60.000,5.000";
    send("$J=X0F1500\n");
    EXPECT_EQ(at_sender_.back(), "ok");
}

TEST_F(GatedSender, GetsAnAnswerToCheckModeInAnAlarm) {
    begin();
    state_ = "Alarm";
    send("$X\n$C\n");
    EXPECT_EQ(at_sender_.back(), "error:8");
}

TEST_F(GatedSender, SpeaksToTheOperator) {
    begin();
    for (const char* line : {"$FEELER=T", "$FEELER=T99999999999", "$FEELER=T-1", "$FEELER=T7",
                             "$FEELER=X", "$FEELERS", "$J", "[ESP1]"}) {
        say(line);
        EXPECT_EQ(at_sender_.back(), "error:3") << line;
    }
    send("$FEELER\n");
    EXPECT_THAT(at_sender_[at_sender_.size() - 2], HasSubstr("0 lines passed"));
    say("$FEELER=SETUP");
    EXPECT_EQ(at_sender_.back(), "ok");
    send("G0X1\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
    send("$X\n");
    at_sender_.clear();
    say("$FEELER=ZERO");
    send("G0X1\n");
    EXPECT_EQ(at_sender_.back(), "ok");
}

/// A program does not know the number.
TEST_F(GatedSender, HearsWordsOnlyWithTheNumberThatItShows) {
    begin();
    send("$FEELER=SETUP\n$FEELER=SETUP-\n$FEELER=SETUP-0\n$FEELER=SETUP-1x\n");
    EXPECT_EQ(std::count(at_sender_.begin(), at_sender_.end(), "error:3"), 3);
    at_sender_.clear();
    send("$FEELER=NEW\n"); // its number is not that of another word
    const size_t at = at_sender_[0].find("NEW-");
    ASSERT_NE(at, std::string::npos) << at_sender_[0];
    send("$FEELER=SETUP" + at_sender_[0].substr(at + 3, 4) + "\n");
    EXPECT_EQ(at_sender_.back(), "error:3");
    send("$FEELER=NEW" + at_sender_[0].substr(at + 3, 4) + "\n"); // and it holds once
    EXPECT_EQ(at_sender_.back(), "error:3");
    send("G0X70Z0\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
}

/// A word that was refused has no effect later.
TEST_F(GatedSender, ForgetsWordsThatCouldNotTakeEffect) {
    begin();
    say("$FEELER=SETUP");
    state_ = "Alarm";
    gate_.from_controller("ALARM:1\r\n");
    at_sender_.clear();
    say("$FEELER=ZERO");
    EXPECT_EQ(at_sender_.back(), "error:9");
    state_ = "Idle";
    send("$X\nG0X1\n");
    EXPECT_EQ(at_sender_.back(), "error:9");
    EXPECT_THAT(at_sender_[at_sender_.size() - 2], HasSubstr("$FEELER=ZERO"));
}

TEST_F(GatedSender, IsGreetedAlsoInAnAlarm) {
    begin();
    state_ = "Alarm";
    gate_.sender_came();
    gate_.tick(time_ += 1000);
    play_controller();
    EXPECT_THAT(at_sender_, ElementsAre(StartsWith("Grbl")));
}

TEST_F(GatedSender, IsToldThatAControllerDoesNotComeBack) {
    begin();
    gate_.from_sender("\x18");
    for (int i = 0; i < 40; ++i) gate_.tick(time_ += 100);
    EXPECT_THAT(at_sender_, ElementsAre(HasSubstr("does not answer after the reset")));
}

TEST_F(GatedSender, LeavesACheckModeThatWasOnAtTheStart) {
    state_ = "Check";
    begin();
    send("$C\n");
    EXPECT_EQ(at_sender_.back(), "ok");
}

TEST_F(GatedSender, IsToldOfAControllerThatDoesNotAnswer) {
    begin();
    gate_.from_sender("G1X1\n");
    check_all();
    at_controller_.clear();
    for (int i = 0; i < 40; ++i) {
        gate_.tick(time_ += 100);
        if (asked_ > 0) gate_.from_controller("<Idle|MPos:0,0,40|FS:0,0>\r\n");
        asked_ = 0;
    }
    EXPECT_THAT(at_sender_, ElementsAre(HasSubstr("does not answer")));
}

TEST_F(GatedSender, IsLockedWhileTheControllerIsInAlarm) {
    begin();
    gate_.from_controller("ALARM:1\r\n");
    state_ = "Alarm";
    send("G0X1\n$J=X1F100\n$G\n");
    EXPECT_THAT(at_sender_, Not(::testing::Contains(HasSubstr("MSG"))));
    EXPECT_EQ(std::count(at_sender_.begin(), at_sender_.end(), "error:9"), 2);
    EXPECT_TRUE(run_.empty());
    state_ = "Idle";
    send("$X\nG0X1\n");
    EXPECT_EQ(at_sender_.back(), "ok");
}

} // namespace
} // namespace app_test
