#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/program_settings.h"
#include "app/setup/setup_file.h"
#include "tests/support/meshes.h"
#include "tests/support/scoped_folder.h"
#include "tests/support/setup_writer.h"
#include "tests/support/stl_writer.h"

namespace app {
namespace {

using test_support::SetupWriter;

const test_support::ScopedFolder& folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

core::Result<SetupFile> read(const std::string& tool) {
    return read_setup(folder().write("setup.toml", SetupWriter().tool(tool).text()), {});
}

const std::string flat = "number = 4\nshape = \"flat\"\ndiameter = 10\nflute_length = 20\n";

core::ToolAssembly tool_of(const std::string& keys) {
    const auto file = read(keys);
    EXPECT_TRUE(file.has_value()) << error_text(file.error());
    return file ? file->setup.tools.begin()->second : core::ToolAssembly{};
}

void expect_refused(const std::string& keys, const std::string& words) {
    const auto file = read(keys);
    ASSERT_FALSE(file.has_value()) << words;
    EXPECT_NE(error_text(file.error()).find(words), std::string::npos) << error_text(file.error());
}

bool assumes(const std::string& keys, const std::string& words) {
    const auto file = read(keys);
    if (!file) return false;
    for (const std::string& each : file->assumptions)
        if (each.find(words) != std::string::npos) return true;
    return false;
}

const core::RevolvedProfile& holder(const core::ToolAssembly& tool) {
    EXPECT_EQ(tool.parts.back().kind, core::PartKind::holder);
    return tool.parts.back().profile;
}

TEST(ToolTable, ReadsEveryShape) {
    const std::string size = "number = 4\ndiameter = 20\nflute_length = 12\nshape = ";
    for (const char* keys :
         {"\"flat\"", "\"ball\"", "\"bull\"\ncorner_radius = 1", "\"drill\"\npoint_deg = 140",
          "\"taper\"\nangle_deg = 5\ntip_diameter = 2\ncorner_radius = 1",
          "\"chamfer\"\nangle_deg = 45", "\"tslot\"\nneck_diameter = 8\nneck_length = 9",
          "\"dovetail\"\nangle_deg = 30\nneck_diameter = 5", "\"lollipop\"\nneck_diameter = 8",
          "\"threadmill\"\npitch = 1.5\nteeth = 2\nthread_deg = 55"})
        EXPECT_GT(tool_of(size + keys + "\n").length, 11.9) << keys;
    EXPECT_EQ(
        tool_of("number = 4\nshape = \"profile\"\nprofile = [[2, 0], [5, 3], [5, 9]]\n").length,
        9.0);
}

TEST(ToolTable, TakesPartsAsConesOrAsOutlines) {
    const auto cones =
        tool_of(flat + "shank = [[10, 8, 25]]\nholder = [[30, 40, 20], [60, 60, 5]]\n");
    const auto outlines = tool_of(flat
                                  + "shank = [[5, 0], [4, 25]]\n"
                                    "holder = [[15, 0], [20, 20], [30, 20], [30, 25]]\n");
    EXPECT_EQ(cones.length, 70.0);
    EXPECT_EQ(outlines.length, 70.0);
    ASSERT_EQ(holder(outlines).elements.size(), 2U);
    EXPECT_EQ(holder(outlines).elements[1].r0, holder(cones).elements[1].r0);
    EXPECT_EQ(outlines.parts[1].profile.elements[0].r1, 4.0);
    expect_refused(flat + "holder = [[15, 1], [20, 20]]\n", "holder must begin at z = 0");
    expect_refused(flat + "shank = [[5, 0], [4, 25], [4, 20]]\n", "shank must not go down");
}

TEST(ToolTable, TakesAPresetOfAHolderByItsName) {
    const auto tool = tool_of(flat + "stick_out = 45\nholder = \"BT40-ER32\"\n");
    EXPECT_NEAR(tool.length, 45.0 + 70.0, 1e-9);
    EXPECT_EQ(core::bounds(holder(tool)).max.x, 31.5); // the flange of the taper
    EXPECT_EQ(core::bounds(tool.parts[1].profile).max.z, 45.0);
    expect_refused(flat + "holder = \"BT40-ER99\"\n",
                   "holder = there is no holder \"BT40-ER99\"; did you mean \"BT40-ER");
}

TEST(ToolTable, TakesAHolderFromAFile) {
    folder().write("mine.toml", "[[holder]]\nname = \"chuck\"\nprofile = [[20, 0], [20, 60]]\n");
    EXPECT_EQ(tool_of(flat + "holder = \"chuck\"\nholder_file = \"mine.toml\"\n").length, 80.0);
    expect_refused(flat + "holder = \"chuk\"\nholder_file = \"mine.toml\"\n", "not in mine.toml");
    expect_refused(flat + "holder = \"chuck\"\nholder_file = \"no.toml\"\n",
                   "no.toml: there is no");
    expect_refused(flat + "holder_file = \"mine.toml\"\n", "holder_file needs holder");
    for (const char* bad : {"[[holder]]\nname = \"a\"\n", "[[holder]]\ncones = [[1, 1, 1]]\n",
                            "[[holder]]\nname = \"a\"\ncones = [[1, 1, 0]]\n", "holder = 3\n",
                            "[[holder]]\nname = \"a\"\ncones = [[1, 1, 1]]\ncolor = 1\n",
                            "[[holder]]\nname = \"a\"\ncones = []\n", "[[holder\n"}) {
        folder().write("bad.toml", bad);
        expect_refused(flat + "holder = \"a\"\nholder_file = \"bad.toml\"\n", "bad.toml:");
    }
}

TEST(ToolTable, TakesAHolderFromAMesh) {
    folder().write("holder.stl",
                   test_support::binary_stl(test_support::box_mesh({-3, -4, 0}, {3, 4, 30})));
    const std::string mesh = flat + "holder_mesh = \"holder.stl\"\n";
    EXPECT_EQ(core::bounds(holder(tool_of(mesh))).max.x, 5.0);
    EXPECT_EQ(tool_of(mesh).length, 50.0);
    EXPECT_TRUE(assumes(mesh, "smallest body of revolution that contains holder.stl"));
    expect_refused(mesh + "holder = [[5, 5, 5]]\n", "cannot be combined with holder");
    folder().write("low.stl",
                   test_support::binary_stl(test_support::box_mesh({-3, -4, -1}, {3, 4, 30})));
    expect_refused(flat + "holder_mesh = \"low.stl\"\n", "begins at Z -1");
    expect_refused(flat + "holder_mesh = \"none.stl\"\n", "none.stl");
}

TEST(ToolTable, ListsItsAssumptions) {
    EXPECT_TRUE(assumes(flat, "tool 4 has no holder"));
    EXPECT_TRUE(assumes(flat + "cuts_at_centre = false\n", "within 2.5 mm of its axis"));
    EXPECT_TRUE(assumes(flat + "cuts_at_centre = false\ncentre_diameter = 3\n", "within 1.5 mm"));
    EXPECT_FALSE(assumes(flat, "of its axis"));
    EXPECT_TRUE(assumes("number = 4\nshape = \"threadmill\"\ndiameter = 8\nflute_length = 12\n",
                        "tool 4 has no pitch"));
    expect_refused(flat + "centre_diameter = 3\n", "cuts_at_centre = false");
    expect_refused(flat + "cuts_at_centre = false\ncentre_diameter = 10\n", "below diameter");
    expect_refused(flat + "single_point = true\n", "state shank_diameter or shank");
    EXPECT_FALSE(assumes(flat + "single_point = true\nshank_diameter = 6\n", "of its axis"));
}

TEST(ToolTable, GivesTheControlLengthWearAndDiameter) {
    const auto file = read_setup(
        folder().write("setup.toml",
                       SetupWriter()
                           .tool(flat + "gauge_length = 88\n")
                           .lengths("[[length_offset]]\nnumber = 3\nlength = 95\nwear = -0.2\n"
                                    "diameter = 9.8\n")
                           .text()),
        {});
    ASSERT_TRUE(file.has_value());
    const gcode::LengthOffset& offset = file->environment.length_offsets.at(core::OffsetNumber{3});
    EXPECT_EQ(offset.length, 95.0);
    EXPECT_EQ(offset.wear, -0.2);
    EXPECT_EQ(offset.diameter, 9.8);
    EXPECT_EQ(file->environment.tool_lengths.at(core::ToolNumber{4}), 88.0);
    EXPECT_EQ(file->environment.tool_diameters.at(core::ToolNumber{4}), 10.0);
}

} // namespace
} // namespace app
