#include <gtest/gtest.h>

#include "app/report/text/text_report.h"
#include "app/setup/tools/freecad_bit.h"
#include "app/setup/tools/tool_library.h"
#include "core/sim/tool_assembly.h"
#include "gcode/language/modal_state.h"
#include "tests/support/scoped_folder.h"

namespace app {
namespace {

using core::ToolNumber;
using core::ToolShape;
using gcode::LengthUnit;

const test_support::ScopedFolder& folder() {
    static const test_support::ScopedFolder kept;
    return kept;
}

using Tools = std::map<ToolNumber, FoundTool>;

core::Result<Tools> read(const std::string& name, const std::string& text,
                         LengthUnit unit = LengthUnit::mm) {
    return read_tool_library(folder().write(name, text), unit);
}

std::string bit(const std::string& shape, const std::string& parameters) {
    return R"({"version": 2, "name": "a bit", "shape": ")" + shape + R"(", "parameter": {)"
           + parameters + R"(}, "attribute": {}})";
}

core::ToolDescription tool_of(const core::Result<Tools>& tools, int number = 1) {
    EXPECT_TRUE(tools.has_value()) << error_text(tools.error());
    if (!tools || !tools->contains(ToolNumber{number})) return {};
    const FoundTool& found = tools->at(ToolNumber{number});
    EXPECT_TRUE(core::assemble(complete(found).tool).has_value())
        << core::assemble(complete(found).tool).error().message;
    return found.tool;
}

TEST(ToolLibrary, ReadsFreeCadsBits) {
    const auto mill =
        tool_of(read("a.fctb", bit("endmill.fcstd", R"("CuttingEdgeHeight": "30.0000 mm",
        "Diameter": "5.0000 mm", "Length": "50.0000 mm", "ShankDiameter": "3.0000 mm")")));
    EXPECT_EQ(mill.shape, ToolShape::flat);
    EXPECT_EQ(mill.diameter, 5.0);
    EXPECT_EQ(mill.flute_length, 30.0);
    EXPECT_EQ(mill.shank_diameter, 3.0);
    EXPECT_EQ(mill.stick_out, std::nullopt) << "a part of its length is in the holder";
    const auto inch = tool_of(read("b.fctb", bit("ballend.fcstd", R"("Diameter": "1/4 in")")));
    EXPECT_EQ(inch.shape, ToolShape::ball);
    EXPECT_EQ(inch.diameter, 6.35);
    const auto vee = tool_of(read("c.fctb", bit("v-bit.fcstd", R"("CuttingEdgeAngle": "60.0000 °",
        "Diameter": "10 mm", "TipDiameter": "1 mm", "CuttingEdgeHeight": "1 mm", "Length": "20 mm")")));
    EXPECT_EQ(vee.shape, ToolShape::chamfer);
    EXPECT_EQ(vee.angle_deg, 30.0);
    EXPECT_EQ(vee.tip_diameter, 1.0);
    const auto drill =
        tool_of(read("d.fctb", bit("drill.fcstd",
                                   R"("Diameter": 3.5, "TipAngle": "119 °", "Length": "60 mm")")));
    EXPECT_EQ(drill.point_deg, 119.0);
    const auto bull = tool_of(
        read("e.fctb", bit("bullnose.fcstd", R"("Diameter": "6 mm", "FlatRadius": "1.5 mm")")));
    EXPECT_EQ(bull.corner_radius, 1.5);
    const auto dove = tool_of(read("f.fctb", bit("dovetail.fcstd", R"("CuttingEdgeAngle": "60 °",
        "CuttingEdgeHeight": "9 mm", "Diameter": "19 mm", "NeckDiameter": "8 mm", "NeckHeight": "5 mm")")));
    EXPECT_EQ(dove.angle_deg, 30.0);
    EXPECT_EQ(dove.neck_length, 5.0);
}

TEST(ToolLibrary, ReadsFreeCadsQuantitiesInAllUnits) {
    const std::pair<const char*, std::optional<double>> cases[] = {{"12 mm", 12.0},
                                                                   {"1.20 cm", 12.0},
                                                                   {"0.012 m", 12.0},
                                                                   {"12000 \u00b5m", 12.0},
                                                                   {"12000 um", 12.0},
                                                                   {"0.5 in", 12.7},
                                                                   {"1/2 in", 12.7},
                                                                   {"1 1/2 in", 38.1},
                                                                   {"1/2\"", 12.7},
                                                                   {"1+1/2\"", 38.1},
                                                                   {"0.5 ft", 152.4},
                                                                   {"500 mil", 12.7},
                                                                   {"500 thou", 12.7},
                                                                   {"1.2e1 mm", 12.0},
                                                                   {"12,5 mm", 12.5},
                                                                   {"12", 12.0},
                                                                   {"+12 mm", 12.0},
                                                                   {"-12 mm", -12.0},
                                                                   {"12 deg", {}},
                                                                   {"12 parsec", {}},
                                                                   {"mm", {}},
                                                                   {"12 mm 3", {}},
                                                                   {"1.2.3 mm", {}},
                                                                   {"12 / 0 mm", {}},
                                                                   {"", {}}};
    for (const auto& [text, expected] : cases) {
        const auto found = freecad_length(nlohmann::json(text));
        EXPECT_EQ(found.has_value(), expected.has_value()) << text;
        if (found && expected) {
            EXPECT_NEAR(*found, *expected, 1e-9) << text;
        }
    }
    EXPECT_EQ(freecad_angle("60.0 \u00b0"), 60.0);
    EXPECT_EQ(freecad_angle("60 deg"), 60.0);
    EXPECT_NEAR(freecad_angle("0.5 rad").value_or(0.0), 28.6478897565, 1e-9);
    EXPECT_EQ(freecad_angle(90), 90.0);
    EXPECT_FALSE(freecad_angle("12 mm").has_value());
    EXPECT_FALSE(freecad_length(std::string(100000, '1') + " mm").has_value());
    EXPECT_FALSE(read("p.fctb", bit("endmill.fcstd", R"("Diameter": "-12 mm")")));
    EXPECT_FALSE(read("q.fctb", bit("endmill.fcstd", R"("Diameter": "12 parsec")")));
}

TEST(ToolLibrary, ReadsAFreeCadLibraryWithItsBits) {
    folder().write("five.fctb", bit("endmill.fcstd", R"("Diameter": "5 mm")"));
    folder().write("nine.fctb", bit("drill.fcstd", R"("Diameter": "9 mm")"));
    const auto tools = read("mine.fctl", R"({"tools": [{"nr": 1, "path": "five.fctb"},
        {"nr": 7, "path": "nine.fctb"}], "version": 1})");
    EXPECT_EQ(tool_of(tools, 1).diameter, 5.0);
    EXPECT_EQ(tool_of(tools, 7).shape, ToolShape::drill);
    const auto missing = read("less.fctl", R"({"tools": [{"nr": 1, "path": "none.fctb"}]})");
    ASSERT_FALSE(missing.has_value());
    EXPECT_NE(error_text(missing.error()).find("there is no bit none.fctb"), std::string::npos);
    EXPECT_FALSE(read("twice.fctl", R"({"tools": [{"nr": 1, "path": "five.fctb"},
        {"nr": 1, "path": "nine.fctb"}]})")
                     .has_value());
}

TEST(ToolLibrary, ReadsFreeCadsOlderTables) {
    const std::string tools = R"({"1": {"name": "end", "tooltype": "EndMill", "diameter": 8.0,
        "cornerRadius": 0.0, "cuttingEdgeAngle": 180.0, "cuttingEdgeHeight": 25.0,
        "flatRadius": 0.0, "lengthOffset": 0.0},
        "4": {"name": "", "tooltype": "BallEndMill", "diameter": 3.0}})";
    for (const std::string& text : {tools, R"({"TableName": "a", "Tools": )" + tools + "}",
                                    R"([{"TableName": "a", "Tools": )" + tools + "}]"}) {
        const auto read_tools = read("table.json", text);
        EXPECT_EQ(tool_of(read_tools, 1).flute_length, 25.0);
        EXPECT_EQ(tool_of(read_tools, 4).shape, ToolShape::ball);
    }
}

TEST(ToolLibrary, ReadsFusionsLibraries) {
    const auto tools = read("fusion.json", R"({"data": [
        {"type": "bull nose end mill", "unit": "millimeters", "description": "x",
         "geometry": {"DC": 10, "RE": 1, "LCF": 22, "SFDM": 10, "LB": 45},
         "post-process": {"number": 3},
         "holder": {"unit": "millimeters", "segments": [
             {"height": 30, "lower-diameter": 32, "upper-diameter": 40}]}},
        {"type": "drill", "unit": "inches", "geometry": {"DC": 0.25, "SIG": 135},
         "post-process": {"number": 4}},
        {"type": "holder"}], "version": 2})");
    const auto bull = tool_of(tools, 3);
    EXPECT_EQ(bull.corner_radius, 1.0);
    EXPECT_EQ(bull.stick_out, 45.0);
    ASSERT_EQ(bull.holder.size(), 1U);
    EXPECT_EQ(bull.holder[0].upper_diameter, 40.0);
    EXPECT_EQ(tool_of(tools, 4).diameter, 6.35);
    EXPECT_EQ(tool_of(tools, 4).point_deg, 135.0);
}

TEST(ToolLibrary, ReadsAToolTable) {
    const auto tools = read("tool.tbl",
                            "T1 P1 D0.25 Z2.5 ;1/4 end mill\nT2 P2 Z1.5 D0.125 ;ball nose\n"
                            "T99 P99 Z3.0 ;probe\n",
                            LengthUnit::inch);
    EXPECT_EQ(tool_of(tools, 1).diameter, 6.35);
    EXPECT_EQ(tool_of(tools, 1).gauge_length, 63.5);
    EXPECT_EQ(tool_of(tools, 2).shape, ToolShape::ball);
    EXPECT_FALSE(tools->contains(ToolNumber{99}));
}

TEST(ToolLibrary, RefusesFilesThatAreNotToolLibraries) {
    for (const char* text :
         {"", "[]", "{}", "3", "{\"tools\": [3]}",
          "{\"tools\": [{\"nr\": \"1\", \"path\": \"x\"}]}", "{\"parameter\": {}, \"shape\": 3}",
          "{\"parameter\": 3, \"shape\": \"a\"}", "{\"data\": []}",
          "{\"data\": [{\"type\": 3, \"geometry\": 4, \"post-process\": {\"number\": 1}}]}",
          "{\"Tools\": [1]}", "{\"1\": {\"diameter\": null}}",
          "{\"1\": {\"diameter\": -1, \"name\": null, \"tooltype\": 7}}", "not json"}) {
        const auto tools = read("bad.json", text);
        ASSERT_FALSE(tools.has_value()) << text;
        EXPECT_NE(error_text(tools.error()).find("bad.json"), std::string::npos) << text;
    }
    EXPECT_FALSE(read_tool_library(folder() / "none.json", LengthUnit::mm).has_value());
    EXPECT_FALSE(read("tools.csv", "1,2").has_value());
}

} // namespace
} // namespace app
