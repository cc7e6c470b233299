#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/gcode/programs.h"

namespace gcode {
namespace {

const std::filesystem::path shared_programs = source_dir / "../shared/programs";

/// A shared program that ends with an error: where, with which message, and why that is correct.
struct Expected {
    std::string file;
    uint32_t line;
    std::string message;
    std::string why;
};

const std::vector<Expected> errors = {
    {"fanuc-like/MaestroFusio__CONTOUR_ABS.NC", 15, "would fit if the centre words",
     "I and J are coordinates of the centre; Fanuc takes distances and stops (PS0020)"},
    {"fanuc-like/MaestroFusio__TEST2.NC", 12, "at its start and",
     "I and J were meant as coordinates here as well, and do not even fit as these"},
    {"fanuc-like/dillonhuff__mazak_sample.EIA", 2, "G53.5: the dialect fanuc has no such code",
     "a program for a turning and milling centre of Mazak, with codes of its own"},
    {"grbl-hobby/Michael-F-Br___fresa.gcode", 99, "the byte 0x01",
     "a stray control byte: Grbl passes over it, the others stop"},
    {"grbl-hobby/Michael-F-Br___gcodeLexer_samples.ngc", 8, "is not closed",
     "samples for a highlighter, with broken lines on purpose; not a program"},
    {"grbl-hobby/Michael-F-Br___program_3.gcode", 3,
     "G71: ", "Mach3's G71, which is G21 there; no control read here has it"},
    {"grbl-hobby/Michael-F-Br__program_1.gcode", 9, "no feed rate",
     "O1000 makes it Fanuc's, where a feed without F is an alarm (PS0011)"},
    {"grbl-hobby/cncjs__Circle_Diamond_Square_Calibration.gcode", 624, "29.0000 mm",
     "the radii differ by 1.4 mm: Grbl stops above 0.5 mm (error 33)"},
    {"grbl-hobby/cncjs__part.gcode", 2,
     "E0: ", "a program for a 3D printer: Grbl stops at the extruder's E (error 20)"},
    {"grbl-hobby/dillonhuff__camaster_sample.tap", 1, "'[' is not allowed",
     "WinCNC writes comments in square brackets; no control read here does"},
    {"grbl-hobby/fragmuffin__Cross2.tap", 8, "G71: ", "Mach3's G71, as above"},
    {"grbl-hobby/fragmuffin__Horse.tap", 16, "1.4841 mm",
     "G43 H and G91.1 make it LinuxCNC's, whose tolerance of 0.0283 mm it misses by a hair"},
    {"grbl-hobby/fragmuffin__Smiley001.nc", 6, "8.2794 mm",
     "the radii differ by 0.024 mm, above 0.005 mm and a thousandth: Grbl stops (error 33)"},
};

TEST(CorpusErrors, AreThoseOfProgramsThatAreWrong) {
    if (!std::filesystem::exists(shared_programs)) GTEST_SKIP() << "no shared programs here";
    std::map<std::string, Expected> left;
    for (const Expected& entry : errors) left[entry.file] = entry;
    for (const std::string kind : {"fanuc-like", "grbl-hobby"})
        for (const auto& entry : std::filesystem::directory_iterator(shared_programs / kind)) {
            const auto program = read_program(entry.path().string());
            ASSERT_TRUE(program) << program.error().message;
            Environment environment;
            environment.dialect = recognise(*program).dialect;
            const auto whole = gcode::run(*program, environment);
            const std::string name = kind + "/" + entry.path().filename().string();
            const auto expected = left.find(name);
            if (!whole.error) {
                EXPECT_EQ(expected, left.end()) << name << " runs";
                continue;
            }
            ASSERT_NE(expected, left.end())
                << name << ":" << whole.error->where.line << ": " << whole.error->message;
            EXPECT_EQ(whole.error->where.line, expected->second.line) << whole.error->message;
            EXPECT_THAT(whole.error->message, testing::HasSubstr(expected->second.message));
            left.erase(expected);
        }
    EXPECT_TRUE(left.empty()) << left.begin()->first << " runs, or is not there";
}

} // namespace
} // namespace gcode
