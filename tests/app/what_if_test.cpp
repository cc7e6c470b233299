#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/run_state.h"
#include "app/debug/debug_session.h"
#include "core/sim/setup.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"

namespace app_test {
namespace {

using app::DebugSession;
using app::WhatIf;
using core::OffsetNumber;
using core::ToolNumber;
using test_support::ScopedFolder;
using test_support::SetupWriter;
using testing::HasSubstr;

/// A session for a program, with its own files.
struct Opened {
    ScopedFolder folder;
    std::unique_ptr<DebugSession> session;

    Opened(const SetupWriter& setup, const std::string& program) {
        auto opened = DebugSession::open({.program = folder.write("p.nc", program),
                                          .setup = folder.write("s.toml", setup.text()),
                                          .allowance = {},
                                          .mesh_size = 2.0});
        EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
        if (opened) session = *std::move(opened);
    }
    DebugSession* operator->() const { return session.get(); }

    /// Goes to the first block of a line.
    void go_to_line(int line) const {
        const auto place = session->find_line(std::to_string(line));
        ASSERT_TRUE(place);
        ASSERT_TRUE(session->go_to(*place));
    }

    /// The machine position after each block from here to the end.
    std::vector<core::AxisPosition> places() const {
        std::vector<core::AxisPosition> all;
        while (session->knows(session->at())) {
            EXPECT_TRUE(session->go_to(session->at() + 1));
            all.push_back(session->state().machine.position);
        }
        return all;
    }
};

const std::string start = "G21 G90 G17 G54\nT1 M6\nM3 S2000\nG43 H1 Z50.\nG0 X10. Y10.\n";
const std::string rest = "G1 Z-2. F800.\nG91 X30.\nG90 Y40.\nG2 X60. Y60. R20.\nG0 Z50.\nM30\n";

/// Applies a change after `start`, and compares with a program that contains it at that position.
void expect_as_programmed(const SetupWriter& setup, const WhatIf& change, const std::string& lines,
                          const std::string& before = start, const std::string& behind = rest) {
    const Opened changed(setup, before + behind), programmed(setup, before + lines + behind);
    changed.go_to_line(6);
    const auto lines_more = static_cast<int>(std::count(lines.begin(), lines.end(), '\n'));
    programmed.go_to_line(6 + lines_more);
    const core::AxisPosition stood = changed->state().machine.position;
    ASSERT_TRUE(changed->change(change));
    EXPECT_EQ(changed->state().machine.position, stood);
    EXPECT_EQ(changed->state().control.modal.position, programmed->state().control.modal.position);
    EXPECT_EQ(changed->state().control.modal.offsets, programmed->state().control.modal.offsets);
    EXPECT_EQ(changed->state().lowering.offsets, programmed->state().lowering.offsets);
    const auto places = changed.places();
    EXPECT_EQ(places, programmed.places());
    EXPECT_FALSE(changed->record().stopped) << changed->record().stopped->message;
    ASSERT_GE(places.size(), 5u);
    EXPECT_NE(places[0], stood); // something moved
}

TEST(WhatIf, MovesAnActiveWorkOffsetAsG10Does) {
    const SetupWriter setup;
    for (const auto& [axis, words] :
         {std::pair<size_t, std::string>{0, "X-340."}, {1, "Y-190.5"}, {2, "Z-415."}})
        expect_as_programmed(setup, app::WorkOffsetChange{0, axis, std::stod(words.substr(1))},
                             "G10 L2 P1 " + words + "\n");
}

TEST(WhatIf, MovesAWorkOffsetUnderARotationAsG10Does) {
    const std::string turned = "G21 G90 G17 G54\nT1 M6\nM3 S2000\nG43 H1 Z50.\nG68 X5. Y5. R30.\n";
    expect_as_programmed(SetupWriter(), app::WorkOffsetChange{0, 0, -340.0}, "G10 L2 P1 X-340.\n",
                         turned,
                         "G1 X10. Y10. F800.\nZ20.\nG91 X30.\nG90 Y40.\nG69\nG0 Z50.\nM30\n");
}

TEST(WhatIf, LeavesTheMachineAloneWhereAnotherOffsetIsOn) {
    const Opened changed(SetupWriter(), start + rest);
    changed.go_to_line(6);
    const auto before = changed->state().control.modal;
    ASSERT_TRUE(changed->change(app::WorkOffsetChange{1, 0, -100.0}));
    EXPECT_EQ(changed->state().control.modal, before);
    EXPECT_EQ(changed->state().control.tables->work[1].origin[0], -100.0);
}

TEST(WhatIf, ChangesALengthThatIsOnAsWritingItAndCallingItAgainDoes) {
    for (const char* call : {"G43 H1 Z50.\n", "G44 H1 Z250.\n"}) {
        const std::string called =
            "G21 G90 G17 G54\nT1 M6\nM3 S2000\n" + std::string(call) + "G0 X10. Y10.\n";
        const std::string again = std::string(call).substr(0, 6);
        expect_as_programmed(SetupWriter(), app::LengthOffsetOverride{OffsetNumber{1}, 97.5},
                             "G10 L10 P1 R97.5\n" + again + "\n", called);
    }
}

TEST(WhatIf, CountsTheLengthWithItsWear) {
    SetupWriter setup;
    setup.lengths("[[length_offset]]\nnumber = 1\nlength = 95.0\nwear = 0.25\n");
    const Opened changed(setup, start + rest);
    changed.go_to_line(6);
    EXPECT_DOUBLE_EQ(changed->state().control.modal.offsets.tool[2], 95.25);
    ASSERT_TRUE(changed->change(app::LengthOffsetOverride{OffsetNumber{1}, 96.0}));
    EXPECT_DOUBLE_EQ(changed->state().control.modal.offsets.tool[2], 96.0);
    EXPECT_DOUBLE_EQ(changed->state().machine.length_offset.length, 96.0);
}

TEST(WhatIf, LeavesALengthAloneThatTheProgramGaveItself) {
    SetupWriter setup;
    setup.program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    const Opened changed(setup, "G21 G90 G54\nT1 M6\nM3 S2000\nG43.1 Z95\nG0 Z50\n" + rest);
    changed.go_to_line(6);
    const auto before = changed->state().control.modal;
    ASSERT_TRUE(changed->change(app::LengthOffsetOverride{OffsetNumber{1}, 60.0}));
    EXPECT_EQ(changed->state().control.modal, before);
}

TEST(WhatIf, ChangesTheLengthThatComesWithTheTool) {
    SetupWriter setup;
    setup.program("dialect = \"heidenhain\"\nstart = { X = -350, Y = -200, Z = 0 }\n");
    const Opened changed(setup, "0 BEGIN PGM P MM\n1 TOOL CALL 1 Z S2000\n2 M3\n"
                                "3 L Z+50 R0 FMAX\n4 L X+10 Y+10 FMAX\n5 L Z+10 F500\n"
                                "6 END PGM P MM\n");
    changed.go_to_line(5); // in Klartext block numbers
    const double stood = *changed->state().machine.position[2];
    ASSERT_TRUE(changed->change(app::LengthOffsetOverride{OffsetNumber{1}, 100.0}));
    EXPECT_EQ(changed->state().machine.position[2], stood);
    EXPECT_DOUBLE_EQ(*changed->state().control.modal.position[2], 45.0);
    ASSERT_TRUE(changed->go_to(changed->at() + 1));
    EXPECT_DOUBLE_EQ(*changed->state().machine.position[2], -420.0 + 10.0 + 100.0);
}

TEST(WhatIf, DoesNotChangeAnOffsetDuringRadiusCompensation) {
    const Opened changed(SetupWriter(), start
                                            + "G41 D1 X20. F500.\nX30.\nX40.\nX50.\nG40 X60.\n"
                                              "M30\n");
    changed.go_to_line(8);
    const uint64_t before = digest_of(changed->state());
    const auto done = changed->change(app::WorkOffsetChange{0, 0, -340.0});
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().message, HasSubstr("before G41"));
    EXPECT_EQ(digest_of(changed->state()), before);
    EXPECT_TRUE(changed->change(app::WorkOffsetChange{3, 0, -340.0}));
}

/// The parts of a tool with their lower and upper ends along its axis.
std::string parts_of(const core::ToolAssembly& tool) {
    std::string text;
    for (const core::ToolPart& part : tool.parts) {
        const core::Aabb box = core::bounds(part.profile);
        text += std::string(core::name_of(part.kind)) + " " + std::to_string(std::lround(box.min.z))
                + ".." + std::to_string(std::lround(box.max.z)) + " ";
    }
    return text + std::to_string(std::lround(tool.length));
}

TEST(WhatIf, PullsAToolOutOfItsHolderOrPushesItIn) {
    const Opened changed(SetupWriter(), start + rest);
    const auto tool = [&] { return parts_of(changed->setup_at(0).tools.at(ToolNumber{1})); };
    EXPECT_EQ(tool(), "flutes 0..20 shank 20..45 holder 45..95 95");
    ASSERT_TRUE(changed->change(app::ToolLengthChange{ToolNumber{1}, 100.0}));
    EXPECT_EQ(tool(), "flutes 0..20 shank 20..50 holder 50..100 100");
    ASSERT_TRUE(changed->change(app::ToolLengthChange{ToolNumber{1}, 70.0}));
    EXPECT_EQ(tool(), "flutes 0..20 holder 20..70 70");
    ASSERT_TRUE(changed->change(app::ToolLengthChange{ToolNumber{1}, 80.0}));
    EXPECT_EQ(tool(), "flutes 0..20 shank 20..30 holder 30..80 80");
    const auto done = changed->change(app::ToolLengthChange{ToolNumber{1}, 69.0});
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().message, HasSubstr("no shorter than 70 mm"));
    EXPECT_EQ(tool(), "flutes 0..20 shank 20..30 holder 30..80 80");
}

TEST(WhatIf, ChangesOnlyTheGaugeLengthOfAToolWithoutAHolder) {
    SetupWriter setup;
    setup.tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
               "gauge_length = 95\n");
    const Opened changed(setup, start + rest);
    ASSERT_TRUE(changed->change(app::ToolLengthChange{ToolNumber{1}, 60.0}));
    EXPECT_EQ(parts_of(changed->setup_at(0).tools.at(ToolNumber{1})), "flutes 0..20 60");
    EXPECT_FALSE(changed->change(app::ToolLengthChange{ToolNumber{1}, 10.0}));
}

/// Verdict, deciding pair and bound of all blocks of a run, as text.
std::string said_of(const app::CheckRun& run, size_t from = 0) {
    std::string text;
    for (size_t i = from; i < run.blocks.size(); ++i) {
        const core::BlockResult& result = run.blocks[i].result;
        text += std::to_string(i) + " " + core::name_of(result.verdict);
        if (result.deciding) {
            const core::PairClearance& pair = result.pairs[*result.deciding];
            text += " " + core::part_name(run.setup, pair.pair) + " "
                    + core::body_name(run.setup, pair.pair) + " " + std::to_string(pair.lower) + " "
                    + std::to_string(pair.allowance.distance);
        }
        text += "\n";
    }
    return text;
}

/// A deep slot next to a clamp, so that holder and clamp matter.
const std::string slot = start
                         + "G1 Z-18. F800.\nX60.\nG0 Z5.\nX90. Y90.\nG1 Z-5.\nX70.\nG0 Z50.\n"
                           "M30\n";

SetupWriter with_clamp(const std::string& at) {
    SetupWriter setup;
    setup.fixture("clamp-1", "box = [[0, 0, 0], [10, 20, 30]]\nframe = \"G54\"\nat = " + at + "\n");
    return setup;
}

void expect_as_set_up(const SetupWriter& before, const WhatIf& change, const SetupWriter& after) {
    const Opened changed(before, slot), meant(after, slot);
    const std::string unchanged = [&] {
        changed->knows(1000);
        return said_of(changed->record());
    }();
    ASSERT_TRUE(changed->change(change)); // at the beginning
    changed->knows(1000);
    meant->knows(1000);
    EXPECT_EQ(said_of(changed->record()), said_of(meant->record()));
    EXPECT_NE(said_of(changed->record()), unchanged);
    ASSERT_TRUE(changed->take_back());
    changed->knows(1000);
    EXPECT_EQ(said_of(changed->record()), unchanged);
}

TEST(WhatIf, OfAToolGivesWhatASetUpWithThatToolGives) {
    SetupWriter longer = with_clamp("[80, 60, 0]");
    longer.tool("number = 1\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n"
                "shank = [[10, 10, 5]]\nholder = [[40, 40, 50]]\n");
    expect_as_set_up(with_clamp("[80, 60, 0]"), app::ToolLengthChange{ToolNumber{1}, 75.0}, longer);
}

TEST(WhatIf, OfAFixtureGivesWhatASetUpWithItThereGives) {
    expect_as_set_up(with_clamp("[80, 60, 0]"), app::MovedFixture{"clamp-1", {-20.0, 4.0, 0.0}},
                     with_clamp("[60, 64, 0]"));
}

TEST(WhatIf, OfTheAllowanceGivesWhatASetUpWithItGives) {
    SetupWriter other = with_clamp("[80, 60, 0]");
    other.root("mesh_size = 0.5\nallowance = 7.0\n");
    expect_as_set_up(with_clamp("[80, 60, 0]"), app::AllowanceChange{7.0}, other);
}

TEST(WhatIf, OnTheWayForgetsNoBoundThatNoLongerHolds) {
    // The clamp is moved into the way when the machine is already near its new position.
    const Opened changed(with_clamp("[300, 300, 0]"), slot), meant(with_clamp("[70, 80, 0]"), slot);
    for (int line = 6; line <= 11; ++line) {
        changed.go_to_line(line);
        ASSERT_TRUE(changed->change(app::MovedFixture{"clamp-1", {-230.0, -220.0, 0.0}}));
        changed->knows(1000);
        meant->knows(1000);
        EXPECT_EQ(said_of(changed->record(), changed->at()),
                  said_of(meant->record(), changed->at()))
            << line;
        ASSERT_TRUE(changed->take_back());
    }
}

TEST(WhatIf, NamesWhatExistsIfTheTargetIsMissing) {
    const Opened changed(with_clamp("[80, 60, 0]"), slot);
    const auto error = [&](const WhatIf& change) {
        const auto done = changed->change(change);
        return done ? std::string() : done.error().message;
    };
    EXPECT_THAT(error(app::MovedFixture{"clamp-2"}), HasSubstr("there is clamp-1"));
    EXPECT_THAT(error(app::ToolLengthChange{ToolNumber{7}, 90.0}), HasSubstr("it has T1"));
    EXPECT_THAT(error(app::ToolLengthChange{ToolNumber{1}, -1.0}), HasSubstr("a number above 0"));
    EXPECT_THAT(error(app::WorkOffsetChange{0, 3, 1.0}), HasSubstr("no such axis"));
    EXPECT_THAT(error(app::WorkOffsetChange{5000, 0, 1.0}), HasSubstr("no such work offset"));
    EXPECT_THAT(error(app::LengthOffsetOverride{OffsetNumber{0}, 1.0}), HasSubstr("count from 1"));
    EXPECT_THAT(error(app::AllowanceChange{-1.0}), HasSubstr("from 0 to 1000"));
    EXPECT_TRUE(changed->changes().empty());
}

TEST(WhatIf, IsSaidAsAPersonWould) {
    EXPECT_EQ(text_of(app::ToolLengthChange{ToolNumber{3}, 95.0}), "T3 is 95 mm long");
    EXPECT_EQ(text_of(app::LengthOffsetOverride{OffsetNumber{3}, 95.5}), "H3 is 95.5 mm");
    EXPECT_EQ(text_of(app::WorkOffsetChange{6, 2, -4.0}), "G59.1 has its origin at Z-4");
    EXPECT_EQ(text_of(app::AllowanceChange{1.0}), "the minimum clearance is 1 mm");
    EXPECT_EQ(text_of(app::MovedFixture{"clamp-1", {0.0, 10.0, -2.0}}),
              "clamp-1 is moved by 10 mm along Y, -2 mm along Z");
}

TEST(Breakpoint, IsSaidAsAPersonWould) {
    app::Breakpoint breakpoint;
    EXPECT_EQ(text_of(breakpoint), "every block");
    breakpoint.line = 23;
    breakpoint.condition = *app::Condition::read("clearance < 1");
    EXPECT_EQ(text_of(breakpoint), "line 23 if clearance < 1");
    breakpoint.file = "sub.nc";
    breakpoint.tool = ToolNumber{3};
    EXPECT_EQ(text_of(breakpoint), "line 23 of sub.nc, change to T3 if clearance < 1");
    EXPECT_EQ(app::text_of({.id = 1, .rule = "finding"}), "any finding");
}

} // namespace
} // namespace app_test
