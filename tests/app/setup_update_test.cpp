#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/setup/inference/inferred_setup.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "app/setup/setup_text.h"
#include "app/setup/setup_update.h"
#include "gcode/text/source.h"
#include "tests/app/bare_programs.h"
#include "tests/support/scoped_folder.h"

namespace app_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string head = "G21 G90 G54\n(T1 D=8 - FLAT END MILL)\nT1 M6\nS8000 M3\nG43 H1 Z50\n"
                         "G0 X0 Y0\nZ5\nG1 Z-3 F200\nX40\nG0 Z50\n";
const std::string more =
    "(T2 D=5 - DRILL)\nT2 M6\nS900 M3\nG55\nG43 H2 Z50\nG81 X5 Y5 Z-8 R2 F100\n"
    "G80\nG0 Z50\n";

gcode::Program program_of(const std::string& text) {
    const test_support::ScopedFolder folder;
    return *gcode::read_program(folder.write("p.nc", text));
}

core::Result<app::SetupUpdate> update(const std::string& setup, const std::string& program) {
    const auto file = app::completed_setup(setup, "s.toml", program_of(program), {});
    if (!file) return tl::unexpected(file.error());
    return app::updated_setup(setup, *file);
}

app::SetupUpdate updated(const std::string& setup, const std::string& program) {
    const auto done = update(setup, program);
    EXPECT_TRUE(done) << done.error().message << "\n" << setup;
    return done.value_or(app::SetupUpdate{});
}

std::string written_for(const std::string& program) {
    return app::setup_text(*app::infer_setup(program_of(program), {}), {.program = "p.nc"});
}

/// Whether all lines of a text are in another one, in their order.
bool has_all_lines(const std::string& text, const std::string& lines) {
    size_t at = 0;
    for (size_t i = 0; i < lines.size();) {
        const size_t end = std::min(lines.find('\n', i), lines.size());
        const size_t found = text.find(lines.substr(i, end - i), at);
        if (found == std::string::npos) return false;
        at = found + end - i;
        i = end + 1;
    }
    return true;
}

TEST(SetupUpdate, AddsWhatTheProgramSaysNow) {
    std::string mine = written_for(head + "M30\n");
    mine.replace(mine.find("#stick_out = "), 13, "stick_out = 33 # measured ");
    const app::SetupUpdate done = updated(mine, head + more + "M30\n");
    EXPECT_THAT(done.added,
                ElementsAre(HasSubstr("work offset G55"), HasSubstr("tool 2, according to the")));
    EXPECT_THAT(done.unused, IsEmpty());
    EXPECT_TRUE(has_all_lines(done.text, mine)) << done.text;
    EXPECT_THAT(done.text, HasSubstr("[[tool]]\nnumber = 2\ndiameter = 5\n"));
    EXPECT_THAT(done.text, HasSubstr("\n#G54 = { X = 0, Y = 0, Z = -500 }\n#G55 = "));
    EXPECT_THAT(done.text, HasSubstr("stick_out = 33 # measured"));
}

/// The unit of a set-up is that of its text, not of the program.
TEST(SetupUpdate, KeepsToTheUnitOfTheFile) {
    const std::string program =
        "G20 G90 G54\n(T1 D=0.5 - FLAT END MILL)\nT1 M6\nS8000 M3\nG43 H1 Z2\n"
        "G0 X0 Y0\nG1 Z-.1 F20\nX2\nG0 Z2\nM30\n";
    const std::string in_mm = updated("mesh_size = 1\n", program).text;
    EXPECT_THAT(in_mm, HasSubstr("\ndiameter = 12.7\n"));
    EXPECT_THAT(in_mm, HasSubstr("Z = -500 }"));
    EXPECT_THAT(in_mm, Not(HasSubstr("inch")));
    const std::string in_inch = updated("length_unit = \"inch\"\nmesh_size = 0.04\n", program).text;
    EXPECT_THAT(in_inch, HasSubstr("\ndiameter = 0.5\n"));
    EXPECT_THAT(in_inch, HasSubstr("Z = -19.685039 }"));
    const std::string of_mm_program = updated("length_unit = \"inch\"\n", head + "M30\n").text;
    EXPECT_THAT(of_mm_program, HasSubstr("\ndiameter = 0.31496063\n"));
}

TEST(SetupUpdate, NamesWhatIsNotUsedAnyMore) {
    const std::string setup = "[offsets]\nG54 = { X = 1 }\nG56 = { X = 2 }\n[[tool]]\nnumber = 1\n"
                              "stick_out = 40\n[[tool]]\nnumber = 9\nstick_out = 40\n";
    const app::SetupUpdate done = updated(setup, head + "M30\n");
    EXPECT_EQ(done.text, setup);
    EXPECT_THAT(done.added, IsEmpty());
    EXPECT_THAT(done.unused, ElementsAre("tool 9", "work offset G56"));
}

TEST(SetupUpdate, PutsWorkOffsetsBelowTheOthers) {
    const std::string setup = "[offsets] # mine\nG54 = { X = 1 } # touched off\n\n[rules]\n"
                              "air-cut = \"off\"\n[[tool]]\nnumber = 1\n[[tool]]\nnumber = 2\n";
    const app::SetupUpdate done = updated(setup, head + more + "M30\n");
    EXPECT_THAT(done.text, HasSubstr("# touched off\n#G55 = { X = "));
    EXPECT_THAT(done.text, HasSubstr("}\n\n[rules]\nair-cut"));
    EXPECT_THAT(done.added, ElementsAre(HasSubstr("G55")));
}

TEST(SetupUpdate, AddsTheStockThatTheProgramStates) {
    const std::string program = "0 BEGIN PGM A MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n"
                                "2 BLK FORM 0.2 X+50 Y+40 Z+0\n3 TOOL CALL 1 Z S1000\n"
                                "4 L Z+50 R0 FMAX M3\n5 L X+10 Y+10 FMAX\n6 L Z+2 FMAX\n"
                                "7 L Z-3 F100\n8 L X+40 F200\n9 L Z+50 FMAX\n10 END PGM A MM\n";
    const app::SetupUpdate done = updated("[[tool]]\nnumber = 1\n", program);
    EXPECT_THAT(done.text, HasSubstr("\n[stock] "));
    EXPECT_THAT(done.text, HasSubstr("\nbox = [[0, 0, -20], [50, 40, 0]]\n"));
    const std::string own = "[[tool]]\nnumber = 1\n[stock]\nbox = [[0, 0, -9], [1, 1, 0]]\n";
    EXPECT_THAT(updated(own, program).text, HasSubstr(own));
}

TEST(SetupUpdate, DoneTwiceAddsNothing) {
    for (const char* from : bare_programs) {
        const std::string setup = written_for(from);
        for (const char* to : bare_programs) {
            const auto first = update(setup, to);
            if (!first) { // the flank angle of a tool that the other program does not describe
                EXPECT_THAT(first.error().message, HasSubstr("angle_deg does not apply"));
                continue;
            }
            const app::SetupUpdate& once = *first;
            const app::SetupUpdate twice = updated(once.text, to);
            EXPECT_EQ(once.text, twice.text) << from << to;
            EXPECT_THAT(twice.added, IsEmpty()) << once.text << to;
            EXPECT_TRUE(has_all_lines(once.text, setup)) << once.text;
        }
    }
}

TEST(SetupUpdate, KeepsLineEndsAndAMissingOneAtTheEnd) {
    const app::SetupUpdate windows = updated(
        "[[tool]]\r\nnumber = 1\r\n\r\n[offsets]\r\nG54 = { X = 1 }", head + more + "M30\n");
    EXPECT_EQ(windows.added.size(), 2u);
    for (size_t at = windows.text.find('\n'); at != std::string::npos;
         at = windows.text.find('\n', at + 1))
        EXPECT_EQ(windows.text[at - 1], '\r') << at << windows.text;
    const std::string bare = "[[tool]]\nnumber = 1";
    EXPECT_THAT(updated(bare, head + more + "M30\n").text, HasSubstr("number = 1\n"));
    EXPECT_EQ(updated(bare + "\n[offsets]\nG54 = { X = 1 }", head + "M30\n").text,
              bare + "\n[offsets]\nG54 = { X = 1 }")
        << "nothing was added";
}

TEST(SetupUpdate, RefusesWhatItCannotAddTo) {
    const std::string inline_tools = "tool = [{ number = 1 }]\n";
    const auto refused = update(inline_tools, head + more + "M30\n");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("[[tool]]"));
    EXPECT_FALSE(update("[[tool]\n", head));
    EXPECT_FALSE(update("nonsense = 1\n", head));
    // A comment would become part of this text.
    const std::string text =
        "[[fixture]]\nname = \"\"\"\n[offsets]\n\n\"\"\"\nbox = [[0, 0, -9], [1, "
        "1, -8]]\n[[tool]]\nnumber = 1\n[[tool]]\nnumber = 2\n";
    EXPECT_FALSE(update(text, head + more + "M30\n"));
}

} // namespace
} // namespace app_test
